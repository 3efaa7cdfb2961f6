"""What is too near at an instant: hits of a search over intervals, and the score of rough motions.

What passes is not proved. Which pairs have to be evaluated at all is found first, from boxes about all sampled places
of each unit (`sampled_behind`, and then `planes.not_behind`), if there are many.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel
from assur.planner.kernels.carriers import place_carriers
from assur.planner.kernels.gjk import separate
from assur.planner.kernels.intervals import FINEST_S, ITEM_FROM, ITEM_TO, RESERVE_M, Cell, Motion, fetch, least_gap
from assur.planner.kernels.laws import place_frame
from assur.planner.kernels.links import LINKS, POSE_COLUMNS, assembled, place_links
from assur.planner.kernels.proof import HALVE, OPEN, PROVED, SIDES, side_normal
from assur.planner.kernels.solids import (
    CELL,
    CUBE,
    FIRST,
    MOTION,
    NUMBERS,
    PIECES,
    REQUIRED,
    ROW,
    SECOND,
    SET,
    TABLE,
    gap,
    likely,
    place,
    spheres_apart,
    support,
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


@kernel(f"UniTuple(float64, 4)({TABLE}, {TABLE}, {CUBE}, int64, int64, {TABLE}, int64, float64)")
def widest(
    bodies: FloatArray, vertices: FloatArray, placed: FloatArray, a: int, b: int, sets: FloatArray, k: int, lasts: float
) -> tuple[float, float, float, float]:
    """How much two units are apart at the first instant beyond what is not known of them (set k), along the better of
    the vertical and the likely normal, and that normal."""
    up = 1.0 if placed[0, b, 2] >= placed[0, a, 2] else -1.0
    above = gap(bodies, vertices, placed, 0, a, b, 0.0, 0.0, up) - spread(sets, k, lasts, 0.0, 0.0, up)
    found, nx, ny, nz = likely(bodies, vertices, placed, 0, a, b, math.inf)
    found -= spread(sets, k, lasts, nx, ny, nz)
    return (found, nx, ny, nz) if found >= above else (above, 0.0, 0.0, up)


@kernel(
    f"void({ROW}, {TABLE}, {TABLE}, {TABLE}, {CUBE}, {TABLE}, {CELL}, {TABLE}, {TABLE}, float64, float64, float64,"
    f" {ROW})",
    allocates=True,
)
def depths(
    robot: FloatArray,
    laws: FloatArray,
    side: FloatArray,
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
    Only the likely normals are tried, and bodies of several pieces count as their bounding boxes: a score, not a
    verdict. `limits` (≥ 2, n): the lower and the upper ends of the joints; beyond them an instant counts as 1.
    """
    bodies, vertices, still = cell
    links, n = int(robot[LINKS]), q.shape[2]
    carriers, placed = np.empty((1, len(still), POSE_COLUMNS)), np.empty((1, len(bodies), POSE_COLUMNS))
    stamp, normals = np.zeros(len(bodies), dtype=np.int64), np.zeros((len(pairs), 3))
    number, met = 0, 0
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
                fetch(bodies, a, carriers, placed, stamp, number, still)
                fetch(bodies, b, carriers, placed, stamp, number, still)
                if spheres_apart(bodies, placed, 0, a, b, need):
                    continue
                nx, ny, nz = normals[p, 0], normals[p, 1], normals[p, 2]
                k = int(pairs[p, SET])
                if nx != 0.0 or ny != 0.0 or nz != 0.0:
                    spare = gap(bodies, vertices, placed, 0, a, b, nx, ny, nz) - need
                    if spare > 0.0 and (k < 0 or spare > spread(sets, k, lasts, nx, ny, nz)):
                        continue
                if k < 0:
                    found, nx, ny, nz = likely(bodies, vertices, placed, 0, a, b, need)
                else:
                    found, nx, ny, nz = widest(bodies, vertices, placed, a, b, sets, k, lasts)
                if not found > need:
                    # what is not known counts as deep
                    depth[w] += min(1.0, (need - found) / deepest) if found > -math.inf else 1.0
                    met = p
                    break
                normals[p, 0], normals[p, 1], normals[p, 2] = nx, ny, nz
            if depth[w] > most:
                break


@kernel(f"void({ROW}, {TABLE}, {TABLE}, {TABLE}, {ROW}, {CELL}, {NUMBERS}, {TABLE})", allocates=True)
def sampled_behind(
    robot: FloatArray,
    laws: FloatArray,
    side: FloatArray,
    q: FloatArray,
    t: FloatArray,
    cell: Cell,
    units: IntArray,
    least: FloatArray,
) -> None:
    """Fills `least` (R, 6): at all instants each of `units` is behind the plane n·x = −least of each side."""
    bodies, vertices, still = cell
    carriers, placed = np.empty((1, len(still), POSE_COLUMNS)), np.empty((1, len(bodies), POSE_COLUMNS))
    least[:] = math.inf
    for i in range(len(t)):
        place_carriers(robot, laws, side, q[i], t[i], carriers[0])
        for r in range(len(units)):
            place(bodies, units[r], carriers[0], placed, 0)
            for k in range(SIDES):
                nx, ny, nz = side_normal(k)
                found = -(nx * placed[0, units[r], 0] + ny * placed[0, units[r], 1] + nz * placed[0, units[r], 2])
                found -= support(bodies, vertices, placed, 0, units[r], nx, ny, nz)
                least[r, k] = min(least[r, k], found) if found > -math.inf else -math.inf


