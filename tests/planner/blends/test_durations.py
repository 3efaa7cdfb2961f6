"""Times of parabolic blends: limits are kept, what is given is kept or refused with its number, little is wasted."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from assur.planner.blends.durations import RESERVE, TOLD_S, TooShort, fastest, with_acceleration_time
from assur.planner.blends.law import ParabolicBlend
from assur.planner.errors import InputError
from assur.planner.trajectory import Trajectory, check_limits
from tests.planner.timing.least import least_duration

Floats = NDArray[np.float64]
LOWER, UPPER = np.array([-2.3, -2.6, 0.05, -6.3]), np.array([2.3, 2.6, 0.25, 6.3])
SPEED, PULL = np.array([7.8, 9.4, 2.0, 40.0]), np.array([50.0, 80.0, 25.0, 300.0])
REGIMES = ("any", "still", "collinear", "tiny", "one joint", "there and back")


def chain(seed: int, count: int, regime: str) -> Floats:
    """Poses (count, 4) within limits."""
    rng = np.random.default_rng(seed)
    poses: Floats = rng.uniform(LOWER, UPPER, (count, 4))
    if regime == "still":
        poses[1] = poses[0]
    if regime == "collinear":
        poses = poses[0] + np.linspace(0, 1, count)[:, None] * (poses[-1] - poses[0])
    if regime == "tiny":
        poses = np.clip(poses[0] + 1e-6 * rng.normal(size=poses.shape), LOWER, UPPER)
    if regime == "one joint":
        poses[:, 1:] = poses[0, 1:]
    if regime == "there and back":
        poses[::2] = poses[0]
    return poses


def keeps(made: ParabolicBlend, begin: float = 0.0) -> bool:
    """By the exact extrema of the spline through the knots."""
    path = Trajectory(*made.knots(begin), jumps=True)
    report = check_limits(path, LOWER, UPPER, SPEED, PULL, None)
    assert report.jerk is None
    return report.ok


@given(st.integers(0, 10**6), st.integers(2, 8), st.sampled_from(REGIMES), st.floats(0, 60))
def test_the_fastest_chain_keeps_every_limit_at_every_instant(seed: int, count: int, regime: str, begin: float) -> None:
    assert keeps(fastest(chain(seed, count, regime), SPEED, PULL), begin)


@given(st.integers(0, 10**6), st.integers(2, 8), st.sampled_from(REGIMES))
def test_the_fastest_chain_uses_some_limit_up_and_is_the_same_again(seed: int, count: int, regime: str) -> None:
    poses = chain(seed, count, regime)
    made, again = fastest(poses, SPEED, PULL), fastest(poses.copy(), SPEED, PULL)
    assert made.segments.tobytes() == again.segments.tobytes()
    assert made.tau.tobytes() == again.tau.tobytes()
    share = max((np.abs(made.velocities) / SPEED).max(), (np.abs(made.accelerations) / PULL).max())
    if regime != "tiny" and (poses[1:] != poses[:-1]).any():
        assert share >= 1 - 2 * RESERVE


@given(st.integers(0, 10**6), st.sampled_from([regime for regime in REGIMES if regime != "still"]))
def test_a_single_segment_is_the_shortest_that_its_joints_can_do_together(seed: int, regime: str) -> None:
    """The slowest joint alone takes no less where one joint decides; and no chain beats the double integrator."""
    poses = chain(seed, 2, regime)
    made, none = fastest(poses, SPEED, PULL), np.zeros(4)
    way = np.abs(poses[1] - poses[0])
    bound = float(least_duration(poses[0], none, none, poses[1], none, none, SPEED, PULL, None))
    assert made.duration >= bound
    v, a = (SPEED[way > 0] / way[way > 0]).min(initial=np.inf), (PULL[way > 0] / way[way > 0]).min(initial=np.inf)
    together = 1 / v + v / a if v * v <= a else 2 / np.sqrt(a)
    assert made.duration <= max(together * (1 + 1e-6), 4e-3 + 2e-5)


def test_one_joint_alone_takes_what_the_double_integrator_takes() -> None:
    none = np.zeros(1)
    for way in (0.02, 0.3, 4.0):
        made = fastest(np.array([[0.0], [way]]), SPEED[:1], PULL[:1])
        ends = np.array([0.0]), none, none, np.array([way]), none, none
        bound = float(least_duration(*ends, SPEED[:1], PULL[:1], None))
        assert made.duration == pytest.approx(bound, rel=1e-6)
        assert bound < float(least_duration(*ends, SPEED[:1], PULL[:1], 20 * PULL[:1]))


def test_of_two_segments_no_proportion_on_a_fine_grid_is_shorter_by_a_thousandth() -> None:
    for seed in range(12):
        poses = chain(seed, 3, "any")
        made = fastest(poses, SPEED, PULL)
        others = [
            fastest(poses, SPEED, PULL, np.array([share, 1 - share])).duration for share in np.linspace(0.02, 0.98, 97)
        ]
        assert made.duration <= min(others) * 1.001


def test_of_three_segments_no_proportion_on_a_grid_is_shorter_by_half_a_per_cent() -> None:
    for seed in range(4):
        poses = chain(seed, 4, "any")
        shares = np.geomspace(0.1, 1.0, 14)
        others = [
            fastest(poses, SPEED, PULL, np.array(triple)).duration for triple in itertools.product(shares, repeat=3)
        ]
        assert fastest(poses, SPEED, PULL).duration <= min(others) * 1.005


@given(st.integers(0, 10**6), st.integers(2, 7), st.sampled_from(REGIMES), st.floats(2e-3, 1.0))
def test_a_given_acceleration_time_is_kept_to_the_letter_or_refused_with_what_would_do(
    seed: int, count: int, regime: str, asked: float
) -> None:
    poses = chain(seed, count, regime)
    made = with_acceleration_time(poses, SPEED, PULL, asked)
    if isinstance(made, ParabolicBlend):
        assert (made.tau == asked / 2).all()
        assert keeps(made)
        least = np.maximum((np.abs(np.diff(poses, axis=0)) / SPEED).max(1), asked)
        assert (made.segments <= least + 1.1e-5).all()
        return
    assert made.needed > made.limit == PULL[made.joint]
    if made.enough is not None:
        assert made.enough > asked
        for sooner in np.linspace(asked, made.enough - 1.1 * TOLD_S, 60) if made.enough > asked + 3 * TOLD_S else ():
            assert isinstance(with_acceleration_time(poses, SPEED, PULL, float(sooner)), TooShort)
        better = with_acceleration_time(poses, SPEED, PULL, made.enough)
        assert isinstance(better, ParabolicBlend)
        assert keeps(better)


def test_a_refusal_names_the_joint_the_pose_and_the_numbers_of_the_source() -> None:
    """θ2 turns back from −450 to 450 °/s: 78.5 rad/s² in 200 ms."""
    turn = np.pi / 2
    poses = np.array([[0.0, turn, -0.1, -turn], [turn, -turn, -0.2, 0.0], [0.0, turn, -0.1, -turn]])
    speed, pull = np.radians([300.0, 450.0, 6000.0, 600.0]), np.array([50.0, 60.0, 50.0, 50.0])
    found = with_acceleration_time(poses, speed, pull, 0.2)
    assert isinstance(found, TooShort)
    assert (found.joint, found.pose, found.limit) == (1, 1, 60.0)
    assert found.needed == pytest.approx(2 * np.radians(450) / 0.2)
    assert found.enough == pytest.approx(0.2 * found.needed / 60, abs=TOLD_S)
    kept = with_acceleration_time(poses, speed, np.full(4, 80.0), 0.2)
    assert isinstance(kept, ParabolicBlend)
    assert kept.duration == pytest.approx(1.0)


@pytest.mark.parametrize("asked", [0.0, 1.9e-3, -1.0, np.nan, np.inf])
def test_an_acceleration_time_that_cannot_be_written_is_refused(asked: float) -> None:
    with pytest.raises(InputError) as caught:
        with_acceleration_time(np.array([[0.0], [1.0]]), np.ones(1), np.ones(1), asked)
    assert caught.value.field == "acceleration_time_s"
