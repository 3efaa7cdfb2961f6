"""Convex solids as rows of numbers: where they are, their support function, the gap along a normal, likely normals.

Every primitive is box + disc + ball (equation S1), so one support function without branches serves all of them; a hull
adds a loop over its vertices. A gap along any unit normal is a lower bound of the distance (equation N3 in
docs/bundle.md): a bad normal costs efficiency and never safety. Where a pose is not known there is NaN, which no
comparison here takes for a proof.

Tables: `bodies` (U, COLUMNS), one row a *unit* (a convex piece, or the bounding box of a body of several); `vertices`
(V, 3), the corners of hulls in the axes of their units; `pairs` (P, PAIR_COLUMNS), what must be kept apart; `placed`
(M, U, 12), the units at M instants, each with its centre and the rotation of its axes, row by row, in the world. All
lengths in metres.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel

CARRIER = 0
"""Number of the link or frame that carries the unit: links first."""
CENTRE = 1
"""Three columns: the unit's centre in its carrier; of a hull, the middle of the box around it."""
ROTATION = 4
"""Nine columns: the unit's axes in its carrier, row by row."""
HALF = 13
"""Three columns: half edges of the box; of a hull, of the box around it, which serves for normals only."""
DISC = 16
"""Radius of the disc across the unit's z axis."""
BALL = 17
"""Radius of the ball."""
RADIUS = 18
"""Greatest distance of the unit's points from its centre."""
VERTEX = 19
"""A hull's first row in the table of vertices."""
VERTICES = 20
"""How many vertices a hull has; 0: a primitive."""
BODY = 21
"""Number of the body that the unit is of."""
PIECE = 22
"""Number of the piece in its body; -1: the bounding box of the whole body."""
OPENED = 23
"""Of a bounding box: the row of the body's first piece."""
PIECES = 24
"""Of a bounding box: how many pieces the body has; 0: the unit is a piece itself."""
COLUMNS = 25

FIRST, SECOND = 0, 1
"""Columns of a pair: its two units, the first of the robot."""
REQUIRED = 2
"""Distance that a pair must keep, m (N8), in addition to the uncertainty of where the two are: ..."""
SET = 3
"""... the number of its set of displacements (`kernels.uncertainty`), -1 for none, ..."""
EARLY, LATE = 4, 5
"""... and the shifts in time of the second against the first, from and to, s: the robot may start late, and the whole
motion of a frame be shifted. 0 and 0 for what is known, or does not move."""
PAIR_COLUMNS = 6

COVER = -1
"""Piece number of the bounding box of a whole body."""
SAME_M = 1e-9
"""Centres nearer than this give no direction, m."""

TABLE, CUBE, ROW = "float64[:, ::1]", "float64[:, :, ::1]", "float64[::1]"
NUMBERS = "int64[::1]"
NORMAL = "UniTuple(float64, 3)"
UNITS = f"Tuple(({TABLE}, {TABLE}, {CUBE}))"
"""Types in the signatures of kernels."""
Normal = tuple[float, float, float]
"""A unit vector, x, y, z, in the world; or in the axes of a unit."""
Units = tuple[FloatArray, FloatArray, FloatArray]
"""`bodies`, `vertices`, `placed`: units where they are."""
CELL = f"Tuple(({TABLE}, {TABLE}, {NUMBERS}))"
"""The units of an arrangement: `bodies`, `vertices`, and which carriers stand `still` throughout (1), (K,)."""


@kernel(f"void({TABLE}, int64, {TABLE}, {CUBE}, int64)", entry=True)
def place(bodies: FloatArray, i: int, carriers: FloatArray, placed: FloatArray, m: int) -> None:
    """Puts unit i where its carrier is: row i of instant m of `placed`."""
    k = int(bodies[i, CARRIER])
    for row in range(3):
        r0, r1, r2 = carriers[k, 3 + 3 * row], carriers[k, 4 + 3 * row], carriers[k, 5 + 3 * row]
        centre = r0 * bodies[i, CENTRE] + r1 * bodies[i, CENTRE + 1] + r2 * bodies[i, CENTRE + 2]
        placed[m, i, row] = carriers[k, row] + centre
        for column in range(3):
            placed[m, i, 3 + 3 * row + column] = (
                r0 * bodies[i, ROTATION + column]
                + r1 * bodies[i, ROTATION + 3 + column]
                + r2 * bodies[i, ROTATION + 6 + column]
            )


@kernel(f"{NORMAL}({CUBE}, int64, int64, {NORMAL})")
def own_axes(placed: FloatArray, m: int, i: int, normal: Normal) -> Normal:
    """A normal n in the axes of unit i at instant m."""
    nx, ny, nz = normal
    ux = nx * placed[m, i, 3] + ny * placed[m, i, 6] + nz * placed[m, i, 9]
    uy = nx * placed[m, i, 4] + ny * placed[m, i, 7] + nz * placed[m, i, 10]
    uz = nx * placed[m, i, 5] + ny * placed[m, i, 8] + nz * placed[m, i, 11]
    return ux, uy, uz


