"""Full turns: all of them, none beyond a limit, none for what does not turn."""

from __future__ import annotations

import doctest
import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.errors import InputError
from assur.planner.robots import facts, turns
from assur.planner.robots.facts import Limits
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara
from assur.planner.robots.turns import beyond_range, equivalents

WIDE = np.array([7.0, 2.6, 0.4, 13.0])


def arm() -> Robot:
    return Scara(name="arm", l1=0.3, l2=0.2, axes=4, limits=Limits(-WIDE, WIDE, WIDE, WIDE, WIDE))


angle = st.one_of(st.floats(-20, 20), st.integers(-8, 8).map(lambda k: k * np.pi / 2))


@given(angle, st.floats(-2.6, 2.6), st.floats(-0.5, 0.5), angle, st.floats(0, 7), st.floats(0, 13))
def test_every_full_turn_within_the_limits_is_there_once_and_nothing_else(
    q1: float, q2: float, z: float, q4: float, most1: float, most4: float
) -> None:
    robot, q = arm(), np.array([q1, q2, z, q4])
    upper = np.array([most1, 2.6, 0.4, most4])
    expected = []
    for k1, k2, k4 in itertools.product(range(-6, 7), repeat=3):
        turned = np.array([q1 + k1 * 2 * np.pi, q2 + k2 * 2 * np.pi, z, q4 + k4 * 2 * np.pi])
        if (np.abs(turned) <= upper).all():
            expected.append(turned.tolist())
    assert equivalents(robot, q, -upper, upper).tolist() == sorted(expected)


@given(angle, st.floats(0.1, 2.5), angle)
def test_all_of_them_put_the_robot_in_the_same_place(q1: float, q2: float, q4: float) -> None:
    robot = arm()
    every = equivalents(robot, np.array([q1, q2, 0.2, q4]), -WIDE, WIDE)
    assert len(every) >= 2
    p, yaw = robot.forward(every)
    assert np.abs(p - p[0]).max() < 1e-14
    assert np.abs(np.sin((yaw - yaw[0]) / 2)).max() < 1e-14
    assert robot.within(every).all()


def test_a_value_on_the_limit_counts_and_the_next_float_does_not() -> None:
    robot = arm()
    upper = np.array([1.0, 2.0, 0.3, 0.5])
    assert equivalents(robot, upper, -upper, upper).tolist() == [upper.tolist()]
    for joint in range(4):
        q = upper.copy()
        q[joint] = np.nextafter(q[joint], 9.0)
        assert equivalents(robot, q, -upper, upper).shape == (0, 4)


def test_the_prismatic_joint_does_not_turn() -> None:
    q = np.array([0.1, 0.1, 0.3, 0.1])
    lower, upper = np.array([-1.0, -1.0, -20.0, -1.0]), np.array([1.0, 1.0, 20.0, 1.0])
    assert equivalents(arm(), q, lower, upper).tolist() == [q.tolist()]


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("joint", range(4))
def test_what_is_not_finite_has_no_equivalent(bad: float, joint: int) -> None:
    q = np.array([0.1, 0.1, 0.1, 0.1])
    q[joint] = bad
    assert equivalents(arm(), q, -WIDE, WIDE).shape == (0, 4)


@pytest.mark.parametrize("most", [1e9, np.inf, np.nan])
def test_a_range_of_too_many_turns_is_refused_by_the_name_of_its_joint(most: float) -> None:
    upper = np.array([7.0, 2.6, 0.4, most])
    with pytest.raises(InputError, match="limits of theta4"):
        equivalents(arm(), np.zeros(4), -upper, upper)


def test_principal_angles_keep_their_bits_and_others_lose_whole_turns() -> None:
    kept = np.array([np.pi, 3.0, 0.0, -0.0, -3.0, -3.14])
    assert np.array_equal(facts.principal(kept), kept)
    assert facts.principal(np.array([-np.pi])) == np.pi
    x = np.linspace(-40, 40, 4001)
    wrapped = facts.principal(x)
    assert (wrapped > -np.pi).all()
    assert (wrapped <= np.pi).all()
    assert np.abs(np.sin((x - wrapped) / 2)).max() < 1e-14


def test_the_examples_in_the_docstrings_run() -> None:
    assert doctest.testmod(turns).failed == 0


@given(st.floats(-90, 90), st.floats(-80, 80), st.floats(0.1, 9.0), st.floats(-2, 2))
def test_a_joint_is_beyond_its_range_by_the_least_over_all_turns(q4: float, low: float, wide: float, z: float) -> None:
    lower, upper = -WIDE.copy(), WIDE.copy()
    lower[3], upper[3] = low, low + wide
    robot = Scara(name="arm", l1=0.3, l2=0.2, axes=4, limits=Limits(lower, upper, WIDE, WIDE, WIDE))
    every = q4 + 2 * np.pi * np.arange(-60, 61)
    least = max(0.0, float(np.maximum(low - every, every - (low + wide)).min()))
    found = beyond_range(robot, np.array([0.0, 1.0, z, q4]))
    assert found[:2].tolist() == [0.0, 0.0]
    assert found[2] == max(0.0, abs(z) - 0.4)
    assert found[3] == pytest.approx(least, abs=1e-12)
    assert (found[3] == 0.0) == bool(len(equivalents(robot, np.array([0.0, 1.0, 0.0, q4]), lower, upper)))
