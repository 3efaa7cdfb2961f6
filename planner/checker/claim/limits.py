"""Whether the joints of the robot keep their limits between each two knots, by Bernstein coefficients.

A polynomial on an interval is between the least and the greatest of its Bernstein coefficients, and the first and the
last of them are its values at the ends. What they leave open is halved (de Casteljau).
"""

from __future__ import annotations

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.tables import F1, F2, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types

NO_LIMITS, KEPT = -2, -1
"""What `first_joint_beyond` returns in place of a joint."""


@kernel(types.boolean(F1, i8, f8, f8, F2, F1))
def bounded(control: FloatArray, degree: int, middle: float, most: float, stack: FloatArray, state: FloatArray) -> bool:
    """Whether a polynomial with these Bernstein coefficients stays within `most` of `middle`."""
    top = 1
    for m in range(degree + 1):
        stack[0, m] = control[m]
    stack[0, tb.POWERS] = 0.0
    while top > 0:
        top -= 1
        own, worst = stack[top], 0.0
        for m in range(degree + 1):
            off = abs(own[m] - middle)
            if not off <= worst:
                worst = off
        if worst <= most:
            continue
        depth = int(own[tb.POWERS])
        state[tb.WORK] -= 1.0
        if not (abs(own[0] - middle) <= most and abs(own[degree] - middle) <= most) or depth >= tb.DEEPEST:
            return False
        if not state[tb.WORK] > 0.0:
            return False
        other = stack[top + 1]
        for m in range(degree + 1):
            other[m] = own[m]
        for r in range(1, degree + 1):  # the left half remains in `own`, the right half in `other`
            for m in range(degree, r - 1, -1):
                own[m] = 0.5 * (own[m - 1] + own[m])
            for m in range(degree + 1 - r):
                other[m] = 0.5 * (other[m] + other[m + 1])
        own[tb.POWERS] = other[tb.POWERS] = depth + 1.0
        top += 2
    return True


@kernel(types.boolean(F1, F1, i8, F1, F1, F2, F1))
def joint_keeps_limits(
    one: FloatArray,
    other: FloatArray,
    j: int,
    limit: FloatArray,
    control: FloatArray,
    stack: FloatArray,
    state: FloatArray,
) -> bool:
    """Whether a joint keeps its limits between two knots. Coefficients of rates are those of the knots; what their sums
    may round by is taken off what is allowed (R5)."""
    h = other[0] - one[0]
    x, v, a = one[c.KNOT_Q + j], one[c.KNOT_QD + j], one[c.KNOT_QDD + j]
    y, w, b = other[c.KNOT_Q + j], other[c.KNOT_QD + j], other[c.KNOT_QDD + j]
    low, high = limit[c.LIMIT_LOWER + j], limit[c.LIMIT_UPPER + j]
    control[0], control[1], control[2] = x, x + h * v / 5.0, x + 0.4 * h * v + h * h * a / 20.0
    control[3], control[4], control[5] = y - 0.4 * h * w + h * h * b / 20.0, y - h * w / 5.0, y
    off = abs(x) + abs(y) + h * (abs(v) + abs(w)) + h * h * (abs(a) + abs(b)) + abs(low) + abs(high)
    most = 0.5 * (high - low) * (1.0 + limit[c.LIMIT_SHARE]) - 4.0 * tb.ULP * off
    if not bounded(control, 5, 0.5 * (low + high), most, stack, state):
        return False
    middle = 5.0 * (y - x) / h - 2.0 * (v + w) + 0.25 * h * (b - a)
    off = 4.0 * tb.ULP * (5.0 * abs(y - x) / h + 2.0 * (abs(v) + abs(w)) + 0.25 * h * (abs(a) + abs(b)))
    control[0], control[1], control[2], control[3], control[4] = v, v + 0.25 * h * a, middle, w - 0.25 * h * b, w
    most = limit[c.LIMIT_VELOCITY + j] * (1.0 + limit[c.LIMIT_SHARE + 1])
    if not bounded(control, 4, 0.0, most - off, stack, state):
        return False
    third, fourth = 4.0 * (middle - control[1]) / h, 4.0 * (control[3] - middle) / h
    off, most = 8.0 * off / h, limit[c.LIMIT_ACCELERATION + j] * (1.0 + limit[c.LIMIT_SHARE + 2])
    control[0], control[1], control[2], control[3] = a, third, fourth, b
    if not bounded(control, 3, 0.0, most - off, stack, state):
        return False
    if limit[c.LIMIT_JERKS] == 0.0:
        return True
    off, most = 8.0 * off / h, limit[c.LIMIT_JERK + j] * (1.0 + limit[c.LIMIT_SHARE + 3])
    control[0], control[1], control[2] = 3.0 * (third - a) / h, 3.0 * (fourth - third) / h, 3.0 * (b - fourth) / h
    return bounded(control, 2, 0.0, most - off, stack, state)


@kernel(i8(tb.CLAIM, F2, F1))
def first_joint_beyond(k: Claim, stack: FloatArray, state: FloatArray) -> int:
    """The first joint of the robot that does not keep its limits on some piece of its motion; KEPT; or NO_LIMITS, if no
    limits are for all of the motion. Where a failing piece begins is in the last place of `stack`."""
    knots, whole, control = int(k.arms[0, c.ARM_KNOTS]), False, stack[len(stack) - 1]
    for i in range(len(k.limits)):
        limit = k.limits[i]
        whole = whole or (limit[c.LIMIT_T0] <= k.knots[0, 0] and k.knots[knots - 1, 0] <= limit[c.LIMIT_T1])
        for m in range(knots - 1):
            one, other = k.knots[m], k.knots[m + 1]
            if other[0] > one[0] and other[0] > limit[c.LIMIT_T0] and one[0] < limit[c.LIMIT_T1]:
                state[tb.WORK] -= 1.0
                for j in range(int(k.arms[0, c.ARM_JOINTS]) if state[tb.WORK] > 0.0 else 0):
                    if not joint_keeps_limits(one, other, j, limit, control, stack, state):
                        control[tb.POWERS] = one[0]
                        return j
    return KEPT if whole else NO_LIMITS
