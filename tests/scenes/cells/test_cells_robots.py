"""Cells of the other robots: elbow arm, polar arm, R-P-R-R, tool frame z down; and what these arms are not asked.

What an answer says is held against `tests.scenes.cells.second_kinematics`: SciPy's quintic through the knots,
transforms multiplied there, and FCL's distances at many instants.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.errors import InputError
from assur.planner.geometry.shapes import Body, Primitive, box
from assur.planner.robots.five_axis_arm import FLANGE, LINK4
from assur.scenes.exports.documents import check_trajectory_document, export_document
from assur.scenes.requests import check_document, plan_document, scene_of
from assur.scenes.scenarios import shipped
from tests.scenes.cells.second_kinematics import Array, answer, chain, changed, closest, forged, path_of, proof

NAMES = ("elbow-arm", "polar-arm", "lab-arm", "z-down", "rv-m1")
TILTING = ("elbow-arm", "polar-arm", "rv-m1")


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
    arrival, path = answer(name)["arrivals"][step], path_of(answer(name))
    for t in np.linspace(arrival["time_s"], arrival["until_s"], 7):
        around = [chain(name, path(t + k * 1e-4))["flange"] @ np.array([*tcp, 1.0]) for k in (-1, 0, 1)]
        assert np.abs(around[1][:3] - where(t)).max() < 1e-5
        if arrival["time_s"] + 1e-3 < t < arrival["until_s"] - 1e-3:
            v = (around[2] - around[0])[:3] / 2e-4
            assert np.abs(v - (where(t + 1e-4) - where(t - 1e-4)) / 2e-4).max() < 1e-3


def on_dial(centre: tuple[float, float, float], radius: float, rate_deg_s: float, t: float) -> Array:
    angle = math.radians(rate_deg_s) * t
    return np.array(centre) + radius * np.array([math.cos(angle), math.sin(angle), 0.0])


@pytest.mark.parametrize("name", TILTING)
def test_no_link_comes_nearer_to_anything_than_was_asked(name: str) -> None:
    least = closest(name)
    assert least >= scene_of(shipped(name).request).options.clearance.near_m - 1e-6
    assert answer(name)["margins"]["nearest"]["gap_m"] <= least + 1e-4


@pytest.mark.parametrize("name", ["elbow-arm", "rv-m1"])
def test_the_gate_is_in_the_way(name: str) -> None:
    free = changed(name, lambda r: r.update(bodies=[body for body in r["bodies"] if body["name"] != "bar"]))
    quicker = plan_document(free)
    assert quicker["trajectory"]["time_s"][-1] < answer(name)["trajectory"]["time_s"][-1]
    file = export_document(free, quicker, {"format": "csv", "jerk": "report", "tick_ms": 1.0})["file"]
    judged = check_trajectory_document(changed(name), {"file": file, "format": "csv", "jerk": "report"})
    assert judged["ok"] is False
    assert "bar" in judged["first"]["bodies"]


@pytest.mark.parametrize("name", ["elbow-arm", "polar-arm"])
def test_a_straight_leg_of_an_arm_without_a_lift_is_straight(name: str) -> None:
    request = changed(name)
    request["bodies"] = [body for body in request["bodies"] if body["name"] == "part"]
    request["task"][1]["move"]["leg"] = "cartesian"
    found = plan_document(request)
    assert found["status"] == "planned", found
    assert check_document(request, found)["ok"] is True
    leg = found["legs"][-1]
    assert leg["note"] == "straight"
    goal = chain(name, path_of(found)(leg["to_s"]))["flange"][:3, 3]
    assert np.abs(goal - np.array(request["task"][1]["move"]["to"]["at_mm"]) / 1000).max() < 1e-6


PICK = {"part": "part", "grasp_mm": [0, 0, 0], "approach": {"mm": 1}, "dwell_ms": 1, "depart": {"mm": 1}}


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
        scene_of(changed("elbow-arm", change))


def test_a_neighbour_has_to_stay_upright() -> None:
    request = changed("z-down")
    knots = answer("elbow-arm")["trajectory"]
    robot = {"model": "elbow-arm", "tool": {"tcp_mm": [0, 0, 0]}, "base": {"at_mm": [2000, 0, 0]}}
    keys = ("joint_names", "joint_units", "time_s", "position", "velocity", "acceleration")
    request["neighbours"] = [{"name": "other", "robot": robot, "trajectory": {key: knots[key] for key in keys}}]
    with pytest.raises(InputError, match="links stay upright"):
        scene_of(request)


def test_beyond_the_elbow_arms_reach_nothing_is_planned() -> None:
    found = plan_document(changed("elbow-arm", lambda r: r["task"][1]["move"]["to"].update(at_mm=[600, 0, 300])))
    assert found["status"] != "planned"


@pytest.mark.parametrize("name", NAMES)
def test_a_proof_that_looks_elsewhere_or_too_shortly_is_none(name: str) -> None:
    honest = proof(name)[1].certificate
    assert forged(name) == set()
    assert forged(name, normal=-honest.normal) == {Code.ROW}
    assert forged(name, t1=(honest.t0 + honest.t1) / 2) == {Code.COVER}


@pytest.mark.parametrize(
    ("name", "link", "thicker"),
    [("elbow-arm", None, 0.02), ("polar-arm", None, 0.02), ("rv-m1", LINK4, 0.05), ("rv-m1", FLANGE, 0.02)],
)
def test_a_proof_for_smaller_links_is_none_for_these(name: str, link: int | None, thicker: float) -> None:
    """The last link, or the one given, so much thicker on each side, m, that it comes too near."""
    scene, honest = proof(name)
    bodies = list(scene.robot.bodies)
    number = len(bodies) - 1 if link is None else [item.link for item in bodies].index(link)
    piece = bodies[number].body.pieces[0]
    assert isinstance(piece.shape, Primitive)
    thick = replace(piece, shape=box(*(2 * (h + thicker) for h in piece.shape.half)))
    bodies[number] = replace(bodies[number], body=Body(bodies[number].body.name, (thick,)))
    robot: Any = scene.robot
    other = replace(scene, robot=replace(robot, bodies=tuple(bodies)))
    assert Code.ROW in {finding.code for finding in check(other, honest).findings}
