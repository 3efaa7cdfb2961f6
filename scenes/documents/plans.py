"""A plan as a document, for the checker: the answer that it came in, of which only the plan is looked at."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from assur.scenes import bounds
from assur.scenes.documents.model import Angle, Document, Instant, Point
from assur.scenes.documents.robots import TrajectoryDocument

Number = Annotated[float, Field(ge=-1e300, le=1e300)]
Reals = Annotated[list[Number], Field(max_length=bounds.MAX_ROWS)]
Indices = Annotated[list[Annotated[int, Field(ge=-1, le=2**31)]], Field(max_length=bounds.MAX_ROWS)]
Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]
Text = Annotated[str, Field(max_length=bounds.MAX_TEXT)]


class LegDocument(Document):
    """A stretch of the plan; `step` counts from 0."""

    kind: Literal["WAIT", "MOVE", "ARCH", "APPROACH", "FOLLOW", "DEPART"]
    step: Annotated[int, Field(ge=-1, le=bounds.MAX_STEPS)]
    from_s: Instant
    to_s: Instant
    note: Text


class MissedDocument(Document):
    """By how much a parabolic blend misses its pose: the joints, as in the trajectory, and the tool point."""

    joints: Annotated[list[Number], Field(min_length=1, max_length=bounds.MAX_JOINTS)]
    distance_m: Number


class ArrivalDocument(Document):
    """The tool point met a control point."""

    nullable: ClassVar[bool] = True

    control_point: Text
    step: Annotated[int, Field(ge=0, le=bounds.MAX_STEPS)]
    time_s: Instant
    until_s: Instant
    at_m: Point
    yaw_rad: Angle
    yaw_offset_rad: Angle
    matched: bool
    along_m: Number | None
    window_left_s: Number | None
    pitch_rad: Angle | None = None
    roll_rad: Angle | None = None
    missed_by: MissedDocument | None = None


class CertificateDocument(Document):
    """The proof in columns; a second body of -1 is none: the row is of the first alone."""

    digest: Text
    rows: Annotated[int, Field(ge=0, le=bounds.MAX_ROWS)]
    covers: Annotated[list[Text], Field(max_length=16)]
    names: Annotated[list[Text], Field(max_length=8 * bounds.MAX_BODIES)]
    t0_s: Reals
    t1_s: Reals
    first: Indices
    first_piece: Indices
    second: Indices
    second_piece: Indices
    normal: Annotated[list[Vector], Field(max_length=bounds.MAX_ROWS)]


class PlanDocument(Document):
    """A planned answer. What is not checked may be left out, and is not looked at; the durations may be left out."""

    schema_: Literal["assur/1"] = Field(alias="schema")
    status: Literal["planned"]
    trajectory: TrajectoryDocument
    legs: Annotated[list[LegDocument], Field(max_length=8 * bounds.MAX_STEPS)]
    arrivals: Annotated[list[ArrivalDocument], Field(max_length=bounds.MAX_STEPS)]
    certificate: CertificateDocument
    request_digest: Text | None = None
    duration_s: Number | None = None
    start_s: Number | None = None
    lower_bound_s: Number | None = None
    contacts: Any = 0
    margins: Any = 0
    census: Any = 0
    assumptions: Any = 0
    seed: Any = 0
    elapsed_s: Any = 0
    first_s: Any = 0
    cut_by_clock: Any = 0
    notice: Any = 0
