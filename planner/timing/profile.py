"""A timed motion of n joints: per joint, phases of (all but) constant jerk, exact at both ends.

The solver's cubics, and on top of them one quintic over the whole motion that makes both ends exact
(`assur.planner.timing.ends`). So a phase is a quintic, of which the fourth and fifth order are of the size of that
correction, and quintic Hermite knots carry it exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.timing.ends import Cubics, ended
from assur.planner.timing.writing import MERGE, Knots, clusters, middles, written

State = tuple[FloatArray, FloatArray, FloatArray]
"""q, q̇, q̈, each (n,)."""


@dataclass(frozen=True, eq=False)
class Profile:
    """Motion of n joints over [0, `duration`] s.

    `time` (n, S) begins of the phases of each joint, not decreasing, from 0; phases of length zero are allowed. The
    last begins at the end and holds the end state. `phases` (n, S, 6): coefficients c0..c5 in the time since the
    begin of the phase. `start`, `end`: the states asked for, which the knots at both ends repeat to the bit.
    `limits` (2, n): largest acceleration and jerk that the phases were made for.
    """

    duration: float
    time: FloatArray
    phases: FloatArray
    start: State
    end: State
    limits: FloatArray

    def __post_init__(self) -> None:
        for array in (self.time, self.phases, *self.start, *self.end, self.limits):
            array.flags.writeable = False

    @property
    def n(self) -> int:
        """Number of joints."""
        return len(self.time)

    def evaluate(self, t: FloatArray | float, derivative: int = 0) -> FloatArray:
        """q or a derivative (0 to 3) at times `t` (T,) or one time: (T, n) or (n,). Outside [0, duration]: NaN."""
        t = np.asarray(t, dtype=np.float64)
        flat = t.reshape(-1)
        held = np.minimum(np.maximum(flat, 0.0), self.duration)
        out = self.at(held, self.active(held, "right"))[derivative]
        out[held != flat] = np.nan
        return out.reshape(*t.shape, self.n)

    def states(self, t: FloatArray) -> State:
        """q, q̇, q̈ (T, n) at times `t` (T,) within [0, duration]; NaN for a time that is NaN."""
        return self.at(t, self.active(t, "right"))[:3]

    def active(self, t: FloatArray, side: Literal["left", "right"]) -> IntArray:
        """Per time and joint the phase that is under way at t (right) or ends at t (left), (T, n)."""
        past = np.array([row.searchsorted(t, side) for row in self.time])
        return np.asarray(np.maximum(past.T - 1, 0))

    def at(self, t: FloatArray, phase: IntArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
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

    def _moving(self, tau: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """q, q̇, q̈ of every phase at times `tau` (..., n, S) since its begin."""
        q, v, a = (np.zeros_like(tau) for _ in range(3))
        for k in range(5, -1, -1):
            a = a * tau + v
            v = v * tau + q
            q = q * tau + self.phases[..., k]
        return q, v, 2 * a

    def switches(self) -> FloatArray:
        """Times at which a jerk jumps, of all joints, those closer than `MERGE` as one; both ends exactly."""
        return middles(self, *clusters(self, MERGE))

    def knots(self, offset: float = 0.0) -> Knots:
        """Knots (time, q, q̇, q̈) at all switches, for a motion that begins at `offset` s.

        First and last state are the ones asked for, to the bit. A joint whose own switch is not on the knot gets a
        state between its polynomials before and after. States belong to the rounded times, and are chosen so that
        short pieces keep their jerk (`assur.planner.timing.writing`). Raises `FaultError` for a motion of no duration.
        """
        return written(self, offset)

    def extrema(self) -> tuple[FloatArray, FloatArray]:
        """Smallest and largest position (n,), (n,), in closed form: stationary points of the cubics, mended once.

        What the correction P1 adds in fourth and fifth order is met by one step of Newton's method. What runs is the
        spline through the knots: its own extrema decide.
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
        _, slope, bend = self._moving(tau)
        step = np.divide(slope, bend, out=np.zeros_like(tau), where=bend != 0)
        mended = np.where((tau > 0) & (tau < length), np.clip(tau - step, 0.0, length), tau)
        value = self._moving(mended)[0]
        value = np.append(value.swapaxes(0, 1).reshape(self.n, -1), np.stack([self.start[0], self.end[0]], 1), 1)
        return value.min(1), value.max(1)


def finished(joints: list[Cubics], states: list[list[float]], duration: float) -> Profile:
    """The profile of these phases, its ends made exact: `states` are q, q̇, q̈ at the start, then at the end."""
    time, phases = ended(joints, states, duration)
    ends = np.array(states)
    limits = np.array([[joint.acceleration for joint in joints], [joint.jerk for joint in joints]])
    return Profile(duration, time, phases, (ends[0], ends[1], ends[2]), (ends[3], ends[4], ends[5]), limits)
