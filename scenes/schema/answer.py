"""The answer and the verdict as documents. One description: what is written, what is read again, and the schema.

`assur.scenes.answer_facts` writes and reads the planner's facts by these forms. Numbers are SI, poses are in the world,
joint values are in the maker's convention, and null stands for a number that there is not. Of an answer that is read
again only `CheckedPlan` is judged: what the checker does not evaluate may be left out (`partial`).
"""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any, Literal, NotRequired, Required, get_args

from pydantic import ConfigDict, Field, with_config
from typing_extensions import TypedDict, get_type_hints

from assur.planner.model.arrival_error import Cause
from assur.planner.model.input_warning import WarningKind
from assur.planner.model.outcome import (
    Course,
)
from assur.planner.model.refusal import Facts, Reason, Stage, Unit
from assur.planner.model.witness import Meeting, Obstruction, Witness
from assur.scenes import bounds
from assur.scenes.schema.described import describe
from assur.scenes.schema.model import Angle, Point, Strength

CLOSED = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, json_schema_extra=describe)

FACTS: tuple[type, ...] = (*get_args(Facts), *get_args(Witness), Obstruction, Meeting)
"""Dataclasses within answers. A configuration of their own would change how they are read: `facts_described` describes
them in a schema that is made."""
Schema = Literal["assur/1"]
Number = Annotated[float, Field(ge=-1e300, le=1e300)]
Text = Annotated[str, Field(max_length=bounds.MAX_TEXT)]
Step = Annotated[int, Field(ge=-1, le=bounds.MAX_STEPS)]
"""Index of a step of the task, from 0; -1 where it is about none."""
Interval = Annotated[list[Number | None], Field(min_length=2, max_length=2)]
Pair = Annotated[list[Text], Field(min_length=2, max_length=2)]
Row = Annotated[list[Strength], Field(min_length=1, max_length=bounds.MAX_JOINTS)]
Rows = Annotated[list[Row], Field(min_length=2, max_length=bounds.MAX_KNOTS)]
Reals = Annotated[list[Number], Field(max_length=bounds.MAX_ROWS)]
Indices = Annotated[list[Annotated[int, Field(ge=-1, le=2**31)]], Field(max_length=bounds.MAX_ROWS)]
Vector = Annotated[list[Number], Field(min_length=3, max_length=3)]

Instant = Annotated[float, Field(ge=-bounds.PLAN_S, le=bounds.PLAN_S)]


@with_config(CLOSED)
class Trajectory(TypedDict):
    """Knots of a quintic Hermite spline."""

    joint_names: Annotated[list[str], Field(min_length=1, max_length=bounds.MAX_JOINTS)]
    joint_units: Annotated[list[Literal["rad", "m"]], Field(min_length=1, max_length=bounds.MAX_JOINTS)]
    time_s: Annotated[list[Instant], Field(min_length=2, max_length=bounds.MAX_KNOTS)]
    position: Rows
    velocity: Rows
    acceleration: Rows
    acceleration_jumps: NotRequired[bool]


@with_config(CLOSED)
class Route(TypedDict):
    """How a move goes or why the arm waits."""

    course: Annotated[Course, Field(strict=False)]
    vias: Annotated[int, Field(ge=0, le=2**31)]
    after_wait: bool
    later: bool


@with_config(CLOSED)
class Leg(TypedDict):
    """A part of the plan that serves one step."""

    kind: Literal["WAIT", "MOVE", "ARCH", "APPROACH", "FOLLOW", "DEPART"]
    step: Step
    from_s: Instant
    to_s: Instant
    note: NotRequired[Text]
    route: NotRequired[Route | None]


@with_config(CLOSED)
class Missed(TypedDict):
    """By how much a parabolic blend misses its pose."""

    joints: Annotated[list[Number], Field(min_length=1, max_length=bounds.MAX_JOINTS)]
    distance_m: Number


@with_config(CLOSED)
class ErrorShare(TypedDict):
    """What one cause adds to the error of an arrival at most."""

    cause: Annotated[Cause, Field(strict=False)]
    position_m: Number
    yaw_rad: Number


@with_config(CLOSED)
class Realised(TypedDict):
    """What one unknown is in a realisation."""

    what: Text
    value: Number


@with_config(CLOSED)
class ArrivalError(TypedDict):
    """How far the tool may be from the part, or the control point, at `until_s`: no realisation of what the request
    does not know is worse."""

    position_m: Number
    horizontal_m: Number
    vertical_m: Number
    yaw_rad: Number
    causes: Annotated[list[ErrorShare], Field(max_length=16)]
    worst: Annotated[list[Realised], Field(max_length=64)]


@with_config(CLOSED)
class Traced(TypedDict):
    """Facts of a path that was traced."""

    length_m: Number
    slowest_m_s: Number
    fastest_m_s: Number
    error_m: Number


