"""Why a candidate, or a whole request, was refused: typed facts. `report.refusal_table` has their sentences.

Decisions depend on these facts, never on a sentence. Times are absolute seconds of the scene's clock, all else is SI.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal

from typing_extensions import TypedDict

from assur.planner.model.window_missed import WindowMissed


class Reason(StrEnum):
    """The kind of refusal."""

    OUT_OF_REACH = "OUT_OF_REACH"
    JOINT_LIMIT = "JOINT_LIMIT"
    NEAR_SINGULARITY = "NEAR_SINGULARITY"
    NEAR_PARALLEL_SINGULARITY = "NEAR_PARALLEL_SINGULARITY"
    """Type 2: the actuators of a closed chain no longer hold the tool. Type 1 is the one before."""
    SELF_COLLISION = "SELF_COLLISION"
    BODY_COLLISION = "BODY_COLLISION"
    START_IN_COLLISION = "START_IN_COLLISION"
    CONTROL_POINT_IN_COLLISION = "CONTROL_POINT_IN_COLLISION"
    MOTION_LIMIT = "MOTION_LIMIT"
    CARRY_LIMIT = "CARRY_LIMIT"
    LOAD_LIMIT = "LOAD_LIMIT"
    """Tool and part are heavier, or have more inertia about the wrist's axis, than the robot may carry."""
    FORBIDDEN_YAW = "FORBIDDEN_YAW"
    """The tool would be in a forbidden range of yaw, or turn through it."""
    TOLERANCE = "TOLERANCE"
    """The tool may be farther off its control point than is allowed, or is too far from the part that it takes, or a
    part from what it is put down on."""
    WINDOW_MISSED = "WINDOW_MISSED"
    LAW_ENDS = "LAW_ENDS"
    NOT_CERTIFIED = "NOT_CERTIFIED"
    TIMED_OUT = "TIMED_OUT"
    COUNT_SPENT = "COUNT_SPENT"


class Stage(StrEnum):
    """Which part of planning refused."""

    START = "start"
    CONTROL_POINT = "control point"
    WINDOW = "window"
    INVERSE = "inverse"
    TIMING = "timing"
    STRAIGHT = "straight"
    TRACKING = "tracking"
    LIMITS = "limits"
    SCREENING = "screening"
    CERTIFICATE = "certificate"
    CHECKER = "checker"


OF_CANDIDATES = frozenset(Stage) - {Stage.START, Stage.CONTROL_POINT, Stage.INVERSE, Stage.CHECKER}
"""Stages that refuse candidates, one by one."""


@dataclass(frozen=True, slots=True)
class Bodies:
    """The bodies that a refusal is about, first the robot's own or the held part."""

    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class JointName:
    """The joint that a refusal is about."""

    name: str


@dataclass(frozen=True, slots=True)
class FrameName:
    """The frame that a refusal is about."""

    name: str


Subject = Bodies | JointName | FrameName

Unit = Literal["m", "rad", "s", "1", "kg", "kg·m²", "m/s", "m/s²", "m/s³", "rad/s", "rad/s²", "rad/s³"]


def finite(value: float) -> float | None:
    """The number, or None if it is NaN or infinite."""
    return float(value) if math.isfinite(value) else None


@dataclass(frozen=True, slots=True)
class Quantity:
    """A finite number with its unit; "1" is a ratio."""

    value: float
    unit: Unit

    @staticmethod
    def of(value: float, unit: Unit) -> Quantity | None:
        """The quantity, or None where there is no number: it is NaN or infinite."""
        return Quantity(float(value), unit) if math.isfinite(value) else None


def of_joint(kind: str, value: float, order: int = 0) -> Quantity | None:
    """A position (order 0), velocity, acceleration or jerk (3) of a joint of this kind, "revolute" or "prismatic"."""
    angular: tuple[Unit, ...] = ("rad", "rad/s", "rad/s²", "rad/s³")
    linear: tuple[Unit, ...] = ("m", "m/s", "m/s²", "m/s³")
    return Quantity.of(value, (angular if kind == "revolute" else linear)[order])


