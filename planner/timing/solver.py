"""The entry to Ruckig: time-optimal jerk-limited motion from state to state. No other module imports it.

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
R11 It promises to end within 1e-8 of its goal: the phases are summed up here, and a miss is refused.
R12 It holds the GIL: processes, never threads. A `Solver` keeps the library's objects: to make them takes as long as a
    motion from rest to rest: every field that is ever set is set anew at every call, and answers are never shared.
R13 At a time that is not a number it reads foreign memory, or dies: no state is read from it, only its phases.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import ruckig

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError, InputError
from assur.planner.kernels.knots import knots_of_phases, missed_goal
from assur.planner.trajectory import Trajectory

# What the solver is given, made legal: finite vectors of one length, states within limits, limits lowered.

JERK_RESERVE = 0.02
"""Fraction of the jerk limit that the solver does not get: merged switches and rounding took up to 0.006 in
150,000 random motions (see `kernels.knots`)."""
RATE_RESERVE = 1e-3
"""Fraction of the velocity and acceleration limits that the solver does not get, likewise."""
RAMP_S = 1e-3
"""s. The solver gets no more jerk than reaches the limit of acceleration, or by way of it that of velocity, in this
time: a controller's cycle. Shorter phases would share a knot, and their acceleration would be lost (`kernels.knots`). A
motion takes a few milliseconds more at most; robots need some 20 ms for either."""
LIMIT_TOLERANCE = 1e-9
"""Relative. States up to this beyond a limit count as at the limit: the tolerance of the trajectory's own check."""

Reason = Literal["limits", "too short", "blocked", "too long", "no profile", "unsound"]


@dataclass(frozen=True, slots=True)
class TimingRefusal:
    """Why there is no motion as required.

    limits      a given state is, or will inevitably come, beyond a limit; `excess` relative to it
    too short   the earliest motion takes `excess` seconds longer than allowed
    blocked     shorter motions exist, but the next possible duration is `excess` seconds above the required one
    too long    it takes more than `LONGEST`; `excess` in seconds
    no profile  the solver found none for a legal problem; `excess` is NaN
    unsound     its profile does not end where it should; `excess` is how far, in units of what is allowed
    """

    reason: Reason
    excess: float
    detail: str


@dataclass(frozen=True, slots=True)
class SolverLimits:
    """What the solver is given, n numbers each: the most and the least velocity and acceleration, and the jerk."""

    velocity: list[float]
    backward: list[float]
    acceleration: list[float]
    braking: list[float]
    jerk: list[float]


@dataclass(frozen=True, slots=True)
class RobotLimits:
    """The robot's own limits, n finite positive numbers each, and `lowered`: what the solver gets of them at least.

    Raises `InputError` for limits that are none, or of different length.
    """

    velocity: list[float]
    acceleration: list[float]
    jerk: list[float]
    lowered: SolverLimits = field(init=False)

    def __post_init__(self) -> None:
        accepted(LIMIT_NAMES, (self.velocity, self.acceleration, self.jerk), len(self.velocity))
        for name, row in zip(LIMIT_NAMES, (self.velocity, self.acceleration, self.jerk), strict=True):
            if not min(row) > 0:
                raise InputError(f"timing.{name}", row, "positive limits")
        velocity = [v * (1 - RATE_RESERVE) for v in self.velocity]
        acceleration = [a * (1 - RATE_RESERVE) for a in self.acceleration]
        rates = zip(self.jerk, acceleration, velocity, strict=True)
        jerk = [min(j * (1 - JERK_RESERVE), a / RAMP_S, v / RAMP_S**2) for j, a, v in rates]
        lowered = SolverLimits(velocity, [-v for v in velocity], acceleration, [-a for a in acceleration], jerk)
        object.__setattr__(self, "lowered", lowered)


STATE_NAMES = ("q0", "v0", "a0", "q1", "v1", "a1")
LIMIT_NAMES = ("velocity", "acceleration", "jerk")

Row = list[float]
Numbers = tuple[Row, Row, Row]
"""q, q̇, q̈, n numbers each: for four joints NumPy takes three times as long."""


