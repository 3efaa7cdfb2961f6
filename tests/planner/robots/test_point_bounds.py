"""Bounds of point speed and acceleration along a direction: never below the truth, and sharp."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.protocol import Limits, Sweep
from assur.planner.robots.scara import BASE, FLANGE, LINK1, LINK2, LINKS, QUILL, Scara

ROUNDING = 1e-12
"""Relative rounding of the test's own speeds."""
BLIND = np.full(1, np.nan)
"""No link of a SCARA tilts: it does not look at distances."""


def arm(axes: int = 4, arms_rise: bool = False) -> Scara:
    wide = np.full(axes, 4.0)
    limits, base = Limits(-wide, wide, wide, wide, wide), Pose(1.0, 2.0, 0.5, 0.8)
    return Scara("arm", 0.325, 0.225, axes, limits, base, arms_rise=arms_rise)


def instant(robot: Scara, q: FloatArray, qd: FloatArray, qdd: FloatArray) -> Sweep:
    """What is known of intervals that are one instant: the rates themselves."""
    return Sweep(q, q, np.abs(qd @ robot.rate_matrix.T), np.abs(qdd @ robot.rate_matrix.T))


def rider(
    robot: Scara, link: int, joints: tuple[FloatArray, ...], r: FloatArray, angle: FloatArray, z: float
) -> Motion:
    """Motion of points fixed in a link frame at distance `r`, by Motion.at: none of the bound's own formulas."""
    frame = robot.link_motion(link, *joints)
    points = [frame[i].at(Pose(r[i] * np.cos(angle[i]), r[i] * np.sin(angle[i]), z)) for i in range(len(r))]
    return Motion(*(np.stack([getattr(point, name) for point in points]) for name in Motion.__slots__))


@pytest.mark.parametrize("arms_rise", [False, True])
@pytest.mark.parametrize("axes", [3, 4])
@pytest.mark.parametrize("link", range(len(LINKS)))
def test_the_bounds_are_never_below_the_truth_at_random_points_of_a_link(axes: int, link: int, arms_rise: bool) -> None:
    robot, rng, size = arm(axes, arms_rise), np.random.default_rng(link), 600
    q, qd, qdd = rng.normal(size=(3, size, axes)) * np.array([1.0, 3.0, 20.0])[:, None, None]
    reach = rng.uniform(0, 0.4, size)
    point = rider(robot, link, (q, qd, qdd, qdd), reach * np.sqrt(rng.random(size)), rng.uniform(-4, 4, size), 0.1)
    sweep = instant(robot, q, qd, qdd)
    kept = np.full(size, link)
    for n in (rng.normal(size=(size, 3)), np.tile([0.0, 0.0, 1.0], (size, 1)), point.v, point.a, qd[:, :3] * [1, 1, 0]):
        unit = n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
        speed, acceleration = robot.point_bounds(kept, reach, BLIND, unit, sweep)
        assert (np.abs((unit * point.v).sum(1)) <= speed * (1 + ROUNDING) + 1e-15).all()
        assert (np.abs((unit * point.a).sum(1)) <= acceleration * (1 + ROUNDING) + 1e-15).all()


@pytest.mark.parametrize(("arms_rise", "rising"), [(False, [0, 0, 0, 1, 1]), (True, [0, 1, 1, 1, 1])])
@pytest.mark.parametrize("axes", [3, 4])
def test_along_the_vertical_only_what_the_lift_carries_has_a_speed(
    axes: int, arms_rise: bool, rising: list[int]
) -> None:
    robot, up = arm(axes, arms_rise), np.tile([0.0, 0.0, -1.0], (5, 1))
    sweep = Sweep(np.zeros((5, axes)), np.zeros((5, axes)), np.full((5, 4), 3.0), np.full((5, 4), 7.0))
    speed, acceleration = robot.point_bounds(np.arange(5), np.full(5, 0.3), BLIND, up, sweep)
    assert speed.tolist() == [3 * x for x in rising]
    assert acceleration.tolist() == [7 * x for x in rising]


