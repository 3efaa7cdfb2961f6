"""The other robot's links move as its plan says, stand still before and after it, and are bounded."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.laws import Law, Motion, Pose
from assur.planner.model.link_frames import link_law
from assur.planner.robots.facts import Limits
from assur.planner.robots.scara import Scara
from assur.planner.trajectory import Trajectory
from tests.planner.laws.bounded import bounded
from tests.planner.laws.bounded import rates as truth_of

LIMITS = Limits(
    np.array([-2.9, -2.5, -0.2, -6.0]),
    np.array([2.9, 2.5, 0.2, 6.0]),
    np.array([7.0, 11.0, 2.0, 40.0]),
    np.array([100.0, 200.0, 40.0, 700.0]),
    np.array([5e3, 1e4, 2e3, 4e4]),
)
ARM = Scara(name="other", l1=0.325, l2=0.225, axes=4, limits=LIMITS, base=Pose(0.8, 0.1, 0.3, math.pi))
LINKS = range(len(ARM.links))
TIMES = np.array([1.0, 1.4, 1.7, 2.5])
"""Knots of the plan: it runs from 1 to 2.5 s."""


def plan(**changed: Any) -> Trajectory:
    """A motion from rest to rest by way of two knots that it passes in motion."""
    knots: dict[str, FloatArray] = {
        "time": TIMES,
        "q": np.array([[0.2, 1.0, 0.1, 0.0], [0.9, 0.3, 0.05, -1.0], [1.2, -0.6, 0.0, 2.0], [0.7, -1.1, 0.15, 3.0]]),
        "qd": np.array([[0.0, 0, 0, 0], [1.5, -2.0, -0.3, 1.0], [0.5, -2.0, 0.1, 4.0], [0, 0, 0, 0]]),
        "qdd": np.array([[0.0, 0, 0, 0], [1.0, 0.0, 0.3, 8.0], [-3.0, 4.0, 0.5, -9.0], [0, 0, 0, 0]]),
    }
    return Trajectory(**{**knots, **changed})


def fields(motion: Motion) -> FloatArray:
    """(4 orders, T, 4 coordinates)."""
    yaws = (motion.yaw, motion.yaw_d, motion.yaw_dd, motion.yaw_ddd)
    vectors = (motion.p, motion.v, motion.a, motion.j)
    return np.stack([np.concatenate([p, y[..., None]], axis=-1) for p, y in zip(vectors, yaws, strict=True)])


def rates(law: Law, t: FloatArray, n: FloatArray) -> FloatArray:
    """(4, T), in the order of `Bounded`."""
    return truth_of(law.motion(t), n)


def bound(law: Law, start: float, end: float, n: FloatArray) -> FloatArray:
    """(4,)"""
    return bounded(law, np.array([start]), np.array([end]), n[None]).table[:, 0]


@pytest.mark.parametrize("link", LINKS)
def test_a_link_is_where_the_robot_places_it_along_the_plan(link: int) -> None:
    t = np.linspace(1.0, 2.5, 31)
    motion = link_law(ARM, plan(), link).motion(t)
    position, rotation = ARM.placements(plan().evaluate(t))
    np.testing.assert_allclose(motion.p, position[:, link], atol=1e-12)
    np.testing.assert_allclose(np.cos(motion.yaw), rotation[:, link, 0, 0], atol=1e-12)
    np.testing.assert_allclose(np.sin(motion.yaw), rotation[:, link, 1, 0], atol=1e-12)


@pytest.mark.parametrize("link", LINKS)
def test_each_derivative_is_the_difference_quotient_of_the_one_below(link: int) -> None:
    law, step = link_law(ARM, plan(), link), 1e-4
    t = np.linspace(0.8, 2.7, 200)
    t = t[np.abs(t[:, None] - TIMES).min(axis=1) > 3 * step]
    exact = fields(law.motion(t))
    before2, before, after, after2 = (fields(law.motion(t + k * step))[:3] for k in (-2, -1, 1, 2))
    wrong = np.abs((before2 - 8 * before + 8 * after - after2) / (12 * step) - exact[1:]).max(axis=(1, 2))
    assert (wrong <= 1e-8 * (1 + np.abs(exact[1:]).max(axis=(1, 2)))).all()


@pytest.mark.parametrize("link", LINKS)
def test_a_link_stands_still_before_and_after_the_plan_and_nothing_jumps_there(link: int) -> None:
    law = link_law(ARM, plan(), link)
    outside = fields(law.motion(np.array([-1e5, 0.0, np.nextafter(1.0, 0), 2.5, np.nextafter(2.5, 9), 9.0, 1e5])))
    assert not outside[1:].any()
    first, last = fields(law.motion(np.array([1.0, np.nextafter(2.5, 0)]))).transpose(1, 0, 2)
    np.testing.assert_allclose(outside[0, :3], np.tile(first[0], (3, 1)), atol=1e-14)
    np.testing.assert_allclose(outside[0, 3:], np.tile(last[0], (4, 1)), atol=1e-12)
    assert np.abs([first[1:3], last[1:3]]).max() <= 1e-9


times = st.one_of(st.sampled_from([1.0, 1.4, 1.7, 2.5, 0.0, 3.0]), st.floats(0.5, 3.0))


@pytest.mark.parametrize("link", LINKS)
@given(start=times, end=times, around=st.floats(-4, 4), up=st.sampled_from([0.0, 1.0, 0.6]))
def test_a_bound_is_at_least_every_sample_inside_across_and_outside_of_the_plan(
    link: int, start: float, end: float, around: float, up: float
) -> None:
    law, (start, end) = link_law(ARM, plan(), link), sorted((start, end))
    flat = math.sqrt(1 - up**2)
    n = np.array([flat * math.cos(around), flat * math.sin(around), up])
    t = np.unique([*np.linspace(start, end, 300), *(knot for knot in TIMES if start <= knot <= end)])
    t = t[(start <= t) & (t <= end)]
    assert (bound(law, start, end, n) >= rates(law, t, n).max(axis=1)).all()


@pytest.mark.parametrize("link", LINKS)
@given(start=st.floats(0.9, 2.6))
def test_over_a_short_interval_the_bound_of_the_turning_is_sharp(link: int, start: float) -> None:
    law, along = link_law(ARM, plan(), link), np.array([1.0, 0.0, 0.0])
    end = start + 1e-4
    motion = law.motion(np.array([start, end]))
    turn, turn_d = np.abs(motion.yaw_d).max(), np.abs(motion.yaw_dd).max()
    found = bound(law, start, end, along)
    # By how much both, and the direction of the axes, change over the interval.
    assert found[2] <= turn * (1 + 1e-2) + 1e-2
    assert found[3] <= math.hypot(turn_d, turn**2) * (1 + 1e-2) + 0.1


def test_a_vertical_direction_sees_the_quill_alone() -> None:
    up = np.array([0.0, 0.0, 1.0])
    for link, name in enumerate(ARM.links):
        law = link_law(ARM, plan(), link)
        truth = rates(law, np.linspace(1.0, 2.5, 4000), up).max(axis=1)
        found = bound(law, 0.0, 9.0, up)
        moves = name in ("quill", "flange")
        assert ((truth[:2] > 0) == moves).all()
        assert ((found[:2] > 1e-9) == moves).all()


@pytest.mark.parametrize("link", LINKS)
def test_what_stands_still_has_no_bounds_to_speak_of(link: int) -> None:
    law = link_law(ARM, plan(), link)
    for start, end in ((0.0, 0.99), (2.51, 9.0), (3.0, 3.0)):
        assert bound(law, start, end, np.array([0.6, 0.0, 0.8])).max() <= 1e-8


def test_a_neighbour_is_known_where_it_says_and_nowhere_else() -> None:
    law = link_law(ARM, plan(), 4, (0.0, 2.0))
    assert np.isfinite(law.motion(np.array([0.0, 2.0])).p).all()
    assert np.isnan(law.motion(np.array([-0.1, 2.1, math.nan, math.inf])).p).all()
    assert np.isposinf(bound(law, 1.0, 2.1, np.array([1.0, 0.0, 0.0]))).all()
    with pytest.raises(InputError, match=r"neighbour\.valid"):
        link_law(ARM, plan(), 4, (2.0, 0.0))


def test_a_plan_that_does_not_begin_and_end_at_rest_is_refused() -> None:
    for name in ("qd", "qdd"):
        for knot, end in ((0, "start"), (-1, "end")):
            moving = np.array(getattr(plan(), name))
            moving[knot, 2] = 1e-9
            with pytest.raises(InputError) as refused:
                link_law(ARM, plan(**{name: moving}), 4)
            assert refused.value.field == f"neighbour.trajectory.{end}"


@pytest.mark.parametrize("link", [-1, 5, 1.5, None])
def test_a_link_that_the_robot_has_not_is_refused(link: Any) -> None:
    with pytest.raises(InputError) as refused:
        link_law(ARM, plan(), link)
    assert refused.value.field == "neighbour.link"


def test_a_plan_of_another_number_of_joints_is_refused() -> None:
    narrow = {name: getattr(plan(), name)[:, :3] for name in ("q", "qd", "qdd")}
    with pytest.raises(InputError) as refused:
        link_law(ARM, plan(**narrow), 4)
    assert refused.value.field == "neighbour.trajectory"
