"""The trajectory that is executed, drawn, certified and checked: knots (t, q, q̇, q̈) and quintic Hermite between them.

It is what ROS 2's joint_trajectory_controller runs from points with positions, velocities and accelerations, so
whatever is proved here holds for what moves. A piecewise cubic with a knot at every jump of its jerk is reproduced
exactly. Times are strictly increasing; q, q̇ and q̈ are continuous, the jerk jumps at knots.

A trajectory that says so (`jumps`: parabolic blends) may hold two knots at one time, with the same q and q̇, where q̈
jumps (`assur.planner.trajectory.jumps`). Its pieces are those that last; at a jump the one to the right counts.

Kernels are imported where they are called: whoever only names a trajectory, as the web process does, loads no compiler.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np

from assur.planner.arrays import FloatArray, IntArray, frozen
from assur.planner.errors import FaultError, InputError
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
    _knots: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        time = frozen(self.time, (None,), "trajectory.time")
        if len(time) < 2:
            raise InputError("trajectory.time", len(time), "at least two knots")
        if not self.jumps and not (time[1:] > time[:-1]).all():
            raise InputError("trajectory.time", int(np.argmin(time[1:] > time[:-1])) + 1, "strictly increasing times")
        columns, width = [time[:, None]], None
        for name in ("q", "qd", "qdd"):
            states = frozen(getattr(self, name), (len(time), width), f"trajectory.{name}")
            width = states.shape[1]
            columns.append(states)
        if not width:
            raise InputError("trajectory.q", columns[1].shape, "at least one joint")
        self._take(np.concatenate(columns, 1))
        if self.jumps:
            doubled(self.time, self.q, self.qd, self.qdd)

    @classmethod
    def of_knots(cls, knots: FloatArray) -> Trajectory:
        """The trajectory of a table (K, 1 + 3n) of K > 1 knots, which is not copied: times, q, q̇, q̈ side by side.

        Raises `FaultError` for numbers that are not finite and times that do not increase.
        """
        from assur.planner.kernels.hermite import first_bad_knot

        bad = first_bad_knot(knots)
        if len(knots) < 2 or bad >= 0:
            raise FaultError(f"knot {bad} of {len(knots)} is not finite, or not later than the one before")
        made = object.__new__(cls)
        object.__setattr__(made, "jumps", False)
        made._take(knots)
        return made

    def _take(self, knots: FloatArray) -> None:
        """Keeps the table of knots, and its columns as read-only views."""
        n = (knots.shape[1] - 1) // 3
        object.__setattr__(self, "_knots", knots)
        object.__setattr__(self, "time", _closed(knots[:, 0]))
        for number, name in enumerate(("q", "qd", "qdd")):
            object.__setattr__(self, name, _closed(knots[:, 1 + number * n : 1 + (number + 1) * n]))

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

    @property
    def knots(self) -> FloatArray:
        """Times, q, q̇, q̈ side by side, (K, 1 + 3n): what kernels take. Not to be written to."""
        return self._knots

    @cached_property
    def _hulls(self) -> FloatArray:
        """Bernstein coefficients between all knots, (K-1, n, HULL_COLUMNS)."""
        from assur.planner.kernels.hermite import HULL_COLUMNS, piece_hulls

        hulls = np.empty((len(self.time) - 1, self.n, HULL_COLUMNS))
        piece_hulls(self._knots, hulls)
        return hulls

    @cached_property
    def coefficients(self) -> FloatArray:
        """c0..c5 of q(τ) = Σ c_i τ^i, τ = t − t_k, on every piece: (P, n, 6)."""
        from assur.planner.kernels.hermite import piece_coefficients

        coefficients = np.empty((len(self.time) - 1, self.n, 6))
        piece_coefficients(self._knots, self._hulls, coefficients)
        return _closed(coefficients[self._begins])

    @cached_property
    def _horner(self) -> tuple[FloatArray, ...]:
        """Coefficients of q and its three derivatives, order first: (6 - derivative, P, n)."""
        out = [np.ascontiguousarray(np.moveaxis(self.coefficients, -1, 0))]
        for degree in (5, 4, 3):
            out.append(out[-1][1:] * np.arange(1.0, degree + 1)[:, None, None])
        return tuple(_closed(c) for c in out)

    def bernstein(self, derivative: int) -> FloatArray:
        """Bernstein coefficients of a derivative (0 to 3) on every piece, (P, n, 6 - derivative): its convex hull."""
        from assur.planner.kernels.hermite import first_column

        first = first_column(derivative)
        return _closed(self._hulls[self._begins, :, first : first + 6 - derivative])

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
        low, high = self._extremes[derivative]
        return low, high

    @cached_property
    def _extremes(self) -> FloatArray:
        """Lowest and highest value of q and its derivatives, (4, 2, n)."""
        from assur.planner.kernels.limits import spline_extremes

        found = np.empty((4, 2, self.n))
        spline_extremes(self._knots, found)
        return _closed(found)


def _closed(array: FloatArray) -> FloatArray:
    array.flags.writeable = False
    return array
