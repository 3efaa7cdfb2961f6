"""Every kind of bad request is refused at the field that is at fault, and the good one is not."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.scenes.requests import scene_of
from tests.scenes.bad_requests import BAD_REQUESTS, GOOD_REQUEST, Bad


def test_there_are_at_least_sixty_kinds_of_different_names() -> None:
    names = [bad.name for bad in BAD_REQUESTS]
    assert len(names) == len(set(names)) >= 60


def test_the_good_request_is_a_scene() -> None:
    scene = scene_of(GOOD_REQUEST)
    assert [step.name for step in scene.task] == ["pick-1", "place-2", "move-3"]


@pytest.mark.parametrize("bad", BAD_REQUESTS, ids=lambda bad: bad.name)
def test_a_bad_request_is_refused_at_its_field_with_what_is_allowed_or_was_meant(bad: Bad) -> None:
    with pytest.raises(InputError) as caught:
        scene_of(bad.document())
    assert caught.value.field == bad.field
    assert caught.value.allowed
    assert bad.said in caught.value.allowed
    assert pickle.loads(pickle.dumps(caught.value)).args == caught.value.args


def test_reading_a_request_does_not_change_it() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    scene_of(request)
    assert request == GOOD_REQUEST


def test_a_start_on_its_limits_is_no_fault() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    request["start"]["joints"] = {"j1_deg": -170, "j2_deg": 145, "j3_mm": 333, "j4_deg": -270}
    request["start"]["velocity"] = {"j1_deg_s": 400, "j2_deg_s": -670, "j3_mm_s": 2400, "j4_deg_s": 0}
    start = scene_of(request).start
    assert start.q[2] == 0.333


@pytest.mark.parametrize(
    ("model", "joints", "said"),
    [
        ("fanuc-sr-3ia", (0, 0, -1, 0), r"start\.joints\.j3_mm: got -1; allowed: 0 to 200$"),  # it counts downwards
        ("lab-scara", (0, 50, 10, 0), r"start\.joints\.j2_mm: got 50; allowed: 60 to 420$"),  # its lift comes second
        ("lab-scara", (0, 90, 170, 0), r"start\.joints\.j3_deg: got 170; allowed: -150 to 150$"),
    ],
)
def test_a_start_beyond_a_range_is_told_its_makers_joint_and_range(model: str, joints: tuple[int], said: str) -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    request["robot"] = {"model": model, "tool": {"tcp_mm": [0, 0, 0]}}
    lift = 2 if model == "lab-scara" else 3
    keys = [f"j{i}_{'mm' if i == lift else 'deg'}" for i in range(1, 5)]
    request["start"]["joints"] = dict(zip(keys, joints, strict=True))
    with pytest.raises(InputError, match=said):
        scene_of(request)


def test_a_tool_that_has_a_length_and_no_bodies_is_told_to_be_kept_clear_of_nothing() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    told = "the tool has no bodies: nothing is kept clear of it between flange and tool point"
    assert told not in scene_of(request).assumptions
    request["robot"]["tool"] = {"tcp_mm": [0, 0, -100]}
    assert told in scene_of(request).assumptions
    request["robot"]["tool"] = {"tcp_mm": [0, 0, 0]}
    assert told not in scene_of(request).assumptions


def test_an_arm_that_has_no_bodies_is_told_to_be_kept_clear_of_nothing() -> None:
    told = "the arm has no bodies: nothing is kept clear of its links"
    request = copy.deepcopy(GOOD_REQUEST)
    assert told not in scene_of(request).assumptions
    joint = {"range_deg": [-120, 120], "velocity_deg_s": 400, "acceleration_deg_s2": 4000, "jerk_deg_s3": 2e5}
    lift = {"range_mm": [0, 200], "velocity_mm_s": 1000, "acceleration_mm_s2": 1e4, "jerk_mm_s3": 5e5}
    joints = [{"name": f"j{i + 1}", **(lift if i == 2 else joint)} for i in range(4)]
    request["robot"] = {
        "scara": {"name": "bare", "l1_mm": 325, "l2_mm": 225, "joints": joints, "bodies": [], "self_pairs": []},
        "tool": {"tcp_mm": [0, 0, 0]},
    }
    request["start"]["joints"] = {"j1_deg": 0, "j2_deg": 60, "j3_mm": 150, "j4_deg": 0}
    assert told in scene_of(request).assumptions


def test_a_length_that_is_too_large_in_millimetres_is_not_told_to_be_in_millimetres() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    request["task"][2]["move"]["to"] = {"at_mm": [350000, 0, 120]}
    with pytest.raises(InputError) as caught:
        scene_of(request)
    assert "did you mean" not in caught.value.allowed


THREE_AXES: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {
        "elbow_arm": {
            "height_mm": 300,
            "l1_mm": 250,
            "l2_mm": 232,
            "joints": [
                {
                    "name": name,
                    "range_deg": [-140, 150],
                    "velocity_deg_s": 180,
                    "acceleration_deg_s2": 1500,
                    "jerk_deg_s3": 75000,
                }
                for name in ("j1", "j2", "j3")
            ],
            "bodies": [],
            "self_pairs": [],
        },
        "tool": {"tcp_mm": [0, 0, 0]},
    },
    "start": {"joints": {"j1_deg": 0, "j2_deg": 70, "j3_deg": -90}},
    "bodies": [{"name": "nut", "shape": {"sphere": {"radius_mm": 8}}, "pose": {"at_mm": [300, 0, 20]}}],
}
MOVE = {"move": {"to": {"at_mm": [300, 0, 300]}}}


@pytest.mark.parametrize(
    ("step", "field"),
    [
        (
            {
                "pick": {
                    "part": "nut",
                    "grasp_mm": [0, 0, 0],
                    "approach": {"mm": 5},
                    "dwell_ms": 0,
                    "depart": {"mm": 5},
                }
            },
            "task[1].pick",
        ),
        ({"move": {"to": {"at_mm": [300, 0, 300]}, "arch": {"top_mm": 400}}}, "task[1].move.arch"),
        ({"move": {"to": {"at_mm": [300, 0, 300], "yaw_free": True}}}, "task[1].move.to.yaw_free"),
        ({"follow": {"to": {"at_mm": [300, 0, 300], "yaw_free": True}, "duration_s": 1}}, "task[1].follow.to.yaw_free"),
    ],
)
def test_what_an_arm_cannot_do_is_refused_where_it_is_asked(step: Any, field: str) -> None:
    scene_of({**THREE_AXES, "task": [MOVE, MOVE]})
    with pytest.raises(InputError) as caught:
        scene_of({**THREE_AXES, "task": [MOVE, step]})
    assert caught.value.field == field


def test_a_manner_that_was_left_out_is_named_where_its_silence_is_the_fault() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    to = {"frame": "dial", "at_mm": [0, 0, 100], "yaw_deg": 0}
    stop = {"move": {"to": {"at_mm": [350, 0, 120]}}}
    request["task"] = [stop, {"move": {"to": to, "via": True}}, stop]
    request["options"] = {"timing": "parabolic_blend"}
    with pytest.raises(InputError) as caught:
        scene_of(request)
    assert caught.value.field == "task[1].move.match"
    request["task"][1]["move"]["match"] = "position"
    scene_of(request)
