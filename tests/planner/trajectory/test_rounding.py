"""Short pieces keep their jerk through the rounding of knots."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.trajectory import Trajectory
from assur.planner.trajectory.rounding import defect, moved, settled
from tests.planner.trajectory.splines import constant_jerk

JERK = 300.0


def with_short_piece(h: float, seed: int, place: int = 3) -> Trajectory:
    """Seven pieces of constant jerk, one of them of length h, near q = 3 and t = 5 s at 2 rad/s."""
    rng = np.random.default_rng(seed)
    steps = rng.uniform(0.02, 0.05, 7)
    steps[place] = h
    time = 5 + np.concatenate([[0.0], np.cumsum(steps)])
    return constant_jerk(time, JERK * rng.uniform(-1, 1, (7, 2)), np.array([[3.0, -2.5], [2.0, -1.0], [1.0, 2.0]]))


def jerk_error(path: Trajectory, wanted: Trajectory) -> float:
    """By how much jerk departs from the mean of each piece of `wanted`."""
    mean = np.diff(wanted.qdd, axis=0) / wanted.steps[:, None]
    return float(np.abs(path.bernstein(3) - mean[..., None]).max())


@pytest.mark.parametrize("h", [1e-6, 1e-5, 1e-4])
@pytest.mark.parametrize("place", [1, 3, 5])
def test_a_settled_piece_keeps_its_jerk_where_a_rounded_one_loses_it(h: float, place: int) -> None:
    rounded, mended = [], []
    for seed in range(40):
        path = with_short_piece(h, seed, place)
        rounded.append(jerk_error(path, path))
        left_over = defect(path.steps, path.q, path.qd, path.qdd)
        qd, qdd = settled(path.steps, path.qd, path.qdd, left_over)
        assert np.abs(qd - path.qd).max() <= 1e-15 / h * 3
        assert np.array_equal(qd[[0, -1]], path.qd[[0, -1]])
        assert np.array_equal(qdd[[0, -1]], path.qdd[[0, -1]])
        mended.append(jerk_error(Trajectory(path.time, path.q, qd, qdd), path))
    assert max(mended) <= 1e-3 * JERK
    if h < 1e-5:
        assert min(rounded) > 0.1 * JERK


@pytest.mark.parametrize("place", [0, 6])
def test_a_short_piece_at_an_end_keeps_its_jerk_to_six_roundings_over_its_length_cubed(place: int) -> None:
    h = 1e-5
    for seed in range(40):
        path = with_short_piece(h, seed, place)
        left_over = defect(path.steps, path.q, path.qd, path.qdd)
        qd, qdd = settled(path.steps, path.qd, path.qdd, left_over)
        found = Trajectory(path.time, path.q, qd, qdd)
        bound = 6 * np.abs(left_over[place]).max() / h**3
        assert jerk_error(found, path) <= bound * 1.05 + 1e-3 * JERK
        assert jerk_error(path, path) >= 0.9 * 60 / 6 * bound - 1e-3 * JERK


def test_a_moved_time_and_what_rounding_took_are_exact_together() -> None:
    rng = np.random.default_rng(0)
    time, by = rng.uniform(0, 3, 1000), 0.1 + 1e-9
    total, rest = moved(time, by)
    assert np.array_equal(total, time + by)
    for a, s, r in zip(time.tolist(), total.tolist(), rest.tolist(), strict=True):
        # Integers hold a sum of doubles exactly.
        assert sum(int(x * 2.0**80) for x in (a, by)) == sum(int(x * 2.0**80) for x in (s, r))


def test_two_knots_have_nothing_to_give() -> None:
    path = constant_jerk(np.array([0.0, 1e-5]), np.ones((1, 1)), np.ones((3, 1)))
    qd, qdd = settled(path.steps, path.qd, path.qdd, np.ones((1, 1)))
    assert np.array_equal(qd, path.qd)
    assert np.array_equal(qdd, path.qdd)
