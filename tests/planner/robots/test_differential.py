"""Transforms, inverse Jacobian and determinant of every family."""

from __future__ import annotations

import numpy as np
import pytest

from assur.experiments.differential import determinant, inverse_jacobian, transforms
from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.elbow_arm import ElbowArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.polar_arm import PolarArm
from assur.planner.robots.protocol import Limits, Robot
from assur.planner.robots.scara import Scara


def limits(n: int, lower: float = -3.0) -> Limits:
    high = np.full(n, 3.0)
    return Limits(np.full(n, lower), high, high, high, high)


BASE = Pose(0.4, -0.7, 0.2, 2.5)
ROBOTS: list[Robot] = [
    Scara("four", 0.3, 0.2, 4, limits(4), BASE),
    Scara("three", 0.3, 0.2, 3, limits(3), BASE, arms_rise=True),
    ElbowArm(name="elbow", height=0.3, l1=0.25, l2=0.16, limits=limits(3), base=BASE),
    PolarArm(name="polar", height=0.3, limits=limits(3, 0.1), base=BASE),
    FiveBar("five", 0.085, (0.2, 0.2), (0.24, 0.26), 4, limits(4), BASE),
]
every_robot = pytest.mark.parametrize("robot", ROBOTS)


def states(robot: Robot, size: int = 500) -> FloatArray:
    q = np.random.default_rng(1).uniform(robot.limits.lower, robot.limits.upper, (20 * size, len(robot.joints)))
    return q[(robot.margin(q) > 0.1) & (robot.parallel_margin(q) > 0.1)][:size]


@every_robot
def test_the_inverse_jacobian_undoes_the_jacobian(robot: Robot) -> None:
    q = states(robot)
    product = inverse_jacobian(robot, q) @ robot.jacobian(q)
    assert np.abs(product - np.eye(len(robot.joints))).max() < 1e-12
    assert np.abs(inverse_jacobian(robot, q[0]) - inverse_jacobian(robot, q)[0]).max() < 1e-15


@every_robot
def test_the_transforms_are_the_placements_and_rigid(robot: Robot) -> None:
    q = states(robot)
    found = transforms(robot, q)
    assert found.shape == (500, len(robot.links), 4, 4)
    assert (found[..., 3, :] == [0.0, 0.0, 0.0, 1.0]).all()
    gram = np.swapaxes(found[..., :3, :3], -1, -2) @ found[..., :3, :3]
    assert np.abs(gram - np.eye(3)).max() < 1e-15
    assert np.abs(np.linalg.det(found[..., :3, :3]) - 1).max() < 1e-15
    assert np.abs(found[:, robot.links.index("flange"), :3, 3] - robot.forward(q)[0]).max() < 1e-15


@every_robot
def test_the_determinant_vanishes_with_the_margin_and_only_there(robot: Robot) -> None:
    q = states(robot)
    assert (np.abs(determinant(robot, q)) > 1e-6).all()
    singular = q[0].copy()
    if isinstance(robot, FiveBar):
        # the left coupler goes on in line with its crank: stretched
        reach = Pose(0.44 * np.cos(-0.2), 0.0425 + 0.44 * np.sin(-0.2), 0.1)
        singular = robot.inverse(Motion.still(robot.base.then(reach), ()), 1, 0).q
    else:
        singular[1 if isinstance(robot, Scara) else 2] = 0.0
    assert abs(determinant(robot, singular)) < 1e-16
    with np.errstate(all="raise"):
        both = inverse_jacobian(robot, np.stack([singular, q[1], np.full_like(singular, np.nan)]))
    assert np.isnan(both[[0, 2]]).all()
    assert np.isfinite(both[1]).all()


class Redundant(Scara):
    """A SCARA of which only x and y are asked."""

    def jacobian(self, q: FloatArray) -> FloatArray:
        return super().jacobian(q)[..., :2, :]


def test_with_more_joints_than_coordinates_it_is_the_pseudo_inverse_of_the_least_rates() -> None:
    robot = Redundant("two of four", 0.3, 0.2, 4, limits(4), BASE)
    q = states(robot)
    jacobian, inverse = robot.jacobian(q), inverse_jacobian(robot, q)
    assert np.abs(jacobian @ inverse - np.eye(2)).max() < 1e-12
    assert np.abs(inverse - np.linalg.pinv(jacobian)).max() < 1e-10
    values = np.linalg.svd(jacobian, compute_uv=False).prod(-1)
    assert np.abs(determinant(robot, q) - values).max() < 1e-12
