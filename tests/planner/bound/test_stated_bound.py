"""A stated lower bound of the duration is accepted up to the one that is computed again, and no further."""

from __future__ import annotations

import math

import pytest

from assur.planner.bound.duration import RESERVE, WINDOW_M, WINDOW_S, least_duration
from assur.planner.checker.statement.differences import MEET, SAME
from assur.planner.checker.verdict import Code
from assur.planner.model.outcome import Planned
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from assur.scenes.reading.claims import untrue_bound
from tests.planner.cells import belt_and_dial, cell, go, table_to_table

CELLS = {"table": table_to_table, "belt": belt_and_dial, "move": lambda: cell(go(0.35, -0.2))}


def least(scene: Scene) -> float:
    """The bound of a cell that has one."""
    found = least_duration(scene)
    assert found is not None
    return found


@pytest.mark.parametrize("name", sorted(CELLS))
def test_what_is_computed_again_is_accepted_and_so_is_less(name: str) -> None:
    scene = CELLS[name]()
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    lasts = outcome.plan.trajectory.duration
    for claimed in (outcome.lower_bound_s, least(scene), 0.5 * least(scene), 1e-9, None):
        assert untrue_bound(claimed, scene, lasts) == ()


@pytest.mark.parametrize("name", sorted(CELLS))
def test_more_than_is_computed_again_is_refused(name: str) -> None:
    scene = CELLS[name]()
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    lasts = outcome.plan.trajectory.duration
    known = least(scene)
    more = known * (1.0 + 2.0 * RESERVE)
    assert more < lasts
    for claimed in (more, 0.5 * (known + lasts), lasts, lasts + 1e-6, 1e9, math.inf, math.nan, 0.0, -1.0):
        (finding,) = untrue_bound(claimed, scene, lasts)
        assert (finding.code, finding.where) == (Code.CLAIM, "lower_bound_s")
        assert not finding.amount <= 0.0


def test_nothing_is_known_of_a_task_whose_point_the_arm_is_at_already() -> None:
    scene = cell(go(0.35, -0.2))
    place, yaw = scene.robot.forward(scene.start.q)
    here = cell(go(float(place[0]), float(place[1]), float(place[2]), float(yaw)))
    assert least_duration(here) is None
    (finding,) = untrue_bound(0.1, here, 1.0)
    assert "no bound is known" in finding.what


def test_a_bound_above_the_plan_is_refused_even_if_it_is_the_computed_one() -> None:
    scene = cell(go(0.35, -0.2))
    (finding,) = untrue_bound(least(scene), scene, 0.5 * least(scene))
    assert finding.amount == pytest.approx(0.5 * least(scene))


def test_no_window_of_the_bound_is_narrower_than_that_of_a_check() -> None:
    assert WINDOW_S >= SAME
    assert WINDOW_M >= MEET
