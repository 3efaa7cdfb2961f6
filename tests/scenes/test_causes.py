"""What a refusal says is what a person finds who looks: the cause of the best candidate, the change that helps, and one
number for one distance."""

from __future__ import annotations

import copy
import json
import math
from functools import cache
from typing import Any

import pytest

from assur.scenes.requests import check_document, load_scenario, plan_document
from tests.docs.pages import ROOT
from tests.scenes.refused_cells import cell, go, options

Document = dict[str, Any]
CUP = {"name": "cup", "shape": {"cylinder": {"radius_mm": 15, "height_mm": 100}}, "at_mm": [0, 0, -50]}
PICK = {"part": "part", "grasp_mm": [0, 0, 10], "window_mm": [-300, 250], "approach": {"mm": 30}, "dwell_ms": 80,
        "depart": {"mm": 40}, "contact_with": ["bed"]}  # fmt: skip
PLACE = {"part": "part", "to": {"at_mm": [250, -300, 66], "yaw_deg": 90}, "approach": {"mm": 60}, "dwell_ms": 60,
         "depart": {"mm": 70}, "contact_with": ["tray"]}  # fmt: skip


def lagging(tolerance_mm: float | None = None, **more: Any) -> Document:
    """A pick from a belt and a place in a tray, by an arm whose lift may lag by 0.2 mm. A post is beside the way, and a
    random detour folds the arm until it would hit itself."""
    part = {"name": "part", "shape": {"box": {"size_mm": [40, 30, 20]}}, "mass_kg": 0.3, "yaw_symmetry": 2}
    deep = {} if tolerance_mm is None else {"contact_tolerance_mm": tolerance_mm}
    return {
        "schema": "assur/1",
        "robot": {
            "model": "mitsubishi-rh-6frh5520",
            "tool": {"tcp_mm": [0, 0, -100], "mass_kg": 0.45, "bodies": [CUP]},
            "limits": {"j4_deg": [-270, 270]},
        },
        "start": {"joints": {"j1_deg": -38.7193, "j2_deg": 103.3424, "j3_mm": 220, "j4_deg": 0}},
        "frames": {
            "belt": {"conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": 200}, "uncertainty": {"position_mm": 0.5}}
        },
        "bodies": [
            {"name": "bed", "shape": {"box": {"size_mm": [1400, 300, 50]}}, "pose": {"at_mm": [0, 350, 25]}},
            {"name": "post", "shape": {"cylinder": {"radius_mm": 20, "height_mm": 250}},
             "pose": {"at_mm": [300, 150, 125]}},
            {**part, "pose": {"frame": "belt", "at_mm": [-330, 0, 10], "yaw_deg": 20}},
            {"name": "tray", "shape": {"mesh": {"asset": "tray", "unit": "mm"}},
             "pose": {"at_mm": [250, -300, 80], "yaw_deg": 90}},
        ],
        "task": [
            {"pick": {**PICK, **deep}},
            {"place": {**PLACE, **deep}},
            {"move": {"to": {"at_mm": [350, 0, 120]}}},
        ],
        "options": {
            "seed": 2, "budget_s": 60, "max_candidates": 40, "explain_budget_s": 0, "stop": "first",
            "clearance_mm": {"travel": 8, "near": 1.5}, "elbow": "keep", **more,
        },
        "execution": {"lag": {"j1_deg": 0.05, "j2_deg": 0.05, "j3_mm": 0.2, "j4_deg": 0.1}, "belt_correction": True},
    }  # fmt: skip


def planned(request: Document) -> Document:
    """The answer to a request, which the checker has nothing against."""
    answer: Document = json.loads(json.dumps(plan_document(request)))
    assert check_document(request, answer)["ok"]
    return answer


@pytest.mark.parametrize(
    ("tolerance_mm", "said"),
    [
        (None, "pick-1: cup would be pressed 0.2 mm into part (uncertainty 0.2 mm), but only 0.1 mm is allowed"),
        # exactly what is needed: the proof keeps a reserve
        (0.1, "pick-1: cup and part could not be proved to be pressed together by no more than 0.2 mm"),
        (0.2, "pick-1: part would be pressed 0.402 mm into bed (uncertainty 0.402 mm), but only 0.3 mm is allowed"),
        (0.3, "pick-1: part would be pressed 0.402 mm into bed (uncertainty 0.402 mm), but only 0.4 mm is allowed"),
        (0.4, "place-2: cup would be pressed 0.604 mm into part (uncertainty 0.604 mm), but only 0.5 mm is allowed"),
    ],
)
def test_a_contact_that_is_too_deep_is_the_cause_and_not_what_random_detours_hit(
    tolerance_mm: float | None, said: str
) -> None:
    answer = planned(lagging(tolerance_mm))
    assert answer["sentence"].startswith(f"{said}: a contact_tolerance_mm of the step allows more (")
    facts, best = answer["refusal"]["facts"], answer["best_candidate"]
    assert (facts["rule"], answer["refusal"]["stage"]) == ("contact", "certificate")
    assert (best["bodies"], best["gap_m"]) == (answer["refusal"]["bodies"], facts["gap_m"])


def test_the_change_that_the_cause_asks_for_is_the_first_that_is_tried_and_helps() -> None:
    request = lagging(explain_budget_s=60)
    answer = planned(request)
    assert answer["relaxation"]["what"] == "contact tolerance"
    assert answer["relaxation"]["value"] == "0.6 mm at each pick and place"
    assert {each.partition(":")[0] for each in answer["tried"]} == {"contact tolerance"}
    assert planned(lagging(0.6))["status"] == "planned"


