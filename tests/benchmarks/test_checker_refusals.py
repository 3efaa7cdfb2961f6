"""A plan that the checker refuses is a failure of every campaign, and its request is kept."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from assur.planner.checker import Code, Finding, Verdict
from assur.planner.search import census
from assur.scenes import load
from assur.scenes.requests import check_document, plan_document
from benchmarks.checker_refusals import codes_of
from benchmarks.judge.campaigns import CAMPAIGNS
from benchmarks.random_requests.random_cells import random_cell
from benchmarks.run_problems import refused

Document = dict[str, Any]
KIND = "table to table"
SAID = "this plan is not to be"


def searched(seed: int) -> Document:
    """A random cell whose search ends after few candidates."""
    request = random_cell(KIND, seed)
    return {**request, "options": {**request.get("options", {}), "max_candidates": 20}}


@cache
def seed() -> int:
    """The seed of one that has a plan."""
    return next(seed for seed in range(20) if plan_document(searched(seed))["status"] == "planned")


@pytest.fixture
def request_refused(monkeypatch: pytest.MonkeyPatch) -> Document:
    """A request that has a plan, and a checker that refuses each plan of a search."""
    request, verdict = searched(seed()), Verdict.of([Finding(Code.ARRIVAL, SAID, where="1 s")])
    monkeypatch.setattr(census, "check", lambda *_, **__: verdict)
    return request


def test_the_sentence_begins_with_it_and_no_other_beginning_is_believed(request_refused: Document) -> None:
    answer = plan_document(request_refused)
    assert (answer["status"], answer["proved"]) == ("not_planned", False)
    count = sum(line["count"] for line in answer["census"]["lines"] if line["stage"] == "checker")
    what = "a plan" if count == 1 else f"{count} plans"
    first = f"A fault of the planner: the checker refused {what} of the search (ARRIVAL: {SAID}); please report it. "
    assert answer["sentence"].startswith(first)
    assert check_document(request_refused, answer)["ok"]
    for lie in (answer["sentence"].removeprefix(first), "All is well. " + answer["sentence"]):
        assert not check_document(request_refused, {**answer, "sentence": lie})["ok"]


def kept(folder: Path, request: Document) -> Document:
    """What is said beside the request that was written."""
    (file,) = [file for file in folder.glob("*.json") if not file.name.endswith(".faults.json")]
    assert load(file) == json.loads(json.dumps(request))
    told: Document = json.loads(file.with_suffix(".faults.json").read_text(encoding="utf-8"))
    return told


def test_each_campaign_counts_it_as_a_failure_and_keeps_the_request(request_refused: Document, tmp_path: Path) -> None:
    for name, campaign in CAMPAIGNS.items():
        tally = campaign.tally()
        assert not campaign.evaluate(tally, KIND, seed(), request_refused, tmp_path / name)
        assert (tally.unchecked, dict(tally.codes), tally.clean) == (1, {"ARRIVAL": 1}, False)
        assert kept(tmp_path / name, request_refused)["in_the_search"][0]["facts"]["what"] == SAID


def test_nothing_is_counted_of_a_plan_that_the_checker_accepts(tmp_path: Path) -> None:
    campaign, request = CAMPAIGNS["plans"], random_cell(KIND, seed())
    tally = campaign.tally()
    assert campaign.evaluate(tally, KIND, seed(), request, tmp_path)
    assert (tally.unchecked, tally.clean, list(tmp_path.iterdir())) == (0, True, [])


def test_a_problem_of_which_the_checker_refused_a_plan_is_a_failure() -> None:
    assert refused({"status": "planned", "checked": True, "checker_refused": 1})
    assert not refused({"status": "planned", "checked": True, "checker_refused": 0})
    assert not refused({"status": "error", "reason": "no answer"})
    assert codes_of({"census": {"lines": []}}, [{"code": "LIMIT"}]) == ["LIMIT"]
