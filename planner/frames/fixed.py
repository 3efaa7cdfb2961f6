"""Frames that stand still, and bodies that drift along a straight line."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.law import Frame
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.validity import ALWAYS, FURTHEST_S, KnownLaw, interval, number, placed


@dataclass(frozen=True)
class Fixed(KnownLaw):
    """A frame that stands at `pose`. Raises `InputError` for a pose that is not finite."""

    pose: Pose
    valid: tuple[float, float] = ALWAYS

    def __post_init__(self) -> None:
        object.__setattr__(self, "pose", placed(self.pose, "fixed.pose"))
        object.__setattr__(self, "valid", interval(self.valid, "fixed.valid"))

    def _motion(self, t: FloatArray, /) -> Motion:
        return Motion.still(self.pose, t.shape)


def all_stand(frames: Iterable[Frame]) -> bool:
    """Whether none of the frames moves."""
    return all(isinstance(frame.law, Fixed) for frame in frames)


@dataclass(frozen=True)
class Linear(KnownLaw):
    """A frame that moves with the constant `velocity` (3,) m/s and is at `pose` at `at_time`; it does not turn.

    p = p0 + v (t − at_time). Raises `InputError` for numbers that are not finite.
    """

    pose: Pose
    velocity: tuple[float, float, float]
    at_time: float = 0.0
    valid: tuple[float, float] = ALWAYS
    _velocity: FloatArray = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if len(self.velocity) != 3:
            raise InputError("linear.velocity", self.velocity, "three numbers")
        velocity = tuple(number(part, f"linear.velocity[{i}]") for i, part in enumerate(self.velocity))
        object.__setattr__(self, "pose", placed(self.pose, "linear.pose"))
        object.__setattr__(self, "velocity", velocity)
        object.__setattr__(self, "at_time", number(self.at_time, "linear.at_time", -FURTHEST_S, FURTHEST_S))
        object.__setattr__(self, "valid", interval(self.valid, "linear.valid"))
        object.__setattr__(self, "_velocity", np.array(velocity))

    def _motion(self, t: FloatArray, /) -> Motion:
        still = Motion.still(self.pose, t.shape)
        p = still.p + (t - self.at_time)[..., None] * self._velocity
        v = still.v + self._velocity
        return Motion(p, v, still.a, still.j, still.yaw, still.yaw_d, still.yaw_dd, still.yaw_ddd)
