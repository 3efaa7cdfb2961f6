"""No plan of a random cell is shorter than the bound that is proved for the cell."""

from __future__ import annotations

from dataclasses import replace

import pytest

from assur.planner.bound.duration import least_duration
from assur.planner.model.outcome import Planned
from assur.planner.pipeline import plan
from assur.scenes.requests import scene_of
from benchmarks.random_requests.random_cells import KINDS, random_cell


@pytest.mark.parametrize("kind", KINDS)
def test_no_plan_of_a_random_cell_is_shorter_than_its_bound(kind: str) -> None:
    planned = 0
    for seed in (11, 12):
        scene = scene_of(random_cell(kind, seed))
        bound = least_duration(scene)
        assert bound is not None
        for search in (1, 2):
            asked = replace(scene.options, seed=search, max_candidates=40, stop="first", budget_s=600.0)
            outcome = plan(replace(scene, options=replace(asked, explain_budget_s=0.0)))
            if isinstance(outcome, Planned):
                planned += 1
                assert outcome.lower_bound_s == bound
                assert 0.0 < bound <= outcome.plan.trajectory.duration
    assert planned > 0 or "five-bar" in kind
