"""A plan in the making: the legs to the first k control points, proved; and candidates that continue it."""

from __future__ import annotations

from dataclasses import dataclass, field

from assur.planner.arrays import FloatArray
from assur.planner.collision.rows import Rows
from assur.planner.frames.tilted import Tilt
from assur.planner.legs.branch import Branch
from assur.planner.legs.control_point import ControlPoint, control_point
from assur.planner.legs.joint import Reached, Shape
from assur.planner.legs.meeting import Meetings, meetings
from assur.planner.legs.pace import Pace
from assur.planner.legs.state import Knots, State, TimedLeg
from assur.planner.legs.tracing import lead as lead_of_trace
from assur.planner.legs.tracking import lead_time
from assur.planner.model.attachments import AT_START, Attachments, at_start
from assur.planner.model.outcome import Arrival, Leg
from assur.planner.model.phases import NOTHING_HANDLED, Handled, Phase, handled_at_start
from assur.planner.model.refusal import Refusal
from assur.planner.model.scene import Scene, Trace
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
    tracked: ControlPoint | None = None
    """The control point above which a tracking leg ended: the arm still moves with its frame."""
    paces: dict[float, Pace] = field(default_factory=dict)
    """Of joint legs, by effort: one table for all partial plans of a search."""
    lines: dict[tuple[float, Tilt | None, float, int], TimedLeg | Refusal] = field(default_factory=dict)
    """Straight legs from here by yaw and tilt of the tool, wait and mode: full turns of the meeting make no other."""
    traces: dict[Branch, Refusal] = field(default_factory=dict)
    """Why the path of a frame that stands still cannot be traced in a branch, whenever the arm comes."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A motion that can be tried: with which turn of the tool and in which branch the control point is met, by which
    shape of joint leg, and which shares of the limits tracking legs and the last leg to rest use."""

    yaw_offset: float
    branch: Branch
    shape: Shape
    tracking_effort: float = 1.0
    stop_pace: float = 1.0


@dataclass(frozen=True, eq=False)
class TimedCandidate:
    """A joint leg to the next control point, timed; what follows at the point is not known yet."""

    before: PartialPlan
    meeting: Meetings
    candidate: Candidate
    reached: Reached
    phases: tuple[Phase, ...]
    ahead: FloatArray | None = None

    @property
    def end(self) -> float:
        return self.reached.end

    @property
    def trajectory(self) -> Trajectory:
        """The leg; before it the arm stands still."""
        return self.reached.trajectory


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


def prepared(
    scene: Scene, partial: PartialPlan, yaw_offset: float, tilt: Tilt | None, modes: tuple[int, ...]
) -> Meetings | Refusal:
    """How the next control point can be met from here."""
    point, state = control_point(scene, partial.step, partial.attached, yaw_offset, tilt), partial.state
    lead = 0.0
    if isinstance(point.facts, Trace):
        lead = lead_of_trace(point)
    elif point.tracks:
        found = lead_time(scene, point, 1.0)
        if isinstance(found, Refusal):
            return found
        lead = found
    return meetings(scene, point, state.time, lead, modes, state.q)


def paced(scene: Scene, partial: PartialPlan, effort: float) -> Pace:
    """The pace of joint legs of this effort; made once a search."""
    if effort not in partial.paces:
        partial.paces[effort] = Pace(scene.robot.limits, scene.robot.lift, effort)
    return partial.paces[effort]