@with_config(CLOSED)
class Arrival(TypedDict):
    """Where and when the tool point reaches a control point, and how. What is measured of a grip or a support is there
    only where there is something to measure."""

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
    missed_by: NotRequired[Missed | None]
    error: NotRequired[ArrivalError | None]
    joints: NotRequired[Annotated[list[Number], Field(max_length=bounds.MAX_JOINTS)]]
    mode: NotRequired[Text | None]
    trace: NotRequired[Traced | None]
    pitch_rad: NotRequired[Angle | None]
    roll_rad: NotRequired[Angle | None]
    grip_m: NotRequired[Number]
    support_m: NotRequired[Number]


@with_config(CLOSED)
class CertificateDigest(TypedDict):
    """The proof by its digest, its number of rows, and what it covers."""

    digest: Text
    rows: Annotated[int, Field(ge=0, le=bounds.MAX_ROWS)]
    covers: Annotated[list[Text], Field(max_length=16)]


@with_config(CLOSED)
class Certificate(CertificateDigest):
    """The proof in columns."""

    names: Annotated[list[Text], Field(max_length=8 * bounds.MAX_BODIES)]
    t0_s: Reals
    t1_s: Reals
    first: Indices
    first_piece: Indices
    second: Indices
    second_piece: Indices
    normal: Annotated[list[Vector], Field(max_length=bounds.MAX_ROWS)]
    shift0_s: NotRequired[Reals | None]
    shift1_s: NotRequired[Reals | None]


@with_config(CLOSED)
class Contact(TypedDict):
    """Two bodies that may touch, and when."""

    bodies: Pair
    from_s: Number
    to_s: Number


@with_config(CLOSED)
class Peak(TypedDict):
    """The largest velocity, acceleration and jerk of a joint, in SI, and as shares of its limits."""

    joint: Text
    velocity: Number
    velocity_ratio: Number
    acceleration: Number
    acceleration_ratio: Number
    jerk: Number | None
    jerk_ratio: Number | None


@with_config(CLOSED)
class Nearest(TypedDict):
    """Where the arm comes closest to another body that it may not touch."""

    gap_m: Number
    time_s: Number
    bodies: Pair
    phase: Text


@with_config(CLOSED)
class Busiest(TypedDict):
    """The leg in which the limit that binds is used most: for `at_limit_s` within a hundredth of its peak."""

    kind: Text
    step: Step
    from_s: Number
    to_s: Number
    at_limit_s: Number


@with_config(CLOSED)
class ToolPeaks(TypedDict):
    """The largest speed and acceleration of the tool point, and when."""

    speed_m_s: Number
    speed_at_s: Number
    acceleration_m_s2: Number
    acceleration_at_s: Number


@with_config(CLOSED)
class Clearances(TypedDict):
    """The smallest clearances of the plan."""

    nearest: Nearest | None
    placed: NotRequired[Nearest | None]


@with_config(CLOSED)
class Margins(Clearances, total=False):
    """What the plan leaves of its limits and distances. With `report: short`, the smallest clearances only."""

    peaks: list[Peak]
    binds: Text
    busiest: Busiest | None
    helps: Text
    tool: ToolPeaks | None
    travel_pairs: Annotated[list[Nearest], Field(max_length=64)]
    near_pairs: Annotated[list[Nearest], Field(max_length=64)]
    tool_acceleration_m_s2: Number | None
    tool_acceleration_limit_m_s2: Number | None
    singularity: Number | None
    parallel: Number | None
    jerk: Literal["limited", "unbounded"]


@with_config(CLOSED)
class Carried(TypedDict):
    """What the flange carries for a time: tool and `part` (null: the tool alone), the inertia about the last joint's
    axis (null: it turns nothing about the vertical), and the share of acceleration and jerk that the joints have."""

    part: Text | None
    mass_kg: Number
    inertia_kgm2: Number | None
    acceleration_share: Number
    from_s: Number
    to_s: Number


@with_config(CLOSED)
class LoadApplied(TypedDict):
    """What is known of what the robot may carry (null: not known), the law by which acceleration and jerk are scaled,
    and what is carried."""

    rated_kg: Number | None
    max_kg: Number | None
    max_inertia_kgm2: Number | None
    law: Literal["none", "rated_load", "table"]
    carried: Annotated[list[Carried], Field(max_length=4 * bounds.MAX_STEPS)]


class Refused(TypedDict):
    """What a refusal is about (bodies, a joint or a frame), its facts, and the same for people in `detail`."""

    stage: Stage
    reason: Reason
    step: Step
    bodies: list[Text]
    joint: Text | None
    frame: Text | None
    interval_s: Interval | None
    unit: Unit | None
    facts: Annotated[Facts, Field(discriminator="kind")]
    detail: Text


