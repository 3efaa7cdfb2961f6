"""Arms of every family for tests of kernels, with random joint motion of them."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Pose
from assur.planner.robots.elbow_arm import ElbowArm
from assur.planner.robots.facts import Limits
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.polar_arm import PolarArm
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara

BASES = (Pose(), Pose(0.4, -0.7, 0.2, 2.5))


def limits(lower: list[float], upper: list[float]) -> Limits:
    n = len(lower)
    return Limits(np.array(lower), np.array(upper), np.full(n, 7.0), np.full(n, 100.0), np.full(n, 5e3))


def arms() -> dict[str, Robot]:
    """One or more of every family, at the origin and elsewhere."""
    found: dict[str, Robot] = {}
    for number, base in enumerate(BASES):
        for axes in (3, 4):
            for rises in (False, True):
                wide = limits([-4.0, -4.0, -0.3, -7.0][:axes], [4.0, 4.0, 0.3, 7.0][:axes])
                name = f"scara {axes} {rises} {number}"
                found[name] = Scara(name, 0.325, 0.225, axes, wide, base, arms_rise=rises)
        for axes, assembly in ((2, "front"), (3, "back"), (4, "front")):
            wide = limits([-4.0, -4.0, 0.1, -7.0][:axes], [4.0, 4.0, 0.4, 7.0][:axes])
            name = f"five-bar {axes} {number}"
            lengths = ((0.17, 0.22), (0.28, 0.24)) if axes == 3 else ((0.2, 0.2), (0.26, 0.26))
            found[name] = FiveBar(name, 0.085, *lengths, axes, wide, base, assembly=assembly)
        free = limits([-4.0] * 3, [4.0] * 3)
        elbow, polar, five = f"elbow {number}", f"polar {number}", f"five-axis {number}"
        found[elbow] = ElbowArm(name=elbow, height=0.3, limits=free, base=base, l1=0.25, l2=0.16)
        stroke = limits([-4.0, -2.0, 0.1], [4.0, 2.0, 0.6])
        found[polar] = PolarArm(name=polar, height=0.3, limits=stroke, base=base)
        free = limits([-4.0] * 5, [4.0] * 5)
        found[five] = FiveAxisArm(name=five, height=0.3, limits=free, base=base, l1=0.25, l2=0.16, l3=0.18)
    return found


ARMS = arms()
"""By name."""


def states(robot: Robot, seed: int, size: int) -> FloatArray:
    """q (size, n): random within limits, and singular ones: stretched, folded, over the base axis."""
    rng = np.random.default_rng(seed)
    q = rng.uniform(robot.limits.lower, robot.limits.upper, (size, len(robot.joints)))
    q[: size // 8, 1:3] = 0.0
    q[size // 8 : size // 4, 1:3] = np.pi
    q[size // 4 : size // 3] = np.round(q[size // 4 : size // 3])
    return q
