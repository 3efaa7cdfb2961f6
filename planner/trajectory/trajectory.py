"""The trajectory that is executed, drawn, certified and checked: knots (t, q, q̇, q̈) and quintic Hermite between them.

It is what ROS 2's joint_trajectory_controller runs from points with positions, velocities and accelerations, so
whatever is proved here holds for what moves. A piecewise cubic with a knot at every jump of its jerk is reproduced
exactly. Times are strictly increasing; q, q̇ and q̈ are continuous, the jerk jumps at knots.

A trajectory that says so (`jumps`) may hold two knots at one time, with the same q and q̇, where q̈
jumps (`assur.planner.trajectory.trajectory`). Its pieces are those that last; at a jump the one to the right counts.

Kernels are imported where they are called: code that only names a trajectory (the web process) loads no compiler.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from assur.planner.arrays import FloatArray, frozen
from assur.planner.errors import FaultError, InputError

if TYPE_CHECKING:
    from assur.planner.kernels.spline import Spline

# Two knots at one time: a jump in acceleration, and nothing else.
#
# A motion without a limit of the jerk may jump from one acceleration to another. At such a time there is one knot for
# what ends and one for what begins; q and q̇ are the same in both, to the bit, so the motion and its speed are
# continuous. Evaluation is continuous from the right. The jerk has no bound there.


def doubled(time: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray) -> None:
    """Accept knots; two at one time are a jump. Raises `InputError` naming field and knot otherwise."""
    step = time[1:] - time[:-1]
    if not (step >= 0).all():
        raise InputError("trajectory.time", int(np.argmin(step >= 0)) + 1, "times that do not decrease")
    if not time[-1] > time[0]:
        raise InputError("trajectory.time", float(time[0]), "knots at two times at least")
    second = np.flatnonzero(step == 0) + 1
    crowded = np.flatnonzero(np.diff(second) == 1)
    if len(crowded):
        raise InputError("trajectory.time", int(second[crowded[0] + 1]), "two knots at one time, not three")
    for k in second:
        for name, states in (("q", q), ("qd", qd)):
            if not (states[k] == states[k - 1]).all():
                allowed = "the same in both knots at one time: only the acceleration may jump"
                raise InputError(f"trajectory.{name}", int(k), allowed)
        if not (qdd[k] != qdd[k - 1]).any():
            raise InputError("trajectory.qdd", int(k), "a jump where two knots share a time; one knot will do")


class Trajectory:
    """Joint motion over [start, end]: `time` (K,) s, `q, qd, qdd` (K, n) rad or m and their derivatives.

    `jumps`: whether two knots may share a time where q and q̇ agree to the bit and q̈ does not.

    Raises `InputError` naming the field for fewer than two knots, shapes that differ, values that are not finite and
    times that do not increase; with `jumps`, for a third knot at one time and for two that are not such a jump.
    """

    __slots__ = ("_extremes", "_knots", "_spline", "jumps", "n")

    def __init__(
        self, time: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray, *, jumps: bool = False
    ) -> None:
        time = frozen(time, (None,), "trajectory.time")
        if len(time) < 2:
            raise InputError("trajectory.time", len(time), "at least two knots")
        if not jumps and not (time[1:] > time[:-1]).all():
            raise InputError("trajectory.time", int(np.argmin(time[1:] > time[:-1])) + 1, "strictly increasing times")
        columns, width = [time[:, None]], None
        for name, given in (("q", q), ("qd", qd), ("qdd", qdd)):
            states = frozen(given, (len(time), width), f"trajectory.{name}")
            width = states.shape[1]
            columns.append(states)
        if not width:
            raise InputError("trajectory.q", columns[1].shape, "at least one joint")
        self._take(np.concatenate(columns, 1), None, jumps=jumps)
        if jumps:
            doubled(self.time, self.q, self.qd, self.qdd)

    @classmethod
    def of_knots(cls, knots: FloatArray, *, jumps: bool = False) -> Trajectory:
        """The trajectory of a table (K, 1 + 3n) of K > 1 knots: times, q, q̇, q̈ side by side. It is not copied.

        Raises `FaultError` for numbers that are not finite and times that do not increase; with `jumps`, `InputError`
        as the constructor does.
        """
        from assur.planner.kernels.spline import spline_tables

        bad, spline = spline_tables(knots, jumps)
        if len(knots) < 2 or bad >= 0:
            raise FaultError(f"knot {bad} of {len(knots)} is not finite, or not later than the one before")
        made = object.__new__(cls)
        made._take(knots, spline, jumps=jumps)
        if jumps:
            doubled(made.time, made.q, made.qd, made.qdd)
        return made

    def _take(self, knots: FloatArray, spline: Spline | None, *, jumps: bool) -> None:
        """Keeps the table of knots, and those of its spline where they are known."""
        self._knots, self._spline, self.jumps, self.n = knots, spline, jumps, (knots.shape[1] - 1) // 3
        self._extremes: FloatArray | None = None

    def __reduce__(self) -> tuple[Callable[..., Trajectory], tuple[FloatArray, ...]]:
        """Between processes only the knots travel; they are validated again."""
        made = partial(Trajectory, jumps=True) if self.jumps else Trajectory
        return made, (self.time, self.q, self.qd, self.qdd)

    @property
    def time(self) -> FloatArray:
        """Times of the knots (K,), s. Not to be written to, as the states are."""
        return _closed(self._knots[:, 0])

    @property
    def q(self) -> FloatArray:
        """Joint positions at the knots (K, n)."""
        return _closed(self._knots[:, 1 : 1 + self.n])

    @property
    def qd(self) -> FloatArray:
        """Their rates (K, n)."""
        return _closed(self._knots[:, 1 + self.n : 1 + 2 * self.n])

    @property
    def qdd(self) -> FloatArray:
        """Their accelerations (K, n); at a jump, before and after it."""
        return _closed(self._knots[:, 1 + 2 * self.n :])

    @property
    def start(self) -> float:
        return float(self._knots[0, 0])

    @property
    def end(self) -> float:
        return float(self._knots[-1, 0])

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

    @property
    def spline(self) -> Spline:
        """What kernels read (`kernels.spline`): times `tk` (P + 1,), coefficients `c` (P, n, 6) in the time since each
        knot, bounds `whole` (P + 1, 9 n) of every piece; P = K-1 without jumps. Not to be written to."""
        if self._spline is None:
            from assur.planner.kernels.spline import spline_tables

            _, self._spline = spline_tables(self._knots, self.jumps)
        return self._spline

    @property
    def edges(self) -> FloatArray:
        """Begins of the pieces and the end of the last, (P+1,) s: the times of the knots, each once."""
        return self.spline[0]

    @property
    def coefficients(self) -> FloatArray:
        """c0..c5 of q(τ) = Σ c_i τ^i, τ = t − t_k, on every piece: (P, n, 6)."""
        return self.spline[1]

    @property
    def steps(self) -> FloatArray:
        """Lengths of the pieces, (P,) s."""
        return np.asarray(np.diff(self.edges))

    @property
    def knots(self) -> FloatArray:
        """Times, q, q̇, q̈ side by side, (K, 1 + 3n): what kernels take. Not to be written to."""
        return self._knots

    def evaluate(self, t: FloatArray | float, derivative: int = 0) -> FloatArray:
        """q or a derivative (0 to 3) at times `t` (...): (..., n).

        At an inner knot the piece to its right counts (this matters for the jerk alone, and for the acceleration
        where it jumps), at a knot its own numbers come back. Outside [start, end], and for a time that is NaN: NaN.
        """
        t = np.asarray(t, dtype=np.float64)
        return self._states(t.ravel())[:, derivative].reshape(*t.shape, self.n)

    def states(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """q, q̇, q̈ (T, n) at times t (T,) within [start, end]; the end state is exact."""
        found = self._states(t)
        return found[:, 0].copy(), found[:, 1].copy(), found[:, 2].copy()

    def _states(self, t: FloatArray) -> FloatArray:
        """q and its derivatives (T, 4, n) at times t (T,)."""
        from assur.planner.kernels.spline import spline_states

        found = np.empty((len(t), 4, self.n))
        tk, c, _ = self.spline
        spline_states(self._knots, tk, c, np.array(t), found)
        return found

    def state(self, t: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """q, q̇, q̈ at one time, each (n,)."""
        return self.evaluate(t), self.evaluate(t, 1), self.evaluate(t, 2)

    def extrema(self, derivative: int) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest value (n,), (n,) of q or a derivative (0 to 3) over the whole trajectory.

        For the polynomials as they stand, not for samples. The interval given holds every value, and is wider than
        the true range by at most 1e-13 of the largest Bernstein coefficient, plus the rounding of the coefficients.
        Where the acceleration jumps both of its sides count, and the jerk has no bound: −∞ and ∞.
        """
        low, high = self.extremes[derivative]
        return low, high

    @property
    def extremes(self) -> FloatArray:
        """The smallest and the largest value of q and its derivatives as `extrema` has them, (4, 2, n)."""
        if self._extremes is None:
            from assur.planner.kernels.limits import spline_extremes

            found = np.empty((4, 2, self.n))
            spline_extremes(self._knots, found)
            self._extremes = _closed(found)
        return self._extremes


