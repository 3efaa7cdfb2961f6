"""All joint positions at a pose of the tool, for every family: complete, with right margins; and the reverse."""

from __future__ import annotations

import copy
import itertools
import json
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from assur.planner.collision.proof import Prover
from assur.planner.errors import InputError
from assur.planner.feasibility.necessary import start_collides, start_impossible
from assur.planner.model.scene import WorldBody
from assur.planner.robots.facts import principal
from assur.scenes import ik, load
from assur.scenes.conventions import converted
from assur.scenes.reading.robots import RobotWithTool
from assur.scenes.requests import cell_of, ik_cell, ik_document, scene_of
from assur.scenes.schema.ik import IkAnswer
from tests.planner.cells import mesh_box
from tests.refused import refused_at
from tests.scenes.robots_of_every_family import (
    ROBOTS,
    built,
    in_words_of_the_maker,
    pose_document,
    positions,
    robot_document,
    tool_at,
)

ANSWER: TypeAdapter[Any] = TypeAdapter(IkAnswer)
POSE = {"at_mm": [350, 0, 150], "yaw_deg": 90}


def through_the_model(answer: dict[str, Any]) -> Any:
    """An answer as its own description reads it from JSON and writes it again."""
    return ANSWER.dump_python(ANSWER.validate_json(json.dumps(answer)), mode="json")


def vector(joints: dict[str, float], given: RobotWithTool) -> np.ndarray[Any, np.dtype[np.float64]]:
    """A joint vector from the answer's words."""
    assert list(joints) == [f"{joint.name}_{joint.unit}" for joint in given.conventions]
    return converted(np.array(list(joints.values())), given.conventions)


@pytest.mark.parametrize("name", ROBOTS)
def test_every_solution_puts_the_tool_there_and_no_joint_position_that_does_is_missing(name: str) -> None:
    given, robot = built(name), robot_document(name)
    turning = np.array([joint.kind == "revolute" for joint in given.robot.joints])
    limits = given.robot.limits
    for q in positions(given, 10, seed=11):
        tool = tool_at(q, given)
        answer = ik(robot=robot, pose=pose_document(tool, given))
        assert through_the_model(answer) == answer
        assert answer["status"] == "reached"
        found = [vector(each["joints"], given) for each in answer["solutions"]]
        for each, solution in zip(found, answer["solutions"], strict=True):
            there = tool_at(each, given)
            assert there.p == pytest.approx(tool.p, abs=1e-9)
            if "yaw" in given.robot.coordinates:
                assert principal(there.yaw - tool.yaw) == pytest.approx(0.0, abs=1e-9)
            assert solution["mode"] == given.robot.modes[int(given.robot.mode_of(each))]
            assert (limits.lower <= each).all()
            assert (each <= limits.upper).all()
        # every full turn of the joints that were drawn, by trying all
        turned = [
            [x + 2 * math.pi * k for k in range(-3, 4)] if turns else [x] for x, turns in zip(q, turning, strict=True)
        ]
        kept = [
            [x for x in row if low <= x <= high]
            for row, low, high in zip(turned, limits.lower, limits.upper, strict=True)
        ]
        wanted = [np.array(each) for each in itertools.product(*kept)]
        for each in wanted:
            assert min(np.abs(other - each).max() for other in found) < 1e-8
        of_mode = given.robot.modes[int(given.robot.mode_of(q))]
        assert [each["mode"] for each in answer["solutions"]].count(of_mode) == len(wanted)
        modes = {each["mode"] for each in answer["solutions"]} | {each["mode"] for each in answer["unreached"]}
        assert modes == set(given.robot.modes)


@pytest.mark.parametrize("name", ROBOTS)
def test_joints_give_the_pose_and_the_margins_that_the_pose_gives_with_these_joints(name: str) -> None:
    given, robot = built(name), robot_document(name)
    for q in positions(given, 5, seed=12):
        forward = ik(robot=robot, joints=in_words_of_the_maker(q, given))
        assert through_the_model(forward) == forward
        (one,) = forward["solutions"]
        tool = tool_at(q, given)
        assert forward["tool"]["world"]["at_m"] == pytest.approx(tool.p.tolist(), abs=1e-12)
        assert forward["tool"]["world"]["yaw_rad"] == pytest.approx(float(tool.yaw), abs=1e-12)
        back = ik(robot=robot, pose=pose_document(tool, given))["solutions"]
        same = [each for each in back if np.abs(vector(each["joints"], given) - q).max() < 1e-8]
        assert len(same) == 1
        assert same[0]["turn"] == one["turn"]
        for key in ("singularity_margin", "parallel_margin", "reach_m"):
            assert same[0][key] == pytest.approx(one[key], abs=1e-6)


