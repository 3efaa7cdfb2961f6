"""Hard requests in a short form: which disagreements of planner and checker are left, and how they are counted."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from assur.planner.model.refusal import Obstacle
from assur.scenes.requests import check_document, plan_document, validate
from benchmarks.checker_refusals import Document, codes_of
from benchmarks.judge.campaigns import CAMPAIGNS, Tally
from benchmarks.judge.product import BAD_INPUT
from benchmarks.random_requests.hard import HARD, hard_request, later
from benchmarks.random_requests.impossible import random_request
from benchmarks.random_requests.kinds import random_cell

EACH = 7
"""Requests of each kind: 63 of all kinds."""


def test_a_kind_and_a_seed_make_one_request_which_is_in_si() -> None:
    for kind in HARD:
        first, again, other = (json.dumps(hard_request(kind, seed), sort_keys=True) for seed in (0, 0, 1))
        assert first == again != other
        assert validate(json.loads(first)).schema_ == "assur/1"


@pytest.mark.parametrize("kind", HARD)
def test_each_answer_is_planned_and_checked_or_refused_for_a_reason(kind: str) -> None:
    """The checker refuses no plan of these requests."""
    tally = Tally()
    for seed in range(EACH):
        CAMPAIGNS["hard"].evaluate(tally, kind, seed, hard_request(kind, seed))
    assert tally.clean, tally.codes
    assert tally.evaluated + tally.refused.total() == tally.by_checker == EACH
    assert tally.evaluated > 0


@pytest.mark.parametrize(("kind", "seed"), [("tiny limits", 27), ("tiny limits", 264), ("tiny limits", 1293)])
def test_an_arch_whose_lift_reaches_its_acceleration_in_microseconds_rises(kind: str, seed: int) -> None:
    assert codes_and_status(hard_request(kind, seed)) == ([], "planned")


@pytest.mark.parametrize("seed", [196, 954, 77000223])
def test_a_peak_of_the_jerk_in_a_short_piece_is_shown(seed: int) -> None:
    assert codes_and_status(hard_request("tiny limits", seed)) == ([], "planned")


def test_a_pair_is_stated_where_points_of_its_simplex_are_almost_on_one_line() -> None:
    """A step of that search went away from the origin by rounding, and its points were those of the row."""
    assert codes_and_status(hard_request("mesh round the arm", 77000544)) == ([], "planned")


def test_the_top_of_an_arch_is_as_high_as_is_required_where_switches_share_knots() -> None:
    assert codes_and_status(random_request("arch", 1262)) == ([], "planned")


def test_an_arch_to_a_lift_that_rises_as_it_arrives_is_one() -> None:
    """The lift is a millimetre below the end before it rises; each piece of the motion was stated to sink all along."""
    assert codes_and_status(hard_request("moves flown by", 213)) == ([], "planned")


def test_a_motion_that_goes_down_before_its_top_is_no_arch() -> None:
    request = random_cell("start in motion, five-bar", 23)
    assert codes_and_status(request) == ([], "planned")
    lines = plan_document(request)["census"]["lines"]
    assert Obstacle.NO_ARCH in [line["facts"].get("obstacle") for line in lines]


def codes_and_status(request: Document) -> tuple[list[str], str]:
    """The codes with which the checker refuses plans of a request, and what becomes of it."""
    answer = plan_document(request, certificate="full")
    return codes_of(answer, check_document(request, answer)["findings"]), answer["status"]


def test_an_error_without_a_bound_is_no_number_of_an_answer() -> None:
    """Lag takes the best candidate of this request to where its arm cannot be."""
    answer = plan_document(hard_request("much lag", 571))
    assert answer["status"] == "not_planned"
    assert answer["best_candidate"]["arrivals"][0]["error"] is None


def test_all_instants_of_a_document_are_later_and_no_durations() -> None:
    document = {"at_s": 1.0, "window_s": [1.0, 2.0], "dwell_s": 3.0, "points": [{"time_s": 4.0}], "budget_s": 5.0}
    moved = {"at_s": 101.0, "window_s": [101.0, 102.0], "dwell_s": 3.0, "points": [{"time_s": 104.0}], "budget_s": 5.0}
    assert later(document, 100.0) == moved


def test_an_error_of_the_product_is_a_fault_and_kept(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def fails(*_: object, **__: object) -> None:
        raise ZeroDivisionError("0/0")

    monkeypatch.setattr("benchmarks.judge.product.plan_document", fails)
    tally = Tally()
    assert not CAMPAIGNS["hard"].evaluate(tally, "no yaw", 0, hard_request("no yaw", 0), tmp_path)
    assert (dict(tally.faults), tally.clean) == ({"ZeroDivisionError": 1}, False)
    assert "0/0" in (tmp_path / "no-yaw-0.faults.json").read_text(encoding="utf-8")


def test_a_request_that_is_bad_input_is_counted_by_its_field() -> None:
    tally = Tally()
    CAMPAIGNS["hard"].evaluate(tally, "no yaw", 0, {**hard_request("no yaw", 0), "task": []})
    assert dict(tally.refused) == {f"{BAD_INPUT} task": 1}
