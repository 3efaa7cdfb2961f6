"""Ranges of yaw in which the tool may not be: planned around, proved to be in the way, refused by the checker."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner.checker import Code
from assur.planner.errors import InputError
from assur.planner.legs.forbidden_yaw import tool_yaw
from assur.planner.model.scene import Start
from assur.scenes.reading.plan import plan_of
from assur.scenes.reading.robots import equipped
from assur.scenes.requests import cell_of, shipped
from assur.scenes.schema.read import read
from assur.scenes.schema.robots import RobotDocument
from tests.changed import changed
from tests.scenes.cells import answers
from tests.scenes.cells.answers import Document, not_planned, planned

START = {"joints": {"j1_deg": -40, "j2_deg": 80, "j3_mm": 250, "j4_deg": 100}}
"""The tool has a yaw of 140°."""
BAND = [200, 240]
"""Between the yaw of the first goal and the short way to that of the second."""
LAG = {"lag": {"j1_deg": 0.5, "j2_deg": 0.5, "j3_mm": 0, "j4_deg": 1}}
"""The tool may be 2° beside its yaw."""


def cell(*ranges: Sequence[float], second: float = -90, **more: object) -> Document:
    """Two moves of an arm, from a yaw of 140° over 170° to -90°, which is 270°."""
    return {
        "schema": "assur/1",
        "robot": {
            "model": "mitsubishi-rh-6frh5520",
            "tool": {"tcp_mm": [30, 0, -100]},
            "limits": {"forbidden_yaw_deg": list(ranges)} if ranges else {},
        },
        "start": START,
        "task": [
            {"move": {"to": {"at_mm": [350, 150, 150], "yaw_deg": 170}}},
            {"move": {"to": {"at_mm": [350, -150, 150], "yaw_deg": second}}},
        ],
        "options": {"stop": "budget", "max_candidates": 60, "budget_s": 60, "seed": 1},
        **more,
    }


def refused(request: Document) -> Document:
    answer = not_planned(request)
    assert answer["reason"] == "FORBIDDEN_YAW"
    return answer


def yaws(request: Document, answer: Document) -> Any:
    """Yaw of the tool in the world, degrees from 0 to 360, at 2000 instants, by the robot's forward kinematics."""
    scene = cell_of(request).scene
    plan, _ = plan_of(answer, cell_of(request).conventions)
    times = np.linspace(plan.trajectory.start, plan.trajectory.end, 2000)
    return np.degrees(scene.robot.forward(plan.trajectory.evaluate(times))[1] + scene.tool.tcp.yaw) % 360.0


def crosses(found: Any, first: float, last: float) -> bool:
    return bool(((found > first) & (found < last)).any())


def codes(request: Document, answer: Document) -> list[Code]:
    """The findings about a plan that was made for another request."""
    return answers.codes(request, plan_of(answer, cell_of(request).conventions)[0])


@pytest.fixture(scope="module")
def free() -> Document:
    """The plan without ranges."""
    return planned(cell())


@pytest.fixture(scope="module")
def round_it() -> Document:
    """The plan with a range in the short way."""
    return planned(cell(BAND))


def test_the_tool_turns_the_other_way_round_a_forbidden_range(free: Document, round_it: Document) -> None:
    assert crosses(yaws(cell(), free), *BAND)
    assert not crosses(yaws(cell(BAND), round_it), *BAND)


def test_a_plan_that_was_made_without_the_range_is_refused_by_the_checker(free: Document, round_it: Document) -> None:
    assert codes(cell(BAND), free) == [Code.DIRECTION]
    assert codes(cell(BAND), round_it) == []


@pytest.mark.parametrize("turn", [-360, 0, 360])
def test_a_range_holds_whatever_the_full_turns(free: Document, turn: int) -> None:
    ends = [end + turn for end in BAND]
    if all(-360 <= end <= 360 for end in ends):
        assert codes(cell(ends), free) == [Code.DIRECTION]
    else:
        with pytest.raises(InputError):
            cell_of(cell(ends))


def test_a_range_goes_counter_clockwise_from_its_first_end(free: Document) -> None:
    """[240, 200] is all but the 40° between: the tool is in it from the start on."""
    assert refused(cell([240, 200]))["proved"]
    assert codes(cell([240, 200]), free) == [Code.DIRECTION]


def test_a_narrow_range_is_found_between_the_knots(free: Document) -> None:
    """0.2° are passed in a millisecond."""
    assert codes(cell([219.9, 220.1]), free) == [Code.DIRECTION]
    assert codes(cell([300, 300.2], [100, 100.2]), free) == []


def test_a_start_in_a_forbidden_range_is_proved_before_any_search(free: Document) -> None:
    answer = refused(cell([130, 150]))
    assert (answer["proved"], answer["census"]["candidates"]) == (True, 0)
    assert (answer["refusal"]["stage"], answer["refusal"]["facts"]["kind"]) == ("start", "forbidden_yaw")
    assert math.degrees(answer["refusal"]["amount"]) == pytest.approx(10, abs=1e-3)
    assert (
        "the yaw of the tool at the start is 140 deg, in the forbidden range from 130 deg to 150 deg"
        in answer["sentence"]
    )
    assert codes(cell([130, 150]), free) == [Code.DIRECTION]


