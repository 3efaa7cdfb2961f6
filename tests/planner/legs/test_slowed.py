"""Motions that are slowed down where they pull too hard: the same way, the same ends, at the limit for most of it."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.legs.joint import slowed
from assur.planner.legs.tool_motion import RESERVE, tool_accelerations, tool_peak
from assur.planner.model.scene import Scene
from assur.planner.timing import TimingRefusal
from assur.planner.trajectory import Trajectory
from tests.planner.cells import arm, cell, go, limits
from tests.planner.timing.legs import time_joints
from tests.planner.trajectory.splines import keeps_limits

LIMITS = limits()
FROM, TO = np.array([-1.2, 0.8, 0.15, 0.0]), np.array([1.5, 1.2, 0.2, 0.5])


def scene() -> Scene:
    return cell(go(0.3, 0.0), robot=arm(), q=tuple(FROM.tolist()))


def motion(effort: float = 1.0, **ends: FloatArray) -> Trajectory:
    none: Any = np.zeros(4)
    first, last = ends.get("first", none), ends.get("last", none)
    rates = LIMITS.velocity * effort**0.5, LIMITS.acceleration * effort, LIMITS.jerk * effort**1.5
    found = time_joints(FROM, first, none, TO, last, none, *rates)
    assert not isinstance(found, TimingRefusal)
    return found


@pytest.mark.parametrize(("effort", "share"), [(0.7, 0.5), (1.0, 0.25), (1.0, 0.1)])
def test_a_slowed_motion_keeps_the_limit_its_way_and_its_ends(effort: float, share: float) -> None:
    here, whole = scene(), motion(effort)
    peak, _ = tool_peak(here, whole, whole.start, whole.end)
    found = slowed(here, 0, whole, share * peak, LIMITS)
    assert found is not None
    fine = np.linspace(found.start, found.end, int(found.duration / 1e-4) + 2)
    assert tool_accelerations(here, found, fine).max() <= share * peak
    kinds = LIMITS.lower, LIMITS.upper, LIMITS.velocity, LIMITS.acceleration, LIMITS.jerk
    assert keeps_limits(found, *kinds)
    assert np.array_equal(found.knots[0], whole.knots[0])
    assert np.array_equal(found.knots[-1, 1:], whole.knots[-1, 1:])
    # less time than if all of it were stretched until its peak is low enough
    assert found.duration < 0.93 * whole.duration / share**0.5
    assert found.duration > whole.duration
    # on the way of before: each position is one of the other's
    dense = whole.evaluate(np.linspace(whole.start, whole.end, 20001))
    for q in found.evaluate(np.linspace(found.start, found.end, 97)):
        assert np.abs(dense - q).max(1).min() <= 5e-4


def test_most_of_a_motion_that_is_slowed_down_is_near_the_limit() -> None:
    here, whole = scene(), motion()
    limit = 0.2 * tool_peak(here, whole, whole.start, whole.end)[0]
    found = slowed(here, 0, whole, limit, LIMITS)
    assert found is not None
    times = np.linspace(found.start, found.end, 101)
    pulls = [tool_peak(here, found, a, b)[0] for a, b in pairwise(times.tolist())]
    assert np.mean(np.array(pulls) >= 0.8 * limit) >= 0.6


def test_what_already_keeps_the_limit_is_not_slowed_down() -> None:
    here, whole = scene(), motion()
    peak, _ = tool_peak(here, whole, whole.start, whole.end)
    assert slowed(here, 0, whole, 1.01 * peak / (1 - RESERVE), LIMITS) is None


def test_an_end_in_motion_is_kept_and_one_that_pulls_too_hard_itself_is_not_slowed() -> None:
    """A joint that lifts at the end, as above a point, pulls little; the first joint at full speed pulls inwards."""
    here = scene()
    lifting = motion(0.7, first=np.array([0.0, 0.0, 0.05, 0.0]))
    limit = 0.6 * tool_peak(here, lifting, lifting.start, lifting.end)[0]
    found = slowed(here, 0, lifting, limit, LIMITS)
    assert found is not None
    assert found.duration > lifting.duration
    assert np.array_equal(found.knots[0], lifting.knots[0])
    swinging = motion(last=np.array([LIMITS.velocity[0], 0.0, 0.0, 0.0]))
    assert slowed(here, 0, swinging, 0.1, LIMITS) is None
