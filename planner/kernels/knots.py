"""Compiled: knots of a joint motion from its phases of constant jerk, which need no repair.

Ruckig gives each joint its own switches, and those of different joints may be microseconds apart. A knot at each of
them would make pieces so short that the rounding of a position is felt in the jerk (60 r/h³). Therefore switches closer
than `MERGE` share a knot. Accelerations at the knots are the profile's; velocities and positions are summed up again
over the merged pieces, which are cubics (equation T4):

    j = (a1 − a0)/h    v1 = v0 + h (a0 + a1)/2    q1 = q0 + h v0 + h² (2 a0 + a1)/6

So the jerk of a piece is a mean of the profile's jerk over it, and cannot exceed its limit. What the sums miss at the
end of a leg, r, r', r'' in position, velocity and acceleration, is added to its knots as one quintic that begins at
rest, over the whole duration T of the leg (equation T5), with u = t/T:

    c(u) = u³ (c3 + c4 u + c5 u²)        c3 = 10 r − 4 T r' + T² r''/2
    c4 = −15 r + 7 T r' − T² r''         c5 = 6 r − 3 T r' + T² r''/2

Its jerk is of the order of 60 r/T³. Nothing else is mended: the caller checks limits.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.limits import FIRST, TIME

MERGE = 2e-5
"""s. Switches closer than this share a knot: at 20 µs and 3 rad, rounding costs a jerk of 2 rad/s³."""

DURATION, JERK = 0, 1
"""Rows of a joint's phases: how long each lasts, s, and its jerk."""


@kernel("float64(float64[:, ::1], float64[:, ::1], float64[:, :, ::1], float64, float64, float64, float64)")
def missed_goal(
    start: FloatArray,
    goal: FloatArray,
    phases: FloatArray,
    duration: float,
    position: float,
    velocity: float,
    acceleration: float,
) -> float:
    """By how much phases (n, 2, S) from the state `start` (3, n) miss the state `goal` after `duration` s.

    The worst joint's norm, its parts in units of `position`, `velocity`, `acceleration`; infinity for numbers that are
    none. A joint whose phases end earlier goes on with constant acceleration.
    """
    worst = 0.0
    for joint in range(start.shape[1]):
        q, v, a = start[0, joint], start[1, joint], start[2, joint]
        left = duration
        for phase in range(phases.shape[2]):
            h, j = phases[joint, DURATION, phase], phases[joint, JERK, phase]
            q += h * (v + h * (a / 2 + h * j / 6))
            v += h * (a + h * j / 2)
            a += h * j
            left -= h
        q += left * (v + left * a / 2)
        v += left * a
        off_q = (q - goal[0, joint]) / position
        off_v = (v - goal[1, joint]) / velocity
        off_a = (a - goal[2, joint]) / acceleration
        miss = math.sqrt(off_q * off_q + off_v * off_v + off_a * off_a)
        if not miss <= worst:
            worst = miss
        if not miss < math.inf:
            return math.inf
    return worst


@kernel("int64(float64[:, :, ::1], float64, float64[::1])", allocates=True)
def shared_switches(phases: FloatArray, duration: float, times: FloatArray) -> int:
    """Writes the times of the knots of one leg, from 0 to `duration`, to `times`, and gives their number.

    Those of phases (n, 2, S), in the middle of each group that is shorter than `MERGE`; none is nearer than that to
    either end. `times` has room for n S + 2 numbers.
    """
    joints, most = phases.shape[0], phases.shape[2]
    switches = np.empty(joints * most)
    found = 0
    for joint in range(joints):
        t = 0.0
        for phase in range(most):
            h = phases[joint, DURATION, phase]
            t += h
            if h > 0 and MERGE <= t <= duration - MERGE:
                switches[found] = t
                found += 1
    switches[:found].sort()
    times[0] = 0.0
    count, at = 1, 0
    while at < found:
        first = last = switches[at]
        while at < found and switches[at] < first + MERGE:
            last = switches[at]
            at += 1
        times[count] = (first + last) / 2
        count += 1
    times[count] = duration
    return count + 1


