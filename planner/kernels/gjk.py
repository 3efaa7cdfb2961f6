"""Distance of two convex units and the normal that shows it, by GJK on support points.

The result is not trusted, it is a normal to try: what is claimed is the support gap along it. Algorithm: E. G. Gilbert,
D. W. Johnson, S. S. Keerthi, IEEE J. Robotics and Automation 4 (1988) 193; nearest point of a simplex by Voronoi
regions (C. Ericson, Real-Time Collision Detection, 2005, 5.1).
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.solids import (
    BALL,
    DISC,
    HALF,
    NORMAL,
    ROW,
    TABLE,
    UNITS,
    VERTEX,
    VERTICES,
    Normal,
    Units,
    gap,
    own_axes,
)
from assur.planner.kernels.uncertainty import add_spread

ITERATIONS = 64
"""Polytopes end after a dozen; round bodies converge linearly and are near enough by then."""
RELATIVE = 1e-6
"""The search ends when the support gap is within this fraction of the distance (1.1 clearances must certify)."""
ABSOLUTE_M = 1e-10
"""... or within this length of it, m."""
POINT_M = 1e-12
"""A difference of points shorter than this has no direction, m: a few roundings."""
FLAT = 1e-18
"""A tetrahedron of six times this volume or less has no inside, m³."""


@kernel(f"void({UNITS}, int64, int64, {NORMAL}, float64, {TABLE}, int64)")
def add_farthest(units: Units, m: int, i: int, normal: Normal, sign: float, points: FloatArray, k: int) -> None:
    """Adds `sign` times the point of unit i, without its ball, that is farthest along n to row k of `points`."""
    bodies, vertices, placed = units
    ux, uy, uz = own_axes(placed, m, i, normal)
    count = int(bodies[i, VERTICES])
    if count == 0:
        px = bodies[i, HALF] if ux >= 0.0 else -bodies[i, HALF]
        py = bodies[i, HALF + 1] if uy >= 0.0 else -bodies[i, HALF + 1]
        pz = bodies[i, HALF + 2] if uz >= 0.0 else -bodies[i, HALF + 2]
        if bodies[i, DISC] > 0.0:
            across = math.sqrt(ux * ux + uy * uy)
            if across > 0.0:
                px += bodies[i, DISC] * ux / across
                py += bodies[i, DISC] * uy / across
    else:
        first = int(bodies[i, VERTEX])
        best, which = -math.inf, first
        for v in range(first, first + count):
            along = ux * vertices[v, 0] + uy * vertices[v, 1] + uz * vertices[v, 2]
            if along > best:
                best, which = along, v
        px, py, pz = vertices[which, 0], vertices[which, 1], vertices[which, 2]
    for row in range(3):
        r0, r1, r2 = placed[m, i, 3 + 3 * row], placed[m, i, 4 + 3 * row], placed[m, i, 5 + 3 * row]
        points[k, row] += sign * (placed[m, i, row] + r0 * px + r1 * py + r2 * pz)


@kernel(f"float64({TABLE}, int64, {TABLE}, int64)")
def dot(p: FloatArray, i: int, q: FloatArray, j: int) -> float:
    """Product of row i of p and row j of q."""
    return float(p[i, 0] * q[j, 0] + p[i, 1] * q[j, 1] + p[i, 2] * q[j, 2])


@kernel(f"void({TABLE}, int64, int64, {ROW})")
def nearest_on_segment(points: FloatArray, a: int, b: int, weights: FloatArray) -> None:
    """Weights of the point nearest to the origin on the segment of rows a and b; the others stay as they are."""
    aa, ab, bb = dot(points, a, points, a), dot(points, a, points, b), dot(points, b, points, b)
    length = aa - 2.0 * ab + bb
    share = (aa - ab) / length if length > 0.0 else 0.0
    share = min(max(share, 0.0), 1.0)
    weights[a], weights[b] = 1.0 - share, share


@kernel(f"void({TABLE}, int64, int64, int64, {ROW})")
def nearest_on_triangle(points: FloatArray, a: int, b: int, c: int, weights: FloatArray) -> None:
    """The same on the triangle of rows a, b and c."""
    weights[a] = weights[b] = weights[c] = 0.0
    aa, ab, ac = dot(points, a, points, a), dot(points, a, points, b), dot(points, a, points, c)
    bb, bc, cc = dot(points, b, points, b), dot(points, b, points, c), dot(points, c, points, c)
    d1, d2 = aa - ab, aa - ac
    d3, d4 = ab - bb, ab - bc
    d5, d6 = ac - bc, ac - cc
    vc, vb, va = d1 * d4 - d3 * d2, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4
    if d1 <= 0.0 and d2 <= 0.0:
        weights[a] = 1.0
    elif d3 >= 0.0 and d4 <= d3:
        weights[b] = 1.0
    elif d6 >= 0.0 and d5 <= d6:
        weights[c] = 1.0
    elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        nearest_on_segment(points, a, b, weights)
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        nearest_on_segment(points, a, c, weights)
    elif va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        nearest_on_segment(points, b, c, weights)
    elif va + vb + vc > 0.0:
        total = va + vb + vc
        weights[a], weights[b], weights[c] = va / total, vb / total, vc / total
    else:
        nearest_on_segment(points, a, b, weights)  # the corners lie on one line


@kernel(f"float64({TABLE}, int64, {ROW}, {ROW})")
def combined(points: FloatArray, count: int, weights: FloatArray, found: FloatArray) -> float:
    """Writes the weighted sum of the first `count` rows to `found` (3,) and returns its square."""
    for j in range(3):
        total = 0.0
        for i in range(count):
            total += weights[i] * points[i, j]
        found[j] = total
    return float(found[0] * found[0] + found[1] * found[1] + found[2] * found[2])


@kernel(f"boolean({TABLE}, {TABLE})")
def nearest_on_tetrahedron(points: FloatArray, work: FloatArray) -> bool:
    """The same on the tetrahedron of four rows; weights go to row 0 of `work` (3, 4). False: the origin is inside."""
    best, outside = math.inf, False
    for corner in range(4):
        a, b, c = (corner + 1) % 4, (corner + 2) % 4, (corner + 3) % 4
        ux, uy, uz = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1], points[b, 2] - points[a, 2]
        vx, vy, vz = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1], points[c, 2] - points[a, 2]
        nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        side = (
            nx * (points[corner, 0] - points[a, 0])
            + ny * (points[corner, 1] - points[a, 1])
            + nz * (points[corner, 2] - points[a, 2])
        )
        origin = -(nx * points[a, 0] + ny * points[a, 1] + nz * points[a, 2])
        # a flat tetrahedron has no inside: every face is a candidate then
        if side * origin > 0.0 and abs(side) > FLAT:
            continue
        outside = True
        work[1, corner] = 0.0
        nearest_on_triangle(points, a, b, c, work[1])
        square = combined(points, 4, work[1], work[2])
        if square < best:
            best = square
            for k in range(4):
                work[0, k] = work[1, k]
    return outside


@kernel(f"boolean({TABLE}, int64, {TABLE})", entry=True)
def nearest_to_origin(points: FloatArray, count: int, work: FloatArray) -> bool:
    """Weights, in row 0 of `work` (3, 4), of the point nearest to the origin in the simplex of the first `count` rows.

    False: the origin is inside of a tetrahedron.
    """
    if count == 4:
        return nearest_on_tetrahedron(points, work)
    if count == 3:
        nearest_on_triangle(points, 0, 1, 2, work[0])
    elif count == 2:
        nearest_on_segment(points, 0, 1, work[0])
    else:
        work[0, 0] = 1.0
    return True


@kernel(
    f"Tuple((float64, {NORMAL}, float64))({UNITS}, int64, int64, int64, float64, {TABLE}, int64, float64, {TABLE},"
    f" {TABLE})"
)
def separate(
    units: Units,
    m: int,
    a: int,
    b: int,
    enough: float,
    sets: FloatArray,
    k: int,
    lasts: float,
    points: FloatArray,
    work: FloatArray,
) -> tuple[float, Normal, float]:
    """The gap of two units along the best normal found, that normal, and a length that their distance is not above.

    Ends once the gap exceeds `enough`. Where the units meet, the last is 0 and no normal need be of use; where nothing
    is known, the gap is −inf or NaN. With a set number k of `sets` (-1: none) the second unit counts as enlarged by it
    during the search for the normal. `points` (4, 3) and `work` (3, 4) are room to work in.
    """
    bodies, _, placed = units
    balls = bodies[a, BALL] + bodies[b, BALL]
    vx, vy = placed[m, b, 0] - placed[m, a, 0], placed[m, b, 1] - placed[m, a, 1]
    vz = placed[m, b, 2] - placed[m, a, 2]
    best, normal, above = -math.inf, (0.0, 0.0, 1.0), math.inf
    count, first = 0, True
    for _ in range(ITERATIONS):
        length = math.sqrt(vx * vx + vy * vy + vz * vz)
        if not length > POINT_M:
            above = 0.0
            break
        nx, ny, nz = vx / length, vy / length, vz / length
        for j in range(3):
            points[count, j] = 0.0
        add_farthest(units, m, b, (-nx, -ny, -nz), 1.0, points, count)
        add_farthest(units, m, a, (nx, ny, nz), -1.0, points, count)
        add_spread(sets, k, lasts, (nx, ny, nz), -1.0, points, count)
        along = nx * points[count, 0] + ny * points[count, 1] + nz * points[count, 2]
        if along > best:
            best, normal = along, (nx, ny, nz)
            if best - balls > enough:
                break
        if not first:
            above = min(above, max(length - balls, 0.0))
            if length - best <= RELATIVE * length + ABSOLUTE_M:
                break
            known = False
            for i in range(count):
                known = known or (
                    points[i, 0] == points[count, 0]
                    and points[i, 1] == points[count, 1]
                    and points[i, 2] == points[count, 2]
                )
            if known:
                break
        first = False
        count += 1
        if not nearest_to_origin(points, count, work):
            above = 0.0
            break
        kept, vx, vy, vz = 0, 0.0, 0.0, 0.0
        for i in range(count):
            weight = work[0, i]
            if weight > 0.0:
                vx += weight * points[i, 0]
                vy += weight * points[i, 1]
                vz += weight * points[i, 2]
                for j in range(3):
                    points[kept, j] = points[i, j]
                kept += 1
        count = kept
        if count == 4:
            break
    # what is claimed is the gap along the normal as it was rounded
    return gap(units, m, a, b, normal), normal, above
