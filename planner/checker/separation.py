"""Whether a row of the certificate keeps two solids apart (equations C1, C3, C4 in docs/guarantees.md).

For points x of the one and y of the other f(t) = n·(y - x) leaves its chord downwards by at most M h²/8 with M >= f''.
Terms of a support function that do not change as a solid turns (a ball; the disc of a solid of revolution that stands
upright on an upright carrier) are the same at all times, so M is wanted for the points that are left: the corners of
a box, vertices, a disc that lies. With c, d the centres and r_x, r_y the distances of those points from them,

    M = max n·(d'' - c'') + |n| (r_x |R_x''| + r_y |R_y''|)                                                   (C7)

where |R''| is the length of the second derivatives of the axes' coordinates; on an upright carrier one axis, its
horizontal coordinates and the horizontal part of n are enough. An interval that this does not do for is halved.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.jets import F1, F2, F3, TABLES, product, size
from assur.planner.checker.motion import JETS, MOST_LINKS, Tables, carry
from assur.planner.compiled import kernel

CENTRE, TURN, HALF, DISC, BALL, VERTEX, VERTICES, ARM_FLAT, ARM, SOLID = 0, 3, 12, 15, 16, 17, 18, 19, 20, 21
"""Columns of a solid, in its carrier: centre, axes (columns one after the other), half sizes of the box, disc across
the z axis, ball (S1), first row and number of the vertices of a hull; how far points that count are from the vertical
through its centre, and from its centre; how many columns."""
T0, T1, ONE, ONE_ON, OTHER, OTHER_ON, NORMAL, NEED, DRIFT, LATE, ROW = 0, 1, 2, 3, 4, 5, 6, 9, 10, 11, 12
"""Columns of a row: its interval; solid and carrier of both (-1: the origin of the world); normal; the distance that is
required, what is added to it for each second, and the dispatch that may be late (C5); how many columns."""
SLACK_M = 1e-9
"""Taken off each gap, m, for its rounding: some twenty terms of a few metres, each rounded to 1e-15 m."""
HALVINGS = 10
"""How often an interval may be halved: most rows need none or one, a wide interval of a five-bar up to six."""
FINER = 2
"""How often the interval of a row of one body alone is halved: what will be required of it is not known yet."""
MOST = 4_000_000
"""Parts of intervals in one check, after which rows are refused: some 10 s."""


@kernel(f"float64({F1}, {F3}, int64, {F2}, float64, float64, float64)")
def support(
    solid: FloatArray, jets: FloatArray, c: int, vertices: FloatArray, nx: float, ny: float, nz: float
) -> float:
    """max of n·x over a solid on carrier c, where the jets, of an instant, have it (S1)."""
    local = (
        nx * jets[c, 3, 0] + ny * jets[c, 4, 0] + nz * jets[c, 5, 0],
        nx * jets[c, 6, 0] + ny * jets[c, 7, 0] + nz * jets[c, 8, 0],
        nx * jets[c, 9, 0] + ny * jets[c, 10, 0] + nz * jets[c, 11, 0],
    )
    found: float = nx * jets[c, 0, 0] + ny * jets[c, 1, 0] + nz * jets[c, 2, 0]
    u, v, w = 0.0, 0.0, 0.0
    for k in range(3):
        found += local[k] * solid[CENTRE + k]
        u += local[k] * solid[TURN + k]
        v += local[k] * solid[TURN + 3 + k]
        w += local[k] * solid[TURN + 6 + k]
    found += abs(u) * solid[HALF] + abs(v) * solid[HALF + 1] + abs(w) * solid[HALF + 2]
    found += solid[DISC] * math.sqrt(u * u + v * v) + solid[BALL] * math.sqrt(u * u + v * v + w * w)
    first, most = int(solid[VERTEX]), -math.inf
    for i in range(first, first + int(solid[VERTICES])):
        most = max(most, u * vertices[i, 0] + v * vertices[i, 1] + w * vertices[i, 2])
    return found + most if solid[VERTICES] > 0.0 else found


@kernel(f"UniTuple(float64, 3)({F1}, {F3}, int64, boolean, int64, float64, float64, float64)")
def moving(
    solid: FloatArray, jets: FloatArray, c: int, tilts: bool, order: int, nx: float, ny: float, nz: float
) -> tuple[float, float, float]:
    """Bounds of n·c of a solid's centre c, differentiated `order` times, and how far that of its points may be off."""
    low, high = 0.0, 0.0
    for k in range(3):
        n = nx if k == 0 else (ny if k == 1 else nz)
        for axis in range(4):
            jet = jets[c, 3 * axis + k]
            share = n if axis == 0 else n * solid[CENTRE + axis - 1]
            bounds = product(share, share, jet[2 * order], jet[2 * order + 1])
            low += bounds[0]
            high += bounds[1]
    if tilts:
        return low, high, solid[ARM] * size(jets, c, 3, JETS, order)
    return low, high, solid[ARM_FLAT] * math.sqrt(nx * nx + ny * ny) * size(jets, c, 3, 5, order)


