"""A plan in the making: the legs to the first k control points, proved; and candidates that continue it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.rows import Rows
from assur.planner.collision.screening import Encounter
from assur.planner.frames.motion import Tilt
from assur.planner.legs.control_point import ControlPoint, control_point
from assur.planner.legs.joint import Shape
from assur.planner.legs.line import ScaledLimits
from assur.planner.legs.meeting import Meetings, entering, meetings
from assur.planner.legs.path_leg import lead as lead_of_trace
from assur.planner.legs.state import Branch, Knots, State, TimedLeg
from assur.planner.legs.tool_motion import lift_most
from assur.planner.legs.tracking import lead_time
from assur.planner.model.attachments import AT_START, Attachments, at_start
from assur.planner.model.outcome import Arrival, BestCandidate, Course, Leg, LegKind, Route
from assur.planner.model.phases import (
    NOTHING_HANDLED,
    GraspUncertainty,
    Phase,
    handled_at_start,
    on_way,
)
from assur.planner.model.refusal import Refusal, Separation, Stage
from assur.planner.model.scene import Scene, Trace
from assur.planner.robots.facts import Limits
from assur.planner.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class PartialPlan:
    """The state after the first `step` steps, and everything that led there."""

    step: int
    state: State
    mode: int
    attached: Attachments = AT_START
    handled: GraspUncertainty = NOTHING_HANDLED
    legs: tuple[Leg, ...] = ()
    arrivals: tuple[Arrival, ...] = ()
    knots: Knots | None = None
    trajectory: Trajectory | None = None
    """The trajectory through these knots, where it was made."""
    proofs: tuple[Rows, ...] = ()
    wrist: float = 0.0
    """By how much the wrist has turned so far, there and back counted both, rad; 0 for an arm without one."""
    rises: float = 0.0
    """How far, m, the lift goes on before it could stop, behind a depart that it did not stop at."""
    stops: bool = False
    """Whether the candidate that led here was to stop (`Candidate.stops`)."""
    waited: bool = False
    """Whether the arm has waited here until a part was gone."""
    tracked: ControlPoint | None = None
    """The control point above which a tracking leg ended: the arm still moves with its frame."""
    scaled: dict[tuple[float, float, Limits, float | None, bool], ScaledLimits] = field(default_factory=dict)
    """Of joint legs (`scaled_limits`): one table for all partial plans of a search."""
    lines: dict[tuple[float, Tilt | None, float, int], TimedLeg | Refusal] = field(default_factory=dict)
    """Straight legs from here by yaw and tilt of the tool, wait and mode: full turns of the meeting make no other."""

    def way(self, scene: Scene, until: float) -> Phase:
        """The phase of a motion from here to the next control point that ends at `until`, s."""
        kept, on = (LegKind.MOVE, self.step, self.attached), on_way(scene, self.step)
        return Phase(self.state.time, until, *kept, corrected=on, handled=self.handled)


@dataclass(frozen=True, eq=False)
class Option:
    """A branch in which a control point can be met, and the least duration until one of its times, s."""

    meeting: Meetings
    branch: Branch
    least: float = 0.0


@dataclass(frozen=True, eq=False)
class Candidate:
    """A motion that can be tried: the option in which the control point is met, the shape of the joint leg to it, and
    which shares of the limits tracking legs and the last leg to rest use. `stops`: whether the tool stops behind the
    depart although it need not: then the arm can wait there."""

    option: Option
    shape: Shape
    tracking_effort: float = 1.0
    stop_pace: float = 1.0
    stops: bool = False

    @property
    def branch(self) -> Branch:
        return self.option.branch

    @property
    def point(self) -> ControlPoint:
        """The control point that it leads to."""
        return self.option.meeting.point


@dataclass(frozen=True, eq=False)
class _Timed:
    """A motion from a partial plan by a candidate, in phases."""

    before: PartialPlan
    candidate: Candidate
    trajectory: Trajectory
    phases: tuple[Phase, ...]

    @property
    def end(self) -> float:
        return self.trajectory.end


@dataclass(frozen=True, eq=False)
class TimedCandidate(_Timed):
    """A joint leg to the next control point, timed; before it the arm stands still, and what follows at the point is
    not known yet."""

    ahead: FloatArray | None = None

    @property
    def standing(self) -> bool:
        """Whether the point may be met at any time."""
        return self.candidate.branch.still


@dataclass(frozen=True, eq=False)
class Extension(_Timed):
    """The whole motion that continues a partial plan to its next control point, within limits; `after`: the partial
    plan that it leads to once it is proved."""

    after: PartialPlan


TimedMotion = TimedCandidate | Extension


def initial(scene: Scene) -> PartialPlan:
    """The partial plan of no steps."""
    start = scene.start
    state = State(start.time, start.q, start.qd, start.qdd)
    return PartialPlan(0, state, int(scene.robot.mode_of(start.q)), at_start(scene), handled_at_start(scene))


def can_wait(scene: Scene, partial: PartialPlan) -> bool:
    """Whether the arm stands and may stand on: where a via is flown by it may not, even if it rests there for an
    instant as all its joints turn round. It waits once between two steps."""
    return partial.state.resting and not flown_by(scene, partial) and not partial.waited


def flown_by(scene: Scene, partial: PartialPlan) -> bool:
    """Whether a partial plan ends at a via that is flown by."""
    before = scene.task[partial.step - 1] if partial.step > 0 else None
    return before is not None and before.via and before.leg == "joint"


def prepared(
    scene: Scene, partial: PartialPlan, yaw_offset: float, tilt: Tilt | None, modes: tuple[int, ...]
) -> list[Meetings | Refusal]:
    """How the next control point can be met from here: first without a stop above it, where there is such a way."""
    point, state = control_point(scene, partial.step, partial.attached, yaw_offset, tilt), partial.state
    moving, found = entering(scene, point, state.q), list[Meetings | Refusal]()
    for entry in (None,) if moving is None else (moving, None):
        entered = point if entry is None else replace(point, entry=entry)
        lead: float | Refusal = 0.0
        if isinstance(point.facts, Trace):
            lead = lead_of_trace(point)
        elif point.tracks:
            lead = lead_time(scene, entered, 1.0)
        if isinstance(lead, Refusal):
            found.append(lead)
        else:
            found.append(meetings(scene, entered, state.time, lead, modes, state.q))
    return found


def scaled_limits(scene: Scene, partial: PartialPlan, shape: Shape, point: ControlPoint) -> ScaledLimits:
    """The limits of joint legs of this shape to a point, with what the gripper holds; made once a search. Where the
    lift moves at an end it has to go on as it has begun: it has all of its limits then."""
    lift_effort = 1.0 if partial.rises > 0.0 or point.entry is not None else None
    carried, limits = partial.attached.held is not None, partial.attached.limits(scene)
    key = shape.effort, shape.pull, limits, lift_effort, carried
    if key not in partial.scaled:
        most = lift_most(scene, carried=carried)
        partial.scaled[key] = ScaledLimits(limits, scene.robot.lift, shape.effort, lift_effort, most, shape.pull)
    return partial.scaled[key]


# The candidate that came furthest, of a search that finds no plan: what stopped it is why there is none, and it is what
# is shown of a refusal.

MOST_KNOTS = 1_000
"""Most knots of the reported motion of a refusal, about 100 kB of an answer: a follow of many minutes has 20,000."""


ORDER = tuple(Stage)
"""Stages, in the order in which a candidate comes to them."""


@dataclass(frozen=True, eq=False)
class RefusedMotion:
    """A motion that was timed, and why it was refused: for bodies that are too near at one instant, the deepest first,
    or for something else. It refers to what the search has anyway: keeping one costs nothing."""

    motion: TimedMotion
    encounters: tuple[Encounter, ...]

    @property
    def rank(self) -> tuple[int, bool, bool, int, float]:
        """The greater the further it came: by steps, then by stages, then by how little is missing.

        The leg to a point is screened before what follows at the point is timed, and that before all of it is screened.
        """
        refusal, whole = self.encounters[0].refusal, isinstance(self.motion, Extension)
        free = whole or refusal.stage is not Stage.SCREENING
        return self.motion.before.step, free, whole, ORDER.index(refusal.stage), -refusal.missing


def best_candidate(scene: Scene, refused: RefusedMotion | None, proved: PartialPlan | None) -> BestCandidate | None:
    """What came furthest: a motion that was refused, behind what was proved before it; or, where there is none, the
    longest partial plan that was `proved`. None: there is neither."""
    if refused is not None:
        return _of_motion(scene, refused.motion, refused.encounters[0].confirmed())
    if proved is None or proved.knots is None:
        return None
    return BestCandidate(reported_motion(scene, proved.knots), proved.legs, _with_known_errors(proved.arrivals))


def _with_known_errors(arrivals: tuple[Arrival, ...]) -> tuple[Arrival, ...]:
    """Arrivals without errors that have no bound: so large a lag may take the arm where it cannot be."""
    found = list[Arrival]()
    for each in arrivals:
        if each.error is not None:
            lengths = each.error.position_m, each.error.within.position_m, each.error.within.vertical_m
            if not math.isfinite(sum(lengths) + each.error.within.yaw_rad):
                each = replace(each, error=None)
        found.append(each)
    return tuple(found)


def _of_motion(scene: Scene, motion: TimedMotion, refusal: Refusal) -> BestCandidate:
    facts, interval = refusal.facts, refusal.interval
    if isinstance(motion, Extension):
        knots, legs, arrivals = motion.after.knots, motion.after.legs, motion.after.arrivals
    else:
        knots, legs, arrivals = None, *_leg_of(motion)
    if knots is None:
        own, before = Knots.of(motion.trajectory), motion.before
        if own.begin > before.state.time:
            own = Knots.standing(before.state, own.begin).then(own)
        knots = own if before.knots is None else before.knots.then(own)
    met = isinstance(facts, Separation)
    bodies = refusal.bodies
    return BestCandidate(
        trajectory=reported_motion(scene, knots),
        legs=legs,
        arrivals=_with_known_errors(arrivals),
        at=interval[0] if met and interval is not None else None,
        bodies=(bodies[0], bodies[1]) if met and len(bodies) == 2 else None,
        gap_m=facts.gap_m if isinstance(facts, Separation) else None,
        required_m=facts.required_m if isinstance(facts, Separation) else None,
    )


def _leg_of(motion: TimedMotion) -> tuple[tuple[Leg, ...], tuple[Arrival, ...]]:
    """The legs up to a control point that a timed candidate comes to, and the arrivals before it."""
    before, shape, step = motion.before, motion.candidate.shape, motion.before.step
    begin, end = motion.trajectory.start, motion.trajectory.end
    legs = before.legs
    if begin > before.state.time:
        legs += (Leg(LegKind.WAIT, step, before.state.time, begin, Route(Course.FOR_BODIES)),)
    kind = LegKind.ARCH if shape.form else LegKind.MOVE
    return (*legs, Leg(kind, step, begin, end, shape.route)), before.arrivals


def reported_motion(scene: Scene, knots: Knots) -> Trajectory:
    """The motion through knots, or, where they are more than `MOST_KNOTS`, through so many of them: it is
    reported for help and nothing is proved of it."""
    table = knots.table
    if len(table) > MOST_KNOTS:
        table = table[np.linspace(0, len(table) - 1, MOST_KNOTS).round().astype(np.int64)]
    return Trajectory.of_knots(table, jumps=not scene.options.jerk_limited)
