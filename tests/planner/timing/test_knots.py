"""Knots from phases: jerks are means of the profile's, ends are exact, switches that nearly coincide share a knot."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.errors import FaultError
from assur.planner.kernels import knots
from assur.planner.kernels.knots import DURATION, MERGE, knots_of_phases, missed_goal, shared_switches
from assur.planner.timing import RawProfile, TimingRefusal, trajectory_of
from tests.planner.timing.legs import KINDS, ROBOTS, Floats, Question, question
from tests.planner.trajectory.splines import bernstein


def timed(seed: int, robot: str, kind: str, n: int) -> tuple[Question, RawProfile]:
    one = question(np.random.default_rng(seed), robot, kind, n, least=1e-3)
    found = one.solver.raw_profile(*one.states)
    assert not isinstance(found, TimingRefusal)
    return one, found


PROFILES = st.builds(timed, st.integers(0, 10**6), st.sampled_from(ROBOTS), st.sampled_from(KINDS), st.integers(1, 5))


def own(profile: RawProfile, t: Floats) -> tuple[Floats, Floats, Floats]:
    """q, q̇, q̈ (T, n) at times t by summing up phase after phase, a joint and a time at once: plain and slow."""
    states = np.empty((3, len(t), len(profile.phases)))
    for joint, (lengths, jerks) in enumerate(profile.phases):
        for k, time in enumerate(t):
            q, v, a = (row[joint] for row in profile.begin)
            left = float(time)
            for h, j in [*zip(lengths, jerks, strict=True), (math.inf, 0.0)]:
                tau = min(h, left)
                q, v, a = q + tau * (v + tau * (a / 2 + tau * j / 6)), v + tau * (a + tau * j / 2), a + tau * j
                left -= tau
            states[:, k, joint] = q, v, a
    return states[0], states[1], states[2]


@given(PROFILES, st.floats(0, 30))
def test_a_trajectory_is_near_the_profile_and_repeats_its_ends_to_the_bit(
    pair: tuple[Question, RawProfile], begin: float
) -> None:
    one, profile = pair
    path = trajectory_of([profile], [begin, begin + profile.duration])
    assert (path.start, path.end) == (begin, begin + profile.duration)
    for k, states in ((0, one.start), (-1, one.goal)):
        for have, wanted in zip((path.q[k], path.qd[k], path.qdd[k]), states, strict=True):
            assert np.array_equal(have, wanted)
    t = np.linspace(0, profile.duration, 40)
    # a switch of 2 J that is a merge beside its knot moves the velocity by J · merge · h
    off = 2 * one.jerk * MERGE * profile.duration
    allowed = off * profile.duration, 10 * off, 10 * off / profile.duration + 2 * one.jerk * MERGE
    for order, (have, most) in enumerate(zip(own(profile, t), allowed, strict=True)):
        inside = np.minimum(begin + t, path.end)
        assert (np.abs(path.evaluate(inside, order) - have) <= most + 1e-9).all()


@given(PROFILES)
def test_the_jerk_of_a_piece_is_a_mean_of_the_profiles(pair: tuple[Question, RawProfile]) -> None:
    """But for what makes the end exact, and for rounding."""
    one, profile = pair
    path = trajectory_of([profile], [0.0, profile.duration])
    _, _, a = own(profile, path.time)
    mean = (a[1:] - a[:-1]) / path.steps[:, None]
    ends = 120 * 2 * one.jerk * MERGE / profile.duration
    rounding = 200 * 4.4e-16 * np.abs(path.q).max() / path.steps[:, None] ** 3
    assert (np.abs(bernstein(path, 3) - mean[..., None]) <= (ends + rounding + 1e-6 * one.jerk)[..., None]).all()


@given(PROFILES)
def test_knots_are_no_closer_than_half_a_merge_and_every_switch_is_near_one(pair: tuple[Question, RawProfile]) -> None:
    _, profile = pair
    path = trajectory_of([profile], [0.0, profile.duration])
    assert path.steps.min() >= min(MERGE / 2, profile.duration)
    switches = np.cumsum(profile.phases[:, DURATION], axis=1).ravel()
    assert np.abs(switches[:, None] - path.time).min(1).max() <= MERGE


def test_switches_share_a_knot_where_they_are_near_and_have_their_own_where_they_are_not() -> None:
    phases = np.zeros((2, 2, 3))
    phases[0, DURATION] = [0.1, 0.1, 0.1]
    phases[1, DURATION] = [0.1 + MERGE / 2, 0.1, 0.1 - MERGE / 2]
    times = np.empty(8)
    count = shared_switches(phases, 0.3, times)
    assert times[:count] == pytest.approx([0.0, 0.1 + MERGE / 4, 0.2 + MERGE / 4, 0.3])
    phases[1, DURATION, 0] = 0.1 + 2 * MERGE
    count = shared_switches(phases, 0.3, times)
    assert times[:count] == pytest.approx([0.0, 0.1, 0.1 + 2 * MERGE, 0.2, 0.2 + 2 * MERGE, 0.3])
    with pytest.raises(IndexError):
        shared_switches(phases, 0.3, np.empty(2))


def test_legs_in_a_row_pass_the_states_between_them_and_a_leg_without_phases_stands() -> None:
    one, first = timed(3, "problems", "rest", 3)
    goal = [row[::-1] for row in first.goal]
    second = one.solver.raw_profile(first.goal, (goal[0], goal[1], goal[2]))
    assert not isinstance(second, TimingRefusal)
    stands = RawProfile(0.5, first.goal, first.goal, np.zeros((3, 2, 1)))
    begins = [1.0, 1.0 + first.duration, 1.5 + first.duration, 1.5 + first.duration + second.duration]
    path = trajectory_of([first, stands, second], begins)
    for begin, state in zip(begins, (first.begin, first.goal, first.goal, second.goal), strict=True):
        k = int(np.flatnonzero(path.time == begin)[0])
        assert (path.q[k].tolist(), path.qd[k].tolist(), path.qdd[k].tolist()) == state
    t = np.linspace(begins[1], begins[2], 20)
    assert np.abs(path.evaluate(t) - first.goal[0]).max() <= 1e-12
    alone = trajectory_of([second], begins[2:])
    t = np.linspace(begins[2], begins[3], 50)
    assert np.abs(path.evaluate(t) - alone.evaluate(t)).max() <= 1e-12


@pytest.mark.parametrize("begins", [[0.0, 0.0], [1.0, 0.5], [0.0, math.nan]])
def test_times_that_do_not_increase_are_a_fault(begins: list[float]) -> None:
    _, profile = timed(1, "real", "rest", 2)
    with pytest.raises(FaultError):
        trajectory_of([profile], begins)


@given(PROFILES, st.integers(0, 4), st.sampled_from([1e-7, 1e-3, math.nan, math.inf]))
def test_a_miss_is_the_distance_from_the_goal_in_units_of_what_is_allowed(
    pair: tuple[Question, RawProfile], joint: int, off: float
) -> None:
    one, profile = pair
    joint %= one.n
    start, goal = np.array([profile.begin, profile.goal])
    units = 1e-7, 1e-7, 1e-6
    assert missed_goal(start, goal, profile.phases, profile.duration, *units) <= 1
    for order, unit in enumerate(units):
        moved = goal.copy()
        moved[order, joint] += off
        have = missed_goal(start, moved, profile.phases, profile.duration, *units)
        assert have == pytest.approx(off / unit, abs=1.0) if math.isfinite(off) else have == math.inf
    broken = profile.phases.copy()
    broken[joint, DURATION, 3] = math.nan
    assert missed_goal(start, goal, broken, profile.duration, *units) == math.inf


@given(PROFILES)
def test_compiled_knots_are_those_of_plain_python(pair: tuple[Question, RawProfile]) -> None:
    _, profile = pair
    begins, states = np.array([0.3, 0.3 + profile.duration]), np.array([profile.begin, profile.goal])
    plain = getattr(knots_of_phases, "py_func", knots_of_phases)
    compiled = knots_of_phases(begins, states, profile.phases[None])
    assert np.array_equal(plain(begins, states, profile.phases[None]), compiled)


def test_every_kernel_has_one_signature() -> None:
    for kernel in (knots.missed_goal, knots.shared_switches, knots.knots_of_phases):
        assert len(getattr(kernel, "signatures", [None])) == 1
