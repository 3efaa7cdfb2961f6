"""The other robot in the cell: a link of an arm that runs a plan made earlier."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.frames.motion import Motion
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class ArmLink:
    """Link number `link` of `robot`, which follows `trajectory` and is at rest before and after it (equation F6)."""

    robot: Robot
    trajectory: Trajectory
    link: int

    def motion(self, t: FloatArray, known: BoolArray) -> Motion:
        """Pose and three derivatives at times `t` (...), s; NaN where `known` (...) is false."""
        path = self.trajectory
        held = np.minimum(np.maximum(np.where(known, t, path.start), path.start), path.end)
        q, qd, qdd, qddd = (path.evaluate(held, derivative) for derivative in range(4))
        # At rest the first three are zero by themselves; the jerk is not, it jumps.
        moving = (path.start <= t) & (t < path.end)
        moved = self.robot.link_motion(self.link, q, qd, qdd, np.where(moving[..., None], qddd, 0.0))
        if known.all():
            return moved
        parts = [getattr(moved, name) for name in Motion.__slots__]
        return Motion(*(np.where(known if x.ndim == t.ndim else known[..., None], x, math.nan) for x in parts))
