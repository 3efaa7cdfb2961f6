"""A robot as a row of numbers: what the kernels know of it."""

from __future__ import annotations

from assur.planner.arrays import FloatArray
from assur.planner.robots.protocol import Robot


def robot_row(robot: Robot) -> FloatArray:
    """A copy of the robot's row (columns of `assur.planner.kernels.links`), SI units."""
    return robot.row.copy()
