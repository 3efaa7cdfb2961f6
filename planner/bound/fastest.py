"""How far one joint can go in a given time, and how soon it can be somewhere (equation D1 of docs/guarantees.md).

A state is (position, velocity, acceleration); limits are those of velocity V, acceleration A and jerk J. For a fixed
time T and fixed velocities and accelerations at both ends, the positions that can be reached are an interval, because
all limits are convex. Its ends are reached by a motion that accelerates to one peak velocity, keeps it if that is V,
and slows down. The peak is found by halving, and the end of the bracket that goes farther is taken.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.meetings import rest_to_rest_time

F1, F2, F3 = "float64[::1]", "float64[:, ::1]", "float64[:, :, ::1]"
"""Types of arrays in signatures."""
ROUNDING = 1e-10
"""rad or m. A position that is no farther beyond what can be reached counts as reached: rounding of kinematics is
1e-14, and of a joint beside a singularity 1e-12."""
ROUNDING_S = 1e-11
"""s. So much less time than is needed counts as enough: a joint at 10 rad/s goes as far as `ROUNDING` in it."""
HALVINGS = 40
"""Of a bracket of velocities or times, which is then a billionth of a thousandth of what it was. The end of it that is
worse for the bound is taken."""
EXACT, FREE = 0.0, 1.0
"""What is known of a state: all of it, or the position alone."""
PAIR = "UniTuple(float64, 2)"
KINDS = 3
"""Row of a state behind position, velocity and acceleration: EXACT or FREE."""
STATE = 4
"""Rows of a state."""


@kernel(f"{PAIR}(float64, float64, float64, float64, float64)")
def risen(v: float, a: float, peak: float, most_a: float, most_j: float) -> tuple[float, float]:
    """Duration and way of the quickest change from (v, a) to velocity `peak` and no acceleration, for a peak that is
    at least what the velocity becomes while the acceleration is taken to 0."""
    gain = peak - v
    top = min(math.sqrt(max(0.0, most_j * gain + 0.5 * a * a)), most_a)
    top = max(top, a, 0.0)
    first, last = max(0.0, (top - a) / most_j), top / most_j
    hold = 0.0
    if top > 0.0:
        hold = max(0.0, (gain - (2.0 * top * top - a * a) / (2.0 * most_j)) / top)
    way = first * (v + first * (0.5 * a + first * most_j / 6.0))
    way += hold * (peak - 0.5 * top * last - 0.5 * top * hold)
    way += last * (peak - last * last * most_j / 6.0)
    return first + hold + last, way


@kernel("float64(float64, float64, float64, float64, float64, float64)", entry=True)
def changed(v0: float, a0: float, v1: float, a1: float, most_a: float, most_j: float) -> float:
    """The least time from (v0, a0) to (v1, a1), whatever the way and the velocities between."""
    direct = 0.5 * (a0 + a1) * abs(a1 - a0) / most_j
    if abs(v1 - v0 - direct) <= ROUNDING:
        return abs(a1 - a0) / most_j  # with a little less or more velocity it may take much longer
    if v1 - v0 < direct:
        v0, a0, v1, a1 = -v0, -a0, -v1, -a1
    gain = v1 - v0
    top = math.sqrt(max(0.0, most_j * gain + 0.5 * (a0 * a0 + a1 * a1)))
    if top <= most_a:
        return max(0.0, (2.0 * top - a0 - a1) / most_j)
    hold = (gain - (2.0 * most_a * most_a - a0 * a0 - a1 * a1) / (2.0 * most_j)) / most_a
    return max(0.0, (2.0 * most_a - a0 - a1) / most_j + max(0.0, hold))


@kernel("float64(float64, float64, float64, float64, float64, float64)")
def unhindered(time: float, v: float, a: float, most_v: float, most_a: float, most_j: float) -> float:
    """The longest way in `time` from (v, a) if the end is free: velocity rises as fast as it may, to V."""
    rise = max(0.0, (most_a - a) / most_j)
    until = 0.0  # when V is reached
    if v < most_v:
        until = (-a + math.sqrt(a * a + 2.0 * most_j * (most_v - v))) / most_j
        if until > rise:
            until = rise + (most_v - v - rise * (a + 0.5 * most_j * rise)) / most_a
    lasts = min(time, until)
    one = min(lasts, rise)
    way = one * (v + one * (0.5 * a + one * most_j / 6.0))
    two = lasts - one
    if two > 0.0:
        way += two * (v + rise * (a + 0.5 * most_j * rise) + 0.5 * two * most_a)
    return way + most_v * max(0.0, time - until)


@kernel("float64(float64, float64, float64, float64, float64, float64)")
def most_ahead(time: float, v: float, a: float, most_v: float, most_a: float, most_j: float) -> float:
    """How far ahead it may be at any time up to `time`: the greatest of 0 and of `unhindered` so far."""
    way = max(0.0, unhindered(time, v, a, most_v, most_a, most_j))
    square = a * a - 2.0 * most_j * v
    if v > 0.0 and a < 0.0 and square >= 0.0:
        # even with full jerk it turns back once
        turn = (-a - math.sqrt(square)) / most_j
        way = max(way, unhindered(min(time, turn), v, a, most_v, most_a, most_j))
    return way


@kernel(f"{PAIR}(float64, float64, float64, float64, float64, float64, float64)")
def bent(time: float, v: float, a0: float, a1: float, most_a: float, most_j: float, line: float) -> tuple[float, float]:
    """Gain of velocity and way in `time` from (v, a0), if the acceleration rises as fast as it may until it meets the
    line `line` − J t, goes down along that, and rises at last so that it ends with a1."""
    one = min(max((line - a0) / (2.0 * most_j), (line - most_a) / most_j, 0.0), time)
    two = min((line + most_a) / most_j, (line - a1 + most_j * time) / (2.0 * most_j), time)
    rise, end = min(max(0.0, (most_a - a0) / most_j), one), time - max(0.0, (a1 + most_a) / most_j)
    level = max(0.0, max(two, end) - two) if two < time else 0.0
    rest = max(0.0, time - max(one, two) - level)
    way, begin, a = 0.0, v, a0
    for lasts, jerk in (
        (rise, most_j),
        (one - rise, 0.0),
        (max(0.0, two - one), -most_j),
        (level, 0.0),
        (rest, most_j),
    ):
        way += lasts * (v + lasts * (0.5 * a + lasts * jerk / 6.0))
        v += lasts * (a + 0.5 * lasts * jerk)
        a += lasts * jerk
    return v - begin, way


@kernel("float64(float64, float64, float64, float64, float64, float64, float64, float64)")
def farthest_way(
    time: float, v0: float, a0: float, v1: float, a1: float, most_v: float, most_a: float, most_j: float
) -> float:
    """The longest way in exactly `time` from (v0, a0) to (v1, a1), or more; −inf where there is none."""
    least = changed(v0, a0, v1, a1, most_a, most_j)
    if time < least - ROUNDING_S * max(1.0, least):
        return -math.inf
    low = max(v0 + 0.5 * a0 * abs(a0) / most_j, v1 - 0.5 * a1 * abs(a1) / most_j)
    if not low <= most_v:
        # more than V on the way, whatever is done: nothing is claimed beside that
        return unhindered(time, v0, a0, max(most_v, v0, v1, low), most_a, most_j)
    t0, _ = risen(v0, a0, low, most_a, most_j)
    t1, _ = risen(v1, -a1, low, most_a, most_j)
    if time < t0 + t1:
        # too short for a peak without acceleration
        under, over = a0, max(a0, a1 + most_j * time)
        for _ in range(HALVINGS):
            line = 0.5 * (under + over)
            if bent(time, v0, a0, a1, most_a, most_j, line)[0] <= v1 - v0:
                under = line
            else:
                over = line
        return bent(time, v0, a0, a1, most_a, most_j, over)[1]
    t0, way0 = risen(v0, a0, most_v, most_a, most_j)
    t1, way1 = risen(v1, -a1, most_v, most_a, most_j)
    if t0 + t1 <= time:
        return way0 + way1 + most_v * (time - t0 - t1)
    high = most_v
    for _ in range(HALVINGS):
        peak = 0.5 * (low + high)
        if risen(v0, a0, peak, most_a, most_j)[0] + risen(v1, -a1, peak, most_a, most_j)[0] <= time:
            low = peak
        else:
            high = peak
    t0, way0 = risen(v0, a0, high, most_a, most_j)
    t1, way1 = risen(v1, -a1, high, most_a, most_j)
    return way0 + way1 + high * (time - t0 - t1)  # the time is a little less than that of this peak


@kernel(f"{PAIR}(float64, {F2}, {F2}, int64, float64, float64, float64)")
def way_span(
    time: float, begin: FloatArray, end: FloatArray, joint: int, most_v: float, most_a: float, most_j: float
) -> tuple[float, float]:
    """The least and the greatest way of a joint in exactly `time` from its state in `begin` (4, n) to the velocity and
    the acceleration in `end`; if of one of them the position alone is known, in `time` or less. (inf, −inf): none."""
    if not time >= 0.0:
        return math.inf, -math.inf
    v0, a0, v1, a1 = begin[1, joint], begin[2, joint], end[1, joint], end[2, joint]
    known0, known1 = begin[KINDS, joint] == EXACT, end[KINDS, joint] == EXACT
    if known0 and known1:
        up = farthest_way(time, v0, a0, v1, a1, most_v, most_a, most_j)
        down = -farthest_way(time, -v0, -a0, -v1, -a1, most_v, most_a, most_j)
    elif known0:
        up, down = most_ahead(time, v0, a0, most_v, most_a, most_j), -most_ahead(time, -v0, -a0, most_v, most_a, most_j)
    elif known1:
        # the same backwards in time
        up, down = most_ahead(time, v1, -a1, most_v, most_a, most_j), -most_ahead(time, -v1, a1, most_v, most_a, most_j)
    else:
        up, down = most_v * time, -most_v * time
    return down, up


@kernel(f"boolean(float64, {F2}, {F2}, int64, float64, float64, float64)")
def out_of_range_in(
    time: float, begin: FloatArray, end: FloatArray, joint: int, most_v: float, most_a: float, most_j: float
) -> bool:
    """Whether a joint cannot come in exactly `time` from its state in `begin` (4, n) to that in `end` (`way_span`)."""
    down, up = way_span(time, begin, end, joint, most_v, most_a, most_j)
    way: float = end[0, joint] - begin[0, joint]
    slack = ROUNDING * max(1.0, abs(way))
    return way > up + slack or way < down - slack


@kernel(f"float64({F2}, {F2}, {F1}, {F2}, float64)", entry=True)
def soonest(begin: FloatArray, end: FloatArray, delay: FloatArray, limits: FloatArray, least: float) -> float:
    """The least time, s, `least` at least, in which every joint can come from its state in `begin` (4, n) to that in
    `end`, which is one that a joint can keep: at rest, or with no more known than the position.

    `delay` (n,): how much later each joint may begin, together with how much sooner it must be there. `limits` (3, n):
    of velocity, acceleration, jerk.
    """
    for joint in range(begin.shape[1]):
        v, a, j = limits[0, joint], limits[1, joint], limits[2, joint]
        if not out_of_range_in(least - delay[joint], begin, end, joint, v, a, j):
            continue
        way = end[0, joint] - begin[0, joint]
        rest = begin[KINDS, joint] == EXACT and end[KINDS, joint] == EXACT
        for row in range(1, KINDS):
            rest = rest and begin[row, joint] == 0.0 and end[row, joint] == 0.0
        if rest:
            least = max(least, delay[joint] + rest_to_rest_time(max(0.0, abs(way) - ROUNDING), v, a, j))
            continue
        low, span = max(0.0, least - delay[joint]), 1e-3
        high = low + span
        for _ in range(HALVINGS):
            if not out_of_range_in(high, begin, end, joint, v, a, j):
                break
            low, span = high, 2.0 * span
            high = low + span
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if out_of_range_in(middle, begin, end, joint, v, a, j):
                low = middle
            else:
                high = middle
        least = max(least, delay[joint] + low)
    return least


@kernel(f"void({F3}, {F3}, {F2}, {F3}, {F1}, {F2}, float64, {F1})", allocates=True)
def arrivals(
    begins: FloatArray,
    kept: FloatArray,
    left: FloatArray,
    goals: FloatArray,
    guides: FloatArray,
    limits: FloatArray,
    floor: float,
    times: FloatArray,
) -> None:
    """Fills `times` (C,) with when each of `goals` (C, 4, n) can be met first, from any of the states `begins`
    (S, 4, n), and not before `floor`, s.

    A state is left by each joint at its time of `left` (S, n), or later along what keeps to `kept` (S, 3, n) and is
    within the limits then; each joint must be at the goal `guides` (n,) before that is met. `limits` (3, n).
    """
    n = limits.shape[1]
    delay, most = np.zeros(n), np.zeros((3, n))
    for c in range(len(goals)):
        times[c] = math.inf
        for s in range(len(begins)):
            worse = False
            for joint in range(n):
                delay[joint] = left[s, joint] - floor + guides[joint]
                for row in range(3):
                    most[row, joint] = max(limits[row, joint], kept[s, row, joint])
                if times[c] < math.inf and not worse:
                    spare = times[c] - floor - delay[joint]
                    v, a, j = most[0, joint], most[1, joint], most[2, joint]
                    worse = out_of_range_in(spare, begins[s], goals[c], joint, v, a, j)
            if not worse:
                times[c] = min(times[c], floor + soonest(begins[s], goals[c], delay, most, 0.0))
