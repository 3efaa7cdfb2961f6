"""Frames of a request: a time law each, how far the frame may be from it, and for how long it is known."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from assur.scenes import bounds
from assur.scenes.schema.model import (
    Angle,
    Coordinate,
    Distance,
    Document,
    Duration,
    Group,
    Instant,
    Interval,
    Point,
    PoseDocument,
    Positive,
    Rate,
    Reference,
    Span,
    Speed,
    YawError,
)

BELT_M_S2, BELT_M_S3 = 5.0, 50.0
"""Acceleration and jerk of a conveyor's change that states none: of a belt with a servo drive, m/s² and m/s³."""
DIAL_RAD_S2, DIAL_RAD_S3 = 20.0, 200.0
"""The same of a turntable: those of the belt at a rim 250 mm from the centre, rad/s² and rad/s³."""


Component = Annotated[float, Field(ge=-1.0, le=1.0)]


class FixedDocument(PoseDocument):
    """A frame that does not move, or that goes with another one, in which its pose is constant."""

    frame: Reference | None = None


class LinearDocument(PoseDocument):
    """A constant velocity."""

    velocity_m_s: Annotated[list[Speed], Field(min_length=3, max_length=3)]
    at_s: Instant = 0.0


class SpeedChange(Document):
    """From `at_s` on the conveyor goes over to another speed, with this acceleration and jerk."""

    at_s: Instant
    speed_m_s: Speed
    acceleration_m_s2: Positive = BELT_M_S2
    jerk_m_s3: Positive = BELT_M_S3


class ConveyorDocument(PoseDocument):
    """Travels along its own x axis."""

    speed_m_s: Speed
    at_s: Instant = 0.0
    changes: Annotated[list[SpeedChange], Field(max_length=bounds.MAX_CHANGES)] = Field(default_factory=list)


class RateChange(Document):
    """From `at_s` on the turntable goes over to another rate, with this acceleration and jerk."""

    at_s: Instant
    rate_rad_s: Rate
    acceleration_rad_s2: Positive = DIAL_RAD_S2
    jerk_rad_s3: Positive = DIAL_RAD_S3


class TurntableDocument(PoseDocument):
    """Turns about its own z axis; with a rise, along a helix."""

    rate_rad_s: Rate
    rise_m_s: Speed = 0.0
    at_s: Instant = 0.0
    changes: Annotated[list[RateChange], Field(max_length=bounds.MAX_CHANGES)] = Field(default_factory=list)


class IndexerDocument(PoseDocument):
    """Moves by a step, rests, and so on."""

    exactly_one: ClassVar[tuple[Group, ...]] = (("step_rad", "step_m"),)

    step_rad: Angle | None = None
    step_m: Coordinate | None = None
    move_s: Span
    dwell_s: Duration
    start_s: Instant = 0.0


class SwingDocument(Document):
    """Swings about a pivot: yaw = yaw_rad + amplitude sin(2π t / period + phase)."""

    pivot_m: Point
    yaw_rad: Angle = 0.0
    amplitude_rad: Angle
    period_s: Span
    phase_rad: Angle = 0.0


class OscillationDocument(PoseDocument):
    """Travels to and fro along `direction` (world axes; its length does not count):
    at_m + amplitude sin(2π t / period + phase)."""

    direction: Annotated[list[Component], Field(min_length=3, max_length=3)]
    amplitude_m: Coordinate
    period_s: Span
    phase_rad: Angle = 0.0


class Keyframe(PoseDocument):
    """A pose to be passed at a time."""

    time_s: Instant


Ends = Literal["clamped", "natural", "periodic"]


def _ends(given: dict[str, Any]) -> Ends:
    """What `ends` is where it is not given."""
    return "periodic" if given.get("repeat") else "clamped"


class KeyframesDocument(Document):
    """A twice differentiable spline through poses; known from the first to the last of them, nowhere else. Or, with
    `repeat`, for ever: the last pose is the first again, and `ends` is periodic."""

    points: Annotated[list[Keyframe], Field(min_length=2, max_length=bounds.MAX_CHANGES)]
    repeat: bool = False
    ends: Ends = Field(default_factory=_ends)


class UncertaintyDocument(Document):
    """How far the frame may be from its law."""

    position_m: Distance = 0.0
    speed_m_s: Annotated[float, Field(ge=0.0, le=bounds.FAST_M_S)] = 0.0
    lateral_m: Distance = 0.0
    vertical_m: Distance = 0.0
    yaw_rad: YawError = 0.0


class FrameDocument(Document):
    """A named frame: exactly one law."""

    exactly_one: ClassVar[tuple[Group, ...]] = (
        ("fixed", "linear", "conveyor", "turntable", "indexer", "swing", "oscillation", "keyframes"),
    )

    fixed: FixedDocument | None = None
    linear: LinearDocument | None = None
    conveyor: ConveyorDocument | None = None
    turntable: TurntableDocument | None = None
    indexer: IndexerDocument | None = None
    swing: SwingDocument | None = None
    oscillation: OscillationDocument | None = None
    keyframes: KeyframesDocument | None = None
    uncertainty: UncertaintyDocument = UncertaintyDocument()
    valid_s: Interval | None = None
