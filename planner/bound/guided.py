"""The joints of an arm whose flange is guided along a point that moves, and when they can be there first.

For arms whose flange is carried by one or two dyads in a horizontal plane, with a lift and a wrist. With the
absolute angles φ1, φ2 of a dyad, e its unit vectors, s = sin(φ2 − φ1) and b = a + l1 φ̇1² e1 + l2 φ̇2² e2,

    l1 φ̇1 = v·e2 / s        l2 φ̇2 = −v·e1 / s        l1 φ̈1 = b·e2 / s        l2 φ̈2 = −b·e1 / s

and the rates of an interval are bounded by equation D2 of docs/guarantees.md.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.bound.fastest import EXACT, F1, F2, F3, FREE, KINDS, ROUNDING, STATE, unhindered, way_span
from assur.planner.compiled import kernel
from assur.planner.kernels.inverse import TURN
from assur.planner.kernels.links import (
    BASE_COS,
    BASE_SIN,
    BASE_X,
    BASE_Y,
    BASE_YAW,
    BASE_Z,
    HEIGHT,
    L1,
    L2,
    L3,
    L4,
)

LEAST_SINE = 1e-3
"""An arm that comes nearer to a singularity than this is not bounded."""
RATES = 9
"""Bounds over an interval: velocity, acceleration and jerk of the point in the plane; the same of its height, and of
its yaw."""
BOUNDED, UNKNOWN, NOWHERE = 0, 1, 2
"""What is known of an arm over an interval: states and bounds; nothing; that it is out of reach at all times."""
DYAD = 14
"""Numbers of a dyad: φ1, φ2, their rates and accelerations; from BOUNDS on bounds of the rates, of the accelerations
and of the jerks of both; and 2 more, of the rate and the acceleration of φ2 − φ1."""
BOUNDS = 6


@kernel(f"int64(float64, float64, float64, {F2}, float64, float64, {F1}, float64, float64, {F1})")
def dyad(
    l1: float,
    l2: float,
    sign: float,
    point: FloatArray,
    x: float,
    y: float,
    rates: FloatArray,
    before: float,
    off: float,
    out: FloatArray,
) -> int:
    """Fills `out` for a dyad from (0, 0) to (x, y), bent to the side of `sign`, at an instant, with bounds over the
    time of `before` s next to it in which its end is at most `off` m away. `point` (4, 4): rows v, a of x, y."""
    far = math.sqrt(x * x + y * y)
    low, high = max(0.0, far - off), far + off
    if low > l1 + l2 + ROUNDING or high < abs(l1 - l2) - ROUNDING:
        return NOWHERE
    first = (low * low - l1 * l1 - l2 * l2) / (2.0 * l1 * l2)
    last = (high * high - l1 * l1 - l2 * l2) / (2.0 * l1 * l2)
    most = max(abs(first), abs(last))
    if not most < 1.0:
        return UNKNOWN
    least = math.sqrt(1.0 - most * most)
    if not least >= LEAST_SINE:
        return UNKNOWN
    c = (far * far - l1 * l1 - l2 * l2) / (2.0 * l1 * l2)
    s = sign * math.sqrt(1.0 - c * c)
    one = math.atan2(y, x) - math.atan2(l2 * s, l1 + l2 * c)
    two = one + math.atan2(s, c)
    c1, s1, c2, s2 = math.cos(one), math.sin(one), math.cos(two), math.sin(two)
    w1, w2 = (point[1, 0] * c2 + point[1, 1] * s2) / (l1 * s), -(point[1, 0] * c1 + point[1, 1] * s1) / (l2 * s)
    bx = point[2, 0] + l1 * w1 * w1 * c1 + l2 * w2 * w2 * c2
    by = point[2, 1] + l1 * w1 * w1 * s1 + l2 * w2 * w2 * s2
    b1, b2 = (bx * c2 + by * s2) / (l1 * s), -(bx * c1 + by * s1) / (l2 * s)
    out[0], out[1], out[2], out[3], out[4], out[5] = one, two, w1, w2, b1, b2
    most1, most2 = rates[0] / (l1 * least), rates[0] / (l2 * least)
    bent1, bent2, jerk1, jerk2 = 0.0, 0.0, 0.0, 0.0
    for _ in range(2):
        pull = rates[1] + l1 * most1 * most1 + l2 * most2 * most2
        bent1, bent2 = pull / (l1 * least), pull / (l2 * least)
        pull = rates[2] + 3.0 * (l1 * most1 * bent1 + l2 * most2 * bent2)
        jerk1, jerk2 = pull / (l1 * least) + most1**3, pull / (l2 * least) + most2**3
        bent1, bent2 = min(bent1, abs(b1) + before * jerk1), min(bent2, abs(b2) + before * jerk2)
        most1, most2 = min(most1, abs(w1) + before * bent1), min(most2, abs(w2) + before * bent2)
    out[BOUNDS], out[BOUNDS + 1], out[BOUNDS + 2], out[BOUNDS + 3] = most1, most2, bent1, bent2
    out[BOUNDS + 4], out[BOUNDS + 5] = jerk1, jerk2
    out[BOUNDS + 6] = min(most1 + most2, abs(w2 - w1) + before * (bent1 + bent2))
    out[BOUNDS + 7] = min(bent1 + bent2, abs(b2 - b1) + before * (jerk1 + jerk2))
    return BOUNDED


@kernel(f"int64({F1}, int64, {F2}, {F1}, float64, {F2}, {F2}, {F1})", entry=True)
def guided_joints(
    arm: FloatArray,
    mode: int,
    point: FloatArray,
    rates: FloatArray,
    before: float,
    state: FloatArray,
    bounds: FloatArray,
    work: FloatArray,
) -> int:
    """Fills `state` (4, n) with the joints of an arm in a working mode whose flange moves as `point` (4, 4: a row an
    order, columns x, y, z, yaw in the world) at an instant, and `bounds` (3, n) with bounds of their velocities,
    accelerations and jerks over the `before` s next to it, in which the point keeps to `rates` (9,). `work` (28,)."""
    dx, dy = point[0, 0] - arm[BASE_X], point[0, 1] - arm[BASE_Y]
    off, turning = rates[0] * before, 1
    left, right = work[:DYAD], work[DYAD : 2 * DYAD]
    if arm[L3] > 0.0:  # two dyads
        x, y = 0.5 * arm[HEIGHT] * arm[BASE_SIN], 0.5 * arm[HEIGHT] * arm[BASE_COS]
        bend, other_bend = 1.0 if mode // 2 == 1 else -1.0, 1.0 if mode % 2 == 1 else -1.0
        found = dyad(arm[L1], arm[L2], bend, point, dx + x, dy - y, rates, before, off, left)
        other = dyad(arm[L3], arm[L4], other_bend, point, dx - x, dy + y, rates, before, off, right)
        if found != BOUNDED or other != BOUNDED:
            return NOWHERE if NOWHERE in (found, other) else UNKNOWN
        for row in range(3):
            state[row, 0], state[row, 1] = left[2 * row], right[2 * row]
            bounds[row, 0], bounds[row, 1] = left[BOUNDS + 2 * row], right[BOUNDS + 2 * row]
        state[0, 0] -= arm[BASE_YAW]
        state[0, 1] -= arm[BASE_YAW]
    else:
        found = dyad(arm[L1], arm[L2], 1.0 if mode == 1 else -1.0, point, dx, dy, rates, before, off, left)
        if found != BOUNDED:
            return found
        for row in range(3):
            state[row, 0], state[row, 1] = left[2 * row], left[2 * row + 1] - left[2 * row]
            bounds[row, 0] = left[BOUNDS + 2 * row]
        state[0, 0] -= arm[BASE_YAW]
        bounds[0, 1], bounds[1, 1] = left[BOUNDS + 6], left[BOUNDS + 7]
        bounds[2, 1] = left[BOUNDS + 4] + left[BOUNDS + 5]
    many = state.shape[1]
    if many > 2:
        for row in range(3):
            state[row, 2], bounds[row, 2] = point[row, 2], rates[3 + row]
        state[0, 2] -= arm[BASE_Z]
    if many > 3:
        for row in range(3):
            state[row, 3] = point[row, 3] - left[2 * row + turning]
            bounds[row, 3] = rates[6 + row] + left[BOUNDS + 2 * row + turning]
    for joint in range(many):
        state[KINDS, joint] = EXACT
    return BOUNDED


@kernel(f"boolean({F2}, {F2}, {F2}, {F2}, {F1}, {F1}, {F2}, float64, float64, boolean)")
def out_of_reach_within(
    begin: FloatArray,
    kept: FloatArray,
    end: FloatArray,
    bounds: FloatArray,
    left: FloatArray,
    late: FloatArray,
    limits: FloatArray,
    time: float,
    before: float,
    boxed: bool,
) -> bool:
    """Whether a joint cannot come from `begin` (4, n), which it leaves at the times `left` (n,) while it keeps to the
    bounds `kept` (3, n) if it waits, to `end` at any time from `time` − `before` to `time`, each `late` (n,) after.

    At the end the joints keep to `bounds` (3, n): who were there sooner could go on to where they are at `time`, within
    bounds and limits. `boxed`: they stop there instead, or pass, and only where they are is bounded.
    `limits` (5, n): range, velocity, acceleration, jerk. A joint whose position is not known (NaN) only needs
    enough time.
    """
    for joint in range(begin.shape[1]):
        at = end[0, joint]
        v, a, j = limits[2, joint], limits[3, joint], limits[4, joint]
        v, a, j = max(v, kept[0, joint]), max(a, kept[1, joint]), max(j, kept[2, joint])
        if not boxed:
            v, a, j = max(v, bounds[0, joint]), max(a, bounds[1, joint]), max(j, bounds[2, joint])
        off = bounds[0, joint] * before
        spare = time + late[joint] - left[joint]
        if spare < 0.0:
            return True
        if not math.isfinite(v + a + j + at + begin[0, joint]):
            continue
        wide = ROUNDING + (off if boxed else 0.0)
        low, high = limits[0, joint] - off - ROUNDING, limits[1, joint] + off + ROUNDING
        turn, last = at - begin[0, joint], at - begin[0, joint]
        if joint != 2:  # of these arms the third joint slides
            turn += TURN * math.ceil((low - at) / TURN)
            last += TURN * math.floor((high - at) / TURN)
        elif not low <= at <= high:
            return True
        # the quick test first, which most times do not pass
        up = unhindered(spare, begin[1, joint], begin[2, joint], v, a, j)
        down = -unhindered(spare, -begin[1, joint], -begin[2, joint], v, a, j)
        tried = False
        met = False
        while turn <= last + ROUNDING and not met:
            if begin[KINDS, joint] != EXACT or end[KINDS, joint] != EXACT or down - wide <= turn <= up + wide:
                if not tried:
                    down, up = way_span(spare, begin, end, joint, v, a, j)
                    tried = True
                met = down - wide <= turn <= up + wide
            turn += TURN
        if not met:
            return True
    return False


@kernel(
    f"int64({F1}, {F3}, {F2}, boolean[::1], {F1}, int64[::1], boolean, boolean, {F3}, {F3}, {F2}, {F1}, {F2})",
    allocates=True,
)
def first_open(
    edges: FloatArray,
    points: FloatArray,
    rates: FloatArray,
    outside: BoolArray,
    arm: FloatArray,
    modes: IntArray,
    stops: bool,
    passes: bool,
    begins: FloatArray,
    kept: FloatArray,
    left: FloatArray,
    late: FloatArray,
    limits: FloatArray,
) -> int:
    """The first of the intervals between `edges` (N + 1,) in which a point cannot be shown not to be met; N: none.

    `points` (N, 4, 4): its motion at the end of each interval; `rates` (N, 9): bounds over it; `outside` (N,): where it
    may not be met. `stops`: the joints stand when it is met; `passes`: only their positions count; else they go
    along with it. From any of the states `begins` (S, 4, n), left at `left` (S, n) or later, along what keeps to
    `kept` (S, 3, n). A joint is there `late` (n,) s after the point is met.
    """
    n = limits.shape[1]
    state, bounds, work = np.zeros((STATE, n)), np.zeros((3, n)), np.zeros(2 * DYAD)
    for k in range(len(points)):
        if outside[k]:
            continue
        before = edges[k + 1] - edges[k]
        for m in range(len(modes)):
            found = guided_joints(arm, modes[m], points[k], rates[k], before, state, bounds, work)
            if found == NOWHERE:
                continue
            if found == UNKNOWN:
                return k
            if stops or passes:
                for joint in range(n):
                    state[1, joint], state[2, joint] = 0.0, 0.0
                    state[KINDS, joint] = FREE if passes else EXACT
            for s in range(len(begins)):
                if not out_of_reach_within(
                    begins[s], kept[s], state, bounds, left[s], late, limits, edges[k + 1], before, stops or passes
                ):
                    return k
    return len(points)
