"""The checker's own curves of a path, from what the request says of it (equations Q1 to Q5).

Arcs are rotations about an axis, splines and corners are polynomials by their control points (Bernstein form). Each
part has a length and a bound of its curvature that holds everywhere on it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.path import ArcTo, LineTo, Path, SplineThrough

CELLS = 512
"""Cells of a polynomial whose lengths are tabled: between their ends a cubic of the arc length is off by 1e-11 of the
length of a cell."""
SMOOTH_RAD, SHARE, PULL = 1e-3, 0.45, 1.75
"""Of rounded corners, as in Q5: what is none; the most that is taken of a part; |dr/du| at the ends, in lengths that
are taken."""
_X, _W = np.polynomial.legendre.leggauss(5)


@dataclass(frozen=True, eq=False)
class Line:
    """From `begin` (3,) along `way` (3,), of length 1."""

    begin: FloatArray
    way: FloatArray
    length: float
    bend: float = 0.0

    def place(self, s: FloatArray) -> FloatArray:
        """Points (T, 3) at arc lengths (T,)."""
        return np.asarray(self.begin + np.outer(s, self.way))

    def state(self, s: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Point, tangent and derivative of the tangent."""
        return self.place(np.array([s]))[0], self.way, np.zeros(3)


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

    def place(self, s: FloatArray) -> FloatArray:
        """Points (T, 3) at arc lengths (T,)."""
        angle = s * self.bend
        return np.asarray(
            self.centre + np.outer(np.cos(angle), self.arm) + np.outer(np.sin(angle), np.cross(self.axis, self.arm))
        )

    def state(self, s: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Point, tangent and derivative of the tangent."""
        p = self.place(np.array([s]))[0]
        out = p - self.centre
        return p, self.bend * np.cross(self.axis, out), -(self.bend**2) * out


@dataclass(frozen=True, eq=False)
class Bezier:
    """The polynomial with control points (D + 1, 3)."""

    control: FloatArray

    @cached_property
    def rates(self) -> FloatArray:
        """Control points of the derivative."""
        return len(self.control[1:]) * np.diff(self.control, axis=0)

    @cached_property
    def seconds(self) -> FloatArray:
        """Control points of the second derivative."""
        return len(self.rates[1:]) * np.diff(self.rates, axis=0)

    @cached_property
    def table(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Parameters (CELLS + 1,), arc lengths there, and derivatives of the first by the second."""
        u = np.arange(CELLS + 1) / CELLS
        inner = ((u[:-1, None] + u[1:, None]) / 2 + _X / (2 * CELLS)).ravel()
        speed = np.linalg.norm(_at(self.rates, inner), axis=1).reshape(CELLS, -1)
        slow = 1.0 / np.maximum(np.linalg.norm(_at(self.rates, u), axis=1), 1e-300)
        return u, np.append(0.0, np.cumsum(speed @ _W / (2 * CELLS))), slow

    @property
    def length(self) -> float:
        """m."""
        return float(self.table[1][-1])

    @property
    def bend(self) -> float:
        """A bound of the curvature, 1/m; infinite where the derivative may vanish."""
        u = self.table[0]
        middle = (u[1:] + u[:-1]) / 2
        thirds = len(self.seconds[1:]) * np.diff(self.seconds, axis=0)
        most = np.linalg.norm(self.seconds, axis=1).max(), np.linalg.norm(thirds, axis=1).max(initial=0.0)
        fast = np.linalg.norm(_at(self.rates, middle), axis=1) - most[0] / (2 * CELLS)
        pull = np.linalg.norm(_at(self.seconds, middle), axis=1) + most[1] / (2 * CELLS)
        return float((pull / fast**2).max()) if (fast > 0.0).all() else math.inf

    def place(self, s: FloatArray) -> FloatArray:
        """Points (T, 3) at arc lengths (T,)."""
        return _at(self.control, self._parameter(s))

    def state(self, s: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Point, tangent and derivative of the tangent."""
        u = self._parameter(np.array([s]))
        first, second = _at(self.rates, u)[0], _at(self.seconds, u)[0]
        square = float(first @ first)
        across = np.cross(np.cross(first, second), first)
        return _at(self.control, u)[0], first / math.sqrt(square), across / square**2

    def _parameter(self, s: FloatArray) -> FloatArray:
        parameter, length, slow = self.table
        i = np.clip(np.searchsorted(length, s, side="right") - 1, 0, CELLS - 1)
        h, step = length[i + 1] - length[i], parameter[i + 1] - parameter[i]
        x = np.clip((s - length[i]) / h, 0.0, 1.0)
        one, other = slow[i] * h, slow[i + 1] * h
        cubic = one + x * (3 * step - 2 * one - other + x * (one + other - 2 * step))
        return np.asarray(parameter[i] + x * cubic)


def _at(control: FloatArray, u: FloatArray) -> FloatArray:
    """De Casteljau's algorithm at parameters (T,): (T, 3)."""
    rows = [np.broadcast_to(each, (len(u), 3)) for each in control]
    w = u[:, None]
    while len(rows) > 1:
        rows = [(1.0 - w) * a + w * b for a, b in pairwise(rows)]
    return np.asarray(rows[0])


Part = Line | Turn | Bezier


@dataclass(frozen=True, eq=False)
class Cut:
    """A part from `begin` to `end`, m along it."""

    part: Part
    begin: float
    end: float

    @property
    def length(self) -> float:
        """m."""
        return self.end - self.begin

    def place(self, s: FloatArray) -> FloatArray:
        """Points (T, 3) at arc lengths (T,) from where it begins."""
        return self.part.place(np.clip(self.begin + s, self.begin, self.end))

    def state(self, s: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Point, tangent and its derivative there."""
        return self.part.state(self.begin + s)


@lru_cache(maxsize=64)
def curves_of(path: Path) -> tuple[Cut, ...]:
    """The parts of a path in order, corners rounded."""
    found: list[Cut] = []
    here = np.array(path.begin)
    for facts in path.parts:
        tangent = found[-1].state(found[-1].length)[1] if found else None
        parts = [Cut(part, 0.0, part.length) for part in _parts(facts, here, tangent)]
        first = parts[0].state(0.0)[1]
        if tangent is not None and math.acos(max(-1.0, min(1.0, float(tangent @ first)))) > SMOOTH_RAD:
            last, behind = found.pop(), parts[0]
            taken = _taken(last, behind, path.blend_m)
            corner = _corner(last, behind, taken)
            found += [Cut(last.part, last.begin, last.end - taken), Cut(corner, 0.0, corner.length)]
            parts[0] = Cut(behind.part, behind.begin + taken, behind.end)
        found += parts
        here = np.array(facts.points[-1] if isinstance(facts, SplineThrough) else facts.to)
    return tuple(found)


def length_of(path: Path) -> float:
    """The length of a path, m, corners rounded."""
    return sum(part.length for part in curves_of(path))


def _parts(facts: LineTo | ArcTo | SplineThrough, here: FloatArray, tangent: FloatArray | None) -> list[Part]:
    if isinstance(facts, SplineThrough):
        return _spline(np.array([here, *facts.points]), tangent)
    to = np.array(facts.to)
    if isinstance(facts, LineTo):
        length = math.dist(here, facts.to)
        return [Line(here, (to - here) / length, length)]
    u, w = np.array(facts.via) - here, to - here
    normal = np.cross(u, w)
    # the centre is as far from all three points, in their plane
    centre = here + np.linalg.solve(np.array([u, w, normal]), np.array([u @ u / 2, w @ w / 2, 0.0]))
    axis, arm = normal / np.linalg.norm(normal), here - centre

    def turned(a: FloatArray, b: FloatArray) -> float:
        return math.atan2(float(axis @ np.cross(a, b)), float(a @ b)) % math.tau

    middle = np.array(facts.via) - centre
    angle = turned(arm, middle) + turned(middle, to - centre)
    return [Turn(centre, arm, axis, angle * float(np.linalg.norm(arm)))]


def _spline(points: FloatArray, tangent: FloatArray | None) -> list[Part]:
    """The cubic spline by its derivatives v at the points, by the lengths of the chords:
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
    v = np.linalg.solve(matrix, right)
    return [
        Bezier(np.array([points[i], points[i] + h[i] * v[i] / 3, points[i + 1] - h[i] * v[i + 1] / 3, points[i + 1]]))
        for i in range(many - 1)
    ]


def _taken(last: Cut, behind: Cut, blend: float) -> float:
    """How much a rounded corner takes of both parts (Q5): regula falsi on how far its middle is from the corner."""
    corner = last.state(last.length)[0]

    def excess(taken: float) -> float:
        p = _corner(last, behind, taken).control
        return math.dist((p[0] + 5 * p[1] + 10 * p[2] + 10 * p[3] + 5 * p[4] + p[5]) / 32, corner) - blend

    low, high = 0.0, SHARE * min(last.part.length, behind.part.length)
    below, above = -blend, excess(high)
    if above <= 0.0:
        return high
    for _ in range(100):
        taken = low - below * (high - low) / (above - below)
        off = excess(taken)
        if off == 0.0 or high - low <= 1e-15 * high:
            return taken
        if off > 0.0:
            high, above, below = taken, off, below / 2
        else:
            low, below, above = taken, off, above / 2
    return (low + high) / 2


def _corner(last: Cut, behind: Cut, taken: float) -> Bezier:
    """The quintic with tangents and curvatures of both parts where they are cut."""
    m = PULL * taken
    p, t, k = last.state(last.length - taken)
    q, w, c = behind.state(taken)
    one, other = p + m / 5 * t, q - m / 5 * w
    return Bezier(np.array([p, one, 2 * one - p + m**2 / 20 * k, 2 * other - q + m**2 / 20 * c, other, q]))
