"""Motions of a hand that has a pitch and a roll beside its heading.

Frames of a cell turn about the vertical only; the hand of an arm with a wrist does not. Its attitude in the world is
Rz(yaw) Ry(−pitch) Rx(roll), equation H1 of docs/kinematics.md: `yaw` is the heading of the arm's vertical plane, the
pitch is that of the tool axis (x) above the horizontal in this plane, the roll is about the tool axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose

Tilt: TypeAlias = tuple[float, float]
"""Pitch and roll, rad."""


@dataclass(frozen=True, slots=True)
class TiltedMotion(Motion):
    """A motion with pitch and roll: `tilt` (..., 2) in rad, and three time derivatives. Upright motions have none."""

    tilt: FloatArray
    tilt_d: FloatArray
    tilt_dd: FloatArray
    tilt_ddd: FloatArray

    @staticmethod
    def of(motion: Motion, tilt: FloatArray, *rates: FloatArray) -> TiltedMotion:
        """`motion` with pitch and roll (..., 2) and their three derivatives; without `rates` they do not change."""
        tilt = np.broadcast_to(tilt, (*motion.yaw.shape, 2))
        d, dd, ddd = rates or (np.zeros(tilt.shape),) * 3
        place, turn = (
            (motion.p, motion.v, motion.a, motion.j),
            (motion.yaw, motion.yaw_d, motion.yaw_dd, motion.yaw_ddd),
        )
        return TiltedMotion(*place, *turn, tilt, d, dd, ddd)

    def at(self, offset: Pose) -> TiltedMotion:
        """Motion of a frame beside this one, `offset` being in a frame that has its heading and stays upright."""
        beside = Motion.at(self, offset)
        return TiltedMotion.of(beside, self.tilt, self.tilt_d, self.tilt_dd, self.tilt_ddd)

    def __getitem__(self, key: object) -> TiltedMotion:
        """The motion at some of the times."""
        names = (*Motion.__slots__, *TiltedMotion.__slots__)
        return TiltedMotion(*(getattr(self, name)[key] for name in names))

    def at_rest(self) -> TiltedMotion:
        """The same poses with all derivatives zero: met in position only."""
        return TiltedMotion.of(Motion.at_rest(self), self.tilt)


def like(motion: Motion, pattern: Motion) -> Motion:
    """`motion` with the pitch and roll that `pattern` begins with, if it has any; they stay."""
    return TiltedMotion.of(motion, pattern.tilt.reshape(-1, 2)[0]) if isinstance(pattern, TiltedMotion) else motion