@kernel(f"float64({TABLE}, int64, {NORMAL})")
def width(bodies: FloatArray, i: int, own: Normal) -> float:
    """Support of unit i along a normal in its own axes (S1); of a hull, that of the box around it."""
    ux, uy, uz = own
    sigma = bodies[i, HALF] * abs(ux) + bodies[i, HALF + 1] * abs(uy) + bodies[i, HALF + 2] * abs(uz)
    if bodies[i, DISC] > 0.0:
        sigma += bodies[i, DISC] * math.sqrt(ux * ux + uy * uy)
    return float(sigma + bodies[i, BALL])


@kernel(f"float64({UNITS}, int64, int64, {NORMAL})")
def unit_support(units: Units, m: int, i: int, normal: Normal) -> float:
    """max of n·(x − centre) over unit i at instant m (S1)."""
    bodies, vertices, placed = units
    ux, uy, uz = own = own_axes(placed, m, i, normal)
    count = int(bodies[i, VERTICES])
    if count == 0:
        return width(bodies, i, own)
    first = int(bodies[i, VERTEX])
    # begins with the first vertex, so that NaN stays
    best = ux * vertices[first, 0] + uy * vertices[first, 1] + uz * vertices[first, 2]
    for v in range(first + 1, first + count):
        best = max(best, ux * vertices[v, 0] + uy * vertices[v, 1] + uz * vertices[v, 2])
    return float(best)


@kernel(f"float64({UNITS}, int64, int64, int64, {NORMAL})")
def gap(units: Units, m: int, a: int, b: int, normal: Normal) -> float:
    """Gap of units a and b at instant m along the unit normal n from a to b: no more than their distance (N3)."""
    (nx, ny, nz), placed = normal, units[2]
    between = (
        nx * (placed[m, b, 0] - placed[m, a, 0])
        + ny * (placed[m, b, 1] - placed[m, a, 1])
        + nz * (placed[m, b, 2] - placed[m, a, 2])
    )
    return float(between - unit_support(units, m, a, normal) - unit_support(units, m, b, (-nx, -ny, -nz)))


@kernel(f"boolean({UNITS}, int64, int64, int64, float64)")
def spheres_apart(units: Units, m: int, a: int, b: int, required: float) -> bool:
    """Whether the spheres around two units are further apart than `required`."""
    bodies, _, placed = units
    dx, dy = placed[m, b, 0] - placed[m, a, 0], placed[m, b, 1] - placed[m, a, 1]
    dz = placed[m, b, 2] - placed[m, a, 2]
    least = bodies[a, RADIUS] + bodies[b, RADIUS] + required
    return bool(least >= 0.0 and dx * dx + dy * dy + dz * dz > least * least)


@kernel(f"Tuple((float64, {NORMAL}))({UNITS}, int64, int64, int64, float64)")
def likely(units: Units, m: int, a: int, b: int, enough: float) -> tuple[float, Normal]:
    """The largest gap, and its normal, of those along which two units are likely to be apart.

    They are the vertical, the horizontal between the centres, and the axes of both units; the first along which the gap
    exceeds `enough` ends the search. The gap is −inf where nothing is known. A hull counts as the box around it until
    the best normal is found; the gap that is returned is that of the hull.
    """
    bodies, _, placed = units
    dx, dy = placed[m, b, 0] - placed[m, a, 0], placed[m, b, 1] - placed[m, a, 1]
    dz = placed[m, b, 2] - placed[m, a, 2]
    best, normal = -math.inf, (0.0, 0.0, 1.0)
    for k in range(8):
        if k == 0:
            nx, ny, nz = 0.0, 0.0, 1.0
        elif k == 1:
            level = math.sqrt(dx * dx + dy * dy)
            if not level > SAME_M:
                continue
            nx, ny, nz = dx / level, dy / level, 0.0
        elif k < 5:
            nx, ny, nz = placed[m, b, k + 1], placed[m, b, k + 4], placed[m, b, k + 7]
        else:
            nx, ny, nz = placed[m, a, k - 2], placed[m, a, k + 1], placed[m, a, k + 4]
        if k > 1 and nx == 0.0 and ny == 0.0:
            continue  # the vertical was tried
        along = nx * dx + ny * dy + nz * dz
        found = abs(along)
        for i in (a, b):
            found -= width(bodies, i, own_axes(placed, m, i, (nx, ny, nz)))
        if found > best:
            sign = 1.0 if along >= 0.0 else -1.0
            best, normal = found, (sign * nx, sign * ny, sign * nz)
            if best > enough:
                break
    if best > -math.inf and (bodies[a, VERTICES] > 0.0 or bodies[b, VERTICES] > 0.0):
        best = max(best, gap(units, m, a, b, normal))
    return best, normal