# The smallest clearance over a motion, between a proved lower and an upper value, by branch and bound.
#
# A pair leaves an interval when the bound of its gap over it (equation N3) is not below the smallest distance found so
# far less `WITHIN_M`; otherwise the interval is halved. The smallest such bound is below every distance at every
# instant; the smallest distance found is one that occurs. The `state` goes on from one phase to the next.

LOWER, UPPER, NEAREST_T, NEAREST_A, NEAREST_B = 2, 3, 4, 5, 6
"""In `state`, besides TOP: the proved lower value, the smallest distance found, m, when and of which units it is."""
WITHIN_M = 3e-5
"""How far the lower value may be below the upper one, m: less than the 0.05 mm that is promised."""
SHORT = 16.0
"""An interval of no more `FINEST_S` is not halved further for a normal that keeps a pair apart in its middle."""


@kernel(f"int64({TABLE}, {TABLE}, {CUBE}, {CUBE}, float64, float64, {TABLE}, int64, {TABLE}, {TABLE}, {ROW})")
def bounded(
    bodies: FloatArray,
    vertices: FloatArray,
    placed: FloatArray,
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
    a, b, h = int(items[i, 0]), int(items[i, 1]), t1 - t0
    nx, ny, nz = items[i, 3], items[i, 4], items[i, 5]
    enough, best = state[UPPER] - WITHIN_M, -math.inf
    several = bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0
    for attempt in range(3):
        if attempt == 0:
            if nx == 0.0 and ny == 0.0 and nz == 0.0:
                continue
        elif attempt == 1:
            _, nx, ny, nz = likely(bodies, vertices, placed, 1, a, b, math.inf)
        else:
            # where another normal keeps them apart in the middle it is the interval that is too long; of a short one it
            # may be the normal, which only just does
            long = h > SHORT * FINEST_S
            if not several and long and gap(bodies, vertices, placed, 1, a, b, nx, ny, nz) >= enough:
                break
            _, nx, ny, nz, above = separate(bodies, vertices, placed, 1, a, b, math.inf, points, -1, 0.0, points, work)
            if above < state[UPPER] and bodies[a, PIECES] == 0.0 and bodies[b, PIECES] == 0.0:
                state[UPPER], state[NEAREST_T], state[NEAREST_A], state[NEAREST_B] = above, 0.5 * (t0 + t1), a, b
                enough = above - WITHIN_M
        g0 = gap(bodies, vertices, placed, 0, a, b, nx, ny, nz)
        g1 = gap(bodies, vertices, placed, 2, a, b, nx, ny, nz)
        found = least_gap(bodies, jets, a, b, nx, ny, nz, g0, g1, h)
        best = max(best, found)
        if best >= enough:
            break
    items[i, 3], items[i, 4], items[i, 5] = nx, ny, nz
    if best >= enough or not (several or h > FINEST_S):
        if not best >= state[LOWER]:
            state[LOWER] = best
        return PROVED
    if several and not gap(bodies, vertices, placed, 1, a, b, nx, ny, nz) > state[UPPER]:
        return OPEN
    return HALVE


@kernel(f"void({MOTION}, {CELL}, {TABLE}, float64, float64, int64, {ROW})", allocates=True)
def sample_distance(
    motion: Motion, cell: Cell, pairs: FloatArray, t0: float, t1: float, many: int, state: FloatArray
) -> None:
    """Lowers the smallest distance found, at `many` instants of [t0, t1]; bodies of several pieces are left out."""
    robot, laws, side, tk, c, _ = motion
    bodies, vertices, still = cell
    carriers, placed = np.empty((1, len(still), POSE_COLUMNS)), np.empty((1, len(bodies), POSE_COLUMNS))
    stamp, q = np.zeros(len(bodies), dtype=np.int64), np.empty(c.shape[1])
    points, work = np.empty((4, 3)), np.empty((3, 4))
    for i in range(many):
        t = t0 + (t1 - t0) * i / max(many - 1, 1)
        spline_state(tk, c, t, q)
        place_carriers(robot, laws, side, q, t, carriers[0])
        for p in range(len(pairs)):
            a, b = int(pairs[p, FIRST]), int(pairs[p, SECOND])
            if pairs[p, REQUIRED] < 0.0 or bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0:
                continue
            fetch(bodies, a, carriers, placed, stamp, i + 1, still)
            fetch(bodies, b, carriers, placed, stamp, i + 1, still)
            if spheres_apart(bodies, placed, 0, a, b, state[UPPER]):
                continue
            found = likely(bodies, vertices, placed, 0, a, b, state[UPPER])[0]
            if found > state[UPPER] or not found > -math.inf:
                continue
            _, _, _, _, above = separate(bodies, vertices, placed, 0, a, b, state[UPPER], points, -1, 0.0, points, work)
            if above < state[UPPER]:
                state[UPPER], state[NEAREST_T], state[NEAREST_A], state[NEAREST_B] = above, t, a, b