def test_a_fixed_goal_with_a_forbidden_yaw_is_proved_before_any_search(free: Document) -> None:
    answer = refused(cell([-100, -80]))
    assert (answer["proved"], answer["census"]["candidates"], answer["refusal"]["step"]) == (True, 0, 1)
    assert "the yaw of the tool would be -90 deg, in the forbidden range from -100 deg to -80 deg" in answer["sentence"]
    assert codes(cell([-100, -80]), free) == [Code.DIRECTION]


def test_a_yaw_between_two_ranges_that_cannot_be_left_is_refused() -> None:
    """From 140° neither way leads to -90°."""
    assert refused(cell(BAND, [0, 20]))["refusal"]["facts"]["on_the_way"]


def test_a_free_yaw_and_one_that_is_kept_stay_outside() -> None:
    for yaw in ({"yaw_free": True}, {"yaw_keep": True}):
        request = cell([100, 139], [171, 200])
        request["options"]["seed"] = 2
        request["task"][1]["move"]["to"] = {"at_mm": [350, -150, 150], **yaw}
        found = yaws(request, planned(request))
        assert not crosses(found, 100, 139)
        assert not crosses(found, 171, 200)


def test_joints_that_lag_widen_a_range_by_their_sum() -> None:
    """The first goal is 1.5° beside the range; the tool may be 2° beside its yaw."""
    near = [171.5, 172.5]
    without = planned(cell(near, second=160))
    answer = refused(cell(near, second=160, execution=LAG))
    assert answer["proved"]
    assert "from 171.5 deg to 172.5 deg (2 deg wider at both ends, for joints that lag)" in answer["sentence"]
    # an arrival's error, which the other request knows nothing of, is a finding that comes first
    assert set(codes(cell(near, second=160, execution=LAG), without)) == {Code.ARRIVAL}
    late = planned(cell([172.5, 173.5], second=160, execution=LAG))
    assert codes(cell(near, second=160, execution=LAG), late) == [Code.DIRECTION]


@pytest.mark.parametrize("model", ["mitsubishi-rv-m1", "oviedo-scara", "elbow-arm"])
def test_an_arm_without_a_yaw_of_its_own_refuses_the_field(model: str) -> None:
    request = changed(cell(BAND), {"robot.model": model})
    with pytest.raises(InputError) as caught:
        cell_of(request)
    assert caught.value.field.startswith("robot.limits.forbidden_yaw")
    assert "no wrist" in caught.value.allowed


def test_ranges_that_leave_no_yaw_are_refused_with_the_lags_too() -> None:
    """0.5° and 1° are free between the ranges, which a lag of 2° closes."""
    tight = [[0, 179.5], [180.5, 359.5]]
    cell_of(cell(*tight))
    with pytest.raises(InputError, match="leave a yaw free"):
        cell_of(cell(*tight, execution=LAG))
    with pytest.raises(InputError, match="leave a yaw free"):
        cell_of(cell([0, 200], [180, 10]))


SCARAS = ["mitsubishi-rh-6frh5520", "fanuc-sr-3ia", "lab-scara", "olier-scara", "fiuba-scara"]


@pytest.mark.parametrize("model", SCARAS)
def test_the_yaw_of_every_scara_is_that_of_its_forward_kinematics(model: str) -> None:
    """The planner adds up joints 1, 2 and 4, the third lifts; the base is turned, and so is the tool point."""
    robot = {"model": model, "base": {"at_mm": [100, 50, 20], "yaw_deg": 37}, "tool": {"tcp_mm": [30, 0, -100]}}
    arm = equipped(read(RobotDocument, robot))
    assert [joint.kind for joint in arm.robot.joints] == ["revolute", "revolute", "prismatic", "revolute"]
    lower, upper = arm.robot.limits.lower, arm.robot.limits.upper
    scene, none = cell_of(cell()).scene, np.zeros(4)
    tool = replace(arm.tool, tcp=replace(arm.tool.tcp, yaw=0.4))
    scene = replace(scene, robot=arm.robot, tool=tool, start=Start(0.0, (lower + upper) / 2, none, none))
    q = np.random.default_rng(1).uniform(lower, upper, (200, 4))
    off = tool_yaw(scene, q) - arm.robot.forward(q)[1] - 0.4
    assert np.abs(np.sin(off / 2.0)).max() < 1e-12


def five_bar(*ranges: Sequence[float]) -> Document:
    limits = {"acceleration": 0.7, **({"forbidden_yaw_deg": list(ranges)} if ranges else {})}
    few = {"options.max_candidates": 60, "options.budget_s": 60}
    made: Document = changed(shipped("five-bar").request, {"robot.limits": limits, **few})
    return made


def test_the_yaw_of_a_five_bar_is_proved_between_its_knots() -> None:
    without = planned(five_bar())
    found = yaws(five_bar(), without)
    low, high = float(found.min()), float(found.max())
    assert 10 < low < high < 350
    # just beside what is passed: nothing changes; a part of what is passed: the plan is refused
    assert codes(five_bar([high + 0.5, high + 5.0]), without) == []
    middle = (low + high) / 2.0
    assert codes(five_bar([middle - 0.1, middle + 0.1]), without) == [Code.DIRECTION]
    assert planned(five_bar([high + 0.5, high + 5.0]))["duration_s"] <= without["duration_s"] * 1.1


def test_a_five_bar_whose_arms_lag_refuses_the_field() -> None:
    request = five_bar([100, 120])
    request["execution"] = {"lag": {"j1_deg": 0.1, "j2_deg": 0, "j3_mm": 0, "j4_deg": 0}}
    with pytest.raises(InputError, match="known for SCARAs only"):
        cell_of(request)