@pytest.mark.parametrize("name", ROBOTS)
def test_the_margins_are_those_of_the_robot_in_its_makers_count(name: str) -> None:
    given, robot = built(name), robot_document(name)
    (q,) = positions(given, 1, seed=13)
    (one,) = ik(robot=robot, joints=in_words_of_the_maker(q, given))["solutions"]
    lower, upper = (in_words_of_the_maker(end, given) for end in (given.robot.limits.lower, given.robot.limits.upper))
    for key, value in one["joints"].items():
        ends = sorted((lower[key], upper[key]))
        assert one["to_limits"][key] == pytest.approx([value - ends[0], ends[1] - value], abs=1e-12)
        assert min(one["to_limits"][key]) >= 0.0
    # joints with a zero of their own are rounded once on the way
    assert one["singularity_margin"] == pytest.approx(float(given.robot.margin(q)), abs=1e-14)
    assert (one["parallel_margin"] is None) == (given.robot.parallel_least == 0.0)
    assert one["reach_m"] > 0.0


def test_what_a_scara_lacks_is_told_by_mode_with_numbers() -> None:
    robot = {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}}
    far = ik(robot=robot, pose={"at_mm": [553.2, 0, 150], "yaw_deg": 0})
    assert (far["status"], far["solutions"]) == ("not_reached", [])
    assert [each["mode"] for each in far["unreached"]] == ["left", "right"]
    for each in far["unreached"]:
        assert (each["reason"], each["detail"], each["beyond"]) == ("OUT_OF_REACH", "3.2 mm out of reach", {})
        assert each["short_m"] == pytest.approx(0.0032, abs=1e-12)
    high = ik(robot=robot, pose={"at_mm": [350, 0, 250], "yaw_deg": 0})["unreached"][0]
    assert (high["reason"], high["short_m"]) == ("JOINT_LIMIT", None)
    assert high["beyond"] == pytest.approx({"j3_m": 0.017})
    stretched = ik(robot=robot, pose={"at_mm": [550, 0, 150], "yaw_deg": 0})["unreached"][0]
    assert (stretched["reason"], stretched["detail"]) == ("NEAR_SINGULARITY", "the arm would be stretched")


def test_the_pose_of_the_tool_is_told_in_every_frame_that_is_known_then() -> None:
    request = load("demo")
    request["frames"]["late"] = {"keyframes": {"points": [{"time_s": t, "at_mm": [0, 0, 0]} for t in (3, 4)]}}
    request["frames"]["nest"] = {"fixed": {"frame": "belt", "at_mm": [-30, 10, 0], "yaw_deg": 90}}
    tool = ik(request, pose={"frame": "nest", "at_mm": [1, 2, 80], "yaw_deg": 5}, at_s=0.5)["tool"]
    assert set(tool) == {"world", "belt", "dial", "gate", "nest"}
    assert tool["nest"]["at_m"] == pytest.approx([0.001, 0.002, 0.08], abs=1e-12)
    assert tool["nest"]["yaw_rad"] == pytest.approx(math.radians(5))
    assert tool["belt"]["at_m"] == pytest.approx([-0.032, 0.011, 0.08], abs=1e-12)
    # the belt is at (250 t, 350, 50) mm and runs along x
    assert tool["world"]["at_m"] == pytest.approx([0.125 - 0.032, 0.361, 0.13], abs=1e-12)
    assert "late" in ik(request, pose=POSE, at_s=3.5)["tool"]


