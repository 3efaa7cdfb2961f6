"""Whether the joints of the robot keep their limits, and sums of joints their bounds, by Bernstein coefficients.

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

PART_ROUNDS = 12.0
"""By how many rounding units of the largest coefficient those on a part of a piece round more, for each degree."""
NO_LIMITS, KEPT = -2, -1
"""What `first_joint_beyond` returns in place of a joint."""


@kernel(types.boolean(i8, f8, f8, F2, F1))
def polynomial_bounded(degree: int, low: float, high: float, stack: FloatArray, state: FloatArray) -> bool:
    """Whether a polynomial stays between two numbers. Its Bernstein coefficients are in the first row of `stack`."""
    top, stack[0, tb.POWERS] = 1, 0.0
    while top > 0:
        top -= 1
        own, within = stack[top], True
        for m in range(degree + 1):
            within = within and low <= own[m] <= high
        if within:
            continue
        depth = int(own[tb.POWERS])
        state[tb.WORK] -= 1.0
        if not (low <= own[0] <= high and low <= own[degree] <= high) or depth >= tb.DEEPEST:
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


@kernel(types.void(F1, F1, i8, f8, F1, F1))
def add_joint(one: FloatArray, other: FloatArray, j: int, share: float, ends: FloatArray, sizes: FloatArray) -> None:
    """Adds a share of a joint to the numbers at the ends of a piece, and to the sums of their sizes: position, velocity
    and acceleration at the first knot, then at the second, then how far both positions are apart."""
    for m in range(7):
        at = c.KNOT_Q + j + c.MOST_JOINTS * (m % 3)
        value = share * (one[at] if m < 3 else other[at] if m < 6 else other[at] - one[at])
        ends[m], sizes[m] = ends[m] + value, sizes[m] + abs(value)


@kernel(f8(f8, F1, F1, i8, F1))
def write_control(h: float, ends: FloatArray, sizes: FloatArray, order: int, control: FloatArray) -> float:
    """Writes the Bernstein coefficients of a quintic that lasts h, or of its derivative of that order, from its ends.
    Returns what they may round by (R5). Coefficients of rates begin and end with those of the knots."""
    x, v, a, y, w, b = ends[0], ends[1], ends[2], ends[3], ends[4], ends[5]
    if order == 0:
        control[0], control[1], control[2] = x, x + h * v / 5.0, x + 0.4 * h * v + h * h * a / 20.0
        control[3], control[4], control[5] = y - 0.4 * h * w + h * h * b / 20.0, y - h * w / 5.0, y
        off = sizes[0] + sizes[3] + h * (sizes[1] + sizes[4]) + h * h * (sizes[2] + sizes[5])
        return float(4.0 * tb.ULP * off)
    second, middle, fourth = v + 0.25 * h * a, 5.0 * ends[6] / h - 2.0 * (v + w) + 0.25 * h * (b - a), w - 0.25 * h * b
    off = 5.0 * sizes[6] / h + 2.0 * (sizes[1] + sizes[4]) + 0.25 * h * (sizes[2] + sizes[5])
    off *= 4.0 * tb.ULP * (1.0 if order == 1 else 8.0 / h if order == 2 else 64.0 / (h * h))
    if order == 1:
        control[0], control[1], control[2], control[3], control[4] = v, second, middle, fourth, w
        return float(off)
    left, right = 4.0 * (middle - second) / h, 4.0 * (fourth - middle) / h
    if order == 2:
        control[0], control[1], control[2], control[3] = a, left, right, b
    else:
        control[0], control[1], control[2] = 3.0 * (left - a) / h, 3.0 * (right - left) / h, 3.0 * (b - right) / h
    return float(off)


@kernel(f8(F1, i8, f8, f8))
def cut_bernstein(control: FloatArray, degree: int, low: float, high: float) -> float:
    """Makes Bernstein coefficients on [0, 1] those on [low, high] (de Casteljau). Returns the largest size before."""
    largest = 0.0
    for m in range(degree + 1):
        largest = max(largest, abs(control[m]))
    for r in range(1, degree + 1):
        for m in range(degree, r - 1, -1):
            control[m] = (1.0 - high) * control[m - 1] + high * control[m]
    share = low / high if high > 0.0 else 0.0
    for r in range(1, degree + 1):
        for m in range(degree + 1 - r):
            control[m] = (1.0 - share) * control[m] + share * control[m + 1]
    return largest


@kernel(types.boolean(tb.CLAIM, F1, f8, F2, F1))
def sum_within(k: Claim, own: FloatArray, more: float, stack: FloatArray, state: FloatArray) -> bool:
    """Whether a sum of joints of the robot, or a derivative of it, is within its bounds for its time. At an instant the
    piece that begins there counts, at the end of the motion the last one. What coefficients may round by is taken off.

    `more`: by how much it may exceed its bounds; if that is not negative, pieces count as a whole. Where a failing
    piece begins is in the last place of `stack`."""
    knots, order, t0, t1 = int(k.arms[0, c.ARM_KNOTS]), int(own[c.SUM_ORDER]), own[c.SUM_T0], own[c.SUM_T1]
    control, ends, sizes = stack[0], stack[len(stack) - 2], stack[len(stack) - 3]
    low, high, last = own[c.SUM_LOW], own[c.SUM_HIGH], k.knots[knots - 1, 0]
    state[tb.WORK] -= 0.01 * knots
    if not (k.knots[0, 0] <= t0 and t1 <= last and state[tb.WORK] > 0.0):
        return False
    for m in range(knots - 1):
        one, other = k.knots[m], k.knots[m + 1]
        h, begin, end = other[0] - one[0], one[0], other[0]
        counts = (begin <= t0 and (t0 < end or end == last)) if t0 == t1 else (begin < t1 and t0 < end)
        if not (h > 0.0 and counts):
            continue
        state[tb.WORK] -= 0.2
        ends[:7], sizes[:7] = 0.0, 0.0
        for j in range(int(k.arms[0, c.ARM_JOINTS])):
            if own[c.SUM_SHARE + j] != 0.0:
                add_joint(one, other, j, own[c.SUM_SHARE + j], ends, sizes)
        off = write_control(h, ends, sizes, order, control)
        if more < 0.0 and (t0 > begin or t1 < end):
            until = 1.0 if t1 >= end else (t1 - begin) / h
            largest = cut_bernstein(control, 5 - order, (max(t0, begin) - begin) / h, until)
            off += PART_ROUNDS * (5 - order) * tb.ULP * (largest + off) if t1 > begin else 0.0
        off -= max(more, 0.0)
        least, most = low + off + 4.0 * tb.ULP * abs(low), high - off - 4.0 * tb.ULP * abs(high)
        if not polynomial_bounded(5 - order, least, most, stack, state):
            stack[len(stack) - 1, tb.POWERS] = begin
            return False
    return True


@kernel(i8(tb.CLAIM, F2, F1))
def first_joint_beyond(k: Claim, stack: FloatArray, state: FloatArray) -> int:
    """The first joint of the robot that does not keep its limits on some piece of its motion; KEPT; or NO_LIMITS, if no
    limits are for all of the motion. Where a failing piece begins is in the last place of `stack`."""
    begin, end, whole = k.knots[0, 0], k.knots[int(k.arms[0, c.ARM_KNOTS]) - 1, 0], False
    own = stack[len(stack) - 4]
    for i in range(len(k.limits)):
        limit = k.limits[i]
        whole = whole or (limit[c.LIMIT_T0] <= begin and end <= limit[c.LIMIT_T1])
        own[c.SUM_T0], own[c.SUM_T1] = max(limit[c.LIMIT_T0], begin), min(limit[c.LIMIT_T1], end)
        lasts = min(limit[c.LIMIT_T1] - limit[c.LIMIT_T0], own[c.SUM_T1] - own[c.SUM_T0])
        if lasts < 0.0 or (lasts == 0.0 and limit[c.LIMIT_T0] < limit[c.LIMIT_T1]):
            continue  # another time than that of the motion
        for j in range(int(k.arms[0, c.ARM_JOINTS])):
            own[c.SUM_SHARE : c.SUM_LOW] = 0.0
            own[c.SUM_SHARE + j] = 1.0
            for order in range(4 if limit[c.LIMIT_JERKS] > 0.0 else 3):
                high = limit[c.LIMIT_UPPER + j + c.MOST_JOINTS * order]
                low = -high if order > 0 else limit[c.LIMIT_LOWER + j]
                own[c.SUM_ORDER], own[c.SUM_LOW], own[c.SUM_HIGH] = order, low, high
                more = 0.5 * (high - low) * limit[c.LIMIT_SHARE + order]
                if not sum_within(k, own, more, stack, state):
                    return j
    return KEPT if whole else NO_LIMITS
