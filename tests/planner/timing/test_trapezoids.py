"""Trapezoids: they meet their ends, keep to their acceleration, and are about as quick as the solver's motions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.timing.trapezoids import Trapezoids, mean_acceleration, stopping_distance, trapezoid_time
from tests.planner.cells import limits

V, A, J = limits().velocity, limits().acceleration, limits().jerk
SLOW = mean_acceleration(V, A, J)


def states(seed: int, count: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Positions and velocities (N, 4) of both ends; some at rest."""
    rng = np.random.default_rng(seed)
    q0, q1 = rng.uniform(-2.0, 2.0, (2, count, 4))
    v0, v1 = rng.uniform(-0.9, 0.9, (2, count, 4)) * V * (rng.random((2, count, 1)) < 0.7)
    return q0, v0, q1, v1


@given(st.integers(0, 10**6), st.sampled_from([0.0, 1e-6, 0.01, 0.3, 4.0]))
def test_a_profile_of_any_duration_that_is_long_enough_meets_both_ends(seed: int, spare: float) -> None:
    q0, v0, q1, v1 = states(seed, 50)
    duration = trapezoid_time(q0, v0, q1, v1, V, SLOW) + spare
    found = Trapezoids.of(q0, v0, q1, v1, SLOW, duration)
    h = 1e-7
    np.testing.assert_allclose(found.at(np.zeros(50)), q0, atol=1e-12)
    met = found.meets()
    assert met.mean() > 0.95
    assert met.all() or spare < 4.0  # no duration that is much longer is blocked
    np.testing.assert_allclose(found.at(duration)[met], q1[met], atol=1e-6)
    if spare > 1e-3:
        np.testing.assert_allclose((found.at(np.full(50, h)) - q0) / h, v0, atol=1e-3 + 2 * h * SLOW.max())
        np.testing.assert_allclose(((q1 - found.at(duration - h)) / h)[met], v1[met], atol=1e-3 + 2 * h * SLOW.max())
    assert (np.abs(found.cruise) <= V * (1 + 1e-6))[met].all()


def test_a_joint_that_is_too_fast_at_both_ends_for_what_time_is_left_is_told_to_miss_its_end() -> None:
    """5 mm at 1 m/s take 5 ms; to be 20 ms late it would have to brake, and the way is too short for that."""
    q0, q1, v = np.zeros(1), np.full(1, 0.005), np.full(1, 1.0)
    rate, speed = np.full(1, 25.0), np.full(1, 2.0)
    least = trapezoid_time(q0, v, q1, v, speed, rate)
    for spare, possible in ((0.0, True), (0.02, False), (0.3, True)):
        assert Trapezoids.of(q0, v, q1, v, rate, least + spare).meets().all() == possible


@given(st.integers(0, 10**6))
def test_no_profile_changes_its_velocity_faster_than_it_may(seed: int) -> None:
    q0, v0, q1, v1 = states(seed, 20)
    duration = trapezoid_time(q0, v0, q1, v1, V, SLOW) * np.linspace(1.0, 3.0, 20)
    found = Trapezoids.of(q0, v0, q1, v1, SLOW, duration)
    t = np.linspace(0.0, duration, 400)
    q = np.stack([found.at(row) for row in t])
    step = duration / 399
    curved = np.diff(q, 2, axis=0) / step[None, :, None] ** 2
    assert (np.abs(curved) <= SLOW * (1 + 1e-6) + 1e-9 / step.min() ** 2).all()


@given(st.integers(0, 10**6))
def test_the_turning_points_of_a_profile_are_its_extremes(seed: int) -> None:
    """With no limit of jerk, the closed form is the extremum of the profile itself."""
    q0, v0, q1, v1 = states(seed, 30)
    duration = trapezoid_time(q0, v0, q1, v1, V, SLOW) + 0.2
    found = Trapezoids.of(q0, v0, q1, v1, SLOW, duration)
    turning = np.concatenate([found.turning_points(SLOW, np.full(4, 1e15)), [q0, q1]])
    q = np.stack([found.at(row) for row in np.linspace(0.0, duration, 4001)])
    met = found.meets()
    np.testing.assert_allclose(q.max(0)[met], turning.max(0)[met], atol=1e-5)
    np.testing.assert_allclose(q.min(0)[met], turning.min(0)[met], atol=1e-5)


def test_a_joint_that_meets_a_limit_at_speed_comes_from_beyond_it() -> None:
    """What a jerk-limited joint needs to get to a speed is what it needs to stop from it, by time reversal."""
    speed, rate, jerk = np.array([1.613]), np.array([80.0]), np.array([1600.0])
    onset = np.sqrt(2 * speed / jerk)  # all of it while the acceleration builds up
    assert stopping_distance(speed, rate, jerk) == pytest.approx(speed * onset * 2 / 3)
    fast = np.array([9.0])
    full = rate / jerk
    left = fast - rate * full / 2
    expected = fast * full - jerk * full**3 / 6 + left**2 / (2 * rate)
    assert stopping_distance(fast, rate, jerk) == pytest.approx(expected)
    assert stopping_distance(np.zeros(1), rate, jerk) == 0.0
