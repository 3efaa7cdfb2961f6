"""The other robot's links move as its plan says, stand still before and after it, and are bounded."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.laws import Law, Pose
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
