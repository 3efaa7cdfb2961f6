"""Compiled: rough motions of many candidates at once, by trapezoids, which are about as quick as Ruckig's.

A candidate goes from the arm's state by free vias to one of the options in which the next control point can be met. Its
rough motion has a trapezoidal velocity profile a joint on each segment. Jerk is not limited; that a jerk-limited motion
needs longer to change its velocity is represented by a lower acceleration, `MEAN` of the rates.

A double integrator gets over the distance x from velocity v0 to v1, |v| <= V and |v̇| <= A, in the least time by σA up
to the velocity σ√(σ A x + (v0² + v1²)/2), or on at σV, and by −σA down to v1, where σ is the sign of what is left of x
when v0 changes to v1 at once (equation P4). A profile that takes a time T cruises at a velocity c for which, above both
ends, −c²/A + c (T + (v0 + v1)/A) − (v0² + v1²)/(2A) is the distance; linear in c between them, and the mirror image
below both (equation P5). Not every longer duration is possible for a joint that is fast at its ends.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel

MOST_VIAS = 2
"""Free vias of a candidate."""
SEGMENTS = MOST_VIAS + 1
OPTION, WAIT, LATE, EFFORT, THROUGH, VIAS, PACES = 0, 1, 2, 3, 4, 5, 6
"""Columns of a candidate: number of the option that it leads to, seconds that it waits and that it comes later than the
earliest, the share of the limits of acceleration that it uses, the pace at which a via control point is passed, the
number of its free vias, their paces; and behind these, from `FIRST_VIA` on, their n joints each."""
FIRST_VIA = PACES + MOST_VIAS

LOWER, UPPER, VELOCITY, ACCELERATION, JERK = range(5)
"""Rows of the joints' limits."""

TIME, STATE = 0, 1
"""Columns of a meeting: its time, s, and from there n positions and n velocities. Those of an option follow each other,
with increasing times; an option that can be met at any time has one."""
FIRST, COUNT, ANY_TIME = 0, 1, 2
"""Columns of an option: where its meetings begin, how many it has, whether it can be met at any time (1 or 0)."""

BEGIN, END, DURATIONS = 0, 1, 2
"""Columns of a rough motion: when it begins to move and when it ends, s, then the durations of its segments; and behind
these, for each joint, position at the `SEGMENTS` + 1 stations, velocity there, cruising velocity of the segments, and
its acceleration."""
OF_JOINT = DURATIONS + SEGMENTS
PLACES, SPEEDS, CRUISES, RATE = 0, SEGMENTS + 1, 2 * SEGMENTS + 2, 3 * SEGMENTS + 2
JOINT_COLUMNS = 3 * SEGMENTS + 3

VIA_VELOCITY = 0.9
"""Share of a velocity limit up to which a via is flown by: the rest is left to Ruckig."""
BRIEFEST = 1e-3
"""A motion through a via is taken to last this long at least, s."""
SAFETY_FACTOR = 1.01
"""Ruckig's motions are nearly always at most 1 % longer than the estimate."""
MEETINGS = 2
"""Times that the meeting is looked up again after the motion to it was timed."""
REACHED = 1e-6
"""An end is reached to this, rad or m: the closed form rounds by some 1e-9."""


@kernel("float64(float64, float64, float64, float64, float64)")
def least_time(x: float, v0: float, v1: float, speed: float, rate: float) -> float:
    """The least time of a double integrator over the distance x from velocity v0 to v1 (equation P4), s."""
    sign = 1.0 if x >= (v0 + v1) * abs(v1 - v0) / (2 * rate) else -1.0
    x, v0, v1 = sign * x, sign * v0, sign * v1
    peak = math.sqrt(max(rate * x + (v0 * v0 + v1 * v1) / 2, 0.0))
    if peak <= speed:
        return (2 * peak - v0 - v1) / rate
    return (2 * speed - v0 - v1) / rate + (x - (2 * speed * speed - v0 * v0 - v1 * v1) / (2 * rate)) / speed


@kernel("float64(float64, float64, float64, float64, float64)")
def cruise(x: float, v0: float, v1: float, rate: float, duration: float) -> float:
    """The cruising velocity of a profile over the distance x that takes `duration` (equation P5)."""
    low, high = min(v0, v1), max(v0, v1)
    between, ramp = duration - (high - low) / rate, (high * high - low * low) / (2 * rate)
    above = x > ramp + high * between
    if not above and between > 0 and x >= ramp + low * between:
        return (x - ramp) / between
    sign = 1.0 if above else -1.0
    b, c = duration + sign * (v0 + v1) / rate, sign * x + (v0 * v0 + v1 * v1) / 2 / rate
    return sign * (rate / 2) * (b - math.sqrt(max(b * b - 4 * c / rate, 0.0)))


