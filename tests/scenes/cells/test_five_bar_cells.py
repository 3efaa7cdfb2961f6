"""The five-bar's cells: what they expect, what must be true of their answers, and tampered plans that are refused."""

from __future__ import annotations

import copy
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from assur.planner.checker import Code
from assur.planner.errors import InputError
from assur.planner.model.link_frames import link_law
from assur.planner.robots.five_bar import FiveBar
from assur.planner.trajectory import Trajectory
from assur.scenes.reading.plan import plan_of
from assur.scenes.requests import cell_of, check_document, plan_document, shipped
from tests.scenes.cells.answers import answer, codes

Answer = dict[str, Any]


@cache
def around() -> tuple[Answer, Answer]:
    """Request and answer of the ends of the forbidden line, joined by a joint leg."""
    request = copy.deepcopy(shipped("five-bar-type-2").request)
    del request["task"][0]["move"]["leg"]
    request["options"] |= {"max_candidates": 300, "report": "full"}
    return request, plan_document(request)


def test_the_line_through_type_2_is_refused_with_its_margin() -> None:
    found = answer("five-bar-type-2")
    assert found["reason"] == "NEAR_PARALLEL_SINGULARITY"
    assert found["refusal"]["stage"] == "straight"
    assert found["refusal"]["amount"] > 0.1  # more than the least margin: the line goes on behind the curve


def test_a_target_inside_the_type_2_curve_is_proved_to_be_impossible() -> None:
    request = copy.deepcopy(shipped("five-bar-type-2").request)
    request["task"] = [{"move": {"to": {"at_mm": [120, 0, 70], "yaw_deg": 0}}}]
    found = plan_document(request)
    assert (found["status"], found["reason"], found["proved"]) == ("not_planned", "NEAR_PARALLEL_SINGULARITY", True)


def test_the_same_ends_are_joined_by_a_joint_leg_that_goes_around_the_curve() -> None:
    request, found = around()
    assert found["status"] == "planned"
    assert check_document(request, found)["ok"] is True
    robot = cell_of(request).scene.robot
    assert isinstance(robot, FiveBar)
    plan = plan_of(found, cell_of(request).conventions)[0]
    q = plan.trajectory.evaluate(np.linspace(plan.trajectory.start, plan.trajectory.end, 2_000))
    assert (robot.parallel_margin(q) >= robot.parallel_least).all()


def test_a_start_too_near_to_type_2_is_refused_at_once() -> None:
    request, _ = around()
    request = copy.deepcopy(request)
    request["start"]["joints"].update(j1_deg=35.95, j2_deg=-35.95)
    found = plan_document(request)
    assert (found["reason"], found["proved"]) == ("NEAR_PARALLEL_SINGULARITY", True)
    assert found["refusal"]["stage"] == "start"


# Tampered plans.


def test_a_plan_that_goes_straight_through_type_2_in_joint_space_is_refused_for_that() -> None:
    """Both ends of the right plan, joined directly: the chain would have to come apart on the way."""
    request, found = around()
    plan = plan_of(found, cell_of(request).conventions)[0]
    knots, ends = plan.trajectory, [0, -1]
    direct = Trajectory(knots.time[ends], knots.q[ends], knots.qd[ends], knots.qdd[ends])
    findings = codes(request, replace(plan, trajectory=direct))
    assert Code.ROW in findings
    assert Code.DIGEST not in findings


def test_a_robot_that_asks_for_more_margin_refuses_the_same_plan() -> None:
    request, found = around()
    least = found["margins"]["parallel"]
    strict = copy.deepcopy(request)
    strict["robot"]["five_bar"]["parallel_margin"] = least + 0.02
    assert codes(strict, plan_of(found, cell_of(strict).conventions)[0]) == [Code.ROW]


def test_a_neighbour_that_would_come_apart_is_bad_input() -> None:
    robot = cell_of(shipped("five-bar-type-2").request).scene.robot
    q = np.array([[1.8, 0.4, 0.1, 0.0], [-0.4, -1.8, 0.1, 0.0]])
    with pytest.raises(InputError, match="stays assembled"):
        link_law(robot, Trajectory(np.array([0.0, 1.0]), q, 0 * q, 0 * q), 2)
