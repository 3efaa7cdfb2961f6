"""One loop over halved intervals, depth first, for three questions about all pairs of a phase.

`PROVE`: do they stay apart at every instant? Every pair that is proved on an interval writes a row; the first that
resists ends the search. `SCREEN`: the same, and an instant at which pairs are too near ends the search: all of them
are reported. `NEAREST`: what is the smallest distance? The state of a search is in arrays of the caller
(`assur.planner.kernels.intervals`).
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.intervals import (
    DONE,
    FINEST_S,
    FOUND,
    HIT,
    ITEM_FROM,
    ITEM_TO,
    ITEMS_FULL,
    MOTION,
    RESERVE_M,
    RESISTED,
    ROWS_FULL,
    TOP,
    WORK_SPENT,
    Cell,
    Motion,
    evaluate_motion,
    halve_shift,
    move_items,
    open_box,
    place_unit,
    places_for,
    push,
    room_for,
)
from assur.planner.kernels.jets import JET_COLUMNS, JETS
from assur.planner.kernels.links import POSE_COLUMNS
from assur.planner.kernels.proof import (
    ALONG,
    FROM,
    HALVE_SHIFT,
    OPEN,
    OTHER,
    PROVED,
    RESISTED_A,
    RESISTED_B,
    RESISTED_GAP,
    RESISTED_NEED,
    RESISTED_S,
    RESISTED_T,
    T0,
    T1,
    TO,
    TOO_NEAR,
    UNIT,
    decide_pair,
)
from assur.planner.kernels.screening import HITS, bounded, note_hit
from assur.planner.kernels.solids import CELL, EARLY, LATE, ROW, TABLE
from assur.planner.kernels.uncertainty import (
    ERRORS,
    MOMENTS,
    OFFSET_COLUMNS,
    Errors,
    displace_links,
    growing_for,
    place_shifted,
)

PROVE, SCREEN, NEAREST = range(3)
"""What a search is for."""


@kernel(
    f"int64(int64, {MOTION}, {CELL}, {TABLE}, {ERRORS}, {TABLE}, {TABLE}, {ROW}, {TABLE}, {TABLE}, int64)",
    allocates=True,
)
def search_intervals(
    task: int,
    motion: Motion,
    cell: Cell,
    pairs: FloatArray,
    errors: Errors,
    items: FloatArray,
    stack: FloatArray,
    state: FloatArray,
    rows: FloatArray,
    hits: FloatArray,
    budget: int,
) -> int:
    """Goes on with a search until it is done, pairs are too near, one resists, or rows, items or work run out.

    `errors`: how far things may be from the plan. `rows` take what is proved, `hits` what is too near. `budget`: after
    how many items no interval is begun. If rows, items or work run out, the state is such that the call can be repeated
    with more room.
    """
    (carried, _), (bodies, _, still) = motion, cell
    many = len(still)
    (carriers, units), room = places_for(cell, 3), room_for(motion)
    jets, offsets, steady = np.zeros((many, JETS, JET_COLUMNS)), np.zeros((many, OFFSET_COLUMNS)), np.zeros((0, 1))
    ahead = 0
    for p in range(len(pairs)):
        ahead = len(bodies) if pairs[p, EARLY] != 0.0 or pairs[p, LATE] != 0.0 else ahead
    shifted = (
        np.empty((MOMENTS, many if ahead > 0 else 0, POSE_COLUMNS)), np.empty((MOMENTS, ahead, POSE_COLUMNS)),
        np.zeros((many if ahead > 0 else 0, JETS, JET_COLUMNS)), np.full((many, 3), np.nan),
    )  # fmt: skip
    span, stamp = np.empty(4), np.zeros(len(bodies), dtype=np.int64)
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
        evaluate_motion(motion, t0, t1, room, carriers, jets)
        lasts, is_offset = growing_for(errors[2], t1), False
        if task != NEAREST:
            is_offset = displace_links(carried[0], room, errors, t1, offsets)
        end, left, i, free, h = first + count, 0, first, state[HITS] == 0.0, t1 - t0
        while i < end:
            r, status = int(state[FOUND]), DONE
            proving = task == PROVE or (task == SCREEN and free)
            if proving and r >= len(rows):
                status = ROWS_FULL
            else:
                budget -= 1
                a, b = int(items[i, 0]), int(items[i, 1])
                place_unit(units, a, carriers, stamp, number, still)
                place_unit(units, b, carriers, stamp, number, still)
                if task == NEAREST:
                    verdict = bounded(units, jets, t0, t1, items, i, points, work, state)
                else:
                    if items[i, ITEM_FROM] != 0.0 or items[i, ITEM_TO] != 0.0:
                        span[0], span[1], span[2], span[3] = t0, t1, items[i, ITEM_FROM], items[i, ITEM_TO]
                        place_shifted(carried, units, number, a, b, span, shifted)
                    verdict = decide_pair(
                        units, jets, shifted, pairs, errors[0], offsets if is_offset else steady, lasts, h, items, i,
                        points, work, found,
                    )  # fmt: skip
                if verdict == PROVED:
                    # an instant is no interval
                    if proving and h > 0.0:
                        rows[r, T0], rows[r, T1], rows[r, UNIT], rows[r, OTHER] = t0, t1, a, b
                        for k in range(3):
                            rows[r, ALONG + k] = items[i, 3 + k]
                        rows[r, FROM], rows[r, TO] = items[i, ITEM_FROM], items[i, ITEM_TO]
                        state[FOUND] = r + 1
                elif verdict == OPEN:
                    opened = open_box(bodies, items, i, end)
                    if opened < 0:
                        status = ITEMS_FULL
                    else:
                        end = opened
                elif verdict == HALVE_SHIFT:
                    if halve_shift(items, i, end):
                        end += 1
                        continue
                    status = ITEMS_FULL
                else:
                    # where the gap is unknown, or within the reserve, a proof reports it
                    hit = verdict == TOO_NEAR and task == SCREEN and found[0] <= found[1] - RESERVE_M
                    if proving and not hit and (verdict == TOO_NEAR or (h > 0.0 and not h > FINEST_S)):
                        state[RESISTED_A], state[RESISTED_B], state[RESISTED_T] = a, b, middle
                        state[RESISTED_GAP], state[RESISTED_NEED] = found[0], found[1] - RESERVE_M
                        state[RESISTED_S] = 0.5 * (items[i, ITEM_FROM] + items[i, ITEM_TO])
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