def accepted(names: Sequence[str], rows: Sequence[Row], n: int) -> None:
    """Accepts rows of n finite numbers each; `InputError` naming the first that is not."""
    # a sum is finite only if every number is
    if n > 0 and set(map(len, rows)) == {n} and math.isfinite(sum(map(sum, rows))):
        return
    for name, row in zip(names, rows, strict=True):
        if not (len(row) == n > 0 and math.isfinite(sum(row))):
            raise InputError(f"timing.{name}", row, f"{n or 'some'} finite numbers")


def lowered_limits(start: Numbers, goal: Numbers, allowed: RobotLimits) -> SolverLimits | TimingRefusal:
    """Limits for the solver: lowered, but never below what the end states need, each direction by itself.

    A state with acceleration a comes to the velocity v ± a|a|/(2j) whatever one does (equation P2: + after the start,
    − before the goal). A state that needs the whole jerk limit for that gets it.
    """
    (_, v0, a0), (_, v1, a1), usual = start, goal, allowed.lowered
    if _at_rest(start, goal):
        return usual
    # whether both states, and what they lead to (equation P6), are within the lowered limits: nearly always
    ease = [
        -a <= a0 <= a and -a <= a1 <= a and -v <= v0 <= v and -v <= v1 <= v
        and -v <= v0 + a0 * abs(a0) / (2 * j) <= v and -v <= v1 - a1 * abs(a1) / (2 * j) <= v
        for v0, a0, v1, a1, v, a, j in zip(
            v0, a0, v1, a1, usual.velocity, usual.acceleration, usual.jerk, strict=True
        )
    ]  # fmt: skip
    if all(ease):
        return usual
    rows = list[tuple[float, ...]]()
    for i, (v, a, j) in enumerate(zip(allowed.velocity, allowed.acceleration, allowed.jerk, strict=True)):
        lowered_v, lowered_a, lowered_j = usual.velocity[i], usual.acceleration[i], usual.jerk[i]
        if ease[i]:
            rows.append((lowered_v, -lowered_v, lowered_a, -lowered_a, lowered_j))
            continue
        need_a = (0.0, a0[i], a1[i])
        worst = max(map(abs, need_a))
        if not worst <= a * (1 + LIMIT_TOLERANCE):
            return TimingRefusal("limits", worst / a - 1, f"joint {i}: acceleration {worst}, limit {a}")
        for given_j in (lowered_j, j):
            after = v0[i] + a0[i] * abs(a0[i]) / (2 * given_j)
            before = v1[i] - a1[i] * abs(a1[i]) / (2 * given_j)
            need_v = (0.0, v0[i], v1[i], after, before)
            worst = max(map(abs, need_v))
            if worst <= v * (1 + LIMIT_TOLERANCE):
                break
        else:
            return TimingRefusal("limits", worst / v - 1, f"joint {i}: velocity comes to {worst}, limit {v}")
        # The solver compares without tolerance: a few roundings more than is needed.
        needs = [end * (1 + 1e-14) for end in (max(need_v), min(need_v), max(need_a), min(need_a))]
        forward, pull = max(lowered_v, needs[0]), max(lowered_a, needs[2])
        rows.append((forward, min(-lowered_v, needs[1]), pull, min(-lowered_a, needs[3]), given_j))
    return SolverLimits(*map(list, zip(*rows, strict=True)))


# A timed motion as the solver gave it, phases of constant jerk a joint; and the trajectory that is made of several.


@dataclass(frozen=True, slots=True, eq=False)
class RawProfile:
    """Motion of n joints over [0, `duration`] s from the state `begin` to `goal`, which the phases all but meet.

    `phases` (n, 2, S): durations in s and jerks of each joint, from 0 on. A joint whose phases end before the duration
    goes on with constant acceleration.
    """

    duration: float
    begin: Numbers
    goal: Numbers
    phases: FloatArray

    @property
    def parts(self) -> Sequence[RawProfile]:
        """Profiles in a row that are the same motion, whose ends it passes exactly: itself."""
        return (self,)

    def at(self, t: float) -> Numbers:
        """q, q̇, q̈ after t s, as sums over the phases."""
        rows: Numbers = [], [], []
        for q, v, a, (lengths, jerks) in zip(*self.begin, self.phases.tolist(), strict=True):
            left = t
            for length, j in [*zip(lengths, jerks, strict=True), (math.inf, 0.0)]:
                h = min(length, left)
                if h > 0.0:
                    q, v, a = q + h * (v + h * (a / 2 + h * j / 6)), v + h * (a + h * j / 2), a + h * j
                    left -= h
            for row, value in zip(rows, (q, v, a), strict=True):
                row.append(value)
        return rows