@kernel("float64(float64, float64, float64, float64, float64, float64, float64)")
def profile_at(q0: float, v0: float, v1: float, cruising: float, rate: float, duration: float, t: float) -> float:
    """The position at `t` s, within [0, `duration`], of a profile that begins at q0 and cruises at `cruising`."""
    first, last = abs(cruising - v0) / rate, duration - abs(v1 - cruising) / rate
    up, on, down = min(t, first), max(min(t, last) - first, 0.0), max(t - last, 0.0)
    rise = rate if cruising > v0 else -rate
    fall = rate if v1 > cruising else -rate
    return q0 + (v0 + rise / 2 * up) * up + cruising * on + (cruising + fall / 2 * down) * down


@kernel("float64(float64, float64, float64)")
def stopping_distance(speed: float, acceleration: float, jerk: float) -> float:
    """The least distance in which a joint that does not accelerate gets from `speed` to 0."""
    onset = math.sqrt(2 * min(speed, acceleration**2 / (2 * jerk)) / jerk)
    rest = max(speed - jerk * onset**2 / 2, 0.0)
    return speed * onset - jerk * onset**3 / 6 + rest**2 / (2 * acceleration)


@kernel("void(float64[::1], float64[::1], float64[::1], float64, float64[::1], float64[::1], float64[::1])", entry=True)
def passing_velocity(
    before: FloatArray,
    at: FloatArray,
    behind: FloatArray,
    pace: float,
    velocity: FloatArray,
    acceleration: FloatArray,
    found: FloatArray,
) -> None:
    """Fills `found` (n,) with the velocity with which `at` is passed from `before` to `behind`: `pace` times the mean.

    A joint that turns round at the via stands still there: else it would go on beyond the via, perhaps beyond a limit.
    """
    duration = BRIEFEST
    for i in range(len(at)):
        length = abs(at[i] - before[i]) + abs(behind[i] - at[i])
        duration = max(duration, length / velocity[i] + math.sqrt(length / acceleration[i]))
    for i in range(len(at)):
        most, wanted = VIA_VELOCITY * velocity[i], pace * (behind[i] - before[i]) / duration
        on = (at[i] - before[i]) * (behind[i] - at[i]) > 0
        found[i] = min(max(wanted, -most), most) if on else 0.0


@kernel("int64(float64[:, ::1], float64[::1], float64)")
def next_meeting(meetings: FloatArray, option: FloatArray, at: float) -> int:
    """The row of the first meeting of an option at time `at` or later; -1: it is too late."""
    low, high = int(option[FIRST]), int(option[FIRST] + option[COUNT])
    end = high
    if option[ANY_TIME] > 0:
        return low if low < end else -1
    while low < high:
        middle = (low + high) // 2
        if meetings[middle, TIME] < at:
            low = middle + 1
        else:
            high = middle
    return low if low < end else -1


@kernel("float64(float64[::1], float64[::1], float64[::1], float64[::1], float64[::1], float64[::1])")
def _longest(
    q0: FloatArray, v0: FloatArray, q1: FloatArray, v1: FloatArray, velocity: FloatArray, rate: FloatArray
) -> float:
    """The least time in which all joints get from one state to the other, s."""
    found = 0.0
    for i in range(len(q0)):
        found = max(found, least_time(q1[i] - q0[i], v0[i], v1[i], velocity[i], rate[i]))
    return found


