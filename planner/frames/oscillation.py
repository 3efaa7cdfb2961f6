"""A shutter, a lift or a shaker that travels to and fro along a straight line."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.conveyor import travelling
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.swing import sine
from assur.planner.frames.validity import ALWAYS, KnownLaw, interval, number, placed, span

SHORTEST_DIRECTION = 1e-3
"""Least length of a direction (no unit): a shorter one was mistaken."""


@dataclass(frozen=True)
class Oscillation(KnownLaw):
    """A frame that travels by `amplitude` (m) to either side of `pose` along `direction` (3,); it does not turn.

    The direction is in world axes, and its length does not count. With u the unit vector along it and
    θ = 2π t/period + phase (equation F8): p = pose + amplitude sin θ u.
    Raises `InputError` for numbers that are not finite, a direction that is none, or a period that is not positive.
    """

    pose: Pose
    direction: tuple[float, float, float]
    amplitude: float
    period: float
    phase: float = 0.0
    valid: tuple[float, float] = ALWAYS
    along: FloatArray = field(init=False, repr=False, compare=False)
    """u (3,)."""

    def __post_init__(self) -> None:
        if len(self.direction) != 3:
            raise InputError("oscillation.direction", self.direction, "three numbers")
        direction = tuple(number(part, f"oscillation.direction[{i}]") for i, part in enumerate(self.direction))
        length = math.hypot(*direction)
        if not length >= SHORTEST_DIRECTION:
            allowed = f"a vector of length {SHORTEST_DIRECTION:g} or more"
            raise InputError("oscillation.direction", self.direction, allowed)
        object.__setattr__(self, "pose", placed(self.pose, "oscillation.pose"))
        object.__setattr__(self, "direction", direction)
        object.__setattr__(self, "amplitude", number(self.amplitude, "oscillation.amplitude"))
        object.__setattr__(self, "period", span(self.period, "oscillation.period"))
        object.__setattr__(self, "phase", number(self.phase, "oscillation.phase"))
        object.__setattr__(self, "valid", interval(self.valid, "oscillation.valid"))
        object.__setattr__(self, "along", np.array(direction) / length)

    def _motion(self, t: FloatArray, /) -> Motion:
        return travelling(self.pose, self.along, sine(self.amplitude, self.period, self.phase, t))
