"""Lower bounds of durations: the closed form is the solver's own minimum, and no bound is above it."""

from __future__ import annotations

import numpy as np
import pytest
import ruckig
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.timing.solver import TimingRefusal
from assur.planner.trajectory import Trajectory
from tests.planner.timing.least import least_duration, rest_to_rest_time
from tests.planner.timing.legs import KINDS, ROBOTS, Question, question, time_joints


def true_minimum(asked: Question) -> float:
    """The solver's shortest duration at the whole limits."""
    n = asked.n
    solver, given_, found = ruckig.Ruckig(n), ruckig.InputParameter(n), ruckig.Trajectory(n)
    for which, states in (("current", asked.start), ("target", asked.goal)):
        for name, value in zip(("position", "velocity", "acceleration"), states, strict=True):
            setattr(given_, f"{which}_{name}", value.tolist())
    given_.max_velocity, given_.max_acceleration, given_.max_jerk = (limit.tolist() for limit in asked.limits)
    solver.calculate(given_, found)
    return float(found.duration)


@given(
    st.integers(0, 10**6),
    st.sampled_from(ROBOTS),
    st.floats(-7, 1),
)
def test_the_time_from_rest_to_rest_is_the_solvers_minimum(seed: int, robot: str, order: float) -> None:
    rng = np.random.default_rng(seed)
    asked = question(rng, robot, "rest", n=1)
    way = np.array([10.0**order])
    asked = Question(asked.q0 * 0, asked.v0, asked.a0, way, asked.v1, asked.a1, *asked.limits)
    closed = rest_to_rest_time(way, *asked.limits)
    # The solver's position is good to 1e-8, so its time to 1e-8/D/3 where no limit is reached.
    assert closed[0] == pytest.approx(true_minimum(asked), rel=1e-9 + 1e-8 / way[0])


def test_the_closed_form_has_no_seams() -> None:
    for v, a, j in ((1.0, 2.0, 50.0), (1.0, 50.0, 2.0), (1.0, 1.0, 1.0), (2.0, 4.0, 8.0)):
        distance = np.geomspace(1e-6, 1e3, 20001)
        time = rest_to_rest_time(distance, v, a, j)
        assert (np.diff(time) > 0).all()
        # Never faster than twice the velocity allows for the step in distance.
        assert (np.diff(time) <= np.diff(distance) * time[:-1] / distance[:-1] * 1.001).all()
    assert rest_to_rest_time(0.0, 1.0, 1.0, 1.0) == 0
    assert rest_to_rest_time(-3.0, 1.0, 1.0, 1.0) == rest_to_rest_time(3.0, 1.0, 1.0, 1.0)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("robot", ROBOTS)
def test_no_bound_is_above_the_solvers_minimum_at_the_whole_limits(kind: str, robot: str) -> None:
    rng, shares = np.random.default_rng(3), []
    for _ in range(250):
        asked = question(rng, robot, kind, n=int(rng.integers(1, 5)))
        bound, minimum = float(least_duration(*asked.args)), true_minimum(asked)
        # Below the solver's own precision of 1e-8 in position there is nothing to compare.
        assert 0 < bound <= minimum * (1 + 1e-9) + 1e-9
        shares.append(bound / minimum)
    assert np.median(shares) > (0.99 if kind == "rest" else 0.6)


@given(st.integers(0, 10**6), st.sampled_from(ROBOTS), st.sampled_from(KINDS))
def test_no_bound_is_above_what_we_time(seed: int, robot: str, kind: str) -> None:
    asked = question(np.random.default_rng(seed), robot, kind)
    shortest, profile = asked.solver.shortest(*asked.states), time_joints(*asked.args)
    assert isinstance(profile, Trajectory)
    assert not isinstance(shortest, TimingRefusal)
    assert least_duration(*asked.args) <= min(shortest, profile.duration)


def test_a_batch_of_goals_is_each_goal_by_itself() -> None:
    rng = np.random.default_rng(4)
    many = [question(rng, "real", "moving") for _ in range(20)]
    start = many[0].start
    goals = [np.stack([one.goal[k] for one in many]) for k in range(3)]
    batch = least_duration(*start, goals[0], goals[1], goals[2], *many[0].limits)
    assert batch.shape == (20,)
    for k in range(20):
        alone = least_duration(*start, goals[0][k], goals[1][k], goals[2][k], *many[0].limits)
        assert batch[k] == alone


def test_a_goal_that_is_not_a_number_has_no_finite_bound() -> None:
    one, zero = np.ones(2), np.zeros(2)
    goal = np.array([[1.0, 1.0], [np.nan, 1.0]])
    bound = least_duration(zero, zero, zero, goal, zero, zero, one, one, one)
    assert np.isfinite(bound).tolist() == [True, False]
