"""The wrist: a yaw that is kept, less travel among plans of equal duration, joints and modes in the arrivals."""

from __future__ import annotations

import copy
import math
from dataclasses import replace

import numpy as np
import pytest

from assur.planner.checker import Code
from assur.planner.errors import InputError
from assur.planner.search.tuning import SAME_DURATION
from assur.scenes.reading.plan import plan_of
from assur.scenes.requests import cell_of, check_document, shipped
from tests.changed import GONE, changed
from tests.refused import refused_at
from tests.scenes.cells.answers import Document, codes, planned

START = {"joints": {"j1_deg": -40, "j2_deg": 80, "j3_mm": 250, "j4_deg": 100}}


def cell(**to: object) -> Document:
    """Two moves of an arm with its wrist turned: to one side with a yaw, back with what `to` says."""
    return {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [30, 0, -100]}},
        "start": START,
        "task": [
            {"move": {"to": {"at_mm": [350, 150, 150], "yaw_deg": 170}}},
            {"move": {"to": {"at_mm": [350, -150, 150], **to}}},
        ],
        "options": {"stop": "budget", "max_candidates": 120, "budget_s": 60, "seed": 1},
    }


def test_a_kept_yaw_is_that_of_the_step_before() -> None:
    first, second = planned(cell(yaw_keep=True))["arrivals"]
    assert math.remainder(first["yaw_rad"] - math.radians(170), math.tau) == pytest.approx(0, abs=1e-6)
    assert math.remainder(second["yaw_rad"] - first["yaw_rad"], math.tau) == pytest.approx(0, abs=1e-9)


def test_a_free_yaw_leaves_the_wrist_where_it_is() -> None:
    request = cell(yaw_free=True)
    request["robot"]["tool"]["tcp_mm"] = [0, 0, -100]  # on the wrist's axis: no yaw brings the arm nearer
    first, second = planned(request)["arrivals"]
    assert second["joints"][3] == pytest.approx(first["joints"][3], abs=1e-9)


def test_a_yaw_is_kept_on_a_belt_from_the_start() -> None:
    belt = {"conveyor": {"at_mm": [350, -200, 100], "yaw_deg": 30, "speed_mm_s": 100}}
    follow = {"to": {"frame": "belt", "at_mm": [0, 0, 0], "yaw_keep": True}, "duration_ms": 100}
    request = {**cell(), "frames": {"belt": belt}, "task": [{"follow": follow}]}
    scene = cell_of(request).scene
    before = float(scene.robot.forward(scene.start.q)[1])
    (arrival,) = planned(request)["arrivals"]
    assert math.remainder(arrival["yaw_rad"] - before, math.tau) == pytest.approx(0, abs=1e-9)


def test_a_yaw_is_kept_from_the_end_of_a_depart_that_turned_with_a_dial() -> None:
    request = copy.deepcopy(dict(shipped("transfer").request))
    request["frames"] = {"dial": {"turntable": {"at_mm": [420, -150, 0], "rate_deg_s": 60}}}
    load = next(body for body in request["bodies"] if body["name"] == "load")
    load["pose"] = {"frame": "dial", "at_mm": [0, 0, 20]}
    request["task"] = [request["task"][0], {"move": {"to": {"at_mm": [420, 100, 90], "yaw_keep": True}}}]
    grip, away = planned(request)["arrivals"]
    turned = math.degrees(math.remainder(away["yaw_rad"] - grip["yaw_rad"], math.tau))
    assert 0.5 < turned < 3.0  # in the 20 ms of the depart the dial turns by more than a degree


def test_a_plan_that_turns_a_tool_whose_yaw_is_kept_is_refused() -> None:
    """The plan for a free yaw, checked against the request that keeps it."""
    plan, _ = plan_of(planned(cell(yaw_free=True)), cell_of(cell()).conventions)
    kept = cell(yaw_keep=True)
    assert {*codes(kept, plan)} == {Code.DIRECTION}


@pytest.mark.parametrize(
    ("change", "allowed"),
    [
        ({"yaw_keep": True, "yaw_deg": 10}, "one of"),
        ({"yaw_keep": True, "frame": "dial", "at_mm": [50, 0, 0]}, "dial turns"),
    ],
)
def test_a_yaw_that_cannot_be_kept_is_refused_by_its_field(change: Document, allowed: str) -> None:
    request = cell(**change)
    request["frames"] = {"dial": {"turntable": {"at_mm": [300, 0, 100], "rate_deg_s": 30}}}
    with pytest.raises(InputError) as caught:
        cell_of(request)
    assert "task[1].move.to" in caught.value.field
    assert allowed in f"{caught.value.field} {caught.value.allowed}" or "yaw" in caught.value.allowed


