"""How far a joint can go in a given time: against Ruckig, and against motions of random jerks."""

from __future__ import annotations

import math

import numpy as np
import pytest
import ruckig
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.bound.fastest import EXACT, FREE, changed, farthest_way, out_of_range_in, soonest
from assur.planner.kernels.meetings import rest_to_rest_time

Limit = tuple[float, float, float]
SEEDS = st.integers(0, 2**32 - 1)


def column(p: float, v: float = 0.0, a: float = 0.0, kind: float = EXACT) -> FloatArray:
    """A state of one joint."""
    return np.array([[p], [v], [a], [kind]])


def drawn(rng: np.random.Generator) -> Limit:
    """Limits of velocity, acceleration and jerk over two decades each."""
    v, a, j = np.exp(rng.uniform(np.log([0.3, 2.0, 20.0]), np.log([10.0, 60.0, 2000.0]))).tolist()
    return v, a, j


def end(rng: np.random.Generator, limit: Limit) -> tuple[float, float]:
    """A velocity and an acceleration, often 0."""
    v, a = (float(rng.uniform(-most, most)) * float(rng.integers(0, 2)) for most in limit[:2])
    return v, a


def keeps(v: float, a: float, limit: Limit) -> bool:
    """Whether who has this velocity and acceleration can keep the limit of velocity, before and behind."""
    return abs(v) + a * a / (2.0 * limit[2]) <= limit[0]


def by_ruckig(begin: FloatArray, goal: FloatArray, limit: Limit) -> float:
    """The least duration, s."""
    asked, found = ruckig.InputParameter(1), ruckig.Trajectory(1)
    asked.current_position, asked.current_velocity, asked.current_acceleration = (begin[k].tolist() for k in range(3))
    asked.target_position, asked.target_velocity, asked.target_acceleration = (goal[k].tolist() for k in range(3))
    asked.max_velocity, asked.max_acceleration, asked.max_jerk = ([most] for most in limit)
    result = ruckig.Ruckig(1).calculate(asked, found)
    assert result in (ruckig.Result.Working, ruckig.Result.Finished)
    return float(found.duration)


@settings(max_examples=300)
@given(SEEDS)
def test_the_least_duration_is_the_one_that_ruckig_finds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    limit, way = drawn(rng), float(rng.normal() * np.exp(rng.uniform(-6.0, 1.0)))
    (v0, a0), (v1, a1) = end(rng, limit), end(rng, limit)
    if not (keeps(v0, a0, limit) and keeps(v1, a1, limit)):
        return
    begin, goal = column(0.3, v0, a0), column(0.3 + way, v1, a1)
    least = by_ruckig(begin, goal, limit)
    assert not all(out_of_range_in(least + off, begin, goal, 0, *limit) for off in (-1e-7, 0.0, 1e-7))
    if least > 1e-3:
        assert out_of_range_in(least * (1.0 - 1e-5) - 1e-6, begin, goal, 0, *limit)
    if v1 == a1 == 0.0:
        found = soonest(begin, goal, np.zeros(1), np.array(limit)[:, None], 0.0)
        assert found == pytest.approx(least, rel=1e-5, abs=1e-6)
    if v0 == a0 == v1 == a1 == 0.0:
        assert rest_to_rest_time(way, *limit) == pytest.approx(least, rel=1e-6)


def wandered(rng: np.random.Generator, limit: Limit) -> tuple[FloatArray, list[tuple[float, FloatArray]]]:
    """A state of a joint, and those (4, 1) that a motion of random jerks comes through from it, with their times."""
    most_v, most_a, most_j = limit
    v, a = end(rng, limit)
    if not keeps(v, a, limit):
        v, a = 0.0, 0.0
    p, time, found = 0.0, 0.0, list[tuple[float, FloatArray]]()
    begin = column(p, v, a)
    for _ in range(int(rng.integers(1, 12))):
        lasts = float(rng.exponential(0.5 * most_a / most_j + 0.2 * most_v / most_a))
        jerk = float(rng.choice([-1.0, 0.0, 1.0, rng.uniform(-1.0, 1.0)])) * most_j
        if jerk != 0.0:
            # until the acceleration has its limit
            lasts = min(lasts, (math.copysign(most_a, jerk) - a) / jerk)
        here = np.linspace(0.0, lasts, 16)
        fast, hard = v + here * (a + here * jerk / 2.0), a + here * jerk
        kept = np.abs(fast) + hard * hard / (2.0 * most_j) <= most_v
        lasts = float(here[int(np.argmin(kept)) - 1]) if not kept.all() else lasts
        if not lasts > 0.0:
            continue
        p += lasts * (v + lasts * (a / 2.0 + lasts * jerk / 6.0))
        v += lasts * (a + lasts * jerk / 2.0)
        a += lasts * jerk
        time += lasts
        found.append((time, column(p, v, a)))
    return begin, found


