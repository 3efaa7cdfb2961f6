"""The way of the tool point between two frames that move, p(s, t) = A(t) + s (B(t) - A(t)), timed by a phase law s(t).

With Δ = B - A (equation L1):

    ṗ = Ȧ + s Δ̇ + ṡ Δ        p̈ = Ä + s Δ̈ + 2 ṡ Δ̇ + s̈ Δ

and likewise yaw, pitch and roll, the short way round. The flange is where it then has to be: beside a line, where the
tool point is beside the flange's axis and the yaw changes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.facts import Limits
from assur.planner.timing import Numbers, Solver

Along = Callable[[FloatArray], Motion]
"""The motion of a frame at times (T,)."""


@dataclass(frozen=True, slots=True)
class Line:
    """The course between two frames of the flange; `tcp`: the tool point in the flange, which is what goes along the
    line."""

    left: Along
    met: Along
    tcp: Pose = Pose()

    def motion(self, t: FloatArray, s: FloatArray, sd: FloatArray, sdd: FloatArray) -> Motion:
        """Motion (T,) of the flange, equation L1, at times t (T,) in these phases (T,)."""
        beside = Pose(self.tcp.x, self.tcp.y)
        a, b = self.left(t).at(beside).table, self.met(t).at(beside).table
        width = min(a.shape[-1], b.shape[-1])
        a, b = a[..., :width], b[..., :width].copy()
        b[:, 0, 3:] -= np.round((b[0, 0, 3:] - a[0, 0, 3:]) / (2 * np.pi)) * 2 * np.pi
        gap = b - a
        table, s, sd, sdd = np.zeros_like(gap), s[:, None], sd[:, None], sdd[:, None]
        table[:, 0] = a[:, 0] + s * gap[:, 0]
        table[:, 1] = a[:, 1] + s * gap[:, 1] + sd * gap[:, 0]
        table[:, 2] = a[:, 2] + s * gap[:, 2] + 2 * sd * gap[:, 1] + sdd * gap[:, 0]
        motion = Motion(table)
        return motion if motion.tilted else motion.at(beside.inverse())


# What the joints of a line do under a law of its phase, and how long they need for it (equations L2 and L4).

FLAT = 1e-12
"""Relative to the largest rate: below, a root has its slope taken here, where it would be infinite."""
_ORDER = np.array([1.0, 2.0, 3.0])
"""Of velocity, acceleration and jerk in time."""


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What the joints do in the states `shape` (R, 4) of a law of duration 1: the line's derivatives `q` (4, R, n)
    there, the rates over their limits `values` (R, n, 3), and the `times` (R, n, 3) that they need (L4)."""

    shape: FloatArray
    q: FloatArray
    values: FloatArray
    times: FloatArray


@dataclass(frozen=True, eq=False)
class LineRates:
    """What the joints of a line do under a law: `table` (M, 4, n) holds q' to q'''' by s, `bounds` (n, 3) the limits of
    velocity, acceleration and jerk."""

    table: FloatArray
    bounds: FloatArray

    @staticmethod
    def of(derivatives: tuple[FloatArray, FloatArray, FloatArray], limits: Limits) -> LineRates:
        """The fourth derivative, by differences, serves the slopes of the search alone."""
        fourth = np.gradient(derivatives[2], 1 / (len(derivatives[2]) - 1), axis=0)
        bounds = np.stack([limits.velocity, limits.acceleration, limits.jerk], -1)
        return LineRates(np.stack([*derivatives, fourth], 1), bounds)

    def at(self, s: FloatArray) -> FloatArray:
        """The table at s (R,), (4, R, n)."""
        last = len(self.table) - 1
        x = np.clip(s, 0.0, 1.0) * last
        i = np.minimum(x.astype(int), last - 1)
        w = (x - i)[:, None, None]
        return np.asarray((self.table[i] * (1 - w) + self.table[i + 1] * w).swapaxes(0, 1))

    def times(self, shape: FloatArray) -> FloatArray:
        """Times (R, n, 3) that velocity, acceleration and jerk need in a state (R, 4) of a law of duration 1 (L4)."""
        return self.seen(shape).times

    def seen(self, shape: FloatArray) -> Seen:
        """The times, and what they come of."""
        q = self.at(shape[:, 0])
        values = self._values(q, shape)
        return Seen(shape, q, values, _times(values))

    def slopes(self, seen: Seen) -> FloatArray:
        """Derivatives (R, n, 3, 4) of the times by s, ṡ, s̈, s⃛."""
        values, times = seen.values, seen.times
        q1, q2, q3, q4 = seen.q
        d, dd, ddd = (seen.shape[:, k, None] for k in (1, 2, 3))
        partial = np.zeros((*values.shape, 4))
        partial[..., 0, 0], partial[..., 0, 1] = q2 * d, q1
        partial[..., 1, 0], partial[..., 1, 1], partial[..., 1, 2] = q2 * dd + q3 * d**2, 2 * q2 * d, q1
        partial[..., 2, 0] = q2 * ddd + 3 * q3 * d * dd + q4 * d**3
        partial[..., 2, 1], partial[..., 2, 2], partial[..., 2, 3] = 3 * (q2 * dd + q3 * d**2), 3 * q2 * d, q1
        # of |x|^(1/k): sign(x) |x|^(1/k − 1)/k
        root = np.sign(values) / _ORDER * np.maximum(times, FLAT * times.max()) ** (1 - _ORDER) / self.bounds
        return np.asarray(partial * root[..., None])

    def _values(self, q: FloatArray, shape: FloatArray) -> FloatArray:
        """q̇, q̈, q⃛ over their limits, (R, n, 3), by the chain rule (L2)."""
        q1, q2, q3, _ = q
        d, dd, ddd = (shape[:, k, None] for k in (1, 2, 3))
        values = np.empty((*q1.shape, 3))
        values[..., 0] = q1 * d
        values[..., 1] = q1 * dd + q2 * d**2
        values[..., 2] = q1 * ddd + 3 * q2 * d * dd + q3 * d**3
        return values / self.bounds