def on_keyframes(second: float) -> Document:
    """A yaw that is kept in a frame whose keyframes have yaws of 30° and of `second`."""
    points = [{"time_s": 0, "at_mm": [350, -150, 150], "yaw_deg": 30}]
    points.append({"time_s": 5, "at_mm": [350, -100, 150], "yaw_deg": second})
    request = cell(yaw_keep=True, frame="lift", at_mm=[0, 0, 0])
    request["frames"] = {"lift": {"keyframes": {"points": points}}}
    return request


def test_a_yaw_is_kept_on_keyframes_that_all_have_the_same_yaw() -> None:
    first, second = planned(on_keyframes(30))["arrivals"]
    assert math.remainder(second["yaw_rad"] - first["yaw_rad"], math.tau) == pytest.approx(0, abs=1e-9)


def test_a_yaw_is_not_kept_on_keyframes_that_turn_and_the_error_says_what_else_may_be_given() -> None:
    with refused_at("task[1].move.to.yaw_keep", match=r"false, with yaw_free: true or a yaw_deg: lift turns"):
        cell_of(on_keyframes(31))


@pytest.mark.parametrize(
    ("said", "key"), [({}, "yaw_rad"), ({"yaw_keep": False}, "yaw_keep"), ({"yaw_free": False}, "yaw_free")]
)
def test_a_yaw_that_is_missing_is_refused_with_all_that_may_be_given(said: Document, key: str) -> None:
    follow = {"to": {"at_mm": [350, -150, 150], **said}, "duration_ms": 100}
    request = {**cell(), "task": [{"follow": follow}]}
    with pytest.raises(InputError) as caught:
        cell_of(request)
    assert caught.value.field == f"task[0].follow.to.{key}"
    for words in ("yaw_deg", "yaw_free: true", "yaw_keep: true", "must be given"):
        assert words in caught.value.allowed


def test_a_part_is_not_placed_with_a_kept_yaw() -> None:
    to = "task[1].place.to"
    kept = changed(shipped("transfer").request, {f"{to}.yaw_deg": GONE, f"{to}.yaw_keep": True})
    with pytest.raises(InputError, match="a part is placed as it has to lie"):
        cell_of(kept)


def travel(answer: Document) -> float:
    wrist = np.array(answer["trajectory"]["position"])[:, 3]
    return float(np.abs(np.diff(wrist)).sum())


def test_of_plans_that_take_equally_long_the_one_with_less_travel_of_the_wrist_is_the_answer() -> None:
    """A part that looks the same in all of four turns: the wrist has time to turn, and no reason to."""
    request = cell()
    # the part stands in the air: nothing but the wrist tells the plans apart
    part = {
        "name": "part",
        "shape": {"box": {"size_mm": [30, 30, 30]}},
        "pose": {"at_mm": [350, -200, 45], "yaw_deg": 20},
    }
    request["bodies"] = [{**part, "yaw_symmetry": 4}]
    pick = {"part": "part", "grasp_mm": [0, 0, 15], "approach": {"mm": 5}, "dwell_ms": 0, "depart": {"mm": 5}}
    request["task"] = [{"move": {"to": {"at_mm": [350, 200, 150], "yaw_deg": 0}}}, {"pick": pick}]
    request["robot"]["tool"]["tcp_mm"] = [0, 0, -100]
    request["options"]["clearance_mm"] = {"travel": 0, "near": 0}
    answer = planned(request)
    every = []
    for turn in (0, 90, 180, 270):
        fixed = copy.deepcopy(request)
        fixed["bodies"][0]["yaw_symmetry"] = 1
        fixed["bodies"][0]["pose"]["yaw_deg"] = 20 + turn
        every.append(planned(fixed))
    soonest = min(each["duration_s"] for each in every)
    least = min(travel(each) for each in every if each["duration_s"] <= (1 + SAME_DURATION) * soonest)
    assert answer["duration_s"] <= (1 + SAME_DURATION) ** 2 * soonest
    assert travel(answer) <= least + 0.05


def test_an_arrival_without_joints_or_mode_is_read_as_before() -> None:
    request = cell(yaw_free=True)
    answer = planned(request)
    for arrival in answer["arrivals"]:
        del arrival["joints"], arrival["mode"]
    assert check_document(request, answer)["ok"]
    plan, findings = plan_of(answer, cell_of(request).conventions)
    assert not findings
    assert replace(plan).arrivals == plan.arrivals
