"""A plan in the making: the legs to the first k control points, proved; and candidates that continue it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from assur.planner.arrays import FloatArray
from assur.planner.collision.rows import Rows
from assur.planner.frames.tilted import Tilt
from assur.planner.legs.branch import Branch
from assur.planner.legs.control_point import ControlPoint, control_point
from assur.planner.legs.joint import Shape
from assur.planner.legs.meeting import Meetings, meetings
from assur.planner.legs.overlap import entering
from assur.planner.legs.pace import Pace
from assur.planner.legs.paths.tracing import lead as lead_of_trace
from assur.planner.legs.state import Knots, State, TimedLeg
from assur.planner.legs.tool_motion import lift_most
from assur.planner.legs.tracking import lead_time
from assur.planner.model.attachments import AT_START, Attachments, at_start
from assur.planner.model.outcome import Arrival, Leg, LegKind
from assur.planner.model.phases import NOTHING_HANDLED, Handled, Phase, handled_at_start, on_way
from assur.planner.model.refusal import Refusal
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
    handled: Handled = NOTHING_HANDLED
    legs: tuple[Leg, ...] = ()
    arrivals: tuple[Arrival, ...] = ()
    knots: Knots | None = None
    proofs: tuple[Rows, ...] = ()
    wrist: float = 0.0
    """By how much the wrist has turned so far, there and back counted both, rad; 0 for an arm without one."""
    rises: float = 0.0
    """How far, m, the lift goes on before it could stop, behind a depart that it did not stop at."""
    stops: bool = False
    """Whether the candidate that led here was to stop (`Candidate.stops`)."""
    tracked: ControlPoint | None = None
    """The control point above which a tracking leg ended: the arm still moves with its frame."""
    paces: dict[tuple[float, float, Limits, bool, bool], Pace] = field(default_factory=dict)
    """Of joint legs (`paced`): one table for all partial plans of a search."""
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
class TimedCandidate:
    """A joint leg to the next control point, timed; before it the arm stands still, and what follows at the point is
    not known yet."""

    before: PartialPlan
    candidate: Candidate
    trajectory: Trajectory
    phases: tuple[Phase, ...]
    ahead: FloatArray | None = None

    @property
    def end(self) -> float:
        return self.trajectory.end

    @property
    def standing(self) -> bool:
        """Whether the point may be met at any time."""
        return self.candidate.branch.still


@dataclass(frozen=True, eq=False)
class Extension:
    """The whole motion that continues a partial plan to its next control point, within limits; `after`: the partial
    plan that it leads to once it is proved."""

    before: PartialPlan
    candidate: Candidate
    trajectory: Trajectory
    phases: tuple[Phase, ...]
    after: PartialPlan

    @property
    def end(self) -> float:
        return self.trajectory.end


def initial(scene: Scene) -> PartialPlan:
    """The partial plan of no steps."""
    start = scene.start
    state = State(start.time, start.q, start.qd, start.qdd)
    return PartialPlan(0, state, int(scene.robot.mode_of(start.q)), at_start(scene), handled_at_start(scene))


def can_wait(scene: Scene, partial: PartialPlan) -> bool:
    """Whether the arm stands and may stand on: where a via is flown by it may not, even if it rests there for an
    instant as all its joints turn round."""
    before = scene.task[partial.step - 1] if partial.step > 0 else None
    flown_by = before is not None and before.via and before.leg == "joint"
    return partial.state.resting and not flown_by


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


def paced(scene: Scene, partial: PartialPlan, shape: Shape, point: ControlPoint) -> Pace:
    """The pace of joint legs of this shape to a point, with what the gripper holds; made once a search. Where the lift
    moves at an end it has to go on as it has begun: it has all of its limits then."""
    whole = partial.rises > 0.0 or point.entry is not None
    carried, limits = partial.attached.held is not None, partial.attached.limits(scene)
    key = shape.effort, shape.pull, limits, whole, carried
    if key not in partial.paces:
        most = lift_most(scene, carried=carried)
        partial.paces[key] = Pace(limits, scene.robot.lift, shape.effort, 1.0 if whole else None, most, shape.pull)
    return partial.paces[key]