PathPart = Literal["lead-in", "path", "lead-out"]


class Spot(TypedDict, total=False):
    """A place on a path, as `OnPath` has it."""

    path_m: float
    path_part: PathPart
    path_at_m: tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class OnPath:
    """Where on a path something happens (None: on no path). `path_m`: the length from its first point, m, less than 0
    on the lead-in of a trace and more than the path's length on its lead-out, which `path_part` says; `path_at_m`: the
    place of the tool point in the path's frame, m."""

    path_m: float | None = None
    path_part: PathPart | None = None
    path_at_m: tuple[float, float, float] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class OutOfReach(OnPath):
    """`mode`: the assembly mode; `every_pitch`: at no pitch of the tool; `heights`: required and possible height of
    the flange, m; `from_axis`: its distance from the arm's axis, m; `pitch`: of the tool, rad; `modes`: a straight leg
    would have to change from the first assembly mode to the second."""

    kind: Literal["out_of_reach"] = "out_of_reach"
    mode: str | None = None
    every_pitch: bool = False
    heights_m: tuple[float, float] | None = None
    from_axis_m: float | None = None
    pitch_rad: float | None = None
    modes: tuple[str, str] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class BeyondRange(OnPath):
    """JOINT_LIMIT. `value` that the joint would have, and `limit`, the end of its range that this is beyond, rad or m,
    as its maker counts it (None: not known); `mode`: the assembly mode; `above_m`: it happens so far above the point;
    `arch_top_m`: for an arch of this height."""

    kind: Literal["joint_limit"] = "joint_limit"
    mode: str | None = None
    above_m: float = 0.0
    arch_top_m: float | None = None
    value: float | None = None
    limit: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Singular(OnPath):
    """`margin` reached (None: it is crossed, or not known) and `required`; `positions`: names of the singular positions
    met; `distance_m`: how near a straight leg comes; `modes`: as in `OutOfReach`."""

    kind: Literal["singularity"] = "singularity"
    margin: float | None = None
    required: float | None = None
    mode: str | None = None
    positions: tuple[str, ...] = ()
    distance_m: float | None = None
    modes: tuple[str, str] | None = None


class Obstacle(StrEnum):
    """What prevents a motion (MOTION_LIMIT)."""

    RATE = "rate"
    """A joint would exceed its velocity, acceleration or jerk."""
    FRAME_TOO_FAST = "frame too fast"
    """... because a frame that must be tracked is too fast."""
    PATH_TOO_FAST = "path too fast"
    """... because a path in a frame is traced too fast."""
    # the others are no joint's rate; `report.refusal_table` has each in words
    NOT_SMOOTH = "not smooth"
    NO_PATH_LAW = "no path law"
    NO_PROFILE = "no profile"
    NO_SUCH_DURATION = "no such duration"
    NO_ARCH = "no arch"
    STOPS_AT_VIA = "stops at via"
    STRAIGHT_FROM_MOTION = "straight from motion"
    POINT_TOO_FAST = "point too fast"
    OTHER_FRAME = "other frame"
    OTHER_MODE = "other mode"
    NO_PATH = "no path"
    PROCESS_SPEED = "process speed"


Rate = Literal["velocity", "acceleration", "jerk"]
RATES: tuple[Rate, Rate, Rate] = ("velocity", "acceleration", "jerk")


