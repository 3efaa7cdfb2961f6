"""What a viewer plays, as a document: poses over time, meshes, curves, and what an answer says, for the eye.

Times are seconds since `start_s` of the request's clock. Arrays of numbers are packed: their shape, and their numbers,
the last index fastest, little-endian in base64.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, with_config
from typing_extensions import TypedDict

from assur.planner.model.outcome import LegKind
from assur.scenes import bounds
from assur.scenes.schema.answer import CLOSED, Number, Pair, Text, Vector

Shape = Annotated[list[Annotated[int, Field(ge=0)]], Field(min_length=1, max_length=3)]
Base64 = Annotated[str, Field(pattern="^[A-Za-z0-9+/]*={0,2}$")]
Name = Annotated[str, Field(max_length=bounds.MAX_TEXT)]
Index = Annotated[int, Field(ge=0)]
BodyKind = Literal["robot", "tool", "part", "body", "neighbour"]
StepKind = Literal["move", "follow", "trace", "pick", "place"]


@with_config(CLOSED)
class Floats(TypedDict):
    """Numbers of 32 bits."""

    shape: Shape
    float32: Base64


@with_config(CLOSED)
class Words(TypedDict):
    """Whole numbers of 16 bits, without sign."""

    shape: Shape
    uint16: Base64


@with_config(CLOSED)
class CarrierTrack(TypedDict):
    """A link or a frame: `position_m` [K][3] and `rotation` [K][4], quaternions x, y, z, w, in the world, at `time_s`
    [K]. Between two of them the position goes along a straight line and the attitude along the shorter arc, evenly;
    before the first and after the last it stands."""

    name: Name
    time_s: Floats
    position_m: Floats
    rotation: Floats


@with_config(CLOSED)
class ShownMesh(TypedDict):
    """Triangles of a shape. A vertex is at `low_m` + `vertices` [V][3] · `step_m`, in the body's frame."""

    low_m: Vector
    step_m: Vector
    vertices: Words
    faces: Words


@with_config(CLOSED)
class ShownSeat(TypedDict):
    """From `from_s` on a body is at this pose on a carrier."""

    from_s: Number
    carrier: Index
    at_m: Vector
    yaw_rad: Number


@with_config(CLOSED)
class Unknown(TypedDict):
    """How far a body may be from where it is drawn: horizontally, growing with time, and up or down."""

    horizontal_m: Number
    growth_m_s: Number
    vertical_m: Number


@with_config(CLOSED)
class ShownBody(TypedDict):
    """A body: what it is, the number of its mesh, where it is from when on, when it is taken away, and what is
    unknown of its place."""

    name: Name
    kind: BodyKind
    mesh: Index
    seats: Annotated[list[ShownSeat], Field(min_length=1)]
    gone_s: Number | None
    unknown: Unknown | None


@with_config(CLOSED)
class ShownPoint(TypedDict):
    """A control point: where the tool point is, on a carrier, when it is met; from `time_s` to `until_s`, or not."""

    name: Name
    step: Index
    kind: StepKind
    carrier: Index
    at_m: Vector
    yaw_rad: Number
    time_s: Number | None
    until_s: Number | None
    path_m: Floats | None


@with_config(CLOSED)
class ShownTool(TypedDict):
    """The tool point: where it is on its carrier, and its way in the world, `path_m` [P][3] at `time_s` [P]."""

    carrier: Index
    at_m: Vector
    yaw_rad: Number
    time_s: Floats
    path_m: Floats


@with_config(CLOSED)
class ShownLimits(TypedDict):
    """The limits of the joints, in the order of their names, from one time to another, with what is carried then."""

    from_s: Number
    to_s: Number
    lower: list[Number]
    upper: list[Number]
    velocity: list[Number]
    acceleration: list[Number]
    jerk: list[Number] | None


@with_config(CLOSED)
class ShownCurves(TypedDict):
    """Joints as their maker counts them: `joints` [T][4][n], position and three derivatives, and `tool` [T][2], speed
    and acceleration of the tool point, at `time_s` [T]. Two times are the same where something jumps."""

    names: list[Name]
    units: list[Literal["rad", "m"]]
    time_s: Floats
    joints: Floats
    tool: Floats
    knots_s: Floats
    limits: list[ShownLimits]


@with_config(CLOSED)
class ShownDistances(TypedDict):
    """The nearest pair at `time_s` [D]: its distance, what that must be, the numbers of both bodies [D][2], and the two
    points in the world [D][2][3]. Pairs that may touch do not count while they may."""

    time_s: Floats
    gap_m: Floats
    required_m: Floats
    bodies: Words
    points_m: Floats


@with_config(CLOSED)
class ShownLeg(TypedDict):
    """A part of the plan, for one step."""

    kind: Literal[tuple(str(kind) for kind in LegKind)]  # type: ignore[valid-type]
    step: int
    from_s: Number
    to_s: Number
    note: Text
    near: bool


@with_config(CLOSED)
class ShownSpan(TypedDict):
    """What is so from one time to another: what is held, or which two bodies may touch."""

    names: list[Name]
    from_s: Number
    to_s: Number


@with_config(CLOSED)
class ShownLine(TypedDict):
    """Refusals of one kind, counted."""

    reason: Text
    count: int
    detail: Text


@with_config(CLOSED)
class ShownRefusal(TypedDict):
    """Why there is no plan."""

    reason: Text
    proved: bool
    sentence: Text
    met: Pair | None
    at_s: Number | None
    helps: Text | None


@with_config(CLOSED)
class Reduced(TypedDict):
    """A body that is drawn with fewer triangles than it has: `off_m` says how far a vertex was moved at most."""

    body: Name
    triangles: int
    shown: int
    off_m: Number


@with_config(CLOSED)
class ViewDocument(TypedDict):
    """All that a viewer plays. Where nothing was planned the arm stands, and frames go on."""

    schema: Literal["assur-view/1"]
    status: Literal["planned", "not_planned"]
    candidate: bool
    start_s: Number
    lasts_s: Number
    moves: bool
    carriers: list[CarrierTrack]
    meshes: list[ShownMesh]
    bodies: list[ShownBody]
    control_points: list[ShownPoint]
    tool: ShownTool
    curves: ShownCurves | None
    distances: ShownDistances | None
    legs: list[ShownLeg]
    held: list[ShownSpan]
    contacts: list[ShownSpan]
    refusal: ShownRefusal | None
    census: list[ShownLine]
    candidates: int
    reduced: list[Reduced]
    request_digest: Text
    notice: Text
