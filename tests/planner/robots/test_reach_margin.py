"""How far a pose is from the edge of the reach, held to the inverse and to the distance from a singularity."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion
from assur.planner.robots.facts import Code
from assur.planner.robots.robot import Robot
from assur.planner.robots.tilting import PolarArm
from tests.planner.robots.families import NAMES, far, five_axis, flange_of, random_q, robot_named

SIZE = 400
WAY_M = 1.5
"""Half the edge of the cube in which poses are looked at, m: no arm of these reaches its corners."""


def flange(robot: Robot, q: FloatArray) -> Motion:
    none = np.zeros_like(q)
    return robot.link_motion(flange_of(robot), q, none, none, none)


def put(motion: Motion, p: FloatArray) -> Motion:
    """The first pose of a motion, at other positions."""
    table = motion.at_rest().table[:1].repeat(len(p), axis=0)
    table[:, 0, :3] = p
    return Motion(table)


def reached(robot: Robot, poses: Motion, mode: int) -> BoolArray:
    """Whether the linkage comes there, the range of a polar arm's ram included."""
    found = robot.inverse(poses, mode, 0)
    met = found.code != Code.OUT_OF_REACH
    if isinstance(robot, PolarArm):
        met &= (robot.limits.lower[2] <= found.q[..., 2]) & (found.q[..., 2] <= robot.limits.upper[2])
    return np.asarray(met)


@pytest.mark.parametrize("name", NAMES)
def test_a_pose_is_out_of_reach_where_the_margin_is_negative_and_nowhere_else(name: str) -> None:
    robot, rng = robot_named(name), np.random.default_rng(6)
    for mode in range(len(robot.modes)):
        pose = flange(robot, random_q(robot, rng, 1, mode))
        p = pose.p + rng.uniform(-WAY_M, WAY_M, (SIZE, 3))
        p[: SIZE // 2] = pose.p + rng.uniform(-0.05, 0.05, (SIZE // 2, 3))
        if not robot.tilting:
            p[:, 2] = pose.p[0, 2]
        poses = put(pose, p)
        margin = robot.reach_margin(poses, mode)
        assert (margin < 0).any()
        assert (margin > 0).any()
        clear = np.abs(margin) > 1e-9 * far(robot)
        assert ((margin > 0) == reached(robot, poses, mode))[clear].all()


@pytest.mark.parametrize("name", NAMES)
def test_within_reach_the_margin_is_the_distance_from_a_stretched_or_folded_arm(name: str) -> None:
    robot, rng = robot_named(name), np.random.default_rng(7)
    for mode in range(len(robot.modes)):
        q = random_q(robot, rng, SIZE, mode)
        poses = flange(robot, q)
        margin = robot.reach_margin(poses, mode)
        assert (margin > 0).all()
        if isinstance(robot, PolarArm):
            ends = np.minimum(q[:, 2] - robot.limits.lower[2], robot.limits.upper[2] - q[:, 2])
            assert margin == pytest.approx(ends, abs=1e-12 * far(robot))
            continue
        if robot.tilting:  # the axis of the base is a singularity inside the reach
            margin = np.minimum(margin, np.hypot(*(poses.p - robot.base.position)[:, :2].T))
        assert margin == pytest.approx(robot.singular_distance(q), abs=1e-12 * far(robot))


def test_an_arm_with_pitch_is_asked_with_one() -> None:
    still, none = np.zeros((1, 3)), np.zeros(1)
    motion = Motion.of(still, still, still, still, none, none, none, none)
    with pytest.raises(FaultError, match="without pitch"):
        five_axis().reach_margin(motion, 0)
    assert np.isfinite(five_axis().reach_margin(motion.with_tilt(np.zeros(2)), 0)).all()
