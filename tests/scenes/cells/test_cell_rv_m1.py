"""The cell of the five-axis arm, held against a second kinematics; and what its requests may and may not ask."""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from functools import cache
from typing import Any

import fcl
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import BPoly

from assur.planner.checker import Code, check
from assur.planner.errors import InputError
from assur.planner.geometry.shapes import Body, Primitive, box
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Plan, Planned
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from assur.planner.report.number_format import amount
from assur.planner.robots.five_axis_arm import FLANGE, LINK4, FiveAxisArm
from assur.scenes.requests import check_document, plan_document, plan_scenario, scene_of
from assur.scenes.scenarios import shipped, unmet

Array = NDArray[np.float64]
Document = dict[str, Any]
INSTANTS = 600
LINKS = ("base", "link1", "link2", "link3", "link4", "flange")


@cache
def answer() -> Document:
    return plan_scenario(shipped("rv-m1"))


def path_of(plan: Document) -> BPoly:
    knots = plan["trajectory"]
    states = np.stack([np.array(knots[key]) for key in ("position", "velocity", "acceleration")], axis=1)
    return BPoly.from_derivatives(np.array(knots["time_s"]), states)


def about(axis: int, angle: float, x: float = 0.0, z: float = 0.0) -> Array:
    """A turn about an axis after a shift, (4, 4)."""
    found, i, j = np.eye(4), (axis + 1) % 3, (axis + 2) % 3
    c, s = math.cos(angle), math.sin(angle)
    found[[i, j], [i, j]], found[i, j], found[j, i] = c, -s, s
    found[0, 3], found[2, 3] = x, z
    return found


def chain(q: Array) -> list[Array]:
    """Link frames from the maker's joint values and the numbers of the catalogue."""
    found = [np.eye(4)]
    for step in (about(2, q[0], z=0.3), about(1, -q[1]), about(1, -q[2], 0.25), about(1, -q[3], 0.16)):
        found.append(found[-1] @ step)
    return [*found, found[-1] @ about(0, q[4], 0.072)]


def test_the_cell_is_planned_as_it_expects_and_checked_and_the_same_again() -> None:
    scenario = shipped("rv-m1")
    assert unmet(scenario.expect, answer()) == []
    verdict = check_document(scenario.request, answer(), folder=scenario.folder)
    assert verdict["ok"] is True, verdict
    again = plan_scenario(scenario)
    assert again["certificate"]["digest"] == answer()["certificate"]["digest"]


def test_the_tool_points_straight_down_at_its_control_point_and_has_its_velocity() -> None:
    arrival, path = answer()["arrivals"][0], path_of(answer())
    assert arrival["pitch_rad"] == pytest.approx(-math.pi / 2)
    assert arrival["roll_rad"] == pytest.approx(math.radians(20))
    for t in np.linspace(arrival["time_s"], arrival["until_s"], 7):
        around = [chain(path(t + k * 1e-4))[-1] for k in (-1, 0, 1)]
        where = np.array([0.33, 0.12 * t - 0.25, 0.04 + 0.02 + 0.045])
        assert np.abs(around[1][:3, 3] - where).max() < 1e-5
        assert np.abs(around[1][:3, 0] - [0.0, 0.0, -1.0]).max() < 1e-4
        if arrival["time_s"] + 1e-3 < t < arrival["until_s"] - 1e-3:
            v = (around[2] - around[0])[:3, 3] / 2e-4
            assert np.abs(v - [0.0, 0.12, 0.0]).max() < 1e-3


def test_the_pitch_of_the_second_point_was_free_and_is_told() -> None:
    arrival, path = answer()["arrivals"][1], path_of(answer())
    flange = chain(path(arrival["time_s"]))[-1]
    assert flange[:3, 3] == pytest.approx([0.3, 0.15, 0.42], abs=1e-6)
    assert math.asin(flange[2, 0]) == pytest.approx(arrival["pitch_rad"], abs=1e-6)
    assert math.atan2(flange[1, 0], flange[0, 0]) == pytest.approx(arrival["yaw_rad"], abs=1e-6)


def solid(piece: Any) -> Any:
    x, y, z = (2 * h for h in piece.shape.half)
    if piece.shape.kind == "box":
        return fcl.Box(x, y, z)
    return fcl.Cylinder(piece.shape.disc, z) if piece.shape.kind == "cylinder" else fcl.Capsule(piece.shape.ball, z)