@dataclass(frozen=True, slots=True, kw_only=True)
class MotionLimit(OnPath):
    """`rate`: which limit of the joint is exceeded, where that is known; `value` that the joint would have of it, and
    the `limit`, both without a sign, rad or m per s, s² or s³; `frame`: which it would have to track; `speed_m_s`: with
    which a path would be traced."""

    kind: Literal["motion_limit"] = "motion_limit"
    obstacle: Obstacle
    rate: Rate | None = None
    mode: str | None = None
    frame: str | None = None
    value: float | None = None
    limit: float | None = None
    speed_m_s: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Overshoot:
    """JOINT_LIMIT or MOTION_LIMIT at the start: the joint keeps its limits there, and exceeds one however hard it
    brakes. `rate`: velocity, or None for the range; `value` that it reaches at least and the `limit`: a velocity
    without a sign, or a position as its maker counts it, rad or m (and per s); `after_s`: how long after the start."""

    kind: Literal["overshoot"] = "overshoot"
    rate: Literal["velocity"] | None
    value: float
    limit: float
    after_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class AccelerationTime:
    """MOTION_LIMIT where the acceleration time is given: what it would need of the joint, and the
    joint's limit, rad/s² or m/s²; `enough_s`: an acceleration time that would do, where one is known."""

    kind: Literal["acceleration_time"] = "acceleration_time"
    given_s: float
    needed: float
    limit: float
    enough_s: float | None = None


Rule = Literal["near", "travel", "exception", "contact"]
"""What says how far two bodies must stay apart: the clearance of approach, follow and depart, or that elsewhere; an
exception that names them; or that they may touch."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Separation:
    """How near two bodies come: `gap_m` (negative: how deep, at most; None: not known) where `required_m` is
    required; both are None where time ran out before they were known. `required_m` is `clearance_m`, which `rule` says,
    and the uncertainty of where the two are."""

    kind: Literal["separation"] = "separation"
    touching: bool
    gap_m: float | None
    required_m: float | None
    rule: Rule | None = None
    clearance_m: float | None = None
    end: Literal["approach", "depart"] | None = None
    straight_m: float | None = None
    least_m: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Enclosed:
    """The first body is inside the second, a hollow mesh."""

    kind: Literal["enclosed"] = "enclosed"


@dataclass(frozen=True, slots=True, kw_only=True)
class Carrying:
    """The held part would be accelerated with `acceleration`, m/s², where `limit` is allowed."""

    kind: Literal["carrying"] = "carrying"
    acceleration: float
    limit: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Overload:
    """LOAD_LIMIT. `value` of the load, the tool's share of it and the part's (`part` None: the tool alone), where
    `limit` is allowed by `of`: the maximum load, kg, the last mass of a given table, kg, or the greatest inertia about
    the wrist's axis, kg·m²."""

    kind: Literal["overload"] = "overload"
    of: Literal["max_load", "table", "max_inertia"]
    value: float
    limit: float
    tool: float
    part: str | None = None
    part_value: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ForbiddenYaw:
    """The tool would have the yaw `yaw_rad` in the world, where the range from `first_rad` counter-clockwise to
    `last_rad` is forbidden; `on_the_way`: not there, but it would have to turn through the range. `lag_rad`: by how
    much the range counts wider at both ends, for joints that lag."""

    kind: Literal["forbidden_yaw"] = "forbidden_yaw"
    first_rad: float
    last_rad: float
    yaw_rad: float
    lag_rad: float = 0.0
    on_the_way: bool = False
    mode: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LawEnds:
    """A frame's motion is known on `known_s`, s (None: which frame, is not known; None for an end: for ever), and
    needed at `needed_s`. `tracked_s`: for so long a control point must be tracked in the frame, s, until `needed_s` at
    the earliest (None: it is not for a control point that it is needed); `on_arrival`: the arm comes no sooner."""

    kind: Literal["law_ends"] = "law_ends"
    known_s: tuple[float | None, float | None] | None = None
    needed_s: float
    tracked_s: float | None = None
    on_arrival: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Inaccurate:
    """The tool may be `position_m` and `yaw_rad` off its control point, where `allowed_m` and `allowed_rad` are allowed
    (None: any); `cause` contributes most, `most` of the quantity that is too large."""

    kind: Literal["inaccurate"] = "inaccurate"
    position_m: float
    yaw_rad: float
    allowed_m: float | None
    allowed_rad: float | None
    cause: str
    most: float


