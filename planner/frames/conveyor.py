"""A belt: what lies on it travels along the frame's own x axis."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.profile import Derivatives, Profile
from assur.planner.frames.ramps import Change, ramped
from assur.planner.frames.validity import ALWAYS, FURTHEST_S, KnownLaw, interval, number, placed


@dataclass(frozen=True)
class Conveyor(KnownLaw):
    """A frame that is at `pose` at `at_time` and travels along its local x with `speed` until the first of `changes`.

    With u = (cos yaw, sin yaw, 0) and s the travel (equation F1): p = p0 + s(t) u. A negative speed runs backwards.
    Raises `InputError` for numbers that are not finite and for changes that overlap.
    """

    pose: Pose
    speed: float
    changes: tuple[Change, ...] = ()
    at_time: float = 0.0
    valid: tuple[float, float] = ALWAYS
    drive: Profile = field(init=False, repr=False, compare=False)
    _along: FloatArray = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "pose", placed(self.pose, "conveyor.pose"))
        object.__setattr__(self, "speed", number(self.speed, "conveyor.speed"))
        object.__setattr__(self, "changes", tuple(self.changes))
        object.__setattr__(self, "at_time", number(self.at_time, "conveyor.at_time", -FURTHEST_S, FURTHEST_S))
        object.__setattr__(self, "valid", interval(self.valid, "conveyor.valid"))
        object.__setattr__(self, "drive", ramped(self.speed, self.changes, self.at_time, "conveyor"))
        object.__setattr__(self, "_along", np.array([math.cos(self.pose.yaw), math.sin(self.pose.yaw), 0.0]))

    def _motion(self, t: FloatArray, /) -> Motion:
        return travelling(self.pose, self._along, self.drive.evaluate(t))


def travelling(pose: Pose, along: FloatArray, s: Derivatives) -> Motion:
    """The motion of a frame that has come from `pose` by `s` (...) metres along the unit vector `along` (3,)."""
    travel, v, a, j = (rate[..., None] * along for rate in s)
    shape = s[0].shape
    return Motion(pose.position + travel, v, a, j, np.full(shape, pose.yaw), *np.zeros((3, *shape)))