def test_no_link_comes_nearer_to_anything_than_was_asked() -> None:
    scene, path = scene_of(shipped("rv-m1").request), path_of(answer())
    knots, closest = answer()["trajectory"]["time_s"], np.inf
    arm = [(LINKS[item.link], item.body.pieces[0]) for item in scene.robot.bodies]
    assert {link for link, _ in arm} == set(LINKS)
    for t in np.linspace(knots[0], knots[-1], INSTANTS):
        frames, placed = dict(zip(LINKS, chain(path(t)), strict=True)), []
        for link, piece in arm:
            at = frames[link]
            pose = fcl.Transform(at[:3, :3] @ piece.rotation, at[:3, :3] @ piece.position + at[:3, 3])
            placed.append((link, fcl.CollisionObject(solid(piece), pose)))
        for body in scene.bodies:
            motion = scene.frames[body.frame].law.motion(np.array(t)).at(body.pose)
            yaw, piece = about(2, float(motion.yaw))[:3, :3], body.body.pieces[0]
            pose = fcl.Transform(yaw @ piece.rotation, yaw @ piece.position + motion.p)
            other = fcl.CollisionObject(solid(piece), pose)
            closest = min(closest, *(gap(one, other) for _, one in placed))
        for i, (first, one) in enumerate(placed):
            for second, other in placed[i + 1 :]:
                if (first, second) in scene.robot.self_pairs:
                    closest = min(closest, gap(one, other))
    assert closest >= scene.options.clearance.near_m - 1e-6
    assert answer()["margins"]["nearest"]["gap_m"] <= closest + 1e-4


def gap(one: Any, other: Any) -> float:
    return float(fcl.distance(one, other, fcl.DistanceRequest(), fcl.DistanceResult()))


def test_the_gate_is_in_the_way() -> None:
    free = changed(lambda r: r.update(bodies=[body for body in r["bodies"] if body["name"] != "bar"]))
    quicker = plan_document(free)
    assert quicker["trajectory"]["time_s"][-1] < answer()["trajectory"]["time_s"][-1]
    assert any("bar" in line["bodies"] for line in answer()["census"]["lines"])


def changed(change: Any) -> Document:
    request = copy.deepcopy(shipped("rv-m1").request)
    change(request)
    return request


def second(request: Document) -> Document:
    target: Document = request["task"][1]["move"]["to"]
    return target


@pytest.mark.parametrize(("key", "amount"), [("pitch_rad", 1e-4), ("roll_rad", -1e-4)])
@pytest.mark.parametrize("step", [0, 1])
def test_an_answer_that_says_another_attitude_is_refused(key: str, amount: float, step: int) -> None:
    forged = copy.deepcopy(answer())
    forged["arrivals"][step][key] += amount
    verdict = check_document(shipped("rv-m1").request, forged)
    assert verdict["ok"] is False
    assert "ARRIVAL" in {finding["code"] for finding in verdict["findings"]}


def test_an_answer_for_another_pitch_than_the_request_asks_is_refused() -> None:
    other = changed(lambda r: r["task"][0]["follow"]["to"].update(pitch_rad=-math.pi / 2 + 1e-4, pitch_deg=None))
    del other["task"][0]["follow"]["to"]["pitch_deg"]
    verdict = check_document(other, answer())
    assert {"ARRIVAL", "DIGEST"} <= {finding["code"] for finding in verdict["findings"]}


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
    assert np.allclose(chain(q)[-1][:3, 3], [0.28, 0.1, 0.25], atol=1e-9)
    assert q[1] + q[2] + q[3] == pytest.approx(math.radians(-60), abs=1e-9)
    assert via["missed_by"]["distance_m"] > 1e-3
    other = check_document(blends(-60.01), made)
    assert "ARRIVAL" in {finding["code"] for finding in other["findings"]}
    for key in ("pitch_rad", "roll_rad"):
        forged = copy.deepcopy(made)
        forged["arrivals"][0][key] += 1e-4
        assert "ARRIVAL" in {finding["code"] for finding in check_document(blends(), forged)["findings"]}


@cache
def proof() -> tuple[Scene, Plan]:
    scene = scene_of(shipped("rv-m1").request)
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    return scene, outcome.plan


def forged(**columns: Any) -> set[Code]:
    """What the checker finds when columns of the proof are others and its digest fits."""
    scene, honest = proof()
    changed = replace(honest.certificate, **columns)
    parts = (scene.digest, honest.trajectory, honest.legs, honest.arrivals, changed)
    verdict = check(scene, replace(honest, certificate=replace(changed, digest=digest(*parts))))
    return {finding.code for finding in verdict.findings}


