"""The trajectory that is executed, drawn, certified and checked: knots (t, q, q̇, q̈) and quintic Hermite between them.

It is what ROS 2's joint_trajectory_controller runs from points with positions, velocities and accelerations, so
whatever is proved here holds for what moves. A piecewise cubic with a knot at every jump of its jerk is reproduced
exactly. Times are strictly increasing; q, q̇ and q̈ are continuous, the jerk jumps at knots.

A trajectory that says so (`jumps`: parabolic blends) may hold two knots at one time, with the same q and q̇, where q̈
jumps (`assur.planner.trajectory.jumps`). Its pieces are those that last; at a jump the one to the right counts.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np

from assur.planner.arrays import FloatArray, IntArray, frozen
from assur.planner.errors import InputError
from assur.planner.trajectory.extremum import span
from assur.planner.trajectory.hermite import hulls, powers
from assur.planner.trajectory.jumps import doubled


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Joint motion over [start, end]: `time` (K,) s, `q, qd, qdd` (K, n) rad or m and their derivatives.

    `jumps`: whether two knots may share a time where q and q̇ agree to the bit and q̈ does not.

    Raises `InputError` naming the field for fewer than two knots, shapes that differ, values that are not finite and
    times that do not increase; with `jumps`, for a third knot at one time and for two that are not such a jump.
    """

    time: FloatArray
    q: FloatArray
    qd: FloatArray
    qdd: FloatArray
    jumps: bool = field(default=False, kw_only=True)

    def __post_init__(self) -> None:
        time = frozen(self.time, (None,), "trajectory.time")
        if len(time) < 2:
            raise InputError("trajectory.time", len(time), "at least two knots")
        if not self.jumps and not (time[1:] > time[:-1]).all():
            raise InputError("trajectory.time", int(np.argmin(time[1:] > time[:-1])) + 1, "strictly increasing times")
        object.__setattr__(self, "time", time)
        width = None
        for name in ("q", "qd", "qdd"):
            states = frozen(getattr(self, name), (len(time), width), f"trajectory.{name}")
            width = states.shape[1]
            object.__setattr__(self, name, states)
        if not width:
            raise InputError("trajectory.q", self.q.shape, "at least one joint")
        if self.jumps:
            doubled(self.time, self.q, self.qd, self.qdd)

    def __reduce__(self) -> tuple[Callable[..., Trajectory], tuple[FloatArray, ...]]:
        """Between processes only the knots travel; they are validated again."""
        made = partial(Trajectory, jumps=True) if self.jumps else Trajectory
        return made, (self.time, self.q, self.qd, self.qdd)

    @property
    def n(self) -> int:
        """Number of joints."""
        return int(self.q.shape[1])

    @property
    def start(self) -> float:
        return float(self.time[0])

    @property
    def end(self) -> float:
        return float(self.time[-1])

    @property
    def duration(self) -> float:
        return self.end - self.start

    @property
    def rest_at_start(self) -> bool:
        """Whether velocity and acceleration of the first knot are exactly zero."""
        return not (self.qd[0].any() or self.qdd[0].any())

    @property
    def rest_at_end(self) -> bool:
        """Whether velocity and acceleration of the last knot are exactly zero."""
        return not (self.qd[-1].any() or self.qdd[-1].any())

    @cached_property
    def _begins(self) -> IntArray:
        """Numbers of the knots at which the pieces begin, (P,): all but the last, and the first of two at one time."""
        return np.flatnonzero(self.time[1:] > self.time[:-1])

    @cached_property
    def edges(self) -> FloatArray:
        """Begins of the pieces and the end of the last, (P+1,) s: the times of the knots, each once."""
        return _closed(np.append(self.time[self._begins], self.time[-1]))

    @cached_property
    def steps(self) -> FloatArray:
        """Lengths of the pieces, (P,) s; P = K-1 without jumps."""
        return _closed(self.edges[1:] - self.edges[:-1])

    @cached_property
    def _hulls(self) -> tuple[FloatArray, ...]:
        if len(self._begins) == len(self.time) - 1:
            return tuple(_closed(hull) for hull in hulls(self.steps, self.q, self.qd, self.qdd))
        # rows do not see each other: what lasts no time gets some length, and is left out again
        length = np.ones(len(self.time) - 1)
        length[self._begins] = self.steps
        return tuple(_closed(hull[self._begins]) for hull in hulls(length, self.q, self.qd, self.qdd))

    @cached_property
    def coefficients(self) -> FloatArray:
        """c0..c5 of q(τ) = Σ c_i τ^i, τ = t − t_k, on every piece: (P, n, 6)."""
        knots = np.append(self._begins, len(self.time) - 1)
        return _closed(powers(self.steps, self.q[knots], self.qd[knots], self._hulls))

    @cached_property
    def _horner(self) -> tuple[FloatArray, ...]:
        """Coefficients of q and its three derivatives, order first: (6 - derivative, P, n)."""
        out = [np.ascontiguousarray(np.moveaxis(self.coefficients, -1, 0))]
        for degree in (5, 4, 3):
            out.append(out[-1][1:] * np.arange(1.0, degree + 1)[:, None, None])
        return tuple(_closed(c) for c in out)

    def bernstein(self, derivative: int) -> FloatArray:
        """Bernstein coefficients of a derivative (0 to 3) on every piece, (P, n, 6 - derivative): its convex hull."""
        return self._hulls[derivative]

    def piece(self, t: FloatArray) -> tuple[IntArray, FloatArray]:
        """The piece that holds each time, the right one at an inner knot, and the time since its begin."""
        index = np.minimum(np.maximum(self.edges.searchsorted(t, "right") - 1, 0), len(self.steps) - 1)
        return index, t - self.edges[index]

    def on_piece(self, index: IntArray, tau: FloatArray, derivative: int) -> FloatArray:
        """q or a derivative (0 to 3) of pieces number `index` (...), `tau` (...) s after their begin: (..., n)."""
        c = self._horner[derivative].take(index, 1)
        tau = np.repeat(tau[..., None], self.n, -1)
        value = c[-1]
        for coefficient in c[-2::-1]:
            value *= tau
            value += coefficient
        return np.asarray(value)

    def states_on_piece(self, index: IntArray, tau: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """q, q̇, q̈ as `on_piece` gives them, in one go: Horner's scheme for a polynomial and its derivatives."""
        c = self._horner[0].take(index, 1)
        # Contiguous operands in place: a broadcast of tau would take three times as long.
        tau = np.repeat(tau[..., None], self.n, -1)
        q, v = c[5] * tau, c[5]
        q += c[4]
        a = v.copy()
        for k in (3, 2, 1, 0):
            if k < 3:
                a *= tau
                a += v
            v *= tau
            v += q
            q *= tau
            q += c[k]
        a *= 2
        return q, v, a

    def evaluate(self, t: FloatArray | float, derivative: int = 0) -> FloatArray:
        """q or a derivative (0 to 3) at times `t` (...): (..., n).

        At an inner knot the piece to its right counts (this matters for the jerk alone, and for the acceleration
        where it jumps), at a knot its own numbers come back. Outside [start, end], and for a time that is NaN: NaN.
        """
        t = np.asarray(t, dtype=np.float64)
        held = np.minimum(np.maximum(t, self.time[0]), self.time[-1])
        value = self.on_piece(*self.piece(held), derivative)
        last = held == self.time[-1]
        if derivative < 3 and last.any():
            value[last] = (self.q, self.qd, self.qdd)[derivative][-1]
        outside = held != t
        if outside.any():
            value[outside] = np.nan
        return value

    def states(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """q, q̇, q̈ (T, n) at times t (T,) within [start, end]; the end state is exact."""
        q, qd, qdd = self.states_on_piece(*self.piece(t))
        last = t == self.time[-1]
        q[last], qd[last], qdd[last] = self.q[-1], self.qd[-1], self.qdd[-1]
        return q, qd, qdd

    def state(self, t: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """q, q̇, q̈ at one time, each (n,)."""
        return self.evaluate(t), self.evaluate(t, 1), self.evaluate(t, 2)

    def extrema(self, derivative: int) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest value (n,), (n,) of q or a derivative (0 to 3) over the whole trajectory.

        For the polynomials as they stand, not for samples. The interval given holds every value, and is wider than
        the true range by at most 1e-13 of the largest Bernstein coefficient, plus the rounding of the coefficients.
        Where the acceleration jumps both of its sides count, and the jerk has no bound: −∞ and ∞.
        """
        low, high = span(self._hulls[derivative])
        if len(self._begins) < len(self.time) - 1 and derivative >= 2:
            leap = np.abs(np.diff(self.qdd, axis=0)[self.time[1:] == self.time[:-1]]).max(0) > 0
            if derivative == 3:
                return np.where(leap, -np.inf, low), np.where(leap, np.inf, high)
            low, high = np.minimum(low, self.qdd.min(0)), np.maximum(high, self.qdd.max(0))
        return low, high


def _closed(array: FloatArray) -> FloatArray:
    array.flags.writeable = False
    return array
