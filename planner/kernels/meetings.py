"""Compiled: the joint states in which a control point can be met, at many times, and how long the way there takes.

A meeting is a row: its time, s, then n positions, velocities and accelerations of the joints.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel
from assur.planner.kernels.candidates import ACCELERATION, JERK, VELOCITY, least_time
from assur.planner.kernels.dyads import ASSEMBLED, RRR_COLUMNS, WORK_ROWS
from assur.planner.kernels.inverse import TURN, joint_states
from assur.planner.kernels.links import assembled
from assur.planner.kernels.motion import ORDERS

LEGAL, NOWHERE, SINGULAR, FAST = range(4)
"""What becomes of a meeting: it can be, limits of position left aside; the arm is not assembled there, or its position
has no derivatives; it is nearer to a singularity than required; a joint would have to be too fast."""
NO_BOUND = -1.0
"""A required margin that every posture has."""
ROUNDING = 1e-12
"""Relative. Taken off every lower bound of a duration: the closed forms round by some 1e-15, and a bound must never
exceed the truth."""


@kernel(
    "int64(float64[::1], int64, float64[:, :, ::1], float64[:, ::1], float64, float64[::1], float64[:, ::1],"
    " float64[:, ::1], int64[::1], int64[::1])",
    allocates=True,
)
def meeting_states(
    robot: FloatArray,
    mode: int,
    targets: FloatArray,
    limits: FloatArray,
    required: float,
    times: FloatArray,
    states: FloatArray,
    margins: FloatArray,
    codes: IntArray,
    verdicts: IntArray,
) -> int:
    """Fills `states` (T, 1 + 3n), `margins` (T, 2), `codes` (T,) and `verdicts` (T,) of the flange motions `targets`
    (T, 4, 6), which are to be met at `times` (T,) with margins of `required` at least. Returns how many are LEGAL."""
    n, legal = limits.shape[1], 0
    work, joints = np.empty((WORK_ROWS, RRR_COLUMNS)), np.empty((ORDERS, n))
    for i in range(len(targets)):
        code = joint_states(robot, mode, 2, targets[i], joints, margins[i], work)
        states[i, 0] = times[i]
        known, fast = 0.0, False
        for k in range(3):
            for j in range(n):
                states[i, 1 + k * n + j] = joints[k, j]
                known += 0.0 * joints[k, j]
        for j in range(n):
            kept = abs(joints[1, j]) <= limits[VELOCITY, j] and abs(joints[2, j]) <= limits[ACCELERATION, j]
            fast = fast or not kept
        verdict = LEGAL
        if code != ASSEMBLED or not math.isfinite(known):
            verdict = NOWHERE
        elif not (margins[i, 0] >= required and margins[i, 1] >= required):
            verdict = SINGULAR
        elif fast:
            verdict = FAST
        codes[i], verdicts[i] = code, verdict
        legal += verdict == LEGAL
    return legal


@kernel("void(float64[:, ::1], int64[::1], float64[:, ::1], float64[::1], float64[::1], int64, int64[:, ::1])")
def turn_ranges(
    states: FloatArray,
    verdicts: IntArray,
    within: FloatArray,
    revolute: FloatArray,
    near: FloatArray,
    most: int,
    turns: IntArray,
) -> None:
    """Fills `turns` (n, 2) with the least and the most full turns of each joint that can bring a legal meeting within
    the limits of position `within` (2, n); at most `most` either way from the position `near` (n,), NaN: any."""
    n = len(revolute)
    for j in range(n):
        turns[j, 0] = turns[j, 1] = 0
        if revolute[j] != 1.0:
            continue
        lowest, highest, first = math.inf, -math.inf, math.nan
        for i in range(len(states)):
            if verdicts[i] == LEGAL:
                q = states[i, 1 + j]
                lowest, highest = min(lowest, q), max(highest, q)
                if math.isnan(first):
                    first = q
        if not lowest <= highest:
            turns[j, 1] = -1
            continue
        least = math.ceil((within[0, j] - highest) / TURN)
        last = math.floor((within[1, j] - lowest) / TURN)
        if not math.isnan(near[j]):
            here = math.floor((near[j] - first) / TURN + 0.5)
            least, last = max(least, here - most), min(last, here + most)
        turns[j, 0], turns[j, 1] = int(least), int(last)


@kernel(
    "int64(float64[::1], float64[:, ::1], int64[::1], float64[:, ::1], float64[::1], float64[:, ::1], int64[::1])",
    allocates=True,
)
def turned_states(
    robot: FloatArray,
    states: FloatArray,
    verdicts: IntArray,
    within: FloatArray,
    turns: FloatArray,
    found: FloatArray,
    numbers: IntArray,
) -> int:
    """Fills `found` with the legal meetings that are within the limits of position once every joint has made so many
    full turns (n,), and `numbers` with their rows. Returns how many these are."""
    n, count = len(turns), 0
    q = np.empty(n)
    for i in range(len(states)):
        kept = verdicts[i] == LEGAL
        for j in range(n):
            q[j] = states[i, 1 + j] + TURN * turns[j]
            kept = kept and within[0, j] <= q[j] <= within[1, j]
        if kept and assembled(robot, q, q):
            found[count] = states[i]
            for j in range(n):
                found[count, 1 + j] = q[j]
            numbers[count] = i
            count += 1
    return count


@kernel("float64(float64, float64, float64, float64)")
def rest_to_rest_time(distance: float, velocity: float, acceleration: float, jerk: float) -> float:
    """The minimum time from rest to rest of one joint, s.

    With V, A, J the limits and D the distance (equation P3):

        D ≤ 2A³/J², D ≤ 2√(V³/J):   T = (32 D/J)^⅓                     neither A nor V is reached
        D ≤ V (V/A + A/J), V J ≥ A²:  T = A/J + √(A²/J² + 4D/A)          A is reached, V is not
        else:                        T = D/V + (V/A + A/J  or, if V J < A²,  2√(V/J))
    """
    d, v, a, j = abs(distance), velocity, acceleration, jerk
    sharp = v * j < a * a
    short = 2.0 * math.sqrt(v * v * v / j) if sharp else 2.0 * a * a * a / (j * j)
    if d <= short:
        return math.pow(32.0 * d / j, 1.0 / 3.0)
    ramp = 2.0 * math.sqrt(v / j) if sharp else v / a + a / j
    if not sharp and d <= v * ramp:
        return a / j + math.sqrt((a / j) * (a / j) + 4.0 * d / a)
    return d / v + ramp


@kernel("void(float64[:, ::1], float64[:, ::1], float64[:, ::1], boolean, float64[::1])")
def least_durations(
    start: FloatArray, meetings: FloatArray, limits: FloatArray, jerk_limited: bool, found: FloatArray
) -> None:
    """Fills `found` (R,) with lower bounds, s, of the duration of any motion within limits from the state `start`
    (3, n) to each of `meetings` (R, 1 + 3n).

    The greatest over the joints of: the time-optimal double integrator in (position, velocity) under V and A (P4); the
    same in (velocity, acceleration) under A and J; and equation P3 for joints that are at rest at both ends, which is
    then the minimum itself. Each drops a constraint, so none exceeds the minimum. Without a limit of jerk the first of
    the three is all that is true. NaN where a number of the states is NaN.
    """
    n = start.shape[1]
    for i in range(len(meetings)):
        longest, unknown = 0.0, 0.0
        for j in range(n):
            q0, v0, a0 = start[0, j], start[1, j], start[2, j]
            q1, v1, a1 = meetings[i, 1 + j], meetings[i, 1 + n + j], meetings[i, 1 + 2 * n + j]
            v, a, jerk = limits[VELOCITY, j], limits[ACCELERATION, j], limits[JERK, j]
            if jerk_limited and v0 == 0.0 and v1 == 0.0 and a0 == 0.0 and a1 == 0.0:
                bound = rest_to_rest_time(q1 - q0, v, a, jerk)
            else:
                bound = least_time(q1 - q0, v0, v1, v, a)
                if jerk_limited:
                    bound = max(bound, least_time(v1 - v0, a0, a1, a, jerk))
            unknown += 0.0 * (q0 + v0 + a0 + q1 + v1 + a1)
            longest = max(longest, bound)
        found[i] = longest * (1.0 - ROUNDING) + unknown


@kernel("void(float64[::1], float64[:, ::1], float64[::1], float64[::1])")
def velocity_times(q: FloatArray, meetings: FloatArray, velocity: FloatArray, found: FloatArray) -> None:
    """Fills `found` (R,) with the seconds that the joints take at least from q (n,) to each meeting at `velocity`."""
    for i in range(len(meetings)):
        longest = 0.0
        for j in range(len(q)):
            longest = max(longest, abs(meetings[i, 1 + j] - q[j]) / velocity[j])
        found[i] = longest
