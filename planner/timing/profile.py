"""A timed motion of n joints: per joint, phases of (all but) constant jerk, exact at both ends.

The solver's cubics, and on top of them one quintic over the whole motion that makes both ends exact
(`planner.timing.ends`). So a phase is a quintic, of which the fourth and fifth order are of the size of that
correction, and quintic Hermite knots carry it exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from planner.arrays import BoolArray, FloatArray, IntArray
from planner.errors import FaultError
from planner.timing.ends import Cubics, ended
from planner.trajectory.hermite import hulls
from planner.trajectory.rounding import defect, moved, settled

MERGE = 1e-6
"""s. Switches closer than this share one knot. From 1 µs up, velocities as doubles know a jerk to 0.03 rad/s³; a
switch of jerk J that is off its knot by δ costs a jerk of up to 9 J δ/h on a neighbouring piece of length h, so δ is
kept far below the shortest pieces that count."""
CROWD = 5e-5
"""s. Two pieces in a row below this, or one at an end, cannot shed their rounding on long neighbours."""
WIDER = (4e-6, 1.6e-5)
"""s. Merges that are tried there besides."""
COINCIDENT = 1e-12
"""s. Switches of several joints this close are one: J δ/h is lost in rounding for every h above `MERGE`."""

Knots = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Times (K,), q, q̇, q̈ (K, n)."""
State = tuple[FloatArray, FloatArray, FloatArray]
"""q, q̇, q̈, each (n,)."""


