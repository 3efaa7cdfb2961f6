"""Every kind of bad request is refused at the field that is at fault, and the good one is not."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import pytest

from assur.planner.errors import InputError
from assur.scenes.requests import parse_json, scene_of, validate
from tests.scenes.bad_requests import (
    BAD_REQUESTS,
    BAD_TEXTS,
    BELT,
    GOOD_REQUEST,
    PART,
    PICK,
    Bad,
    BadText,
    Change,
    drop,
    put,
)


def test_there_are_at_least_sixty_kinds_of_different_names() -> None:
    names = [bad.name for bad in BAD_REQUESTS] + [text.name for text in BAD_TEXTS]
    assert len(names) == len(set(names)) >= 60


def test_the_good_request_is_a_scene() -> None:
    scene = scene_of(GOOD_REQUEST)
    assert [step.name for step in scene.task] == ["pick-1", "place-2", "move-3"]


@pytest.mark.parametrize("bad", BAD_REQUESTS, ids=lambda bad: bad.name)
def test_a_bad_request_is_refused_at_its_field(bad: Bad) -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    bad.change(request)
    with pytest.raises(InputError) as caught:
        scene_of(request)
    assert caught.value.field == bad.field
    assert caught.value.allowed
    assert pickle.loads(pickle.dumps(caught.value)).args == caught.value.args


@pytest.mark.parametrize("bad", BAD_TEXTS, ids=lambda bad: bad.name)
def test_a_bad_text_is_refused(bad: BadText) -> None:
    with pytest.raises(InputError) as caught:
        validate(parse_json(bad.data))
    if bad.field is not None:
        assert caught.value.field == bad.field


def test_reading_a_request_does_not_change_it() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    scene_of(request)
    assert request == GOOD_REQUEST


FAR_MESH = {"mesh": {"asset": "bracket", "unit": "m"}}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (put("start", "joints", "j3_mm", value=30), ["start.joints.j3_mm: got 30; allowed: 133 to 333"]),
        (put("start", "joints", "j4_deg", value=300), ["allowed: -270 to 270"]),
        (put("start", "joints", value={"j1_rad": 0, "j2_rad": 9, "j3_m": 0.2, "j4_rad": 0}), ["-2.53073 to 2.53073"]),
        (put("start", "joints", value={"j1_rad": 0, "j2_rad": 0, "j3_m": 0.02, "j4_rad": 0}), ["0.133 to 0.333"]),
        (
            put("start", "velocity", value={"j1_rad_s": 0, "j2_deg_s": -700, "j3_m_s": 0, "j4_rad_s": 0}),
            ["-670 to 670"],
        ),
        (
            put("start", "acceleration", value={"j1_rad_s2": 80, "j2_rad_s2": 0, "j3_m_s2": 0, "j4_rad_s2": 0}),
            ["got 80", "-75.384 to 75.384"],  # 0.6 of the maker's
        ),
        (put(*BELT, "at", value=[0, 1, 2]), ["did you mean at_m or at_mm?", "speed_m_s/speed_mm_s", "yaw_rad/yaw_deg"]),
        (put(*BELT, "at", value=3), ["did you mean at_s or at_ms?"]),
        (put(*BELT, "sped_mm_s", value=3), ["did you mean speed_m_s or speed_mm_s?"]),
        (put("frames", "valid_s", value={"conveyor": {"colour": 3}}), ["frames.valid_s.conveyor", "one of"]),
        (drop("schema"), ["allowed: assur/1, which must be given"]),
        (drop(*PART, "shape", "mesh", "unit"), ["one of m, mm, cm, in, which must be given"]),
        (put(*PICK, "window_mm", value=[250, -300]), ["250 is not below -300"]),
        (put("task", 2, value={"mvoe": {}}), ["mvoe is none of them", "did you mean move?"]),
        (put("robot", "model", value="RH-6FRH5520"), ["fanuc-sr-3ia", "did you mean mitsubishi-rh-6frh5520?"]),
        (put(*PICK, "part", value="angel"), ["the name of a body: bar, bed, part, plate"]),
        (put(*PART, "shape", value=FAR_MESH), ["bodies[1].shape.mesh.unit: got 'm'", "m large; is the unit right?"]),
    ],
)
def test_a_refusal_says_what_was_written_and_what_was_probably_meant(change: Change, words: list[str]) -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    change(request)
    with pytest.raises(InputError) as caught:
        scene_of(request)
    told = f"{caught.value}; {caught.value.allowed}"  # the exception's own text shortens nothing of `allowed`
    assert [word for word in words if word not in told] == []


def test_a_start_on_its_limits_is_no_fault() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    request["start"]["joints"] = {"j1_deg": -170, "j2_deg": 145, "j3_mm": 333, "j4_deg": -270}
    request["start"]["velocity"] = {"j1_deg_s": 400, "j2_deg_s": -670, "j3_mm_s": 2400, "j4_deg_s": 0}
    start = scene_of(request).start
    assert start.q[2] == 0.333


def test_a_start_of_a_joint_that_its_maker_counts_downwards_is_told_its_makers_range() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    request["robot"] = {"model": "fanuc-sr-3ia", "tool": {"tcp_mm": [0, 0, 0]}}
    request["start"]["joints"]["j3_mm"] = -1
    with pytest.raises(InputError, match="allowed: 0 to 200"):
        scene_of(request)


def test_masses_are_told_to_be_unused_wherever_one_is_given() -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    told = "mass_kg is not used: no torque, no payload check"
    assert scene_of(request).assumptions.count(told) == 1
    del request["robot"]["tool"]["mass_kg"]
    assert told in scene_of(request).assumptions
    del request["bodies"][1]["mass_kg"]
    assert told not in scene_of(request).assumptions


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        (put("task", 0, "pick", "part", value="parrt"), "task[0].pick.part", "did you mean part?"),
        (put("task", 1, "place", "to", "frame", value="dail"), "task[1].place.to.frame", "did you mean dial?"),
        (put("bodies", 1, "pose", "frame", value="bellt"), "bodies[1].pose.frame", "did you mean belt?"),
        (
            put("task", 2, "move", "to", value={"at_m": [350, 0, 120]}),
            "task[2].move.to.at_m[0]",
            "did you mean at_mm?",
        ),
        (
            put("start", "joints", value={"j1_deg": 17, "j2_deg": 68, "j3_m": 250, "j4_deg": 0}),
            "start.joints.j3_m",
            "did you mean j3_mm?",
        ),
        (put("options", value={"clearance_mm": 5}), "options.clearance_mm", "a mapping of fields: travel, near"),
        (lambda document: document.update(status="planned"), "status", "this is an answer, not a request"),
    ],
)
def test_a_fault_says_what_was_probably_meant(change: Change, field: str, words: str) -> None:
    request = copy.deepcopy(GOOD_REQUEST)
    change(request)
    with pytest.raises(InputError) as caught:
        scene_of(request)
    assert caught.value.field == field
    assert words in caught.value.allowed


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
