"""Who watches a search is told how far it has come, and may end it; watching changes no answer."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest

from assur.planner.geometry.shapes import box
from assur.planner.model.deadline import Progress
from assur.planner.model.outcome import NotPlanned, Planned
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from tests.planner.cells import belt_and_dial, cell, go, stands


class EndedError(Exception):
    """Raised by whoever watches."""


def two_moves(**options: Any) -> Scene:
    return cell(go(0.35, -0.2), go(0.2, 0.3), max_candidates=60, **options)


@pytest.mark.parametrize(
    "scene", [two_moves(), two_moves(timing="parabolic_blend"), belt_and_dial(go(0.35, 0.0, 0.12))]
)
def test_a_watched_search_finds_what_an_unwatched_one_finds(scene: Scene) -> None:
    told: list[Progress] = []
    alone, watched = plan(scene), plan(scene, watch=told.append)
    assert isinstance(alone, Planned)
    assert isinstance(watched, Planned)
    assert watched.plan.certificate.digest == alone.plan.certificate.digest
    assert watched.census == alone.census
    assert told
    for before, after in pairwise(told):
        assert before.elapsed_s <= after.elapsed_s
        assert before.candidates <= after.candidates
        assert before.steps <= after.steps
    last = told[-1]
    assert last.stage == "search"
    assert last.candidates == watched.census.candidates
    assert last.steps == len(scene.task)
    assert last.duration_s == watched.plan.trajectory.end - scene.start.time
    assert last.lower_bound_s is not None
    assert last.duration_s is not None
    assert watched.lower_bound_s == last.lower_bound_s
    assert 0 < last.lower_bound_s <= last.duration_s


def test_what_a_watch_raises_ends_the_search() -> None:
    told: list[Progress] = []

    def watch(progress: Progress) -> None:
        told.append(progress)
        if len(told) == 2:
            raise EndedError

    with pytest.raises(EndedError):
        plan(two_moves(), watch=watch)
    assert len(told) == 2


def test_the_search_for_a_change_that_would_help_is_watched_too() -> None:
    wall = stands("wall", box(0.02, 2.0, 1.0), 0.45, 0.0, 0.5)
    scene = cell(go(0.35, -0.2), go(0.55, 0.0), bodies=(wall,), max_candidates=20)
    scene = replace(scene, options=replace(scene.options, explain_budget_s=30.0))
    stages: list[str] = []
    outcome = plan(scene, watch=lambda progress: stages.append(progress.stage))
    assert isinstance(outcome, NotPlanned)
    assert outcome.tried
    assert stages == sorted(stages, key=["search", "relaxation"].index)
    assert "relaxation" in stages

    def end_it(progress: Progress) -> None:
        if progress.stage == "relaxation":
            raise EndedError

    with pytest.raises(EndedError):
        plan(scene, watch=end_it)
