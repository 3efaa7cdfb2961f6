"""Paths from what a request states of them: lines, arcs and splines, with rounded corners (Q1 to Q5).

Arcs are rotations about an axis; all else are polynomials by their control points (Bernstein form). Each part has a
length, and a bound of its curvature that holds everywhere on it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.path import ArcTo, LineTo, Point, SplineThrough

CELLS = 512
"""Cells of a polynomial whose lengths are tabled: between their ends a cubic of the arc length is off by 1e-11 of the
length of a cell."""
SMOOTH_RAD, SHARE, PULL = 1e-3, 0.45, 1.75
"""Of rounded corners: an angle that needs none; the most that is taken of a part; |dr/du| at the ends, in lengths that
are taken (Q4, Q5)."""
SECTIONS, ROUNDS = 64, 10
"""Into so many sections the range of what a corner may take is divided, and so often the one that is left."""
SLIP_M = 1e-7
"""A chord that reaches into a part by no more is not counted for it, m: places that are compared are rounded."""
X, W = np.polynomial.legendre.leggauss(5)


@dataclass(frozen=True, eq=False)
class Turn:
    """The arm `arm` (3,) about `centre`, turned about the `axis` (3,) at right angles to it."""

    centre: FloatArray
    arm: FloatArray
    axis: FloatArray
    length: float

    @property
    def bend(self) -> float:
        """The curvature, 1/m."""
        return 1.0 / float(np.linalg.norm(self.arm))

    def state(self, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Points (T, 3), tangents and derivatives of the tangents at arc lengths (T,)."""
        angle = (s * self.bend)[:, None]
        aside = np.cross(self.axis, self.arm)
        out, on = np.cos(angle) * self.arm + np.sin(angle) * aside, np.cos(angle) * aside - np.sin(angle) * self.arm
        return self.centre + out, self.bend * on, -(self.bend**2) * out


