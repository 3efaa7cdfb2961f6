"""The door to Ruckig: time-optimal jerk-limited motion from state to state. No other module imports it.

What its traps are and how they are met (numbers of the hazards' list):

R1  Intermediate positions are sent to a cloud service over plain HTTP: never set.
R2  Errors of 6 to 11 % in millimetres, none in SI: SI only.
R3  Residual velocities of 1e-14 fail its root finding: below `RESIDUAL` the solver is given zero; failures are values.
R4  Two result codes are missing from its enum and come as ValueError: caught like its own error.
R5  A NaN or negative minimum duration is ignored, a too short one replaced: checked before and after.
R6  A state outside the limits is accepted: refused before.
R7  Motions of any length are answered: refused beyond `LONGEST`.
R8  Vectors of the wrong length read foreign memory: lengths checked here.
R9  Positions overshoot when ends move, and there are no position limits: for the caller to check, on extrema.
R10 Infinite limits switch to another family of profiles: finite limits only.
R12 It holds the GIL: processes, never threads. Objects are new at every call (2 µs): nothing is left from the last one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import accumulate
from typing import Any

import numpy as np
import ruckig

from planner.arrays import FloatArray
from planner.timing.ends import Cubics, missed
from planner.timing.profile import Profile
from planner.timing.question import Limits, TimingRefusal, accepted, lowered_limits
from planner.timing.sketch import Settled, Sketch
from planner.timing.straight import straight

RESIDUAL = 1e-9
"""rad/s, m/s, rad/s², m/s². Slower than this counts as at rest for the solver; the end states stay as asked."""
LONGEST = 600.0
"""s. No motion of a cell's robot takes ten minutes; beyond 7600 s the solver answers nonsense."""
DURATION_TOLERANCE = 1e-11
"""s. A duration is met when the solver keeps it to this: a hundred times its rounding, and 1e-7 rad/s² of end state."""
BRIEF = 0.05
"""s. Shorter motions from rest to rest go straight if that takes no longer: the solver's switches, each joint having
its own, then crowd within microseconds once in a thousand times, and knots cannot follow them."""
SHORTEST = 1e-3
"""s. What the fastest motion from rest to rest takes at least, also that to where the arm is: a controller's cycle. A
goal that differs from the start by rounding would otherwise take a microsecond, too short for knots."""
RETRIES = (1.0, 0.99, 0.95)
"""Factors on the solver's jerk limit, tried in turn when its root finding fails on a legal problem."""


def time_joints(
    q0: FloatArray,
    v0: FloatArray,
    a0: FloatArray,
    q1: FloatArray,
    v1: FloatArray,
    a1: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray,
    duration: float | None = None,
) -> Profile | TimingRefusal:
    """The fastest motion from state 0 to state 1 in which all joints arrive together, or the one of `duration`.

    The limits are the robot's own: the solver is given `JERK_RESERVE` and `RATE_RESERVE` less, so that the spline
    through the knots keeps them, but never less than what the two states need.

    Arguments: positions, velocities, accelerations of n joints, each (n,), rad or m, and symmetric limits (n,);
    `duration` in s or None. From rest to rest the fastest motion takes `SHORTEST` at least. Positions may leave the box
    of start and goal: not checked here, like every position limit.

    Raises `InputError` for lengths that differ, numbers that are not finite, limits that are not positive, a negative
    duration. Source: Berscheid and Kröger, Jerk-limited Real-time Trajectory Generation with Arbitrary Target States
    (RSS 2021), by way of the library `ruckig`.
    """
    found = sketch_joints(q0, v0, a0, q1, v1, a1, velocity, acceleration, jerk, duration)
    return found if isinstance(found, TimingRefusal) else found.profile


def sketch_joints(
    q0: FloatArray,
    v0: FloatArray,
    a0: FloatArray,
    q1: FloatArray,
    v1: FloatArray,
    a1: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray,
    duration: float | None = None,
) -> Sketch | Settled | TimingRefusal:
    """`time_joints` without the profile, which is made when it is asked for: candidates are looked at first."""
    rows = accepted((q0, v0, a0, q1, v1, a1, velocity, acceleration, jerk), duration)
    if duration is not None and not duration <= LONGEST:
        return TimingRefusal("too long", duration - LONGEST, f"{duration} s asked, {LONGEST} s allowed")
    lowered = lowered_limits(rows)
    if isinstance(lowered, TimingRefusal):
        return lowered
    found = _solve(rows, lowered, duration)
    if isinstance(found, TimingRefusal):
        return found
    if found.duration < BRIEF and _at_rest(rows):
        brief = straight(rows[0], rows[3], lowered, max(found.duration, SHORTEST) if duration is None else duration)
        if brief is not None:
            return Settled(brief)
    return _read(found.profiles[0], rows, lowered, found.duration if duration is None else duration)


