"""The cell of the five-axis arm, held against a second kinematics; and what its requests may and may not ask."""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BPoly

from assur.planner.errors import InputError
from assur.planner.report.number_format import amount
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.scenes.requests import check_document, plan_document, scene_of
from assur.scenes.scenarios import shipped
from tests.scenes.cells.second_kinematics import Document, answer, chain, changed, path_of

NAME = "rv-m1"


def test_the_tool_points_straight_down_at_its_control_point_and_has_its_velocity() -> None:
    arrival, path = answer(NAME)["arrivals"][0], path_of(answer(NAME))
    assert arrival["pitch_rad"] == pytest.approx(-math.pi / 2)
    assert arrival["roll_rad"] == pytest.approx(math.radians(20))
    for t in np.linspace(arrival["time_s"], arrival["until_s"], 7):
        around = [chain(NAME, path(t + k * 1e-4))["flange"] for k in (-1, 0, 1)]
        where = np.array([0.33, 0.12 * t - 0.25, 0.04 + 0.02 + 0.045])
        assert np.abs(around[1][:3, 3] - where).max() < 1e-5
        assert np.abs(around[1][:3, 0] - [0.0, 0.0, -1.0]).max() < 1e-4
        if arrival["time_s"] + 1e-3 < t < arrival["until_s"] - 1e-3:
            v = (around[2] - around[0])[:3, 3] / 2e-4
            assert np.abs(v - [0.0, 0.12, 0.0]).max() < 1e-3


def test_the_pitch_of_the_second_point_was_free_and_is_told() -> None:
    arrival, path = answer(NAME)["arrivals"][1], path_of(answer(NAME))
    flange = chain(NAME, path(arrival["time_s"]))["flange"]
    assert flange[:3, 3] == pytest.approx([0.3, 0.15, 0.42], abs=1e-6)
    assert math.asin(flange[2, 0]) == pytest.approx(arrival["pitch_rad"], abs=1e-6)
    assert math.atan2(flange[1, 0], flange[0, 0]) == pytest.approx(arrival["yaw_rad"], abs=1e-6)


def second(request: Document) -> Document:
    target: Document = request["task"][1]["move"]["to"]
    return target


@pytest.mark.parametrize(("key", "amount"), [("pitch_rad", 1e-4), ("roll_rad", -1e-4)])
@pytest.mark.parametrize("step", [0, 1])
def test_an_answer_that_says_another_attitude_is_refused(key: str, amount: float, step: int) -> None:
    forged = copy.deepcopy(answer(NAME))
    forged["arrivals"][step][key] += amount
    verdict = check_document(shipped("rv-m1").request, forged)
    assert verdict["ok"] is False
    assert {"ARRIVAL", "JOINTS"} & {finding["code"] for finding in verdict["findings"]}


def test_an_answer_for_another_pitch_than_the_request_asks_is_refused() -> None:
    other = changed(NAME, lambda r: r["task"][0]["follow"]["to"].update(pitch_rad=-math.pi / 2 + 1e-4, pitch_deg=None))
    del other["task"][0]["follow"]["to"]["pitch_deg"]
    verdict = check_document(other, answer(NAME))
    assert {"ARRIVAL", "JOINTS"} & {finding["code"] for finding in verdict["findings"]}


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
    # the pose it misses, by the second kinematics: where the joints are then, less what they miss it by
    knots = made["trajectory"]
    t, kept = np.unique(knots["time_s"], return_index=True)  # parabolas: positions and velocities say all of them
    states = np.stack([np.array(knots[key])[kept] for key in ("position", "velocity")], axis=1)
    q = BPoly.from_derivatives(t, states)(via["time_s"]) - np.array(via["missed_by"]["joints"])
    assert np.allclose(chain(NAME, q)["flange"][:3, 3], [0.28, 0.1, 0.25], atol=1e-9)
    assert q[1] + q[2] + q[3] == pytest.approx(math.radians(-60), abs=1e-9)
    assert via["missed_by"]["distance_m"] > 1e-3
    other = check_document(blends(-60.01), made)
    assert "ARRIVAL" in {finding["code"] for finding in other["findings"]}
    for key in ("pitch_rad", "roll_rad"):
        forged = copy.deepcopy(made)
        forged["arrivals"][0][key] += 1e-4
        assert "ARRIVAL" in {finding["code"] for finding in check_document(blends(), forged)["findings"]}


def test_free_and_silent_are_one_request_and_a_number_is_another() -> None:
    silent = changed(NAME, lambda r: second(r).pop("pitch_deg"))
    both = changed(NAME, lambda r: second(r).update(roll_deg="free"))
    assert scene_of(silent).digest == scene_of(both).digest == answer(NAME)["request_digest"]
    asked = changed(NAME, lambda r: second(r).update(pitch_deg=-60))
    assert scene_of(asked).digest != scene_of(silent).digest