def test_the_time_is_that_of_the_start_unless_another_is_asked() -> None:
    request = load("demo")
    request["start"]["at_s"] = 0.25
    there = {"frame": "belt", "at_mm": [0, 0, 90], "yaw_deg": 0}
    assert ik(request, pose=there)["tool"]["world"]["at_m"][0] == pytest.approx(0.0625)
    assert ik(request, pose=there)["at_s"] == 0.25
    assert ik(request, pose=there, at_s=-0.5)["tool"]["world"]["at_m"][0] == pytest.approx(-0.125)


def obstructed() -> dict[str, Any]:
    """A cell with a post and a wall in the way, and a collision that the clearance makes."""
    robot = {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}}
    shape = {"cylinder": {"radius_mm": 20, "height_mm": 240}}
    return {
        "schema": "assur/1",
        "robot": robot,
        "start": {"joints": {"j1_deg": -40, "j2_deg": 90, "j3_mm": 300, "j4_deg": 0}},
        "bodies": [{"name": "post", "shape": shape, "pose": {"at_mm": [320, 180, 120]}}],
        "task": [{"move": {"to": {"at_mm": [350, 0, 150]}}}],
    }


def test_collisions_at_rest_are_those_that_a_start_there_would_have() -> None:
    request = obstructed()
    for x in np.linspace(200.0, 500.0, 13).tolist():
        for solution in ik(request, pose={"at_mm": [x, 150, 120], "yaw_deg": 0})["solutions"]:
            there = scene_of({**request, "start": {"joints": solution["joints"]}})
            prover = Prover(there)
            assert start_impossible(there, prover) is None
            refusal = start_collides(there, prover)
            told = solution["collisions"]
            assert (refusal is None) == (told == [])
            if refusal is not None:
                assert list(refusal.bodies) == told[0]["bodies"]
                assert " would hit post: they would overlap by up to " in told[0]["detail"]


def test_every_pair_is_told_and_a_clearance_that_is_missing_with_its_distances() -> None:
    request = obstructed()
    pose = {"at_mm": [320, 180, 120], "yaw_deg": 0}
    request["bodies"].append({**request["bodies"][0], "name": "other"})
    (left, *_) = ik(request, pose=pose)["solutions"]
    assert {each["bodies"][1] for each in left["collisions"]} == {"post", "other"}
    assert len({tuple(each["bodies"]) for each in left["collisions"]}) == len(left["collisions"])
    near = {"at_mm": [320, 120, 120], "yaw_deg": 0}
    assert ik(request, pose=near)["solutions"][0]["collisions"] == []
    request["options"] = {"clearance_mm": {"travel": 60, "near": 1}}
    answer = ik(request, pose=near)
    assert through_the_model(answer) == answer
    told = answer["solutions"][0]["collisions"]
    assert any("would come too close to post: " in each["detail"] for each in told)
    assert all(each["facts"]["required_m"] == pytest.approx(0.06) for each in told)


def test_an_arm_inside_a_hollow_mesh_is_told_to_be_inside() -> None:
    cell = cell_of(obstructed())
    room = WorldBody(mesh_box("room", 2.0, 2.0, 2.0))
    within = replace(cell, scene=replace(cell.scene, bodies=(room,)))
    told = ik_cell(within, {"pose": POSE})["solutions"][0]["collisions"]
    assert [each["facts"]["kind"] for each in told] == ["enclosed"] * 4
    names = ("base-column", "link-1", "link-2", "shaft")
    assert [each["detail"] for each in told] == [f"{name} is inside room" for name in names]


def test_a_body_that_moves_is_where_it_is_at_the_time() -> None:
    request = obstructed()
    request["frames"] = {"belt": {"conveyor": {"at_mm": [0, 0, 0], "speed_mm_s": 100}}}
    request["bodies"][0]["pose"]["frame"] = "belt"
    pose = {"at_mm": [320, 180, 120], "yaw_deg": 0}
    assert ik(request, pose=pose)["solutions"][0]["collisions"] != []
    assert ik(request, pose=pose, at_s=-5)["solutions"][0]["collisions"] == []


GOOD = {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}}


