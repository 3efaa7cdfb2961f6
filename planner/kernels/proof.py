"""What becomes of one open pair on one interval: proved apart, to be halved, to be opened, or too near.

A pair leaves as soon as one normal proves it (equations N3, N4 and N8 in docs/bundle.md). What is not proved goes on
to both halves of its interval, or of its shift, with the best normal so far as the first to try. A bounding box that is
too near is replaced by the pieces in it.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.gjk import separate
from assur.planner.kernels.intervals import FINEST_S, ITEM_FROM, ITEM_TO, RESERVE_M, least_gap
from assur.planner.kernels.solids import CUBE, NORMAL, PIECES, REQUIRED, ROW, SET, TABLE, gap, likely
from assur.planner.kernels.uncertainty import MIDDLE, SHIFTED, Shifted, doubtful, least_shifted

RESISTED_A, RESISTED_B, RESISTED_T, RESISTED_GAP, RESISTED_NEED, RESISTED_S = 2, 3, 4, 5, 6, 8
"""In `state`, of the pair that resisted: its units, the instant, the largest gap found there, the one needed, and the
shift."""
T0, T1, UNIT, OTHER, ALONG, FROM, TO = 0, 1, 2, 3, 4, 7, 8
"""Columns of a row: interval, s, two units, a normal (3) from the first to the second, and the shift, s."""
ROW_COLUMNS = 9

NARROW_M = 1e-3
"""What is less than this above the gap needed is worth a search for a better normal, m."""
PROVED, OPEN, HALVE, HALVE_SHIFT, TOO_NEAR = range(5)
"""What became of one item on one interval."""


@kernel(f"boolean({TABLE}, {TABLE}, {CUBE}, {CUBE}, int64, int64, {NORMAL}, float64, float64)")
def shown(
    bodies: FloatArray,
    vertices: FloatArray,
    placed: FloatArray,
    jets: FloatArray,
    a: int,
    b: int,
    nx: float,
    ny: float,
    nz: float,
    h: float,
    need: float,
) -> bool:
    """Whether the normal n keeps units a and b apart by `need` over all of an interval of length h (N3)."""
    g0 = gap(bodies, vertices, placed, 0, a, b, nx, ny, nz)
    if not g0 > need:
        return False
    g1 = gap(bodies, vertices, placed, 2, a, b, nx, ny, nz)
    if not g1 > need:
        return False
    return bool(least_gap(bodies, jets, a, b, nx, ny, nz, g0, g1, h) >= need)


@kernel(
    f"int64({TABLE}, {TABLE}, {CUBE}, {CUBE}, {SHIFTED}, {TABLE}, {TABLE}, {TABLE}, float64, float64, {TABLE}, int64,"
    f" {TABLE}, {TABLE}, {ROW})"
)
def settle(
    bodies: FloatArray,
    vertices: FloatArray,
    placed: FloatArray,
    jets: FloatArray,
    shifted: Shifted,
    pairs: FloatArray,
    sets: FloatArray,
    sway: FloatArray,
    lasts: float,
    h: float,
    items: FloatArray,
    i: int,
    points: FloatArray,
    work: FloatArray,
    found: FloatArray,
) -> int:
    """What becomes of item i on an interval of length h; the item takes the normal that proves it, or the best in the
    middle.

    Normals are tried in this order: that of the longer interval, the vertical, the best of the likely ones, and that of
    GJK, the last only where the others keep the pair hardly apart in the middle. `sway` is of no rows where links are
    not displaced. `found` (2,) is the best gap there, NaN where nothing is known, and the one needed.
    """
    a, b, p, sways = int(items[i, 0]), int(items[i, 1]), int(items[i, 2]), len(sway) > 0
    d, asked, unsure = items[i, ITEM_TO] - items[i, ITEM_FROM], pairs[p, REQUIRED] + RESERVE_M, pairs[p, SET] >= 0.0
    late = d > 0.0 or items[i, ITEM_TO] != 0.0
    view, m = (shifted[1], MIDDLE) if late else (placed, 1)
    best, need, nx, ny, nz = -math.inf, asked, items[i, 3], items[i, 4], items[i, 5]
    for attempt in range(4):
        if attempt == 0:
            mx, my, mz = nx, ny, nz
            if mx == 0.0 and my == 0.0 and mz == 0.0:
                continue
            other = gap(bodies, vertices, view, m, a, b, mx, my, mz)
        elif attempt == 1:
            # the vertical before the others: heights change slowly, so it does for long intervals
            mx, my, mz = 0.0, 0.0, 1.0 if view[m, b, 2] >= view[m, a, 2] else -1.0
            other = gap(bodies, vertices, view, m, a, b, mx, my, mz)
        elif attempt == 2:
            other, mx, my, mz = likely(bodies, vertices, view, m, a, b, math.inf)
        else:
            # where there is room in the middle it is the interval that is too long
            if best > NARROW_M:
                break
            other, mx, my, mz, _ = separate(
                bodies, vertices, view, m, a, b, math.inf, sets, int(pairs[p, SET]), lasts, points, work
            )
        wanted = asked
        if unsure or sways:
            wanted += doubtful(pairs, sets, p, bodies, sway, lasts, sways, a, b, mx, my, mz)
        if not (other - wanted > best or other > wanted):
            continue
        if other - wanted > best:
            best, need, nx, ny, nz = other - wanted, wanted, mx, my, mz
        if other > wanted:
            if late:
                proved = least_shifted(
                    bodies, vertices, view, jets, shifted[2], a, b, mx, my, mz, h, d
                )[0] >= wanted  # fmt: skip
            else:
                proved = shown(bodies, vertices, placed, jets, a, b, mx, my, mz, h, wanted)
            if proved:
                items[i, 3], items[i, 4], items[i, 5] = mx, my, mz
                return PROVED
    items[i, 3], items[i, 4], items[i, 5] = nx, ny, nz
    found[0], found[1] = best + need if best > -math.inf else math.nan, need
    if best > 0.0:
        if d > FINEST_S:
            _, over_time, over_shift = least_shifted(bodies, vertices, view, jets, shifted[2], a, b, nx, ny, nz, h, d)
            if over_shift > over_time:
                return HALVE_SHIFT
        return HALVE
    return OPEN if bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0 else TOO_NEAR
