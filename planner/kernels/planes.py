"""Which bodies are far from all that a robot sweeps: by planes across the axes of the world (equation C6).

In a large cell most of what stands around is far from the arm, and a few rows of single units of the robot do for all
of it. The six sides are the normals +x, +y, +z, −x, −y, −z of the world. `boxes` (U, 6): least and greatest coordinates
of units, m; `others` (O, PAIR_COLUMNS - 1): bodies of the surroundings and what is required of them, the columns of a
pair without its first unit. The set of a pair is that number plus the `kind` of the robot's unit, where there are sets.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel
from assur.planner.kernels.carriers import derivative
from assur.planner.kernels.intervals import RESERVE_M, Cell, Motion, fetch, least_between, survey
from assur.planner.kernels.links import ANGLE_COUNT, LINKS, POSE_COLUMNS
from assur.planner.kernels.solids import (
    CARRIER,
    CELL,
    CUBE,
    FIRST,
    MOTION,
    NORMAL,
    NUMBERS,
    PAIR_COLUMNS,
    RADIUS,
    REQUIRED,
    ROW,
    SECOND,
    SET,
    TABLE,
    support,
)
from assur.planner.kernels.sweeps.chain import JETS
from assur.planner.kernels.sweeps.jets import ACCELERATION, JET_COLUMNS
from assur.planner.kernels.uncertainty import DOUBT, SWAY_COLUMNS, Doubt, displaced, spread, sway_links

SIDES = 6
SPARED = 512.0
"""A bound of the acceleration of a unit, as large as that of any checker, times the square of an interval, over this is
what a checker may miss of a plane that it proves over eighths of the interval (N3)."""


@kernel("UniTuple(float64, 3)(int64)")
def side_normal(side: int) -> tuple[float, float, float]:
    """The unit normal of a side."""
    sign = 1.0 if side < 3 else -1.0
    axis = side % 3
    return (sign if axis == 0 else 0.0), (sign if axis == 1 else 0.0), (sign if axis == 2 else 0.0)


@kernel(f"float64({TABLE}, {TABLE}, {CUBE}, int64, int64, {NORMAL})")
def ahead(
    bodies: FloatArray, vertices: FloatArray, placed: FloatArray, m: int, i: int, nx: float, ny: float, nz: float
) -> float:
    """How far the plane n·x = 0 is ahead of all points of unit i at instant m, m."""
    along = nx * placed[m, i, 0] + ny * placed[m, i, 1] + nz * placed[m, i, 2]
    return float(-along - support(bodies, vertices, placed, m, i, nx, ny, nz))


@kernel(f"void({MOTION}, {CELL}, {DOUBT}, {NUMBERS}, {ROW}, {TABLE})", allocates=True)
def behind(motion: Motion, cell: Cell, doubt: Doubt, units: IntArray, edges: FloatArray, least: FloatArray) -> None:
    """Fills `least` (R, 6): each of `units` (R,) stays behind the plane n·x = −least of each side all along, wherever
    its link may be displaced to.

    It is proved over each of the intervals between `edges` (N3), and is the smallest of them. What the checker may
    miss of it is taken off: it proves a plane over eighths of an interval, by bounds of its own.
    """
    bodies, vertices, still = cell
    robot, n = motion[0], motion[4].shape[1]
    links = int(robot[LINKS])
    carriers, placed = np.empty((3, len(still), POSE_COLUMNS)), np.empty((3, len(bodies), POSE_COLUMNS))
    jets, stamp = np.zeros((len(still), JETS, JET_COLUMNS)), np.zeros(len(bodies), dtype=np.int64)
    q, joints, lagging = np.empty(n), np.empty((n, JET_COLUMNS)), np.empty((n, JET_COLUMNS))
    turns, lagged = np.empty((int(robot[ANGLE_COUNT]), 2, JET_COLUMNS)), np.zeros((links, JETS, JET_COLUMNS))
    sway = np.zeros((len(still), SWAY_COLUMNS))
    least[:] = math.inf
    for part in range(len(edges) - 1):
        t0, t1 = edges[part], edges[part + 1]
        survey(motion, t0, t1, q, joints, turns, carriers, jets)
        sways = sway_links(robot, joints, doubt, t1, lagging, turns, lagged, sway)
        for r in range(len(units)):
            i = units[r]
            fetch(bodies, i, carriers, placed, stamp, part + 1, still)
            turning, square = jets[int(bodies[i, CARRIER])], (t1 - t0) * (t1 - t0)
            turned = 0.0
            for j in range(3, JETS):
                turned += (abs(turning[j, ACCELERATION]) + turning[j, ACCELERATION + 1]) ** 2
            for k in range(SIDES):
                nx, ny, nz = side_normal(k)
                g0 = ahead(bodies, vertices, placed, 0, i, nx, ny, nz)
                g1 = ahead(bodies, vertices, placed, 2, i, nx, ny, nz)
                middle, radius = derivative(bodies, jets, i, 2, nx, ny, nz)
                shown = least_between(g0, g1, radius - middle, t1 - t0)
                shown -= (abs(middle) + radius + bodies[i, RADIUS] * math.sqrt(turned)) * square / SPARED
                if sways:
                    shown -= displaced(bodies, sway, i, nx, ny, nz)
                # what is not a number shows nothing
                least[r, k] = min(least[r, k], shown) if shown > -math.inf else -math.inf


@kernel(f"float64({TABLE}, int64, int64, {TABLE}, float64, int64)")
def wanted_beyond(others: FloatArray, o: int, kind: int, sets: FloatArray, lasts: float, side: int) -> float:
    """The distance, m, that body number o must be from a plane of a side for a unit of the robot of a kind behind
    it."""
    found, k = others[o, REQUIRED - 1] + RESERVE_M, int(others[o, SET - 1])
    if k < 0:
        return float(found)
    nx, ny, nz = side_normal(side)
    return float(found + spread(sets, k + kind, lasts, nx, ny, nz))


@kernel(
    f"int64({TABLE}, {NUMBERS}, {NUMBERS}, {TABLE}, {TABLE}, {TABLE}, {TABLE}, float64, {TABLE}, {TABLE})",
    allocates=True,
)
def not_behind(
    boxes: FloatArray,
    units: IntArray,
    kinds: IntArray,
    least: FloatArray,
    others: FloatArray,
    special: FloatArray,
    sets: FloatArray,
    lasts: float,
    used: FloatArray,
    pairs: FloatArray,
) -> int:
    """Writes the pairs of `units` (R,) and `others` that no plane keeps apart to `pairs`; returns how many they are.

    `least` (R, 6) is what `behind` found; `used` (R, 6) becomes 1 where it is needed. `boxes` are NaN for what does not
    stand still. `special` (A, PAIR_COLUMNS): pairs with what is required of them instead of what `others` says, which
    is never more. `sets`: by how much more they must be apart, where errors have grown for `lasts` seconds. -1: `pairs`
    is too short.
    """
    together, count = np.empty(SIDES), 0
    for k in range(SIDES):
        together[k] = math.inf
        for r in range(len(units)):
            together[k] = min(together[k], least[r, k])
    for o in range(len(others)):
        b, unsure = int(others[o, 0]), others[o, SET - 1] >= 0.0
        best, side = -math.inf, 0
        for k in range(0 if unsure else SIDES):  # sets are asked unit by unit
            beyond = together[k] + (boxes[b, k] if k < 3 else -boxes[b, k])
            if beyond > best:
                best, side = beyond, k
        if best >= others[o, REQUIRED - 1] + RESERVE_M:
            for r in range(len(units)):
                used[r, side] = 1.0
            continue
        for r in range(len(units)):
            best, side, apart = -math.inf, 0, False
            for k in range(SIDES):
                beyond = least[r, k] + (boxes[b, k] if k < 3 else -boxes[b, k])
                beyond -= wanted_beyond(others, o, kinds[r], sets, lasts, k)
                apart = apart or (used[r, k] > 0.0 and beyond >= 0.0)
                if beyond > best:
                    best, side = beyond, k
            if apart:
                continue
            if best >= 0.0:
                used[r, side] = 1.0
                continue
            if count == len(pairs):
                return -1
            pairs[count, FIRST], pairs[count, SECOND] = units[r], b
            for column in range(REQUIRED, PAIR_COLUMNS):
                pairs[count, column] = others[o, column - 1]
            if unsure:
                pairs[count, SET] += kinds[r]
            for k in range(len(special)):
                if special[k, FIRST] == units[r] and special[k, SECOND] == b:
                    for column in range(REQUIRED, PAIR_COLUMNS):
                        pairs[count, column] = special[k, column]
            count += 1
    return count


@kernel(f"void({TABLE}, {NUMBERS}, {NUMBERS}, {TABLE}, {TABLE}, {TABLE}, float64, {TABLE})")
def drop_spare(
    boxes: FloatArray,
    units: IntArray,
    kinds: IntArray,
    least: FloatArray,
    others: FloatArray,
    sets: FloatArray,
    lasts: float,
    used: FloatArray,
) -> None:
    """Sets `used` (R, 6) to 0 for planes that do nothing which another one does not do: a certificate stays small."""
    for r in range(len(units)):
        for spare in range(SIDES):
            if used[r, spare] == 0.0:
                continue
            does = False
            for o in range(len(others)):
                b = int(others[o, 0])
                need = wanted_beyond(others, o, kinds[r], sets, lasts, spare)
                if not least[r, spare] + (boxes[b, spare] if spare < 3 else -boxes[b, spare]) >= need:
                    continue
                alone = True
                for k in range(SIDES):
                    beyond = least[r, k] + (boxes[b, k] if k < 3 else -boxes[b, k])
                    if k != spare and used[r, k] > 0.0 and beyond >= wanted_beyond(others, o, kinds[r], sets, lasts, k):
                        alone = False
                        break
                if alone:
                    does = True
                    break
            if not does:
                used[r, spare] = 0.0
