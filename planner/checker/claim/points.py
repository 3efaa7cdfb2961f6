"""Where the tool is, how fast it moves against its point, how hard it accelerates, and where its axes point.

Between two times an error e leaves its chord by at most max |ë| h²/8 (N9). What that does not decide is halved.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import point, slot_of
from assur.planner.checker.claim.jets import constant, jet, minus, plus, scaled
from assur.planner.checker.claim.motion import rounding
from assur.planner.checker.claim.solids import length
from assur.planner.checker.claim.tables import F1, F2, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types

POINTS, RATES, AXES = range(3)
"""Tables of claims about the tool: `points`, `rates`, `axes`."""


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8, i8, F1))
def relative(
    k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, t0: float, t1: float, order: int, result: FloatArray
) -> bool:
    """The tool point as its control point has it, and the difference of both x axes: bounds over [t0, t1] of the sizes
    of six coordinates, of their derivatives of that order. False: not known."""
    on, target_on = int(own[c.POINT_LINK]), int(g.on[int(own[c.POINT_FRAME]), 0])
    one, other = slot_of(k, g, s, on, t0, t1), slot_of(k, g, s, target_on, t0, t1)
    if one < 0 or other < 0:
        return False
    a, b, tool, target = s.jets[one], s.jets[other], own[c.POINT_TOOL :], own[c.POINT_TARGET :]
    ca, sa, cb, sb = math.cos(tool[3]), math.sin(tool[3]), math.cos(target[3]), math.sin(target[3])
    for axis in range(3):
        u = point(a, on, axis, tool[0], tool[1], tool[2])
        u = minus(u, point(b, target_on, axis, target[0], target[1], target[2]))
        v = plus(scaled(ca, jet(a, on, 3 + axis)), scaled(sa, jet(a, on, 6 + axis)))
        v = minus(v, plus(scaled(cb, jet(b, target_on, 3 + axis)), scaled(sb, jet(b, target_on, 6 + axis))))
        if order == 0 and axis == 2 and own[c.POINT_HEIGHT] >= 0.0:
            u = minus(u, constant(own[c.POINT_MIDDLE]))
        if order == 0:
            result[axis], result[3 + axis] = abs(u[0]) + u[1], abs(v[0]) + v[1]
        elif order == 1:
            result[axis], result[3 + axis] = abs(u[2]) + u[3], abs(v[2]) + v[3]
        else:
            result[axis], result[3 + axis] = abs(u[4]) + u[5], abs(v[4]) + v[5]
    return True


@kernel(f8(tb.GEOMETRY, F1, i8))
def point_rounding(g: tb.Geometry, own: FloatArray, order: int) -> float:
    """By how much the numbers of `relative` round, of that order, and the slack."""
    on, target_on = int(own[c.POINT_LINK]), int(g.on[int(own[c.POINT_FRAME]), 0])
    reach = length(own, c.POINT_TOOL, c.POINT_TOOL + 3)
    other = length(own, c.POINT_TARGET, c.POINT_TARGET + 3)
    return float(tb.SLACK + rounding(g, on, order, 1.0 + reach) + rounding(g, target_on, order, 1.0 + other))


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8, F1))
def at_point(
    k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, t0: float, t1: float, result: FloatArray
) -> bool:
    """Whether the tool is at its point over [t0, t1] (N9)."""
    range_of_heights, h, off = own[c.POINT_HEIGHT] >= 0.0, t1 - t0, point_rounding(g, own, 0)
    across, bow, bow_up, bow_yaw = 2 if range_of_heights else 3, 0.0, 0.0, 0.0
    if h > 0.0:
        if not relative(k, g, s, own, t0, t1, 2, result):
            return False
        off += point_rounding(g, own, 2) * h * h / 8.0
        bow, bow_yaw = length(result, 0, across) * h * h / 8.0, length(result, 3, 6) * h * h / 8.0
        bow_up = result[2] * h * h / 8.0
    for end in range(2 if h > 0.0 else 1):
        t = t0 if end == 0 else t1
        if not relative(k, g, s, own, t, t, 0, result):
            return False
        if not length(result, 0, across) + bow + off <= own[c.POINT_POSITION]:
            return False
        if range_of_heights and not result[2] + bow_up + off <= own[c.POINT_HEIGHT]:
            return False
        if own[c.POINT_YAW] >= 0.0 and not length(result, 3, 6) + bow_yaw + off <= own[c.POINT_YAW]:
            return False
    return True


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8, F1))
def rate_within(
    k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, t0: float, t1: float, result: FloatArray
) -> bool:
    """Whether a point of a link accelerates no harder than is claimed over [t0, t1]."""
    on, tool = int(own[c.RATE_LINK]), own[c.RATE_POINT :]
    slot = slot_of(k, g, s, on, t0, t1)
    if slot < 0:
        return False
    for axis in range(3):
        u = point(s.jets[slot], on, axis, tool[0], tool[1], tool[2])
        result[axis] = abs(u[4]) + u[5]
    off = tb.SLACK + rounding(g, on, 2, 1.0 + length(own, c.RATE_POINT, c.RATE_POINT + 3))
    return bool(length(result, 0, 3) * (1.0 + 64.0 * tb.ULP) + off <= own[c.RATE_MOST])


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8))
def axis_within(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, t0: float, t1: float) -> bool:
    """Whether the scalar product of an axis and a direction is within its bounds over [t0, t1]."""
    on, axis, direction, h = int(own[c.AXIS_LINK]), own[c.AXIS_ON :], own[c.AXIS_DIRECTION :], t1 - t0
    size = 3.0 * (abs(direction[0]) + abs(direction[1]) + abs(direction[2])) * length(axis, 0, 3)
    bow = size * (rounding(g, on, 0, 1.0) + 16.0 * tb.ULP + rounding(g, on, 2, 1.0) * h * h / 8.0)
    for end in range(3 if h > 0.0 else 1):
        a, b = (t0, t1) if end == 0 else (t0, t0) if end == 1 else (t1, t1)
        slot = slot_of(k, g, s, on, a, b)
        if slot < 0:
            return False
        total = constant(0.0)
        for m in range(3):
            for i in range(3):
                total = plus(total, scaled(axis[m] * direction[i], jet(s.jets[slot], on, 3 + 3 * m + i)))
        if end == 0 and h > 0.0:
            bow += (abs(total[4]) + total[5]) * h * h / 8.0
        elif not (own[c.AXIS_LOW] <= total[0] - bow and total[0] + bow <= own[c.AXIS_HIGH]):
            return False
    return True


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, i8, F1, F2, F1))
def tool_claim_holds(
    k: Claim, g: tb.Geometry, s: tb.Scratch, kind: int, own: FloatArray, stack: FloatArray, state: FloatArray
) -> bool:
    """Whether a claim about the tool (POINTS, RATES or AXES) is shown for its time, or for all parts of it; of a
    point, its rates as that time begins. `stack`:
    room for intervals, the last row for numbers."""
    result, top = stack[len(stack) - 1], 1
    stack[0, 0], stack[0, 1], stack[0, 2] = own[0], own[1], 0.0
    if kind == POINTS and max(own[c.POINT_RATE], own[c.POINT_RATE + 1]) >= 0.0:
        off = point_rounding(g, own, 1)
        if not relative(k, g, s, own, own[c.POINT_T0], own[c.POINT_T0], 1, result):
            return False
        if own[c.POINT_RATE] >= 0.0 and not length(result, 0, 3) + off <= own[c.POINT_RATE]:
            return False
        if own[c.POINT_RATE + 1] >= 0.0 and not length(result, 3, 6) + off <= own[c.POINT_RATE + 1]:
            return False
    while top > 0:
        top -= 1
        t0, t1, depth = stack[top, 0], stack[top, 1], stack[top, 2]
        state[tb.WORK] -= 1.0
        if kind == POINTS:
            shown = at_point(k, g, s, own, t0, t1, result)
        elif kind == RATES:
            shown = rate_within(k, g, s, own, t0, t1, result)
        else:
            shown = axis_within(k, g, s, own, t0, t1)
        if shown:
            continue
        if depth >= tb.DEEPEST or t0 == t1 or not state[tb.WORK] > 0.1 * s.work[tb.TOUCHED]:
            return False
        for half in range(2):
            stack[top, 0], stack[top, 1] = (0.5 * (t0 + t1), t1) if half == 0 else (t0, 0.5 * (t0 + t1))
            stack[top, 2], top = depth + 1.0, top + 1
    return True
