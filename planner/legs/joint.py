"""Joint legs: from a state of the arm to a meeting, all joints timed by Ruckig, through free vias or over an arch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels.candidates import passing_velocity
from assur.planner.legs.arched import Hop, Vertical, arch, vertical
from assur.planner.legs.branch import Branch
from assur.planner.legs.limits import beyond_limits
from assur.planner.legs.meeting import GRID_S
from assur.planner.legs.pace import Pace
from assur.planner.legs.state import State
from assur.planner.model.outcome import Course, Route
from assur.planner.model.refusal import Obstacle, Quantity, Refusal, Stage, unmoved, window_missed
from assur.planner.model.scene import Scene
from assur.planner.model.window_missed import Miss, WindowMissed
from assur.planner.timing import SHORTEST, Numbers, RawProfile, TimingRefusal, trajectory_of
from assur.planner.trajectory import Trajectory

TRIES = 12
"""Calls of Ruckig after which a rendezvous is given up: it converges in three or four."""


@dataclass(frozen=True, eq=False)
class Via:
    """A joint position (n,) that is flown by at `pace` times the mean joint velocity of the whole leg."""

    q: FloatArray
    pace: float


@dataclass(frozen=True, eq=False)
class Shape:
    """A way to go: wait first, then directly, by vias, or over an arch; `late` seconds after the earliest meeting;
    `effort`: share of the limits of acceleration (velocity by its root, jerk by its power of 3/2) that is used."""

    wait: float = 0.0
    late: float = 0.0
    vias: tuple[Via, ...] = ()
    hop: Hop | None = None
    effort: float = 1.0
    pull: float = 1.0
    """Share of the acceleration that the joints across use, velocity and jerk left as they are."""
    through: float = 0.0
    """Pace at which a via control point is flown by, in mean joint velocities of the way to the one behind it."""

    @property
    def route(self) -> Route:
        course = Course.ARCH if self.hop else Course.DIRECT
        return Route(course, len(self.vias), after_wait=self.wait > 0, later=self.late > 0)


class JointMotion:
    """The legs of one shape from one state towards one branch. `pace`: that of the shape's effort and of what the
    gripper holds; None: the gripper is empty."""

    def __init__(
        self,
        scene: Scene,
        step: int,
        state: State,
        shape: Shape,
        branch: Branch,
        ahead: FloatArray | None = None,
        pace: Pace | None = None,
    ) -> None:
        self.scene, self.step, self.state, self.shape, self.branch = scene, step, state, shape, branch
        self.ahead: list[float] | None = None if ahead is None else ahead.tolist()
        self.pace = Pace(scene.limits_with(None), scene.robot.lift, shape.effort) if pace is None else pace
        self.origin: Numbers = (state.q.tolist(), state.qd.tolist(), state.qdd.tolist())
        """Where the last leg sets out: at the arm's state, or at the last via."""
        self.prefix: list[RawProfile] = []
        self._verticals: dict[tuple[float, ...], Vertical | TimingRefusal] = {}

    def meet(self) -> Trajectory | Refusal:
        """The leg to the earliest meeting on the branch's grid that this shape reaches (or `late` seconds later). Its
        last knot is at the time of the meeting to the bit, as the control point is.

        Ruckig is asked to take exactly the time that is left: to the first grid time that a lower bound allows, and
        then to the first one that its shortest duration allows, until it fits.
        """
        failed = self._through_vias()
        if failed is not None:
            return failed
        branch, begin = self.branch, self.state.time + self.shape.wait
        if branch.still:
            return self._at_any_time(begin)
        spent = sum(profile.duration for profile in self.prefix)
        # velocity limits alone say that nothing earlier can be met; Ruckig says the rest
        least = branch.velocity_times(self.origin[0], self.pace.rates[0])
        # an arm that moves with the point already is at it now: a leg that takes no time is none
        rows = np.flatnonzero(branch.time >= begin + spent + np.maximum(least, SHORTEST))
        times = branch.time[rows]
        number, late = 0, self.shape.late
        for _ in range(TRIES):
            if not number < len(rows):
                break
            row, time = int(rows[number]), float(times[number])
            goal, left = self._goal(row), time - begin - spent
            found = None if late > 0 or left < SHORTEST else self._last(goal, left)
            if found is None or (isinstance(found, TimingRefusal) and found.reason != "too short"):
                # not asked yet, or not in exactly this time: what is possible at all?
                shortest = self._shortest(goal)
                if isinstance(shortest, TimingRefusal):
                    number = int(times.searchsorted(time + max(GRID_S, shortest.excess)))
                    continue
                if begin + spent + shortest > time:
                    number = int(times.searchsorted(begin + spent + shortest))
                    continue
                if late > 0:
                    later, late = int(times.searchsorted(time + late)), 0.0
                    number = later if later < len(rows) else number
                    continue
                found = self._last(goal, left) if found is None else found
            if not isinstance(found, TimingRefusal):
                return self._leg(found, begin, time)
            step = found.excess if found.reason == "too short" else max(GRID_S, found.excess)
            number = int(times.searchsorted(time + step))
        return self._missed(begin, begin + spent, float(least[-1]))

    def _missed(self, begin: float, ready: float, least: float) -> Refusal:
        """Why no meeting was found; `least`: s that the way to the last one takes at least, after `ready`."""
        end, soonest = float(self.branch.time[-1]), self._shortest(self._goal(len(self.branch.time) - 1))
        need = ready + (least if isinstance(soonest, TimingRefusal) else soonest)
        if not need > end:
            return unmoved(Stage.TIMING, self.step, Obstacle.NO_SUCH_DURATION, interval=(begin, end))
        facts, late = WindowMissed(miss=Miss.NO_MEETING_LEFT), Quantity.of(need - end, "s")
        return window_missed(Stage.TIMING, self.step, facts, amount=late, interval=(begin, end))

    def _shortest(self, goal: Numbers) -> float | TimingRefusal:
        """How long the last leg takes at least, s."""
        if self.shape.hop is None:
            return self.pace.together.shortest(self.origin, goal)
        found = self._arch(self.shape.hop, goal, None)
        return found if isinstance(found, TimingRefusal) else found.duration

    def _goal(self, row: int) -> Numbers:
        """The state to be met; a via control point is met with a velocity towards what is `ahead`."""
        branch = self.branch
        q = branch.q[row].tolist()
        if self.ahead is None or not self.shape.through > 0:
            return q, branch.qd[row].tolist(), branch.qdd[row].tolist()
        return q, self._passing(self.state.q.tolist(), q, self.ahead, self.shape.through), [0.0] * len(q)

    def _passing(self, before: list[float], at: list[float], behind: list[float], share: float) -> list[float]:
        velocity, acceleration, _ = self.pace.rates
        found = np.empty(len(at))
        first, here, last = (np.array(station) for station in (before, at, behind))
        passing_velocity(first, here, last, share, np.array(velocity), np.array(acceleration), found)
        row: list[float] = found.tolist()
        return row

    def _through_vias(self) -> Refusal | None:
        """Times the legs up to the last via."""
        shape = self.shape
        if not shape.vias:
            return None
        goal = self.branch.q[0].tolist()
        stations = [self.origin[0], *(via.q.tolist() for via in shape.vias), goal]
        for i, via in enumerate(shape.vias, start=1):
            v = self._passing(stations[i - 1], stations[i], stations[i + 1], via.pace)
            passed: Numbers = (stations[i], v, [0.0] * len(v))
            found = self.pace.together.raw_profile(self.origin, passed)
            if isinstance(found, TimingRefusal):
                return unmoved(Stage.TIMING, self.step, Obstacle.NO_PROFILE)
            self.prefix.append(found)
            self.origin = passed
        return None

    def _last(self, goal: Numbers, duration: float | None) -> RawProfile | TimingRefusal:
        if self.shape.hop is not None:
            return self._arch(self.shape.hop, goal, duration)
        return self.pace.together.raw_profile(self.origin, goal, duration)

    def _at_any_time(self, begin: float) -> Trajectory | Refusal:
        """The way to a point that stands: the fastest."""
        last = self._last(self._goal(0), None)
        if isinstance(last, TimingRefusal):
            return unmoved(Stage.TIMING, self.step, Obstacle.NO_PROFILE)
        return self._leg(last, begin, None)

    def _leg(self, last: RawProfile, begin: float, end: float | None) -> Trajectory | Refusal:
        """The leg whose last part is `last`, if its spline keeps the limits; `end` None: when that ends."""
        parts, begins = [*self.prefix, last], [begin]
        for profile in parts:
            begins.append(begins[-1] + profile.duration)
        if end is not None:
            begins[-1] = end
        trajectory = trajectory_of(parts, begins)
        return beyond_limits(self.scene, self.step, trajectory, self.pace.limits) or trajectory

    def _arch(self, hop: Hop, goal: Numbers, duration: float | None) -> RawProfile | TimingRefusal:
        # on a belt the lift joint meets all later points as it meets the first: its motions are timed once
        key = tuple(row[self.pace.lift[0]] for row in goal)
        if key not in self._verticals:
            self._verticals[key] = vertical(self.origin, goal, hop.top, self.pace)
        return arch(self.origin, goal, hop, self.pace, duration, self._verticals[key])
