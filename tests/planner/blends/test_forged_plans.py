"""Plans with parabolic blends before the checker: the right one, and one forged in each way with a digest that fits."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.errors import InputError
from assur.planner.geometry.shapes import box
from assur.planner.model.digest import digest
from assur.planner.model.outcome import COVERS, Arrival, Missed, Plan, Planned
from assur.planner.model.scene import Move, Options, Scene, Target
from assur.planner.pipeline import plan
from assur.planner.trajectory import Trajectory
from tests.planner.cells import cell, go, stands
from tests.planner.trajectory.changed import changed as changed_path

TIME_S = 0.3
"""Acceleration time of the plan."""


def scene(**changes: Any) -> Scene:
    """Past two vias to a stop and on to another, over a box that does not leave much room."""
    asked: dict[str, Any] = {"timing": "parabolic_blend", "acceleration_time_s": TIME_S, "max_candidates": 200}
    options = Options(seed=3, budget_s=60.0, stop="first", stay_safe_s=0.1, **{**asked, **changes})
    task = (
        go(0.42, 0.05, 0.16, name="over", via=True),
        go(0.35, -0.15, 0.14, name="past", via=True),
        go(0.3, -0.3, 0.1, name="stop"),
        go(0.35, 0.2, 0.12, name="end"),
    )
    return replace(cell(*task, bodies=(stands("low", box(0.1, 0.1, 0.05), 0.4, 0.0, 0.025),)), options=options)


@cache
def right() -> tuple[Scene, Plan]:
    asked = scene()
    outcome = plan(asked)
    assert isinstance(outcome, Planned), outcome.sentence
    return asked, outcome.plan


def sealed(asked: Scene, made: Plan) -> Plan:
    c = made.certificate
    fresh = digest(asked.digest, made.trajectory, made.legs, made.arrivals, c)
    return replace(made, certificate=replace(c, digest=fresh))


def codes(asked: Scene, made: Plan) -> set[Code]:
    verdict = check(asked, sealed(asked, made))
    assert verdict.ok == (not verdict.findings)
    return {finding.code for finding in verdict.findings}


def with_arrival(made: Plan, number: int, **changes: Any) -> Plan:
    arrivals = list(made.arrivals)
    arrivals[number] = replace(arrivals[number], **changes)
    return replace(made, arrivals=tuple(arrivals))


def with_missed(made: Plan, number: int, **changes: Any) -> Plan:
    missed = made.arrivals[number].missed_by
    assert missed is not None
    return with_arrival(made, number, missed_by=replace(missed, **changes))


def test_the_right_plan_is_right_and_has_the_form_that_it_should() -> None:
    asked, made = right()
    assert codes(asked, made) == set()
    assert made.trajectory.jumps
    assert (np.diff(made.trajectory.time) == 0).sum() >= 7
    assert [arrival.missed_by is not None for arrival in made.arrivals] == [True, True, False, False]
    assert made.certificate.covers == COVERS[:-1]


@pytest.mark.parametrize("number", [0, 1])
@pytest.mark.parametrize("joint", [0, 1, 2, 3])
def test_a_joint_that_is_said_to_miss_by_another_amount_is_found(number: int, joint: int) -> None:
    asked, made = right()
    missed = made.arrivals[number].missed_by
    assert missed is not None
    for by in (2e-9, -1e-3, 10.0, np.float64(1e300)):
        joints = list(missed.joints)
        joints[joint] += float(by)
        # a pose that is missed by so much may be one of another working mode
        assert codes(asked, with_missed(made, number, joints=tuple(joints))) - {Code.ELBOW} == {Code.BLEND}


def test_a_distance_by_which_the_tool_does_not_miss_is_found() -> None:
    asked, made = right()
    missed = made.arrivals[0].missed_by
    assert missed is not None
    assert missed.distance_m > 1e-3
    for distance in (0.0, missed.distance_m + 2e-6):
        assert codes(asked, with_missed(made, 0, distance_m=distance)) - {Code.POINT} == {Code.BLEND}
    assert codes(asked, with_missed(made, 0, distance_m=-missed.distance_m)) == {Code.FORM}


def test_a_miss_that_is_not_told_or_told_of_a_stop_is_found() -> None:
    asked, made = right()
    assert codes(asked, with_arrival(made, 1, missed_by=None)) == {Code.BLEND, Code.POINT}
    assert codes(asked, with_arrival(made, 2, missed_by=Missed((0.0, 0.0, 0.0, 0.0), 0.0))) == {Code.BLEND}


def test_a_miss_that_is_none_is_refused_for_its_form() -> None:
    asked, made = right()
    for missed in (3.0, "much"):
        with pytest.raises(InputError):
            with_arrival(made, 0, missed_by=missed)
    for joints, off in (((0.0, 0.0, 0.0, np.nan), 0.0), ((0.0,) * 4, np.inf), ([0.0] * 4, 0.0)):
        with pytest.raises(InputError):
            Missed(joints, off)  # type: ignore[arg-type]
    verdict = check(asked, with_arrival(made, 0, missed_by=Missed((0.0, 0.0), 0.0)))
    assert {finding.code for finding in verdict.findings} == {Code.FORM}


def test_a_via_that_is_not_what_is_blended_past_is_found_from_two_micrometres_on() -> None:
    asked, made = right()
    for off, wrong in ((2e-6, True), (0.2e-6, False)):
        step: Any = asked.task[0]
        pose = replace(step.target.pose, x=step.target.pose.x + off)
        moved = replace(asked, task=(replace(step, target=replace(step.target, pose=pose)), *asked.task[1:]))
        assert (Code.BLEND in codes(moved, made)) == wrong
    turned: Any = asked.task[0]
    pose = replace(turned.target.pose, yaw=turned.target.pose.yaw + 2e-6)
    moved = replace(asked, task=(replace(turned, target=Target("world", pose)), *asked.task[1:]))
    assert Code.BLEND in codes(moved, made)


def test_a_via_that_is_due_beside_the_middle_of_its_blend_is_found() -> None:
    asked, made = right()
    arrival, legs = made.arrivals[0], list(made.legs)
    first = next(i for i, leg in enumerate(legs) if leg.t1 == arrival.time)
    late = arrival.time + 1e-3
    legs[first], legs[first + 1] = replace(legs[first], t1=late), replace(legs[first + 1], t0=late)
    forged = replace(with_arrival(made, 0, time=late, until=late), legs=tuple(legs))
    assert Code.BLEND in codes(asked, forged)


def test_another_acceleration_time_than_the_one_that_is_asked_is_found() -> None:
    _, made = right()
    for asked, wrong in ((scene(acceleration_time_s=TIME_S + 1e-6), True), (scene(acceleration_time_s=None), False)):
        assert (Code.BLEND in codes(asked, made)) == wrong


def test_a_piece_that_is_no_parabola_is_found() -> None:
    """A smooth knot in the middle of a blend, whose place is a little beside the parabola."""
    asked, made = right()
    path = made.trajectory
    t = float((path.edges[0] + path.edges[1]) / 2)
    k = int(path.time.searchsorted(t))
    q, qd, qdd = path.state(t)
    for beside, wrong in ((1e-6, True), (0.0, False)):
        columns = [
            np.insert(getattr(path, name), k, value, axis=0)
            for name, value in (("time", t), ("q", q + beside), ("qd", qd), ("qdd", qdd))
        ]
        bent = Trajectory(columns[0], columns[1], columns[2], columns[3], jumps=True)
        # a knot more in a blend also makes two pieces of it that do not last the acceleration time
        free = replace(asked, options=replace(asked.options, acceleration_time_s=None))
        assert (Code.BLEND in codes(free, replace(made, trajectory=bent))) == wrong


def formless(made: Plan, **columns: Any) -> None:
    """Knots that are no trajectory with jumps."""
    with pytest.raises(InputError):
        changed_path(made.trajectory, **columns)


def test_a_jump_of_place_or_velocity_and_a_third_knot_are_refused_for_their_form() -> None:
    _, made = right()
    path = made.trajectory
    for name in ("q", "qd"):
        states = getattr(path, name).copy()
        states[3] += 1e-12
        formless(made, **{name: states})
    third = {name: np.insert(getattr(path, name), 3, getattr(path, name)[3], axis=0) for name in ("q", "qd", "qdd")}
    formless(made, time=np.insert(path.time, 3, path.time[3]), **third)
    formless(made, time=path.time[::-1].copy())
    formless(made, time=np.zeros_like(path.time))


@pytest.mark.parametrize("jumps", [False, None, 1, "yes"])
def test_a_plan_that_does_not_say_that_it_jumps_is_refused(jumps: Any) -> None:
    asked, made = right()
    if not jumps:
        formless(made, jumps=jumps)
        return
    verdict = check(asked, replace(made, trajectory=changed_path(made.trajectory, jumps=jumps)))
    assert {finding.code for finding in verdict.findings} == {Code.FORM}


def test_a_jerk_limited_request_takes_no_doubled_knots_however_they_are_said() -> None:
    """The blended plan, and a smooth one with two knots at one time."""
    _, made = right()
    smooth = scene(timing="jerk_limited", acceleration_time_s=None)
    assert Code.FORM in codes(smooth, made)
    full = replace(made, certificate=replace(made.certificate, covers=COVERS))
    assert {finding.code for finding in check(smooth, full).findings} == {Code.FORM}
    formless(made, jumps=False)
    outcome = plan(replace(smooth, options=replace(smooth.options, stop="first")))
    assert isinstance(outcome, Planned)
    good, path = outcome.plan, outcome.plan.trajectory
    assert codes(smooth, good) == set()
    k = len(path.time) // 2
    twice = {name: np.insert(getattr(path, name), k, getattr(path, name)[k], axis=0) for name in ("q", "qd", "qdd")}
    twice["qdd"][k] += 1.0
    formless(good, time=np.insert(path.time, k, path.time[k]), **twice)
    jumping = changed_path(path, time=np.insert(path.time, k, path.time[k]), jumps=True, **twice)
    verdict = check(smooth, replace(good, trajectory=jumping))
    assert {finding.code for finding in verdict.findings} == {Code.FORM}


def test_a_jerk_limited_plan_may_miss_nothing_whatever_it_says() -> None:
    smooth = scene(timing="jerk_limited", acceleration_time_s=None)
    outcome = plan(smooth)
    assert isinstance(outcome, Planned)
    missed = Missed((0.0,) * 4, 0.0)
    assert codes(smooth, with_arrival(outcome.plan, 0, missed_by=missed)) == {Code.BLEND}


@pytest.mark.parametrize("covers", [COVERS, COVERS[:-2], ("jerk",), (), None, list(COVERS[:-1])])
def test_a_certificate_that_says_it_covers_another_thing_is_refused(covers: Any) -> None:
    asked, made = right()
    if not isinstance(covers, tuple):
        with pytest.raises(InputError):
            replace(made.certificate, covers=covers)
        return
    wrong = replace(made, certificate=replace(made.certificate, covers=covers))
    assert {finding.code for finding in check(asked, wrong).findings} == {Code.FORM}


@pytest.mark.parametrize(("kind", "order"), [("velocity", 1), ("acceleration", 2)])
def test_velocity_and_acceleration_are_looked_at_and_the_jerk_is_not(kind: str, order: int) -> None:
    asked, made = right()
    low, high = made.trajectory.extrema(order)
    peak = np.maximum(np.abs(low), np.abs(high))
    for share, broken in ((1 - 1e-6, True), (1 + 1e-6, False)):
        limits = replace(asked.robot.limits, **{kind: peak * share, "jerk": asked.robot.limits.jerk * 1e-6})
        robot: Any = asked.robot
        found = codes(replace(asked, robot=replace(robot, limits=limits)), made)
        assert found == ({Code.LIMIT} if broken else set())


def test_a_stop_is_met_exactly_and_its_miss_would_be_found() -> None:
    asked, made = right()
    step: Any = asked.task[2]
    assert isinstance(step, Move)
    pose = replace(step.target.pose, y=step.target.pose.y + 2e-6)
    task = (*asked.task[:2], replace(step, target=replace(step.target, pose=pose)), asked.task[3])
    assert Code.POINT in codes(replace(asked, task=task), made)
    arrival: Arrival = made.arrivals[2]
    q = made.trajectory.evaluate(arrival.time)
    place, _ = asked.robot.forward(q)
    assert np.abs(place - step.target.pose.position).max() <= 1e-12
    assert not made.trajectory.evaluate(arrival.time, 1).any()
