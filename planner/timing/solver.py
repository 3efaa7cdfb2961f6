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
R12 It holds the GIL: processes, never threads. A `Solver` keeps the library's objects, of which making takes as long as
    a question from rest to rest: every field that is ever set is set anew at every call, and answers are never shared.
R13 Asked for the state at a time that is not a number it reads foreign memory, or dies: only finite ones are asked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

import ruckig

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.timing.ends import Cubics, aside
from assur.planner.timing.profile import Profile
from assur.planner.timing.question import (
    STATE_NAMES,
    Allowed,
    Limits,
    Numbers,
    Row,
    TimingRefusal,
    accepted,
    accepted_duration,
    lowered_limits,
    numbers,
)
from assur.planner.timing.sketch import Settled, Sketch
from assur.planner.timing.straight import straight

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
    q0_, v0_, a0_, q1_, v1_, a1_, *limits = numbers((q0, v0, a0, q1, v1, a1, velocity, acceleration, jerk))
    found = Solver(*limits).sketch((q0_, v0_, a0_), (q1_, v1_, a1_), duration)
    return found if isinstance(found, TimingRefusal) else found.profile


class Solver:
    """Ruckig for n joints with symmetric limits of n numbers each, which are accepted once.

    Raises `InputError` for limits that are not positive finite numbers of one length, and by its methods for states
    that are not n finite numbers.
    """

    def __init__(self, velocity: Row, acceleration: Row, jerk: Row) -> None:
        self._allowed = Allowed(velocity, acceleration, jerk)
        self._n = len(velocity)
        self._ruckig, self._given = ruckig.Ruckig(self._n), ruckig.InputParameter(self._n)

    def sketch(self, start: Numbers, goal: Numbers, duration: float | None = None) -> Sketch | Settled | TimingRefusal:
        """`time_joints` without the profile, which is made when it is asked for: candidates are looked at first."""
        accepted_duration(duration)
        lowered = self._lowered(start, goal)
        if duration is not None and not duration <= LONGEST:
            return TimingRefusal("too long", duration - LONGEST, f"{duration} s asked, {LONGEST} s allowed")
        if isinstance(lowered, TimingRefusal):
            return lowered
        found = self._solve(start, goal, lowered, duration)
        if isinstance(found, TimingRefusal):
            return found
        if found.duration < BRIEF and _at_rest(start, goal):
            brief = straight(
                start[0], goal[0], lowered, max(found.duration, SHORTEST) if duration is None else duration
            )
            if brief is not None:
                return Settled(brief)
        taken = float(found.duration) if duration is None else duration
        for number, ends in enumerate(zip(*found.at_time(taken), *goal, strict=True)):
            miss = aside(*ends)
            if not miss <= 1:
                return TimingRefusal("unsound", miss, f"the solver misses the goal of joint {number}")
        return Sketch(taken, start, goal, _Solved(found, lowered))

    def shortest(self, start: Numbers, goal: Numbers) -> float | TimingRefusal:
        """How long the fastest motion takes, s: the duration of `sketch`."""
        lowered = self._lowered(start, goal)
        if isinstance(lowered, TimingRefusal):
            return lowered
        found = self._solve(start, goal, lowered, None)
        if isinstance(found, TimingRefusal):
            return found
        return max(found.duration, SHORTEST) if _at_rest(start, goal) else float(found.duration)

    def _lowered(self, start: Numbers, goal: Numbers) -> Limits | TimingRefusal:
        accepted(STATE_NAMES, (*start, *goal), self._n)
        return lowered_limits(start, goal, self._allowed)

    def _solve(self, start: Numbers, goal: Numbers, lowered: Limits, duration: float | None) -> Any:
        """The solver's trajectory, or a `TimingRefusal`. (The library ships no types.)"""
        given, found = self._given, ruckig.Trajectory(self._n)
        given.current_position, given.target_position = start[0], goal[0]
        given.current_velocity, given.current_acceleration = _still(start[1]), _still(start[2])
        given.target_velocity, given.target_acceleration = _still(goal[1]), _still(goal[2])
        given.max_velocity, given.min_velocity = lowered.velocity, lowered.backward
        given.max_acceleration, given.min_acceleration = lowered.acceleration, lowered.braking
        given.minimum_duration = duration
        failure = ""
        for factor in RETRIES:
            given.max_jerk = [j * factor for j in lowered.jerk]
            try:
                self._ruckig.validate_input(given, True, True)
                result = self._ruckig.calculate(given, found)
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


def _at_rest(start: Numbers, goal: Numbers) -> bool:
    return not (any(start[1]) or any(start[2]) or any(goal[1]) or any(goal[2]))


def _still(row: Row) -> Row:
    return [x if abs(x) >= RESIDUAL else 0.0 for x in row] if any(row) else row


@dataclass(frozen=True, slots=True, eq=False)
class _Solved:
    """An answer of the solver to the limits that it was given."""

    found: Any
    lowered: Limits

    def positions(self, times: list[float]) -> list[Row]:
        # R13; the sum is finite only if every time is
        if not math.isfinite(sum(times)):
            raise FaultError("a motion has positions at finite times only")
        at = self.found.at_time
        return [at(t)[0] for t in times]

    def cubics(self) -> list[Cubics]:
        """The solver's phases, brake phases included."""
        joints = self.found.profiles[0]
        braked = any(joint.brake.duration > 0 for joint in joints)
        cubics = []
        for number, joint in enumerate(joints):
            t, p, v, a, j = joint.t, joint.p, joint.v, joint.a, joint.j
            if braked:
                brake = joint.brake
                t, p, v, a, j = brake.t + t, brake.p + p, brake.v + v, brake.a + a, brake.j + j
            # The solver lets a joint that is there early go on with constant acceleration: one more phase.
            most = max(self.lowered.acceleration[number], -self.lowered.braking[number])
            cubics.append(Cubics([0.0, *accumulate(t)], p, v, a, [*j, 0.0], most, self.lowered.jerk[number]))
        return cubics