@pytest.mark.parametrize(
    ("question", "field", "said"),
    [
        ({"pose": POSE}, "request", "a request, or a robot"),
        ({"robot": GOOD}, "pose", "a pose of the tool, or joints"),
        ({"robot": GOOD, "pose": POSE, "joints": {}}, "joints", "exactly one of pose, joints"),
        ({"robot": GOOD, "pose": {"at_mm": [1, 2, 3]}}, "pose.yaw_rad", "which must be given"),
        ({"robot": GOOD, "pose": {**POSE, "frame": "belt"}}, "pose.frame", "one of world"),
        ({"robot": GOOD, "pose": {**POSE, "body": "part"}}, "pose.body", "none is there"),
        ({"robot": GOOD, "pose": {**POSE, "yaw_deg": math.inf}}, "pose.yaw_deg", "a finite number"),
        ({"robot": GOOD, "pose": {**POSE, "roll_deg": 1}}, "pose.roll_deg", "no roll"),
        ({"robot": GOOD, "pose": POSE, "at_s": math.nan}, "at_s", "a finite number"),
        ({"robot": GOOD, "pose": POSE, "at_s": 1e9}, "at_s", "at most 100000"),
        ({"robot": GOOD, "pose": POSE, "at": 1}, "at", "did you mean at_s"),
        ({"robot": {"model": "scara"}, "pose": POSE}, "robot.tool", "which must be given"),
        ({"robot": {**GOOD, "model": "scara"}, "pose": POSE}, "robot.model", "one of benchmark-scara"),
        (
            {"robot": {"model": "elbow-arm", "tool": {"tcp_mm": [0, 0, 1]}}, "pose": {"at_mm": [300, 0, 300]}},
            "robot.tool.tcp_mm",
            "tilts",
        ),
        ({"robot": GOOD, "joints": {"j1_deg": 1}}, "joints.j2_rad", "which must be given"),
        (
            {"robot": GOOD, "joints": {"j1_deg": 1, "j2_deg": 146, "j3_mm": 200, "j4_deg": 0}},
            "joints.j2_deg",
            "-145 to 145",
        ),
        (
            {
                "robot": {**robot_document("five-bar of two axes"), "tool": {"tcp_mm": [0, 0, 0]}},
                "joints": {"j1_deg": 180, "j2_deg": 180, "j3_mm": 1},
            },
            "joints.j3_mm",
            "one of j1_rad, j2_rad",
        ),
    ],
)
def test_what_is_wrong_with_a_question_is_told_at_its_field(question: dict[str, Any], field: str, said: str) -> None:
    with refused_at(field, said):
        ik(**question)


def test_joints_with_which_a_chain_does_not_close_are_refused() -> None:
    robot = copy.deepcopy(robot_document("five-bar of two axes"))
    robot["five_bar"]["distal_mm"] = [60, 60]
    with refused_at("joints", "the couplers 120.0 mm long together"):
        ik(robot=robot, joints={"j1_deg": 90, "j2_deg": -90})


def test_a_request_that_is_wrong_is_told_at_its_own_field_and_brings_no_second_robot() -> None:
    request = load("demo")
    with refused_at("robot"):
        ik(request, robot=GOOD, pose=POSE)
    request["robot"]["model"] = "none"
    with refused_at("robot.model"):
        ik(request, pose=POSE)


def test_a_time_at_which_a_body_is_nowhere_is_refused() -> None:
    request = obstructed()
    request["frames"] = {"gate": {"fixed": {"at_mm": [0, 0, 0]}, "valid_s": [0, 2]}}
    request["bodies"][0]["pose"]["frame"] = "gate"
    assert ik(request, pose=POSE)["status"] == "reached"
    with pytest.raises(InputError) as caught:
        ik(request, pose=POSE, at_s=2.5)
    assert caught.value.field == "at_s"
    assert caught.value.allowed.endswith("it is known from 0 s to 2 s")


def test_what_is_no_mapping_is_no_question() -> None:
    none: tuple[object, ...] = (None, 3, [], "pose")
    for question in none:
        with pytest.raises(InputError):
            ik_document(None, question)


def test_what_is_no_answer_is_refused_by_its_description() -> None:
    answer = ik(robot=GOOD, pose=POSE)
    for key, value in (("status", "perhaps"), ("at_s", math.nan), ("solutions", [{"mode": "left"}]), ("colour", 1)):
        with pytest.raises(ValidationError):
            through_the_model({**answer, key: value})