@kernel(f"boolean(int64, int64, float64, float64, {TABLES}, {F3}, {F2})")
def carried(c: int, count: int, t0: float, t1: float, tables: Tables, jets: FloatArray, known: FloatArray) -> bool:
    """`carry`, which is not done again for the same interval: `known` (carriers, 3) has those of the jets and whether
    they are known. The links of the arm, of `count`, are known together."""
    k = 0 if c < count else c
    if not (known[k, 0] == t0 and known[k, 1] == t1):
        known[k, 2] = 1.0 if carry(k, count, t0, t1, tables, jets) else 0.0
        known[k, 0], known[k, 1] = t0, t1
    return bool(known[k, 2] > 0.0)


@kernel(f"void({F2}, int64, {F1}, {F2}, {F2}, {TABLES}, {F1})")
def spare(
    rows: FloatArray,
    count: int,
    tilts: FloatArray,
    solids: FloatArray,
    vertices: FloatArray,
    tables: Tables,
    found: FloatArray,
) -> None:
    """By how much, m, each row (N, ROW) proves more than is required, into `found`; less than 0 or NaN: it does not.

    `tilts` (carriers,): whether they tilt. Of a row of one body alone, it is the distance that it proves.
    """
    carriers, work = len(tilts), 0
    shape = (carriers + MOST_LINKS, JETS, 6)
    over, begin, end, later = np.empty(shape), np.empty(shape), np.empty(shape), np.empty(shape)
    known = np.full((4, carriers, 3), np.nan)
    stack = np.empty((HALVINGS + 2, 3))
    for i in range(len(rows)):
        one, other = int(rows[i, ONE]), int(rows[i, OTHER])
        on, beside = int(rows[i, ONE_ON]), int(rows[i, OTHER_ON])
        nx, ny, nz = rows[i, NORMAL], rows[i, NORMAL + 1], rows[i, NORMAL + 2]
        pair, late = other >= 0, rows[i, LATE]
        found[i] = np.inf
        stack[0, 0], stack[0, 1], stack[0, 2], top = rows[i, T0], rows[i, T1], 0.0, 1
        while top > 0 and (found[i] >= 0.0 or (found[i] > -np.inf and not pair)):
            top -= 1
            work += 1
            t0, t1, depth = stack[top, 0], stack[top, 1], stack[top, 2]
            g0, g1, need, high = np.nan, np.nan, rows[i, NEED] + SLACK_M, np.inf
            ok = work <= MOST
            for c in (on, beside):
                if ok and c >= 0:
                    ok = carried(c, count, t0, t1, tables, over, known[0])
                    ok = ok and carried(c, count, t0, t0, tables, begin, known[1])
                    ok = ok and carried(c, count, t1, t1, tables, end, known[2])
            if ok:
                g0 = -support(solids[one], begin, on, vertices, nx, ny, nz)
                g1 = -support(solids[one], end, on, vertices, nx, ny, nz)
                a = moving(solids[one], over, on, tilts[on] > 0.0, 2, nx, ny, nz)
                high = a[2] - a[0]
                if pair:
                    g0 -= support(solids[other], begin, beside, vertices, -nx, -ny, -nz)
                    g1 -= support(solids[other], end, beside, vertices, -nx, -ny, -nz)
                    b = moving(solids[other], over, beside, tilts[beside] > 0.0, 2, nx, ny, nz)
                    high += b[1] + b[2]
                    world = beside if on < count else on
                    if late > 0.0 and world >= count:
                        ok = carried(world, count, t0, t1 + late, tables, later, known[3])
                        solid = solids[other] if on < count else solids[one]
                        v = moving(solid, later, world, False, 1, nx, ny, nz)
                        need += late * (max(abs(v[0]), abs(v[1])) + v[2])
                    need += rows[i, DRIFT] * (t1 + late)
            taken = min(g0, g1) - need
            bound = taken - max(high, 0.0) * (t1 - t0) * (t1 - t0) / 8.0
            if not (ok and bound > -np.inf):
                bound = -np.inf  # a closed chain may be known to assemble over halves of what is too wide
            done = bound >= 0.0 or taken < 0.0 if pair else bound > -np.inf and depth >= FINER
            if done or depth >= HALVINGS:
                found[i] = min(found[i], bound)
                continue
            middle = (t0 + t1) / 2.0
            stack[top, 0], stack[top, 1], stack[top, 2] = t0, middle, depth + 1.0
            stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = middle, t1, depth + 1.0
            top += 2
