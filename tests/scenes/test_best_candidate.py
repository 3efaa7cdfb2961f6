"""The candidate that a refusal shows: it moves from the start, and meets the two bodies at the instant that it says."""

from __future__ import annotations

import copy
import json
from itertools import pairwise

import numpy as np
import pytest

from assur.planner.model.phases import phases
from assur.scenes.reading.plan import motion_of
from assur.scenes.requests import plan_document
from assur.scenes.scenarios import shipped
from assur.scenes.view.distances import distances
from tests.scenes.cells.answers import answer
from tests.scenes.view.shown import cell, scene, view

MEETING = ("shut-gate", "two-robots-parked", "dense-flow-uncertain")
PROVED = ("heavy-casting-refused", "long-bar")


@pytest.mark.parametrize("name", MEETING)
def test_two_bodies_are_as_near_as_it_says_when_it_says(name: str) -> None:
    best = answer(name)["best_candidate"]
    trajectory, legs, arrivals = motion_of(best, cell(name).conventions)
    pairs = distances(scene(name), trajectory, phases(scene(name), legs, arrivals), (best["at_s"],))
    assert trajectory.start == scene(name).start.time
    assert (trajectory.q[0] == scene(name).start.q).all()
    assert legs[0].t0 == trajectory.start
    assert legs[-1].t1 == trajectory.end
    assert all(one.t1 == other.t0 for one, other in pairwise(legs))
    nearest = min(each.gap_m for each in pairs if each.time == best["at_s"])
    assert best["gap_m"] < best["required_m"]
    # the pair is the nearest, or, overlapping, as near as anything; gaps along a normal may be less than the distance
    assert nearest <= max(best["gap_m"], 0.0) + 1e-4


def test_it_ends_where_the_search_came_no_further() -> None:
    best = answer("two-robots-parked")["best_candidate"]
    assert {leg["step"] for leg in best["legs"]} == {0, 1}
    assert [arrival["step"] for arrival in best["arrivals"]] == [0]
    assert answer("two-robots-parked")["refusal"]["step"] == 1


@pytest.mark.parametrize("name", PROVED)
def test_what_was_proved_before_the_search_has_none(name: str) -> None:
    assert answer(name)["best_candidate"] is None
    assert answer(name)["census"]["candidates"] == 0


def test_the_same_request_has_the_same_candidate() -> None:
    again = json.loads(json.dumps(plan_document(shipped("shut-gate").request)))
    assert again["best_candidate"] == json.loads(json.dumps(answer("shut-gate")["best_candidate"]))


def test_blends_have_one_too() -> None:
    request = copy.deepcopy(shipped("parabolic-blend").request)
    request["options"] |= {"max_candidates": 2, "elbow": "keep"}
    refused = plan_document(request)
    assert refused["status"] == "not_planned"
    assert refused["best_candidate"]["trajectory"]["acceleration_jumps"] is True


def test_a_view_of_it_says_that_it_is_no_plan() -> None:
    shown, best = view("shut-gate"), answer("shut-gate")["best_candidate"]
    assert (shown["status"], shown["candidate"], shown["moves"]) == ("not_planned", True, True)
    assert shown["refusal"]["met"] == best["bodies"]
    assert shown["refusal"]["at_s"] == pytest.approx(best["at_s"] - shown["start_s"])
    assert np.isfinite(shown["lasts_s"])
