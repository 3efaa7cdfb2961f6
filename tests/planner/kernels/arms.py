"""Arms of every family for tests of kernels, with random joint motion of them."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.planner.robots.robot import Robot
from tests.planner.robots.families import MADE, elbow, five_axis, polar, scara
from tests.planner.robots.five_bars import five_bar

ARMS: dict[str, Robot] = {
    **MADE,
    "scara": scara(),
    "scara at the origin": scara(base=Pose()),
    "elbow arm": elbow(),
    "polar arm": polar(),
    "five-axis arm": five_axis(Pose(), l3=0.18),
    "five-bar": five_bar(base=Pose(0.4, -0.7, 0.2, 2.5)),
}
"""By name."""


def states(robot: Robot, seed: int, size: int) -> FloatArray:
    """q (size, n): random within limits, and singular ones: stretched, folded, over the base axis."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(robot.limits.lower, robot.limits.upper, (size, len(robot.joints)))
    q[: size // 8, 1:3] = 0.0
    q[size // 8 : size // 4, 1:3] = np.pi
    q[size // 4 : size // 3] = np.round(q[size // 4 : size // 3])
    return q
