"""Curves by their arc length: straight lines, circular arcs, polynomials; each with its tangent and its curvature.

Equations Q1 to Q5 of docs/kinematics.md. Every method takes arc lengths (T,) in m and gives rows (T, 3).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray

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
    """Σ_k `coefficients`[k] u^k, (6, 3), for u from 0 to 1. `lengths`: arc lengths (STEPS + 1,), m, at even
    parameters."""

    coefficients: FloatArray
    lengths: FloatArray

    @property
    def length(self) -> float:
        """m."""
        return float(self.lengths[-1])

    def at(self, s: FloatArray) -> Along:
        """Point, tangent and curvature (Q3)."""
        return along(self.coefficients[None], self.lengths[None], np.zeros(len(s), dtype=np.int64), s)


def polynomials(coefficients: FloatArray) -> tuple[Polynomial, ...]:
    """The curves of coefficients (P, 6, 3)."""
    edges = np.arange(STEPS) / STEPS
    many = _differentiated(coefficients)[:, None]
    table = np.zeros((len(coefficients), STEPS + 1))
    np.cumsum(_between(many, edges[None], (edges + 1 / STEPS)[None]), axis=1, out=table[:, 1:])
    return tuple(Polynomial(c, lengths) for c, lengths in zip(coefficients, table, strict=True))


def slowest(coefficients: FloatArray) -> FloatArray:
    """The least |dr/du| (P,) of curves of coefficients (P, 6, 3) at many parameters, m: near zero there is a cusp."""
    u = np.linspace(0.0, 1.0, 8 * STEPS + 1)[None]
    return np.asarray(_norm(_sum(_differentiated(coefficients)[:, None], u)).min(1))


def along(coefficients: FloatArray, lengths: FloatArray, curve: IntArray, s: FloatArray) -> Along:
    """Point, tangent and curvature (Q3) at arc lengths s (T,), each on one `curve` (T,) of those with coefficients
    (P, 6, 3) and tables of `lengths` (P, STEPS + 1)."""
    c, table = coefficients[curve], lengths[curve]
    once = _differentiated(c)
    # Newton's method, from the line of the table
    i = np.clip((table <= s[:, None]).sum(1) - 1, 0, STEPS - 1)[:, None]
    low, high = (np.take_along_axis(table, k, 1)[:, 0] for k in (i, i + 1))
    begin = i[:, 0] / STEPS
    u = begin + (s - low) / (high - low) / STEPS
    for _ in range(NEWTON):
        off = low + _between(once, begin, u) - s
        u = u - off / _norm(_sum(once, u))
    u = np.clip(u, 0.0, 1.0)
    first, second = _sum(once, u), _sum(_differentiated(once), u)
    speed = _norm(first)[:, None]
    tangent = first / speed
    bend = second - (second * tangent).sum(1, keepdims=True) * tangent
    return _sum(c, u), tangent, bend / speed**2


def _differentiated(c: FloatArray) -> FloatArray:
    """Coefficients (..., K - 1, 3) of the derivative of polynomials with coefficients (..., K, 3)."""
    return np.asarray(c[..., 1:, :] * np.arange(1, c.shape[-2])[:, None])


def _sum(c: FloatArray, u: FloatArray) -> FloatArray:
    """Values (..., 3) of polynomials with coefficients (..., K, 3) at parameters u (...)."""
    found = np.zeros((*u.shape, 3))
    for k in range(c.shape[-2] - 1, -1, -1):
        found = found * u[..., None] + c[..., k, :]
    return found


def _norm(v: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt((v * v).sum(-1)))


def _between(once: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Arc lengths (...) between parameters a and b (...) of curves whose derivatives have coefficients (..., K, 3), by
    Gauss's rule."""
    u = (a + b)[..., None] / 2 + (b - a)[..., None] / 2 * _X
    return np.asarray((b - a) / 2 * (_norm(_sum(once[..., None, :, :], u)) @ _W))


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
    slope = mean - h[:, None] * (2 * m[:-1] + m[1:]) / 6
    c = np.zeros((n - 1, 6, 3))
    c[:, 0], c[:, 1], c[:, 2] = points[:-1], slope * h[:, None], m[:-1] / 2 * h[:, None] ** 2
    c[:, 3] = (m[1:] - m[:-1]) / 6 * h[:, None] ** 2
    return polynomials(c)


def joining(one: Along, other: Along, speed: float) -> Polynomial:
    """The polynomial of degree 5 from one state of a curve to another, each (1, 3), with tangent and curvature of both
    at its ends; `speed`: |dr/du| there, m (Q4)."""
    (p, t, k), (q, w, c) = ((row[0] for row in state) for state in (one, other))
    v0, a0, v1, a1 = speed * t, speed**2 * k, speed * w, speed**2 * c
    d = q - p
    coefficients = [
        p,
        v0,
        a0 / 2,
        10 * d - 6 * v0 - 4 * v1 - 1.5 * a0 + 0.5 * a1,
        -15 * d + 8 * v0 + 7 * v1 + 1.5 * a0 - a1,
        6 * d - 3 * (v0 + v1) - 0.5 * (a0 - a1),
    ]
    return polynomials(np.array([coefficients]))[0]


def middle_points(one: Along, other: Along, speed: FloatArray) -> FloatArray:
    """The points (T, 3) at u = 1/2 of the polynomials that join states (T, 3) of curves (`joining`); `speed` (T,)."""
    (p, t, k), (q, w, c) = one, other
    v = speed[:, None]
    return np.asarray((p + q) / 2 + 5 / 32 * v * (t - w) + v**2 * (k + c) / 64)
