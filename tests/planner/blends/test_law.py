"""The law of parabolic blends against its formulas, and its knots against the law."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from assur.experiments.printed_joint_move import ParabolicBlend as Printed
from assur.planner.blends.law import SHORTEST, ParabolicBlend
from assur.planner.errors import InputError
from assur.planner.trajectory import Trajectory
from tests.planner.trajectory.splines import bernstein

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


def zone(made: ParabolicBlend, k: int, s: Floats) -> Floats:
    """B1 as it is written."""
    v1, v2, tau = made.velocities[k], made.velocities[k + 1], made.tau[k]
    s = s[:, None]
    found: Floats = made.poses[k] - v1 * (tau - s) ** 2 / (4 * tau) + v2 * (tau + s) ** 2 / (4 * tau)
    return found


laws = st.builds(law, st.integers(0, 10**6), st.integers(2, 7), st.integers(1, 4), meeting=st.booleans())


@given(laws)
def test_zone_one_is_the_formula_and_joins_zone_two_in_place_and_speed(made: ParabolicBlend) -> None:
    for k, (t, tau) in enumerate(zip(made.passed, made.tau, strict=True)):
        s = np.linspace(-tau, tau, 21)
        assert np.abs(made.evaluate(t + s) - zone(made, k, s)).max() <= 1e-13
        ends = zone(made, k, np.array([-tau, tau]))
        for end, v, side in zip(ends, made.velocities[k : k + 2], (-1, 1), strict=True):
            assert np.abs(end - (made.poses[k] + side * tau * v)).max() <= 1e-13
            # from both sides of the end of the zone
            around = t + side * tau + np.array([-1e-9, 1e-9])
            q, qd = made.evaluate(around), made.evaluate(around, 1)
            assert np.abs(q - end).max() <= 1e-9 * np.abs(v).max() + 1e-12
            assert np.abs(qd - v).max() <= 2e-9 * np.abs(made.accelerations).max() + 1e-9


@given(laws)
def test_a_pose_is_missed_by_a_quarter_of_tau_times_the_change_of_velocity(made: ParabolicBlend) -> None:
    inner = slice(1, -1)
    v = made.velocities
    missed = made.evaluate(made.passed[inner]) - made.poses[inner]
    assert np.abs(missed - made.tau[inner, None] * (v[2:-1] - v[1:-2]) / 4).max(initial=0.0) <= 1e-13
    assert np.abs(missed - made.missed_by[inner]).max(initial=0.0) <= 1e-13
    assert not made.missed_by[[0, -1]].any()
    ends = made.evaluate(np.array([0.0, made.duration]))
    assert np.abs(ends - made.poses[[0, -1]]).max() <= 1e-14
    assert np.abs(made.evaluate(np.array([0.0, made.duration]), 1)).max() <= 1e-12


def test_with_one_tau_and_equal_segments_it_is_the_reading_of_the_source() -> None:
    poses = np.random.default_rng(1).normal(size=(4, 3))
    ours, theirs = ParabolicBlend(poses, np.full(3, 0.5), np.full(4, 0.1)), Printed(poses, 0.5, 0.1)
    assert ours.duration == pytest.approx(theirs.duration) == pytest.approx(1.7)
    t = np.linspace(0.0001, 1.6999, 997)  # not on a jump
    for order in range(3):
        assert np.abs(ours.evaluate(t, order) - theirs.evaluate(t, order)).max() <= 1e-11
    assert np.abs(ours.missed_by[1:-1] - theirs.missed_by[1:-1]).max() <= 1e-15


@given(laws, st.floats(-5, 50))
def test_the_knots_are_the_law_and_every_piece_is_a_parabola(made: ParabolicBlend, begin: float) -> None:
    path = Trajectory(*made.knots(begin), jumps=True)
    assert path.start == begin
    assert path.end == pytest.approx(begin + made.duration, abs=1e-13 * (1 + abs(begin)))
    assert path.rest_at_start
    assert path.rest_at_end
    assert (path.q[[0, -1]] == made.poses[[0, -1]]).all()
    t = np.linspace(0, made.duration, 400)[1:-1]
    for order, exact in ((0, 1e-12), (1, 1e-10)):
        assert np.abs(path.evaluate(t + begin, order) - made.evaluate(t, order)).max() <= exact
    pull = bernstein(path, 2)
    assert (pull.max(-1) - pull.min(-1)).max() <= 1e-6
    # two at a time wherever the acceleration jumps, at the ends too
    zones = len(made.poses) + int((made._straight > 1e-12).sum())
    assert len(path.steps) == zones
    assert len(path.time) == 2 * zones + 2


def test_a_pose_without_a_change_of_velocity_has_no_jump() -> None:
    poses = np.array([[0.0], [1.0], [2.0]])
    made = ParabolicBlend(poses, np.full(2, 0.5), np.full(3, 0.1))
    time, _, _, qdd = made.knots()
    assert time.tolist() == pytest.approx([0, 0, 0.2, 0.2, 0.5, 0.7, 1.0, 1.0, 1.2, 1.2])
    assert np.flatnonzero(qdd[:, 0]).tolist() == [1, 2, 7, 8]
    assert Trajectory(*made.knots(), jumps=True).time.shape == (10,)
    assert not made.missed_by.any()


@pytest.mark.parametrize(
    ("poses", "segments", "tau", "field"),
    [
        (np.zeros((1, 2)), np.zeros(0), np.ones(1), "poses"),
        (np.full((2, 2), np.nan), np.ones(1), np.full(2, 0.1), "poses"),
        (np.zeros((2, 2)), np.ones(2), np.full(2, 0.1), "segments"),
        (np.zeros((2, 2)), np.array([np.nan]), np.full(2, 0.1), "segments"),
        (np.zeros((2, 2)), np.ones(1), np.array([0.1, 0.0]), "tau"),
        (np.zeros((2, 2)), np.ones(1), np.array([0.1, np.inf]), "tau"),
        (np.zeros((2, 2)), np.array([0.19]), np.full(2, 0.1), "segments[0]"),
        (np.zeros((2, 2)), np.array([0.2 + SHORTEST / 2]), np.full(2, 0.1), "segments[0]"),
    ],
)
def test_what_is_no_law_is_refused(poses: Floats, segments: Floats, tau: Floats, field: str) -> None:
    with pytest.raises(InputError) as caught:
        ParabolicBlend(poses, segments, tau)
    assert caught.value.field == f"parabolic_blend.{field}"


def test_the_equations_that_the_code_cites_are_on_the_page() -> None:
    folder = PAGE.parents[1] / "planner" / "blends"
    cited = set()
    for name in ("law", "durations"):
        cited |= set(re.findall(r"\bB\d\b", (folder / f"{name}.py").read_text(encoding="utf-8")))
    assert cited == set(re.findall(r"\((B\d)\)\s*$", PAGE.read_text(encoding="utf-8"), re.MULTILINE))
    assert len(cited) == 7