def _closed(array: FloatArray) -> FloatArray:
    array.flags.writeable = False
    return array


# Knots of two motions that meet, put together.

MEETING_ACCELERATION = 1e-6
"""rad/s² or m/s². Motions that differ by more than this where they meet do so by a jump of the acceleration."""


def joined(one: FloatArray, other: FloatArray) -> FloatArray:
    """Knots (K, 1 + 3n) of two motions that meet; at the meeting what ends the first and begins the second, once if
    they agree.

    Where either may jump the meeting may have three or four knots: those in the middle last no time, and go. Time and
    place of the meeting are the first one's.
    """
    n, last, first = (one.shape[1] - 1) // 3, len(one) - 1, 0
    while last > 0 and one[last - 1, 0] == one[last, 0]:
        last -= 1
    while first + 1 < len(other) and other[first + 1, 0] == other[first, 0]:
        first += 1
    begin = np.concatenate([one[last, :-n], other[first, -n:]])
    jumps = (np.abs(begin[-n:] - one[last, -n:]) > MEETING_ACCELERATION).any()
    return np.concatenate([one[: last + 1], *([begin[None]] if jumps else []), other[first + 1 :]])


# Whether a trajectory keeps the joint limits at every instant: exact extrema against limits, accept-if.
#
# Limits are arrays here, each (n,), because robots come after trajectories in the order of the modules.

