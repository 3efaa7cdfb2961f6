"""Working modes and assembly modes of a five-bar in plans: how the one changes, that the other never does, and what the
checker says to plans that are forged so that they do otherwise."""

from __future__ import annotations

import copy
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from assur.experiments.five_bar_workspace import velocity_equation
from assur.planner.arrays import FloatArray
from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.model.outcome import Plan
from assur.planner.robots.five_bar import FiveBar
from assur.planner.trajectory import Trajectory
from assur.scenes.reading.plan import plan_of
from assur.scenes.requests import cell_of, check_document, plan_document, shipped
from tests.scenes.cells.answers import codes, resealed

Answer = dict[str, Any]
OTHER_MM = (300, 130, 100)
"""A place that `left-left` reaches, and `left-right` as well: the right arm has to be stretched on the way."""


def request(**changes: Any) -> Answer:
    found = copy.deepcopy(shipped("five-bar-type-2").request)
    found["task"] = [{"move": {"to": {"at_mm": list(OTHER_MM)}, "name": "there", **changes}}]
    found["options"].update(elbow="left-left", max_candidates=300)
    return found


@cache
def changed() -> tuple[Answer, Answer]:
    asked = request()
    return asked, plan_document(asked)


def the_plan(asked: Answer, found: Answer) -> tuple[FiveBar, Plan]:
    cell = cell_of(asked)
    robot = cell.scene.robot
    assert isinstance(robot, FiveBar)
    return robot, plan_of(found, cell.conventions)[0]


def along(plan: Plan, many: int = 4_001) -> tuple[FloatArray, FloatArray]:
    t = np.linspace(plan.trajectory.start, plan.trajectory.end, many)
    return t, plan.trajectory.evaluate(t)


def test_a_joint_leg_changes_the_working_mode_where_it_crosses_type_1() -> None:
    asked, found = changed()
    assert found["status"] == "planned"
    assert check_document(asked, found)["ok"] is True
    robot, plan = the_plan(asked, found)
    t, q = along(plan)
    modes = robot.mode_of(q)
    at = np.flatnonzero(np.diff(modes))
    assert [robot.modes[modes[i]] for i in (0, -1)] == ["left-right", "left-left"]
    assert len(at) == 1
    inside = [leg for leg in plan.legs if leg.t0 <= t[at[0]] <= leg.t1]
    assert [leg.kind for leg in inside] == ["MOVE"]
    # type 1: the right arm stretched, the left arm and the couplers far from it; det B changes its sign, det A keeps it
    direct, inverse = velocity_equation(robot, q)
    assert robot.margin(q)[at[0]] < 1e-2
    assert np.flatnonzero(np.diff(np.sign(inverse[:, 1, 1]))).tolist() == at.tolist()
    assert (inverse[:, 0, 0] * inverse[0, 0, 0] > 0).all()
    assert (np.linalg.det(direct) < 0).all()
    assert robot.parallel_margin(q).min() >= robot.parallel_least


def test_a_straight_leg_does_not_change_the_working_mode() -> None:
    found = plan_document(request(leg="cartesian"))
    assert (found["status"], found["reason"]) == ("not_planned", "NEAR_SINGULARITY")
    assert "a straight leg cannot change from mode left-right to left-left" in found["sentence"]


def test_a_plan_that_keeps_its_working_mode_never_crosses_type_1() -> None:
    asked = request()
    asked["options"]["elbow"] = "keep"
    found = plan_document(asked)
    assert found["status"] == "planned"
    robot, plan = the_plan(asked, found)
    assert set(robot.mode_of(along(plan)[1]).tolist()) == {robot.modes.index("left-right")}


def forged(plan: Plan, knots: tuple[FloatArray, FloatArray, FloatArray, FloatArray]) -> Plan:
    return replace(plan, trajectory=Trajectory(*knots))


