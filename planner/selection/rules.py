"""Compiled: the rules by which known parts are ranked."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel, types
from assur.planner.selection import columns as c
from assur.planner.selection.columns import F1, F2, TIMES, Times, f8, i8
from assur.planner.selection.cycles import between, cycle
from assur.planner.selection.look_ahead import order_values

LOOK_AHEAD, FIFO, NEAREST, SPT, EDD = range(5)
MEETS, IDLE, FREE, LEAVES, SCORE, FOUND = range(6)
"""Of a part that is known, s: when it is met at the earliest, how long the arm waits for it, when the arm is free
again, until when it can be met; and its score: the least is the best, infinite for what cannot be taken."""
SOON = 1e-4
"""Of orders that are equally good the one whose first cycle ends sooner, 1/s."""
MOST_FIRST = 1e-3
"""The price of time, 1/s, where the look-ahead takes in all that is known: most parts first, then time."""
OUTSIDE_M = 10.0
"""What `nearest` adds to the distance of a part that is not within the window yet, m."""


@kernel(types.void(TIMES, F1, F2, F2), allocates=True)
def find_cycles(k: Times, arm: FloatArray, parts: FloatArray, found: FloatArray) -> None:
    """Fills MEETS to LEAVES of `found` (N, FOUND)."""
    width = c.ARM_SLOT + len(k.places)
    ends, tried = np.empty((k.there.shape[2], width)), np.empty(width)
    for i in range(len(parts)):
        found[i, MEETS], found[i, IDLE] = cycle(k, arm, parts[i], ends, tried)
        found[i, FREE] = ends[:, c.ARM_TIME].min()
        found[i, LEAVES] = parts[i, c.PART_PASSED] + k.lanes[int(parts[i, c.PART_LANE]), c.LANE_LEAVES]


@kernel(f8(TIMES, F1, F1))
def distance(k: Times, arm: FloatArray, part: FloatArray) -> float:
    """From the place where the arm is to where a part is now, m; OUTSIDE_M more if the part is before its window."""
    lane, place = int(part[c.PART_LANE]), int(arm[c.ARM_PLACE])
    own, grid, s = k.lanes[lane], k.places[place], arm[c.ARM_TIME] - part[c.PART_PASSED]
    total = 0.0
    for axis in range(2):
        is_at = between(k.lane_points[lane, axis], s, own[c.LANE_BEGIN], own[c.LANE_STEP])
        was_at = between(k.place_points[place, axis], arm[c.ARM_WAY], grid[c.PLACE_BEGIN], grid[c.PLACE_STEP])
        total += (is_at - was_at) ** 2
    return math.sqrt(total) + (OUTSIDE_M if s < own[c.LANE_ENTERS] else 0.0)


@kernel(types.void(TIMES, F1, F2, i8, f8, F2), allocates=True)
def look_ahead(k: Times, arm: FloatArray, parts: FloatArray, depth: int, price: float, found: FloatArray) -> None:
    """Scores `depth` of the parts by the best order that each begins; those that can still be taken, half of them the
    ones that leave first, half the ones whose cycles end first. The others follow by the ends of their cycles."""
    n, modes, width = len(parts), k.there.shape[2], c.ARM_SLOT + len(k.places)
    can = np.isfinite(found[:, FREE])
    size = min(int(can.sum()), depth)
    chosen, taken = np.empty(size, np.int64), np.zeros(n, np.bool_)
    for m in range(size):
        by, best = FREE if m % 2 == 0 else LEAVES, -1
        for i in range(n):
            if can[i] and not taken[i] and (best < 0 or found[i, by] < found[best, by]):
                best = i
        taken[best] = True
    m = 0
    for i in range(n):
        found[i, SCORE] = n + found[i, FREE] - arm[c.ARM_TIME]
        if taken[i]:
            chosen[m] = i
            m += 1
    rows, values = np.empty((size, c.PART)), np.empty(size)
    for m in range(size):
        rows[m] = parts[chosen[m]]
    arms, firsts = np.empty((1 << size, size, modes, width)), np.zeros((1 << size, size, modes), np.int64)
    if size == int(can.sum()):
        price = MOST_FIRST
    order_values(k, arm, rows, price, arms, firsts, np.empty((modes, width)), np.empty(width), values)
    for m in range(size):
        i = chosen[m]
        found[i, SCORE] = SOON * (found[i, FREE] - arm[c.ARM_TIME]) - values[m]


@kernel(types.void(TIMES, F1, F2, i8, i8, f8, F2), allocates=True)
def score_parts(
    k: Times, arm: FloatArray, parts: FloatArray, rule: int, depth: int, price: float, found: FloatArray
) -> None:
    """Fills `found` (N, FOUND) for the parts that are known (N, PART). `depth`, `price` (1/s): of the look-ahead."""
    find_cycles(k, arm, parts, found)
    if rule == LOOK_AHEAD:
        look_ahead(k, arm, parts, depth, price, found)
    for i in range(len(parts)):
        if rule == FIFO:
            found[i, SCORE] = i
        elif rule == EDD:
            found[i, SCORE] = found[i, LEAVES]
        elif rule == SPT:
            found[i, SCORE] = found[i, FREE]
        elif rule == NEAREST:
            found[i, SCORE] = distance(k, arm, parts[i])
        if found[i, FREE] == math.inf:
            found[i, SCORE] = math.inf
