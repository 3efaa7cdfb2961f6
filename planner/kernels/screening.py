"""What is too near at sampled instants: refuses most colliding candidates, scores rough motions, and judges postures.

What passes is not proved. Which pairs may be looked over at all is found first, from boxes about all sampled places of
each unit (`sampled_behind`, and then `planes.not_behind`), if there are many.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel
from assur.planner.kernels.carriers import place_carriers
from assur.planner.kernels.gjk import separate
from assur.planner.kernels.links import POSE_COLUMNS
from assur.planner.kernels.planes import SIDES, side_normal
from assur.planner.kernels.proof import KEPT_STILL, needed
from assur.planner.kernels.solids import (
    CARRIER,
    CUBE,
    FIRST,
    NUMBERS,
    OPENED,
    PIECES,
    REQUIRED,
    ROW,
    SECOND,
    TABLE,
    gap,
    likely,
    place,
    spheres_apart,
    support,
)

HIT_A, HIT_B, HIT_AT, HIT_GAP, HIT_NEED, HIT_PAIR = range(6)
"""Columns of a hit: two units (pieces), the number of the instant, the gap, the gap needed, the number of the pair."""
HIT_COLUMNS = 6


@kernel(f"void({TABLE}, int64, {TABLE}, {CUBE}, {NUMBERS}, int64, {NUMBERS})")
def fetch_one(
    bodies: FloatArray, i: int, carriers: FloatArray, placed: FloatArray, stamp: IntArray, number: int, still: IntArray
) -> None:
    """Places unit i at instant number `number`, unless it has been."""
    if stamp[i] < number:
        place(bodies, i, carriers, placed, 0)
        stamp[i] = KEPT_STILL if still[int(bodies[i, CARRIER])] else number


@kernel(f"float64({TABLE}, {TABLE}, {CUBE}, int64, int64, float64, {TABLE}, int64, {TABLE}, {TABLE})")
def unit_gap(
    bodies: FloatArray,
    vertices: FloatArray,
    placed: FloatArray,
    a: int,
    b: int,
    need: float,
    normals: FloatArray,
    p: int,
    points: FloatArray,
    work: FloatArray,
) -> float:
    """A lower bound of the distance of two units: the first that exceeds `need`, or else the largest that is found.

    Row p of `normals` is tried first, and takes the normal that did: it often does at the next instant, too.
    """
    nx, ny, nz = normals[p, 0], normals[p, 1], normals[p, 2]
    if nx != 0.0 or ny != 0.0 or nz != 0.0:
        found = gap(bodies, vertices, placed, 0, a, b, nx, ny, nz)
        if found > need:
            return found
    if spheres_apart(bodies, placed, 0, a, b, need):
        return math.inf
    found, nx, ny, nz = likely(bodies, vertices, placed, 0, a, b, need)
    if not found > need:
        other, nx, ny, nz, _ = separate(bodies, vertices, placed, 0, a, b, need, points, work)
        if other > found:
            found = other
    if found > need:
        normals[p, 0], normals[p, 1], normals[p, 2] = nx, ny, nz
    return found


@kernel(
    f"float64({TABLE}, {TABLE}, {TABLE}, {CUBE}, {NUMBERS}, int64, {NUMBERS}, int64, int64, float64, {TABLE}, int64,"
    f" {TABLE}, {TABLE}, {ROW})"
)
def body_gap(
    bodies: FloatArray,
    vertices: FloatArray,
    carriers: FloatArray,
    placed: FloatArray,
    stamp: IntArray,
    number: int,
    still: IntArray,
    a: int,
    b: int,
    need: float,
    normals: FloatArray,
    p: int,
    points: FloatArray,
    work: FloatArray,
    hit: FloatArray,
) -> float:
    """The same for two bodies: where their bounding boxes are too near, the least among their pieces.

    `hit` takes the two pieces.
    """
    fetch_one(bodies, a, carriers, placed, stamp, number, still)
    fetch_one(bodies, b, carriers, placed, stamp, number, still)
    found = unit_gap(bodies, vertices, placed, a, b, need, normals, p, points, work)
    hit[HIT_A], hit[HIT_B] = a, b
    if found > need or not (bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0):
        return found
    first_a, count_a = (int(bodies[a, OPENED]), int(bodies[a, PIECES])) if bodies[a, PIECES] > 0.0 else (a, 1)
    first_b, count_b = (int(bodies[b, OPENED]), int(bodies[b, PIECES])) if bodies[b, PIECES] > 0.0 else (b, 1)
    least = math.inf
    for i in range(first_a, first_a + count_a):
        fetch_one(bodies, i, carriers, placed, stamp, number, still)
        if count_b > 1 and unit_gap(bodies, vertices, placed, i, b, need, normals, p, points, work) > need:
            continue
        for j in range(first_b, first_b + count_b):
            fetch_one(bodies, j, carriers, placed, stamp, number, still)
            found = unit_gap(bodies, vertices, placed, i, j, need, normals, p, points, work)
            if found < least:
                least = found
                hit[HIT_A], hit[HIT_B] = i, j
    return least


@kernel(f"int64({TABLE}, int64, {ROW})")
def note_hit(hits: FloatArray, count: int, hit: FloatArray) -> int:
    """Keeps a hit, the deepest of each pair; where there is no room, it is left out. Returns how many are kept."""
    for k in range(count):
        if hits[k, HIT_PAIR] == hit[HIT_PAIR]:
            if not hits[k, HIT_GAP] - hits[k, HIT_NEED] <= hit[HIT_GAP] - hit[HIT_NEED]:
                for column in range(HIT_COLUMNS):
                    hits[k, column] = hit[column]
            return count
    if count == len(hits):
        return count
    for column in range(HIT_COLUMNS):
        hits[count, column] = hit[column]
    return count + 1


@kernel(
    f"UniTuple(int64, 3)({ROW}, {TABLE}, {TABLE}, {TABLE}, {ROW}, {TABLE}, {TABLE}, {NUMBERS}, {TABLE}, float64,"
    f" float64, int64, {TABLE})"
)
def screen(
    robot: FloatArray,
    laws: FloatArray,
    side: FloatArray,
    q: FloatArray,
    t: FloatArray,
    bodies: FloatArray,
    vertices: FloatArray,
    still: IntArray,
    pairs: FloatArray,
    since: float,
    until: float,
    enough: int,
    hits: FloatArray,
) -> tuple[int, int, int]:
    """What is too near at instants `t` (T,) with joints `q` (T, n): instants evaluated, those with a hit, hits.

    Instants are taken farthest from each other first, until `enough` of them have a hit. `hits` (H, HIT_COLUMNS) takes
    the deepest hit of each pair. Required is what C5 says for the end of a phase, `until`, without the term of a late
    start; pairs that may touch are left out.
    """
    carriers, placed = np.empty((len(still), POSE_COLUMNS)), np.empty((1, len(bodies), POSE_COLUMNS))
    stamp, hit = np.zeros(len(bodies), dtype=np.int64), np.zeros(HIT_COLUMNS)
    points, work = np.empty((4, 3)), np.empty((3, 4))
    normals, evaluated, bad, count = np.zeros((len(pairs), 3)), 0, 0, 0
    start, stride = 0, 1
    while stride < len(t):
        stride *= 2
    while True:
        for i in range(start, len(t), stride):
            evaluated += 1
            place_carriers(robot, laws, side, q[i], t[i], carriers)
            free = True
            for p in range(len(pairs)):
                if pairs[p, REQUIRED] < 0.0:
                    continue
                need = needed(pairs, p, since, until)
                found = body_gap(
                    bodies, vertices, carriers, placed, stamp, evaluated, still,
                    int(pairs[p, FIRST]), int(pairs[p, SECOND]), need, normals, p, points, work, hit,
                )  # fmt: skip
                if not found > need:
                    hit[HIT_AT], hit[HIT_GAP], hit[HIT_NEED], hit[HIT_PAIR] = i, found, need, p
                    count = note_hit(hits, count, hit)
                    free = False
            if not free:
                bad += 1
                if bad >= enough:
                    return evaluated, bad, count
        if start > 0:
            stride = start
        if stride == 1:
            break
        start = stride // 2
    return evaluated, bad, count


@kernel(
    f"void({ROW}, {TABLE}, {TABLE}, {TABLE}, {ROW}, {TABLE}, {TABLE}, {NUMBERS}, {TABLE}, float64, float64, float64,"
    f" {ROW})"
)
def depth_at(
    robot: FloatArray,
    laws: FloatArray,
    side: FloatArray,
    q: FloatArray,
    t: FloatArray,
    bodies: FloatArray,
    vertices: FloatArray,
    still: IntArray,
    pairs: FloatArray,
    since: float,
    until: float,
    deepest: float,
    depth: FloatArray,
) -> None:
    """Adds to `depth` (N,) by how much the worst pair is nearer than required at instants `t` (N,) with joints `q`.

    It is a share of `deepest`, m, and 1 at most. Only the likely normals are tried, and bodies of several pieces count
    as their bounding boxes: a score, not a verdict.
    """
    carriers, placed = np.empty((len(still), POSE_COLUMNS)), np.empty((1, len(bodies), POSE_COLUMNS))
    stamp, normals = np.zeros(len(bodies), dtype=np.int64), np.zeros((len(pairs), 3))
    for i in range(len(t)):
        place_carriers(robot, laws, side, q[i], t[i], carriers)
        worst = 0.0
        for p in range(len(pairs)):
            if pairs[p, REQUIRED] < 0.0:
                continue
            a, b, need = int(pairs[p, FIRST]), int(pairs[p, SECOND]), needed(pairs, p, since, until)
            fetch_one(bodies, a, carriers, placed, stamp, i + 1, still)
            fetch_one(bodies, b, carriers, placed, stamp, i + 1, still)
            nx, ny, nz = normals[p, 0], normals[p, 1], normals[p, 2]
            if (nx != 0.0 or ny != 0.0 or nz != 0.0) and gap(bodies, vertices, placed, 0, a, b, nx, ny, nz) > need:
                continue
            if spheres_apart(bodies, placed, 0, a, b, need):
                continue
            found, nx, ny, nz = likely(bodies, vertices, placed, 0, a, b, need)
            if found > need:
                normals[p, 0], normals[p, 1], normals[p, 2] = nx, ny, nz
            else:
                # what is not known counts as deep
                worst = max(worst, need - found) if found > -math.inf else deepest
                if not worst < deepest:
                    worst = deepest
                    break
        depth[i] += worst / deepest


@kernel(f"void({ROW}, {TABLE}, {TABLE}, {TABLE}, {ROW}, {TABLE}, {TABLE}, {NUMBERS}, {NUMBERS}, {TABLE})")
def sampled_behind(
    robot: FloatArray,
    laws: FloatArray,
    side: FloatArray,
    q: FloatArray,
    t: FloatArray,
    bodies: FloatArray,
    vertices: FloatArray,
    still: IntArray,
    units: IntArray,
    least: FloatArray,
) -> None:
    """Fills `least` (R, 6): at all instants each of `units` is behind the plane n·x = −least of each side."""
    carriers, placed = np.empty((len(still), POSE_COLUMNS)), np.empty((1, len(bodies), POSE_COLUMNS))
    least[:] = math.inf
    for i in range(len(t)):
        place_carriers(robot, laws, side, q[i], t[i], carriers)
        for r in range(len(units)):
            place(bodies, units[r], carriers, placed, 0)
            for k in range(SIDES):
                nx, ny, nz = side_normal(k)
                found = -(nx * placed[0, units[r], 0] + ny * placed[0, units[r], 1] + nz * placed[0, units[r], 2])
                found -= support(bodies, vertices, placed, 0, units[r], nx, ny, nz)
                least[r, k] = min(least[r, k], found) if found > -math.inf else -math.inf