@dataclass(frozen=True, eq=False)
class Profile:
    """Motion of n joints over [0, `duration`] s.

    `time` (n, S) begins of the phases of each joint, not decreasing, from 0; phases of length zero are allowed. The
    last begins at the end and holds the end state. `phases` (n, S, 6): coefficients c0..c5 in the time since the
    begin of the phase. `start`, `end`: the states asked for, which the knots at both ends repeat to the bit.
    """

    duration: float
    time: FloatArray
    phases: FloatArray
    start: State
    end: State

    def __post_init__(self) -> None:
        for array in (self.time, self.phases, *self.start, *self.end):
            array.flags.writeable = False

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.time)

    def evaluate(self, t: FloatArray | float, derivative: int = 0) -> FloatArray:
        """q or a derivative (0 to 3) at times `t` (T,) or one time: (T, n) or (n,). Outside [0, duration]: NaN."""
        t = np.asarray(t, dtype=np.float64)
        flat = t.reshape(-1)
        out = self._at(flat, self._active(flat, "right"))[derivative]
        out[~((flat >= 0) & (flat <= self.duration))] = np.nan
        return out.reshape(*t.shape, self.n)

    def _active(self, t: FloatArray, side: Literal["left", "right"]) -> IntArray:
        """Per time and joint the phase that is under way at t (right) or ends at t (left), (T, n)."""
        past = np.array([row.searchsorted(t, side) for row in self.time])
        return np.asarray(np.maximum(past.T - 1, 0))

    def _at(self, t: FloatArray, phase: IntArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """q, q̇, q̈, q⃛ (T, n) at t (T,) by the polynomials of the given phases (T, n)."""
        joint = np.arange(self.n)
        tau = t[:, None] - self.time[joint, phase]
        c = self.phases[joint, phase]
        q, v = c[..., 5] * tau + c[..., 4], c[..., 5]
        a = jerk = np.zeros_like(tau)
        # Horner's scheme for a polynomial and its derivatives at once; a and the jerk lack their factors 2 and 6.
        for k in (3, 2, 1, 0):
            jerk = jerk * tau + a
            a = a * tau + v
            v = v * tau + q
            q = q * tau + c[..., k]
        return q, v, 2 * a, 6 * jerk

    def _clusters(self, merge: float) -> tuple[FloatArray, FloatArray]:
        """Begins and ends of the clusters of switches that share a knot, from 0 to the duration."""
        times = np.sort(self.time, axis=None).tolist()
        last = self.duration
        low, high = [0.0], [0.0]
        for t in times:
            if t > last - merge:
                break
            if t < low[-1] + merge:
                high[-1] = t
            else:
                low.append(t)
                high.append(t)
        low.append(next(t for t in times if t > last - merge))
        high.append(last)
        return np.array(low), np.array(high)

    def switches(self) -> FloatArray:
        """Times at which a jerk jumps, of all joints, those closer than `MERGE` as one; both ends exactly."""
        low, high = self._clusters(MERGE)
        return self._middles(low, high)

    def _middles(self, low: FloatArray, high: FloatArray) -> FloatArray:
        out = (low + high) / 2
        out[0], out[-1] = 0.0, self.duration
        return np.asarray(out)

    def knots(self, offset: float = 0.0) -> Knots:
        """Knots (time, q, q̇, q̈) at all switches, for a motion that begins at `offset` s.

        First and last state are the ones asked for, to the bit. A joint whose own switch is not on the knot gets a
        state between its polynomials before and after, weighted so that the longer piece bears the jump of its jerk.
        States belong to the rounded times and velocities are settled so that short pieces keep their jerk
        (`planner.trajectory.rounding`). Where short pieces crowd, wider merges are tried and the one with the least
        jerk is taken. Raises `FaultError` for a motion of no duration.
        """
        if not self.duration > 0:
            raise FaultError("a motion of no duration has no knots")
        knots = self._knots(offset, MERGE)
        short = knots[0][1:] - knots[0][:-1] < CROWD
        if short[0] or short[-1] or (short[1:] & short[:-1]).any():
            knots = min((knots, *(self._knots(offset, merge) for merge in WIDER)), key=self._jerk_ratio)
        return knots

    def _jerk_ratio(self, knots: Knots) -> float:
        """Largest jerk of the spline through `knots`, in units of the largest of the phases, over all joints."""
        time, *states = knots
        spline = np.abs(hulls(time[1:] - time[:-1], *states)[3]).max((0, 2))
        phases = 6 * np.abs(self.phases[..., 3]).max(1)
        return float((spline[phases > 0] / phases[phases > 0]).max(initial=0.0))

    def _knots(self, offset: float, merge: float) -> Knots:
        low, high = self._clusters(merge)
        t = self._middles(low, high)
        time, rest = moved(t, offset)
        h = time[1:] - time[:-1]
        states = list(self._at(t, self._active(high, "right"))[:3])
        spread = high - low > COINCIDENT
        if spread.any():
            self._blend(states, t, low, spread)
        wait = -rest[:, None]
        q, qd, qdd = states[0] + wait * states[1], states[1] + wait * states[2], states[2]
        for k, state in ((0, self.start), (-1, self.end)):
            q[k], qd[k], qdd[k] = state
        left_over = defect(h, q, qd, qdd)
        left_over[spread[1:] | spread[:-1]] = 0.0
        return time, q, *settled(h, qd, qdd, left_over)

    def _blend(self, states: list[FloatArray], t: FloatArray, low: FloatArray, spread: BoolArray) -> None:
        """Mix, at knots whose switches are spread, the polynomials before and after; never at the ends."""
        inner = np.flatnonzero(spread)
        inner = inner[(inner > 0) & (inner < len(t) - 1)]
        phase = self._active(low[inner], "left")
        before, after = t[inner] - t[inner - 1], t[inner + 1] - t[inner]
        left = (after / (before + after))[:, None]
        for state, before_it in zip(states, self._at(t[inner], phase), strict=False):
            state[inner] = left * before_it + (1 - left) * state[inner]

    def extrema(self) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest position (n,), (n,), in closed form: stationary points of the cubics.

        Fourth and fifth order, which are of the size of the correction P1, enter at second order only. What runs is
        the spline through the knots: its own extrema decide.
        """
        length = np.append(self.time[:, 1:], np.full((self.n, 1), self.duration), 1) - self.time
        c1, c2, c3 = self.phases[..., 1], self.phases[..., 2], self.phases[..., 3]
        root = np.sqrt(np.maximum(c2 * c2 - 3 * c1 * c3, 0.0))
        # Both roots without cancellation: w = −(c2 ± root), τ = w/(3 c3) and τ = c1/w; a division by zero is no root.
        w = -(c2 + np.copysign(root, c2))
        zero = np.zeros_like(w)
        roots = np.stack(
            [
                length,
                np.divide(w, 3 * c3, out=zero.copy(), where=c3 != 0),
                np.divide(c1, w, out=zero.copy(), where=w != 0),
            ]
        )
        tau = np.where((roots > 0) & (roots <= length), roots, 0.0)
        value = self.phases[..., 5]
        for k in range(4, -1, -1):
            value = value * tau + self.phases[..., k]
        value = np.append(value.swapaxes(0, 1).reshape(self.n, -1), np.stack([self.start[0], self.end[0]], 1), 1)
        return value.min(1), value.max(1)


def finished(joints: list[Cubics], states: list[list[float]], duration: float) -> Profile:
    """The profile of these phases, its ends made exact: `states` are q, q̇, q̈ at the start, then at the end."""
    time, phases = ended(joints, states, duration)
    ends = np.array(states)
    return Profile(duration, time, phases, (ends[0], ends[1], ends[2]), (ends[3], ends[4], ends[5]))
