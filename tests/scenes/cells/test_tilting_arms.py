"""Cells of the other robots: elbow arm, polar arm, R-P-R-R, tool frame z down; and what these arms are not asked."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.geometry.shapes import Body, Primitive, box
from assur.planner.robots.five_axis_arm import FLANGE, LINK4
from assur.scenes.exports.documents import check_trajectory_document, export_document
from assur.scenes.requests import check_document, plan_document
from assur.scenes.scenarios import shipped
from benchmarks.judge.product import as_si
from benchmarks.judge.promises import broken_promises
from tests.changed import changed
from tests.scenes.bad_requests import Bad
from tests.scenes.cells.answers import Document, answer, forged, not_planned, proof

NAMES = ("elbow-arm", "polar-arm", "lab-arm", "z-down", "rv-m1", "five-bar")


@pytest.mark.parametrize("name", ["elbow-arm", "rv-m1"])
def test_the_gate_is_in_the_way(name: str) -> None:
    request = shipped(name).request
    free = {**request, "bodies": [body for body in request["bodies"] if body["name"] != "bar"]}
    quicker = plan_document(free)
    assert quicker["trajectory"]["time_s"][-1] < answer(name)["trajectory"]["time_s"][-1]
    file = export_document(free, quicker, {"format": "csv", "jerk": "report", "tick_ms": 1.0})["file"]
    judged = check_trajectory_document(request, {"file": file, "format": "csv", "jerk": "report"})
    assert judged["ok"] is False
    assert "bar" in judged["first"]["bodies"]


@pytest.mark.parametrize(
    ("name", "attitude"),
    [("elbow-arm", {}), ("polar-arm", {}), ("rv-m1", {"pitch_deg": -60, "roll_deg": 0})],
)
def test_a_straight_leg_of_an_arm_without_a_lift_is_straight_and_carries_the_pitch_along(
    name: str, attitude: Document
) -> None:
    request = changed(
        shipped(name).request,
        {"task[1].move.leg": "cartesian", "options.report": "full"}
        | {f"task[1].move.to.{key}": value for key, value in attitude.items()},
    )
    request["bodies"] = [body for body in request["bodies"] if body["name"] == "part"]
    found = plan_document(request)
    assert found["status"] == "planned", found
    assert check_document(request, found)["ok"] is True
    assert found["legs"][-1]["note"] == "straight"
    assert broken_promises(as_si(request), found) == []


PICK = {"part": "part", "grasp_mm": [0, 0, 0], "approach": {"mm": 1}, "dwell_ms": 1, "depart": {"mm": 1}}
ELBOW, RV_M1, UPRIGHT = (shipped(name).request for name in ("elbow-arm", "rv-m1", "z-down"))
BESIDE = {
    "name": "other",
    "robot": {"model": "elbow-arm", "tool": {"tcp_mm": [0, 0, 0]}, "base": {"at_mm": [2000, 0, 0]}},
    "trajectory": {
        "joint_names": ["theta1", "theta2", "theta3"],
        "joint_units": ["rad"] * 3,
        "time_s": [0.0, 1.0],
        **{key: [[0.0] * 3] * 2 for key in ("position", "velocity", "acceleration")},
    },
}
BAD: tuple[Bad, ...] = (
    Bad("a long tool", {"robot.tool.tcp_mm": [0, 0, -50]}, said="tilts", on=ELBOW),
    Bad("an arch", {"task[1].move.arch": {"top_mm": 500}}, said="no joint that lifts", on=ELBOW),
    Bad("a yaw", {"task[0].follow.to.yaw_deg": 10}, said="no yaw", on=ELBOW),
    Bad("joints of another arm", {"robot.model": "rv-m1"}, said="mitsubishi-rv-m1", on=ELBOW),
    Bad("a pick", {"task": [{"pick": PICK}]}, "[0].pick", "no wrist", on=ELBOW),
    Bad("a long tool of five axes", {"robot.tool.tcp_mm": [50, 0, 0]}, said="of mitsubishi-rv-m1 tilts", on=RV_M1),
    Bad("an arch of five axes", {"task[1].move.arch": {"top_mm": 500}}, said="no joint that lifts", on=RV_M1),
    Bad("a yaw of five axes", {"task[1].move.to.yaw_deg": 10}, said="heading follows from the position", on=RV_M1),
    Bad("a pick of five axes", {"task": [{"pick": PICK}]}, "[0].pick", "turns and tilts its tool", on=RV_M1),
    Bad(
        "a yaw of a grasp of five axes",
        {"task": [{"pick": {**PICK, "grasp_yaw_deg": 3}}]},
        "[0].pick.grasp_yaw_deg",
        "heading follows from the position",
        on=RV_M1,
    ),
    Bad("a pitch in words", {"task[1].move.to.pitch_deg": "down"}, said="free, or a number", on=RV_M1),
    Bad("a neighbour that tilts", {"neighbours": [BESIDE]}, "[0].robot", "links stay upright", on=UPRIGHT),
)


@pytest.mark.parametrize("bad", BAD, ids=lambda bad: bad.name)
def test_what_an_arm_whose_flange_tilts_cannot_do_is_refused_in_words(bad: Bad) -> None:
    bad.refused()


def test_beyond_the_elbow_arms_reach_it_is_proved_that_nothing_can_be_planned() -> None:
    request = changed(ELBOW, {"task[1].move.to.at_mm": [600, 0, 300]})
    found = not_planned(request)
    assert (found["reason"], found["proved"]) == ("OUT_OF_REACH", True)
    assert check_document(request, found)["ok"]


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