def _times(values: FloatArray) -> FloatArray:
    times = np.abs(values)
    times[..., 1] = np.sqrt(times[..., 1])
    times[..., 2] = np.cbrt(times[..., 2])
    return times


# How fast joint legs may go, and who times them: all joints together or, over an arch, the lift apart from the others.
#
# Scaled limits are made once for many legs: limits are checked once, and the solvers stay.


@dataclass(frozen=True, eq=False)
class ScaledLimits:
    """The robot's `limits` at this `effort`: the share of the acceleration limits that is used (of velocity its root,
    of jerk its power of 3/2). `pull`: share of the acceleration that the joints across use of that.
    `lift_joint`: the number of the joint that lifts; None: no arches. `lift_effort`: its own, and `lift_most`: the
    acceleration, m/s², that it keeps to."""

    limits: Limits
    lift_joint: int | None
    effort: float = 1.0
    lift_effort: float | None = None
    lift_most: float = math.inf
    pull: float = 1.0

    @cached_property
    def rates(self) -> Numbers:
        """Limits of velocity, acceleration and jerk, a number a joint."""
        limits, effort = self.limits, np.full(len(self.limits.velocity), self.effort)
        if self.lift_joint is not None and self.lift_effort is not None:
            effort[self.lift_joint] = self.lift_effort
        rates = limits.velocity * effort**0.5, limits.acceleration * effort, limits.jerk * effort**1.5
        velocity, acceleration, jerk = np.array(rates).tolist()
        acceleration = [self.pull * each for each in acceleration]
        if self.lift_joint is not None:
            acceleration[self.lift_joint] /= self.pull
            acceleration[self.lift_joint] = min(acceleration[self.lift_joint], self.lift_most)
        return velocity, acceleration, jerk

    @cached_property
    def lift(self) -> list[int]:
        """The number of the lift joint, alone in a list."""
        if self.lift_joint is None:
            raise FaultError("an arch needs a lift joint")
        return [self.lift_joint]

    @cached_property
    def others(self) -> list[int]:
        """Numbers of the joints that go across."""
        return [i for i in range(len(self.limits.velocity)) if i != self.lift_joint]

    @cached_property
    def together(self) -> Solver:
        """Times all joints."""
        return Solver(*self.rates)

    @cached_property
    def lifting(self) -> Solver:
        """Times the lift joint alone."""
        return Solver(*part(self.rates, self.lift))

    @cached_property
    def across(self) -> Solver:
        """Times the others."""
        return Solver(*part(self.rates, self.others))


def part(rows: Numbers, joints: list[int]) -> Numbers:
    """The numbers of some joints."""
    first, second, third = rows
    return [first[i] for i in joints], [second[i] for i in joints], [third[i] for i in joints]
