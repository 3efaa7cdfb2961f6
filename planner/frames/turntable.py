"""A dial that turns about the vertical through its frame's origin; with a rise, a screw."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.profile import Derivatives, Profile
from assur.planner.frames.ramps import Change, ramped
from assur.planner.frames.validity import ALWAYS, FURTHEST_S, KnownLaw, interval, number, placed


@dataclass(frozen=True)
class Turntable(KnownLaw):
    """A frame that turns in place with `rate` (rad/s) until the first of `changes` (of the rate), and climbs.

    Its origin is the centre; at `at_time` it is at `pose`. With θ the angle turned since then (equation F2):

        yaw = pose.yaw + θ(t),   z = pose.z + rise (t − at_time)

    `rise` is in m/s and constant. Raises `InputError` for numbers that are not finite and for changes that overlap.
    """

    pose: Pose
    rate: float
    rise: float = 0.0
    changes: tuple[Change, ...] = ()
    at_time: float = 0.0
    valid: tuple[float, float] = ALWAYS
    drive: Profile = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "pose", placed(self.pose, "turntable.pose"))
        object.__setattr__(self, "rate", number(self.rate, "turntable.rate"))
        object.__setattr__(self, "rise", number(self.rise, "turntable.rise"))
        object.__setattr__(self, "changes", tuple(self.changes))
        object.__setattr__(self, "at_time", number(self.at_time, "turntable.at_time", -FURTHEST_S, FURTHEST_S))
        object.__setattr__(self, "valid", interval(self.valid, "turntable.valid"))
        object.__setattr__(self, "drive", ramped(self.rate, self.changes, self.at_time, "turntable"))

    def _motion(self, t: FloatArray, /) -> Motion:
        found = turning(self.pose, self.drive.evaluate(t))
        found.p[..., 2] += self.rise * (t - self.at_time)
        found.v[..., 2] = self.rise
        return found


def turning(pose: Pose, angle: Derivatives) -> Motion:
    """The motion of a frame that has turned in place from `pose` by `angle` (...) radians."""
    shape = angle[0].shape
    p, still = np.tile(pose.position, (*shape, 1)), np.zeros((3, *shape, 3))
    return Motion(p, still[0], still[1], still[2], pose.yaw + angle[0], *angle[1:])
