"""Distance of two convex units and the normal that shows it, by GJK on support points.

Used where the likely normals of `assur.planner.collision.support_gaps` fail: one pair at one time. The result is not
trusted, it is a
normal to try: what is claimed is the support gap along it. Algorithm: E. G. Gilbert, D. W. Johnson, S. S. Keerthi,
IEEE J. Robotics and Automation 4 (1988) 193; nearest point of a simplex by Voronoi regions.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.support_gaps import Placed

Vector = tuple[float, float, float]
Support = Callable[[Vector], Vector]

ITERATIONS = 64
"""Polytopes end after a dozen; round bodies converge linearly and are near enough by then."""
RELATIVE = 1e-6
"""The search ends when the support gap is within this fraction of the distance (1.1 clearances must certify)."""
ABSOLUTE_M = 1e-10
"""... or within this length of it, m."""


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _sub(a: Vector, b: Vector) -> Vector:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _cross(a: Vector, b: Vector) -> Vector:
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def _mix(points: list[Vector], weights: list[float]) -> Vector:
    x = sum(w * p[0] for w, p in zip(weights, points, strict=True))
    y = sum(w * p[1] for w, p in zip(weights, points, strict=True))
    z = sum(w * p[2] for w, p in zip(weights, points, strict=True))
    return (x, y, z)


def _segment(a: Vector, b: Vector) -> tuple[Vector, list[Vector]]:
    ab = _sub(b, a)
    length = _dot(ab, ab)
    s = -_dot(a, ab) / length if length > 0 else 0.0
    if s <= 0:
        return a, [a]
    if s >= 1:
        return b, [b]
    return _mix([a, b], [1 - s, s]), [a, b]


def _triangle(a: Vector, b: Vector, c: Vector) -> tuple[Vector, list[Vector]]:
    """Nearest point of triangle abc to the origin, and the corners it depends on."""
    ab, ac = _sub(b, a), _sub(c, a)
    d1, d2 = -_dot(ab, a), -_dot(ac, a)
    if d1 <= 0 and d2 <= 0:
        return a, [a]
    d3, d4 = -_dot(ab, b), -_dot(ac, b)
    if d3 >= 0 and d4 <= d3:
        return b, [b]
    d5, d6 = -_dot(ab, c), -_dot(ac, c)
    if d6 >= 0 and d5 <= d6:
        return c, [c]
    vc, vb, va = d1 * d4 - d3 * d2, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4
    if vc <= 0 <= d1 and d3 <= 0:
        return _segment(a, b)
    if vb <= 0 <= d2 and d6 <= 0:
        return _segment(a, c)
    if va <= 0 <= d4 - d3 and d5 - d6 >= 0:
        return _segment(b, c)
    total = va + vb + vc
    if not total > 0:
        # the corners lie on one line: the nearest of the three edges
        return min((_segment(a, b), _segment(a, c), _segment(b, c)), key=lambda found: _dot(found[0], found[0]))
    return _mix([a, b, c], [va / total, vb / total, vc / total]), [a, b, c]


def _tetrahedron(a: Vector, b: Vector, c: Vector, d: Vector) -> tuple[Vector, list[Vector]] | None:
    """Nearest point of the tetrahedron to the origin; None: the origin is inside."""
    best: tuple[Vector, list[Vector]] | None = None
    outside = False
    for p, q, r, other in ((a, b, c, d), (a, b, d, c), (a, c, d, b), (b, c, d, a)):
        normal = _cross(_sub(q, p), _sub(r, p))
        side = _dot(normal, _sub(other, p))
        # a flat tetrahedron has no inside: every face is a candidate then
        if side * -_dot(normal, p) > 0 and abs(side) > 1e-18:
            continue
        outside = True
        found = _triangle(p, q, r)
        if best is None or _dot(found[0], found[0]) < _dot(best[0], best[0]):
            best = found
    return best if outside else None


def _support_of(placed: Placed, row: int) -> tuple[Support, Vector, float]:
    """Support point of the core of one unit, a point inside it, and the radius of its ball."""
    solids, unit = placed.solids, int(placed.unit[row])
    c: Vector = tuple(placed.centre[row].tolist())
    columns: list[Vector] = [tuple(column) for column in placed.axes[row].T.tolist()]
    hull = int(solids.hull[unit])
    if hull >= 0:
        vertices = placed.centre[row] + solids.hulls[hull].vertices @ placed.axes[row].T

        def of_hull(n: Vector) -> Vector:
            found: Vector = tuple(vertices[int(np.argmax(vertices @ np.array(n)))].tolist())
            return found

        # the origin of a hull may be anywhere, outside of it too
        middle: Vector = tuple(vertices.mean(0).tolist())
        return of_hull, middle, 0.0
    half, disc = solids.half[unit].tolist(), float(solids.disc[unit])

    def of_primitive(n: Vector) -> Vector:
        local = [_dot(column, n) for column in columns]
        offset = [h if x >= 0 else -h for h, x in zip(half, local, strict=True)]
        if disc > 0:
            across = (local[0] ** 2 + local[1] ** 2) ** 0.5
            if across > 0:
                offset[0] += disc * local[0] / across
                offset[1] += disc * local[1] / across
        x, y, z = _mix(columns, offset)
        return (c[0] + x, c[1] + y, c[2] + z)

    return of_primitive, c, float(solids.ball[unit])


def separate(a: Placed, b: Placed, row: int) -> tuple[float, FloatArray | None]:
    """Distance, m, of the units in row `row` and unit normal (3,) from a to b that shows it; (0.0, None): they meet."""
    support_a, centre_a, ball_a = _support_of(a, row)
    support_b, centre_b, ball_b = _support_of(b, row)

    def difference(n: Vector) -> Vector:
        return _sub(support_b((-n[0], -n[1], -n[2])), support_a(n))

    v = _sub(centre_b, centre_a)
    if _dot(v, v) == 0:
        return 0.0, None
    v = difference(v)
    simplex = [v]
    best, normal = -np.inf, v
    for _ in range(ITERATIONS):
        length = _dot(v, v) ** 0.5
        if not length > 1e-12:
            return 0.0, None
        w = difference(v)
        gap = _dot(v, w) / length
        if gap > best:
            best, normal = gap, v
        if length - best <= RELATIVE * length + ABSOLUTE_M or w in simplex:
            break
        simplex.append(w)
        if len(simplex) == 2:
            v, simplex = _segment(*simplex)
        elif len(simplex) == 3:
            v, simplex = _triangle(*simplex)
        else:
            found = _tetrahedron(*simplex)
            if found is None:
                return 0.0, None
            v, simplex = found
    n = np.array(normal)
    n /= np.sqrt(n @ n)
    return max(0.0, best - ball_a - ball_b), n
