"""What every shipped cell promises: the answer that its file expects, and a plan that the checker accepts and that
keeps what it says by the means of the oracle, whose kinematics, laws and distances are its own."""

from __future__ import annotations

import copy
import json

import pytest

from assur.scenes.requests import check_document, plan_scenario
from assur.scenes.scenario import Scenario, with_files
from assur.scenes.scenarios import shipped, shipped_scenarios, unmet
from benchmarks.judge.product import as_si
from benchmarks.judge.promises import broken_promises
from tests.changed import changed
from tests.scenes.cells.answers import Document, answer

TWICE = ("standard-cycle", "rv-m1")
"""Cells that are planned a second time."""
PLANNED = [name for name in shipped_scenarios() if shipped(name).expect["status"] == "planned"]
BLENDED = "parabolic-blend"
"""The oracle does not know parabolic blends."""


def of_files(scenario: Scenario) -> Document:
    """The request of a scenario in SI, with what files hold in it."""
    return as_si(with_files(scenario.request, scenario.folder))


@pytest.mark.parametrize("name", shipped_scenarios())
def test_a_cell_is_answered_as_its_file_expects_and_its_plan_is_accepted_as_it_is_written_out(name: str) -> None:
    scenario = shipped(name)
    assert unmet(scenario.expect, answer(name)) == []
    assert not answer(name)["cut_by_clock"]
    if answer(name)["status"] == "planned":
        written = json.loads(json.dumps(answer(name), allow_nan=False))
        verdict = check_document(scenario.request, written, folder=scenario.folder)
        assert (verdict["ok"], verdict["findings"]) == (True, [])


@pytest.mark.parametrize("name", sorted({*PLANNED} - {BLENDED}))
def test_a_plan_keeps_what_it_promises_by_other_means(name: str) -> None:
    assert broken_promises(of_files(shipped(name)), answer(name)) == []


@pytest.mark.parametrize("name", ["belt-to-belt", "elbow-arm", "rv-m1", "two-robots-late"])
def test_a_plan_that_is_a_millisecond_late_or_nearer_by_a_millimetre_breaks_its_promise(name: str) -> None:
    request, late = of_files(shipped(name)), copy.deepcopy(answer(name))
    late["trajectory"]["time_s"] = [t + 1e-3 for t in late["trajectory"]["time_s"]]
    assert broken_promises(request, late)
    more = answer(name)["margins"]["nearest"]["gap_m"] + 1e-3
    assert broken_promises(changed(request, {"options.clearance_m": {"travel": more, "near": more}}), answer(name))


@pytest.mark.parametrize("name", TWICE)
def test_a_plan_that_a_count_ends_is_the_same_every_time(name: str) -> None:
    again = plan_scenario(shipped(name), certificate="digest")
    assert again["trajectory"] == answer(name)["trajectory"]
    assert again["certificate"]["digest"] == answer(name)["certificate"]["digest"]
