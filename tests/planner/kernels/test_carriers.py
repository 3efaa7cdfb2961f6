"""Carriers as kernels place and bound them: frames as their laws say, joints as the trajectory and its sweep say."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.kernels.carriers import carrier_bounds, point_bound
from assur.planner.kernels.columns import laws as law_columns
from assur.planner.kernels.laws import bound_frame, place_frame
from assur.planner.kernels.links import BOUND_COLUMNS
from assur.planner.kernels.spline import spline_motion, spline_state, sweep_bounds
from assur.planner.laws import Law, Pose, fixed, law_tables, linear
from assur.planner.model.link_frames import link_law
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory
from assur.planner.trajectory.spline import spline_table
from tests.planner.kernels.arms import ARMS, states
from tests.planner.laws.laws import Case, cases, directions, intervals, samples
from tests.planner.robots.point_bounds import Sweep
from tests.planner.trajectory.splines import bernstein, splines

CLOSE = 1e-12
"""Relative, and m or rad: how far two forms of the same formula may differ by rounding."""
NO_LAWS = np.zeros((0, law_columns.LAW_COLUMNS))
NO_PIECES = np.zeros((0, law_columns.PIECE_COLUMNS))
every_arm = pytest.mark.parametrize("name", list(ARMS))


def same(found: FloatArray, expected: FloatArray, close: float = CLOSE) -> None:
    assert np.array_equal(np.isfinite(found), np.isfinite(expected))
    known = np.isfinite(expected)
    assert np.all(np.abs(found[known] - expected[known]) <= close * (1.0 + np.abs(expected[known])))


def swept(robot: Robot, seed: int, size: int) -> Sweep:
    """Ranges about random states, from points to wide ones, with random rates; some are zero, one is infinite."""
    rng = np.random.default_rng(seed)
    q = states(robot, seed, size)
    half = 10.0 ** rng.uniform(-4, 0.5, (size, 1)) * rng.random(q.shape)
    half[::3] = 0.0
    rates = rng.exponential(3.0, (2, size, len(robot.rate_matrix)))
    rates[:, ::5] = 0.0
    rates[:, ::7, 0] = 0.0
    return Sweep(q - half, q + half, rates[0], rates[1] * 10.0)


@every_arm
def test_a_point_of_which_nothing_is_known_is_bounded_by_infinity(name: str) -> None:
    robot = ARMS[name]
    row, known = robot.row, swept(robot, 3, 4)
    bounds = np.empty((len(robot.links), BOUND_COLUMNS))
    last = len(robot.links) - 1
    for bad in (math.nan, math.inf):
        rate = known.rate[1].copy()
        rate[0] = bad
        carrier_bounds(row, NO_LAWS, NO_PIECES, 0.0, 1.0, known.lower[1], known.upper[1], rate, known.rate_d[1], bounds)
        assert point_bound(bounds, last, 0.1, 0.1, 1.0, 0.0, 0.0) == (math.inf, math.inf)
    each = (known.lower[1], known.upper[1], known.rate[1], known.rate_d[1])
    carrier_bounds(row, NO_LAWS, NO_PIECES, 0.0, 1.0, *each, bounds)
    for reach, distance in ((-0.1, 0.1), (0.1, -0.1), (math.nan, 0.1), (0.1, math.nan)):
        assert point_bound(bounds, last, reach, distance, 1.0, 0.0, 0.0) == (math.inf, math.inf)
    assert point_bound(bounds, last, 0.1, 0.1, math.nan, 0.0, 0.0) == (math.inf, math.inf)


def placed_by(law: Law, t: FloatArray) -> FloatArray:
    """Rows of carriers (T, 12) as the law's own motion has them."""
    motion = law.motion(t)
    rows = np.zeros((len(t), 12))
    rows[:, :3] = motion.p
    rows[:, 3] = rows[:, 7] = np.cos(motion.yaw)
    rows[:, 6] = np.sin(motion.yaw)
    rows[:, 4] = -rows[:, 6]
    rows[:, 11] = 1.0
    rows[np.isnan(motion.yaw)] = np.nan
    return rows


def placed(law: Law, t: FloatArray) -> FloatArray:
    rows, pieces = law_tables([law])
    found = np.empty((len(t), 12))
    for i in range(len(t)):
        place_frame(rows[0], pieces, t[i], found, i)
    return found


@given(cases(), st.integers(0, 10**6))
def test_frames_are_where_the_law_says(case: Case, seed: int) -> None:
    low, high = case.window
    t = np.random.default_rng(seed).uniform(low - 1.0, high + 1.0, 50)
    t = np.concatenate([t, case.switches, [low, high, math.nan, math.inf, 2e6]])
    same(placed(case.law, t), placed_by(case.law, t), 1e-11)


