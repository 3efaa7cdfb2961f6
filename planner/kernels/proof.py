"""What becomes of one open pair on one interval: proved apart, to be halved, to be opened, or too near.

A pair leaves as soon as one normal proves it (equations N3, N4 and N8 in docs/bundle.md). What is not proved goes on
to both halves of its interval, or of its shift, with the best normal so far as the first to try. A bounding box that is
too near is replaced by the pieces in it.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel
from assur.planner.kernels.carriers import derivative
from assur.planner.kernels.gjk import separate
from assur.planner.kernels.intervals import (
    FINEST_S,
    ITEM_FROM,
    ITEM_TO,
    MOTION,
    RESERVE_M,
    Cell,
    Motion,
    evaluate_motion,
    keep_normal,
    least_between,
    least_gap,
    normal_of,
    place_unit,
    places_for,
    room_for,
)
from assur.planner.kernels.jets import ACCELERATION, JET_COLUMNS, JETS
from assur.planner.kernels.solids import (
    CARRIER,
    CELL,
    CUBE,
    FIRST,
    NORMAL,
    NUMBERS,
    PAIR_COLUMNS,
    PIECES,
    RADIUS,
    REQUIRED,
    ROW,
    SECOND,
    SET,
    TABLE,
    UNITS,
    Normal,
    Units,
    gap,
    likely,
    unit_support,
)
from assur.planner.kernels.uncertainty import (
    ERRORS,
    MIDDLE,
    OFFSET_COLUMNS,
    SHIFTED,
    Errors,
    Shifted,
    displace_links,
    displaced,
    least_shifted,
    spread,
    uncertainty_margin,
)

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


@kernel(f"boolean({UNITS}, {CUBE}, int64, int64, {NORMAL}, float64, float64)")
def shown(units: Units, jets: FloatArray, a: int, b: int, normal: Normal, h: float, need: float) -> bool:
    """Whether a normal keeps units a and b apart by `need` over all of an interval of length h (N3)."""
    g0 = gap(units, 0, a, b, normal)
    if not g0 > need:
        return False
    g1 = gap(units, 2, a, b, normal)
    if not g1 > need:
        return False
    return bool(least_gap(units[0], jets, a, b, normal, g0, g1, h) >= need)


@kernel(
    f"int64({UNITS}, {CUBE}, {SHIFTED}, {TABLE}, {TABLE}, {TABLE}, float64, float64, {TABLE}, int64, {TABLE}, {TABLE},"
    f" {ROW})"
)
def decide_pair(
    units: Units,
    jets: FloatArray,
    shifted: Shifted,
    pairs: FloatArray,
    sets: FloatArray,
    offsets: FloatArray,
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
    GJK, the last only where the others keep the pair hardly apart in the middle. `offsets` has no rows where no
    link is displaced. `found` (2,) is the best gap there, NaN where nothing is known, and the one needed.
    """
    a, b, p, is_offset = int(items[i, 0]), int(items[i, 1]), int(items[i, 2]), len(offsets) > 0
    d, required, unsure = items[i, ITEM_TO] - items[i, ITEM_FROM], pairs[p, REQUIRED] + RESERVE_M, pairs[p, SET] >= 0.0
    late, bodies = d > 0.0 or items[i, ITEM_TO] != 0.0, units[0]
    view, m = ((bodies, units[1], shifted[1]), MIDDLE) if late else (units, 1)
    best, need, kept = -math.inf, required, normal_of(items, i)
    for attempt in range(4):
        if attempt == 0:
            normal = kept
            if normal == (0.0, 0.0, 0.0):
                continue
            other = gap(view, m, a, b, normal)
        elif attempt == 1:
            # the vertical before the others: heights change slowly, so it does for long intervals
            normal = (0.0, 0.0, 1.0 if view[2][m, b, 2] >= view[2][m, a, 2] else -1.0)
            other = gap(view, m, a, b, normal)
        elif attempt == 2:
            other, normal = likely(view, m, a, b, math.inf)
        else:
            # where there is room in the middle it is the interval that is too long
            if best > NARROW_M:
                break
            other, normal, _ = separate(view, m, a, b, math.inf, sets, int(pairs[p, SET]), lasts, points, work)
        wanted = required
        if unsure or is_offset:
            wanted += uncertainty_margin(pairs, sets, p, bodies, offsets, lasts, is_offset, a, b, normal)
        if not (other - wanted > best or other > wanted):
            continue
        if other - wanted > best:
            best, need, kept = other - wanted, wanted, normal
        if other > wanted:
            if late:
                proved = least_shifted(view, jets, shifted[2], a, b, normal, h, d)[0] >= wanted
            else:
                proved = shown(units, jets, a, b, normal, h, wanted)
            if proved:
                keep_normal(items, i, normal)
                return PROVED
    keep_normal(items, i, kept)
    found[0], found[1] = best + need if best > -math.inf else math.nan, need
    if best > 0.0:
        if d > FINEST_S:
            _, over_time, over_shift = least_shifted(view, jets, shifted[2], a, b, kept, h, d)
            if over_shift > over_time:
                return HALVE_SHIFT
        return HALVE
    return OPEN if bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0 else TOO_NEAR


