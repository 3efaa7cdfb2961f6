"""The SCARA: its links by the pose algebra, every case of its dyad, near singular places and on right angles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion, Pose
from assur.planner.robots.facts import Code, Limits
from assur.planner.robots.scara import FLANGE, Scara
from tests.planner.robots.families import BASE, scara


def same_angle(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.abs(np.angle(np.exp(1j * (a - b)))))


def test_the_lift_carries_the_arms_where_they_rise_and_the_flange_alone_where_they_do_not() -> None:
    q = np.array([0.3, 1.0, 0.2, 0.0])
    low, high = scara().placements(q)[0], scara(arms_rise=True).placements(q)[0]
    assert low[:, 2].tolist() == [0.2, 0.2, 0.2, 0.4, 0.4]
    assert high[:, 2].tolist() == [0.2, 0.4, 0.4, 0.4, 0.4]
    assert np.array_equal(low[:, :2], high[:, :2])
    assert np.array_equal(scara().forward(q)[0], scara(arms_rise=True).forward(q)[0])


@given(
    theta1=st.floats(-3.0, 3.0),
    gap=st.floats(2.0, 5.0).map(lambda k: 10.0**-k),
    mode=st.sampled_from([0, 1]),
    folded=st.booleans(),
    base=st.sampled_from([Pose(), BASE]),
)
def test_near_a_singularity_the_inverse_still_comes_back_to_its_flange(
    theta1: float, gap: float, mode: int, folded: bool, base: Pose
) -> None:
    robot = scara(base=base)
    theta2 = (1 if mode else -1) * (np.pi - gap if folded else gap)
    q = np.array([theta1, theta2, 0.2, 1.0])
    p, yaw = robot.forward(q)
    zero = np.zeros(3)
    got = robot.inverse(Motion.of(p, zero, zero, zero, yaw, *(np.array(0.0),) * 3), mode)
    assert got.code == Code.ASSEMBLED
    back, back_yaw = robot.forward(got.q)
    assert np.abs(back - p).max() < 1e-14
    assert same_angle(back_yaw, yaw) < 1e-13
    assert abs(got.q[1] - theta2) < 1e-14 / gap
    assert got.margin == pytest.approx(np.sin(gap), rel=1e-14 / gap**2 + 1e-12)


grid = st.integers(-4, 4).map(lambda k: k * np.pi / 4)


@given(q1=grid, q2=grid, q4=grid, base_yaw=grid, shape=st.sampled_from([(), (2,)]))
def test_on_right_angles_the_inverse_comes_back_to_its_flange(
    q1: float, q2: float, q4: float, base_yaw: float, shape: tuple[int, ...]
) -> None:
    robot = scara(base=Pose(0.5, -0.25, 0.0, base_yaw), l1=0.25, l2=0.25)
    q = np.broadcast_to(np.array([q1, q2, 0.2, q4]), (*shape, 4))
    zero = np.zeros((*shape, 4))
    mode = int(robot.mode_of(np.array([q1, q2, 0.2, q4])))
    got = robot.inverse(robot.link_motion(FLANGE, q, zero, zero, zero), mode)
    if abs(q2) == np.pi:
        assert (got.code == Code.INDETERMINATE).all()
    else:
        assert (got.code == (Code.STRETCHED if q2 == 0 else Code.ASSEMBLED)).all()
        assert np.abs(robot.forward(got.q)[0] - robot.forward(q)[0]).max() < 1e-14
        assert same_angle(robot.forward(got.q)[1], robot.forward(q)[1]).max() < 1e-14


def test_the_mode_is_right_where_theta2_is_positive_and_none_where_it_is_unknown() -> None:
    q = np.zeros((6, 4))
    q[:, 1] = [0.5, -0.5, 2.6, -2.6, np.nan, np.inf]
    with np.errstate(all="raise"):
        assert scara().mode_of(q).tolist() == [1, 0, 1, 0, -1, -1]
    assert scara().margin(q)[:4].tolist() == np.abs(np.sin(q[:4, 1])).tolist()
    assert np.isnan(scara().margin(q)[4:]).all()


def test_within_takes_the_limits_themselves_and_nothing_beyond_rounding_and_no_nan() -> None:
    high = np.array([3.0, 2.6, 0.4, 6.4])
    robot = Scara(
        name="arm",
        l1=0.325,
        l2=0.225,
        axes=4,
        limits=Limits(np.array([-3.0, -2.6, 0.1, -6.4]), high, high, high, high),
    )
    lower, upper = robot.limits.lower, robot.limits.upper
    assert (robot.limits.slack <= 1.01e-10 * (upper - lower)).all()
    assert robot.within(np.stack([lower, upper, (lower + upper) / 2])).all()
    for joint in range(4):
        for edge, outwards in ((lower, -1.0), (upper, 1.0)):
            beyond = edge.copy()
            beyond[joint] += outwards * 1.01 * robot.limits.slack[joint]
            assert not robot.within(beyond)
        unknown = lower.copy()
        unknown[joint] = np.nan
        assert not robot.within(unknown)
    assert robot.within(np.empty((0, 4))).shape == (0,)
    assert robot.within(np.zeros((2, 3, 4))).shape == (2, 3)