def test_a_plan_for_the_machine_put_together_the_other_way_round_is_refused() -> None:
    """Its cranks do the same, its tool is elsewhere: the assembly mode is the robot's, and no plan's."""
    asked, found = changed()
    behind = copy.deepcopy(asked)
    behind["robot"]["five_bar"]["assembly"] = "back"
    findings = codes(behind, the_plan(asked, found)[1])
    assert Code.DIGEST not in findings
    assert Code.ARRIVAL in findings


@pytest.mark.parametrize("certified", [True, False], ids=["with its certificate", "without one"])
def test_a_forged_plan_that_leaves_its_assembly_mode_and_comes_back_is_refused(*, certified: bool) -> None:
    """Both cranks turn outwards until the elbows are too far apart for the couplers, and back again."""
    asked, found = changed()
    robot, plan = the_plan(asked, found)
    knots = plan.trajectory
    turn = np.array([[0.0, 0.0, 0.0, 0.0], [0.6, -1.4, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0]])
    q = knots.q[0] + turn
    assert np.isnan(robot.parallel_margin(q)).tolist() == [False, True, False]
    t = knots.time[0] + np.array([0.0, 2.0, 4.0])
    t = np.concatenate([t, t[-1] + 0.5 + knots.time[1:] - knots.time[0]])
    none = np.zeros((3, 4))
    q = np.concatenate([q, knots.q[1:]])
    qd, qdd = np.concatenate([none, knots.qd[1:]]), np.concatenate([none, knots.qdd[1:]])
    made = forged(plan, (t, q, qd, qdd))
    later = t[-1] - knots.time[-1]
    legs = (*(replace(leg, t0=leg.t0 + later, t1=leg.t1 + later) for leg in plan.legs),)
    arrivals = (*(replace(one, time=one.time + later, until=one.until + later) for one in plan.arrivals),)
    made = replace(made, legs=(replace(legs[0], t0=float(t[0])), *legs[1:]), arrivals=arrivals)
    if not certified:
        c = plan.certificate
        columns = {name: getattr(c, name) for name in c.__dataclass_fields__}
        kept = {name: column[:0] for name, column in columns.items() if isinstance(column, np.ndarray)}
        none_left: dict[str, Any] = dict(kept)
        made = replace(made, certificate=replace(c, **none_left))
    findings = codes(asked, made)
    assert Code.LEGS not in findings
    assert {Code.ROW, Code.COVER} & {*findings}


# Links of one robot against each other.

CROSSED_MM = (300, 0, 100)
"""In `left-left` both cranks would have to be at about the same place."""


def crossed(**changes: Any) -> Answer:
    asked = request()
    asked["task"][0]["move"]["to"]["at_mm"] = list(CROSSED_MM)
    asked["options"]["seed"] = 3  # with others the way that comes furthest may end at a singularity
    asked["robot"]["five_bar"].update(changes)
    return asked


def test_the_cranks_of_one_robot_may_not_meet() -> None:
    found = plan_document(crossed())
    assert (found["status"], found["reason"]) == ("not_planned", "SELF_COLLISION")
    assert "crank-left would hit crank-right" in found["sentence"]


def test_a_plan_in_which_they_meet_is_refused_by_the_checker() -> None:
    """Made for a robot of which nothing is asked about the cranks; of them it proves nothing."""
    cranks, pairs = ["proximal-left", "proximal-right"], crossed()["robot"]["five_bar"]["self_pairs"]
    careless = crossed(self_pairs=[pair for pair in pairs if pair != cranks])
    found = plan_document(careless)
    assert found["status"] == "planned"
    _, plan = the_plan(careless, found)
    asked = crossed()
    findings = check(cell_of(asked).scene, resealed(asked, plan)).findings
    assert {finding.code for finding in findings} == {Code.COVER}
    told = " ".join(f"{finding.what} {finding.where}" for finding in findings)
    assert "crank-left" in told, told
    assert "crank-right" in told