@kernel("void(float64[:, ::1], int64, int64, int64, float64[:, ::1], float64[:, ::1])")
def _sum_up(knots: FloatArray, first: int, last: int, joint: int, start: FloatArray, phases: FloatArray) -> None:
    """Fills one joint's states in the rows `first` to `last` of the knots of a leg, whose times are there (T4).

    `start` (3, n): where the leg begins. `phases` (2, S): durations and jerks of the joint.
    """
    joints, most = start.shape[1], phases.shape[1]
    q, v, a = FIRST + joint, FIRST + joints + joint, FIRST + 2 * joints + joint
    knots[first, q], knots[first, v], knots[first, a] = start[0, joint], start[1, joint], start[2, joint]
    phase, begun, pace = 0, 0.0, start[2, joint]
    for k in range(first + 1, last + 1):
        # the acceleration of the profile at this time
        t = knots[k, TIME] - knots[first, TIME]
        while phase < most and begun + phases[DURATION, phase] <= t:
            begun += phases[DURATION, phase]
            pace += phases[DURATION, phase] * phases[JERK, phase]
            phase += 1
        now = pace + (t - begun) * phases[JERK, phase] if phase < most else pace
        h, before, speed = knots[k, TIME] - knots[k - 1, TIME], knots[k - 1, a], knots[k - 1, v]
        knots[k, a] = now
        knots[k, v] = speed + h * (before + now) / 2
        knots[k, q] = knots[k - 1, q] + h * (speed + h * (2 * before + now) / 6)


@kernel("float64[:, ::1](float64[::1], float64[:, :, ::1], float64[:, :, :, ::1])", allocates=True)
def knots_of_phases(begins: FloatArray, states: FloatArray, phases: FloatArray) -> FloatArray:
    """Knots (K, 1 + 3n) of L legs in a row: time, q, q̇, q̈ (equations T4, T5).

    `begins` (L+1,): times in s at which the legs begin, and at which the last one ends, increasing. `states`
    (L+1, 3, n): q, q̇, q̈ at these times, which the knots there repeat to the bit. `phases` (L, n, 2, S): durations and
    jerks of every joint, beginning with the leg; phases of no length are allowed. A leg without phases waits.
    """
    legs, joints, most = phases.shape[0], phases.shape[1], phases.shape[3]
    knots = np.empty((1 + legs * (joints * most + 1), 1 + 3 * joints))
    times = np.empty(joints * most + 2)
    q, v, a = FIRST, FIRST + joints, FIRST + 2 * joints
    knots[0, TIME] = begins[0]
    count = 1
    for leg in range(legs):
        begin, duration = begins[leg], begins[leg + 1] - begins[leg]
        first = count - 1
        inner = shared_switches(phases[leg], duration, times) - 2
        last = first + inner + 1
        for number in range(inner):
            knots[first + 1 + number, TIME] = begin + times[1 + number]
        knots[last, TIME] = begins[leg + 1]
        count = last + 1
        for joint in range(joints):
            _sum_up(knots, first, last, joint, states[leg], phases[leg, joint])
            # what the sums miss, as a quintic that begins at rest
            r = states[leg + 1, 0, joint] - knots[last, q + joint]
            rv = duration * (states[leg + 1, 1, joint] - knots[last, v + joint])
            ra = duration * duration * (states[leg + 1, 2, joint] - knots[last, a + joint])
            c3, c4, c5 = 10 * r - 4 * rv + ra / 2, -15 * r + 7 * rv - ra, 6 * r - 3 * rv + ra / 2
            for k in range(first + 1, last):
                u = (knots[k, TIME] - begin) / duration
                knots[k, q + joint] += u**3 * (c3 + u * (c4 + u * c5))
                knots[k, v + joint] += u * u * (3 * c3 + u * (4 * c4 + u * 5 * c5)) / duration
                knots[k, a + joint] += u * (6 * c3 + u * (12 * c4 + u * 20 * c5)) / (duration * duration)
            knots[last, q + joint] = states[leg + 1, 0, joint]
            knots[last, v + joint] = states[leg + 1, 1, joint]
            knots[last, a + joint] = states[leg + 1, 2, joint]
    return knots[:count]