@given(cases(), st.data(), st.floats(-math.pi, math.pi))
def test_no_point_beside_a_frames_axis_is_faster_than_its_bound(case: Case, data: st.DataObject, around: float) -> None:
    t0, t1 = data.draw(intervals(case))
    n, reach = data.draw(directions()), data.draw(st.sampled_from([0.0, 0.3]))
    rows, pieces = law_tables([case.law])
    bounds = np.empty((1, BOUND_COLUMNS))
    bound_frame(rows[0], pieces, t0, t1, bounds, 0)
    speed, acceleration = point_bound(bounds, 0, reach, 9.0, *n)
    beside = Pose(reach * math.cos(around), reach * math.sin(around), 0.2)
    motion = case.law.motion(samples(case, t0, t1, 200)).at(beside)
    close = CLOSE * (1.0 + acceleration)
    assert np.abs(motion.v @ n).max() <= speed + close
    assert np.abs(motion.a @ n).max() <= acceleration + close


@pytest.mark.parametrize("interval", [(0.0, 3.0), (3.5, 4.5), (5.0, 4.0), (math.nan, 4.0), (3.0, math.nan)])
def test_nothing_is_extrapolated(interval: tuple[float, float]) -> None:
    laws: list[Law] = [fixed(Pose(1.0), (2.0, 4.0)), linear(Pose(), (0.1, 0.0, 0.0), 0.0, (2.0, 4.0))]
    rows, pieces = law_tables(laws)
    bounds = np.empty((2, BOUND_COLUMNS))
    for k in range(2):
        bound_frame(rows[k], pieces, *interval, bounds, k)
        assert point_bound(bounds, k, 0.0, 0.0, 0.0, 0.0, 1.0) == (math.inf, math.inf)
    found = placed(laws[0], np.array([1.999, 2.0, 4.0, 4.001]))
    assert np.array_equal(np.isnan(found).all(1), [True, False, False, True])


def neighbours() -> list[tuple[Robot, Trajectory]]:
    """Upright arms with a plan from rest to rest that keeps the loop assembled."""
    time, found = np.array([1.0, 1.4, 1.7, 2.5]), []
    for name in ("scara whose arms rise", "far three-axis scara", "five-bar"):
        robot = ARMS[name]
        n, rng = len(robot.joints), np.random.default_rng(5)
        q = np.array([0.6, -0.6, 0.2, 0.3])[:n] + rng.uniform(-0.2, 0.2, (4, n))
        qd, qdd = rng.normal(size=(2, 4, n))
        qd[[0, 3]] = qdd[[0, 3]] = 0.0
        found.append((robot, Trajectory(time, q, 0.3 * qd, qdd)))
    return found


@pytest.mark.parametrize(("robot", "path"), neighbours(), ids=lambda value: getattr(value, "name", ""))
def test_a_neighbours_link_is_where_its_plan_has_it(robot: Robot, path: Trajectory) -> None:
    t = np.random.default_rng(6).uniform(0.0, 3.0, 60)
    for link in range(len(robot.links)):
        law = link_law(robot, path, link)
        same(placed(law, t), placed_by(law, t))


@given(splines, st.integers(0, 10**6))
def test_the_spline_is_the_trajectory(path: Trajectory, seed: int) -> None:
    rng = np.random.default_rng(seed)
    table = spline_table(path, np.eye(path.n))
    t = np.concatenate([rng.uniform(path.start - 0.5, path.end + 0.5, 30), path.time])
    q, state = np.empty(path.n), np.empty((4, path.n))
    for each in t:
        held = min(max(each, path.start), path.end)
        spline_state(table.tk, table.c, each, q)
        same(q, path.evaluate(held))
        spline_motion(table.tk, table.c, each, state)
        inside = path.start <= each < path.end
        for order in range(1, 4):
            size = np.abs(bernstein(path, order)).max()
            expected = path.evaluate(held, order) if inside else np.zeros(path.n)
            assert np.all(np.abs(state[order] - expected) <= CLOSE * (1.0 + size))
    spline_state(table.tk, table.c, math.nan, q)
    assert np.isnan(q).all()


def test_beside_a_trajectory_that_does_not_rest_nothing_is_known() -> None:
    time, q = np.array([0.0, 1.0]), np.zeros((2, 1))
    moving = np.array([[0.0], [0.5]])
    table = spline_table(Trajectory(time, q, moving, q), np.eye(1))
    lower, upper, rate, rate_d = np.empty((4, 1))
    for t0, t1, known in ((-1.0, 0.5, True), (0.5, 1.0, True), (0.5, 1.1, False), (0.5, 0.4, False)):
        sweep_bounds(table.tk, table.c, table.whole, table.matrix, t0, t1, lower, upper, rate, rate_d)
        assert np.isfinite([lower[0], upper[0], rate[0], rate_d[0]]).all() == known
    for t0, t1 in ((math.nan, 0.5), (0.5, math.nan)):
        sweep_bounds(table.tk, table.c, table.whole, table.matrix, t0, t1, lower, upper, rate, rate_d)
        assert rate[0] == rate_d[0] == upper[0] == math.inf == -lower[0]
