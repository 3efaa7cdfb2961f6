"""Ends of profiles: outermost phases too short to be written, and what is done instead."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from assur.planner.errors import FaultError
from assur.planner.timing.ends import Cubics, missed
from assur.planner.timing.profile import finished
from assur.planner.trajectory import Trajectory

A, J = 30.0, 600.0


def phases(start: tuple[float, float, float], lengths: list[float], jerks: list[float]) -> Cubics:
    """Phases of these lengths and jerks from a state, and one more at constant acceleration, as the solver has them."""
    t, states = [0.0], [start]
    for h, j in zip(lengths, jerks, strict=True):
        p, v, a = states[-1]
        states.append((p + h * (v + h * (a / 2 + h * j / 6)), v + h * (a + h * j / 2), a + h * j))
        t.append(t[-1] + h)
    columns = [[state[k] for state in states] for k in range(3)]
    return Cubics(t, columns[0], columns[1], columns[2], [*jerks, 0.0], A, J)


def written(joint: Cubics) -> Trajectory:
    """The knots of one joint's phases between the states that they begin and end in."""
    states = [[joint.p[0]], [joint.v[0]], [joint.a[0]], [joint.p[-1]], [joint.v[-1]], [joint.a[-1]]]
    return Trajectory(*finished([joint], states, joint.t[-1]).knots(4.0))


SHORT = (3e-7, 1e-6, 3e-6, 1e-5, 3e-5)
LONG = [0.02, 0.03, 0.05]


@pytest.mark.parametrize("short", SHORT)
@pytest.mark.parametrize("jerk", [-J, 0.0, J])
@pytest.mark.parametrize("at_start", [False, True])
def test_a_short_outermost_phase_costs_less_than_the_jerk_reserve(short: float, jerk: float, *, at_start: bool) -> None:
    for signs in itertools.product([-J, 0.0, J], repeat=3):
        lengths, jerks = [*LONG, short], [*signs, jerk]
        if at_start:
            lengths, jerks = lengths[::-1], jerks[::-1]
        path = written(phases((2.7, 1.0, 0.0), lengths, jerks))
        assert np.abs(path.bernstein(3)).max() <= J * 1.02


@pytest.mark.parametrize("short", SHORT)
@pytest.mark.parametrize("at_start", [False, True])
def test_a_bump_at_an_end_costs_less_than_the_jerk_reserve(short: float, *, at_start: bool) -> None:
    lengths, jerks = [*LONG, short, short], [J, 0.0, -J, J, -J]
    if at_start:
        lengths, jerks = lengths[::-1], jerks[::-1]
    path = written(phases((-2.7, 1.0, 0.0), lengths, jerks))
    assert np.abs(path.bernstein(3)).max() <= J * 1.02


def test_a_short_end_of_a_plateau_keeps_the_acceleration_within_its_reserve() -> None:
    for short, plateau in itertools.product(SHORT, [1e-3, 0.05, 1.0]):
        path = written(phases((1.0, 0.0, 0.0), [A / J, plateau, short], [J, 0.0, -J]))
        assert np.abs(path.bernstein(2)).max() <= A * 1.001
        assert np.abs(path.bernstein(3)).max() <= J * 1.02


@pytest.mark.parametrize("short", SHORT)
def test_whatever_is_left_out_the_ends_are_exact_and_the_way_hardly_changes(short: float) -> None:
    joint = phases((2.7, 1.0, 0.0), [short, *LONG, short], [J, -J, 0.0, J, -J])
    path = written(joint)
    assert np.ravel(path.state(path.start)).tolist() == [joint.p[0], joint.v[0], joint.a[0]]
    assert np.ravel(path.state(path.end)).tolist() == [joint.p[-1], joint.v[-1], joint.a[-1]]
    for t in np.linspace(0, joint.t[-1], 50).tolist():
        phase = max(k for k, begin in enumerate(joint.t) if begin <= t)
        # What J δ of acceleration does over the motion, at most.
        assert path.evaluate(min(4.0 + t, path.end))[0] == pytest.approx(
            joint.at(phase, t - joint.t[phase])[0], abs=1e-9 + J * short * joint.t[-1] ** 2 / 10
        )


def test_a_motion_as_short_as_such_a_phase_is_written_as_it_is() -> None:
    joint = phases((0.0, 1.0, 0.0), [4e-6, 4e-6, 4e-6], [J, 0.0, -J])
    path = written(joint)
    assert path.end - path.start == pytest.approx(1.2e-5, rel=1e-9)
    assert np.ravel(path.state(path.end)).tolist() == [joint.p[-1], joint.v[-1], joint.a[-1]]


def test_a_joint_that_arrives_early_waits() -> None:
    early = phases((1.0, 0.0, 0.0), [0.1, 0.2, 0.1], [1.0, -1.0, 1.0])
    late = phases((1.0, 0.0, 0.0), [0.2, 0.4, 0.2], [1.0, -1.0, 1.0])
    states = [[early.p[0]] * 2, [0.0] * 2, [0.0] * 2, [early.p[-1], late.p[-1]], [0.0] * 2, [0.0] * 2]
    profile = finished([early, late], states, 0.8)
    waiting = profile.evaluate(np.linspace(0.4, 0.8, 9))
    assert waiting[:, 0] == pytest.approx(np.full(9, early.p[-1]), abs=1e-12)
    assert waiting[-1, 1] == late.p[-1]


@pytest.mark.parametrize(("which", "off"), [(3, 2e-7), (4, 2e-7), (5, 2e-6)])
def test_phases_that_do_not_end_at_the_goal_are_a_fault(which: int, off: float) -> None:
    joint = phases((0.0, 0.0, 0.0), LONG, [J, 0.0, -J])
    states = [[0.0], [0.0], [0.0], [joint.p[-1]], [joint.v[-1]], [joint.a[-1]]]
    for share, accepted in ((0.4, True), (1.0, False), (np.nan, False)):
        moved = [list(row) for row in states]
        moved[which][0] += share * off
        assert (missed(joint, (moved[3][0], moved[4][0], moved[5][0]), joint.t[-1]) <= 1) is accepted
        if accepted:
            assert finished([joint], moved, joint.t[-1]).end[which - 3][0] == moved[which][0]
        else:
            with pytest.raises(FaultError, match="do not end"):
                finished([joint], moved, joint.t[-1])