@dataclass(frozen=True, eq=False)
class Bezier:
    """The polynomial with control points (D + 1, 3); lines are cubics."""

    control: FloatArray

    @cached_property
    def derivatives(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Control points of three derivatives."""
        found = [self.control]
        for _ in range(3):
            found.append(len(found[-1][1:]) * np.diff(found[-1], axis=0))
        return found[1], found[2], found[3]

    @cached_property
    def table(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Parameters (CELLS + 1,), arc lengths there, and derivatives of the first by the second."""
        u, rates = np.arange(CELLS + 1) / CELLS, self.derivatives[0]
        inner = ((u[:-1, None] + u[1:, None]) / 2 + X / (2 * CELLS)).ravel()
        speed = np.linalg.norm(_at(rates, inner), axis=1).reshape(CELLS, -1)
        slow = 1.0 / np.maximum(np.linalg.norm(_at(rates, u), axis=1), 1e-300)
        return u, np.append(0.0, np.cumsum(speed @ W / (2 * CELLS))), slow

    @property
    def length(self) -> float:
        """m."""
        return float(self.table[1][-1])

    @cached_property
    def bend(self) -> float:
        """A bound of the curvature |ṙ × r̈| / |ṙ|³, 1/m: from the middle of each cell ṙ changes by r̈, and ṙ × r̈ by
        ṙ × r⃛. Infinite where ṙ may vanish."""
        middle = self.table[0][:-1] + 0.5 / CELLS
        rate, second = (_at(each, middle) for each in self.derivatives[:2])
        most = [np.linalg.norm(each, axis=1).max() for each in self.derivatives]
        fast = np.linalg.norm(rate, axis=1) - most[1] / (2 * CELLS)
        across = np.linalg.norm(np.cross(rate, second), axis=1) + most[0] * most[2] / (2 * CELLS)
        return float((across / fast**3).max()) if (fast > 0.0).all() else math.inf

    def state(self, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Points (T, 3), tangents and derivatives of the tangents at arc lengths (T,) (Q3)."""
        parameter, length, slow = self.table
        i = np.clip(np.searchsorted(length, s, side="right") - 1, 0, CELLS - 1)
        h, step = length[i + 1] - length[i], parameter[i + 1] - parameter[i]
        x = np.clip((s - length[i]) / h, 0.0, 1.0)
        one, other = slow[i] * h, slow[i + 1] * h
        u = parameter[i] + x * (one + x * (3 * step - 2 * one - other + x * (one + other - 2 * step)))
        first, second = (_at(each, u) for each in self.derivatives[:2])
        square = (first**2).sum(1)[:, None]
        across = np.cross(np.cross(first, second), first)
        return _at(self.control, u), first / np.sqrt(square), across / square**2


def _at(control: FloatArray, u: FloatArray) -> FloatArray:
    """De Casteljau's algorithm at parameters (T,): (T, 3)."""
    rows = [np.broadcast_to(each, (len(u), 3)) for each in control]
    while len(rows) > 1:
        rows = [(1.0 - u[:, None]) * a + u[:, None] * b for a, b in pairwise(rows)]
    return np.asarray(rows[0])


@dataclass(frozen=True, eq=False)
class Cut:
    """A part from `begin` to `end`, m along it."""

    part: Turn | Bezier
    begin: float
    end: float

    def state(self, s: FloatArray | float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Points (T, 3), tangents and their derivatives at arc lengths (T,) from where it begins."""
        return self.part.state(np.clip(self.begin + np.atleast_1d(s), self.begin, self.end))


class Curve:
    """Parts one behind the other, by arc length."""

    def __init__(self, parts: Sequence[Cut]) -> None:
        self.parts = parts
        self.edges = np.append(0.0, np.cumsum([part.end - part.begin for part in parts]))
        self.length = float(self.edges[-1])

    def state(self, s: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Points (T, 3) and tangents at arc lengths (T,)."""
        number = np.clip(np.searchsorted(self.edges, s, side="right") - 1, 0, len(self.parts) - 1)
        found = np.empty((2, len(s), 3))
        for k in np.unique(number).tolist():
            rows = number == k
            found[:, rows] = self.parts[k].state(s[rows] - self.edges[k])[:2]
        return found[0], found[1]

    def bow(self, begin: FloatArray, end: FloatArray) -> FloatArray:
        """How far the curve leaves its chords from `begin` to `end` (T,) at most, m: κ Δs²/8 with the greatest
        curvature, and where parts meet at a small angle that times Δs/4."""
        first = np.searchsorted(self.edges[1:-1], begin + SLIP_M, side="right")
        last = np.searchsorted(self.edges[1:-1], end - SLIP_M, side="left")
        bend = np.zeros(len(begin))
        for k, part in enumerate(self.parts):
            bend[(first <= k) & (k <= last)] = np.maximum(bend, part.part.bend)[(first <= k) & (k <= last)]
        far = end - begin
        return np.asarray(bend * far**2 / 8.0 + (last > first) * SMOOTH_RAD * far / 4.0)


@lru_cache(maxsize=64)
def curve_of(begin: Point, parts: tuple[LineTo | ArcTo | SplineThrough, ...], blend: float) -> Curve:
    """The path from a point along parts, with corners rounded within `blend`, m."""
    found: list[Cut] = []
    here = np.array(begin)
    for facts in parts:
        tangent = found[-1].state(math.inf)[1][0] if found else None
        behind = [Cut(part, 0.0, part.length) for part in _parts(facts, here, tangent)]
        turn = 1.0 if tangent is None else float(tangent @ behind[0].state(0.0)[1][0])
        if math.acos(max(-1.0, min(1.0, turn))) > SMOOTH_RAD:
            last, first = found.pop(), behind[0]
            taken = _taken(last, first, blend)
            corner = Bezier(_corner(last, first, np.array([taken]))[:, 0])
            found += [Cut(last.part, last.begin, last.end - taken), Cut(corner, 0.0, corner.length)]
            behind[0] = Cut(first.part, first.begin + taken, first.end)
        found += behind
        here = np.array(facts.points[-1] if isinstance(facts, SplineThrough) else facts.to)
    return Curve(found)


def _parts(
    facts: LineTo | ArcTo | SplineThrough, here: FloatArray, tangent: FloatArray | None
) -> Sequence[Turn | Bezier]:
    if isinstance(facts, SplineThrough):
        return _spline(np.array([here, *facts.points]), tangent)
    to = np.array(facts.to)
    if isinstance(facts, LineTo):
        return [Bezier(here + np.outer(np.arange(4.0) / 3.0, to - here))]
    u, w = np.array(facts.via) - here, to - here
    normal = np.cross(u, w)
    # the centre is as far from all three points, in their plane (Q1)
    centre = here + np.linalg.solve(np.array([u, w, normal]), np.array([u @ u / 2, w @ w / 2, 0.0]))
    axis, arm, middle = normal / np.linalg.norm(normal), here - centre, np.array(facts.via) - centre

    def turned(a: FloatArray, b: FloatArray) -> float:
        return math.atan2(float(axis @ np.cross(a, b)), float(a @ b)) % math.tau

    return [Turn(centre, arm, axis, (turned(arm, middle) + turned(middle, to - centre)) * float(np.linalg.norm(arm)))]


def _spline(points: FloatArray, tangent: FloatArray | None) -> list[Bezier]:
    """The cubic spline (Q2) by its derivatives v at the points, by the lengths h of the chords with directions d:
    v_(i-1)/h_(i-1) + 2 v_i (1/h_(i-1) + 1/h_i) + v_(i+1)/h_i = 3 (d_(i-1)/h_(i-1) + d_i/h_i)."""
    way = np.diff(points, axis=0)
    h = np.sqrt((way**2).sum(1))
    d, many = way / h[:, None], len(points)
    matrix, right = np.eye(many), np.zeros((many, 3))
    for i in range(1, many - 1):
        matrix[i, i - 1 : i + 2] = 1 / h[i - 1], 2 * (1 / h[i - 1] + 1 / h[i]), 1 / h[i]
        right[i] = 3 * (d[i - 1] / h[i - 1] + d[i] / h[i])
    if tangent is None:
        matrix[0, :2], right[0] = (2.0, 1.0), 3.0 * d[0]
    else:
        right[0] = tangent
    matrix[-1, -2:], right[-1] = (1.0, 2.0), 3.0 * d[-1]
    v = h[:, None] / 3 * np.linalg.solve(matrix, right)[[range(many - 1), range(1, many)]]
    return [Bezier(np.array([a, a + x, b - y, b])) for a, b, x, y in zip(points, points[1:], *v, strict=False)]


def _taken(last: Cut, behind: Cut, blend: float) -> float:
    """How much a rounded corner takes of both parts: so much that its middle is `blend` from the corner (Q5)."""
    corner, low, high = last.state(math.inf)[0][0], 0.0, SHARE * min(last.part.length, behind.part.length)
    for _ in range(ROUNDS):
        tried = np.linspace(low, high, SECTIONS + 1)
        middle = np.tensordot(np.array([1.0, 5.0, 10.0, 10.0, 5.0, 1.0]) / 32.0, _corner(last, behind, tried), 1)
        beyond = np.flatnonzero(np.linalg.norm(middle - corner, axis=1) > blend)
        if not len(beyond):
            return high
        low, high = float(tried[max(beyond[0] - 1, 0)]), float(tried[beyond[0]])
    return low


def _corner(last: Cut, behind: Cut, taken: FloatArray) -> FloatArray:
    """Control points (6, T, 3) of the quintic with tangents and curvatures of both parts where they are cut (Q4)."""
    m = PULL * taken[:, None]
    (p, t, k), (q, w, c) = last.state(last.end - last.begin - taken), behind.state(taken)
    one, other = p + m / 5 * t, q - m / 5 * w
    return np.array([p, one, 2 * one - p + m**2 / 20 * k, 2 * other - q + m**2 / 20 * c, other, q])
