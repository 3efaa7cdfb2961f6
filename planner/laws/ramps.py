"""Commanded changes of speed: a belt that stops and starts again, a dial that is slowed down."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from assur.planner.errors import InputError
from assur.planner.laws.validity import FURTHEST_S, LARGEST, float_in

TravelPiece = tuple[float, float, float, float, float]
"""When a piece begins, and travel, speed, acceleration and jerk then."""
SMALLEST = 1e-6
"""Least acceleration (and jerk) of a change, SI: below it the speed takes days to change."""
LARGEST_JERK = 1e9
"""Largest finite jerk of a change, SI: above it write infinity."""
SHORTEST_RAMP_S = 1e-5
"""A change of speed in less time is a jump, and no law may jump in velocity, s. Switches closer than this are merged
in a trajectory, so an arm could not follow it either."""


@dataclass(frozen=True, slots=True)
class Change:
    """From `time` (s) on, the speed changes to `speed` by an S-curve within `acceleration` and `jerk`.

    m/s, m/s², m/s³ for what travels; rad/s, rad/s², rad/s³ for what turns. An infinite jerk is allowed: the
    acceleration then jumps, and at the jump the later value is taken; an arm cannot follow that exactly.
    Raises `InputError` unless all are numbers and acceleration and jerk are positive.
    """

    time: float
    speed: float
    acceleration: float
    jerk: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "time", float_in(self.time, "change.time", -FURTHEST_S, FURTHEST_S))
        object.__setattr__(self, "speed", float_in(self.speed, "change.speed"))
        object.__setattr__(self, "acceleration", float_in(self.acceleration, "change.acceleration", SMALLEST, LARGEST))
        jerk = self.jerk if self.jerk == math.inf else float_in(self.jerk, "change.jerk", SMALLEST, LARGEST_JERK)
        object.__setattr__(self, "jerk", jerk)

    def phases(self, before: float) -> list[tuple[float, float, float]]:
        """The ramp from speed `before`, as (duration, acceleration at its begin, jerk) of each phase; [] if none.

        With Δ the change, A and J the limits (equation F7): tⱼ = A/J, tₐ = Δ/A − tⱼ if Δ ≥ A²/J, and else
        tⱼ = √(Δ/J), tₐ = 0; the phases are tⱼ with jerk J, tₐ with none and tⱼ with −J.
        """
        delta = abs(self.speed - before)
        sign = math.copysign(1.0, self.speed - before)
        if delta == 0.0:
            return []
        if self.jerk == math.inf:
            return [(delta / self.acceleration, sign * self.acceleration, 0.0)]
        rise = min(self.acceleration / self.jerk, math.sqrt(delta / self.jerk))
        level = max(0.0, delta / (self.jerk * rise) - rise) if rise > 0.0 else 0.0  # nothing is left of 5e-324 m/s
        peak = sign * self.jerk * rise
        middle = [(level, peak, 0.0)] if level > 0.0 else []
        return [(rise, 0.0, sign * self.jerk), *middle, (rise, peak, -sign * self.jerk)]


def ramped(speed: float, changes: Sequence[Change], at_time: float, field: str) -> list[TravelPiece]:
    """The travel of what has `speed` from the beginning and is given `changes`, zero at `at_time`, piece by piece.
    The first piece and the last one are at constant speed for ever.

    Raises `InputError` naming the change that begins before the one before it has ended, or that takes no time.
    """
    free = -math.inf
    changing: list[tuple[float, float, float, float]] = []
    first = speed
    for i, change in enumerate(changes):
        if not change.time >= free:
            allowed = f"{free} s or later: the change before ends then"
            raise InputError(f"{field}.changes[{i}].time", change.time, allowed)
        phases = change.phases(speed)
        took = sum(duration for duration, _, _ in phases)
        if phases and not took >= SHORTEST_RAMP_S:
            raise InputError(f"{field}.changes[{i}].acceleration", change.acceleration, "one that takes 10 µs at least")
        # Times are rounded. So that no later place is off by more and more, each phase reaches the speed which the ramp
        # has at its rounded end, `late` after its own, and the last one reaches exactly that of the change.
        time, late, here, end = change.time, 0.0, speed, speed
        for duration, acceleration, jerk in phases:
            begin, time = time, time + duration
            late += time - begin - duration
            end += duration * (acceleration + jerk * duration / 2)
            there = end + late * (acceleration + jerk * duration)
            if time > begin:
                changing.append((begin, here, (there - here) / (time - begin) - jerk * (time - begin) / 2, jerk))
                here = there
        if phases:
            begin, here, acceleration, jerk = changing[-1]
            changing[-1] = (begin, here, (change.speed - here) / (time - begin) - jerk * (time - begin) / 2, jerk)
            changing.append((time, change.speed, 0.0, 0.0))
        speed, free = change.speed, time
    ways, gone = [(changing[0][0] if changing else at_time, 0.0, first, 0.0, 0.0)], 0.0
    for time, speed, acceleration, jerk in changing:
        begin, _, *rates = ways[-1]
        gone += _gone(time - begin, *rates)
        ways.append((time, gone, speed, acceleration, jerk))
    begin, before, *rates = [ways[0], *(way for way in ways[1:] if way[0] <= at_time)][-1]
    zero = before + _gone(at_time - begin, *rates)
    return [(begin, gone - zero, v, a, j) for begin, gone, v, a, j in ways]


def _gone(h: float, speed: float, acceleration: float, jerk: float) -> float:
    """The travel in a time `h`, s."""
    return h * (speed + h * (acceleration / 2 + h * (jerk / 6)))
