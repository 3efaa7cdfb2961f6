"""What every shipped cell promises: the answer that its file expects, and a plan that the checker accepts."""

from __future__ import annotations

import json

import pytest

from assur.scenes.requests import check_document, plan_scenario
from assur.scenes.scenarios import shipped, shipped_scenarios, unmet
from tests.scenes.cells.second_kinematics import answer

TWICE = ("standard-cycle", "rv-m1")
"""Cells that are planned a second time."""


@pytest.mark.parametrize("name", shipped_scenarios())
def test_a_cell_is_answered_as_its_file_expects_and_its_plan_is_accepted_as_it_is_written_out(name: str) -> None:
    scenario = shipped(name)
    assert unmet(scenario.expect, answer(name)) == []
    assert not answer(name)["cut_by_clock"]
    if answer(name)["status"] == "planned":
        written = json.loads(json.dumps(answer(name), allow_nan=False))
        verdict = check_document(scenario.request, written, folder=scenario.folder)
        assert (verdict["ok"], verdict["findings"]) == (True, [])


@pytest.mark.parametrize("name", TWICE)
def test_a_plan_that_a_count_ends_is_the_same_every_time(name: str) -> None:
    again = plan_scenario(shipped(name), certificate="digest")
    assert again["trajectory"] == answer(name)["trajectory"]
    assert again["certificate"]["digest"] == answer(name)["certificate"]["digest"]
