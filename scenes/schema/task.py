"""The task of a request: control points and how each is met, one key a step."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

from pydantic import BeforeValidator, Field
from pydantic_core import PydanticCustomError

from assur.scenes import bounds
from assur.scenes.schema.model import (
    ORIGIN,
    Angle,
    Coordinate,
    Distance,
    Document,
    Duration,
    Group,
    Interval,
    Name,
    Point,
    PoseUncertaintyDocument,
    Reference,
    Stretch,
    YawError,
)

Match = Literal["velocity", "position"]
TAKEN_AWAY = "somebody has taken it away"
"""What an answer says of a part with `gone_after_s`, among its assumptions."""


def _free_or_number(value: object) -> object:
    """None for `free`, so that it means the same as silence; what a union would refuse once for each of its options is
    refused once, in words."""
    number = type(value) in (int, float) and -bounds.TURNS_RAD <= value <= bounds.TURNS_RAD  # type: ignore[operator]
    if not (number or value == "free"):
        largest = f"{bounds.TURNS_RAD:g} rad, {math.degrees(bounds.TURNS_RAD):.12g} deg"
        raise PydanticCustomError(
            "free_or_number", "allowed: {allowed}", {"allowed": f"free, or a number up to {largest}"}
        )
    return value if number else None


FreeAngle = Annotated[Angle | Literal["free"] | None, BeforeValidator(_free_or_number)]


class TargetDocument(Document):
    """A pose in a frame (the world if none is named), or relative to a body and in that body's frame."""

    at_most_one: ClassVar[tuple[Group, ...]] = (("frame", "body"), ("yaw_rad", "yaw_free", "yaw_keep"))

    frame: Reference | None = None
    body: Reference | None = None
    at_m: Point = ORIGIN
    yaw_rad: Angle | None = None
    yaw_free: bool = False
    yaw_keep: bool = False
    pitch_rad: FreeAngle = None
    roll_rad: FreeAngle = None


class ArchDocument(Document):
    """Up, over, down."""

    top_m: Coordinate


class LiftDocument(Document):
    """The straight part along the vertical."""

    m: Distance
    stop: bool = False


class WindowedStep(Document):
    """What all steps share: a name and when the control point may be met."""

    name: Name | None = None
    window_s: Interval | None = None
    window_m: Stretch | None = None


class FollowDocument(WindowedStep):
    """Meet a pose with its velocity and track it."""

    to: TargetDocument
    duration_s: Duration
    tolerance_m: Distance | None = None
    tolerance_rad: YawError | None = None


class LineDocument(Document):
    """Straight on to a point of the path's frame; the last part of a move's path ends at its `to`."""

    to_m: Point | None = None


class ArcDocument(Document):
    """Along a circle; the last part of a move's path ends at its `to`."""

    via_m: Point
    to_m: Point | None = None


class SplineDocument(Document):
    """Along a cubic spline through points."""

    through_m: Annotated[list[Point], Field(min_length=1, max_length=bounds.MAX_PATH_POINTS)]


class PathPartDocument(Document):
    """A part of a path: it begins where the one before it ends."""

    exactly_one: ClassVar[tuple[Group, ...]] = (("line", "arc", "spline"),)

    line: LineDocument | None = None
    arc: ArcDocument | None = None
    spline: SplineDocument | None = None


PathDocument = Annotated[list[PathPartDocument], Field(min_length=1, max_length=bounds.MAX_PATH_PARTS)]


class MoveDocument(WindowedStep):
    """Bring the tool point to a pose. The points of a `path` are in the frame of `to`."""

    to: TargetDocument
    match: Match = "velocity"
    via: bool = False
    arch: ArchDocument | None = None
    leg: Literal["joint", "cartesian"] = "joint"
    path: PathDocument | None = None
    blend_m: Distance = 0.0


class TraceDocument(WindowedStep):
    """Take the tool point along a path in a frame at a process speed relative to that frame."""

    start: TargetDocument
    path: PathDocument
    blend_m: Distance = 0.0
    speed_m_s: Annotated[float, Field(ge=bounds.LEAST, le=bounds.FAST_M_S)]
    lead_in_m: Annotated[float, Field(ge=bounds.LEAST, le=bounds.FAR_M)] | None = None
    lead_out_m: Annotated[float, Field(ge=bounds.LEAST, le=bounds.FAR_M)] | None = None


class _Handling(WindowedStep):
    part: Reference
    approach: LiftDocument
    dwell_s: Duration
    depart: LiftDocument
    match: Match = "velocity"
    contact_with: Annotated[list[Reference], Field(max_length=bounds.MAX_CONTACTS)] | None = None
    tolerance_m: Distance | None = None
    tolerance_rad: YawError | None = None
    contact_tolerance_m: Distance = 0.0
    arch: ArchDocument | None = None


class PickDocument(_Handling):
    """Approach a part, stay with it, attach it, depart."""

    grasp_m: Point
    grasp_yaw_rad: Angle = 0.0
    held_within: PoseUncertaintyDocument | None = None
    grip_within_m: Distance | None = None


class PlaceDocument(_Handling):
    """Bring the held part's own frame to a pose, stay there, detach it, depart."""

    to: TargetDocument
    support_within_m: Distance | None = None
    gone_after_s: Duration | None = None


class StepDocument(Document):
    """One step."""

    exactly_one: ClassVar[tuple[Group, ...]] = (("move", "follow", "trace", "pick", "place"),)

    move: MoveDocument | None = None
    follow: FollowDocument | None = None
    trace: TraceDocument | None = None
    pick: PickDocument | None = None
    place: PlaceDocument | None = None