LIMIT_TOLERANCE = 1e-9
"""Relative; of the range for positions. Knots that lie on a limit round to 1e-16 beyond it and extrema are bounded to
1e-13; a thousand times that is still a thousandth of the excess that anyone may find (1e-6)."""
JERK_TOLERANCE = 1e-6
"""Relative. A jerk is a third difference of the knots' numbers: those of a 10 µs piece round it by some rad/s³, a
hundredth of what anyone may find (1e-4)."""


def accepted_bands(
    lower: FloatArray, upper: FloatArray, velocity: FloatArray, acceleration: FloatArray, jerk: FloatArray | None
) -> FloatArray:
    """What a trajectory within limits, each (n,), may reach: lowest and highest q and derivatives, (4, 2, n).

    Beyond the limits by `LIMIT_TOLERANCE` and `JERK_TOLERANCE`. `jerk` None: it is not limited.
    """
    wide = np.full(len(lower), np.inf) if jerk is None else jerk
    rates = np.array([velocity, acceleration, wide]) * (
        1 + np.array([[LIMIT_TOLERANCE], [LIMIT_TOLERANCE], [JERK_TOLERANCE]])
    )
    slack = LIMIT_TOLERANCE * (upper - lower) / 2
    bands = np.empty((4, 2, len(lower)))
    bands[0] = lower - slack, upper + slack
    bands[1:, 0], bands[1:, 1] = -rates, rates
    return bands


def keeps_bands(trajectory: Trajectory, bands: FloatArray) -> bool:
    """Whether a trajectory stays within `accepted_bands`."""
    from assur.planner.kernels.limits import NONE, first_limit_broken

    return first_limit_broken(trajectory.knots, bands) == NONE
