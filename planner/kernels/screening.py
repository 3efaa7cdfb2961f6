"""What is too near at an instant: hits of a search over intervals, and the score of rough motions.

What passes is not proved. Which pairs have to be evaluated at all is found first, from boxes about all sampled places
of each unit (`sampled_behind`, and then `planes.not_behind`), if there are many.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel
from assur.planner.kernels.carriers import CARRIED, Carried, place_carriers
from assur.planner.kernels.gjk import separate
from assur.planner.kernels.intervals import (
    FINEST_S,
    ITEM_FROM,
    ITEM_TO,
    MOTION,
    RESERVE_M,
    Cell,
    Motion,
    keep_normal,
    least_gap,
    normal_of,
    place_unit,
    places_for,
)
from assur.planner.kernels.laws import place_frame
from assur.planner.kernels.links import LINKS, assembled, place_links
from assur.planner.kernels.proof import HALVE, OPEN, PROVED, SIDES, leads, side_normal
from assur.planner.kernels.solids import (
    CELL,
    CUBE,
    FIRST,
    NORMAL,
    NUMBERS,
    OPENED,
    PIECES,
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
    place,
    spheres_apart,
)
from assur.planner.kernels.spline import spline_state
from assur.planner.kernels.uncertainty import spread

HIT_A, HIT_B, HIT_T, HIT_GAP, HIT_NEED, HIT_PAIR, HIT_S = range(7)
"""Columns of a hit: two units (pieces), the instant, s, the gap, the gap needed, m, the number of the pair, the shift,
s."""
HIT_COLUMNS = 7
HITS = 7
"""In `state`: how many hits are kept."""


@kernel(f"void({TABLE}, {ROW}, {TABLE}, int64, float64, {ROW})")
def note_hit(hits: FloatArray, state: FloatArray, items: FloatArray, i: int, t: float, found: FloatArray) -> None:
    """Keeps item i at time t as a hit, the deepest of each pair; where there is no room, it is left out.

    `found` (2,): its gap and the one needed.
    """
    count, pair = int(state[HITS]), items[i, 2]
    for k in range(count):
        if hits[k, HIT_PAIR] == pair:
            if hits[k, HIT_GAP] - hits[k, HIT_NEED] <= found[0] - found[1]:
                return
            count = k
            break
    if count == len(hits):
        return
    hits[count, HIT_A], hits[count, HIT_B], hits[count, HIT_T] = items[i, 0], items[i, 1], t
    hits[count, HIT_GAP], hits[count, HIT_NEED], hits[count, HIT_PAIR] = found[0], found[1], pair
    hits[count, HIT_S] = 0.5 * (items[i, ITEM_FROM] + items[i, ITEM_TO])
    state[HITS] = max(state[HITS], count + 1.0)


@kernel(f"Tuple((float64, {NORMAL}))({UNITS}, int64, int64, {TABLE}, int64, float64)")
def widest(units: Units, a: int, b: int, sets: FloatArray, k: int, lasts: float) -> tuple[float, Normal]:
    """How much two units are apart at the first instant beyond their uncertainty (set k), along the better of
    the vertical and the likely normal, and that normal."""
    up = (0.0, 0.0, 1.0 if units[2][0, b, 2] >= units[2][0, a, 2] else -1.0)
    above = gap(units, 0, a, b, up) - spread(sets, k, lasts, up)
    found, normal = likely(units, 0, a, b, math.inf)
    found -= spread(sets, k, lasts, normal)
    return (found, normal) if found >= above else (above, up)


@kernel(f"float64({UNITS}, {CUBE}, {NUMBERS}, int64, {NUMBERS}, {ROW}, {TABLE}, float64)")
def first_piece(
    units: Units,
    carriers: FloatArray,
    stamp: IntArray,
    number: int,
    still: IntArray,
    pair: FloatArray,
    sets: FloatArray,
    lasts: float,
) -> float:
    """The gap of the first pieces of a pair of bodies that are found too near; infinity: there are none."""
    bodies, need, k = units[0], pair[REQUIRED] + RESERVE_M, int(pair[SET])
    a, b = int(pair[FIRST]), int(pair[SECOND])
    own, others = max(int(bodies[a, PIECES]), 1), max(int(bodies[b, PIECES]), 1)
    if bodies[a, PIECES] > 0.0:
        a = int(bodies[a, OPENED])
    if bodies[b, PIECES] > 0.0:
        b = int(bodies[b, OPENED])
    for i in range(a, a + own):
        place_unit(units, i, carriers, stamp, number, still)
        for j in range(b, b + others):
            place_unit(units, j, carriers, stamp, number, still)
            if spheres_apart(units, 0, i, j, need):
                continue
            if k < 0:
                found, _ = likely(units, 0, i, j, need)
            else:
                found, _ = widest(units, i, j, sets, k, lasts)
            if not found > need:
                return float(found)
    return math.inf


@kernel(
    f"void({CARRIED}, {TABLE}, {CUBE}, {TABLE}, {CELL}, {TABLE}, {TABLE}, float64, float64, float64, {ROW})",
    allocates=True,
)
def depths(
    carried: Carried,
    limits: FloatArray,
    q: FloatArray,
    t: FloatArray,
    cell: Cell,
    pairs: FloatArray,
    sets: FloatArray,
    lasts: float,
    deepest: float,
    most: float,
    depth: FloatArray,
) -> None:
    """Fills `depth` (W,) with the sum, over instants `t` (W, T) with joints `q` (W, T, n), of how much nearer than
    required some pair is: a share of `deepest`, m, and 1 at most.

    At each instant the first pair that is found too near counts. A motion whose sum exceeds `most` is given up there.
    Only the likely normals are tried: a score, not a verdict. `limits` (≥ 2, n): the lower and the upper ends of the
    joints; beyond them an instant counts as 1.
    """
    (robot, laws, side), (bodies, _, still) = carried, cell
    links, n = int(robot[LINKS]), q.shape[2]
    (carriers, units), met = places_for(cell, 1), 0
    stamp, normals = np.zeros(len(bodies), dtype=np.int64), np.zeros((len(pairs), 3))
    number = 0
    for w in range(len(q)):
        depth[w] = 0.0
        for i in range(q.shape[1]):
            within = True
            for j in range(n):
                within = within and limits[0, j] <= q[w, i, j] <= limits[1, j]
            if not within or not assembled(robot, q[w, i], q[w, i]):
                depth[w] += 1.0
                if depth[w] > most:
                    break
                continue
            number += 1
            place_links(robot, q[w, i], carriers[0])
            for f in range(len(laws)):
                if number == 1 or not still[links + f]:
                    place_frame(laws[f], side, t[w, i], carriers[0], links + f)
            # what was met last is likely to be met again
            for turn in range(-1, len(pairs)):
                p = turn if turn >= 0 else met
                if p >= len(pairs) or pairs[p, REQUIRED] < 0.0:
                    continue
                a, b, need = int(pairs[p, FIRST]), int(pairs[p, SECOND]), pairs[p, REQUIRED] + RESERVE_M
                place_unit(units, a, carriers, stamp, number, still)
                place_unit(units, b, carriers, stamp, number, still)
                if spheres_apart(units, 0, a, b, need):
                    continue
                normal, k = (normals[p, 0], normals[p, 1], normals[p, 2]), int(pairs[p, SET])
                if normal != (0.0, 0.0, 0.0):
                    spare = gap(units, 0, a, b, normal) - need
                    if spare > 0.0 and (k < 0 or spare > spread(sets, k, lasts, normal)):
                        continue
                if k < 0:
                    found, normal = likely(units, 0, a, b, need)
                else:
                    found, normal = widest(units, a, b, sets, k, lasts)
                if not found > need and (bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0):
                    # the normal of boxes that overlap keeps nothing apart
                    found = first_piece(units, carriers, stamp, number, still, pairs[p], sets, lasts)
                    normal = (0.0, 0.0, 0.0)
                if not found > need:
                    # an unknown gap counts as deep
                    depth[w] += min(1.0, (need - found) / deepest) if found > -math.inf else 1.0
                    met = p
                    break
                normals[p, 0], normals[p, 1], normals[p, 2] = normal
            if depth[w] > most:
                break


@kernel(f"void({CARRIED}, {TABLE}, {ROW}, {CELL}, {NUMBERS}, {TABLE})", allocates=True)
def sampled_behind(
    carried: Carried, q: FloatArray, t: FloatArray, cell: Cell, mine: IntArray, least: FloatArray
) -> None:
    """Fills `least` (R, 6): at all instants each unit of `mine` is behind the plane n·x = −least of each side."""
    carriers, units = places_for(cell, 1)
    least[:] = math.inf
    for i in range(len(t)):
        place_carriers(carried, q[i], t[i], carriers[0])
        for r in range(len(mine)):
            place(units[0], mine[r], carriers[0], units[2], 0)
            for k in range(SIDES):
                found = leads(units, 0, mine[r], side_normal(k))
                least[r, k] = min(least[r, k], found) if found > -math.inf else -math.inf


# The smallest clearance over a motion, between a proved lower and an upper value, by branch and bound.
#
# A pair leaves an interval when the bound of its gap over it (equation N3) is not below the smallest distance found so
# far less `WITHIN_M`; otherwise the interval is halved. The smallest such bound is below every distance at every
# instant; the smallest distance found is one that occurs. The `state` goes on from one phase to the next.

LOWER, UPPER, NEAREST_T, NEAREST_A, NEAREST_B = 2, 3, 4, 5, 6
"""In `state`, besides TOP: the proved lower value, the smallest distance found, m, its time and its units."""
WITHIN_M = 3e-5
"""How far the lower value may be below the upper one, m: less than the 0.05 mm that is promised."""
SHORT = 16.0
"""An interval of no more `FINEST_S` is not halved further for a normal that keeps a pair apart in its middle."""


@kernel(f"int64({UNITS}, {CUBE}, float64, float64, {TABLE}, int64, {TABLE}, {TABLE}, {ROW})")
def bounded(
    units: Units,
    jets: FloatArray,
    t0: float,
    t1: float,
    items: FloatArray,
    i: int,
    points: FloatArray,
    work: FloatArray,
    state: FloatArray,
) -> int:
    """What becomes of item i on [t0, t1]: it leaves (`PROVED`), is halved or opened.

    The state takes what is found, the item its best normal.
    """
    a, b, h, bodies = int(items[i, 0]), int(items[i, 1]), t1 - t0, units[0]
    normal = normal_of(items, i)
    enough, best = state[UPPER] - WITHIN_M, -math.inf
    several = bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0
    for attempt in range(3):
        if attempt == 0:
            if normal == (0.0, 0.0, 0.0):
                continue
        elif attempt == 1:
            _, normal = likely(units, 1, a, b, math.inf)
        else:
            # where another normal keeps them apart in the middle it is the interval that is too long; of a short one it
            # may be the normal, which only just does
            long = h > SHORT * FINEST_S
            if not several and long and gap(units, 1, a, b, normal) >= enough:
                break
            _, normal, above = separate(units, 1, a, b, math.inf, points, -1, 0.0, points, work)
            if above < state[UPPER] and bodies[a, PIECES] == 0.0 and bodies[b, PIECES] == 0.0:
                state[UPPER], state[NEAREST_T], state[NEAREST_A], state[NEAREST_B] = above, 0.5 * (t0 + t1), a, b
                enough = above - WITHIN_M
        ends = gap(units, 0, a, b, normal), gap(units, 2, a, b, normal)
        best = max(best, least_gap(bodies, jets, a, b, normal, *ends, h))
        if best >= enough:
            break
    keep_normal(items, i, normal)
    if best >= enough or not (several or h > FINEST_S):
        if not best >= state[LOWER]:
            state[LOWER] = best
        return PROVED
    if several and not gap(units, 1, a, b, normal) > state[UPPER]:
        return OPEN
    return HALVE


@kernel(f"void({MOTION}, {CELL}, {TABLE}, float64, float64, int64, {ROW})", allocates=True)
def sample_distance(
    motion: Motion, cell: Cell, pairs: FloatArray, t0: float, t1: float, many: int, state: FloatArray
) -> None:
    """Lowers the smallest distance found, at `many` instants of [t0, t1]; bodies of several pieces are left out."""
    (carried, spline), (bodies, _, still) = motion, cell
    carriers, units = places_for(cell, 1)
    stamp, q = np.zeros(len(bodies), dtype=np.int64), np.empty(spline[1].shape[1])
    points, work = np.empty((4, 3)), np.empty((3, 4))
    for i in range(many):
        t = t0 + (t1 - t0) * i / max(many - 1, 1)
        spline_state(spline, t, q)
        place_carriers(carried, q, t, carriers[0])
        for p in range(len(pairs)):
            a, b = int(pairs[p, FIRST]), int(pairs[p, SECOND])
            if pairs[p, REQUIRED] < 0.0 or bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0:
                continue
            place_unit(units, a, carriers, stamp, i + 1, still)
            place_unit(units, b, carriers, stamp, i + 1, still)
            if spheres_apart(units, 0, a, b, state[UPPER]):
                continue
            found = likely(units, 0, a, b, state[UPPER])[0]
            if found > state[UPPER] or not found > -math.inf:
                continue
            above = separate(units, 0, a, b, state[UPPER], points, -1, 0.0, points, work)[2]
            if above < state[UPPER]:
                state[UPPER], state[NEAREST_T], state[NEAREST_A], state[NEAREST_B] = above, t, a, b
