"""What the joints of a line do under a law of its phase, and how long they need for it (equations L2 and L4)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.robots.facts import Limits

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
class Rates:
    """What the joints of a line do under a law: `table` (M, 4, n) holds q' to q'''' by s, `bounds` (n, 3) the limits of
    velocity, acceleration and jerk."""

    table: FloatArray
    bounds: FloatArray

    @staticmethod
    def of(derivatives: tuple[FloatArray, FloatArray, FloatArray], limits: Limits) -> Rates:
        """The fourth derivative, by differences, serves the slopes of the search alone."""
        fourth = np.gradient(derivatives[2], 1 / (len(derivatives[2]) - 1), axis=0)
        bounds = np.stack([limits.velocity, limits.acceleration, limits.jerk], -1)
        return Rates(np.stack([*derivatives, fourth], 1), bounds)

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
