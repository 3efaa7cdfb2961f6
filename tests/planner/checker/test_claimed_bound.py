"""A lower bound of the duration that an answer claims: accepted where it is proved, and refused where it is not."""

from __future__ import annotations

import math

import pytest

from assur.planner.checker.bound.duration import RESERVE, least_duration
from assur.planner.checker.claims.bound import bound
from assur.planner.checker.verdict import Code
from assur.planner.model.outcome import Planned
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from tests.planner.cells import belt_and_dial, cell, go, table_to_table

CELLS = {"table": table_to_table, "belt": belt_and_dial, "move": lambda: cell(go(0.35, -0.2))}


def proved(scene: Scene) -> float:
    """The bound of a cell that has one."""
    found = least_duration(scene)
    assert found is not None
    return found


@pytest.mark.parametrize("name", sorted(CELLS))
def test_what_is_proved_is_accepted_and_so_is_less(name: str) -> None:
    scene = CELLS[name]()
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    lasts = outcome.plan.trajectory.duration
    for claimed in (outcome.lower_bound_s, proved(scene), 0.5 * proved(scene), 0.0, -1.0, None):
        assert bound(scene, lasts, claimed) == []


@pytest.mark.parametrize("name", sorted(CELLS))
def test_what_is_not_proved_is_refused(name: str) -> None:
    scene = CELLS[name]()
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    lasts = outcome.plan.trajectory.duration
    least = proved(scene)
    more = least * (1.0 + 2.0 * RESERVE)
    assert more < lasts
    for claimed in (more, 0.5 * (least + lasts), lasts, lasts + 1e-6, 1e9, math.inf, math.nan):
        (finding,) = bound(scene, lasts, claimed)
        assert (finding.code, finding.where) == (Code.CLAIM, "lower_bound_s")
        assert not finding.amount <= 0.0


def test_nothing_is_known_of_a_task_whose_point_the_arm_is_at_already() -> None:
    scene = cell(go(0.35, -0.2))
    place, yaw = scene.robot.forward(scene.start.q)
    here = cell(go(float(place[0]), float(place[1]), float(place[2]), float(yaw)))
    assert least_duration(here) is None
    (finding,) = bound(here, 1.0, 0.1)
    assert "no bound can be proved" in finding.what


def test_a_bound_above_the_plan_is_refused_even_if_it_could_be_proved() -> None:
    scene = cell(go(0.35, -0.2))
    (finding,) = bound(scene, 0.5 * proved(scene), proved(scene))
    assert finding.amount == pytest.approx(0.5 * proved(scene))