@dataclass(frozen=True, slots=True, kw_only=True)
class NotTouching:
    """TOLERANCE of a grip or a support: the tool is `distance_m` from the part that it takes (`grip`), or a part from
    what it is put down on (`support`), where `allowed_m` are allowed."""

    kind: Literal["not_touching"] = "not_touching"
    of: Literal["grip", "support"]
    distance_m: float
    allowed_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Corrected:
    """With a belt correction the tool may be shifted by `shift_m`: a joint would go beyond its range, or the arm come
    to where it is singular."""

    kind: Literal["corrected"] = "corrected"
    shift_m: float
    joint: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Refuted:
    """The checker refused the plan: the code of its first finding, what it says, and where."""

    kind: Literal["refuted"] = "refuted"
    code: str
    what: str
    where: str


Facts = (
    OutOfReach
    | BeyondRange
    | Singular
    | MotionLimit
    | Overshoot
    | AccelerationTime
    | Separation
    | Enclosed
    | Carrying
    | Corrected
    | ForbiddenYaw
    | Inaccurate
    | NotTouching
    | Overload
    | WindowMissed
    | LawEnds
    | Refuted
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Refusal:
    """One candidate's end: which stage refused it at which step, why, what it is about, when, by how much.

    `amount`: what was missing or too much, positive; None where there is no number.
    """

    stage: Stage
    reason: Reason
    step: int
    subject: Subject | None = None
    interval: tuple[float, float] | None = None
    amount: Quantity | None = None
    facts: Facts

    @property
    def bodies(self) -> tuple[str, ...]:
        """Names of the bodies that it is about; none where it is about something else."""
        return self.subject.names if isinstance(self.subject, Bodies) else ()

    @property
    def missing(self) -> float:
        """The amount as a number, in its unit; infinite where there is none."""
        return math.inf if self.amount is None else self.amount.value

    @property
    def joint(self) -> str | None:
        return self.subject.name if isinstance(self.subject, JointName) else None

    @property
    def frame(self) -> str | None:
        return self.subject.name if isinstance(self.subject, FrameName) else None


def unmoved(stage: Stage, step: int, obstacle: Obstacle, *, interval: tuple[float, float] | None = None) -> Refusal:
    """No motion could be made: MOTION_LIMIT without a joint or a number."""
    facts = MotionLimit(obstacle=obstacle)
    return Refusal(stage=stage, reason=Reason.MOTION_LIMIT, step=step, interval=interval, facts=facts)


def out_of_reach(
    stage: Stage,
    step: int,
    *,
    short_m: float = math.nan,
    interval: tuple[float, float] | None = None,
    facts: OutOfReach | None = None,
) -> Refusal:
    """A point is `short_m` out of reach; NaN: by how much is not known."""
    return Refusal(
        stage=stage,
        reason=Reason.OUT_OF_REACH,
        step=step,
        interval=interval,
        amount=Quantity.of(short_m, "m"),
        facts=facts or OutOfReach(),
    )


def window_missed(
    stage: Stage,
    step: int,
    facts: WindowMissed,
    *,
    amount: Quantity | None = None,
    interval: tuple[float, float] | None = None,
) -> Refusal:
    """A window, or the latest end, is missed by `amount`, s or m."""
    reason = Reason.WINDOW_MISSED
    return Refusal(stage=stage, reason=reason, step=step, interval=interval, amount=amount, facts=facts)


def law_ends(
    stage: Stage,
    step: int,
    frame: str,
    known: tuple[float, float],
    needed: float,
    *,
    interval: tuple[float, float] | None = None,
    tracked: float | None = None,
    on_arrival: bool = False,
) -> Refusal:
    """The motion of a frame is known on `known`, s, and not at `needed`; `tracked`, `on_arrival`: as in `LawEnds`."""
    span = finite(known[0]), finite(known[1])
    return Refusal(
        stage=stage,
        reason=Reason.LAW_ENDS,
        step=step,
        subject=FrameName(frame),
        interval=interval,
        amount=Quantity.of(max(known[0] - needed, needed - known[1]), "s"),
        facts=LawEnds(known_s=span, needed_s=needed, tracked_s=tracked, on_arrival=on_arrival),
    )