@pytest.mark.parametrize("link", [LINK1, LINK2, QUILL, FLANGE])
def test_the_bounds_are_reached_by_a_stretched_arm_that_turns_as_one(link: int) -> None:
    """All arms in line: nothing of the bound is given away but by the directions of arms."""
    robot, size = arm(), 8
    q = np.zeros((size, 4))
    q[:, 0] = np.linspace(-3, 3, size)
    qd, qdd = np.zeros((size, 4)), np.zeros((size, 4))
    qd[:, 0], qdd[:, 0] = 2.0, -5.0
    reach = np.full(size, 0.1)
    point = rider(robot, link, (q, qd, qdd, qdd), reach, np.zeros(size), 0.0)
    sweep = instant(robot, q, qd, qdd)
    along_v = point.v / np.linalg.norm(point.v, axis=1, keepdims=True)
    along_a = point.a / np.linalg.norm(point.a, axis=1, keepdims=True)
    speed, _ = robot.point_bounds(np.full(size, link), reach, BLIND, along_v, sweep)
    _, acceleration = robot.point_bounds(np.full(size, link), reach, BLIND, along_a, sweep)
    assert np.abs(speed / np.linalg.norm(point.v, axis=1) - 1).max() < 1e-12
    assert np.abs(acceleration / np.linalg.norm(point.a, axis=1) - 1).max() < 1e-12


def test_the_quills_own_radius_does_not_count_and_the_flanges_does() -> None:
    robot = arm()
    sweep = Sweep(np.zeros((2, 4)), np.zeros((2, 4)), np.ones((2, 4)), np.ones((2, 4)))
    n = np.tile([1.0, 0.0, 0.0], (2, 1))
    speed, _ = robot.point_bounds(np.array([QUILL, FLANGE]), np.full(2, 0.1), BLIND, n, sweep)
    assert speed == pytest.approx([0.55, 0.65], rel=1e-15)


@given(st.integers(0, 4), st.floats(0, 3.2), st.floats(0, 1.0), st.lists(st.floats(0, 50), min_size=8, max_size=8))
def test_the_bounds_are_the_formulas_of_the_page(link: int, tilt: float, reach: float, rates: list[float]) -> None:
    robot = arm()
    rate, rate_d = np.array(rates[:4]), np.array(rates[4:])
    n = np.array([[np.sin(tilt) * 0.6, np.sin(tilt) * 0.8, np.cos(tilt)]])
    sweep = Sweep(np.zeros((1, 4)), np.zeros((1, 4)), rate[None], rate_d[None])
    speed, acceleration = robot.point_bounds(np.array([link]), np.array([reach]), BLIND, n, sweep)
    arms = {
        BASE: [],
        LINK1: [(reach, 0)],
        LINK2: [(0.325, 0), (reach, 1)],
        QUILL: [(0.325, 0), (0.225, 1)],
        FLANGE: [(0.325, 0), (0.225, 1), (reach, 3)],
    }[link]
    lifted = link in (QUILL, FLANGE)
    flat, upright = abs(np.sin(tilt)), abs(np.cos(tilt))
    assert speed[0] == pytest.approx(
        flat * sum(length * rate[k] for length, k in arms) + lifted * upright * rate[2], rel=1e-12, abs=1e-300
    )
    assert acceleration[0] == pytest.approx(
        flat * sum(length * np.hypot(rate_d[k], rate[k] ** 2) for length, k in arms) + lifted * upright * rate_d[2],
        rel=1e-12,
        abs=1e-300,
    )


@pytest.mark.parametrize("bad", [np.inf, np.nan])
@pytest.mark.parametrize("link", range(5))
def test_rates_that_are_not_known_are_bounded_by_infinity_without_a_warning(link: int, bad: float) -> None:
    robot = arm()
    unknown, n = np.full((2, 4), bad), np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    with np.errstate(all="raise"):
        sweep = Sweep(unknown, unknown, unknown, unknown)
        bounds = robot.point_bounds(np.full(2, link), np.full(2, 0.1), BLIND, n, sweep)
    assert all((bound == np.inf).all() for bound in bounds)


@pytest.mark.parametrize("reach", [-0.1, np.nan, np.inf])
@pytest.mark.parametrize("link", [LINK1, LINK2, FLANGE])
def test_a_reach_that_is_none_is_bounded_by_infinity(link: int, reach: float) -> None:
    one = np.ones((1, 4))
    with np.errstate(all="raise"):
        speed, acceleration = arm().point_bounds(
            np.array([link]), np.array([reach]), BLIND, np.array([[1.0, 0.0, 0.0]]), Sweep(one, one, one, one)
        )
    assert speed[0] == acceleration[0] == np.inf


@pytest.mark.parametrize("link", [-1, 5])
def test_a_link_that_does_not_exist_is_a_fault(link: int) -> None:
    one = np.ones((1, 4))
    with pytest.raises(FaultError, match="no such link"):
        arm().point_bounds(np.array([link]), np.ones(1), BLIND, np.ones((1, 3)), Sweep(one, one, one, one))
