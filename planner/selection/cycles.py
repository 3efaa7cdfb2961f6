"""Compiled: the earliest end of a cycle, which goes to a part, picks it, goes to its place and puts it down."""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel, types
from assur.planner.selection import columns as c
from assur.planner.selection.columns import F1, F2, TIMES, Times, f8, i8

ROUNDS, WITHIN_S = 12, 1e-5
"""A meeting moves while the arm is on its way: how often it is computed anew at most, and when it is known."""
LATE_S = 1e-6
"""By how much a meeting may be after the end of the window: rounding."""


@kernel(f8(F1, f8, f8, f8), inline=True)
def between(row: FloatArray, at: float, begin: float, step: float) -> float:
    """The value of a row of a grid, linear between its points."""
    if len(row) == 1:
        return float(row[0])
    i = min(max(int((at - begin) / step), 0), len(row) - 2)
    share = (at - begin) / step - i
    return float(row[i] * (1.0 - share) + row[i + 1] * share)


@kernel(types.void(F1, F1), inline=True)
def copy_arm(arm: FloatArray, copy: FloatArray) -> None:
    """Writes an arm over another one. (A slice would allocate.)"""
    for i in range(len(arm)):
        copy[i] = arm[i]


@kernel(types.UniTuple(f8, 2)(TIMES, F1, i8, i8, f8), inline=True)
def meeting(k: Times, arm: FloatArray, lane: int, mode: int, passed: float) -> tuple[float, float]:
    """The earliest instant above a part, s, and the time before that the arm waits, s; infinite: it leaves before."""
    own, place, since = k.lanes[lane], int(arm[c.ARM_PLACE]), int(arm[c.ARM_MODE])
    grid, last = k.places[place], k.there.shape[1] - 1
    at = (arm[c.ARM_WAY] - grid[c.PLACE_BEGIN]) / grid[c.PLACE_STEP]
    i = min(max(int(at), 0), max(last - 1, 0))
    share, here = at - i, k.there[place, i, since, lane, mode]
    beside = k.there[place, min(i + 1, last), since, lane, mode]
    enters = passed + own[c.LANE_ENTERS]
    met = ready = max(arm[c.ARM_TIME], enters)
    for _ in range(ROUNDS):
        s = min(max(met - passed, own[c.LANE_ENTERS]), own[c.LANE_LEAVES])
        travel = between(here, s, own[c.LANE_BEGIN], own[c.LANE_STEP])
        if share > 0.0:
            travel += share * (between(beside, s, own[c.LANE_BEGIN], own[c.LANE_STEP]) - travel)
        if travel >= 1e-3 * c.UNREACHED:
            return math.inf, 0.0
        ready = arm[c.ARM_TIME] + travel
        later = max(ready, enters)
        if abs(later - met) < WITHIN_S:
            break
        met = later
    if met - passed > own[c.LANE_LEAVES] + LATE_S:
        return math.inf, 0.0
    return met, met - ready


@kernel(types.void(TIMES, F1, F1, i8, i8, f8, F1), inline=True)
def put_down(
    k: Times,
    arm: FloatArray,
    part: FloatArray,
    mode: int,
    later: int,
    picked: float,
    end: FloatArray,
) -> None:
    """Writes the arm after the part, which it has since `picked` in `mode`, is put down in mode `later`; its time is
    infinite if the place is out of reach. Slots are filled in their order."""
    lane, place, ride = int(part[c.PART_LANE]), int(part[c.PART_PLACE]), k.rides[0, c.RIDE_PLACE]
    own, grid = k.lanes[lane], k.places[place]
    s = picked - part[c.PART_PASSED]
    at = (s - own[c.LANE_BEGIN]) / own[c.LANE_STEP]
    i = min(max(int(at), 0), k.back.shape[2] - 2)
    share, last = at - i, k.back.shape[4] - 1
    copy_arm(arm, end)
    end[c.ARM_PLACE], end[c.ARM_MODE], end[c.ARM_TIME] = place, later, math.inf
    slot, period = int(arm[c.ARM_SLOT + place]), grid[c.PLACE_PERIOD]
    while True:
        way = slot % grid[c.PLACE_SLOTS] if period == 0.0 else grid[c.PLACE_BEGIN]
        opens = slot * period + grid[c.PLACE_BEGIN]
        arrives = picked if period == 0.0 else max(picked, opens)
        for _ in range(ROUNDS):
            if period > 0.0:
                way = min(max(arrives - slot * period, grid[c.PLACE_BEGIN]), grid[c.PLACE_LEAVES])
            on = (way - grid[c.PLACE_BEGIN]) / grid[c.PLACE_STEP]
            m = min(max(int(on), 0), max(last - 1, 0))
            rest, n = on - m, min(m + 1, last)
            here, there = k.back[lane, mode, i, place], k.back[lane, mode, i + 1, place]
            one = here[m, later] * (1.0 - rest) + here[n, later] * rest
            other = there[m, later] * (1.0 - rest) + there[n, later] * rest
            travel = one * (1.0 - share) + other * share
            if travel >= 1e-3 * c.UNREACHED:
                return
            new = picked + travel if period == 0.0 else max(picked + travel, opens)
            if abs(new - arrives) < WITHIN_S:
                arrives = new
                break
            arrives = new
        if period > 0.0:
            way = arrives + ride - slot * period
        if period == 0.0 or way <= grid[c.PLACE_LEAVES]:
            end[c.ARM_TIME], end[c.ARM_WAY], end[c.ARM_SLOT + place] = arrives + ride, way, slot + 1
            return
        if arrives == opens:
            return  # no slot stays as long as it takes
        slot += 1  # this one leaves empty


@kernel(types.UniTuple(f8, 2)(TIMES, F1, F1, F2, F1), entry=True)
def cycle(k: Times, arm: FloatArray, part: FloatArray, ends: FloatArray, tried: FloatArray) -> tuple[float, float]:
    """Writes the arm after a part, for each mode that it may have then, into `ends` (E, ARM + P); a time that is
    infinite: it cannot be taken. `tried` (ARM + P,) is overwritten. Returns when the part is met in the cycle that ends
    first, and how long the arm waits for it, s."""
    first, met, idle = math.inf, math.inf, 0.0
    ends[:, c.ARM_TIME] = math.inf
    for mode in range(len(ends)):
        above, waits = meeting(k, arm, int(part[c.PART_LANE]), mode, part[c.PART_PASSED])
        if above == math.inf:
            continue
        for later in range(len(ends)):
            put_down(k, arm, part, mode, later, above + k.rides[0, c.RIDE_PICK], tried)
            if tried[c.ARM_TIME] < ends[later, c.ARM_TIME]:
                copy_arm(tried, ends[later])
            if tried[c.ARM_TIME] < first:
                first, met, idle = tried[c.ARM_TIME], above, waits
    return met, idle