def test_a_proof_that_looks_elsewhere_or_too_shortly_is_none() -> None:
    honest = proof()[1].certificate
    assert forged() == set()
    assert forged(normal=-honest.normal) == {Code.SEPARATION, Code.COVER}
    assert forged(t1=(honest.t0 + honest.t1) / 2) == {Code.COVER}


@pytest.mark.parametrize(("link", "thicker"), [(LINK4, 0.05), (FLANGE, 0.02)])
def test_a_proof_for_a_smaller_hand_or_flange_is_none_for_this_one(link: int, thicker: float) -> None:
    """The body so much thicker on each side, m, that it comes too near; 20 mm more of link 4 would still be clear."""
    scene, honest = proof()
    number = next(i for i, item in enumerate(scene.robot.bodies) if item.link == link)
    body = scene.robot.bodies[number]
    piece = body.body.pieces[0]
    assert isinstance(piece.shape, Primitive)
    shape = box(*(2 * (h + thicker) for h in piece.shape.half))
    bodies = list(scene.robot.bodies)
    bodies[number] = replace(body, body=Body(body.body.name, (replace(piece, shape=shape),)))
    robot: Any = scene.robot
    other = replace(scene, robot=replace(robot, bodies=tuple(bodies)))
    assert Code.SEPARATION in {finding.code for finding in check(other, honest).findings}


def test_free_and_silent_are_one_request_and_a_number_is_another() -> None:
    silent = changed(lambda r: second(r).pop("pitch_deg"))
    both = changed(lambda r: second(r).update(roll_deg="free"))
    assert scene_of(silent).digest == scene_of(both).digest == answer()["request_digest"]
    asked = changed(lambda r: second(r).update(pitch_deg=-60))
    assert scene_of(asked).digest != scene_of(silent).digest


def test_a_target_too_far_away_is_refused_with_what_is_missing() -> None:
    """600 mm away and 100 mm up, against arm and hand of 482 mm."""
    far = plan_document(changed(lambda r: r.update(task=[{"move": {"name": "far", "to": {"at_mm": [600, 0, 400]}}}])))
    assert (far["status"], far["reason"], far["proved"]) == ("not_planned", "OUT_OF_REACH", True)
    short = math.hypot(0.6, 0.1) - 0.482
    assert far["refusal"]["amount"] == pytest.approx(short, abs=1e-12)
    assert far["sentence"] == f"far: the point is {amount(short, 'm')} out of reach at every pitch of the tool."


def test_a_target_that_the_hand_reaches_only_stretched_out_is_refused_straight_down() -> None:
    at = {"at_mm": [460, 0, 300]}
    down = plan_document(changed(lambda r: r.update(task=[{"move": {"name": "far", "to": {**at, "pitch_deg": -90}}}])))
    assert (down["status"], down["reason"], down["proved"]) == ("not_planned", "OUT_OF_REACH", True)
    assert "at a pitch of -90 deg" in down["sentence"]
    free = plan_document(changed(lambda r: r.update(task=[{"move": {"to": at}}], bodies=[])))
    assert free["status"] == "planned", free


def test_a_straight_leg_is_straight_and_carries_the_pitch_along() -> None:
    request = changed(lambda r: r.update(bodies=[body for body in r["bodies"] if body["name"] == "part"]))
    request["task"][1]["move"]["leg"] = "cartesian"
    second(request).update(pitch_deg=-60, roll_deg=0)
    found = plan_document(request)
    assert found["status"] == "planned", found
    assert check_document(request, found)["ok"] is True
    leg, path = found["legs"][-1], path_of(found)
    assert leg["note"] == "straight"
    begin, middle, end = (chain(path(t))[-1] for t in (leg["from_s"], leg["from_s"] + 0.4, leg["to_s"]))
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
        scene_of(changed(change))


def test_every_number_that_nobody_vouches_for_is_told_with_the_plan() -> None:
    told = "\n".join(answer()["assumptions"])
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

    robot = scene_of(changed(longer)).robot
    assert isinstance(robot, FiveAxisArm)
    assert robot.l3 == pytest.approx(0.172)
    found = plan_document(changed(longer))
    assert found["status"] == "planned", found
    assert check_document(changed(longer), found)["ok"] is True
