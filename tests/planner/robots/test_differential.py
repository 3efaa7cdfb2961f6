"""The inverse Jacobian and the determinant at singular states, and where there are more joints than coordinates; else
`test_every_robot.py` has them."""

from __future__ import annotations

import numpy as np
import pytest

from assur.experiments.differential import determinant, inverse_jacobian, jacobian
from assur.planner.robots.robot import Robot
from tests.planner.robots.families import elbow, five_axis, polar, random_q, scara


@pytest.mark.parametrize(
    ("robot", "joint", "value"),
    [(scara(), 1, 0.0), (scara(3), 1, 0.0), (elbow(), 2, 0.0), (polar(), 1, np.pi / 2), (five_axis(), 2, 0.0)],
)
def test_a_singular_state_has_no_inverse_and_its_neighbours_have(robot: Robot, joint: int, value: float) -> None:
    q = random_q(robot, np.random.default_rng(1), 2)
    singular = q[0].copy()
    singular[joint] = value
    assert abs(determinant(robot, singular)) < 1e-16
    with np.errstate(all="raise"):
        both = inverse_jacobian(robot, np.stack([singular, q[1], np.full_like(singular, np.nan)]))
    assert np.isnan(both[2]).all()
    assert np.isnan(both[0]).all() or np.abs(both[0]).max() > 1e15
    assert np.abs(both[1] @ jacobian(robot, q[1]) - np.eye(len(singular))).max() < 1e-12
    assert np.array_equal(inverse_jacobian(robot, q[1]), both[1])


def test_with_more_joints_than_coordinates_it_is_the_pseudo_inverse_of_the_least_rates() -> None:
    robot = scara()
    object.__setattr__(robot, "coordinates", ("x", "y"))
    q = random_q(robot, np.random.default_rng(1), 500)
    direct, inverse = jacobian(robot, q), inverse_jacobian(robot, q)
    assert np.abs(direct @ inverse - np.eye(2)).max() < 1e-12
    assert np.abs(inverse - np.linalg.pinv(direct)).max() < 1e-10
    values = np.linalg.svd(direct, compute_uv=False).prod(-1)
    assert np.abs(determinant(robot, q) - values).max() < 1e-12
