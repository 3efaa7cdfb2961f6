"""Curves by their arc length: straight lines, circular arcs, polynomials; each with its tangent and its curvature.

Equations Q1 to Q5 of docs/kinematics.md. Every method takes arc lengths (T,) in m and gives rows (T, 3).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from assur.planner.arrays import FloatArray

Along = tuple[FloatArray, FloatArray, FloatArray]
"""Point (T, 3) m, tangent (T, 3) of length 1, and derivative of the tangent by arc length (T, 3) 1/m."""
STEPS = 128
"""Parts of a polynomial curve whose lengths are tabled."""
NEWTON = 6
"""Steps from an arc length to a parameter: from the table's line each squares an error of some percent."""
_X, _W = np.polynomial.legendre.leggauss(8)


@dataclass(frozen=True, eq=False)
class Straight:
    """From `begin` (3,) along `direction` (3,) of length 1."""

    begin: FloatArray
    direction: FloatArray
    length: float

    def at(self, s: FloatArray) -> Along:
        """Point, tangent and curvature."""
        tangent = np.broadcast_to(self.direction, (len(s), 3))
        return self.begin + s[:, None] * self.direction, tangent, np.zeros((len(s), 3))


@dataclass(frozen=True, eq=False)
class Circular:
    """About `centre` (3,) from centre + radius · `first` towards centre + radius · `second`, which are at right angles
    and of length 1 (Q1)."""

    centre: FloatArray
    first: FloatArray
    second: FloatArray
    radius: float
    length: float

    def at(self, s: FloatArray) -> Along:
        """Point, tangent and curvature."""
        angle = s[:, None] / self.radius
        out = np.cos(angle) * self.first + np.sin(angle) * self.second
        tangent = np.cos(angle) * self.second - np.sin(angle) * self.first
        return self.centre + self.radius * out, tangent, -out / self.radius


@dataclass(frozen=True, eq=False)
class Polynomial:
    """Σ_k `coefficients`[k] u^k, (6, 3), for u from 0 to 1."""

    coefficients: FloatArray

    @cached_property
    def length(self) -> float:
        """m."""
        return float(self._lengths[-1])

    @cached_property
    def slowest(self) -> float:
        """The least |dr/du| at many parameters, m: near zero the curve has a cusp."""
        return float(np.linalg.norm(self._derivative(np.linspace(0.0, 1.0, 8 * STEPS + 1), 1), axis=1).min())

    def at(self, s: FloatArray) -> Along:
        """Point, tangent and curvature (Q3)."""
        u = self._parameter(s)
        first, second = self._derivative(u, 1), self._derivative(u, 2)
        speed = np.linalg.norm(first, axis=1, keepdims=True)
        tangent = first / speed
        bend = second - (second * tangent).sum(1, keepdims=True) * tangent
        return self._derivative(u, 0), tangent, bend / speed**2

    def _derivative(self, u: FloatArray, order: int) -> FloatArray:
        c = self.coefficients
        for _ in range(order):
            c = c[1:] * np.arange(1, len(c))[:, None]
        found = np.zeros((len(u), 3))
        for row in c[::-1]:
            found = found * u[:, None] + row
        return found

    @cached_property
    def _lengths(self) -> FloatArray:
        """Arc lengths (STEPS + 1,) at even parameters."""
        edges = np.arange(STEPS) / STEPS
        return np.append(0.0, np.cumsum(self._between(edges, edges + 1 / STEPS)))

    def _between(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Arc lengths (T,) between parameters, by Gauss's rule."""
        u = (a + b)[:, None] / 2 + (b - a)[:, None] / 2 * _X
        speed = np.linalg.norm(self._derivative(u.ravel(), 1), axis=1).reshape(u.shape)
        return np.asarray((b - a) / 2 * (speed @ _W))

    def _parameter(self, s: FloatArray) -> FloatArray:
        """Parameters (T,) at arc lengths, by Newton's method."""
        table = self._lengths
        i = np.clip(np.searchsorted(table, s, side="right") - 1, 0, STEPS - 1)
        begin = i / STEPS
        u = begin + (s - table[i]) / (table[i + 1] - table[i]) / STEPS
        for _ in range(NEWTON):
            off = table[i] + self._between(begin, u) - s
            u = u - off / np.linalg.norm(self._derivative(u, 1), axis=1)
        return np.clip(u, 0.0, 1.0)


Curve = Straight | Circular | Polynomial


def circle_through(begin: FloatArray, via: FloatArray, end: FloatArray) -> Circular | None:
    """The arc from `begin` through `via` to `end` (Q1); None where the three are on a line, to within rounding."""
    u, w = via - begin, end - begin
    normal = np.cross(u, w)
    square = float(normal @ normal)
    if not square > (1e-9 * float(np.linalg.norm(u) * np.linalg.norm(w))) ** 2:
        return None
    centre = begin + np.cross((u @ u) * w - (w @ w) * u, normal) / (2.0 * square)
    out, last = begin - centre, end - centre
    radius = float(np.linalg.norm(out))
    first = out / radius
    second = np.cross(normal / np.sqrt(square), first)
    sweep = float(np.arctan2(last @ second, last @ first)) % (2.0 * np.pi)
    return Circular(centre, first, second, radius, radius * sweep)


def spline_through(points: FloatArray, tangent: FloatArray | None) -> tuple[Polynomial, ...]:
    """The cubic spline through points (N, 3), by the lengths of its chords (Q2): it begins along `tangent`, or without
    curvature where that is None, and ends without curvature."""
    chord = np.diff(points, axis=0)
    h = np.linalg.norm(chord, axis=1)
    mean, n = chord / h[:, None], len(points)
    matrix, right = np.zeros((n, n)), np.zeros((n, 3))
    # second derivatives: continuous slopes inside, and what holds at the ends
    for i in range(1, n - 1):
        matrix[i, i - 1 : i + 2] = h[i - 1] / 6, (h[i - 1] + h[i]) / 3, h[i] / 6
        right[i] = mean[i] - mean[i - 1]
    matrix[0, 0] = matrix[-1, -1] = 1.0
    if tangent is not None:
        matrix[0, :2], right[0] = (h[0] / 3, h[0] / 6), mean[0] - tangent
    m = np.linalg.solve(matrix, right)
    found = []
    for i in range(n - 1):
        slope = mean[i] - h[i] * (2 * m[i] + m[i + 1]) / 6
        c = np.zeros((6, 3))
        c[:4] = points[i], slope * h[i], m[i] / 2 * h[i] ** 2, (m[i + 1] - m[i]) / 6 * h[i] ** 2
        found.append(Polynomial(c))
    return tuple(found)


def joining(one: Along, other: Along, speed: float) -> Polynomial:
    """The polynomial of degree 5 from one state of a curve to another, each (1, 3), with tangent and curvature of both
    at its ends; `speed`: |dr/du| there, m (Q4)."""
    (p, t, k), (q, w, c) = ((row[0] for row in state) for state in (one, other))
    v0, a0, v1, a1 = speed * t, speed**2 * k, speed * w, speed**2 * c
    d = q - p
    return Polynomial(
        np.array(
            [
                p,
                v0,
                a0 / 2,
                10 * d - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1,
                -15 * d + 8 * v0 + 7 * v1 + 1.5 * a0 - a1,
                6 * d - 3 * (v0 + v1) - 0.5 * (a0 - a1),
            ]
        )
    )
