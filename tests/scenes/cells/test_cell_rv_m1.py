"""The cell of the five-axis arm: pitch and roll that are asked, free, missed and out of reach."""

from __future__ import annotations

import math

import pytest

from assur.planner.report.number_format import amount
from assur.scenes.requests import check_document, plan_document, scene_of
from assur.scenes.scenarios import shipped
from tests.changed import GONE, changed
from tests.scenes.cells.answers import Document, answer, findings_of

NAME = "rv-m1"


def cell(changes: Document) -> Document:
    """The cell's request with changes."""
    made: Document = changed(shipped(NAME).request, changes)
    return made


def test_an_answer_for_another_pitch_than_the_request_asks_is_refused() -> None:
    to = "task[0].follow.to"
    other = cell({f"{to}.pitch_deg": GONE, f"{to}.pitch_rad": -math.pi / 2 + 1e-4})
    assert {"ARRIVAL", "JOINTS"} & findings_of(other, answer(NAME))


def blends(pitch_deg: float = -60.0) -> Document:
    """A via with a pitch and a roll that are asked, blended past on the way to another pose."""
    return {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rv-m1", "tool": {"tcp_mm": [0, 0, 0]}},
        "start": {"joints": {"j1_deg": 0, "j2_deg": 80, "j3_deg": -100, "j4_deg": -40, "j5_deg": 0}},
        "task": [
            {"move": {"to": {"at_mm": [280, 100, 250], "pitch_deg": pitch_deg, "roll_deg": 20}, "via": True}},
            {"move": {"to": {"at_mm": [250, -150, 200], "pitch_deg": -80}}},
        ],
        "options": {"timing": "parabolic_blend", "seed": 1, "max_candidates": 60, "budget_s": 60, "stop": "first"},
    }


def test_a_via_that_is_blended_past_has_its_pitch_and_roll_in_the_pose_that_is_missed() -> None:
    made = plan_document(blends())
    assert made["status"] == "planned"
    assert check_document(blends(), made)["ok"] is True
    via = made["arrivals"][0]
    assert via["pitch_rad"] == pytest.approx(math.radians(-60), abs=1e-12)
    assert via["roll_rad"] == pytest.approx(math.radians(20), abs=1e-12)
    assert via["missed_by"]["distance_m"] > 1e-3
    other = check_document(blends(-60.01), made)
    assert "ARRIVAL" in {finding["code"] for finding in other["findings"]}


def test_free_and_silent_are_one_request_and_a_number_is_another() -> None:
    to = "task[1].move.to"
    silent, both, asked = (
        scene_of(cell(changes)).digest
        for changes in ({f"{to}.pitch_deg": GONE}, {f"{to}.roll_deg": "free"}, {f"{to}.pitch_deg": -60})
    )
    assert silent == both == answer(NAME)["request_digest"] != asked


def test_a_target_too_far_away_is_refused_with_what_is_missing() -> None:
    """600 mm away and 100 mm up, against arm and hand of 482 mm."""
    far = plan_document(cell({"task": [{"move": {"name": "far", "to": {"at_mm": [600, 0, 400]}}}]}))
    assert (far["status"], far["reason"], far["proved"]) == ("not_planned", "OUT_OF_REACH", True)
    short = math.hypot(0.6, 0.1) - 0.482
    assert far["refusal"]["amount"] == pytest.approx(short, abs=1e-12)
    assert far["sentence"] == f"far: the point is {amount(short, 'm')} out of reach at every pitch of the tool."


def test_a_target_that_the_hand_reaches_only_stretched_out_is_refused_straight_down() -> None:
    at = {"at_mm": [460, 0, 300]}
    down = plan_document(cell({"task": [{"move": {"to": {**at, "pitch_deg": -90}}}]}))
    assert (down["status"], down["reason"], down["proved"]) == ("not_planned", "OUT_OF_REACH", True)
    assert "at a pitch of -90 deg" in down["sentence"]
    free = plan_document(cell({"task": [{"move": {"to": at}}], "bodies": []}))
    assert free["status"] == "planned", free


def test_every_number_that_nobody_vouches_for_is_told_with_the_plan() -> None:
    told = "\n".join(answer(NAME)["assumptions"])
    for what in ("length of link 1 250", "length of link 2 160", "length of the hand 72", "height of the shoulder 300"):
        assert f"mitsubishi-rv-m1: {what} mm, third_party: widely quoted for the Mitsubishi RV-M1, unsourced" in told
    for joint in ("j1", "j2", "j3", "j4", "j5"):
        assert f"{joint} lower end of its range" in told
        assert f"{joint} acceleration" in told