# Which bodies are far from all that a robot sweeps: by planes across the axes of the world (equation C6).
#
# In a large cell most of what stands around is far from the arm, and a few rows of single units of the robot do for all
# of it. The six sides are the normals +x, +y, +z, −x, −y, −z of the world. `boxes` (U, 6): least and greatest
# coordinates of units, m.

SIDES = 6
SPARED = 512.0
"""A bound of the acceleration of a unit, as large as that of any checker, times the square of an interval, over this is
what a checker may miss of a plane that it proves over eighths of the interval (N3)."""


@kernel(f"{NORMAL}(int64)")
def side_normal(side: int) -> Normal:
    """The unit normal of a side."""
    sign = 1.0 if side < 3 else -1.0
    axis = side % 3
    return (sign if axis == 0 else 0.0), (sign if axis == 1 else 0.0), (sign if axis == 2 else 0.0)


@kernel(f"float64({UNITS}, int64, int64, {NORMAL})")
def leads(units: Units, m: int, i: int, normal: Normal) -> float:
    """How far the plane n·x = 0 is ahead of all points of unit i at instant m, m."""
    (nx, ny, nz), placed = normal, units[2]
    along = nx * placed[m, i, 0] + ny * placed[m, i, 1] + nz * placed[m, i, 2]
    return float(-along - unit_support(units, m, i, normal))


@kernel(f"void({MOTION}, {CELL}, {ERRORS}, {NUMBERS}, {ROW}, {TABLE})", allocates=True)
def behind(motion: Motion, cell: Cell, errors: Errors, units: IntArray, edges: FloatArray, least: FloatArray) -> None:
    """Fills `least` (R, 6): each of `units` (R,) stays behind the plane n·x = −least of each side all along, wherever
    its link may be displaced to.

    It is proved over each of the intervals between `edges` (N3), and is the smallest of them. What the checker may
    miss of it is taken off: it proves a plane over eighths of an interval, by bounds of its own.
    """
    bodies, _, still = cell
    (carriers, seen), room, offsets = places_for(cell, 3), room_for(motion), np.zeros((len(still), OFFSET_COLUMNS))
    jets, stamp = np.zeros((len(still), JETS, JET_COLUMNS)), np.zeros(len(bodies), dtype=np.int64)
    least[:] = math.inf
    for part in range(len(edges) - 1):
        t0, t1 = edges[part], edges[part + 1]
        evaluate_motion(motion, t0, t1, room, carriers, jets)
        is_offset = displace_links(motion[0][0], room, errors, t1, offsets)
        for r in range(len(units)):
            i = units[r]
            place_unit(seen, i, carriers, stamp, part + 1, still)
            turning, square = jets[int(bodies[i, CARRIER])], (t1 - t0) * (t1 - t0)
            turned = 0.0
            for j in range(3, JETS):
                turned += (abs(turning[j, ACCELERATION]) + turning[j, ACCELERATION + 1]) ** 2
            for k in range(SIDES):
                normal = side_normal(k)
                middle, radius = derivative(bodies, jets, i, 2, normal)
                shown = least_between(leads(seen, 0, i, normal), leads(seen, 2, i, normal), radius - middle, t1 - t0)
                shown -= (abs(middle) + radius + bodies[i, RADIUS] * math.sqrt(turned)) * square / SPARED
                if is_offset:
                    shown -= displaced(bodies, offsets, i, normal)
                # what is not a number shows nothing
                least[r, k] = min(least[r, k], shown) if shown > -math.inf else -math.inf