def trajectory_of(profiles: Sequence[RawProfile], begins: Sequence[float]) -> Trajectory:
    """The trajectory of profiles in a row (equations T4 and T5), which repeats the states between them to the bit.

    `begins`: when each of them begins, and when the last one ends, s, increasing. Whether it keeps any limits is for
    the caller to check: merged switches and exact ends cost one in a thousand motions more than the reserves.

    Raises `FaultError` for times that do not increase.
    """
    times, parts = [begins[0]], list[RawProfile]()
    for profile, begin, end in zip(profiles, begins[:-1], begins[1:], strict=True):
        if not begin < end:
            raise FaultError(f"profiles that begin at {list(begins)} s")
        for part in profile.parts:
            parts.append(part)
            times.append(times[-1] + part.duration)
        times[-1] = end
    states = [parts[0].begin]
    if len(parts) == 1:
        phases = parts[0].phases[None]
        states.append(parts[0].goal)
    else:
        n, most = len(parts[0].phases), max([part.phases.shape[2] for part in parts])
        phases = np.zeros((len(parts), n, 2, most))
        for row, part in zip(phases, parts, strict=True):
            row[:, :, : part.phases.shape[2]] = part.phases
            states.append(part.goal)
    return Trajectory.of_knots(knots_of_phases(np.array(times), np.array(states), phases))


RESIDUAL = 1e-9
"""rad/s, m/s, rad/s², m/s². Slower than this counts as at rest for the solver; the end states stay as given."""
LONGEST = 600.0
"""s. No motion of a cell's robot takes ten minutes; beyond 7600 s the solver answers nonsense."""
DURATION_TOLERANCE = 1e-11
"""s. A duration is met when the solver keeps it to this: a hundred times its rounding, and 1e-7 rad/s² of end state."""
SHORTEST = 1e-3
"""s. What the fastest motion from rest to rest takes at least, also that to where the arm is: a controller's cycle. A
goal that differs from the start by rounding would otherwise take a microsecond, too short for knots."""
ONE_QUINTIC = 1.25e-3
"""s. How long what would take less than `SHORTEST` takes: one quintic instead of phases that the solver knows to 1e-9
rad, which is a jerk of 60 rad/s³ over a millisecond. The jerk of a quintic asks for (60/32)^⅓ = 1.233 times as long."""
RETRIES = (1.0, 0.99, 0.95)
"""Factors on the solver's jerk limit, tried in turn when its root finding fails on a legal problem."""
END_POSITION, END_VELOCITY, END_ACCELERATION = 1e-7, 1e-7, 1e-6
"""rad or m, and s. What the solver may miss an end state by: it promises 1e-8; more cannot be trusted."""


def fastest_motion(start: Numbers, goal: Numbers, limits: Numbers, begin: float = 0.0) -> Trajectory | TimingRefusal:
    """The fastest motion from one state to another in which all joints arrive together, from `begin`, s, on.

    The limits of velocity, acceleration and jerk are the robot's own: the solver is given `JERK_RESERVE` and
    `RATE_RESERVE` less, so that the spline through the knots keeps them in all but one of some thousand motions, but
    never less than what the two states need. From rest to rest a motion takes `SHORTEST` at least. Positions may leave
    the box of start and goal: not checked here, like every position limit.

    Raises `InputError` for lengths that differ, numbers that are not finite, limits that are not positive. Source:
    Berscheid and Kröger, Jerk-limited Real-time Trajectory Generation with Arbitrary Target States (RSS 2021), by way
    of the library `ruckig`.
    """
    found = Solver(*limits).raw_profile(start, goal)
    return found if isinstance(found, TimingRefusal) else trajectory_of([found], [begin, begin + found.duration])


