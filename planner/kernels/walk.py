"""One loop over halved intervals, depth first, for three questions about all pairs of a phase.

`PROVE`: do they stay apart at every instant? Every pair that is proved on an interval writes a row; the first that
resists ends the search. `SCREEN`: the same, and an instant at which pairs are too near ends the search: all of them
are told. `NEAREST`: what is the smallest distance? The state of a search is in arrays of
the caller (`assur.planner.kernels.intervals`).
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.carriers import carrier_bounds
from assur.planner.kernels.intervals import (
    DONE,
    FINEST_S,
    FOUND,
    HIT,
    ITEMS_FULL,
    RESERVE_M,
    RESISTED,
    ROWS_FULL,
    TOP,
    WORK_SPENT,
    Cell,
    Motion,
    fetch,
    move_items,
    open_box,
    push,
    survey,
)
from assur.planner.kernels.links import BOUND_COLUMNS, POSE_COLUMNS
from assur.planner.kernels.nearest import bounded
from assur.planner.kernels.proof import (
    ALONG,
    OPEN,
    OTHER,
    PROVED,
    RESISTED_A,
    RESISTED_B,
    RESISTED_GAP,
    RESISTED_NEED,
    RESISTED_T,
    T0,
    T1,
    TOO_NEAR,
    UNIT,
    settle,
)
from assur.planner.kernels.screening import HITS, note_hit
from assur.planner.kernels.solids import CELL, MOTION, ROW, TABLE

PROVE, SCREEN, NEAREST = range(3)
"""What a search is for."""


@kernel(
    f"int64(int64, {MOTION}, {CELL}, {TABLE}, float64, float64, {TABLE}, {TABLE}, {ROW}, {TABLE}, {TABLE}, int64)",
    allocates=True,
)
def walk(
    task: int,
    motion: Motion,
    cell: Cell,
    pairs: FloatArray,
    since: float,
    latest: float,
    items: FloatArray,
    stack: FloatArray,
    state: FloatArray,
    rows: FloatArray,
    hits: FloatArray,
    budget: int,
) -> int:
    """Goes on with a search until it is done, pairs are too near, one resists, or rows, items or work run out.

    `since`: the time from which a growth counts; `latest`: by how much the robot may start late at most, s. `rows` take
    what is proved, `hits` what is too near. `budget`: after how many items no interval is begun. If rows, items or work
    run out, the state is such that the call can be repeated with more room.
    """
    robot, laws, side, _, c, _, matrix = motion
    bodies, vertices, still = cell
    many, n, m = len(still), c.shape[1], len(matrix)
    carriers, placed = np.empty((3, many, POSE_COLUMNS)), np.empty((3, len(bodies), POSE_COLUMNS))
    bounds, late_bounds = np.zeros((many, BOUND_COLUMNS)), np.zeros((many, BOUND_COLUMNS))
    stamp, q, swept = np.zeros(len(bodies), dtype=np.int64), np.empty(n), np.empty((4, max(n, m)))
    points, work, found = np.empty((4, 3)), np.empty((3, 4)), np.empty(2)
    number = 0
    while state[TOP] > 0.0:
        top = int(state[TOP]) - 1
        if top + 2 > len(stack):
            return ITEMS_FULL
        # between intervals only: items that were looked over in one would be looked over again
        if budget <= 0:
            return WORK_SPENT
        t0, t1, first, count = stack[top, 0], stack[top, 1], int(stack[top, 2]), int(stack[top, 3])
        middle = 0.5 * (t0 + t1)
        state[TOP] = top
        number += 1
        survey(motion, t0, t1, q, swept, carriers, bounds)
        if latest > 0.0 and task != NEAREST:
            lower, upper, rate, rate_d = swept[0, :n], swept[1, :n], swept[2, :m], swept[3, :m]
            carrier_bounds(robot, laws, side, t0, t1 + latest, lower, upper, rate, rate_d, late_bounds)
        end, left, i, free, h = first + count, 0, first, state[HITS] == 0.0, t1 - t0
        while i < end:
            r, status = int(state[FOUND]), DONE
            proving = task == PROVE or (task == SCREEN and free)
            if proving and r >= len(rows):
                status = ROWS_FULL
            else:
                budget -= 1
                a, b = int(items[i, 0]), int(items[i, 1])
                fetch(bodies, a, carriers, placed, stamp, number, still)
                fetch(bodies, b, carriers, placed, stamp, number, still)
                if task == NEAREST:
                    verdict = bounded(bodies, vertices, placed, bounds, t0, t1, items, i, points, work, state)
                else:
                    verdict = settle(
                        bodies, vertices, placed, bounds, late_bounds, pairs, since, t0, t1, items, i, points, work,
                        found,
                    )  # fmt: skip
                if verdict == PROVED:
                    # an instant is no interval
                    if proving and h > 0.0:
                        rows[r, T0], rows[r, T1], rows[r, UNIT], rows[r, OTHER] = t0, t1, a, b
                        for k in range(3):
                            rows[r, ALONG + k] = items[i, 3 + k]
                        state[FOUND] = r + 1
                elif verdict == OPEN:
                    opened = open_box(bodies, items, i, end)
                    if opened < 0:
                        status = ITEMS_FULL
                    else:
                        end = opened
                else:
                    # of what is not known, or within the reserve, a proof says so
                    hit = verdict == TOO_NEAR and task == SCREEN and found[0] <= found[1] - RESERVE_M
                    if proving and not hit and (verdict == TOO_NEAR or (h > 0.0 and not h > FINEST_S)):
                        state[RESISTED_A], state[RESISTED_B], state[RESISTED_T] = a, b, middle
                        state[RESISTED_GAP], state[RESISTED_NEED] = found[0], found[1] - RESERVE_M
                        return RESISTED
                    if hit:
                        free = False
                        note_hit(hits, state, items, i, middle, found)
                    if h > 0.0 and (proving or task == NEAREST):
                        move_items(items, i, first + left, 1)
                        left += 1
            if status != DONE:
                move_items(items, i, first + left, end - i)
                push(stack, state, t0, t1, first, left + end - i)
                return status
            i += 1
        if not free:
            return HIT
        if left > 0:
            if first + 2 * left > len(items):
                push(stack, state, t0, t1, first, left)
                return ITEMS_FULL
            move_items(items, first, first + left, left)
            push(stack, state, middle, t1, first, left)
            push(stack, state, t0, middle, first + left, left)
    return DONE
