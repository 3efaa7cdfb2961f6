"""What is too near at sampled instants: hits of a search over intervals, and the score of rough motions.

What passes is not proved. Which pairs have to be evaluated at all is found first, from boxes about all sampled places
of each unit (`sampled_behind`, and then `planes.not_behind`), if there are many.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel
from assur.planner.kernels.carriers import place_carriers
from assur.planner.kernels.intervals import Cell, fetch, needed
from assur.planner.kernels.links import POSE_COLUMNS
from assur.planner.kernels.planes import SIDES, side_normal
from assur.planner.kernels.solids import (
    CELL,
    FIRST,
    NUMBERS,
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

HIT_A, HIT_B, HIT_T, HIT_GAP, HIT_NEED, HIT_PAIR = range(6)
"""Columns of a hit: two units (pieces), the instant, s, the gap, the gap needed, m, the number of the pair."""
HIT_COLUMNS = 6
HITS, BAD = 7, 8
"""In `state`: how many hits are kept, and how many instants had one."""


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
    state[HITS] = max(state[HITS], count + 1.0)


@kernel(f"void({ROW}, {TABLE}, {TABLE}, {TABLE}, {ROW}, {CELL}, {TABLE}, float64, float64, float64, {ROW})")
def depth_at(
    robot: FloatArray,
    laws: FloatArray,
    side: FloatArray,
    q: FloatArray,
    t: FloatArray,
    cell: Cell,
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
    bodies, vertices, still = cell
    carriers, placed = np.empty((1, len(still), POSE_COLUMNS)), np.empty((1, len(bodies), POSE_COLUMNS))
    stamp, normals = np.zeros(len(bodies), dtype=np.int64), np.zeros((len(pairs), 3))
    for i in range(len(t)):
        place_carriers(robot, laws, side, q[i], t[i], carriers[0])
        worst = 0.0
        for p in range(len(pairs)):
            if pairs[p, REQUIRED] < 0.0:
                continue
            a, b, need = int(pairs[p, FIRST]), int(pairs[p, SECOND]), needed(pairs, p, since, until)
            fetch(bodies, a, carriers, placed, stamp, i + 1, still)
            fetch(bodies, b, carriers, placed, stamp, i + 1, still)
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


@kernel(f"void({ROW}, {TABLE}, {TABLE}, {TABLE}, {ROW}, {CELL}, {NUMBERS}, {TABLE})")
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
