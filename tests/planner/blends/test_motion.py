"""The motion of parabolic blends against its formulas, and its times: limits are kept, what is given is kept or refused
with its number, little is wasted."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from assur.experiments.printed_joint_move import ParabolicBlend as Printed
from assur.planner.blends.law import RESERVE, STATED_S, ParabolicBlend, fastest, with_acceleration_time
from assur.planner.trajectory import Trajectory
from tests.planner.timing.least import least_duration
from tests.planner.trajectory.splines import bernstein, keeps_limits

Floats = NDArray[np.float64]
PAGE = Path(__file__).parents[3] / "docs" / "kinematics.md"


def law(seed: int, count: int = 5, n: int = 3, *, meeting: bool = False) -> ParabolicBlend:
    """A random law; `meeting`: every other segment has no straight piece."""
    rng = np.random.default_rng(seed)
    tau = rng.uniform(0.01, 0.2, count)
    straight = rng.uniform(1e-3, 0.3, count - 1)
    if meeting:
        straight[::2] = 0.0
    return ParabolicBlend(rng.uniform(-3, 3, (count, n)), tau[1:] + tau[:-1] + straight, tau)


def path(made: ParabolicBlend, begin: float = 0.0) -> Trajectory:
    return Trajectory.of_knots(made.knots(begin), jumps=True)


laws = st.builds(law, st.integers(0, 10**6), st.integers(2, 7), st.integers(1, 4), meeting=st.booleans())


@given(laws, st.floats(-5, 50))
def test_the_knots_are_the_formulas_of_both_zones_and_every_piece_is_a_parabola(
    made: ParabolicBlend, begin: float
) -> None:
    motion, v, ends = path(made, begin), made.velocities, [0.0, *(made.passed + made.tau)]
    assert motion.start == begin
    assert motion.end == pytest.approx(begin + made.duration, abs=1e-13 * (1 + abs(begin)))
    assert motion.rest_at_start
    assert motion.rest_at_end
    assert (motion.q[[0, -1]] == made.poses[[0, -1]]).all()
    # times are rounded by some 1e-14 s
    off, off_rate = 1e-12 + 1e-13 * np.abs(v).max(), 1e-10 + 1e-13 * np.abs(made.accelerations).max()
    for k, (pose, t, tau) in enumerate(zip(made.poses, made.passed, made.tau, strict=True)):
        s = np.linspace(-tau, tau, 21)[:, None]
        zone = pose - v[k] * (tau - s) ** 2 / (4 * tau) + v[k + 1] * (tau + s) ** 2 / (4 * tau)  # (B1)
        rate = v[k] * (tau - s) / (2 * tau) + v[k + 1] * (tau + s) / (2 * tau)
        inside = np.clip(begin + t + s[:, 0], motion.start, motion.end)
        assert np.abs(motion.evaluate(inside) - zone).max() <= off
        assert np.abs(motion.evaluate(inside, 1) - rate).max() <= off_rate
        if k:
            s = np.linspace(ends[k] - t, -tau, 9)[:, None]
            assert np.abs(motion.evaluate(begin + t + s[:, 0]) - (pose + v[k] * s)).max() <= off  # (B2)
    pull = bernstein(motion, 2)
    assert (pull.max(-1) - pull.min(-1)).max() <= 1e-6
    # two knots at a time wherever the acceleration jumps, at the ends too
    zones = len(made.poses) + int((made.segments - made.tau[1:] - made.tau[:-1] > 1e-12).sum())
    assert len(motion.steps) == zones
    assert len(motion.time) == 2 * zones + 2


@given(laws)
def test_a_pose_is_missed_by_a_quarter_of_tau_times_the_change_of_velocity(made: ParabolicBlend) -> None:
    inner, v, motion = slice(1, -1), made.velocities, path(made)
    missed = motion.evaluate(made.passed[inner]) - made.poses[inner]
    assert np.abs(missed - made.tau[inner, None] * (v[2:-1] - v[1:-2]) / 4).max(initial=0.0) <= 1e-11
    assert np.abs(missed - made.missed_by[inner]).max(initial=0.0) <= 1e-11
    assert not made.missed_by[[0, -1]].any()


def test_with_one_tau_and_equal_segments_it_is_the_reading_of_the_source() -> None:
    poses = np.random.default_rng(1).normal(size=(4, 3))
    ours, theirs = ParabolicBlend(poses, np.full(3, 0.5), np.full(4, 0.1)), Printed(poses, 0.5, 0.1)
    assert ours.duration == pytest.approx(theirs.duration) == pytest.approx(1.7)
    t = np.linspace(0.0001, 1.6999, 997)  # not on a jump
    for order, exact in enumerate((1e-12, 1e-11, 1e-9)):
        assert np.abs(path(ours).evaluate(t, order) - theirs.evaluate(t, order)).max() <= exact
    assert np.abs(ours.missed_by[1:-1] - theirs.missed_by[1:-1]).max() <= 1e-15


def test_a_pose_without_a_change_of_velocity_has_no_jump() -> None:
    made = ParabolicBlend(np.array([[0.0], [1.0], [2.0]]), np.full(2, 0.5), np.full(3, 0.1))
    motion = path(made)
    assert motion.time.tolist() == pytest.approx([0, 0, 0.2, 0.2, 0.5, 0.7, 1.0, 1.0, 1.2, 1.2])
    assert np.flatnonzero(motion.qdd[:, 0]).tolist() == [1, 2, 7, 8]
    assert not made.missed_by.any()


def test_the_equations_that_the_code_cites_are_on_the_page() -> None:
    folder = PAGE.parents[1] / "planner" / "blends"
    cited = set(re.findall(r"\bB\d\b", (folder / "law.py").read_text(encoding="utf-8")))
    assert cited == set(re.findall(r"\((B\d)\)\s*$", PAGE.read_text(encoding="utf-8"), re.MULTILINE))
    assert len(cited) == 7


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
    return keeps_limits(path(made, begin), LOWER, UPPER, SPEED, PULL, None)


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
    joint, facts = made
    assert facts.needed > facts.limit == PULL[joint]
    enough = facts.enough_s
    if enough is not None:
        assert enough > asked
        for sooner in np.linspace(asked, enough - 1.1 * STATED_S, 60) if enough > asked + 3 * STATED_S else ():
            assert isinstance(with_acceleration_time(poses, SPEED, PULL, float(sooner)), tuple)
        better = with_acceleration_time(poses, SPEED, PULL, enough)
        assert isinstance(better, ParabolicBlend)
        assert keeps(better)


def test_a_refusal_names_the_joint_and_the_numbers_of_the_source() -> None:
    """θ2 turns back from −450 to 450 °/s: 78.5 rad/s² in 200 ms."""
    turn = np.pi / 2
    poses = np.array([[0.0, turn, -0.1, -turn], [turn, -turn, -0.2, 0.0], [0.0, turn, -0.1, -turn]])
    speed, pull = np.radians([300.0, 450.0, 6000.0, 600.0]), np.array([50.0, 60.0, 50.0, 50.0])
    found = with_acceleration_time(poses, speed, pull, 0.2)
    assert isinstance(found, tuple)
    joint, facts = found
    assert (joint, facts.limit) == (1, 60.0)
    assert facts.needed == pytest.approx(2 * np.radians(450) / 0.2)
    assert facts.enough_s == pytest.approx(0.2 * facts.needed / 60, abs=STATED_S)
    kept = with_acceleration_time(poses, speed, np.full(4, 80.0), 0.2)
    assert isinstance(kept, ParabolicBlend)
    assert kept.duration == pytest.approx(1.0)
