"""How fast joint legs may go, and who times them: all joints together or, over an arch, the lift apart from the others.

A pace is made once for many legs: limits are looked at once, and the solvers stay.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from assur.planner.errors import FaultError
from assur.planner.robots.facts import Limits
from assur.planner.timing import Numbers, Solver


@dataclass(frozen=True, eq=False)
class Pace:
    """The robot's `limits` at this `effort`: the share of the acceleration limits that is used (of velocity its root,
    of jerk its power of 3/2). `pull`: share of the acceleration that the joints across use of that.
    `lift_joint`: the number of the joint that lifts; None: no arches. `lift_effort`: its own, and `lift_most`: the
    acceleration, m/s², that it keeps to."""

    limits: Limits
    lift_joint: int | None
    effort: float = 1.0
    lift_effort: float | None = None
    lift_most: float = math.inf
    pull: float = 1.0

    @cached_property
    def rates(self) -> Numbers:
        """Limits of velocity, acceleration and jerk, a number a joint."""
        limits, effort = self.limits, np.full(len(self.limits.velocity), self.effort)
        if self.lift_joint is not None and self.lift_effort is not None:
            effort[self.lift_joint] = self.lift_effort
        rates = limits.velocity * effort**0.5, limits.acceleration * effort, limits.jerk * effort**1.5
        velocity, acceleration, jerk = (rate.tolist() for rate in rates)
        acceleration = [self.pull * each for each in acceleration]
        if self.lift_joint is not None:
            acceleration[self.lift_joint] /= self.pull
            acceleration[self.lift_joint] = min(acceleration[self.lift_joint], self.lift_most)
        return velocity, acceleration, jerk

    @cached_property
    def lift(self) -> list[int]:
        """The number of the lift joint, alone in a list."""
        if self.lift_joint is None:
            raise FaultError("an arch needs a lift joint")
        return [self.lift_joint]

    @cached_property
    def others(self) -> list[int]:
        """Numbers of the joints that go across."""
        return [i for i in range(len(self.limits.velocity)) if i != self.lift_joint]

    @cached_property
    def together(self) -> Solver:
        """Times all joints."""
        return Solver(*self.rates)

    @cached_property
    def lifting(self) -> Solver:
        """Times the lift joint alone."""
        return Solver(*part(self.rates, self.lift))

    @cached_property
    def across(self) -> Solver:
        """Times the others."""
        return Solver(*part(self.rates, self.others))


def part(rows: Numbers, joints: list[int]) -> Numbers:
    """The numbers of some joints."""
    first, second, third = ([row[i] for i in joints] for row in rows)
    return first, second, third
