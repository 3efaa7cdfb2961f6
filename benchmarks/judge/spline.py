"""Quintic Hermite pieces through knots (t, q, q̇, q̈), and where their derivatives are largest.

On a piece of length h with u = (t - t_i) / h in [0, 1], with what the quadratic start leaves over

    r0 = q1 - q0 - h v0 - h² a0 / 2        r1 = h (v1 - v0 - h a0)        r2 = h² (a1 - a0)            (R1)

    q(u) = q0 + h v0 u + h² a0 / 2 u²
           + (10 r0 - 4 r1 + r2/2) u³ + (-15 r0 + 7 r1 - r2) u⁴ + (6 r0 - 3 r1 + r2/2) u⁵                 (R2)

Differences are taken first and powers of h last, so short pieces lose as few digits as they can.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

KNOTS = ("time_s", "position", "velocity", "acceleration")
"""Columns of the trajectory of an answer."""
BISECTIONS = 60
"""Halvings of [0, 1] that leave less than one part in 2⁵³ of it."""


@dataclass(frozen=True, eq=False)
class Spline:
    """Pieces between `time` (K,) in seconds: `coefficients` (K-1, n, 6), ascending in u."""

    time: Floats
    coefficients: Floats

    @staticmethod
    def through(time: Floats, position: Floats, velocity: Floats, acceleration: Floats) -> Spline:
        """The spline through knots at strictly increasing `time` (K,), the rest (K, n)."""
        h = np.diff(time)[:, None]
        q0, v0, a0 = position[:-1], velocity[:-1] * h, acceleration[:-1] * h**2
        r0 = (position[1:] - q0) - v0 - a0 / 2
        r1 = (velocity[1:] - velocity[:-1]) * h - a0
        r2 = (acceleration[1:] - acceleration[:-1]) * h**2
        cubic = 10 * r0 - 4 * r1 + r2 / 2
        quartic = -15 * r0 + 7 * r1 - r2
        quintic = 6 * r0 - 3 * r1 + r2 / 2
        return Spline(time, np.stack([q0, v0, a0 / 2, cubic, quartic, quintic], axis=-1))

    @staticmethod
    def of(spelt: Mapping[str, Any]) -> Spline:
        """The trajectory of an answer; where its acceleration jumps two knots are at one time, and no piece between."""
        time, *columns = (np.array(spelt[key], dtype=np.float64) for key in KNOTS)
        with np.errstate(divide="ignore", invalid="ignore"):
            found = Spline.through(time, *columns)
        lasting = np.diff(time) > 0.0
        return Spline(np.concatenate([time[:-1][lasting], time[-1:]]), found.coefficients[lasting])

    def evaluate(self, t: Floats, derivative: int = 0) -> Floats:
        """q or its `derivative` at times `t` (N,) within the knots: (N, n)."""
        piece = np.clip(np.searchsorted(self.time, t, side="right") - 1, 0, len(self.time) - 2)
        h = self.time[piece + 1] - self.time[piece]
        u = (t - self.time[piece]) / h
        return horner(_derived(self.coefficients, derivative)[piece], u[:, None]) / h[:, None] ** derivative

    def extremes(self, derivative: int) -> tuple[Floats, Floats]:
        """Smallest and largest value (n,) of a derivative over all pieces, between the samples too.

        They are at the ends of a piece or where the next derivative is zero; `zeros` finds all of those.
        """
        polynomial = _derived(self.coefficients, derivative)
        inner = zeros(_derived(polynomial, 1))
        ends = np.zeros((*inner.shape[:-1], 1))
        u = np.concatenate([ends, inner, ends + 1.0], axis=-1)
        h = np.diff(self.time)[:, None, None]
        values = horner(polynomial[..., None, :], u) / h**derivative
        return values.min(axis=(0, 2)), values.max(axis=(0, 2))


def horner(polynomial: Floats, u: Floats) -> Floats:
    """Values of polynomials (..., m+1), ascending, at u (...)."""
    value = np.zeros(np.broadcast_shapes(polynomial.shape[:-1], u.shape))
    for power in reversed(range(polynomial.shape[-1])):
        value = value * u + polynomial[..., power]
    return np.asarray(value, dtype=np.float64)


def zeros(polynomial: Floats) -> Floats:
    """Points (..., m) in [0, 1] among which is every change of sign of polynomials (..., m+1), ascending.

    Between two neighbouring zeros of its derivative a polynomial is monotonic and has one zero at most, which
    bisection finds; so the zeros of the derivative, found in the same way, split [0, 1]. An interval without a change
    of sign gives one of its ends.
    """
    degree = polynomial.shape[-1] - 1
    if degree < 1:
        return np.zeros((*polynomial.shape[:-1], 0))
    inner = np.sort(zeros(_derived(polynomial, 1)), axis=-1)
    edge = np.zeros((*inner.shape[:-1], 1))
    edges = np.concatenate([edge, inner, edge + 1.0], axis=-1)
    low: Floats = edges[..., :-1]
    high: Floats = edges[..., 1:]
    sign = np.sign(horner(polynomial[..., None, :], low))
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        left = np.sign(horner(polynomial[..., None, :], middle)) == sign
        low, high = np.where(left, middle, low), np.where(left, high, middle)
    return (low + high) / 2


def _derived(polynomial: Floats, times: int) -> Floats:
    for _ in range(times):
        polynomial = np.asarray(polynomial[..., 1:] * np.arange(1.0, polynomial.shape[-1]), dtype=np.float64)
    return polynomial
