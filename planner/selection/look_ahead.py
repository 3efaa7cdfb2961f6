"""Compiled: dynamic programming over the orders of a few parts."""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel, types
from assur.planner.selection import columns as c
from assur.planner.selection.columns import F1, F2, TIMES, Times, f8, i8
from assur.planner.selection.cycles import copy_arm, cycle

MOST = 10
"""Parts that a look-ahead takes in at most: the work doubles with each."""
F4 = f8[:, :, :, ::1]
I3 = i8[:, :, ::1]


@kernel(types.void(TIMES, F1, F2, f8, F4, I3, F2, F1, F1))
def order_values(
    k: Times,
    arm: FloatArray,
    parts: FloatArray,
    price: float,
    arms: FloatArray,
    firsts: IntArray,
    ends: FloatArray,
    tried: FloatArray,
    values: FloatArray,
) -> None:
    """Fills `values` (N,) with what each part leads to if it is taken first: parts taken, less `price` (1/s) times the
    time that it takes.

    For each subset of the parts, each last part of it and each mode, the arm that is free first is kept (`arms`
    (2^N, N, E, ARM + P)), with the part that was taken first (`firsts`): no later arm can be better, because an arm can
    always wait. `ends` (E, ARM + P) and `tried` (ARM + P,) are overwritten. With a price near 0 the number of parts
    counts first, and then the time.
    """
    n, modes = len(parts), len(ends)
    arms[: 1 << n, :n, :, c.ARM_TIME] = math.inf
    values[:n] = -math.inf
    for i in range(n):
        cycle(k, arm, parts[i], ends, tried)
        for mode in range(modes):
            copy_arm(ends[mode], arms[1 << i, i, mode])
        firsts[1 << i, i] = i
    for subset in range(1, 1 << n):
        count = 0
        for i in range(n):
            count += subset >> i & 1
        for i in range(n):
            for mode in range(modes):
                free = arms[subset, i, mode]
                if free[c.ARM_TIME] == math.inf:
                    continue
                first = firsts[subset, i, mode]
                values[first] = max(values[first], count - price * (free[c.ARM_TIME] - arm[c.ARM_TIME]))
                for m in range(n):
                    if subset >> m & 1:
                        continue
                    cycle(k, free, parts[m], ends, tried)
                    larger = subset | 1 << m
                    for later in range(modes):
                        if ends[later, c.ARM_TIME] < arms[larger, m, later, c.ARM_TIME]:
                            copy_arm(ends[later], arms[larger, m, later])
                            firsts[larger, m, later] = first
