"""Which motions are arches, and what is stated of the ways up and down."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from assur.planner.claim import columns as c
from assur.planner.claim.lifts import BACK, BACK_M, arches_of, goes_over, largest
from assur.planner.model.outcome import Course, Leg, LegKind, Route
from assur.planner.timing import Numbers, TimingRefusal, fastest_motion
from assur.planner.trajectory import Trajectory
from assur.planner.trajectory.trajectory import joined
from tests.planner.checker.statement.cases import case_of

LIMITS = ([1.0], [5.0], [250.0])


def at(z: float, rate: float = 0.0) -> Numbers:
    """The state of a joint."""
    return [z], [rate], [0.0]


def through(*states: Numbers) -> Trajectory:
    """The fastest motion through states of one joint."""
    knots = np.zeros((1, 4))
    for one, other in pairwise(states):
        found = fastest_motion(one, other, LIMITS, float(knots[-1, 0]))
        assert not isinstance(found, TimingRefusal)
        knots = joined(knots, found.knots) if len(knots) > 1 else found.knots
    return Trajectory.of_knots(knots)


def arched(first: float, last: float) -> Trajectory:
    """From 0 up to 0.1 m and down again, at these rates at both ends, m/s."""
    return through(at(0.0, first), at(0.1), at(0.0, last))


def way_back(path: Trajectory) -> float:
    """How far the joint goes down before it is highest, and up after it, m."""
    z = path.evaluate(np.linspace(path.start, path.end, 20_001))[:, 0]
    steps, top = np.diff(z), int(z.argmax())
    return float(np.maximum(-steps[:top], 0.0).sum() + np.maximum(steps[top:], 0.0).sum())


def test_at_an_instant_nothing_is_largest() -> None:
    path = arched(0.0, 0.0)
    when, value = largest(path, 2, path.end, path.end)
    assert (when[0], value[0]) == (path.end, 0.0)


@pytest.mark.parametrize("down", [False, True])
@pytest.mark.parametrize("speed", [0.0, 0.02, 0.1, 0.2, 0.3, 0.5])
def test_an_arch_may_go_so_far_the_wrong_way_and_no_farther(speed: float, down: bool) -> None:
    path = arched(0.0, speed) if down else arched(-speed, 0.0)
    back, most = way_back(path), BACK_M + BACK * 0.1
    assert not 1.0 < 1.2 * back / most <= 1.2  # so much more may be stated
    assert goes_over(path, 0) is (back <= most)


def test_a_motion_up_is_an_arch_and_one_that_comes_down_first_is_none() -> None:
    assert goes_over(through(at(0.05), at(0.1)), 0)
    assert goes_over(through(at(0.05), at(0.0)), 0)
    assert goes_over(through(at(0.05), at(0.1), at(0.0)), 0)
    assert not goes_over(through(at(0.05), at(0.0), at(0.1)), 0)
    assert not goes_over(through(at(0.0), at(0.1), at(0.0), at(0.05)), 0)


@pytest.mark.parametrize("speed", [0.05, 0.13, 0.2])
def test_rows_state_little_more_of_a_way_back_than_there_is(speed: float) -> None:
    case, path = case_of("standard-cycle"), arched(-speed, speed)
    n, lift = case.plan.trajectory.n, case.scene.robot.lift
    assert lift is not None
    knots = np.zeros((len(path.time), 1 + 3 * n))
    knots[:, [0, *(1 + lift + n * order for order in range(3))]] = path.knots
    motion = Trajectory.of_knots(knots)
    leg = Leg(LegKind.ARCH, 0, path.start, path.end, Route(Course.ARCH))
    rows = np.array(arches_of(case.scene, replace(case.plan, trajectory=motion, legs=(leg,))))
    rates = rows[rows[:, c.SUM_ORDER] == 1.0]
    lasts = rates[:, c.SUM_T1] - rates[:, c.SUM_T0]
    up = rates[:, c.SUM_HIGH] == c.GREATEST
    stated = (np.where(up, -rates[:, c.SUM_LOW], rates[:, c.SUM_HIGH]).clip(0.0) * lasts).sum()
    assert way_back(path) <= stated <= 1.2 * way_back(path) + 1e-5
