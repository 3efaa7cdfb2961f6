"""A path that the tool point takes in a frame: straight parts, arcs and splines, and corners rounded between them.

The facts are what a request says (`LineTo`, `ArcTo`, `SplineThrough`); the curve by its arc length follows from them
(equations Q1 to Q5 of docs/kinematics.md). The checker derives it a second time.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.errors import InputError
from assur.planner.geometry.curves import (
    Along,
    Circular,
    Curve,
    Polynomial,
    Straight,
    along,
    circle_through,
    joining,
    middle_points,
    slowest,
    spline_through,
)
from assur.planner.model.deadline import raise_if_late

Point = tuple[float, float, float]

CLOSEST_M = 1e-5
"""Points of a path are farther from each other than this, m: nearer ones are a slip or rounding."""
LARGEST_RADIUS_M = 100.0
"""An arc of a larger radius is a line, m: its middle is 1 µm off a chord of 30 mm."""
TANGENT_RAD = 1e-3
"""Parts that meet at a smaller angle are smooth: points that are written in µm turn a part of 2 mm by as much."""
SHARPEST_RAD = math.radians(170.0)
"""A corner that turns by more is not rounded: the way would go back where it came from."""
SHARE = 0.45
"""Of the shorter part at a corner, the most that the rounding takes: both ends of a part may be rounded."""
PULL = 1.75
"""|dr/du| at both ends of a rounded corner, in lengths that it takes of the parts: the curvature then rises and falls
once, and the middle is nearest to the corner."""
SECTIONS, ROUNDS = 64, 10
"""Into so many sections the range of what a corner may take is divided, and so often the one that is left: by 2^60."""
BLOCK = 2048
"""Arc lengths between two readings of the clock."""
CUSP = 0.05
"""A spline whose |dr/du| falls below this share of its chord turns too sharply to be followed."""

LONGEST_S = 600.0
"""Longest time of the tool on one path, s: a check of a path evaluates it every 2 ms from its begin to its end."""


class PathError(InputError):
    """Part `number` of a path cannot be: `key` of it is wrong (empty: the whole part)."""

    def __init__(self, number: int, key: str, value: object, allowed: str) -> None:
        super().__init__(f"path[{number}]" + (f".{key}" if key else ""), value, allowed)
        self.number, self.key = number, key

    def __reduce__(self) -> tuple[type[PathError], tuple[object, ...]]:  # type: ignore[override]
        return type(self), (self.number, self.key, self.value, self.allowed)


@dataclass(frozen=True, slots=True)
class LineTo:
    """Straight on to `to`, m."""

    to: Point


@dataclass(frozen=True, slots=True)
class ArcTo:
    """Along the circle through `via` to `to`, m."""

    via: Point
    to: Point


@dataclass(frozen=True, slots=True)
class SplineThrough:
    """Along a cubic spline through points, m; the last is its end."""

    points: tuple[Point, ...]


PathPart = LineTo | ArcTo | SplineThrough


def end_of(part: PathPart) -> Point:
    """The last point of a part."""
    return part.points[-1] if isinstance(part, SplineThrough) else part.to


@dataclass(frozen=True, slots=True)
class Junction:
    """Where two parts of a curve meet, `at` m from its beginning: how much the curvature differs, 1/m."""

    at: float
    jump: float


class PathCurve:
    """Parts of curves, one behind the other, as one curve by arc length: from 0 to `length`, m, and straight on beyond
    both ends."""

    def __init__(self, parts: list[tuple[Curve, float, float]]) -> None:
        self.parts = parts
        self.edges = np.append(0.0, np.cumsum([end - begin for _, begin, end in parts]))
        self.length = float(self.edges[-1])
        self._begins, self._ends = (np.array([part[k] for part in parts]) for k in (1, 2))
        many = [k for k, part in enumerate(parts) if isinstance(part[0], Polynomial)]
        curves = [part[0] for part in parts if isinstance(part[0], Polynomial)]
        self._polynomial = np.full(len(parts), -1)
        self._polynomial[many] = np.arange(len(many))
        """Which of the polynomials each part is; -1: none."""
        self._coefficients = np.array([curve.coefficients for curve in curves])
        self._lengths = np.array([curve.lengths for curve in curves])

    def at(self, s: FloatArray) -> Along:
        """Points (T, 3), tangents and curvatures at arc lengths (T,); at a junction those of the part behind it. Raises
        `OutOfTimeError` where the deadline in force passes."""
        found = np.zeros((3, len(s), 3))
        for first in range(0, len(s), BLOCK):
            raise_if_late()
            rows = slice(first, first + BLOCK)
            found[:, rows] = self._block(s[rows])
        return found[0], found[1], found[2]

    def _block(self, s: FloatArray) -> FloatArray:
        """What `at` gives (3, T, 3)."""
        number = np.clip(np.searchsorted(self.edges, s, side="right") - 1, 0, len(self.parts) - 1)
        begin, end = self._begins[number], self._ends[number]
        found = self._on(number, np.clip(s - self.edges[number] + begin, begin, end))
        for rows, edge in ((s < 0.0, 0.0), (s > self.length, self.length)):
            found[0, rows] += (s[rows] - edge)[:, None] * found[1, rows]
            found[2, rows] = 0.0
        return found

    def _on(self, number: IntArray, own: FloatArray) -> FloatArray:
        """Points, tangents and curvatures (3, T, 3) on parts `number` (T,), at their `own` arc lengths (T,)."""
        found = np.zeros((3, len(own), 3))
        polynomial = self._polynomial[number]
        among = polynomial >= 0
        if among.any():
            found[:, among] = along(self._coefficients, self._lengths, polynomial[among], own[among])
        for k in np.unique(number[~among]).tolist():
            rows = number == k
            for target, value in zip(found, self.parts[k][0].at(own[rows]), strict=True):
                target[rows] = value
        return found

    @cached_property
    def junctions(self) -> tuple[Junction, ...]:
        """All junctions, the two ends among them, where the curve goes on straight."""
        none, every = np.zeros((1, 3)), np.arange(len(self.parts))
        before = np.concatenate([none, self._on(every, self._ends)[2]])
        behind = np.concatenate([self._on(every, self._begins)[2], none])
        jumps = np.linalg.norm(behind - before, axis=1)
        return tuple(Junction(at, jump) for at, jump in zip(self.edges.tolist(), jumps.tolist(), strict=True))


def _begin(part: tuple[Curve, float, float]) -> Along:
    return part[0].at(np.array([part[1]]))


def _end(part: tuple[Curve, float, float]) -> Along:
    return part[0].at(np.array([part[2]]))


@dataclass(frozen=True)
class Path:
    """From `begin`, m in a frame, along `parts`; corners are rounded so that the way passes them within `blend_m`.
    Making it raises `OutOfTimeError` where the deadline in force passes.

    Raises `PathError` for points that coincide, arcs whose three points are on a line or that are larger than
    `LARGEST_RADIUS_M`, splines with a cusp, and corners where nothing is rounded or that turn back.
    """

    begin: Point
    parts: tuple[PathPart, ...]
    blend_m: float = 0.0

    def __post_init__(self) -> None:
        if not self.parts:
            raise InputError("path", self.parts, "at least one part")
        if not 0.0 <= self.blend_m < math.inf:
            raise InputError("blend_m", self.blend_m, "a finite length from 0 on")
        if not self.curve.length > 0.0:
            raise InputError("path", self.parts, "a path that is longer than nothing")

    @cached_property
    def curve(self) -> PathCurve:
        """The curve by arc length."""
        found: list[tuple[Curve, float, float]] = []
        here = np.array(self.begin)
        for number, part in enumerate(self.parts):
            raise_if_late()
            tangent = None if not found else _end(found[-1])[1][0]
            pieces = _curves(number, part, here, tangent)
            found += self._rounded(number, found, pieces)
            here = np.array(end_of(part))
        return PathCurve(found)

    @property
    def length(self) -> float:
        """m, with corners rounded."""
        return self.curve.length

    @property
    def end(self) -> Point:
        """The last point."""
        return end_of(self.parts[-1])

    def _rounded(
        self, number: int, before: list[tuple[Curve, float, float]], pieces: tuple[Curve, ...]
    ) -> list[tuple[Curve, float, float]]:
        """What follows: the pieces of a part, and before them the corner to it; the last of `before` is cut for it."""
        behind = [(piece, 0.0, piece.length) for piece in pieces]
        if not before:
            return behind
        last, first = before[-1], behind[0]
        ends, begins = _end(last), _begin(first)
        turn = math.atan2(float(np.linalg.norm(np.cross(ends[1][0], begins[1][0]))), float(ends[1][0] @ begins[1][0]))
        if turn <= TANGENT_RAD:
            return behind
        if not self.blend_m > 0.0:
            allowed = (
                "a part that goes on along the tangent of the one before it, or a blend to round the corner of "
                f"{math.degrees(turn):.4g} deg"
            )
            raise PathError(number, "", self.parts[number], allowed)
        if turn > SHARPEST_RAD:
            allowed = f"a corner of {math.degrees(SHARPEST_RAD):g} deg at most, not of {math.degrees(turn):.4g} deg"
            raise PathError(number, "", self.parts[number], allowed)
        taken = corner_length(last, first, self.blend_m, last[0].length)
        corner = _corner(last, first, taken)
        before[-1] = (last[0], last[1], last[2] - taken)
        return [(corner, 0.0, corner.length), (first[0], first[1] + taken, first[2]), *behind[1:]]


def corner_length(
    last: tuple[Curve, float, float], first: tuple[Curve, float, float], blend: float, whole: float
) -> float:
    """How much, m, the rounding of a corner takes of the parts on both sides: so much that its middle is `blend` from
    the corner (Q5), and `SHARE` of the shorter of them at most. `whole`: length of the one before, uncut."""
    corner = _end(last)[0][0]

    def off(taken: FloatArray) -> FloatArray:
        ends, begins = last[0].at(last[2] - taken), first[0].at(first[1] + taken)
        return np.asarray(np.linalg.norm(middle_points(ends, begins, PULL * taken) - corner, axis=1))

    low, high = 0.0, SHARE * min(whole, first[0].length)
    if off(np.array([high]))[0] <= blend:
        return high
    for _ in range(ROUNDS):
        tried = np.linspace(low, high, SECTIONS + 1)
        beyond = np.append(off(tried[1:-1]) > blend, True)
        k = int(beyond.argmax())
        low, high = float(tried[k]), float(tried[k + 1])
    return low


def _corner(last: tuple[Curve, float, float], first: tuple[Curve, float, float], taken: float) -> Polynomial:
    ends = last[0].at(np.array([last[2] - taken]))
    begins = first[0].at(np.array([first[1] + taken]))
    return joining(ends, begins, PULL * taken)


def never(parts: Sequence[PathPart]) -> None:
    """Raises `PathError` for what is wrong with the points of a path wherever it begins."""
    here = None
    for number, part in enumerate(parts):
        _points(number, part, here)
        here = np.array(end_of(part))


def _curves(number: int, part: PathPart, here: FloatArray, tangent: FloatArray | None) -> tuple[Curve, ...]:
    """The curves of one part that begins at `here` (3,), behind one that ends along `tangent`."""
    arc = _points(number, part, here)
    if isinstance(part, SplineThrough):
        points = np.array([here, *part.points])
        splines = spline_through(points, tangent)
        least = slowest(np.array([spline.coefficients for spline in splines]))
        for k, slow in enumerate(least.tolist()):
            if not slow >= CUSP * float(np.linalg.norm(points[k + 1] - points[k])):
                allowed = "points through which a spline has no cusp: nearer to each other where it turns"
                raise PathError(number, "points", part.points[k], allowed)
        return splines
    if arc is not None:
        return (arc,)
    to = np.array(part.to)
    length = float(np.linalg.norm(to - here))
    return (Straight(here, (to - here) / length, length),)


def _points(number: int, part: PathPart, here: FloatArray | None) -> Circular | None:
    """The circle of an arc, if it is known where it begins (3,). Raises `PathError` where points coincide, and where
    those of an arc are on a line."""
    if isinstance(part, SplineThrough):
        points = [*([] if here is None else [tuple(here.tolist())]), *part.points]
        for one, other in pairwise(points):
            _apart(number, "points", other, one, "the one before it")
        return None
    if here is not None:
        _apart(number, "to", part.to, tuple(here.tolist()), "where the part begins")
    if isinstance(part, LineTo):
        return None
    if here is not None:
        _apart(number, "via", part.via, tuple(here.tolist()), "where the arc begins")
    _apart(number, "via", part.via, part.to, "where the arc ends")
    if here is None:
        return None
    arc = circle_through(here, np.array(part.via), np.array(part.to))
    if arc is None or not arc.radius <= LARGEST_RADIUS_M:
        allowed = (
            f"a point beside the line from {_in_mm(here.tolist())} to {_in_mm(part.to)}, on a circle of "
            f"{LARGEST_RADIUS_M:g} m at most; or a line"
        )
        raise PathError(number, "via", part.via, allowed)
    return arc


def _apart(number: int, key: str, point: Point, other: Point, what: str) -> None:
    """Raises `PathError` at a point that is too near another one, described by `what`."""
    if not math.dist(point, other) > CLOSEST_M:
        allowed = f"points that are more than {1e3 * CLOSEST_M:g} mm apart; {_in_mm(other)} is {what}"
        raise PathError(number, key, point, allowed)


def _in_mm(point: Sequence[float]) -> str:
    return "({}) mm".format(", ".join(f"{round(1e3 * x, 4) + 0.0:g}" for x in point))
