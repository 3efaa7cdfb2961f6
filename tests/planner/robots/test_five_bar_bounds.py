"""What is proved of a five-bar over ranges of its joints: that it assembles, and how fast its points can be."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.five_bar import DISTAL_LEFT, FLANGE, LINKS, PROXIMAL_LEFT
from assur.planner.robots.protocol import Sweep
from tests.planner.robots.five_bars import BASES, LENGTHS, five_bar, states

ROUNDING = 1e-11
"""Relative rounding of the test's own speeds."""


def riders(frame: Motion, r: FloatArray, angle: FloatArray) -> Motion:
    """Points fixed in a link's frame at distance `r`, by Motion.at: none of the bound's own formulas."""
    points = [frame[i].at(Pose(r[i] * np.cos(angle[i]), r[i] * np.sin(angle[i]), 0.1)) for i in range(len(r))]
    return Motion(*(np.stack([getattr(point, name) for point in points]) for name in Motion.__slots__))


@given(
    seed=st.integers(0, 2**32 - 1),
    link=st.integers(0, len(LINKS) - 1),
    lengths=st.sampled_from(["even", "short", "odd"]),
    width=st.sampled_from([0.0, 1e-6, 1e-3, 0.02]),
    mode=st.sampled_from([0, 1, 3]),
)
def test_the_bounds_are_never_below_the_truth_anywhere_in_the_range(
    seed: int, link: int, lengths: str, width: float, mode: int
) -> None:
    robot, rng, size = five_bar(lengths, base=BASES[1]), np.random.default_rng(seed), 40
    middle = states(rng, robot, mode, size, 0.0)
    lower, upper = middle - width * rng.random(middle.shape), middle + width * rng.random(middle.shape)
    q = lower + (upper - lower) * rng.integers(0, 2, middle.shape)  # corners of the range
    qd, qdd = rng.normal(size=(2, size, 4)) * np.array([1.0, 10.0])[:, None, None]
    sweep = Sweep(lower, upper, np.abs(qd @ robot.rate_matrix.T), np.abs(qdd @ robot.rate_matrix.T))
    reach = rng.uniform(0, 0.3, size)
    known = robot.assembled(lower, upper)
    point = riders(robot.link_motion(link, q, qd, qdd, 0 * q), reach * rng.random(size), rng.uniform(-4, 4, size))
    for n in (rng.normal(size=(size, 3)), np.tile([0.0, 0.0, 1.0], (size, 1)), point.v, point.a):
        with np.errstate(invalid="ignore"):
            unit = np.nan_to_num(n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300))
        speed, acceleration = robot.point_bounds(np.full(size, link), reach, reach, unit, sweep)
        assert (np.abs((unit * point.v).sum(1))[known] <= (speed * (1 + ROUNDING) + 1e-14)[known]).all()
        assert (np.abs((unit * point.a).sum(1))[known] <= (acceleration * (1 + ROUNDING) + 1e-12)[known]).all()
        assert np.isfinite(speed[known]).all()


@given(
    seed=st.integers(0, 2**32 - 1),
    lengths=st.sampled_from(sorted(LENGTHS)),
    width=st.floats(0.0, 1.5),
    assembly=st.sampled_from(["front", "back"]),
)
def test_a_range_that_is_proved_to_assemble_does_everywhere(
    seed: int, lengths: str, width: float, assembly: str
) -> None:
    robot, rng = five_bar(lengths, assembly=assembly), np.random.default_rng(seed)
    lower = rng.uniform(-3.2, 3.2, (200, 4))
    upper = lower + width * rng.random((200, 4))
    proved = robot.assembled(lower, upper)
    for share in (rng.random((30, 200, 4)), rng.integers(0, 2, (16, 200, 4))):
        q = lower + share * (upper - lower)
        margin = robot.parallel_margin(q)
        assert (margin[:, proved] >= robot.parallel_least - 1e-12).all()


def test_small_ranges_in_the_clear_are_proved_and_points_nearly_always() -> None:
    """The proof is of use: 99 % of points, and 20 ms of full speed, 0.15 rad, where the margin is ample."""
    robot = five_bar()
    q = states(np.random.default_rng(1), robot, 1, 2_000)
    assert robot.assembled(q, q).all()
    ample = q[robot.parallel_margin(q) > 0.7]
    assert robot.assembled(ample - 0.075, ample + 0.075).mean() > 0.99


def test_what_is_not_proved_is_bounded_by_infinity_except_where_couplers_do_not_matter() -> None:
    robot = five_bar("short")
    q = np.array([[np.pi / 2, -np.pi / 2, 0.2, 0.0]])  # the elbows are too far apart
    one = np.ones((1, 4))
    sweep, along = Sweep(q, q, one, one), np.array([[0.6, 0.0, 0.8]])
    for link in range(len(LINKS)):
        with np.errstate(all="raise"):
            speed, acceleration = robot.point_bounds(np.array([link]), np.full(1, 0.1), np.full(1, 0.1), along, sweep)
            up = robot.point_bounds(
                np.array([link]), np.full(1, 0.1), np.full(1, 0.1), np.array([[0.0, 0.0, 1.0]]), sweep
            )
        coupled = link not in (0, 1, 3)
        assert (speed[0] == np.inf) == (acceleration[0] == np.inf) == coupled
        assert up[0] == (1.0 if link >= 5 else 0.0)


def test_a_crank_that_turns_alone_is_bounded_sharply() -> None:
    robot, q = five_bar(), np.array([[0.5, -0.5, 0.2, 0.0]])
    rate = np.array([[2.0, 0.0, 0.0, 0.0]])
    sweep = Sweep(q, q, rate, 5 * rate)
    speed, acceleration = robot.point_bounds(
        np.array([PROXIMAL_LEFT]), np.full(1, 0.2), np.full(1, 0.2), np.array([[1.0, 0, 0]]), sweep
    )
    assert speed[0] == pytest.approx(0.4, rel=1e-14)
    assert acceleration[0] == pytest.approx(0.2 * np.hypot(10, 4), rel=1e-14)


@pytest.mark.parametrize("bad", [np.inf, np.nan])
@pytest.mark.parametrize("link", range(len(LINKS)))
def test_rates_and_ranges_that_are_not_known_are_bounded_by_infinity_without_a_warning(link: int, bad: float) -> None:
    robot = five_bar()
    unknown, n = np.full((1, 4), bad), np.array([[1.0, 0.0, 0.0]])
    fine = np.array([[0.5, -0.5, 0.2, 0.0]])
    with np.errstate(all="raise"):
        speed, _ = robot.point_bounds(
            np.array([link]), np.full(1, 0.1), np.full(1, 0.1), n, Sweep(fine, fine, unknown, unknown)
        )
        assert speed[0] == np.inf
        assert not robot.assembled(-np.abs(unknown), np.abs(unknown)).any()
        if link in (DISTAL_LEFT, FLANGE):
            wide = Sweep(-np.abs(unknown), np.abs(unknown), np.abs(fine), np.abs(fine))
            assert robot.point_bounds(np.array([link]), np.full(1, 0.1), np.full(1, 0.1), n, wide)[0][0] == np.inf


@pytest.mark.parametrize("link", [-1, 7])
def test_a_link_that_does_not_exist_is_a_fault(link: int) -> None:
    one = np.ones((1, 4))
    with pytest.raises(FaultError, match="no such link"):
        five_bar().point_bounds(np.array([link]), np.ones(1), np.ones(1), np.ones((1, 3)), Sweep(one, one, one, one))
