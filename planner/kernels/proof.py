"""What becomes of one open pair on one interval: proved apart, to be halved, to be opened, or too near.

A pair leaves as soon as one normal proves it (equations C1 to C5 in docs/guarantees.md). What is not proved goes on to
both halves of its interval, with the best normal so far as the first to try. A bounding box that is too near is
replaced by the pieces in it.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.gjk import separate
from assur.planner.kernels.intervals import least_gap, needed, unit_bound
from assur.planner.kernels.solids import CUBE, LATE, NORMAL, PIECES, ROW, TABLE, gap, likely

RESISTED_A, RESISTED_B, RESISTED_T, RESISTED_GAP, RESISTED_NEED = 2, 3, 4, 5, 6
"""In `state`, of the pair that resisted: its units, the instant, the largest gap found there and the one needed."""
T0, T1, UNIT, OTHER, ALONG = range(5)
"""Columns of a row: interval, s, two units, and a normal (3) from the first to the second."""
ROW_COLUMNS = 7

NARROW_M = 1e-3
"""What is less than this above the gap needed is worth a search for a better normal, m."""
PROVED, OPEN, HALVE, TOO_NEAR = range(4)
"""What became of one item on one interval."""


@kernel(f"boolean({TABLE}, {TABLE}, {CUBE}, {TABLE}, {TABLE}, int64, int64, {NORMAL}, float64, float64, float64)")
def shown(
    bodies: FloatArray,
    vertices: FloatArray,
    placed: FloatArray,
    bounds: FloatArray,
    late_bounds: FloatArray,
    a: int,
    b: int,
    nx: float,
    ny: float,
    nz: float,
    h: float,
    need: float,
    late: float,
) -> bool:
    """Whether the normal n keeps units a and b apart by `need` over all of an interval of length h (C4)."""
    g0 = gap(bodies, vertices, placed, 0, a, b, nx, ny, nz)
    if not g0 > need:
        return False
    g1 = gap(bodies, vertices, placed, 2, a, b, nx, ny, nz)
    if not g1 > need:
        return False
    if late > 0.0:
        need += late * unit_bound(bodies, late_bounds, b, nx, ny, nz)[0]
    return bool(least_gap(bodies, bounds, a, b, nx, ny, nz, g0, g1, h) >= need)


@kernel(
    f"int64({TABLE}, {TABLE}, {CUBE}, {TABLE}, {TABLE}, {TABLE}, float64, float64, float64, {TABLE}, int64,"
    f" {TABLE}, {TABLE}, {ROW})"
)
def settle(
    bodies: FloatArray,
    vertices: FloatArray,
    placed: FloatArray,
    bounds: FloatArray,
    late_bounds: FloatArray,
    pairs: FloatArray,
    since: float,
    t0: float,
    t1: float,
    items: FloatArray,
    i: int,
    points: FloatArray,
    work: FloatArray,
    found: FloatArray,
) -> int:
    """What becomes of item i on [t0, t1]; the item takes the normal that proves it, or the best in the middle.

    Normals are tried in this order: that of the longer interval, the vertical, the best of the likely ones, and that of
    GJK, the last only where the others keep the pair hardly apart in the middle. `found` (2,) is the best
    gap there, NaN where nothing is known, and the one needed.
    """
    a, b, p = int(items[i, 0]), int(items[i, 1]), int(items[i, 2])
    late, h, need = pairs[p, LATE], t1 - t0, needed(pairs, p, since, t1)
    best, nx, ny, nz = -math.inf, items[i, 3], items[i, 4], items[i, 5]
    for attempt in range(4):
        if attempt == 0:
            mx, my, mz = nx, ny, nz
            if mx == 0.0 and my == 0.0 and mz == 0.0:
                continue
            other = gap(bodies, vertices, placed, 1, a, b, mx, my, mz)
        elif attempt == 1:
            # the vertical before the others: heights change slowly, so it does for long intervals
            mx, my, mz = 0.0, 0.0, 1.0 if placed[1, b, 2] >= placed[1, a, 2] else -1.0
            other = gap(bodies, vertices, placed, 1, a, b, mx, my, mz)
        elif attempt == 2:
            other, mx, my, mz = likely(bodies, vertices, placed, 1, a, b, math.inf)
        else:
            # where there is room in the middle it is the interval that is too long
            if best > need + NARROW_M:
                break
            other, mx, my, mz, _ = separate(bodies, vertices, placed, 1, a, b, math.inf, points, work)
        if not (other > best or other > need):
            continue
        if other > best:
            best, nx, ny, nz = other, mx, my, mz
        if other > need and shown(bodies, vertices, placed, bounds, late_bounds, a, b, mx, my, mz, h, need, late):
            items[i, 3], items[i, 4], items[i, 5] = mx, my, mz
            return PROVED
    items[i, 3], items[i, 4], items[i, 5] = nx, ny, nz
    found[0], found[1] = best if best > -math.inf else math.nan, need
    if best > need:
        return HALVE
    return OPEN if bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0 else TOO_NEAR
