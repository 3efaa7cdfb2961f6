"""A change that a refusal proposes is stated as values by their paths, which make the scene that was tried."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import assur
from assur.api.cli.console_report import CHANGED
from assur.planner.model.options import Clearance
from assur.planner.model.scene import Move
from assur.planner.relaxation.changes import changes, with_step
from assur.scenes.proposals.values import si_number, values_of, written_number
from assur.scenes.requests import cell_of
from assur.scenes.schema.normal import normal
from assur.scenes.set_values import with_values
from tests.planner.test_relaxation import CASES, two_posts
from tests.scenes.proposals.written import request_of


@pytest.mark.parametrize("name", sorted(CASES))
def test_the_request_with_the_values_is_planned(name: str) -> None:
    make, what, value = CASES[name]
    request = request_of(make())
    answer: Any = assur.plan(request)
    assert not answer.planned
    found = answer["relaxation"]
    assert found["what"] == what
    assert found["value"].startswith(value)
    if what == "without":
        assert found["set"] is None
        return
    assert found["set"] is not None
    changed = with_values(request, found["set"])
    changed["options"]["stop"] = "first"
    relaxed: Any = assur.plan(changed)
    assert relaxed.planned
    assert relaxed.duration_s == pytest.approx(found["duration_s"], abs=0.5)


@pytest.mark.parametrize("in_si", [False, True])
def test_each_change_that_is_tried_is_stated_in_the_units_of_the_request(in_si: bool) -> None:
    kinds = set[str]()
    for make, _, _ in CASES.values():
        request = request_of(make())
        cell = cell_of(normal(request) if in_si else request)
        for number in range(len(cell.scene.task)):
            for what, value, tried in changes(cell.scene, number, None):
                found = values_of(cell, tried)
                assert found is not None, (what, value)
                assert not in_si or not any(unit in str(found) for unit in ("_mm", "_deg", "_ms", "'mm'")), found
                kinds.add(what)
    assert len(kinds) == len(CHANGED) - 6  # without a body, and five that a refusal has to ask for


def test_what_the_request_does_not_state_is_added() -> None:
    request = request_of(two_posts())
    for key in ("budget_s", "elbow", "clearance_mm", "singularity_margin"):
        del request["options"][key]
    cell = cell_of(request)
    options = replace(
        cell.scene.options, budget_s=4.0, elbow="auto", clearance=Clearance(0.002, 0.001), singularity_margin=0.0
    )
    assert values_of(cell, replace(cell.scene, options=options)) == {
        "options.budget_s": 4,
        "options.clearance_mm": {"travel": 2, "near": 1},
        "options.elbow": "auto",
        "options.singularity_margin": 0,
    }


def test_no_values_are_stated_for_a_scene_that_they_do_not_make() -> None:
    cell = cell_of(request_of(two_posts()))
    scene, step = cell.scene, cell.scene.task[0]
    assert isinstance(step, Move)
    aside = replace(step, target=replace(step.target, pose=replace(step.target.pose, x=0.3)))
    later = replace(scene, start=replace(scene.start, time=1.0))
    for tried in (with_step(scene, 0, aside), later, replace(scene, bodies=scene.bodies[:1])):
        assert values_of(cell, tried) is None
    assert values_of(cell, scene) == {}


def test_numbers_are_short_and_exact() -> None:
    assert [written_number(value, "at_mm") for value in (0.0123, 0.1 + 0.2, 1e-7)] == [12.3, 300, 0.0001]
    for value in np.random.default_rng(0).uniform(-3.0, 3.0, 200):
        for key in ("at_mm", "at_m", "yaw_deg", "yaw_rad"):
            assert abs(si_number(written_number(value, key), key) - value) <= 1e-12


def test_python_takes_the_values() -> None:
    request = request_of(two_posts())
    answer: Any = assur.plan(request)
    relaxed = assur.plan(request, set=answer["relaxation"]["set"])
    assert relaxed.planned
    assert relaxed.request == with_values(request, answer["relaxation"]["set"])
    with pytest.raises(assur.InputError, match="set"):
        assur.plan(request, set=[])  # type: ignore[arg-type]