def test_a_target_too_far_away_is_refused_with_what_is_missing() -> None:
    """600 mm away and 100 mm up, against arm and hand of 482 mm."""
    far = plan_document(
        changed(NAME, lambda r: r.update(task=[{"move": {"name": "far", "to": {"at_mm": [600, 0, 400]}}}]))
    )
    assert (far["status"], far["reason"], far["proved"]) == ("not_planned", "OUT_OF_REACH", True)
    short = math.hypot(0.6, 0.1) - 0.482
    assert far["refusal"]["amount"] == pytest.approx(short, abs=1e-12)
    assert far["sentence"] == f"far: the point is {amount(short, 'm')} out of reach at every pitch of the tool."


def test_a_target_that_the_hand_reaches_only_stretched_out_is_refused_straight_down() -> None:
    at = {"at_mm": [460, 0, 300]}
    down = plan_document(
        changed(NAME, lambda r: r.update(task=[{"move": {"name": "far", "to": {**at, "pitch_deg": -90}}}]))
    )
    assert (down["status"], down["reason"], down["proved"]) == ("not_planned", "OUT_OF_REACH", True)
    assert "at a pitch of -90 deg" in down["sentence"]
    free = plan_document(changed(NAME, lambda r: r.update(task=[{"move": {"to": at}}], bodies=[])))
    assert free["status"] == "planned", free


def test_a_straight_leg_is_straight_and_carries_the_pitch_along() -> None:
    request = changed(NAME, lambda r: r.update(bodies=[body for body in r["bodies"] if body["name"] == "part"]))
    request["task"][1]["move"]["leg"] = "cartesian"
    second(request).update(pitch_deg=-60, roll_deg=0)
    found = plan_document(request)
    assert found["status"] == "planned", found
    assert check_document(request, found)["ok"] is True
    leg, path = found["legs"][-1], path_of(found)
    assert leg["note"] == "straight"
    begin, middle, end = (chain(NAME, path(t))["flange"] for t in (leg["from_s"], leg["from_s"] + 0.4, leg["to_s"]))
    assert math.degrees(math.asin(begin[2, 0])) == pytest.approx(-90, abs=0.01)
    assert math.degrees(math.asin(end[2, 0])) == pytest.approx(-60, abs=1e-4)
    assert -90 < math.degrees(math.asin(middle[2, 0])) < -60


PICK = {"part": "part", "grasp_mm": [0, 0, 0], "approach": {"mm": 1}, "dwell_ms": 1, "depart": {"mm": 1}}


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (lambda r: r["robot"]["tool"].update(tcp_mm=[50, 0, 0]), "flange of mitsubishi-rv-m1 tilts"),
        (lambda r: r["task"][1]["move"].update(arch={"top_mm": 500}), "no joint that lifts"),
        (lambda r: second(r).update(yaw_deg=10), "heading follows from the position"),
        (lambda r: r.update(task=[{"pick": PICK}]), "turns and tilts its tool"),
        (lambda r: r.update(task=[{"pick": {**PICK, "grasp_yaw_deg": 3}}]), "heading follows from the position"),
        (lambda r: second(r).update(pitch_deg="down"), "free, or a number"),
    ],
)
def test_what_this_arm_cannot_do_is_refused_in_words(change: Any, match: str) -> None:
    with pytest.raises(InputError, match=match):
        scene_of(changed(NAME, change))


def test_every_number_that_nobody_vouches_for_is_told_with_the_plan() -> None:
    told = "\n".join(answer(NAME)["assumptions"])
    for what in ("length of link 1 250", "length of link 2 160", "length of the hand 72", "height of the shoulder 300"):
        assert f"mitsubishi-rv-m1: {what} mm, third_party: widely quoted for the Mitsubishi RV-M1, unsourced" in told
    for joint in ("j1", "j2", "j3", "j4", "j5"):
        assert f"{joint} lower end of its range" in told
        assert f"{joint} acceleration" in told


def test_written_out_a_tools_length_is_a_part_of_the_hand() -> None:
    def longer(request: Document) -> None:
        rate = {"velocity_deg_s": 90, "acceleration_deg_s2": 500, "jerk_deg_s3": 25000}
        joints = [{"name": f"j{i}", "range_deg": [-170, 170], **rate} for i in range(1, 6)]
        lengths = {"height_mm": 300, "l1_mm": 250, "l2_mm": 160, "l3_mm": 72 + 100}
        hand = {"name": "hand", "link": "link4", "shape": {"box": {"size_mm": [160, 20, 20]}}, "at_mm": [80, 0, 0]}
        arm = {**lengths, "joints": joints, "bodies": [hand], "self_pairs": [["base", "link4"]]}
        request["robot"] = {"five_axis_arm": arm, "tool": {"tcp_mm": [0, 0, 0]}}
        request["start"] = {"joints": {"j1_deg": 0, "j2_deg": 80, "j3_deg": -100, "j4_deg": -40, "j5_deg": 0}}
        request["task"] = [{"move": {"to": {"at_mm": [300, 0, 150], "pitch_deg": -90}}}]
        request["bodies"], request["frames"] = [], {}

    robot = scene_of(changed(NAME, longer)).robot
    assert isinstance(robot, FiveAxisArm)
    assert robot.l3 == pytest.approx(0.172)
    found = plan_document(changed(NAME, longer))
    assert found["status"] == "planned", found
    assert check_document(changed(NAME, longer), found)["ok"] is True
