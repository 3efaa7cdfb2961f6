"""Profiles: exact ends, evaluation, switches, extremes, and what becomes of them as knots."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from assur.planner.errors import FaultError
from assur.planner.timing import Profile, time_joints, to_trajectory
from assur.planner.timing.question import TimingRefusal
from assur.planner.timing.writing import MERGE
from tests.planner.timing.legs import MANNERS, ROBOTS, Question, question


def asked_and_timed(seed: int, robot: str, manner: str, n: int) -> tuple[Question, Profile]:
    asked = question(np.random.default_rng(seed), robot, manner, n)
    profile = time_joints(*asked.args)
    assert isinstance(profile, Profile)
    return asked, profile


profiles = st.builds(
    asked_and_timed,
    st.integers(0, 10**6),
    st.sampled_from(ROBOTS),
    st.sampled_from(MANNERS),
    st.integers(1, 5),
)
"""Questions of all robots and manners, and their profiles."""


@given(profiles)
def test_a_profile_begins_and_ends_in_the_states_asked_for(pair: tuple[Question, Profile]) -> None:
    asked, profile = pair
    for derivative in range(3):
        scale = (1.0, asked.velocity.max(), asked.acceleration.max())[derivative]
        start, end = profile.evaluate(np.array([0.0, profile.duration]), derivative)
        assert np.abs(start - asked.start[derivative]).max() <= 1e-13 * scale
        assert np.array_equal(end, asked.goal[derivative])
        # Up to the end, not only at it.
        before = profile.evaluate(profile.duration * (1 - 1e-12), derivative)
        assert (
            np.abs(before - asked.goal[derivative]).max() <= 1e-9 * scale + 2e-12 * profile.duration * asked.jerk.max()
        )


@given(profiles)
def test_a_profile_is_continuous_up_to_its_acceleration_and_its_derivatives_are_derivatives(
    pair: tuple[Question, Profile],
) -> None:
    asked, profile = pair
    t = profile.switches()
    eps = 1e-9
    for derivative, step in enumerate((asked.velocity, asked.acceleration, asked.jerk)):
        jumps = profile.evaluate(t[1:-1] + eps, derivative) - profile.evaluate(t[1:-1] - eps, derivative)
        assert (np.abs(jumps) <= 2.1 * eps * step + 1e-11 * np.maximum(1, step)).all()
        # Between switches: a central difference. What makes the ends exact takes a tenth of the jerk at most.
        middle, h = (t[1:] + t[:-1]) / 2, (t[1:] - t[:-1]) / 4
        wide = h > 1e-4
        slope = profile.evaluate(middle + h, derivative) - profile.evaluate(middle - h, derivative)
        slope = slope[wide] / (2 * h[wide, None])
        h = h[wide, None]
        bend = asked.jerk * (h**2 / 6, 0.1 * h**2 / profile.duration, 0.1 * h / profile.duration)[derivative]
        wanted = profile.evaluate(middle[wide], derivative + 1)
        assert (np.abs(slope - wanted) <= bend + 1e-9 * step + 1e-12 / h * np.maximum(1, step)).all()


@given(profiles, st.floats(0, 600))
def test_the_spline_through_the_knots_is_the_profile(pair: tuple[Question, Profile], offset: float) -> None:
    asked, profile = pair
    # Between moving states a microsecond apart, at a late time, there is nothing left to choose.
    assume(profile.duration > 1e-3)
    path = to_trajectory(profile, offset)
    assert path.start == offset
    assert path.end == offset + profile.duration
    t = np.linspace(0, 1, 300)[1:-1] * profile.duration
    # Where switches crowd, knots follow to a merge of 16 µs. A time near 600 s is known to 1e-13 s.
    late = np.spacing(path.end)
    for derivative, step in enumerate((asked.velocity, asked.acceleration, asked.jerk)):
        gap = np.abs(path.evaluate(offset + t, derivative) - profile.evaluate(t, derivative))
        assert (gap <= (1e-6, 1e-5, 2e-5)[derivative] * np.maximum(1, step) + 2 * late * step).all(), derivative


@given(profiles)
def test_extremes_of_position_hold_all_samples_and_are_reached(pair: tuple[Question, Profile]) -> None:
    _, profile = pair
    low, high = profile.extrema()
    t = np.concatenate([np.linspace(0, profile.duration, 4001), profile.switches()])
    values = profile.evaluate(t)
    assert (values >= low - 1e-12).all()
    assert (values <= high + 1e-12).all()
    exact = to_trajectory(profile).extrema(0)
    assert np.abs(exact[0] - low).max() <= 1e-7
    assert np.abs(exact[1] - high).max() <= 1e-7


@given(profiles)
def test_switches_increase_from_zero_to_the_duration_and_are_not_closer_than_half_the_merge(
    pair: tuple[Question, Profile],
) -> None:
    _, profile = pair
    t = profile.switches()
    assume(profile.duration > MERGE)
    assert t[0] == 0
    assert t[-1] == profile.duration
    assert np.diff(t).min() >= MERGE / 2
    # Every switch of every joint has a knot as near as that.
    own = profile.time.ravel()
    assert np.abs(own[:, None] - t).min(1).max() <= MERGE


def test_outside_its_duration_a_profile_is_not_a_number() -> None:
    _, profile = asked_and_timed(1, "real", "rest", 2)
    outside = np.array([-1e-300, np.nextafter(profile.duration, 9.0), np.nan, np.inf])
    for derivative in range(4):
        assert np.isnan(profile.evaluate(outside, derivative)).all()
        assert np.isfinite(profile.evaluate(0.0, derivative)).all()
        assert profile.evaluate(0.0, derivative).shape == (2,)
        assert profile.evaluate(np.zeros((3, 2)), derivative).shape == (3, 2, 2)


def test_nothing_of_a_profile_can_be_changed() -> None:
    asked, profile = asked_and_timed(2, "real", "moving", 3)
    for array in (profile.time, profile.phases, profile.start[0], profile.end[2], profile.limits):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0.0
    asked.q0[0] += 1.0
    assert profile.start[0][0] != asked.q0[0]


def test_a_motion_of_no_duration_has_no_knots() -> None:
    one, zero = np.ones(1), np.zeros(1)
    profile = time_joints(one, zero, zero, one, zero, zero, one, one, one, 0.0)
    assert isinstance(profile, Profile)
    with pytest.raises(FaultError, match="no duration"):
        profile.knots()


@given(st.integers(0, 10**6), st.sampled_from(("real", "problems", "sharp")), st.sampled_from(MANNERS))
def test_a_sketch_is_where_its_profile_is_to_ten_micrometres(seed: int, robot: str, manner: str) -> None:
    asked = question(np.random.default_rng(seed), robot, manner)
    sketch = asked.solver.sketch(*asked.states)
    assert not isinstance(sketch, TimingRefusal)
    t = np.linspace(0, sketch.duration, 100)
    assert np.abs(sketch.positions(t) - sketch.profile.evaluate(t)).max() <= 1e-5
    beyond = np.array([-1.0, sketch.duration + 1.0])
    assert np.abs(sketch.positions(beyond) - [asked.q0, asked.q1]).max() <= 1e-6


@given(st.integers(0, 10**6), st.sampled_from(MANNERS))
def test_the_states_are_the_three_orders_to_the_bit_and_what_is_no_time_has_none(seed: int, manner: str) -> None:
    asked = question(np.random.default_rng(seed), "real", manner)
    profile = time_joints(*asked.args)
    assert isinstance(profile, Profile)
    t = np.linspace(0, profile.duration, 30)
    assert all(np.array_equal(x, profile.evaluate(t, order)) for order, x in enumerate(profile.states(t)))
    assert all(np.isnan(x).all() for x in profile.states(np.array([np.nan])))
