"""A robot as a row of numbers: what the kernels know of it (columns of `assur.planner.kernels.links`)."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.kernels import links as of
from assur.planner.robots.elbow_arm import ElbowArm
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.polar_arm import PolarArm
from assur.planner.robots.protocol import Robot
from assur.planner.robots.scara import Scara


def robot_row(robot: Robot) -> FloatArray:
    """The robot's row, (`ROBOT_COLUMNS`,) in SI units. Raises `FaultError` for a family that the kernels do not know.

    Adding a family is adding a branch here and in `place_links`, `bound_links` and `joint_states`.
    """
    row = np.zeros(of.ROBOT_COLUMNS)
    row[of.JOINTS], row[of.LINKS] = len(robot.joints), len(robot.links)
    base = robot.base
    row[[of.BASE_X, of.BASE_Y, of.BASE_Z, of.BASE_YAW]] = base.x, base.y, base.z, base.yaw
    row[of.BASE_COS], row[of.BASE_SIN] = math.cos(base.yaw), math.sin(base.yaw)
    match robot:
        case Scara():
            row[of.KIND] = of.SCARA
            row[[of.L1, of.L2, of.LONGEST]] = robot.l1, robot.l2, robot.l1 + robot.l2
            row[of.RISES] = robot.arms_rise
        case FiveBar():
            row[of.KIND] = of.FIVE_BAR
            row[[of.L1, of.L3]], row[[of.L2, of.L4]] = robot.proximal, robot.distal
            row[of.HEIGHT], row[of.SIGMA] = robot.separation, robot.loop.sigma
            row[of.PARALLEL_LEAST] = robot.parallel_least
        case FiveAxisArm():
            row[of.KIND] = of.FIVE_AXIS
            row[[of.L1, of.L2, of.L3]] = robot.l1, robot.l2, robot.l3
            row[[of.HEIGHT, of.LONGEST]] = robot.height, robot.longest
        case ElbowArm():
            row[of.KIND] = of.ELBOW
            row[[of.L1, of.L2]] = robot.l1, robot.l2
            row[[of.HEIGHT, of.LONGEST]] = robot.height, robot.longest
        case PolarArm():
            row[of.KIND] = of.POLAR
            row[[of.HEIGHT, of.LONGEST]] = robot.height, robot.longest
        case _:
            raise FaultError(f"no table for a robot of type {type(robot).__name__}")
    return row