PLANES = f"Tuple(({TABLE}, {NUMBERS}, {TABLE}, {TABLE}, float64))"
Planes = tuple[FloatArray, IntArray, FloatArray, FloatArray, float]
"""`boxes`, NaN for what does not stand still; `number` (U,), the row in `least` of each unit of the robot, -1 for all
others; `least` (R, 6), the result of `behind`; `sets`: by how much more pairs must be apart, where errors have grown
for so many seconds."""


@kernel(f"float64({PLANES}, {TABLE}, int64, int64)")
def spare_beyond(planes: Planes, pairs: FloatArray, p: int, side: int) -> float:
    """How much farther than required the second unit of pair p is from the plane of a side that the first, one of the
    robot, stays behind, m; NaN for what does not stand still."""
    boxes, number, least, sets, lasts = planes
    r, b = number[int(pairs[p, FIRST])], int(pairs[p, SECOND])
    found = least[r, side] + (boxes[b, side] if side < 3 else -boxes[b, side]) - pairs[p, REQUIRED] - RESERVE_M
    return float(found - spread(sets, int(pairs[p, SET]), lasts, side_normal(side)))


@kernel(f"int64({PLANES}, {TABLE}, {TABLE}, {TABLE})")
def not_behind(planes: Planes, pairs: FloatArray, used: FloatArray, left: FloatArray) -> int:
    """Writes the `pairs` (P, PAIR_COLUMNS) that no plane keeps apart to `left` (P, PAIR_COLUMNS); returns how many they
    are. `used` (R, 6) becomes 1 where a plane is needed.
    """
    count, number = 0, planes[1]
    for p in range(len(pairs)):
        r, best, side, apart = number[int(pairs[p, FIRST])], -math.inf, 0, False
        for k in range(SIDES if r >= 0 else 0):
            spare = spare_beyond(planes, pairs, p, k)
            apart = apart or (used[r, k] > 0.0 and spare >= 0.0)
            if spare > best:
                best, side = spare, k
        if apart:
            continue
        if best >= 0.0:
            used[r, side] = 1.0
            continue
        for column in range(PAIR_COLUMNS):
            left[count, column] = pairs[p, column]
        count += 1
    return count


@kernel(f"void({PLANES}, {TABLE}, {TABLE})")
def drop_spare(planes: Planes, pairs: FloatArray, used: FloatArray) -> None:
    """Sets `used` (R, 6) to 0 for planes that do nothing which another one does not do: a certificate stays small."""
    number = planes[1]
    for r in range(len(used)):
        for plane in range(SIDES):
            needed = False
            for p in range(len(pairs) if used[r, plane] > 0.0 else 0):
                if number[int(pairs[p, FIRST])] != r:
                    continue
                if spare_beyond(planes, pairs, p, plane) >= 0.0:
                    needed = True
                    for k in range(SIDES):
                        if k != plane and used[r, k] > 0.0:
                            needed = needed and not spare_beyond(planes, pairs, p, k) >= 0.0
                    if needed:
                        break
            if not needed:
                used[r, plane] = 0.0
