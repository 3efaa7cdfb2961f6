"""Plans with parabolic blends before the checker: what is no such plan by its form, and what is one to its bounds."""

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
from assur.planner.model.outcome import COVERS, Missed, Plan, Planned
from assur.planner.model.scene import Options, Scene
from assur.planner.pipeline import plan
from assur.planner.trajectory import Trajectory
from tests.planner.cells import cell, go, stands
from tests.planner.checker.hand_made import sealed
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


def codes(asked: Scene, made: Plan) -> set[Code]:
    verdict = check(asked, sealed(asked, made))
    assert verdict.ok == (not verdict.findings)
    return {finding.code for finding in verdict.findings}


def test_the_right_plan_is_right_and_has_the_form_that_it_should() -> None:
    asked, made = right()
    assert codes(asked, made) == set()
    assert made.trajectory.jumps
    assert (np.diff(made.trajectory.time) == 0).sum() >= 7
    assert [arrival.missed_by is not None for arrival in made.arrivals] == [True, True, False, False]
    assert made.certificate.covers == COVERS[:-1]


def test_a_miss_that_is_none_is_refused_for_its_form() -> None:
    asked, made = right()
    for missed in (3.0, "much"):
        with pytest.raises(InputError):
            replace(made.arrivals[0], missed_by=missed)  # type: ignore[arg-type]
    for joints, off in (((0.0, 0.0, 0.0, np.nan), 0.0), ((0.0,) * 4, np.inf), ([0.0] * 4, 0.0)):
        with pytest.raises(InputError):
            Missed(joints, off)  # type: ignore[arg-type]
    short = replace(made.arrivals[0], missed_by=Missed((0.0, 0.0), 0.0))
    verdict = check(asked, replace(made, arrivals=(short, *made.arrivals[1:])))
    assert {finding.code for finding in verdict.findings} == {Code.FORM}


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
