"""Bounds of point speed and acceleration along a direction, of every robot: never below the truth, and sharp."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.robots.robot import Robot
from tests.planner.robots.families import MADE, NAMES, STENCIL, random_q, robot_named
from tests.planner.robots.five_bars import LENGTHS, five_bar, states
from tests.planner.robots.point_bounds import joint_jets, point_bounds

SECOND = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
"""Weights of the central second difference."""
UP = np.array([[0.0, 0.0, 1.0]])
KINDS = (*MADE, "mitsubishi-rp-5ah", "mitsubishi-rv-m1", "polar-arm", "elbow-arm")
every_link = pytest.mark.parametrize(
    ("name", "link"), [(name, link) for name in KINDS for link in range(len(robot_named(name).links))]
)


def ranges(robot: Robot, rng: np.random.Generator, size: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Random states (size, n), singular or not, at the corners of ranges that a proof may ask for: instants, and up to
    0.02 wide."""
    middle = rng.uniform(robot.limits.lower, robot.limits.upper, (40 * size, len(robot.joints)))
    middle = middle[robot.within(middle)][:size]
    assert len(middle) == size
    width = rng.choice([0.0, 1e-6, 1e-3, 0.02], (size, 1))
    lower, upper = middle - width * rng.random(middle.shape), middle + width * rng.random(middle.shape)
    return lower, upper, lower + (upper - lower) * rng.integers(0, 2, middle.shape)


@every_link
def test_the_bounds_are_never_below_the_truth_anywhere_in_the_range(name: str, link: int) -> None:
    """Truth by differences of placements, of upright links by the rotation about the vertical: none of the bound's own
    formulas."""
    robot, rng, size = robot_named(name), np.random.default_rng(link), 1_000
    lower, upper, q = ranges(robot, rng, size)
    qd, qdd = rng.normal(size=(2, *q.shape)) * np.array([2.0, 8.0])[:, None, None]
    local = rng.normal(size=(size, 3)) * 0.15
    if link in robot.tilting:
        step, around = 1e-3, []
        for k in range(-4, 5):
            position, rotation = robot.placements(q + qd * k * step + qdd * (k * step) ** 2 / 2)
            around.append(position[:, link] + (rotation[:, link] @ local[..., None])[..., 0])
        v, a = (np.tensordot(w, np.stack(around), 1) / step**order for order, w in ((1, STENCIL), (2, SECOND)))
        off = 1e-8, 1e-4
    else:
        frame = robot.link_motion(link, q, qd, qdd, 0 * q)
        c, s = np.cos(frame.yaw), np.sin(frame.yaw)
        x, y = c * local[:, 0] - s * local[:, 1], s * local[:, 0] + c * local[:, 1]
        out, along = np.stack([x, y, 0 * x], -1), np.stack([-y, x, 0 * x], -1)
        v = frame.v + frame.yaw_d[:, None] * along
        a = frame.a + frame.yaw_dd[:, None] * along - frame.yaw_d[:, None] ** 2 * out
        off = 1e-14, 1e-12
    joints = joint_jets(lower, upper, qd, qdd)
    for n in (rng.normal(size=(size, 3)), np.tile(UP, (size, 1)), v, a):
        unit = n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)
        speed, acceleration = point_bounds(robot, link, local, unit, joints)
        known = np.isfinite(speed)
        assert known.mean() > 0.5
        assert np.isfinite(acceleration).tolist() == known.tolist()
        for bound, truth, slack in ((speed, v, off[0]), (acceleration, a, off[1])):
            true, size_of = np.abs((unit * truth).sum(1)), 1.0 + np.linalg.norm(truth, axis=1)
            # near a singularity of a loop rates are rounded more
            assert (true[known] <= (bound * (1 + 1e-11) + slack + 1e-12 * size_of)[known]).all()
            # over an instant a bound is the truth
            instant = known & (upper == lower).all(1)
            assert instant.any()
            assert (bound[instant] <= (true + (1e-4 if link in robot.tilting else 1e-9) * size_of)[instant]).all()


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("bad", [np.inf, np.nan])
def test_what_is_not_known_is_bounded_by_infinity_without_a_warning(name: str, bad: float) -> None:
    robot = robot_named(name)
    q = random_q(robot, np.random.default_rng(1), 1)
    ones, n, point = np.ones_like(q), np.array([[0.6, 0.0, 0.8]]), np.full((1, 3), 0.1)
    for link in range(1, len(robot.links)):
        for unknown in (joint_jets(bad * q, bad * q, ones, ones), joint_jets(q, q, bad * ones, ones),
                        joint_jets(q, q, ones, bad * ones)):  # fmt: skip
            for bound in point_bounds(robot, link, point, n, unknown):
                assert (bound == np.inf).all(), (link, unknown)
    with np.errstate(all="raise"):
        wide = np.full(q.shape, np.inf)
        assert robot.assembled(-wide, wide).all() == (robot.parallel_least == 0.0)
        assert not robot.assembled(bad * q, bad * q).any() or robot.parallel_least == 0.0


# Arms whose links stay upright


# Arms whose links tilt


# A chain that is closed


@given(
    seed=st.integers(0, 2**32 - 1),
    lengths=st.sampled_from(sorted(LENGTHS)),
    width=st.floats(0.0, 1.5),
    assembly=st.sampled_from(["front", "back"]),
)
def test_a_range_that_is_proved_to_assemble_does_everywhere(
    seed: int, lengths: str, width: float, assembly: str
) -> None:
    robot, rng = five_bar(lengths, assembly=assembly), np.random.default_rng(seed)
    lower = rng.uniform(-3.2, 3.2, (200, 4))
    upper = lower + width * rng.random((200, 4))
    proved = robot.assembled(lower, upper)
    for share in (rng.random((30, 200, 4)), rng.integers(0, 2, (16, 200, 4))):
        margin = robot.parallel_margin(lower + share * (upper - lower))
        assert (margin[:, proved] >= robot.parallel_least - 1e-12).all()


def test_small_ranges_in_the_clear_are_proved_and_points_nearly_always() -> None:
    """The proof is of use: points, and 20 ms of full speed, 0.15 rad, where the margin is ample."""
    robot = five_bar()
    q = states(np.random.default_rng(1), robot, 1, 2_000)
    assert robot.assembled(q, q).all()
    ample = q[robot.parallel_margin(q) > 0.7]
    assert robot.assembled(ample - 0.075, ample + 0.075).mean() > 0.99


def test_nothing_is_known_of_a_loop_that_may_come_apart() -> None:
    robot, ones = five_bar("short"), np.ones((1, 4))
    q = np.array([[np.pi / 2, -np.pi / 2, 0.2, 0.0]])  # the elbows are too far apart
    for link in range(len(robot.links)):
        found = point_bounds(robot, link, 0.1 * np.ones((1, 3)), UP, joint_jets(q, q, ones, ones))
        assert np.ravel(found).tolist() == [np.inf, np.inf]
