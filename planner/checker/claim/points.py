"""Where the tool is, how fast it moves, how hard it accelerates, where its axes point, and along which way it goes.

Between two times an error e leaves its chord by at most max |ë| h²/8 (N9). What that does not decide is halved. Jets of
this module hold the rounding of their carriers in their radii.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import point, slot_of, vector
from assur.planner.checker.claim.jets import Jet, constant, jet, minus, plus, product, put, times, widened
from assur.planner.checker.claim.motion import rounding
from assur.planner.checker.claim.solids import length
from assur.planner.checker.claim.tables import F1, F3, JET, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types


@kernel(JET(tb.GEOMETRY, F3, i8, i8, f8, f8, f8))
def place(g: tb.Geometry, jets: FloatArray, on: int, axis: int, x: float, y: float, z: float) -> Jet:
    """A coordinate in the world of a point (x, y, z) of a carrier, with its rounding."""
    reach = math.sqrt(x * x + y * y + z * z)
    off, rate, second = rounding(g, on, 0, reach), rounding(g, on, 1, reach), rounding(g, on, 2, reach)
    return widened(point(jets, on, axis, x, y, z), off, rate, second)


@kernel(JET(tb.GEOMETRY, F3, i8, i8, f8, f8, f8))
def direction(g: tb.Geometry, jets: FloatArray, on: int, axis: int, x: float, y: float, z: float) -> Jet:
    """A coordinate in the world of a vector (x, y, z) of a carrier, with its rounding."""
    size, own = math.sqrt(x * x + y * y + z * z), g.rounds[on]
    off, rate, second = own[tb.ROUND_TURN], own[2 + tb.ROUND_TURN], own[4 + tb.ROUND_TURN]
    return widened(vector(jets, on, axis, x, y, z), size * off, size * rate, size * second)


@kernel(JET(F3, i8, i8))
def dot(vectors: FloatArray, i: int, j: int) -> Jet:
    """The scalar product of two vectors of jets, with its rounding."""
    total, x, y, z = constant(0.0), 0.0, 0.0, 0.0
    for m in range(3):
        a, b = jet(vectors, i, m), jet(vectors, j, m)
        total = plus(total, times(a, b))
        p, q, r = abs(a[0]) + a[1], abs(a[2]) + a[3], abs(a[4]) + a[5]
        u, v, w = abs(b[0]) + b[1], abs(b[2]) + b[3], abs(b[4]) + b[5]
        x, y, z = x + p * u, y + p * v + q * u, z + p * w + 2.0 * q * v + r * u
    return widened(total, 16.0 * tb.ULP * x, 16.0 * tb.ULP * y, 16.0 * tb.ULP * z)


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
        u = minus(
            place(g, a, on, axis, tool[0], tool[1], tool[2]),
            place(g, b, target_on, axis, target[0], target[1], target[2]),
        )
        v = minus(direction(g, a, on, axis, ca, sa, 0.0), direction(g, b, target_on, axis, cb, sb, 0.0))
        if order == 0 and axis == 2 and own[c.POINT_HEIGHT] >= 0.0:
            u = minus(u, constant(own[c.POINT_MIDDLE]))
        if order == 0:
            result[axis], result[3 + axis] = abs(u[0]) + u[1], abs(v[0]) + v[1]
        elif order == 1:
            result[axis], result[3 + axis] = abs(u[2]) + u[3], abs(v[2]) + v[3]
        else:
            result[axis], result[3 + axis] = abs(u[4]) + u[5], abs(v[4]) + v[5]
    return True


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, F1))
def moves_with_point(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, result: FloatArray) -> bool:
    """Whether the rates of the tool are those of its point as the time of a point begins."""
    if max(own[c.POINT_RATE], own[c.POINT_RATE + 1]) < 0.0:
        return True
    if not relative(k, g, s, own, own[c.POINT_T0], own[c.POINT_T0], 1, result):
        return False
    if own[c.POINT_RATE] >= 0.0 and not length(result, 0, 3) + tb.SLACK <= own[c.POINT_RATE]:
        return False
    return bool(own[c.POINT_RATE + 1] < 0.0 or length(result, 3, 6) + tb.SLACK <= own[c.POINT_RATE + 1])


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8, F1))
def at_point(
    k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, t0: float, t1: float, result: FloatArray
) -> bool:
    """Whether the tool is at its point over [t0, t1] (N9)."""
    range_of_heights, h = own[c.POINT_HEIGHT] >= 0.0, t1 - t0
    across, bow, bow_up, bow_yaw = 2 if range_of_heights else 3, tb.SLACK, tb.SLACK, tb.SLACK
    if h > 0.0:
        if not relative(k, g, s, own, t0, t1, 2, result):
            return False
        bow, bow_yaw = bow + length(result, 0, across) * h * h / 8.0, bow_yaw + length(result, 3, 6) * h * h / 8.0
        bow_up += result[2] * h * h / 8.0
    for end in range(2 if h > 0.0 else 1):
        t = t0 if end == 0 else t1
        if not relative(k, g, s, own, t, t, 0, result):
            return False
        if not length(result, 0, across) + bow <= own[c.POINT_POSITION]:
            return False
        if range_of_heights and not result[2] + bow_up <= own[c.POINT_HEIGHT]:
            return False
        if own[c.POINT_YAW] >= 0.0 and not length(result, 3, 6) + bow_yaw <= own[c.POINT_YAW]:
            return False
    return True


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, i8, F1, i8, f8, f8))
def see(k: Claim, g: tb.Geometry, s: tb.Scratch, on: int, tool: FloatArray, f: int, t0: float, t1: float) -> bool:
    """Jets over [t0, t1] of a point of a link as frame f has it (-1: the world), in `s.vectors`. False: not known."""
    slot = slot_of(k, g, s, on, t0, t1)
    for axis in range(3 if slot >= 0 else 0):
        put(s.vectors, 0, axis, place(g, s.jets[slot], on, axis, tool[0], tool[1], tool[2]))
    if slot < 0 or f < 0:
        return slot >= 0
    frame_on = int(g.on[f, 0])
    slot = slot_of(k, g, s, frame_on, t0, t1)
    for axis in range(3 if slot >= 0 else 0):
        put(s.vectors, 1, axis, minus(jet(s.vectors, 0, axis), place(g, s.jets[slot], frame_on, axis, 0.0, 0.0, 0.0)))
    for axis in range(3 if slot >= 0 else 0):
        x, y, z = 1.0 if axis == 0 else 0.0, 1.0 if axis == 1 else 0.0, 1.0 if axis == 2 else 0.0
        for m in range(3):
            put(s.vectors, 2, m, direction(g, s.jets[slot], frame_on, m, x, y, z))
        put(s.vectors, 0, axis, dot(s.vectors, 1, 2))
    return slot >= 0


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8))
def rate_within(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, t0: float, t1: float) -> bool:
    """Whether a point of a link is no faster or slower (order 1), or accelerates no harder or less (order 2), than is
    claimed over [t0, t1]. The square of a speed w leaves the mean of both ends by at most max |w · dw/dt| h (N12)."""
    on, f, order, tool = int(own[c.RATE_LINK]), int(own[c.RATE_FRAME]), int(own[c.RATE_ORDER]), own[c.RATE_POINT :]
    ends, middle, radius = 2 if order == 1 and t1 > t0 else 1, 0.0, 0.0
    if ends == 2:
        if not see(k, g, s, on, tool, f, t0, t1):
            return False
        for axis in range(3):
            u = jet(s.vectors, 0, axis)
            slope = product((u[2], u[3]), (u[4], u[5]))
            middle, radius = middle + slope[0], radius + slope[1]
    bow, low, high = (abs(middle) + radius) * (t1 - t0), 0.0, 0.0
    for end in range(ends):
        a, b = (t0, t1) if ends == 1 else (t0, t0) if end == 0 else (t1, t1)
        if not see(k, g, s, on, tool, f, a, b):
            return False
        for axis in range(3):
            u = jet(s.vectors, 0, axis)
            size, off = (abs(u[2]), u[3]) if order == 1 else (abs(u[4]), u[5])
            low, high = low + max(size - off, 0.0) ** 2, high + (size + off) ** 2
    low, high = math.sqrt(max(low / ends - bow, 0.0)), math.sqrt(high / ends + bow)
    if not high * (1.0 + 64.0 * tb.ULP) + tb.SLACK <= own[c.RATE_MOST]:
        return False
    return bool(own[c.RATE_LEAST] == 0.0 or own[c.RATE_LEAST] <= low * (1.0 - 64.0 * tb.ULP) - tb.SLACK)


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8))
def axis_within(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, t0: float, t1: float) -> bool:
    """Whether the scalar product of an axis or a way and a direction is within its bounds over [t0, t1]."""
    on, other, x, y, h, bow = int(own[c.AXIS_LINK]), int(own[c.AXIS_OTHER]), c.AXIS_ON, c.AXIS_DIRECTION, t1 - t0, 0.0
    for end in range(3 if h > 0.0 else 1):
        a, b = (t0, t1) if end == 0 else (t0, t0) if end == 1 else (t1, t1)
        slot = slot_of(k, g, s, on, a, b)  # all links of the robot are in this slot
        if slot < 0:
            return False
        for m in range(3):
            if own[c.AXIS_PLACE] > 0.0:
                u = place(g, s.jets[slot], on, m, own[x], own[x + 1], own[x + 2])
                if other >= 0:
                    u = minus(u, place(g, s.jets[slot], other, m, 0.0, 0.0, 0.0))
            else:
                u = direction(g, s.jets[slot], on, m, own[x], own[x + 1], own[x + 2])
            v = constant(own[y + m])
            if other >= 0:
                v = direction(g, s.jets[slot], other, m, own[y], own[y + 1], own[y + 2])
            put(s.vectors, 0, m, u)
            put(s.vectors, 1, m, v)
        total = dot(s.vectors, 0, 1)
        if end == 0 and h > 0.0:
            bow = (abs(total[4]) + total[5]) * h * h / 8.0
        elif not (own[c.AXIS_LOW] <= total[0] - total[1] - bow and total[0] + total[1] + bow <= own[c.AXIS_HIGH]):
            return False
    return True


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8, F1))
def guided(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, t0: float, t1: float, result: FloatArray) -> bool:
    """Whether the tool is on its way from a point of one frame to a point of another over [t0, t1] (N9)."""
    lasts, on, one_on = own[c.GUIDE_T1] - own[c.GUIDE_T0], int(own[c.GUIDE_LINK]), int(g.on[int(own[c.GUIDE_FRAME]), 0])
    other_on, share, tool = int(g.on[int(own[c.GUIDE_FRAME + 1]), 0]), own[c.GUIDE_SHARE], own[c.GUIDE_TOOL :]
    one, other, rate, h, bow = own[c.GUIDE_FROM :], own[c.GUIDE_TO :], 0.0, t1 - t0, tb.SLACK
    if lasts > 0.0:
        rate = (own[c.GUIDE_SHARE + 1] - share) / lasts
    elif share != own[c.GUIDE_SHARE + 1]:
        return False
    for end in range(3 if h > 0.0 else 1):
        a, b = (t0, t1) if end == 0 else (t0, t0) if end == 1 else (t1, t1)
        p, q, r = slot_of(k, g, s, on, a, b), slot_of(k, g, s, one_on, a, b), slot_of(k, g, s, other_on, a, b)
        if p < 0 or q < 0 or r < 0:
            return False
        middle, radius = share + rate * (0.5 * (a + b) - own[c.GUIDE_T0]), 0.5 * abs(rate) * (b - a) + 8.0 * tb.ULP
        for axis in range(3):
            start = place(g, s.jets[q], one_on, axis, one[0], one[1], one[2])
            way = minus(place(g, s.jets[r], other_on, axis, other[0], other[1], other[2]), start)
            way = times((middle, radius, rate, 0.0, 0.0, 0.0), way)
            u = minus(minus(place(g, s.jets[p], on, axis, tool[0], tool[1], tool[2]), start), way)
            result[axis] = abs(u[4]) + u[5] if end == 0 and h > 0.0 else abs(u[0]) + u[1]
        if end == 0 and h > 0.0:
            bow += length(result, 0, 3) * h * h / 8.0
        elif not length(result, 0, 3) + bow <= own[c.GUIDE_MOST]:
            return False
    return True
