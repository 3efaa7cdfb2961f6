"""Five-bars that a request writes out: lengths, heights, joints, links, and what is refused at its field."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.planner.report.number_format import amount
from assur.planner.robots.five_bar import FiveBar
from assur.scenes.requests import plan_document, scene_of, shipped


def request(**changes: Any) -> dict[str, Any]:
    """The request of the cell, with fields of its arm changed (None: left out)."""
    found = copy.deepcopy(shipped("five-bar-type-2").request)
    arm = found["robot"]["five_bar"]
    arm.update(changes)
    for key in [key for key, value in changes.items() if value is None]:
        del arm[key]
    return found


def robot_of(document: dict[str, Any]) -> FiveBar:
    robot = scene_of(document).robot
    assert isinstance(robot, FiveBar)
    return robot


def test_couplers_that_cannot_meet_at_the_start_are_bad_input() -> None:
    for distal, words in (([30, 30], "60.0 mm long together"), ([900, 30], "900 mm and 30 mm long")):
        with pytest.raises(InputError) as caught:
            scene_of(request(distal_mm=distal))
        assert caught.value.field == "start.joints"
        assert "the chain closes; the elbows are" in caught.value.allowed
        assert words in caught.value.allowed


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
    assert robot_of(request(parallel_margin=None)).parallel_least == 0.1


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


@pytest.mark.parametrize(
    ("field", "changes"),
    [
        ("five_bar.separation_m", {"separation_mm": -1}),
        ("five_bar.separation_m", {"separation_mm": None}),
        ("five_bar.proximal_m", {"proximal_mm": [200]}),
        ("five_bar.distal_m", {"distal_mm": [160, 0]}),
        ("five_bar.assembly", {"assembly": "inside"}),
        ("five_bar.parallel_margin", {"parallel_margin": 0}),
        ("five_bar.joints", {"joints": []}),
        ("five_bar.self_pairs", {"self_pairs": [["base", "link1"]]}),
        ("five_bar.l1_m", {"l1_m": 0.2}),
        ("robot", {"separation_mm": 900}),
    ],
)
def test_what_is_no_five_bar_is_refused_at_its_field(field: str, changes: dict[str, Any]) -> None:
    with pytest.raises(InputError) as caught:
        scene_of(request(**changes))
    assert field in caught.value.field.replace("_mm", "_m")


def test_a_crank_that_lifts_is_refused_in_the_words_of_a_five_bar() -> None:
    document = request()
    joints = document["robot"]["five_bar"]["joints"]
    joints[0] = {**joints[2], "name": "j1"}
    with pytest.raises(InputError, match="joint 1 of a five-bar is revolute"):
        scene_of(document)


def test_an_elbow_that_a_five_bar_has_not_is_refused_with_those_that_it_has() -> None:
    document = request()
    document["options"]["elbow"] = "left"
    with pytest.raises(InputError, match="left-right, right-left"):
        scene_of(document)