@settings(max_examples=400)
@given(SEEDS)
def test_nothing_that_a_motion_comes_through_is_beyond(seed: int) -> None:
    rng = np.random.default_rng(seed)
    limit = drawn(rng)
    begin, states = wandered(rng, limit)
    free = begin.copy()
    free[3] = FREE
    for time, state in states:
        passed = state.copy()
        passed[3] = FREE
        for one in (begin, free):
            for other in (state, passed):
                assert not out_of_range_in(time, one, other, 0, *limit)
        # not only at the very time: who was there has passed it later, too
        assert not out_of_range_in(time + 0.1, begin, passed, 0, *limit)
        assert changed(begin[1, 0], begin[2, 0], state[1, 0], state[2, 0], *limit[1:]) <= time * (1 + 1e-9) + 1e-12
        farther = farthest_way(time, begin[1, 0], begin[2, 0], state[1, 0], state[2, 0], *limit) + 1e-6
        assert out_of_range_in(time, begin, column(farther, state[1, 0], state[2, 0]), 0, *limit)


def test_in_less_time_than_a_change_of_velocity_takes_there_is_no_way() -> None:
    least, limit = changed(0.0, 0.0, 1.0, 0.0, 5.0, 250.0), (2.0, 5.0, 250.0)
    assert farthest_way(0.99 * least, 0.0, 0.0, 1.0, 0.0, *limit) == -math.inf
    assert farthest_way(1.01 * least, 0.0, 0.0, 1.0, 0.0, *limit) > 0.0


@given(SEEDS)
def test_who_must_stop_above_a_height_takes_no_less_than_the_way_there_from_rest_to_rest(seed: int) -> None:
    """Going beyond it and coming back is no short cut, however it turns round."""
    rng = np.random.default_rng(seed)
    limit, way = drawn(rng), float(np.exp(rng.uniform(-6.0, 0.0)))
    whole = rest_to_rest_time(way, *limit)
    for share in np.linspace(0.0, 1.0, 33).tolist():
        a = -share * limit[1]
        if not keeps(0.0, a, limit):
            continue
        there = by_ruckig(column(0.0), column(way, 0.0, a), limit)
        assert there + changed(0.0, a, 0.0, 0.0, *limit[1:]) >= whole * (1.0 - 1e-6)


def test_a_joint_that_has_no_time_is_nowhere_and_one_that_is_not_known_is_anywhere() -> None:
    limit = (1.0, 10.0, 100.0)
    here, there = column(0.0), column(1.0)
    assert out_of_range_in(-1e-9, here, here, 0, *limit)
    assert out_of_range_in(math.nan, here, here, 0, *limit)
    assert not out_of_range_in(0.0, here, here, 0, *limit)
    assert out_of_range_in(0.9, here, there, 0, *limit)
    assert not out_of_range_in(0.9, column(math.nan), there, 0, *limit)
    assert out_of_range_in(1.0 - 1e-6, column(0.0, kind=FREE), column(1.0, kind=FREE), 0, *limit)
    assert not out_of_range_in(1.0, column(0.0, kind=FREE), column(1.0, kind=FREE), 0, *limit)


def test_a_joint_that_must_turn_back_has_passed_what_is_before_that() -> None:
    # the velocity is 0.2 - 10 t + 50 t²: 0 after 22.5 ms and 2.16 mm, and below for long
    limit, begin = (1.0, 10.0, 100.0), column(0.0, 0.2, -10.0)
    assert not out_of_range_in(0.1, begin, column(2.1e-3, kind=FREE), 0, *limit)
    assert out_of_range_in(0.1, begin, column(2.2e-3, kind=FREE), 0, *limit)
