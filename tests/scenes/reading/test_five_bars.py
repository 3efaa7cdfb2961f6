"""Five-bars that a request writes out: lengths, heights, joints, links, and what is refused at its field."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner.report.number_format import amount
from assur.planner.robots.five_bar import FiveBar
from assur.scenes.requests import plan_document, scene_of, shipped
from tests.changed import GONE, changed
from tests.scenes.bad_requests import Bad

CELL = shipped("five-bar-type-2").request
ARM = "robot.five_bar"


def request(**changes: Any) -> dict[str, Any]:
    """The request of the cell, with fields of its arm changed."""
    made: dict[str, Any] = changed(CELL, {f"{ARM}.{key}": value for key, value in changes.items()})
    return made


def robot_of(document: dict[str, Any]) -> FiveBar:
    robot = scene_of(document).robot
    assert isinstance(robot, FiveBar)
    return robot


def test_without_a_lift_another_height_is_refused_by_the_two_heights() -> None:
    document = request(height_mm=250)
    arm = document["robot"]["five_bar"]
    arm["joints"] = [joint for joint in arm["joints"] if "range_mm" not in joint][:2]
    arm["bodies"], arm["self_pairs"], document["bodies"], document["frames"] = [], [], [], {}
    document["robot"]["tool"] = {"tcp_mm": [0, 0, 0]}
    names = [joint["name"] for joint in arm["joints"]]
    kept = {key: value for key, value in document["start"]["joints"].items() if key.rsplit("_", 1)[0] in names}
    document["start"]["joints"] = kept
    document["options"] = {"budget_s": 60, "max_candidates": 20}
    here = scene_of({**document, "task": [{"move": {"to": {"at_mm": [0, 0, 0]}}}]})
    x, y, z = (1e3 * value for value in here.robot.forward(here.start.q)[0])
    answer = plan_document({**document, "task": [{"move": {"to": {"at_mm": [x, y, z + 20]}}}]})
    assert (answer["reason"], answer["proved"]) == ("OUT_OF_REACH", True)
    assert "20 mm out of reach: the flange would have to be at a height of " in answer["sentence"]
    assert f"but it stays at {amount(z / 1e3, 'm')}" in answer["sentence"]


def test_a_five_bar_is_what_the_request_says() -> None:
    robot = robot_of(request(proximal_mm=[190, 200], distal_mm=[160, 170], parallel_margin=0.2))
    assert (robot.separation, robot.proximal, robot.distal) == (0.085, (0.19, 0.2), (0.16, 0.17))
    assert (robot.assembly, robot.parallel_least, robot.axes) == ("front", 0.2, 4)
    assert [robot.links[body.link] for body in robot.bodies] == [
        "base",
        "proximal-left",
        "proximal-right",
        "distal-left",
        "distal-right",
        "quill",
    ]
    assert robot_of(request()).parallel_least == 0.1


def test_without_a_lift_the_flange_has_the_height_that_is_told() -> None:
    document = request(height_mm=150)
    arm = document["robot"]["five_bar"]
    arm["joints"] = arm["joints"][:2]
    del document["start"]["joints"]["j3_mm"], document["start"]["joints"]["j4_deg"]
    robot = robot_of(document)
    assert (robot.axes, robot.coordinates) == (2, ("x", "y"))
    p, _ = robot.placements(np.array([0.5, -0.5]))
    assert p[-1, 2] == pytest.approx(0.15)
    # bodies keep their heights above the mounting face
    crank = robot.bodies[1].body.pieces[0]
    assert p[1, 2] + crank.position[2] == pytest.approx(0.18)


NO_MEETING = "the chain closes; the elbows are"
BAD = (
    Bad("axes that are apart by less than nothing", {f"{ARM}.separation_mm": -1}),
    Bad("axes that are apart by nothing stated", {f"{ARM}.separation_mm": GONE}, f"{ARM}.separation_m"),
    Bad("one crank", {f"{ARM}.proximal_mm": [200]}),
    Bad("a coupler of no length", {f"{ARM}.distal_mm": [160, 0]}, "[1]"),
    Bad("an unknown assembly", {f"{ARM}.assembly": "inside"}),
    Bad("no margin", {f"{ARM}.parallel_margin": 0}),
    Bad("no joints", {f"{ARM}.joints": []}),
    Bad(
        "a pair of links of another family",
        {f"{ARM}.self_pairs": [["base", "link1"]]},
        "[0]",
        "two of base, proximal-left",
    ),
    Bad("a length of another family", {f"{ARM}.l1_m": 0.2}),
    Bad("axes that are too far apart", {f"{ARM}.separation_mm": 900}, "robot", "the links can span"),
    Bad("couplers that are too short", {f"{ARM}.distal_mm": [30, 30]}, "start.joints", "60.0 mm long together"),
    Bad("couplers that are too unlike", {f"{ARM}.distal_mm": [900, 30]}, "start.joints", "900 mm and 30 mm long"),
    Bad("couplers that do not meet", {f"{ARM}.distal_mm": [30, 30]}, "start.joints", NO_MEETING),
    Bad(
        "a crank that lifts",
        {f"{ARM}.joints[0]": {**CELL["robot"]["five_bar"]["joints"][2], "name": "j1"}},
        f"{ARM}.joints[0].range_mm",
        "joint 1 of a five-bar is revolute",
    ),
    Bad("an elbow of another family", {"options.elbow": "left"}, said="left-right, right-left"),
)


@pytest.mark.parametrize("bad", BAD, ids=lambda bad: bad.name)
def test_what_is_no_five_bar_is_refused_at_its_field(bad: Bad) -> None:
    replace(bad, on=CELL).refused()
