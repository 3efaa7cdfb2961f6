"""Places of a five-bar in the plane of its base, m: elbows, and which parts of the singular curves belong to a mode."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.five_bar import FiveBar

SINGULAR = 1e-5
"""Up to this a margin, no unit, is that of a point on a curve: a place that is off by 1e-12 m has some 1e-6."""


@dataclass(frozen=True, eq=False)
class Paths:
    """Of the tool axis, m: the straight line that was asked, and the way that was planned between its ends (N, 2)."""

    straight: FloatArray
    around: FloatArray


def standing(p: FloatArray) -> Motion:
    """A standing flange at places (N, 2) in base axes, at the height of the base origin."""
    motion = Motion.still(Pose(), (len(p),))
    motion.p[:, :2] = p
    return motion


def on_curve(robot: FiveBar, curve: FloatArray, mode: int, of_type: int) -> FloatArray:
    """q (N, n) of the curve's points, NaN where the curve is not this mode's."""
    found = robot.inverse(standing(curve), mode, 0)
    parallel = np.full(len(curve), np.nan) if found.parallel is None else found.parallel
    singular = np.abs(found.margin if of_type == 1 else parallel) < SINGULAR
    return np.where((singular & np.isfinite(curve).all(1))[:, None], found.q, np.nan)


def elbows(robot: FiveBar, q: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Places (N, 2) of both elbows in base axes."""
    left, right = (np.stack([np.cos(q[:, k]), np.sin(q[:, k])], -1) for k in (0, 1))
    side = np.array([0.0, robot.separation / 2])
    return side + robot.proximal[0] * left, robot.proximal[1] * right - side
