"""What is claimed of the tool, row by row: shown for the time of the row, or for all parts of it."""

from __future__ import annotations

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.distances import is_near
from assur.planner.checker.claim.errors import error_within
from assur.planner.checker.claim.limits import sum_within
from assur.planner.checker.claim.motion import piece_at
from assur.planner.checker.claim.points import (
    CORRECTED,
    DISTANCES,
    ERRORS,
    POINTS,
    RATES,
    SUMS,
    is_near_chord,
    moves_with_point,
    rate_within,
)
from assur.planner.checker.claim.tables import F1, F2, f8, i8
from assur.planner.checker.claim.uncertainty import corrected_within
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types


@kernel(f8(tb.GEOMETRY, f8, f8))
def middle(g: tb.Geometry, t0: float, t1: float) -> float:
    """Where an interval is divided: where two pieces of the robot's motion meet, if that is once, for there its
    acceleration may jump; else in its middle."""
    first = int(g.spans[0, 0])
    last = first + int(g.spans[0, 1]) - 1
    i = piece_at(g.curves, first, last, t0)
    if i < last and t0 < g.curves[i, 1] < t1 <= g.curves[i + 1, 1]:
        return float(g.curves[i, 1])
    return 0.5 * (t0 + t1)


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, i8, i8, F1, F2, F1))
def claim_holds(
    k: Claim, g: tb.Geometry, s: tb.Scratch, kind: int, row: int, own: FloatArray, stack: FloatArray, state: FloatArray
) -> bool:
    """Whether a row of one of the tables above is shown. `stack`: room for intervals, the last rows for numbers."""
    result, top = stack[len(stack) - 1], 1
    stack[0, 0], stack[0, 1], stack[0, 2] = own[0], own[1], 0.0
    if kind == SUMS:
        return sum_within(k, own, -1.0, stack, state)
    if kind == DISTANCES:
        state[tb.WORK] -= 1.0
        return is_near(k, g, s, own, stack)
    if kind == ERRORS:
        return error_within(k, g, s, own, state)
    if kind == POINTS and not moves_with_point(k, g, s, own, result):
        return False
    while top > 0:
        top -= 1
        t0, t1, depth, shown = stack[top, 0], stack[top, 1], stack[top, 2], False
        state[tb.WORK] -= 1.0
        if kind == RATES:
            shown = rate_within(k, g, s, own, t0, t1)
        elif kind == CORRECTED:
            shown = own[c.PHASE_ROBOT] == 0.0 or corrected_within(k, g, s, row, t0, t1)
        else:
            shown = is_near_chord(k, g, s, kind, own, t0, t1, result, state)
        if shown:
            continue
        if depth >= tb.DEEPEST or t0 == t1 or not state[tb.WORK] > 0.1 * s.work[tb.TOUCHED]:
            return False
        t = middle(g, t0, t1)
        for half in range(2):
            stack[top, 0], stack[top, 1] = (t, t1) if half == 0 else (t0, t)
            stack[top, 2], top = depth + 1.0, top + 1
    return True