def shortest_duration(
    q0: FloatArray,
    v0: FloatArray,
    a0: FloatArray,
    q1: FloatArray,
    v1: FloatArray,
    a1: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray,
) -> float | TimingRefusal:
    """How long the fastest motion takes, s: `time_joints` without reading the profile, in a fifth of its time."""
    rows = accepted((q0, v0, a0, q1, v1, a1, velocity, acceleration, jerk), None)
    lowered = lowered_limits(rows)
    if isinstance(lowered, TimingRefusal):
        return lowered
    found = _solve(rows, lowered, None)
    if isinstance(found, TimingRefusal):
        return found
    return max(found.duration, SHORTEST) if _at_rest(rows) else float(found.duration)


def _solve(rows: list[list[float]], lowered: Limits, duration: float | None) -> Any:
    """The solver's trajectory, or a `TimingRefusal`. (The library ships no types.)"""
    n = len(rows[0])
    solver, given, found = ruckig.Ruckig(n), ruckig.InputParameter(n), ruckig.Trajectory(n)
    given.current_position, given.target_position = rows[0], rows[3]
    given.current_velocity, given.current_acceleration = _still(rows[1]), _still(rows[2])
    given.target_velocity, given.target_acceleration = _still(rows[4]), _still(rows[5])
    given.max_velocity, given.min_velocity = lowered.velocity, lowered.backward
    given.max_acceleration, given.min_acceleration = lowered.acceleration, lowered.braking
    given.minimum_duration = duration
    failure = ""
    for factor in RETRIES:
        given.max_jerk = [j * factor for j in lowered.jerk]
        try:
            solver.validate_input(given, True, True)
            result = solver.calculate(given, found)
        except (ruckig.RuckigError, ValueError) as error:
            failure = str(error).strip()
            continue
        good = result in (ruckig.Result.Working, ruckig.Result.Finished)
        if good and math.isfinite(found.duration) and found.duration >= 0:
            return _unfit(found, duration) or found
        failure = f"{result}"
    return TimingRefusal("no profile", math.nan, failure.splitlines()[0] if failure else "")


def _unfit(found: Any, duration: float | None) -> TimingRefusal | None:
    """Why the duration found is not the one asked for, or too long."""
    if duration is not None and not found.duration <= duration + DURATION_TOLERANCE:
        least = max(found.independent_min_durations)
        return TimingRefusal(
            "blocked" if least <= duration else "too short",
            found.duration - duration,
            f"{duration} s asked, joints alone take {least} s, together the next possible is {found.duration} s",
        )
    if not found.duration <= LONGEST:
        return TimingRefusal("too long", found.duration - LONGEST, f"takes {found.duration} s, {LONGEST} s allowed")
    return None


def _at_rest(rows: list[list[float]]) -> bool:
    return not any(map(any, (rows[1], rows[2], rows[4], rows[5])))


def _still(row: list[float]) -> list[float]:
    return [x if abs(x) >= RESIDUAL else 0.0 for x in row]


def _read(joints: Sequence[Any], rows: list[list[float]], lowered: Limits, duration: float) -> Sketch | TimingRefusal:
    """The solver's phases, brake phases included."""
    braked = any(joint.brake.duration > 0 for joint in joints)
    cubics = []
    for number, joint in enumerate(joints):
        t, p, v, a, j = joint.t, joint.p, joint.v, joint.a, joint.j
        if braked:
            brake = joint.brake
            t, p, v, a, j = brake.t + t, brake.p + p, brake.v + v, brake.a + a, brake.j + j
        # The solver lets a joint that is there early go on with constant acceleration: one more phase.
        most = max(lowered.acceleration[number], -lowered.braking[number])
        cubic = Cubics([0.0, *accumulate(t)], p, v, a, [*j, 0.0], most, lowered.jerk[number])
        miss = missed(cubic, (rows[3][number], rows[4][number], rows[5][number]), duration)
        if not miss <= 1:
            return TimingRefusal("unsound", miss, f"the solver misses the goal of joint {number}")
        cubics.append(cubic)
    ends = np.array(rows[:6])
    return Sketch(duration, (ends[0], ends[1], ends[2]), (ends[3], ends[4], ends[5]), tuple(cubics))
