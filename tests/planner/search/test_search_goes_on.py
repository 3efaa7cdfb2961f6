"""The coarse score alone ends no search: where nothing seems worth a try to it, one candidate is tried all the same."""

from __future__ import annotations

from typing import Any

import pytest

from assur.planner.geometry.shapes import box
from assur.planner.model.outcome import NotPlanned, Planned
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from tests.planner.cells import arm, cell, go, stands

TOP = float(arm().limits.upper[2])


def level(**options: Any) -> Scene:
    """From the top of the lift to the top of the lift, so that no arch is higher than the ends."""
    return cell(go(0.35, -0.2, TOP), q=(0.9, -1.2, TOP, 0.0), budget_s=60.0, explain_budget_s=0.0, **options)


@pytest.mark.parametrize("limit", [40, 75])
def test_after_the_quickest_way_the_search_goes_on_until_its_count_is_reached(limit: int) -> None:
    outcome = plan(level(stop="budget", max_candidates=limit))
    assert isinstance(outcome, Planned)
    assert outcome.census.candidates == limit
    assert not outcome.cut_by_clock


def test_what_never_seems_to_come_in_time_is_tried_until_the_count_is_reached() -> None:
    outcome = plan(level(stop="first", max_candidates=40, latest_end_s=0.05))
    assert isinstance(outcome, NotPlanned)
    assert outcome.census.candidates == 40
    assert "latest_end_s" in outcome.sentence


def test_the_count_is_reached_behind_a_wall_too() -> None:
    wall = stands("wall", box(2.0, 0.02, 1.0), 1.1, -0.1, 0.3)
    scene = cell(go(0.3, -0.4, TOP), bodies=(wall,), q=(1.2, 0.4, TOP, 0.0), max_candidates=60, budget_s=60.0)
    assert plan(scene).census.candidates == 60
