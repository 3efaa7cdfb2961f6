"""Joint legs: from a state of the arm to a meeting, all joints timed by Ruckig, through free vias or over an arch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from planner.arrays import FloatArray
from planner.errors import FaultError
from planner.legs.arched import Arched, Hop, Vertical, arch, vertical
from planner.legs.meeting import GRID_S, Branch
from planner.legs.passing import passing_velocity
from planner.legs.state import Knots, State
from planner.outcome import Reason, Refusal
from planner.scene import Scene
from planner.timing import Settled, Sketch, TimingRefusal, shortest_duration, sketch_joints

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
    through: float = 0.0
    """Pace at which a via control point is flown by, in mean joint velocities of the way to the one behind it."""

    @property
    def family(self) -> str:
        kind = "arch" if self.hop else f"{len(self.vias)} vias" if self.vias else "direct"
        return kind + (" after a wait" if self.wait > 0 else "") + (" later" if self.late > 0 else "")


@dataclass(frozen=True, eq=False)
class Reached:
    """A joint leg that meets a branch at row `row` of its grid, at `end`: profiles, each with the time it begins at.

    Knots are made only of what passes screening: most candidates never need them.
    """

    state: State
    profiles: tuple[tuple[float, Sketch | Settled | Arched], ...]
    end: float
    row: int

    @property
    def begin(self) -> float:
        return self.profiles[0][0]

    def at(self, t: FloatArray) -> FloatArray:
        """q (T, n) at times t, the arm standing still before the leg and after it."""
        found = np.empty((len(t), len(self.state.q)))
        for number, (begin, profile) in enumerate(self.profiles):
            rows = t >= begin if number else np.ones(len(t), dtype=bool)
            if rows.any():
                found[rows] = profile.positions(t[rows] - begin)
        return found

    def knots(self) -> Knots:
        """Knots in absolute time; the last is at `end` to the bit, so that it and the control point agree."""
        parts = [Knots(*(way if isinstance(way, Arched) else way.profile).knots(begin)) for begin, way in self.profiles]
        result = parts[0]
        for part in parts[1:]:
            result = result.then(part)
        time = result.time.copy()
        time[-1] = self.end
        return Knots(time, result.q, result.qd, result.qdd)


class JointMotion:
    """The legs of one shape from one state towards one branch."""

    def __init__(
        self, scene: Scene, step: int, state: State, shape: Shape, branch: Branch, ahead: FloatArray | None = None
    ) -> None:
        self.scene, self.step, self.shape, self.branch, self.ahead = scene, step, shape, branch, ahead
        limits = scene.robot.limits
        self.velocity = limits.velocity * shape.effort**0.5
        self.acceleration = limits.acceleration * shape.effort
        self.jerk = limits.jerk * shape.effort**1.5
        self.lift = scene.robot.lift
        self.state = state
        self._verticals: dict[tuple[float, ...], Vertical | TimingRefusal] = {}
        self.prefix: list[Sketch | Settled] = []

    def meet(self) -> Reached | Refusal:
        """The earliest meeting on the branch's grid that this shape reaches (or `late` seconds later).

        Ruckig's shortest duration is asked at the first grid time that a lower bound allows, then at the first one
        that this duration allows, until it fits: then it is asked to take exactly the time that is left.
        """
        failed = self._through_vias()
        if failed is not None:
            return failed
        branch, begin = self.branch, self.state.time + self.shape.wait
        spent = sum(profile.duration for profile in self.prefix)
        q = self._from()[0]
        rows = np.flatnonzero(branch.legal)
        if branch.still:
            return self._finish(int(rows[0]), None, begin)
        # velocity limits alone say that nothing earlier can be met; Ruckig says the rest
        least = (np.abs(branch.q[rows] - q) / self.velocity).max(-1)
        rows = rows[branch.time[rows] >= begin + spent + least]
        asked = self.shape.late
        for _ in range(TRIES):
            if not len(rows):
                break
            row = int(rows[0])
            shortest = self._shortest(self._goal(row))
            if isinstance(shortest, TimingRefusal):
                rows = rows[branch.time[rows] >= branch.time[row] + max(GRID_S, shortest.excess)]
                continue
            ready = begin + spent + shortest
            if ready > branch.time[row]:
                rows = rows[branch.time[rows] >= ready]
                continue
            if asked > 0:
                later = rows[branch.time[rows] >= branch.time[row] + asked]
                rows, asked = (later if len(later) else rows), 0.0
                continue
            reached = self._finish(row, float(branch.time[row]) - begin - spent, begin)
            if isinstance(reached, Reached):
                return reached
            rows = rows[branch.time[rows] >= branch.time[row] + max(GRID_S, reached.amount)]
        last = int(np.flatnonzero(branch.legal)[-1])
        end, soonest = float(branch.time[last]), self._shortest(self._goal(last))
        need = begin + spent + (float(least[-1]) if isinstance(soonest, TimingRefusal) else soonest)
        if not need > end:
            detail = "no motion was found that takes exactly the time to a meeting"
            return Refusal("timing", Reason.MOTION_LIMIT, self.step, (), (begin, end), detail=detail)
        detail = "no meeting time is left"
        return Refusal("timing", Reason.WINDOW_MISSED, self.step, (), (begin, end), need - end, "s", detail)

    def _shortest(self, goal: tuple[FloatArray, FloatArray, FloatArray]) -> float | TimingRefusal:
        """How long the last leg takes at least, s."""
        if self.shape.hop is None:
            return shortest_duration(*self._from(), *goal, self.velocity, self.acceleration, self.jerk)
        found = self._arch(self._from(), goal, None)
        return found if isinstance(found, TimingRefusal) else found.duration

    def _goal(self, row: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The state to be met; a via control point is met with a velocity towards what is `ahead`."""
        branch = self.branch
        if self.ahead is None or not self.shape.through > 0:
            return branch.q[row], branch.qd[row], branch.qdd[row]
        qd = self._passing(self.state.q, branch.q[row], self.ahead, self.shape.through)
        return branch.q[row], qd, np.zeros_like(qd)

    def _passing(self, before: FloatArray, at: FloatArray, behind: FloatArray, pace: float) -> FloatArray:
        return passing_velocity(before, at, behind, pace, self.velocity, self.acceleration)

    def _from(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        if self.prefix:
            return self.prefix[-1].end
        return self.state.q, self.state.qd, self.state.qdd

    def _through_vias(self) -> Refusal | None:
        """Times the legs up to the last via."""
        shape, q = self.shape, self.state.q
        if not shape.vias:
            return None
        row = int(np.flatnonzero(self.branch.legal)[0])
        stations = [q, *(via.q for via in shape.vias), self.branch.q[row]]
        for i, via in enumerate(shape.vias, start=1):
            v = self._passing(stations[i - 1], via.q, stations[i + 1], via.pace)
            limits = self.velocity, self.acceleration, self.jerk
            found = sketch_joints(*self._from(), via.q, v, np.zeros_like(v), *limits)
            if isinstance(found, TimingRefusal):
                return Refusal("timing", Reason.MOTION_LIMIT, self.step, detail=f"via: {found.detail}")
            self.prefix.append(found)
        return None

    def _last(
        self, goal: tuple[FloatArray, FloatArray, FloatArray], duration: float | None
    ) -> Sketch | Settled | Arched | TimingRefusal:
        start = self._from()
        if self.shape.hop is not None:
            return self._arch(start, goal, duration)
        return sketch_joints(*start, *goal, self.velocity, self.acceleration, self.jerk, duration)

    def _finish(self, row: int, duration: float | None, begin: float) -> Reached | Refusal:
        branch = self.branch
        last = self._last(self._goal(row), duration)
        if isinstance(last, TimingRefusal):
            return Refusal("timing", Reason.MOTION_LIMIT, self.step, (), None, last.excess, "s", last.detail)
        parts, at = [], begin
        for profile in [*self.prefix, last]:
            parts.append((at, profile))
            at += profile.duration
        return Reached(self.state, tuple(parts), at if duration is None else float(branch.time[row]), row)

    def _arch(
        self,
        start: tuple[FloatArray, FloatArray, FloatArray],
        goal: tuple[FloatArray, FloatArray, FloatArray],
        duration: float | None,
    ) -> Arched | TimingRefusal:
        if self.shape.hop is None or self.lift is None:
            raise FaultError("an arch needs a hop and a lift joint")
        limits = self.velocity, self.acceleration, self.jerk
        # on a belt the lift joint meets all later points as it meets the first: its ways are timed once
        key = tuple(float(x[self.lift]) for x in goal)
        if key not in self._verticals:
            self._verticals[key] = vertical(start, goal, self.shape.hop.top, self.lift, limits)
        return arch(start, goal, self.shape.hop, self.lift, limits, duration, self._verticals[key])
