"""Carriers as kernels place and bound them: frames as their laws say, joints as the trajectory and its sweep say."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.kernels.carriers import derivative
from assur.planner.kernels.jets import JET_COLUMNS, JETS
from assur.planner.kernels.laws import place_frame
from assur.planner.kernels.solids import BALL, CENTRE, COLUMNS, DISC, HALF, RADIUS, ROTATION
from assur.planner.kernels.spline import piece_motion, spline_state
from assur.planner.kernels.uncertainty import OFFSET_COLUMNS, OFFSET_REACH, OFFSET_SHIFT, displaced
from assur.planner.laws import Law, Pose, fixed, law_tables, linear
from assur.planner.model.link_frames import link_law
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory
from tests.planner.kernels.arms import ARMS, states
from tests.planner.laws.laws import Case, cases, intervals, samples
from tests.planner.trajectory.splines import bernstein, splines, sweep

CLOSE = 1e-12
"""Relative, and m or rad: how far two forms of the same formula may differ by rounding."""
every_arm = pytest.mark.parametrize("name", list(ARMS))


def same(found: FloatArray, expected: FloatArray, close: float = CLOSE) -> None:
    assert np.array_equal(np.isfinite(found), np.isfinite(expected))
    known = np.isfinite(expected)
    assert np.all(np.abs(found[known] - expected[known]) <= close * (1.0 + np.abs(expected[known])))


def unit(centre: FloatArray, turn: FloatArray, half: FloatArray, disc: float, ball: float) -> FloatArray:
    """The table of one unit on carrier 0: box, disc and ball together."""
    bodies = np.zeros((1, COLUMNS))
    bodies[0, CENTRE : CENTRE + 3], bodies[0, ROTATION : ROTATION + 9] = centre, turn.ravel()
    bodies[0, HALF : HALF + 3], bodies[0, DISC], bodies[0, BALL] = half, disc, ball
    return bodies


def turned(rng: np.random.Generator) -> FloatArray:
    """A random rotation (3, 3)."""
    found, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return np.asarray(found * np.linalg.det(found))


@every_arm
def test_a_solid_moves_no_faster_than_its_bound_and_over_an_instant_as_fast(name: str) -> None:
    """Jets of a link at an instant are its rates: all points of a box then have the derivatives that the bound has."""
    robot, rng = ARMS[name], np.random.default_rng(4)
    n, rows = len(robot.joints), states(robot, 2, 12)
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    for q in rows:
        joints = np.zeros((n, JET_COLUMNS))
        joints[:, 0], joints[:, 2], joints[:, 4] = q, rng.normal(size=n), rng.normal(size=n)
        for link in range(len(robot.links)):
            jets = robot.sweep(joints, link).jets
            if not np.isfinite(jets).all():
                continue
            centre, turn, half = rng.normal(size=3) * 0.2, turned(rng), rng.uniform(0.0, 0.1, 3)
            points = np.column_stack([np.ones(8), centre + (corners * half) @ turn.T])
            along = rng.normal(size=3)
            along /= np.linalg.norm(along)
            for order in (1, 2):
                rates = points @ jets[:, 2 * order].reshape(4, 3) @ along
                found = derivative(unit(centre, turn, half, 0.0, 0.3), jets[None], 0, order, tuple(along.tolist()))
                assert found[0] + found[1] == pytest.approx(rates.max(), rel=1e-9, abs=1e-9)
                assert found[0] - found[1] == pytest.approx(rates.min(), rel=1e-9, abs=1e-9)
                wider = derivative(unit(centre, turn, half, 0.1, 0.3), jets[None], 0, order, tuple(along.tolist()))
                assert wider[0] == found[0]
                assert wider[1] >= found[1]


def test_what_keeps_its_shape_adds_nothing() -> None:
    """A disc about the axis of an upright carrier, and a ball anywhere; a disc that lies on its side does turn."""
    robot = ARMS["far three-axis scara"]
    joints = np.zeros((3, JET_COLUMNS))
    joints[:, 2] = 1.0, 2.0, 0.5
    jets, none, flat = robot.sweep(joints, 2).jets[None], np.zeros(3), np.eye(3)
    for order in (1, 2):
        point = derivative(unit(none, flat, none, 0.0, 0.0), jets, 0, order, (0.6, 0.0, 0.8))
        assert derivative(unit(none, flat, none, 0.2, 0.3), jets, 0, order, (0.6, 0.0, 0.8)) == point
        side = derivative(unit(none, flat[:, [2, 0, 1]], none, 0.2, 0.0), jets, 0, order, (0.6, 0.0, 0.8))
        assert side[1] > point[1] + 0.05


def test_a_correction_displaces_the_far_end_of_a_solid_by_what_its_link_turns_and_its_axis_moves() -> None:
    rod, offsets = unit(np.array([0.2, 0.0, 0.1]), np.eye(3), np.zeros(3), 0.0, 0.0), np.zeros((1, OFFSET_COLUMNS))
    rod[0, RADIUS], offsets[0, OFFSET_SHIFT], offsets[0, OFFSET_REACH] = 0.15, 2e-3, 1e-3
    moved = 2e-3 + 0.35 * math.sin(1e-3)
    assert moved <= displaced(rod, offsets, 0, (0.0, 1.0, 0.0)) <= moved + 1e-6
    assert displaced(rod, offsets, 0, (0.0, 0.0, 1.0)) == 0.0


@every_arm
def test_of_a_link_of_which_nothing_is_known_nothing_is_bounded(name: str) -> None:
    robot = ARMS[name]
    last, solid = len(robot.links) - 1, unit(np.zeros(3), np.eye(3), np.zeros(3), 0.0, 0.1)
    for bad in (math.nan, math.inf):
        for column in range(JET_COLUMNS):
            joints = np.zeros((len(robot.joints), JET_COLUMNS))
            joints[0, column] = bad
            jets = robot.sweep(joints, last).jets[None]
            assert derivative(solid, jets, 0, 2, (1.0, 0.0, 0.0)) == (0.0, math.inf)
    known = np.zeros((1, JETS, JET_COLUMNS))
    assert derivative(solid, known, 0, 2, (1.0, 0.0, 0.0)) == (0.0, 0.0)
    assert derivative(solid, known, 0, 2, (math.nan, 0.0, 0.0)) == (0.0, math.inf)
    solid[0, CENTRE] = math.nan
    assert derivative(solid, known, 0, 2, (1.0, 0.0, 0.0)) == (0.0, math.inf)


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
    reach = data.draw(st.sampled_from([0.0, 0.3]))
    beside = Pose(reach * math.cos(around), reach * math.sin(around), 0.2)
    motion, swept = case.law.motion(samples(case, t0, t1, 200)).at(beside), case.law.sweep(t0, t1)
    for order, truth in ((1, motion.v), (2, motion.a)):
        bound = swept.point(order, beside.x, beside.y, beside.z)
        assert (np.abs(truth).max(0) <= bound + CLOSE * (1.0 + bound)).all()


@pytest.mark.parametrize("interval", [(0.0, 3.0), (3.5, 4.5), (5.0, 4.0), (math.nan, 4.0), (3.0, math.nan)])
def test_nothing_is_extrapolated(interval: tuple[float, float]) -> None:
    laws: list[Law] = [fixed(Pose(1.0), (2.0, 4.0)), linear(Pose(), (0.1, 0.0, 0.0), 0.0, (2.0, 4.0))]
    for law in laws:
        assert law.sweep(*interval).point(1, 0.0, 0.0, 0.0).tolist() == 3 * [math.inf]
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
    table = path.spline
    t = np.concatenate([rng.uniform(path.start - 0.5, path.end + 0.5, 30), path.time])
    q, state = np.empty(path.n), np.empty((4, path.n))
    for each in t:
        held = min(max(each, path.start), path.end)
        spline_state(table, each, q)
        same(q, path.evaluate(held))
        piece_motion(*table[:2], each, state)
        for order in range(1, 4):
            size = np.abs(bernstein(path, order)).max()
            assert np.all(np.abs(state[order] - path.evaluate(held, order)) <= CLOSE * (1.0 + size))
    spline_state(table, math.nan, q)
    assert np.isnan(q).all()


def test_beside_a_trajectory_that_does_not_rest_nothing_is_known() -> None:
    time, q = np.array([0.0, 1.0]), np.zeros((2, 1))
    moving = np.array([[0.0], [0.5]])
    path = Trajectory(time, q, moving, q)
    for t0, t1, known in ((-1.0, 0.5, True), (0.5, 1.0, True), (0.5, 1.1, False), (0.5, 0.4, False)):
        assert np.isfinite(sweep(path, np.array([t0]), np.array([t1]))).all() == known
    for t0, t1 in ((math.nan, 0.5), (0.5, math.nan)):
        low, high = sweep(path, np.array([t0]), np.array([t1]))
        assert (low == -math.inf).all()
        assert (high == math.inf).all()