class Solver:
    """Ruckig for n joints with symmetric limits of n numbers each, which are accepted once.

    Raises `InputError` for limits that are not positive finite numbers of one length, and by its methods for states
    that are not n finite numbers.
    """

    def __init__(self, velocity: Row, acceleration: Row, jerk: Row) -> None:
        self._allowed = RobotLimits(velocity, acceleration, jerk)
        self._n = len(velocity)
        self._ruckig, self._given = ruckig.Ruckig(self._n), ruckig.InputParameter(self._n)

    def raw_profile(self, start: Numbers, goal: Numbers, duration: float | None = None) -> RawProfile | TimingRefusal:
        """The fastest motion, or the one of `duration`, s."""
        if duration is not None and not 0.0 <= duration < math.inf:
            raise InputError("timing.duration", duration, "None, or a number of seconds from 0")
        if duration is not None and not duration <= LONGEST:
            accepted(STATE_NAMES, (*start, *goal), self._n)
            excess = duration - LONGEST
            return TimingRefusal("too long", excess, f"{duration} s are required, {LONGEST} s are allowed")
        found = self._solve(start, goal, duration)
        if isinstance(found, TimingRefusal):
            return found
        if duration is None and found.duration < SHORTEST and _at_rest(start, goal):
            return RawProfile(ONE_QUINTIC, start, goal, np.zeros((self._n, 2, 1)))
        taken = float(found.duration) if duration is None else duration
        # durations and jerks (n, 2, 9) of the phases, brake phases first; that they end where they should is checked
        joints = [(joint.brake.t + joint.t, joint.brake.j + joint.j) for joint in found.profiles[0]]
        phases, (begin, end) = np.array(joints), np.array([start, goal])
        miss = missed_goal(begin, end, phases, taken, END_POSITION, END_VELOCITY, END_ACCELERATION)
        if not miss <= 1:
            return TimingRefusal("unsound", miss, "the solver misses its goal")
        return RawProfile(taken, start, goal, phases)

    def shortest(self, start: Numbers, goal: Numbers) -> float | TimingRefusal:
        """How long the fastest motion takes, s: the duration of `raw_profile`."""
        found = self._solve(start, goal, None)
        if isinstance(found, TimingRefusal):
            return found
        brief = found.duration < SHORTEST and _at_rest(start, goal)
        return ONE_QUINTIC if brief else float(found.duration)

    def _solve(self, start: Numbers, goal: Numbers, duration: float | None) -> Any:
        """The solver's trajectory, or a `TimingRefusal`. (The library ships no types.)"""
        accepted(STATE_NAMES, (*start, *goal), self._n)
        lowered = lowered_limits(start, goal, self._allowed)
        if isinstance(lowered, TimingRefusal):
            return lowered
        given, found = self._given, ruckig.Trajectory(self._n)
        given.current_position, given.target_position = start[0], goal[0]
        rates, n = (*start[1], *start[2], *goal[1], *goal[2]), self._n
        if any(rates):
            rates = tuple([x if abs(x) >= RESIDUAL else 0.0 for x in rates])
        given.current_velocity, given.current_acceleration = rates[:n], rates[n : 2 * n]
        given.target_velocity, given.target_acceleration = rates[2 * n : 3 * n], rates[3 * n :]
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
                fits = found.duration <= (LONGEST if duration is None else duration + DURATION_TOLERANCE)
                return found if fits else _unfit(found, duration)
            failure = f"{result}"
        return TimingRefusal("no profile", math.nan, failure.splitlines()[0] if failure else "")


def _unfit(found: Any, duration: float | None) -> TimingRefusal:
    """Why the duration found is not the one required, or is too long."""
    if duration is None:
        return TimingRefusal("too long", found.duration - LONGEST, f"takes {found.duration} s, {LONGEST} s allowed")
    least = max(found.independent_min_durations)
    return TimingRefusal(
        "blocked" if least <= duration else "too short",
        found.duration - duration,
        f"{duration} s required, joints alone take {least} s, together the next possible is {found.duration} s",
    )


def _at_rest(start: Numbers, goal: Numbers) -> bool:
    return not (any(start[1]) or any(start[2]) or any(goal[1]) or any(goal[2]))
