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
from assur.planner.laws import Change, Law, Pose, conveyor, indexer, keyframes, linear, oscillation, swing, turntable
from tests.planner.laws.laws import Case, cases, changes, poses


def at(*times: float) -> FloatArray:
    return np.array(times)


def test_a_linear_frame_is_at_its_pose_at_the_named_time_and_drifts() -> None:
    found = linear(Pose(1, 2, 3, 0.5), (0.1, -0.2, 0.3), 10.0).motion(at(10.0, 12.0))
    np.testing.assert_allclose(found.p, [[1.0, 2.0, 3.0], [1.2, 1.6, 3.6]], rtol=1e-15)
    np.testing.assert_array_equal(found.yaw, 0.5)


def test_a_belt_carries_along_its_own_x() -> None:
    found = conveyor(Pose(1.0, 2.0, 3.0, math.pi / 2), 0.25, at_time=4.0).motion(at(0.0, 4.0, 8.0))
    np.testing.assert_allclose(found.p, [[1, 1, 3], [1, 2, 3], [1, 3, 3]], atol=1e-15)
    np.testing.assert_allclose(found.v, 3 * [[0, 0.25, 0]], atol=1e-16)


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


def test_a_change_to_the_speed_that_is_had_already_changes_nothing() -> None:
    plain, commanded = conveyor(Pose(), 0.5), conveyor(Pose(), 0.5, (Change(1.0, 0.5, 1.0, 10.0),))
    t = np.linspace(0, 3, 7)
    np.testing.assert_array_equal(plain.motion(t).p, commanded.motion(t).p)


def test_a_point_on_a_dial_runs_round_and_on_a_screw_it_climbs() -> None:
    dial = turntable(Pose(1.0, 0.0, 0.5, 0.0), math.pi, rise=0.1, at_time=1.0)
    found = dial.motion(at(1.0, 1.5, 2.0)).at(Pose(0.2))
    np.testing.assert_allclose(found.p, [[1.2, 0, 0.5], [1.0, 0.2, 0.55], [0.8, 0, 0.6]], atol=1e-15)
    np.testing.assert_allclose(found.v[0], [0, 0.2 * math.pi, 0.1], rtol=1e-15)
    np.testing.assert_allclose(found.a[0], [-0.2 * math.pi**2, 0, 0], atol=1e-14)


def test_an_index_dial_steps_and_stands_for_ever_in_both_directions_of_time() -> None:
    dial = indexer(Pose(yaw=1.0), math.pi / 4, 0.4, 0.6, start=0.25)
    k = np.arange(-1000.0, 1000.0)
    for within, moved in ((0.0, 0.0), (0.2, 0.5), (0.4, 1.0), (0.7, 1.0)):
        found = dial.motion(0.25 + k + within)
        np.testing.assert_allclose(found.yaw, 1.0 + (k + moved) * math.pi / 4, rtol=0, atol=1e-9)
        assert np.abs(found.yaw_d).max() <= 1e-8 or within == 0.2
    np.testing.assert_array_equal(dial.motion(0.25 + k).p, 0)


def test_a_travelling_indexer_pushes_along_its_own_x() -> None:
    chain = indexer(Pose(0, 0, 0.1, math.pi), 0.5, 1.0, 0.0, kind="travel")
    np.testing.assert_allclose(chain.motion(at(0.0, 0.5, 3.0)).p[:, 0], [0, -0.25, -1.5], atol=1e-12)
    np.testing.assert_allclose(chain.motion(at(0.5)).v[0], [-35 / 16 * 0.5, 0, 0], atol=1e-12)


def test_a_gate_swings_about_its_mean_yaw() -> None:
    gate = swing(Pose(1, 2, 3, 0.5), 0.9, 2.0, math.pi / 2)
    np.testing.assert_allclose(gate.motion(at(0.0, 0.5, 1.0, 2.0)).yaw, [1.4, 0.5, -0.4, 1.4], atol=1e-12)
    np.testing.assert_array_equal(gate.motion(at(0.3, 7.0)).p, [[1, 2, 3], [1, 2, 3]])


@given(cases(("keyframes",)))
def test_keyframes_pass_through_their_poses(case: Case) -> None:
    found = case.law.motion(np.asarray(case.law.numbers.times))
    there = np.array([(p.x, p.y, p.z, p.yaw) for p in case.law.numbers.poses])
    np.testing.assert_allclose(np.column_stack([found.p, found.yaw]), there, atol=1e-12)
    ends = (
        [found.a[[0, -1]], found.yaw_dd[[0, -1]]]
        if case.law.numbers.ends == "natural"
        else [found.v[[0, -1]], found.yaw_d[[0, -1]]]
    )
    assert max(np.abs(end).max() for end in ends) <= 1e-9


@given(poses, poses, st.floats(0.1, 3.0))
def test_two_clamped_keyframes_are_the_cubic_step(first: Pose, last: Pose, took: float) -> None:
    u = np.linspace(0, 1, 11)
    found = keyframes((0.0, took), (first, last)).motion(np.minimum(u * took, took))
    step = (3 * u**2 - 2 * u**3)[:, None] * (last.position - first.position)
    np.testing.assert_allclose(found.p, first.position + step, atol=1e-12)
    np.testing.assert_allclose(found.yaw, first.yaw + (3 * u**2 - 2 * u**3) * (last.yaw - first.yaw), atol=1e-12)


def test_a_shutter_goes_up_and_down_about_its_pose() -> None:
    shutter = oscillation(Pose(1, 2, 3, 0.5), (0.0, 0.0, 1.0), 0.2, 2.0, math.pi / 2)
    found = shutter.motion(at(0.0, 0.5, 1.0, 2.0))
    np.testing.assert_allclose(found.p, [[1, 2, 3.2], [1, 2, 3.0], [1, 2, 2.8], [1, 2, 3.2]], atol=1e-12)
    np.testing.assert_allclose(found.v[:, 2], [0, -0.2 * math.pi, 0, 0], atol=1e-12)
    np.testing.assert_array_equal(found.yaw, 0.5)


def test_the_length_of_a_direction_does_not_count() -> None:
    short, long = (oscillation(Pose(), (0.3 * k, -0.4 * k, 0.0), 0.1, 1.0) for k in (0.01, 1.0))
    np.testing.assert_allclose(short.motion(at(0.25)).p, [[0.06, -0.08, 0.0]], rtol=1e-12)
    np.testing.assert_allclose(long.motion(at(0.25)).p, [[0.06, -0.08, 0.0]], rtol=1e-12)


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


def test_a_circle_of_keyframes_is_nearly_a_circle_and_turns_on() -> None:
    """Twelve points of a circle, tangent to it: SciPy's periodic spline is not asked."""
    angles = 2 * math.pi * np.arange(13) / 12
    way = [Pose(0.3 * math.cos(a), 0.3 * math.sin(a), 0.1, a) for a in angles]
    way[-1] = Pose(way[0].x, way[0].y, 0.1, 2 * math.pi)
    law = keyframes(np.arange(13) / 6.0, tuple(way), "periodic")
    t = np.linspace(-7, 9, 999)
    found = law.motion(t)
    np.testing.assert_allclose(found.yaw, math.pi * t, atol=1e-12)
    np.testing.assert_allclose(np.hypot(found.p[:, 0], found.p[:, 1]), 0.3, atol=3e-4)
    np.testing.assert_allclose(np.linalg.norm(found.v, axis=1), 0.3 * math.pi, rtol=3e-3)


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
