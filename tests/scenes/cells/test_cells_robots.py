"""Scenarios of the other robots: elbow arm, polar arm, R-P-R-R, tool frame z down; and what these arms are not asked.

What an answer says is held against a second kinematics: SciPy's quintic through the knots, transforms multiplied here,
and FCL's distances at many instants.
"""

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
from assur.scenes.requests import check_document, plan_document, plan_scenario, scene_of
from assur.scenes.scenarios import shipped, unmet

Array = NDArray[np.float64]
Document = dict[str, Any]
NAMES = ("elbow-arm", "polar-arm", "lab-arm", "z-down")
INSTANTS = 600


@cache
def answer(name: str) -> Document:
    return plan_scenario(shipped(name))


def joints(name: str) -> BPoly:
    knots = answer(name)["trajectory"]
    states = np.stack([np.array(knots[key]) for key in ("position", "velocity", "acceleration")], axis=1)
    return BPoly.from_derivatives(np.array(knots["time_s"]), states)


def turn(axis: str, angle: float) -> Array:
    c, s = math.cos(angle), math.sin(angle)
    if axis == "z":
        return np.array([[c, -s, 0.0, 0.0], [s, c, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    return np.array([[c, 0.0, s, 0.0], [0.0, 1.0, 0.0, 0.0], [-s, 0.0, c, 0.0], [0.0, 0.0, 0.0, 1.0]])


def shift(x: float, y: float, z: float) -> Array:
    found = np.eye(4)
    found[:3, 3] = x, y, z
    return found


def chain(name: str, q: Array) -> dict[str, Array]:
    """Link frames as transforms, from the maker's joint values and the numbers of the catalogue."""
    if name == "elbow-arm":
        turret = shift(0, 0, 0.3) @ turn("z", q[0])
        upper = turret @ turn("y", -q[1])
        fore = upper @ shift(0.25, 0, 0) @ turn("y", -q[2])
        return {"base": np.eye(4), "link1": turret, "link2": upper, "link3": fore, "flange": fore @ shift(0.232, 0, 0)}
    if name == "polar-arm":
        turret = shift(0, 0, 0.4) @ turn("z", q[0])
        guide = turret @ turn("y", -q[1])
        ram = guide @ shift(q[2], 0, 0)
        return {"base": np.eye(4), "link1": turret, "link2": guide, "link3": ram, "flange": ram}
    if name == "lab-arm":
        column = turn("z", q[0]) @ shift(0, 0, q[1])
        second = column @ shift(0.22, 0, 0) @ turn("z", q[2])
        return {"flange": second @ shift(0.2, 0, 0) @ turn("z", q[3])}
    second = turn("z", q[0]) @ shift(0.25, 0, 0) @ turn("z", q[1])
    return {"flange": second @ shift(0.2, 0, 0.3 - q[2]) @ turn("z", -q[3]) @ np.diag([1.0, -1.0, -1.0, 1.0])}


@pytest.mark.parametrize("name", NAMES)
def test_the_cell_is_planned_as_it_expects_and_checked(name: str) -> None:
    scenario = shipped(name)
    assert unmet(scenario.expect, answer(name)) == []
    verdict = check_document(scenario.request, answer(name), folder=scenario.folder)
    assert verdict["ok"] is True, verdict


@pytest.mark.parametrize(
    ("name", "step", "tcp", "where"),
    [
        ("elbow-arm", 0, (0, 0, 0), lambda t: np.array([0.33, 0.15 * t - 0.25, 0.04 + 0.02 + 0.045])),
        ("polar-arm", 0, (0, 0, 0), lambda t: on_dial((0.48, -0.12, 0.25), 0.09, 45.0, t)),
        ("lab-arm", 0, (0, 0, -0.06), lambda t: on_dial((0.25, -0.18, 0.12 + 0.082), 0.06, 30.0, t)),
        ("lab-arm", 1, (0, 0, -0.06), lambda t: np.array([0.2 + 0.0 * t, 0.26, 0.142])),
        ("z-down", 0, (0, 0, 0.08), lambda t: np.array([-0.2 + 0.2 * t, 0.3, 0.08])),
        ("z-down", 1, (0, 0, 0.08), lambda t: on_dial((0.28, -0.12, 0.08), 0.07, 40.0, t)),
    ],
)
def test_the_tool_is_at_its_control_point_and_has_its_velocity(name: str, step: int, tcp: Any, where: Any) -> None:
    arrival, path = answer(name)["arrivals"][step], joints(name)
    for t in np.linspace(arrival["time_s"], arrival["until_s"], 7):
        around = [chain(name, path(t + k * 1e-4))["flange"] @ np.array([*tcp, 1.0]) for k in (-1, 0, 1)]
        assert np.abs(around[1][:3] - where(t)).max() < 1e-5
        if arrival["time_s"] + 1e-3 < t < arrival["until_s"] - 1e-3:
            v = (around[2] - around[0])[:3] / 2e-4
            assert np.abs(v - (where(t + 1e-4) - where(t - 1e-4)) / 2e-4).max() < 1e-3


def on_dial(centre: tuple[float, float, float], radius: float, rate_deg_s: float, t: float) -> Array:
    angle = math.radians(rate_deg_s) * t
    return np.array(centre) + radius * np.array([math.cos(angle), math.sin(angle), 0.0])


def solid(piece: Any) -> Any:
    x, y, z = (2 * h for h in piece.shape.half)
    if piece.shape.kind == "box":
        return fcl.Box(x, y, z)
    return fcl.Cylinder(piece.shape.disc, z) if piece.shape.kind == "cylinder" else fcl.Capsule(piece.shape.ball, z)


@pytest.mark.parametrize("name", ["elbow-arm", "polar-arm"])
def test_no_link_comes_nearer_to_anything_than_was_asked(name: str) -> None:
    scene, path = scene_of(shipped(name).request), joints(name)
    near = scene.options.clearance.near_m
    knots = answer(name)["trajectory"]["time_s"]
    arm = [(scene.robot.links[item.link], item.body.pieces[0]) for item in scene.robot.bodies]
    closest = np.inf
    for t in np.linspace(knots[0], knots[-1], INSTANTS):
        frames, placed = chain(name, path(t)), []
        for link, piece in arm:
            at = frames[link]
            pose = fcl.Transform(at[:3, :3] @ piece.rotation, at[:3, :3] @ piece.position + at[:3, 3])
            placed.append((link, fcl.CollisionObject(solid(piece), pose)))
        for body in scene.bodies:
            motion = scene.frames[body.frame].law.motion(np.array(t)).at(body.pose)
            yaw, piece = turn("z", float(motion.yaw))[:3, :3], body.body.pieces[0]
            pose = fcl.Transform(yaw @ piece.rotation, yaw @ piece.position + motion.p)
            other = fcl.CollisionObject(solid(piece), pose)
            closest = min(closest, *(gap(one, other) for _, one in placed))
        for i, (first, one) in enumerate(placed):
            for second, other in placed[i + 1 :]:
                if (first, second) in scene.robot.self_pairs:
                    closest = min(closest, gap(one, other))
    assert closest >= near - 1e-6
    assert answer(name)["margins"]["nearest"]["gap_m"] <= closest + 1e-4


def gap(one: Any, other: Any) -> float:
    return float(fcl.distance(one, other, fcl.DistanceRequest(), fcl.DistanceResult()))


def test_the_gate_is_in_the_way_of_the_elbow_arm() -> None:
    free = copy.deepcopy(shipped("elbow-arm").request)
    free["bodies"] = [body for body in free["bodies"] if body["name"] != "bar"]
    quicker = plan_document(free)
    assert quicker["trajectory"]["time_s"][-1] < answer("elbow-arm")["trajectory"]["time_s"][-1]
    assert any("bar" in line["bodies"] for line in answer("elbow-arm")["census"]["lines"])


@pytest.mark.parametrize("name", ["elbow-arm", "polar-arm"])
def test_a_straight_leg_of_an_arm_without_a_lift_is_straight(name: str) -> None:
    request = copy.deepcopy(shipped(name).request)
    request["bodies"] = [body for body in request["bodies"] if body["name"] == "part"]
    request["task"][1]["move"]["leg"] = "cartesian"
    found = plan_document(request)
    assert found["status"] == "planned", found
    assert check_document(request, found)["ok"] is True
    leg = found["legs"][-1]
    assert leg["note"] == "straight"
    knots = found["trajectory"]
    states = np.stack([np.array(knots[key]) for key in ("position", "velocity", "acceleration")], axis=1)
    path = BPoly.from_derivatives(np.array(knots["time_s"]), states)
    goal = chain(name, path(leg["to_s"]))["flange"][:3, 3]
    assert np.abs(goal - np.array(request["task"][1]["move"]["to"]["at_mm"]) / 1000).max() < 1e-6


PICK = {"part": "part", "grasp_mm": [0, 0, 0], "approach": {"mm": 1}, "dwell_ms": 1, "depart": {"mm": 1}}


def spoiled(change: Any) -> Document:
    request = copy.deepcopy(shipped("elbow-arm").request)
    change(request)
    return request


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (lambda r: r["robot"]["tool"].update(tcp_mm=[0, 0, -50]), "tilts"),
        (lambda r: r["task"][1]["move"].update(arch={"top_mm": 500}), "no joint that lifts"),
        (lambda r: r["task"][0]["follow"]["to"].update(yaw_deg=10), "no yaw"),
        (lambda r: r["robot"].update(model="polar-arm"), "joints"),
        (lambda r: r.update(task=[{"pick": PICK}]), "no wrist"),
    ],
)
def test_what_an_arm_whose_flange_tilts_cannot_do_is_refused_in_words(change: Any, match: str) -> None:
    with pytest.raises(InputError, match=match):
        scene_of(spoiled(change))


def test_a_neighbour_has_to_stay_upright() -> None:
    request = copy.deepcopy(shipped("z-down").request)
    knots = answer("elbow-arm")["trajectory"]
    robot = {"model": "elbow-arm", "tool": {"tcp_mm": [0, 0, 0]}, "base": {"at_mm": [2000, 0, 0]}}
    keys = ("joint_names", "joint_units", "time_s", "position", "velocity", "acceleration")
    request["neighbours"] = [{"name": "other", "robot": robot, "trajectory": {key: knots[key] for key in keys}}]
    with pytest.raises(InputError, match="links stay upright"):
        scene_of(request)


def test_beyond_the_elbow_arms_reach_nothing_is_planned() -> None:
    found = plan_document(spoiled(lambda r: r["task"][1]["move"]["to"].update(at_mm=[600, 0, 300])))
    assert found["status"] != "planned"


@cache
def proof(name: str) -> tuple[Scene, Plan]:
    scene = scene_of(shipped(name).request)
    outcome = plan(scene)
    assert isinstance(outcome, Planned)
    return scene, outcome.plan


def forged(name: str, **columns: Any) -> set[Code]:
    """What the checker finds when columns of the proof are others and its digest fits; false rows cover nothing."""
    scene, honest = proof(name)
    changed = replace(honest.certificate, **columns)
    parts = (scene.digest, honest.trajectory, honest.legs, honest.arrivals, changed)
    verdict = check(scene, replace(honest, certificate=replace(changed, digest=digest(*parts))))
    return {finding.code for finding in verdict.findings}


@pytest.mark.parametrize("name", NAMES)
def test_a_proof_that_looks_elsewhere_or_too_shortly_is_none(name: str) -> None:
    honest = proof(name)[1].certificate
    assert forged(name) == set()
    assert forged(name, normal=-honest.normal) == {Code.SEPARATION, Code.COVER}
    assert forged(name, t1=(honest.t0 + honest.t1) / 2) == {Code.COVER}


@pytest.mark.parametrize("name", ["elbow-arm", "polar-arm"])
def test_a_proof_for_smaller_links_is_none_for_these(name: str) -> None:
    """The last link 20 mm thicker than it was proved for."""
    scene, honest = proof(name)
    last = scene.robot.bodies[-1]
    piece = last.body.pieces[0]
    assert isinstance(piece.shape, Primitive)
    thick = replace(piece, shape=box(*(2 * h + 0.04 for h in piece.shape.half)))
    bodies = (*scene.robot.bodies[:-1], replace(last, body=Body(last.body.name, (thick,))))
    robot: Any = scene.robot
    other = replace(scene, robot=replace(robot, bodies=bodies))
    assert Code.SEPARATION in {finding.code for finding in check(other, honest).findings}