@kernel(
    "void(float64[:, ::1], float64[:, ::1], float64, float64[:, ::1], float64[:, ::1], float64[:, ::1],"
    " float64[:, ::1])",
    allocates=True,
)
def rough_motions(
    candidates: FloatArray,
    start: FloatArray,
    time: float,
    limits: FloatArray,
    options: FloatArray,
    meetings: FloatArray,
    motions: FloatArray,
) -> None:
    """Fills `motions` (N, OF_JOINT + n JOINT_COLUMNS) with the rough motions of `candidates` (N, FIRST_VIA + 2n).

    `start` (2, n): joints and velocities at `time`; `limits` (5, n); `options` (M, 3) and `meetings` (R, 1 + 2n). A
    motion that is not possible, because it meets its point no more, does not end where it should, or turns round beyond
    a limit, ends at infinity.
    """
    n = start.shape[1]
    q, qd = np.empty((SEGMENTS + 1, n)), np.empty((SEGMENTS + 1, n))
    v, a, mean = np.empty(n), np.empty(n), np.empty(n)
    for k in range(len(candidates)):
        row, motion = candidates[k], motions[k]
        option, vias = options[int(row[OPTION])], int(row[VIAS])
        segments, begin = vias + 1, time + row[WAIT]
        motion[BEGIN], motion[END] = begin, math.inf
        for i in range(n):
            v[i] = limits[VELOCITY, i] * math.sqrt(row[EFFORT])
            a[i] = limits[ACCELERATION, i] * row[EFFORT]
            mean[i] = v[i] / (v[i] / a[i] + a[i] / (limits[JERK, i] * row[EFFORT] ** 1.5))
            q[0, i], qd[0, i] = start[0, i], start[1, i]
            for via in range(vias):
                q[1 + via, i] = row[FIRST_VIA + via * n + i]
        at = next_meeting(meetings, option, -math.inf)
        if at < 0:
            continue
        for i in range(n):
            q[segments, i], qd[segments, i] = meetings[at, STATE + i], meetings[at, STATE + n + i]
        spent = 0.0
        for via in range(vias):
            passing_velocity(q[via], q[via + 1], q[via + 2], row[PACES + via], v, a, qd[via + 1])
            motion[DURATIONS + via] = _longest(q[via], qd[via], q[via + 1], qd[via + 1], v, mean)
            spent += motion[DURATIONS + via]
        last = _longest(q[vias], qd[vias], q[segments], qd[segments], v, mean)
        if not option[ANY_TIME] > 0:
            for _ in range(MEETINGS):
                at = next_meeting(meetings, option, begin + SAFETY_FACTOR * (spent + last) + row[LATE])
                if at < 0:
                    break
                for i in range(n):
                    q[segments, i], qd[segments, i] = meetings[at, STATE + i], meetings[at, STATE + n + i]
                last = _longest(q[vias], qd[vias], q[segments], qd[segments], v, mean)
            if at < 0:
                continue
            last = max(last, meetings[at, TIME] - begin - spent)
        motion[DURATIONS + vias] = last
        for segment in range(segments, SEGMENTS):
            motion[DURATIONS + segment] = 0.0
        possible = True
        for i in range(n):
            joint = motion[OF_JOINT + i * JOINT_COLUMNS : OF_JOINT + (i + 1) * JOINT_COLUMNS]
            joint[RATE] = mean[i]
            for station in range(SEGMENTS + 1):
                there = min(station, segments)
                joint[PLACES + station], joint[SPEEDS + station] = q[there, i], qd[there, i]
            for segment in range(SEGMENTS):
                joint[CRUISES + segment] = 0.0
            for segment in range(segments):
                q0, q1, v0, v1 = q[segment, i], q[segment + 1, i], qd[segment, i], qd[segment + 1, i]
                duration = motion[DURATIONS + segment]
                c = cruise(q1 - q0, v0, v1, mean[i], duration)
                joint[CRUISES + segment] = c
                ends = profile_at(q0, v0, v1, c, mean[i], duration, duration)
                possible = possible and abs(ends - q1) <= REACHED
                # where it turns round in its first and in its last ramp, with its own acceleration and jerk
                out, back = q0, q1
                if v0 * c < 0:
                    out += math.copysign(stopping_distance(abs(v0), limits[ACCELERATION, i], limits[JERK, i]), v0)
                if v1 * c < 0:
                    back -= math.copysign(stopping_distance(abs(v1), limits[ACCELERATION, i], limits[JERK, i]), v1)
                low, high = limits[LOWER, i], limits[UPPER, i]
                possible = possible and low <= out <= high and low <= back <= high
        if possible:
            motion[END] = begin + spent + last


@kernel("void(float64[:, ::1], int64[::1], float64[:, ::1], float64[:, :, ::1])")
def rough_positions(motions: FloatArray, which: IntArray, times: FloatArray, q: FloatArray) -> None:
    """Fills `q` (W, T, n): where the motions `which` (W,) are at `times` (W, T), s, standing before and after."""
    n = q.shape[2]
    for w in range(len(which)):
        motion = motions[which[w]]
        for k in range(times.shape[1]):
            segment, t = 0, max(times[w, k] - motion[BEGIN], 0.0)
            while segment < SEGMENTS - 1 and t >= motion[DURATIONS + segment]:
                t -= motion[DURATIONS + segment]
                segment += 1
            duration = motion[DURATIONS + segment]
            t = min(t, duration)
            for i in range(n):
                joint = motion[OF_JOINT + i * JOINT_COLUMNS : OF_JOINT + (i + 1) * JOINT_COLUMNS]
                q[w, k, i] = profile_at(
                    joint[PLACES + segment],
                    joint[SPEEDS + segment],
                    joint[SPEEDS + segment + 1],
                    joint[CRUISES + segment],
                    joint[RATE],
                    duration,
                    t,
                )
