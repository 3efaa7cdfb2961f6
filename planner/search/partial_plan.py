"""A plan in the making: the legs to the first k control points, proved; and drafts of its continuation."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.rows import Rows
from assur.planner.frames.tilted import Tilt
from assur.planner.legs.branch import Branch
from assur.planner.legs.control_point import ControlPoint, control_point
from assur.planner.legs.glued import lead_time
from assur.planner.legs.joint import Reached, Shape
from assur.planner.legs.meeting import Meetings, meetings
from assur.planner.legs.pace import Pace
from assur.planner.legs.state import Knots, State, Stretch
from assur.planner.model.attachments import AT_START, Attachments
from assur.planner.model.outcome import Arrival, Leg
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Refusal
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Chain:
    """The state after the first `step` steps, and everything that led there."""

    step: int
    state: State
    mode: int
    attached: Attachments = AT_START
    legs: tuple[Leg, ...] = ()
    arrivals: tuple[Arrival, ...] = ()
    knots: Knots | None = None
    proofs: tuple[Rows, ...] = ()
    tracked: ControlPoint | None = None
    """The control point above which a tracking leg ended: the arm still moves with its frame."""
    paces: dict[float, Pace] = field(default_factory=dict)
    """Of joint legs, by effort: one table for all chains of a search."""
    lines: dict[tuple[float, Tilt | None, float, int], Stretch | Refusal] = field(default_factory=dict)
    """Straight legs from here by yaw and tilt of the tool, wait and mode: full turns of the meeting make no other."""


@dataclass(frozen=True, eq=False)
class Sample:
    """One candidate: which yaw of a symmetric part, which branch, which shape of way, how hard the glued legs go."""

    yaw_offset: float
    branch: Branch
    shape: Shape
    glue_effort: float = 1.0
    stop_pace: float = 1.0


@dataclass(frozen=True, eq=False)
class Draft:
    """A candidate continuation of a chain by one step: timed, within limits of position, not yet known to be free."""

    chain: Chain
    sample: Sample
    stretches: tuple[Stretch, ...]
    legs: tuple[Leg, ...]
    arrival: Arrival
    knots: Knots
    trajectory: Trajectory
    after: Chain
    phases: tuple[Phase, ...]

    @property
    def end(self) -> float:
        return float(self.knots.time[-1])

    def at(self, t: FloatArray) -> FloatArray:
        """q (T, n) at times t, the arm standing still before and after."""
        return self.trajectory.evaluate(np.clip(t, self.trajectory.start, self.trajectory.end))


def prepared(
    scene: Scene, chain: Chain, yaw_offset: float, tilt: Tilt | None, modes: tuple[int, ...]
) -> Meetings | Refusal:
    """How the next control point can be met from this chain."""
    point = control_point(scene, chain.step, chain.attached, yaw_offset, tilt)
    lead = lead_time(scene, point, 1.0) if point.tracks else 0.0
    return lead if isinstance(lead, Refusal) else meetings(scene, point, chain.state.time, lead, modes, chain.state.q)


def paced(scene: Scene, chain: Chain, effort: float) -> Pace:
    """The pace of joint legs of this effort; made once a search."""
    if effort not in chain.paces:
        chain.paces[effort] = Pace(scene.robot.limits, scene.robot.lift, effort)
    return chain.paces[effort]


@dataclass(frozen=True, eq=False)
class Outline:
    """A joint leg to the next control point, timed; only the way there is known, as a function of time."""

    chain: Chain
    meeting: Meetings
    sample: Sample
    reached: Reached
    phases: tuple[Phase, ...]
    ahead: FloatArray | None = None

    @property
    def end(self) -> float:
        return self.reached.end

    def at(self, t: FloatArray) -> FloatArray:
        """q (T, n) at times t."""
        return self.reached.at(t)


def initial(scene: Scene) -> Chain:
    """The chain of no steps."""
    start = scene.start
    mode = int(scene.robot.mode_of(start.q))
    return Chain(0, State(start.time, start.q, start.qd, start.qdd), mode)
