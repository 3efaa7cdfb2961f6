"""Trapezoids of rough motions: they reach their ends, keep to their acceleration, and turn round where they say."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.kernels.candidates import (
    ANY_TIME,
    COUNT,
    FIRST,
    VIA_VELOCITY,
    cruise,
    least_time,
    next_meeting,
    passing_velocity,
    profile_at,
    stopping_distance,
)
from tests.planner.cells import limits
from tests.planner.timing.least import least_duration

V, A = limits().velocity, limits().acceleration
SEEDS = st.integers(0, 10**6)


def states(seed: int, count: int = 50) -> list[list[float]]:
    """Rows of q0, v0, q1, v1, velocity limit, acceleration of single joints; some at rest."""
    rng = np.random.default_rng(seed)
    speed, rate = rng.uniform(0.5, 10.0, count), rng.uniform(2.0, 80.0, count)
    v0, v1 = rng.uniform(-0.9, 0.9, (2, count)) * speed * (rng.random((2, count)) < 0.7)
    q0, q1 = rng.uniform(-2.0, 2.0, (2, count))
    rows: list[list[float]] = np.column_stack([q0, v0, q1, v1, speed, rate]).tolist()
    return rows


@given(SEEDS)
def test_the_least_time_is_the_closed_form_over_arrays(seed: int) -> None:
    for q0, v0, q1, v1, speed, rate in states(seed):
        a, b, c, d, e, f = (np.array([x]) for x in (q0, v0, q1, v1, speed, rate))
        none = np.zeros(1)
        wanted = float(least_duration(a, b, none, c, d, none, e, f, None))
        assert least_time(q1 - q0, v0, v1, speed, rate) == pytest.approx(wanted, rel=1e-9, abs=1e-12)


def distance(c: float, v0: float, v1: float, rate: float, duration: float) -> float:
    """How far a joint comes that goes from v0 to c, cruises, and goes on to v1: the area below its velocity."""
    up, down = abs(c - v0) / rate, abs(v1 - c) / rate
    return (v0 + c) / 2 * up + c * (duration - up - down) + (c + v1) / 2 * down


@given(SEEDS, st.sampled_from([0.0, 1e-6, 0.01, 0.3, 4.0]))
def test_a_profile_of_any_duration_meets_both_ends_wherever_that_is_possible(seed: int, spare: float) -> None:
    """The distance grows with the cruising velocity; the slowest and the fastest leave no time to cruise."""
    for q0, v0, q1, v1, speed, rate in states(seed):
        duration = least_time(q1 - q0, v0, v1, speed, rate) + spare
        c = cruise(q1 - q0, v0, v1, rate, duration)
        assert profile_at(q0, v0, v1, c, rate, duration, 0.0) == pytest.approx(q0, abs=1e-12)
        met = abs(profile_at(q0, v0, v1, c, rate, duration, duration) - q1) <= 1e-6
        extremes = [(v0 + v1 + sign * rate * duration) / 2 for sign in (-1.0, 1.0)]
        least, most = (distance(extreme, v0, v1, rate, duration) for extreme in extremes)
        if min(q1 - q0 - least, most - (q1 - q0)) > -1e-9:
            assert met
        elif min(q1 - q0 - least, most - (q1 - q0)) < -1e-5:
            assert not met
        if met:
            assert abs(c) <= speed * (1 + 1e-6)
            t = np.linspace(0.0, duration, 400)
            q = np.array([profile_at(q0, v0, v1, c, rate, duration, x) for x in t])
            curved = np.diff(q, 2) / (t[1] - t[0]) ** 2
            assert (np.abs(curved) <= rate * (1 + 1e-6) + 1e-8 / (t[1] - t[0]) ** 2).all()
            h = 1e-7
            for t0, v in ((0.0, v0), (duration - h, v1)):
                there, next_ = (profile_at(q0, v0, v1, c, rate, duration, t0 + x) for x in (0.0, h))
                assert (next_ - there) / h == pytest.approx(v, abs=1e-6 + 2 * h * rate + 1e-14 / h)


def test_a_joint_that_is_too_fast_at_both_ends_for_what_time_is_left_misses_its_end() -> None:
    """5 mm at 1 m/s take 5 ms; to be 20 ms late it would have to brake, and there is no room for that."""
    least = least_time(0.005, 1.0, 1.0, 2.0, 25.0)
    for spare, possible in ((0.0, True), (0.02, False), (0.3, True)):
        c = cruise(0.005, 1.0, 1.0, 25.0, least + spare)
        ends = profile_at(0.0, 1.0, 1.0, c, 25.0, least + spare, least + spare)
        assert (abs(ends - 0.005) <= 1e-6) == possible


def test_a_joint_that_meets_a_limit_at_speed_comes_from_beyond_it() -> None:
    """What a jerk-limited joint needs to get to a speed is what it needs to stop from it, by time reversal."""
    speed, rate, jerk = 1.613, 80.0, 1600.0
    onset = np.sqrt(2 * speed / jerk)  # all of it while the acceleration builds up
    assert stopping_distance(speed, rate, jerk) == pytest.approx(speed * onset * 2 / 3)
    fast, full = 9.0, rate / jerk
    left = fast - rate * full / 2
    expected = fast * full - jerk * full**3 / 6 + left**2 / (2 * rate)
    assert stopping_distance(fast, rate, jerk) == pytest.approx(expected)
    assert stopping_distance(0.0, rate, jerk) == 0.0


def passed(before: FloatArray, at: FloatArray, behind: FloatArray, pace: float) -> FloatArray:
    found = np.empty(len(at))
    passing_velocity(before, at, behind, pace, V.copy(), A.copy(), found)
    return found


@given(SEEDS, st.floats(0.0, 3.0))
def test_no_joint_passes_where_it_turns_round_and_none_too_fast(seed: int, pace: float) -> None:
    before, at, behind = np.random.default_rng(seed).uniform(limits().lower, limits().upper, (3, 4))
    found = passed(before, at, behind, pace)
    turns = (at - before) * (behind - at) <= 0
    assert (found[turns] == 0).all()
    assert (np.abs(found) <= VIA_VELOCITY * V).all()
    on = ~turns & (found != 0)
    assert (np.sign(found[on]) == np.sign((behind - before)[on])).all()


def test_halfway_the_pace_is_times_the_mean_velocity() -> None:
    start, end = np.zeros(4), np.array([1.0, 0.0, 0.0, 0.0])
    duration = 1.0 / V[0] + np.sqrt(1.0 / A[0])
    np.testing.assert_allclose(passed(start, end / 2, end, 0.5), [0.5 / duration, 0.0, 0.0, 0.0])


def test_the_next_meeting_is_the_first_at_a_time_or_later_and_there_may_be_none() -> None:
    meetings = np.zeros((7, 3))
    meetings[:, 0] = [9.0, 1.0, 1.5, 2.0, 2.5, 0.5, 0.7]
    option = np.zeros(3)
    option[FIRST], option[COUNT] = 1, 4
    for at, row in ((-np.inf, 1), (1.0, 1), (1.2, 2), (2.5, 4), (2.6, -1), (np.inf, -1)):
        assert next_meeting(meetings, option, at) == row
    option[ANY_TIME] = 1
    assert next_meeting(meetings, option, 99.0) == 1
    option[COUNT] = 0
    assert next_meeting(meetings, option, 0.0) == -1