@with_config(CLOSED)
class CensusLine(Refused):
    """Refusals of one kind, counted: the least and the largest amount, and the interval that spans them all. The facts
    are those of the refusal with the least amount."""

    count: int
    least: Number | None
    most: Number | None


@with_config(CLOSED)
class Census(TypedDict):
    """What became of all candidates, most frequent refusal first."""

    candidates: int
    refused: int
    lines: list[CensusLine]


@with_config(CLOSED)
class Refusal(Refused):
    """The leading refusal."""

    amount: Number | None
    witness: NotRequired[Annotated[Witness, Field(discriminator="kind")] | None]


@with_config(CLOSED)
class Relaxation(TypedDict):
    """The first change of the request that was tried and works; `set`: the same as values by their paths (null: no
    values are that change)."""

    what: Text
    value: Text
    duration_s: Number | None
    set: NotRequired[dict[Text, Any] | None]


@with_config(CLOSED)
class InputWarning(TypedDict):
    """What of the request is probably not meant, for programs and in words."""

    kind: Annotated[WarningKind, Field(strict=False)]
    bodies: Pair
    amount_m: Number
    detail: Text


@with_config(CLOSED)
class ShownMotion(TypedDict):
    """What is read of an answer, or of a candidate in it, by those who show how it moves."""

    trajectory: Trajectory
    legs: Annotated[list[Leg], Field(max_length=8 * bounds.MAX_STEPS)]
    arrivals: Annotated[list[Arrival], Field(max_length=bounds.MAX_STEPS)]


class _Motion(ShownMotion):
    schema: Schema
    status: Literal["planned"]


class _Common(TypedDict):
    census: Census
    assumptions: list[Text]
    warnings: NotRequired[list[InputWarning]]
    seed: int
    elapsed_s: Number
    cut_by_clock: bool
    request_digest: Text
    notice: Text


class PlannedMotion(_Motion):
    """What an answer says of the motion that is planned."""

    duration_s: Number
    start_s: Number


@with_config(CLOSED)
class PlannedAnswer(PlannedMotion, _Common):
    """A plan, proved against the model."""

    certificate: Certificate | CertificateDigest
    contacts: list[Contact]
    margins: NotRequired[Margins]
    load: LoadApplied
    lower_bound_s: NotRequired[Number | None]
    first_s: Number | None


@with_config(CLOSED)
class BestCandidate(ShownMotion):
    """The candidate that came furthest, which is no plan and may end before the task does: `bodies` are nearer at
    `at_s` than required; null: it was refused for something else, or is a proved beginning that nothing continues."""

    at_s: Number | None
    bodies: Pair | None
    gap_m: Number | None
    required_m: Number | None


@with_config(CLOSED)
class NotPlannedAnswer(_Common):
    """No plan, and why there is none."""

    schema: Schema
    status: Literal["not_planned"]
    reason: Reason
    proved: bool
    sentence: Text
    refusal: Refusal | None
    relaxation: Relaxation | None
    tried: list[Text]
    explain_budget_spent: bool
    best_candidate: NotRequired[BestCandidate | None]


Answer = Annotated[PlannedAnswer | NotPlannedAnswer, Field(discriminator="status")]


@with_config(CLOSED)
class CheckedPlan(_Motion, total=False):
    """What the checker judges of a planned answer; the durations may be left out."""

    certificate: Required[Certificate]
    duration_s: Number
    start_s: Number
    lower_bound_s: Number | None
    load: LoadApplied
    request_digest: Text


@with_config(CLOSED)
class Finding(TypedDict):
    """Something in a plan that is not right: by how much, and where."""

    code: Text
    what: Text
    amount: Number | None
    unit: Text
    where: Text


@with_config(CLOSED)
class Verdict(TypedDict):
    """What the checker says of an answer."""

    schema: Schema
    ok: bool
    findings: list[Finding]
    not_checked: list[Text]
    request_digest: Text
    notice: Text


@cache
def partial(
    form: Any,
    keys: tuple[str, ...] | None = None,
    required: tuple[str, ...] = (),
    others: tuple[tuple[str, Any], ...] = (),
) -> Any:
    """The fields `keys` of a form (None: all), and `others` in place of its own; only those `required` must be
    there."""
    hints = get_type_hints(form, include_extras=True) | dict(others)
    fields = {
        key: Required[hint] if key in required else hint for key, hint in hints.items() if keys is None or key in keys
    }
    return with_config(CLOSED)(TypedDict(form.__name__, fields, total=False))  # type: ignore[operator]


def facts_described(models: dict[str, Any]) -> None:
    """Describes the fields of facts and witnesses among the schemas of models, by their names."""
    known = {model.__name__: model for model in FACTS}
    for part in models.values():
        if part.get("title") in known:
            describe(part, known[part["title"]])
