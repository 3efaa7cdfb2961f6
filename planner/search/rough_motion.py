"""Rough motions of many ways at once: about as quick as Ruckig's, by trapezoids, and without asking it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.legs.passing import passing_velocities
from assur.planner.robots.protocol import Robot
from assur.planner.search.meeting_options import Option
from assur.planner.search.partial_plan import Chain
from assur.planner.search.via_batch import MOST_VIAS, Prospects
from assur.planner.timing.trapezoids import Trapezoids, mean_acceleration, trapezoid_time

PRUDENCE = 1.01
"""Ruckig's motions take this much longer at most, nearly always: a meeting is not to be missed by a hair."""
MEETINGS = 2
"""Times that the meeting is looked up again after the way to it was timed."""
SEGMENTS = MOST_VIAS + 1


@dataclass(frozen=True, eq=False)
class Rough:
    """N rough motions: when they begin to move (N,), s, and the profiles of their segments (N, S, n)."""

    begin: FloatArray
    segments: Trapezoids

    @property
    def end(self) -> FloatArray:
        """(N,), s; NaN for a motion that meets its point no more."""
        return np.asarray(self.begin + self.segments.duration.sum(-1))

    def some(self, key: IntArray) -> Rough:
        """Some of the motions."""
        return Rough(self.begin[key], self.segments.some((key,)))

    def at(self, t: FloatArray) -> FloatArray:
        """q (N, T, n) at times t (N, T), the arm standing still before and after."""
        ends = self.begin[:, None] + np.cumsum(self.segments.duration, -1)
        segment = (t[..., None] >= ends[:, None, :-1]).sum(-1)
        way = np.arange(len(t))[:, None]
        begins = np.concatenate([self.begin[:, None], ends], -1)
        return self.segments.some((way, segment)).at(t - begins[way, segment])

    def possible(self, robot: Robot) -> BoolArray:
        """Which motions (N,) meet their ends, and stay within the limits of position where a joint turns round."""
        turning = self.segments.turning_points(robot.limits.acceleration, robot.limits.jerk)
        return np.asarray(robot.within(turning).all((0, 2)) & self.segments.meets().all((1, 2)))


class RoughMotions:
    """Times the ways of one chain to its options."""

    def __init__(self, robot: Robot, chain: Chain, options: tuple[Option, ...]) -> None:
        self.limits, self.state = robot.limits, chain.state
        self.branches = [option.branch for option in options]
        self.rows = [np.flatnonzero(branch.legal) for branch in self.branches]

    def __call__(self, ways: Prospects) -> Rough:
        """One motion for each way."""
        count, limits = len(ways), self.limits
        effort = ways.effort[:, None, None]
        v, a = limits.velocity * np.sqrt(effort), limits.acceleration * effort
        # stations: start, vias, goal. Vias stand before the goal, so a way with fewer of them begins with segments of
        # no length, from the start to the start
        number = np.arange(MOST_VIAS) - (MOST_VIAS - ways.count)[:, None]
        used, way = (number >= 0)[..., None], np.arange(count)[:, None]
        q, qd = np.empty((2, count, SEGMENTS + 1, len(self.state.q)))
        q[:, 0], qd[:, 0] = self.state.q, self.state.qd
        q[:, 1:-1] = np.where(used, ways.via[way, number], self.state.q)
        self._meet(ways.option, np.full(count, -np.inf), q, qd)
        passing = passing_velocities(q[:, :-2], q[:, 1:-1], q[:, 2:], ways.pace[way, number], v, a)
        qd[:, 1:-1] = np.where(used, passing, self.state.qd)
        a = np.broadcast_to(mean_acceleration(v, a, limits.jerk * effort**1.5), (count, SEGMENTS, len(self.state.q)))
        begin = self.state.time + ways.wait
        duration = np.zeros((count, SEGMENTS))
        duration[:, :-1] = used[..., 0] * trapezoid_time(q[:, :-2], qd[:, :-2], q[:, 1:-1], qd[:, 1:-1], v, a[:, :-1])
        before = duration[:, :-1].sum(-1)
        for _ in range(MEETINGS):
            last = trapezoid_time(q[:, -2], qd[:, -2], q[:, -1], qd[:, -1], v[:, 0], a[:, -1])
            met = self._meet(ways.option, begin + PRUDENCE * (before + last) + ways.late, q, qd)
        last = trapezoid_time(q[:, -2], qd[:, -2], q[:, -1], qd[:, -1], v[:, 0], a[:, -1])
        duration[:, -1] = np.where(np.isinf(met), last, np.maximum(last, met - begin - before))
        return Rough(begin, Trapezoids.of(q[:, :-1], qd[:, :-1], q[:, 1:], qd[:, 1:], a, duration))

    def _meet(self, option: IntArray, at: FloatArray, q: FloatArray, qd: FloatArray) -> FloatArray:
        """Sets the last of the states (N, S+1, n) to where the options are met from `at` (N,) on.

        When that is (N,), s: inf for any time, NaN where it is too late.
        """
        when = np.full(len(option), np.inf)
        for number in np.unique(option):
            mine = np.flatnonzero(option == number)
            branch, rows = self.branches[number], self.rows[number]
            if branch.still:
                row = np.full(len(mine), rows[0])
            else:
                found = np.searchsorted(branch.time[rows], at[mine])
                row = rows[np.minimum(found, len(rows) - 1)]
                when[mine] = np.where(found < len(rows), branch.time[row], np.nan)
            q[mine, -1], qd[mine, -1] = branch.q[row], branch.qd[row]
        return when
