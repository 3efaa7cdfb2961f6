"""A gate or an arm that swings to and fro about a vertical pivot."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.profile import Derivatives
from assur.planner.frames.turntable import turning
from assur.planner.frames.validity import ALWAYS, KnownLaw, interval, number, placed, span


@dataclass(frozen=True)
class Swing(KnownLaw):
    """A frame that turns in place about `pose`, its pivot and mean yaw, by `amplitude` (rad) to either side.

    With θ = 2π t/period + phase (equation F4): yaw = pose.yaw + amplitude sin θ. What turns on and on is a `Turntable`.
    Raises `InputError` for numbers that are not finite or a period that is not positive.
    """

    pose: Pose
    amplitude: float
    period: float
    phase: float = 0.0
    valid: tuple[float, float] = ALWAYS

    def __post_init__(self) -> None:
        object.__setattr__(self, "pose", placed(self.pose, "swing.pose"))
        object.__setattr__(self, "amplitude", number(self.amplitude, "swing.amplitude"))
        object.__setattr__(self, "period", span(self.period, "swing.period"))
        object.__setattr__(self, "phase", number(self.phase, "swing.phase"))
        object.__setattr__(self, "valid", interval(self.valid, "swing.valid"))

    def _motion(self, t: FloatArray, /) -> Motion:
        return turning(self.pose, sine(self.amplitude, self.period, self.phase, t))


def sine(amplitude: float, period: float, phase: float, t: FloatArray) -> Derivatives:
    """amplitude · sin(2π t/period + phase) with its first three derivatives at times `t` (...), s."""
    w = 2.0 * math.pi / period
    theta = w * t + phase
    value, cosine = amplitude * np.sin(theta), amplitude * np.cos(theta)
    return value, w * cosine, -(w**2) * value, -(w**3) * cosine
