"""Straight motions from rest to rest, in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.timing import rest_to_rest_time, to_trajectory
from assur.planner.timing.question import Limits
from assur.planner.timing.straight import phase_lengths, straight
from assur.planner.trajectory import check_limits
from tests.planner.timing.legs import ROBOTS, question


def made(seed: int, robot: str) -> tuple[list[float], list[float], Limits, float]:
    """A question from rest to rest and the least time along the straight line, by the closed form."""
    asked = question(np.random.default_rng(seed), robot, "rest")
    v, a, j = (limit.tolist() for limit in asked.limits)
    limits = Limits(v, [-x for x in v], a, [-x for x in a], j)
    way = np.abs(asked.q1 - asked.q0)
    least = float(rest_to_rest_time(1.0, *(float((limit / way).min()) for limit in asked.limits)))
    return asked.q0.tolist(), asked.q1.tolist(), limits, least


@given(st.integers(0, 10**6), st.sampled_from(ROBOTS), st.floats(1, 4))
def test_a_straight_motion_is_straight_keeps_the_limits_and_reaches_one_if_it_is_the_fastest(
    seed: int, robot: str, slower: float
) -> None:
    q0, q1, limits, least = made(seed, robot)
    profile = straight(q0, q1, limits, least * slower)
    assert profile is not None
    assert profile.duration == least * slower
    t = np.linspace(0, profile.duration, 100)
    way = np.array(q1) - q0
    share = (profile.evaluate(t) - q0) / way
    assert np.abs(share - share[:, :1]).max() <= 1e-15 / np.abs(way).min() * 10
    path, wide = to_trajectory(profile), np.full(len(way), 9.0)
    report = check_limits(path, -wide, wide, *map(np.array, (limits.velocity, limits.acceleration, limits.jerk)))
    ratios = [check.ratio.max() for check in report.checks[1:]]
    # Rounding of knots near 3 rad over phases of a hundred microseconds, and of the solver's nothing.
    assert max(ratios[:2]) <= 1 + 1e-6
    assert ratios[2] <= 1 + 1e-2
    expected = 1 / slower ** np.arange(1, 4)
    assert max(np.array(ratios) / expected) >= 1 - 1e-6


@given(st.integers(0, 10**6), st.sampled_from(ROBOTS))
def test_less_than_the_least_time_is_refused(seed: int, robot: str) -> None:
    q0, q1, limits, least = made(seed, robot)
    assert straight(q0, q1, limits, least * (1 - 1e-9)) is None
    assert straight(q0, q1, limits, least * (1 - 1e-12)) is not None
    assert straight(q0, q1, limits, float("nan")) is None


def test_standing_still_takes_any_time() -> None:
    limits = Limits([1.0], [-1.0], [1.0], [-1.0], [1.0])
    profile = straight([0.5], [0.5], limits, 0.25)
    assert profile is not None
    assert profile.duration == 0.25
    assert profile.evaluate(np.linspace(0, 0.25, 7))[:, 0].tolist() == [0.5] * 7


def test_the_phases_are_those_of_the_closed_form() -> None:
    rng = np.random.default_rng(0)
    for v, a, j in 10 ** rng.uniform(-2, 4, (2000, 3)):
        ramp, plateau, _, cruise, *_ = lengths = phase_lengths(v, a, j)
        reached = j * ramp * (ramp + plateau)
        assert reached * (2 * ramp + plateau + cruise) == pytest.approx(1, rel=1e-12)
        assert sum(lengths) == pytest.approx(float(rest_to_rest_time(1.0, v, a, j)), rel=1e-12)
        assert reached <= v * (1 + 1e-12)
        assert j * ramp <= a * (1 + 1e-12)