def test_the_most_frequent_cause_is_second() -> None:
    """With more candidates most of them are detours, and many stretch the arm, where no correction is possible."""
    answer = planned(lagging(max_candidates=800))
    assert "cup would be pressed 0.2 mm into part" in answer["sentence"]
    first = answer["census"]["lines"][0]
    assert first["reason"] == "NEAR_SINGULARITY"
    shifted = "the belt correction may shift the tool by 0.5 mm, which would bring the arm to a singular position"
    assert answer["sentence"].endswith(f"; most frequent: {shifted} ({first['count']} of 800).")


@cache
def tutorial() -> str:
    return json.dumps(load_scenario(ROOT / "docs" / "first-belt-cell.yaml").request)


def at_the_fence(**start: float) -> Document:
    """The cell of the tutorial, where the second link starts beside the fence."""
    request: Document = json.loads(tutorial())
    request["start"]["joints"] = {"j1_deg": 0, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0, **start}
    return request


@pytest.mark.parametrize(
    ("start", "gap"),
    [({}, "6.87 mm"), ({"j1_deg": 0.3}, "9.21 mm"), ({"j1_deg": -0.2}, "5.29 mm"), ({"j2_deg": 59}, "1.85 mm")],
)
def test_a_start_that_is_too_near_has_one_gap_and_the_distance_that_would_do(start: Document, gap: str) -> None:
    request = at_the_fence(**start)
    answer = planned(request)
    assert (answer["reason"], answer["proved"]) == ("START_IN_COLLISION", True)
    assert f"link-2 would come too close to fence: gap {gap}, required 10 mm" in answer["sentence"]
    told = answer["refusal"]
    same = [line for line in answer["census"]["lines"] if line["bodies"] == told["bodies"]]
    assert same
    for line in same:
        assert line["facts"]["gap_m"] == pytest.approx(told["facts"]["gap_m"], abs=1e-9)
        assert line["interval_s"] == told["interval_s"]
        assert f"gap {gap}, required 10 mm" in line["detail"]
    # the two points of the witness are as far apart
    one, other = told["witness"]["ways"][0]["points_m"]
    assert math.dist(one, other) == pytest.approx(told["facts"]["gap_m"], abs=1e-6)
    assert answer["relaxation"]["what"] == "pair clearance"
    assert planned({**request, "options": {**request["options"], "explain_budget_s": 0, "clearance_exceptions": [
        {"between": ["link-2"], "and": ["fence"], "clearance_mm": {
            "travel": float(answer["relaxation"]["value"].split("travel ")[1].split()[0]), "near": 2}}
    ]}})["status"] == "planned"  # fmt: skip


@pytest.mark.parametrize("low_mm", [10.0, 3.0, 0.4])
def test_a_place_that_is_too_low_is_mended_by_a_higher_one_and_not_by_contact_with(low_mm: float) -> None:
    request: Document = json.loads(tutorial())
    request["task"][1]["place"]["to"]["at_mm"][2] = 60 - low_mm
    answer = planned(request)
    assert (answer["reason"], answer["proved"]) == ("CONTROL_POINT_IN_COLLISION", True)
    assert (
        f"box would hit tray-floor: they would overlap by up to {low_mm:g} mm, and the required distance is 2 mm"
        in answer["sentence"]
    )
    assert "contact_with" not in answer["sentence"]
    assert (answer["relaxation"]["what"], answer["relaxation"]["value"]) == ("point height", f"{low_mm:g} mm higher")
    assert {each.partition(":")[0] for each in answer["tried"]} == {"point height"}
    request["task"][1]["place"]["to"]["at_mm"][2] = 60
    request["options"]["explain_budget_s"] = 0
    assert planned(request)["status"] == "planned"


def test_a_part_that_stands_just_above_a_floor_may_be_put_on_it_by_contact_with() -> None:
    request: Document = json.loads(tutorial())
    request["options"]["explain_budget_s"] = 0
    request["task"][1]["place"]["to"]["at_mm"][2] = 60.5
    assert "; if box is to rest on tray-floor, name it in contact_with." in planned(request)["sentence"]


@pytest.mark.parametrize("angle_deg", [20, 35, 45])
def test_a_gap_is_the_distance_also_where_the_error_has_a_direction(angle_deg: float) -> None:
    """A post on a belt that may be 30 mm farther along it, 8 mm from the cup: along the normal that counts, which is
    across the belt, the two overlap."""
    a, away = math.radians(angle_deg), 12 + 30 + 8
    post = {"name": "post", "shape": {"cylinder": {"radius_mm": 30, "height_mm": 100}},
            "pose": {"frame": "belt", "at_mm": [away * math.cos(a), away * math.sin(a), 130]}}  # fmt: skip
    belt = {"conveyor": {"at_mm": [350, -150, 0], "speed_mm_s": 0}, "uncertainty": {"position_mm": 30}}
    request = cell(go(350, -150, 100), frames={"belt": belt}, bodies=[post], options=options(max_candidates=20))
    request["options"]["clearance_mm"] = {"travel": 4, "near": 1}
    answer = planned(request)
    assert (answer["status"], answer["refusal"]["bodies"]) == ("not_planned", ["cup", "post"]), answer["sentence"]
    facts, best = copy.deepcopy(answer["refusal"]["facts"]), answer["best_candidate"]
    assert facts["gap_m"] < facts["required_m"]
    assert answer["refusal"]["amount"] == pytest.approx(facts["required_m"] - facts["gap_m"], abs=1e-9)
    assert (best["gap_m"], best["required_m"]) == (facts["gap_m"], facts["required_m"])
    # it is evaluated at the end of the motion first
    assert best["at_s"] == pytest.approx(best["trajectory"]["time_s"][-1], abs=1e-9)
    assert facts["gap_m"] == pytest.approx(0.008, abs=1e-5)
    assert "gap 8 mm, required" in answer["sentence"]
