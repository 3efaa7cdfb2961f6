"""Campaigns over random requests: a short form of ``make soak``, and what they count and keep."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from assur.scenes import load
from benchmarks.judge.campaigns import (
    CAMPAIGNS,
    ELBOW,
    SOAK,
    Campaign,
    RunningCampaign,
    ShiftTally,
    Tally,
    run,
    written,
)
from benchmarks.judge.product import BAD_INPUT, planned
from benchmarks.random_requests.random_cells import random_cell

SHIFTS = CAMPAIGNS["shifts"]


@pytest.mark.parametrize("campaign", CAMPAIGNS.values(), ids=CAMPAIGNS)
def test_kinds_and_seeds_make_the_same_request_again(campaign: Campaign) -> None:
    for kind in campaign.kinds:
        assert json.dumps(campaign.make(kind, 7)) == json.dumps(campaign.make(kind, 7))
        assert json.dumps(campaign.make(kind, 7)) != json.dumps(campaign.make(kind, 8))


def ran(name: str, count: int, out: Path) -> tuple[dict[str, Tally], Tally]:
    """The tallies of a campaign by kind, and of all kinds together; it found no fault."""
    going = RunningCampaign(name, 4)
    run([going], out, count)
    assert set(going.found) == set(CAMPAIGNS[name].kinds)
    assert going.total.evaluated == going.done == count
    assert going.total.clean, [file.read_text() for file in out.glob("*.faults.json")]
    return going.found, going.total


def test_twenty_plans_keep_what_they_promise_when_shifted(tmp_path: Path) -> None:
    _, total = ran("shifts", 20, tmp_path)
    assert isinstance(total, ShiftTally)
    assert not list(tmp_path.iterdir())
    assert (total.runs, total.collisions) == (400, 0)
    assert total.deepest_m <= total.deepest_allowed_m
    assert len(total.ratios) >= 20
    assert min(total.ratios) >= 1.0 - 1e-6
    assert total.median is not None
    assert total.median <= 1.3


def test_sixty_plans_keep_what_they_promise(tmp_path: Path) -> None:
    _, total = ran("plans", 60, tmp_path)
    assert total.by_checker == 60 + sum(
        count for name, count in total.refused.items() if not name.startswith(BAD_INPUT)
    )


def test_proved_refusals_are_contradicted_by_nothing(tmp_path: Path) -> None:
    found, _ = ran("refusals", 300, tmp_path)
    assert all(tally.evaluated for tally in found.values())


def test_a_cell_whose_arm_cannot_stand_with_its_elbow_there_is_counted_as_refused(tmp_path: Path) -> None:
    kind, seed, tally = "table to table", 211, ShiftTally()  # a right elbow, with which j1 would be beyond its range
    request = random_cell(kind, seed)
    assert not SHIFTS.evaluate(tally, kind, seed, request, tmp_path)
    assert (tally.evaluated, tally.runs, dict(tally.refused)) == (0, 0, {f"{BAD_INPUT} {ELBOW}": 1})
    assert not list(tmp_path.iterdir())
    assert tally.clean  # no plan was run, so none broke a promise
    request["start"]["elbow"] = "left"  # the other side is within the ranges
    assert SHIFTS.evaluate(tally, kind, seed, request, tmp_path) or len(tally.refused) == 2


def test_any_other_fault_of_a_cell_is_raised() -> None:
    request = random_cell("table to table", 211)
    request["robot"]["model"] = "no-robot"
    with pytest.raises(ValueError, match=r"robot\.model"):
        SHIFTS.evaluate(ShiftTally(), "table to table", 211, request)


def test_campaigns_run_in_turn_until_each_has_its_count() -> None:
    going = [RunningCampaign(name, 1) for name in SOAK]
    calls: list[int] = []
    run(going, None, count=2, after_each=lambda: calls.append(1))
    assert [each.done for each in going] == [2, 2, 2]
    assert all(each.over for each in going)
    assert len(calls) >= 6


def test_a_campaign_without_time_evaluates_nothing() -> None:
    going = [RunningCampaign("plans", 1)]
    run(going, None, seconds=-1.0)
    assert going[0].done == 0


def test_a_case_that_fails_is_written_as_a_scenario(tmp_path: Path) -> None:
    kind = "belt to table"
    seed, request, answer = next(
        (seed, request, answer)
        for seed in range(20)
        for request in [random_cell(kind, seed)]
        for answer, _ in [planned(request)]
        if answer is not None and answer["status"] == "planned"
    )
    request["frames"]["source"].setdefault("uncertainty", {})["position_m"] = 0.05
    reason, faults = SHIFTS.judge(ShiftTally(), request, answer, 0)
    assert reason is None
    assert "error" in {each["kind"] for each in faults}
    file = written(tmp_path, kind, seed, request, answer, faults, [])
    assert load(file) == json.loads(json.dumps(request))
    document = json.loads(file.with_suffix(".faults.json").read_text())
    assert (document["kind"], document["seed"], document["status"]) == (kind, seed, "planned")
    assert abs(document["faults"][0]["realised"]["frames"]["source"]["along"]) <= 1.0
