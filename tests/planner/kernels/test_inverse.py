"""Joint states and motions of links as kernels have them: the same as the NumPy forms of the robots, to rounding."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion
from assur.planner.frames.tilted import TiltedMotion
from assur.planner.kernels.inverse import LOOP, MODE, POSTURE_COLUMNS, SERIAL, joint_motions, postures
from assur.planner.kernels.motion import link_motions
from assur.planner.tables.robot import robot_row
from tests.planner.kernels.arms import ARMS, states
from tests.planner.kernels.test_carriers import every_arm, same


def rows_of(motion: Motion) -> FloatArray:
    """(N, 4, 6)."""
    out = np.zeros((len(motion.yaw), 4, 6))
    for k, name in enumerate(("p", "v", "a", "j")):
        out[:, k, :3] = getattr(motion, name)
    for k, name in enumerate(("yaw", "yaw_d", "yaw_dd", "yaw_ddd")):
        out[:, k, 3] = getattr(motion, name)
    if isinstance(motion, TiltedMotion):
        for k, name in enumerate(("tilt", "tilt_d", "tilt_dd", "tilt_ddd")):
            out[:, k, 4:] = getattr(motion, name)
    return out


@every_arm
def test_links_move_as_the_robot_says(name: str) -> None:
    robot, rng = ARMS[name], np.random.default_rng(1)
    q = states(robot, 1, 300)
    joints = np.stack([q, *rng.normal(size=(3, *q.shape)) * np.array([1.0, 5.0, 30.0])[:, None, None]], 1)
    joints[5, 3] = np.nan
    for link in range(len(robot.links)):
        expected = rows_of(robot.link_motion(link, *(np.ascontiguousarray(joints[:, k]) for k in range(4))))
        found = np.empty_like(expected)
        link_motions(robot_row(robot), link, joints, found)
        if "five-bar" in name:
            good = robot.parallel_margin(q) > 0.1
            same(found[good], expected[good], 1e-9)
        else:
            same(found, expected)


@every_arm
@pytest.mark.parametrize("order", range(4))
def test_joint_states_are_those_of_the_robot(name: str, order: int) -> None:
    robot, rng, size = ARMS[name], np.random.default_rng(2), 400
    q = states(robot, 3, size)
    joints = np.stack([q, *rng.normal(size=(3, *q.shape)) * np.array([1.0, 5.0, 30.0])[:, None, None]], 1)
    motion = robot.link_motion(len(robot.links) - 1, *(np.ascontiguousarray(joints[:, k]) for k in range(4)))
    motion.p[1::9, :2] *= 3.0
    motion.p[2::50] = np.nan
    motion.v[3::50, 2] = np.inf
    motion.yaw_d[4::50] = np.nan
    if len(robot.joints) == 2:
        motion.p[10::30, 2] += 1e-3
    targets = rows_of(motion)
    for mode in range(len(robot.modes)):
        expected = robot.inverse(motion, mode, order)
        found, margins = np.empty((size, 4, len(robot.joints))), np.empty((size, 2))
        codes = np.empty(size, dtype=np.int64)
        joint_motions(robot_row(robot), mode, order, targets, found, margins, codes)
        assert np.array_equal(codes, expected.code)
        good = expected.margin > 1e-3
        if expected.parallel is not None:
            same(margins[:, 1], expected.parallel)
        same(margins[:, 0], expected.margin, 1e-8)  # a root of what is almost nothing
        for k, each in enumerate((expected.q, expected.qd, expected.qdd, expected.qddd)):
            assert np.array_equal(np.isnan(found[:, k]), np.isnan(each))
            scale = np.maximum(1.0, 1.0 / np.where(good, expected.margin, 1.0)) ** (2 * k + 1)
            error = np.abs(found[:, k] - each) / (1.0 + np.abs(each))
            turned = np.abs(np.abs(found[:, k] - each) - 2 * np.pi) < 1e-9 if k == 0 else False
            close = (error <= 1e-12 * scale[:, None]) | turned | ~np.isfinite(each)
            assert close[good].all()


@every_arm
def test_postures_are_those_of_the_robot(name: str) -> None:
    robot = ARMS[name]
    q = states(robot, 4, 400)
    found = np.empty((len(q), POSTURE_COLUMNS))
    postures(robot_row(robot), q, found)
    same(found[:, SERIAL], robot.margin(q))
    same(found[:, LOOP], robot.parallel_margin(q))
    same(found[:, 1], robot.singular_distance(q))
    assert np.array_equal(found[:, MODE], robot.mode_of(q))
    known = np.isfinite(found[:, 0])
    assert np.array_equal(found[known, 0], robot.singularity(q)[known])
    assert known.all() or "five-bar" in name
