"""The inverse kinematics of the checker on spans, held to the forward kinematics of all families."""

from __future__ import annotations

import math

import numpy as np
import pytest

from assur.planner.checker.refusals.postures import Goal, posture_in_mode
from assur.planner.checker.refusals.spans import ANY, around, span_beyond
from assur.planner.errors import FaultError
from tests.planner.robots.families import MADE, robot_named
from tests.planner.robots.five_bars import five_bar

KINDS = (*MADE, "mitsubishi-rp-5ah", "mitsubishi-rv-m1", "polar-arm", "elbow-arm")


def goal_of(robot: object, q: np.ndarray, wide: float) -> Goal:
    """Where the flange is for q, known up to `wide`."""
    p, yaw = robot.forward(q)  # type: ignore[attr-defined]
    tilted = "pitch" in robot.coordinates  # type: ignore[attr-defined]
    pitch = around(float(q[1] + q[2] + q[3]), wide) if tilted else ANY
    roll = around(float(q[4]), wide) if tilted else ANY
    x, y, z = (around(float(value), wide) for value in p)
    return Goal(x, y, z, around(float(yaw), wide), pitch, roll)


@pytest.mark.parametrize("wide", [1e-12, 1e-6, 1e-2])
@pytest.mark.parametrize("name", KINDS)
def test_the_joints_that_reach_a_goal_are_within_the_spans(name: str, wide: float) -> None:
    robot, rng = robot_named(name), np.random.default_rng(7)
    checked = 0
    for q in rng.uniform(robot.limits.lower, robot.limits.upper, (300, len(robot.joints))):
        mode = int(robot.mode_of(q))
        if mode < 0 or not robot.within(q):
            continue
        found = posture_in_mode(robot, robot.modes[mode], goal_of(robot, q, wide))
        checked += 1
        assert found.short.low <= 0.0
        for joint, value, span in zip(robot.joints, q.tolist(), found.joints, strict=True):
            assert span_beyond(span, value, value, turns=joint.kind == "revolute") <= 1e-9, joint.name
        assert found.margin.low - 1e-9 <= float(robot.margin(q)) <= found.margin.high + 1e-9
        if found.parallel is not None:
            assert found.parallel.low - 1e-9 <= float(robot.parallel_margin(q)) <= found.parallel.high + 1e-9
        if wide < 1e-9 and float(robot.margin(q)) > 0.1:
            assert all(span.high - span.low < 1e-9 for span in found.joints if math.isfinite(span.low))
            others = [
                posture_in_mode(robot, other, goal_of(robot, q, wide))
                for other in robot.modes
                if other != robot.modes[mode]
            ]
            assert all(
                any(
                    span_beyond(span, value, value, turns=joint.kind == "revolute") > 1e-6
                    for joint, value, span in zip(robot.joints, q.tolist(), each.joints, strict=True)
                )
                for each in others
            )
    assert checked > 100


@pytest.mark.parametrize("name", KINDS)
def test_what_is_out_of_reach_is_so_by_the_margin_of_the_robot(name: str) -> None:
    robot, rng = robot_named(name), np.random.default_rng(11)
    for q in rng.uniform(robot.limits.lower, robot.limits.upper, (100, len(robot.joints))):
        if int(robot.mode_of(q)) < 0:
            continue
        goal = goal_of(robot, q, 0.0)
        away = float(rng.uniform(0.5, 3.0))
        x, y = goal.x * away, goal.y * away
        far = Goal(x, y, goal.z, goal.yaw, goal.pitch, goal.roll)
        for number, mode in enumerate(robot.modes):
            from assur.planner.frames.motion import Pose
            from assur.planner.laws import fixed

            motion = fixed(Pose(far.x.middle, far.y.middle, far.z.middle)).motion(np.zeros(1))
            if "pitch" in robot.coordinates:
                motion = motion.with_tilt(np.array([far.pitch.middle, far.roll.middle]))
            short = -float(robot.reach_margin(motion, number)[0])
            assert posture_in_mode(robot, mode, far).short.middle == pytest.approx(short, abs=1e-9)


def test_an_arm_that_is_not_known_is_a_fault() -> None:
    with pytest.raises(FaultError):
        posture_in_mode(
            object.__new__(type("Strange", (), {"base": five_bar().base, "name": "strange"})), "left", Goal(*[ANY] * 3)
        )
