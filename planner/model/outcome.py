"""What a request comes to: a plan with its proof, or the precise reason why there is none.

Facts only. Times are absolute seconds of the scene's clock, everything else is SI.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.errors import FaultError, InputError
from assur.planner.frames.motion import Pose
from assur.planner.model.arrival_error import ArrivalError
from assur.planner.model.input_warning import InputWarning
from assur.planner.model.refusal import Reason, Refusal
from assur.planner.model.witness import Witness
from assur.planner.trajectory import Trajectory

if TYPE_CHECKING:
    from assur.planner.model.scene import Scene


class LegKind(StrEnum):
    """The legs of a plan, in the words of the shop."""

    WAIT = "WAIT"
    MOVE = "MOVE"
    ARCH = "ARCH"
    APPROACH = "APPROACH"
    FOLLOW = "FOLLOW"
    DEPART = "DEPART"


TRACKING = frozenset({LegKind.APPROACH, LegKind.FOLLOW, LegKind.DEPART})
"""Kinds of leg during which the tool is guided along the frame of its control point."""


class Course(StrEnum):
    """How a move goes, or why the arm waits."""

    DIRECT = "direct"
    """From joint position to joint position, also through via points that the planner chose."""
    ARCH = "arch"
    """Up, over and down, in one motion."""
    STRAIGHT = "straight"
    PATH = "path"
    """Along a path of lines, arcs and splines."""
    ROUNDED = "blends"
    """Straight for the joints from pose to pose, each pose passed at a distance by a parabola (parabolic blends)."""
    TO_REST = "to rest"
    """From the velocity of its last point to a stop, where the plan ends."""
    FOR_BODIES = "for bodies"
    """A wait until bodies have passed."""
    FOR_POINT = "for point"
    """A wait until the control point can be met."""


@dataclass(frozen=True, slots=True)
class Route:
    """How a leg goes: its course, the number of via points that the planner chose, whether it begins after a wait and
    meets its point later than it could."""

    course: Course
    vias: int = 0
    after_wait: bool = False
    later: bool = False


@dataclass(frozen=True, slots=True)
class Leg:
    """The part [t0, t1] of the plan that serves step number `step`; `route`: how a move goes or why the arm waits.

    Raises `InputError` for what is no kind, no number of a step, no finite time or no route.
    """

    kind: LegKind
    step: int
    t0: float
    t1: float
    route: Route | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.kind, LegKind):
            raise InputError("leg.kind", self.kind, f"one of {', '.join(LegKind)}")
        _step("leg.step", self.step)
        _finite("leg.t0", self.t0)
        _finite("leg.t1", self.t1)
        if not isinstance(self.route, Route | None):
            raise InputError("leg.route", self.route, "a route, or none")


@dataclass(frozen=True, slots=True)
class Missed:
    """By how much a via that is passed at a distance is missed at its time: each joint, rad or m in the robot's order,
    and the tool point, m. Raises `InputError` for what is not a finite number."""

    joints: tuple[float, ...]
    distance_m: float

    def __post_init__(self) -> None:
        if not isinstance(self.joints, tuple):
            raise InputError("missed_by.joints", self.joints, "a tuple of numbers")
        for number in (*self.joints, self.distance_m):
            _finite("missed_by", number)


@dataclass(frozen=True, slots=True)
class Traced:
    """How a path was traced: its length, m, the least and the greatest speed of the tool point in the path's frame,
    m/s, and its largest distance from where it should be at that time, m. All are bounds.

    Raises `InputError` for what is not a finite number.
    """

    length_m: float
    slowest_m_s: float
    fastest_m_s: float
    error_m: float

    def __post_init__(self) -> None:
        for name in ("length_m", "slowest_m_s", "fastest_m_s", "error_m"):
            _finite(f"arrival.trace.{name}", getattr(self, name))


@dataclass(frozen=True, slots=True)
class Arrival:
    """The tool point met a control point: `pose` of the tool point in the world at `time`.

    `along_m`: distance of the control point's frame along its conveyor (None: no conveyor); `window_left_s`: time left
    in its window; `matched`: velocity matched, too. For a follow, pick or place `time` is when tracking of the point
    begins and `until` when it ends (attach, detach); elsewhere until = time. `yaw_offset`: by how much the tool was
    turned about the part's vertical axis, where the part's symmetry (or a free yaw) leaves the choice. `pitch`, `roll`:
    with which the tool met it, rad; None for an arm that has none. `missed_by`: of a via that is missed: then `pose` is
    where the tool is at `time`, and pitch and roll are those of the pose it misses. `error`: how far the
    tool may be from the control point at `until`; None where all is known. `trace`: of a trace, whose `time` and
    `until` are those of the path's beginning and end; it is `matched` if the tool then has the process speed in the
    frame. `grip_m`: of a pick, how far the tool's bodies are from the part at `until`; `support_m`: of a place, how far
    the part is from the nearest body that it may rest on; upper values, 0 where they touch, None where there is nothing
    to measure.
    Raises `InputError` for what is no number of a step, no pose, no text, or not finite.
    """

    step: int
    control_point: str
    time: float
    until: float
    pose: Pose
    matched: bool
    yaw_offset: float = 0.0
    along_m: float | None = None
    window_left_s: float | None = None
    pitch: float | None = None
    roll: float | None = None
    missed_by: Missed | None = None
    error: ArrivalError | None = None
    trace: Traced | None = None
    grip_m: float | None = None
    support_m: float | None = None

    def __post_init__(self) -> None:
        _step("arrival.step", self.step)
        optional = ("along_m", "window_left_s", "pitch", "roll", "grip_m", "support_m")
        for name in ("time", "until", "yaw_offset", *optional):
            value = getattr(self, name)
            if value is not None or name in ("time", "until", "yaw_offset"):
                _finite(f"arrival.{name}", value)
        for name, kind in (
            ("control_point", str),
            ("pose", Pose),
            ("missed_by", Missed | None),
            ("error", ArrivalError | None),
            ("trace", Traced | None),
        ):
            if not isinstance(getattr(self, name), kind):
                raise InputError(f"arrival.{name}", getattr(self, name), f"{kind}")


def _step(field: str, value: object) -> None:
    """Raises `InputError` for what is no number of a step, from 0 on."""
    if not isinstance(value, int | np.integer) or isinstance(value, bool) or value < 0:
        raise InputError(field, value, "the number of a step, from 0 on")


def _finite(field: str, value: object) -> None:
    """Raises `InputError` for what is no finite number."""
    if not (isinstance(value, float | int | np.floating | np.integer) and math.isfinite(value)):
        raise InputError(field, value, "a finite number")


COLUMNS = {"t0": "f", "t1": "f", "normal": "f", "first": "i", "first_piece": "i", "second": "i", "second_piece": "i"}
"""Columns of a certificate, and whether they hold whole numbers (i)."""
SHIFTS = {"shift0": "f", "shift1": "f"}
"""Those of a certificate with bodies that may be ahead of the clock."""
COVERS = ("separation", "position", "velocity", "acceleration", "jerk")
"""What a certificate covers: separation by its rows, the limits by the exact extrema of the trajectory it is of."""


def covered(trajectory: Trajectory) -> tuple[str, ...]:
    """What the certificate of a plan covers: all but the jerk, which has no bound, where the acceleration may jump."""
    return COVERS[:-1] if trajectory.jumps else COVERS


@dataclass(frozen=True, eq=False)
class Certificate:
    """The proof: row i says that on [t0, t1] the bodies `first` and `second` stay apart along `normal`.

    Bodies are indices into `names`; a piece is the index of a convex piece of the body, -1 its bounding box (in the
    body's axes). A second of -1 is no body but the origin of the world: the row says behind which plane the first stays
    (equation C6). `shift0`, `shift1`: between which times, s, the second body is ahead of the clock (N4); None: it is
    not, in any row. `normal` (M, 3) points from the first to the second. Gaps and bounds of motion are not among the
    columns: who checks a row computes them. Equations N3 and N4 in docs/bundle.md.

    Raises `InputError` for columns of different lengths or kinds, numbers that are not finite, and names that are not
    different texts. Whether names and pieces exist is not known here.
    """

    names: tuple[str, ...]
    t0: FloatArray
    t1: FloatArray
    first: IntArray
    first_piece: IntArray
    second: IntArray
    second_piece: IntArray
    normal: FloatArray
    shift0: FloatArray | None = None
    shift1: FloatArray | None = None
    digest: str = ""
    covers: tuple[str, ...] = COVERS

    def __post_init__(self) -> None:
        given: dict[str, Any] = vars(self)
        rows = getattr(given["t0"], "shape", ())
        if (self.shift0 is None) != (self.shift1 is None):
            raise InputError("certificate.shift0", self.shift0, "both ends of shifts, or none")
        for name, kind in (COLUMNS if self.shift0 is None else COLUMNS | SHIFTS).items():
            column, shape = given[name], (*rows, 3) if name == "normal" else rows
            if not (isinstance(column, np.ndarray) and column.dtype.kind == kind and column.dtype.itemsize == 8):
                raise InputError(f"certificate.{name}", column, "an array of int64 or float64")
            if column.shape != shape or len(rows) != 1 or not (kind == "i" or np.isfinite(column).all()):
                raise InputError(f"certificate.{name}", column.shape, f"finite numbers of shape {shape}")
        names, covers = given["names"], given["covers"]
        if not (isinstance(names, tuple) and {*map(type, names)} <= {str}):
            raise InputError("certificate.names", names, "a tuple of texts")
        if len(set(names)) != len(names):
            raise InputError("certificate.names", names, "different names")
        if not (isinstance(given["digest"], str) and isinstance(covers, tuple)):
            raise InputError("certificate.covers", covers, "a tuple of texts")

    @classmethod
    def of_columns(cls, **columns: Any) -> Certificate:
        """That of columns which are right by their making, and are not validated; without a digest."""
        made = object.__new__(cls)
        vars(made).update(columns)
        return made

    def __len__(self) -> int:
        return len(self.t0)


@dataclass(frozen=True, eq=False)
class Plan:
    """What will run, and its proof. The checker needs this and the scene, nothing else.

    Raises `InputError` for parts that contradict this description.
    """

    trajectory: Trajectory
    legs: tuple[Leg, ...]
    arrivals: tuple[Arrival, ...]
    certificate: Certificate

    def __post_init__(self) -> None:
        for name, one in (("trajectory", Trajectory), ("certificate", Certificate)):
            if not isinstance(getattr(self, name), one):
                raise InputError(f"plan.{name}", getattr(self, name), f"a {one.__name__}")
        for name, each in (("legs", Leg), ("arrivals", Arrival)):
            items = getattr(self, name)
            if not (isinstance(items, tuple) and {*map(type, items)} <= {each}):
                raise InputError(f"plan.{name}", items, f"a tuple of {each.__name__}")


@dataclass(frozen=True, slots=True)
class CensusLine:
    """Refusals of one kind, counted: one of them, over the interval that spans all of them, and the greatest and the
    least amount, in the same unit. The one is that of the candidate that came furthest, where that is of this kind;
    else that with the least amount."""

    refusal: Refusal
    count: int
    most: float | None = None
    least: float | None = None


@dataclass(frozen=True, slots=True)
class Census:
    """What became of all candidates, most frequent refusal first."""

    candidates: int
    refused: int
    lines: tuple[CensusLine, ...] = ()


@dataclass(frozen=True, slots=True)
class JointPeak:
    """Peaks of one joint over the plan (exact extrema, SI) and their ratios to the limits; no jerk: it is unbounded."""

    joint: str
    velocity: float
    acceleration: float
    jerk: float | None
    velocity_ratio: float
    acceleration_ratio: float
    jerk_ratio: float | None


@dataclass(frozen=True, slots=True)
class Nearest:
    """Where the arm comes closest to something, less contacts: `gap_m` is proved not to exceed the distance of any pair
    at any time; `distance_m` is that of `bodies` at `time`, larger by 0.05 mm at most."""

    gap_m: float
    time: float
    bodies: tuple[str, str]
    phase: str
    distance_m: float


@dataclass(frozen=True, slots=True)
class Contact:
    """An allowed contact and the time for which it is allowed."""

    bodies: tuple[str, str]
    t0: float
    t1: float


@dataclass(frozen=True, slots=True)
class Busiest:
    """The part [t0, t1] of a plan, of this kind and for this step, in which the limit that binds is used most: for
    `at_limit_s` the joint, or the tool point, is within a hundredth of its peak."""

    kind: str
    step: int
    t0: float
    t1: float
    at_limit_s: float


@dataclass(frozen=True, slots=True)
class ToolPeaks:
    """The largest speed, m/s, and acceleration, m/s², of the tool point over a plan, and when, s."""

    speed: float
    speed_time: float
    acceleration: float
    acceleration_time: float


@dataclass(frozen=True, slots=True)
class Clearances:
    """The smallest clearances of a plan: `nearest` of the arm, its tool and what it holds; `placed` of parts that were
    put down, of what moves against them without the arm. None: there is nothing to keep apart."""

    nearest: Nearest | None
    placed: Nearest | None


@dataclass(frozen=True, slots=True)
class Margins(Clearances):
    """How much is left. `binds`: the joint and kind of limit that is used most; `busiest`: where; `helps`: what would
    make that part quicker; `travel_pairs`, `near_pairs`: where pairs of the arm, its tool and what it holds come
    nearest, by the clearance that counts there. `parallel`: None without a loop. `jerk`: whether it has bounds."""

    peaks: tuple[JointPeak, ...]
    binds: str
    tool_acceleration: float
    tool_acceleration_limit: float | None
    singularity: float
    parallel: float | None = None
    jerk: Literal["limited", "unbounded"] = "limited"
    busiest: Busiest | None = None
    helps: str = ""
    tool: ToolPeaks | None = None
    travel_pairs: tuple[Nearest, ...] = ()
    near_pairs: tuple[Nearest, ...] = ()


@dataclass(frozen=True, eq=False)
class Planned:
    """A plan, proved against the model. What the option `report` leaves out is None or empty."""

    plan: Plan
    reported: Clearances | None
    """With `report: full`, the margins."""
    lower_bound_s: float | None
    """A proved duration that no plan of the request beats; None: none is known."""
    census: Census
    assumptions: tuple[str, ...]
    seed: int
    elapsed_s: float
    first_s: float
    cut_by_clock: bool
    warnings: tuple[InputWarning, ...] = ()

    @property
    def margins(self) -> Margins:
        """The margins. Raises `FaultError` where `report` is not `full`."""
        if not isinstance(self.reported, Margins):
            raise FaultError("margins that the options of the request leave out")
        return self.reported


@dataclass(frozen=True, slots=True)
class Relaxation:
    """The first change of the request that was tried and works: its kind, its value in words, how long the plan then
    lasts, and the `scene` with the change."""

    what: str
    value: str
    duration_s: float
    scene: Scene = field(repr=False, compare=False)


@dataclass(frozen=True, eq=False)
class BestCandidate:
    """What of a refused search came furthest: a motion that is not a plan. It may end before the task does.

    `at`: the instant, s, at which `bodies` are nearer (`gap_m`) than they must be (`required_m`); None: it was refused
    for something else, or it is the proved beginning that no candidate goes on from.
    """

    trajectory: Trajectory
    legs: tuple[Leg, ...]
    arrivals: tuple[Arrival, ...]
    at: float | None = None
    bodies: tuple[str, str] | None = None
    gap_m: float | None = None
    required_m: float | None = None


@dataclass(frozen=True, eq=False)
class NotPlanned:
    """No plan: the leading reason, whether it is proved for all times and modes, and a sentence for an operator.

    `witness`: what proves it beside the facts of the refusal (None: those do, or it is not proved); `tried`: changes of
    the request that were tried; `explain_budget_spent`: before all of them were; `best`: the candidate that came
    furthest (None: nothing was timed).
    """

    reason: Reason
    proved: bool
    sentence: str
    refusal: Refusal | None
    census: Census
    relaxation: Relaxation | None
    tried: tuple[str, ...]
    explain_budget_spent: bool
    assumptions: tuple[str, ...]
    seed: int
    elapsed_s: float
    cut_by_clock: bool
    warnings: tuple[InputWarning, ...] = ()
    best: BestCandidate | None = None
    witness: Witness | None = None


Outcome = Planned | NotPlanned
