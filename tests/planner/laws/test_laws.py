"""What each law is for: numbers that can be had without it."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.laws import Change, Law, Pose, conveyor, keyframes, turntable
from tests.planner.laws.laws import Case, cases, changes


def at(*times: float) -> FloatArray:
    return np.array(times)


@pytest.mark.parametrize("jerk", [2.0, 8.0, 1000.0, math.inf])
def test_a_ramp_covers_the_mean_of_both_speeds_times_its_duration(jerk: float) -> None:
    change = Change(1.0, 0.3, 2.0, jerk)
    took = sum(duration for duration, _, _ in change.phases(1.1))
    found = conveyor(Pose(), 1.1, (change,)).motion(at(1.0, 1.0 + took / 2, 1.0 + took))
    np.testing.assert_allclose(found.p[2, 0] - found.p[0, 0], 0.5 * (1.1 + 0.3) * took, rtol=1e-12)
    np.testing.assert_allclose(found.v[:, 0], [1.1, 0.7, 0.3], rtol=1e-12)


@given(st.floats(-2, 2), st.floats(-2, 2), st.floats(0.1, 10), st.floats(0.1, 1000))
@example(0.0, 5e-324, 1.0, 2.0)
def test_a_ramp_is_the_shortest_within_its_acceleration_and_jerk(
    before: float, after: float, acceleration: float, jerk: float
) -> None:
    phases = Change(0.0, after, acceleration, jerk).phases(before)
    took = sum(duration for duration, _, _ in phases)
    delta = abs(after - before)
    # Either the acceleration limit is reached (trapezoid of acceleration) or not (triangle); both printed in R1.
    full = delta >= acceleration**2 / jerk
    expected = delta / acceleration + acceleration / jerk if full else 2 * math.sqrt(delta / jerk)
    assert took == pytest.approx(expected, rel=1e-9)
    assert all(abs(a + j * d) <= acceleration * (1 + 1e-12) and abs(j) in (0.0, jerk) for d, a, j in phases)


@given(st.data())
def test_a_belt_has_the_commanded_speed_after_each_change_whenever_it_is_asked(data: st.DataObject) -> None:
    commands, _ = data.draw(changes(0.25))
    belt = conveyor(Pose(), 0.25, commands, data.draw(st.floats(-1, 5)))
    speed = 0.25
    for change in commands:
        assert belt.motion(at(change.time)).v[0, 0] == pytest.approx(speed, abs=1e-12)
        end = change.time + sum(duration for duration, _, _ in change.phases(speed))
        assert belt.motion(at(end)).v[0, 0] == pytest.approx(change.speed, abs=1e-12)
        speed = change.speed
    assert belt.motion(at(belt.numbers.at_time)).p[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert belt.motion(at(1000.0)).v[0, 0] == speed


@pytest.mark.parametrize("law", [conveyor, turntable])
def test_changes_that_overlap_are_refused_by_name(law: Callable[..., Law]) -> None:
    stop = Change(1.0, 0.0, 1.0, math.inf)  # from 0.5 it takes until 1.5
    name = law.__name__
    for time in (1.0, 1.4999, 0.0):
        with pytest.raises(InputError) as refused:
            law(Pose(), 0.5, changes=(stop, Change(time, 0.5, 1.0, 10.0)))
        assert refused.value.field == f"{name}.changes[1].time"
        assert "1.5 s" in refused.value.allowed
    law(Pose(), 0.5, changes=(stop, Change(1.5, 0.5, 1.0, 10.0)))


def test_a_change_in_no_time_is_a_jump_and_refused() -> None:
    with pytest.raises(InputError) as refused:
        conveyor(Pose(), 0.5, (Change(0.0, 0.5 + 1e-6, 1e6, math.inf),))
    assert refused.value.field == "conveyor.changes[0].acceleration"
    with pytest.raises(InputError, match=r"changes\[0\].*10 µs"):
        conveyor(Pose(), 0.0, (Change(0.0, 5e-324, 1.0, 2.0),))


@given(cases(("repeated",)), st.integers(-1000, 1000), st.floats(0, 1))
def test_what_repeats_is_the_same_after_any_number_of_periods_but_for_whole_turns(
    case: Case, rounds: int, where: float
) -> None:
    law = case.law
    first, period = law.numbers.times[0], law.cycle_s or math.nan
    once, again = (law.motion(first + period * (np.array([where]) + k)) for k in (0, rounds))
    for name in ("p", "v", "a", "yaw_d", "yaw_dd"):
        value = getattr(once, name)
        np.testing.assert_allclose(getattr(again, name), value, atol=1e-8 * (1 + np.abs(value).max()))
    turns = round((law.numbers.poses[-1].yaw - law.numbers.poses[0].yaw) / (2 * math.pi))
    np.testing.assert_allclose(again.yaw - once.yaw, 2 * math.pi * turns * rounds, atol=1e-7)
    there = np.array([(p.x, p.y, p.z, p.yaw) for p in law.numbers.poses[:-1]])
    knots = np.asarray(law.numbers.times)[:-1] + rounds * period
    found = law.motion(knots)
    np.testing.assert_allclose(np.column_stack([found.p, found.yaw - 2 * math.pi * turns * rounds]), there, atol=1e-7)


@pytest.mark.parametrize(
    ("last", "field"),
    [
        (Pose(1e-9), "keyframes.points[2].at"),
        (Pose(0.0, 0.0, np.nextafter(0.0, 1)), "keyframes.points[2].at"),
        (Pose(yaw=math.pi), "keyframes.points[2].yaw"),
        (Pose(yaw=2 * math.pi + 1e-9), "keyframes.points[2].yaw"),
    ],
)
def test_a_sequence_that_does_not_end_where_it_began_cannot_repeat(last: Pose, field: str) -> None:
    with pytest.raises(InputError) as refused:
        keyframes((0.0, 1.0, 2.0), (Pose(), Pose(0.1), last), "periodic")
    assert refused.value.field == field
    assert refused.value.allowed.startswith("that of the first point, for the sequence repeats")
    keyframes((0.0, 1.0, 2.0), (Pose(), Pose(0.1), last))
