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
from assur.planner.model.digest import digest
from assur.planner.model.outcome import Plan
from assur.planner.robots.five_bar import FiveBar
from assur.planner.trajectory import Trajectory
from assur.scenes.reading.plan import plan_of
from assur.scenes.requests import cell_of, check_document, plan_document, shipped
from tests.scenes.cells.five_bar_plans import resealed

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


def test_a_forged_plan_that_jumps_into_another_working_mode_is_refused() -> None:
    """The tool stays where it is, the right crank is on the other side a microsecond later."""
    asked, found = changed()
    robot, plan = the_plan(asked, found)
    knots = plan.trajectory
    there = robot.mode_of(knots.q)
    last = int(np.flatnonzero(there == there[0])[-1])
    p, yaw = robot.forward(knots.q[-1:])
    # the end of the plan in the mode of its start, and a microsecond later in its own
    still = robot.link_motion(robot.links.index("flange"), knots.q[-1:], *(np.zeros((1, 4)),) * 3)
    other = robot.inverse(still, int(there[0]), 0).q
    other[:, 3] += 2 * np.pi * np.round((knots.q[-1:, 3] - other[:, 3]) / (2 * np.pi))
    assert np.abs(robot.forward(other)[0] - p).max() < 1e-9
    assert np.abs(np.exp(1j * (robot.forward(other)[1] - yaw)) - 1).max() < 1e-9
    t = np.concatenate([knots.time[: last + 1], [knots.time[-1] - 1e-6, knots.time[-1]]])
    q = np.concatenate([knots.q[: last + 1], other, knots.q[-1:]])
    none = np.zeros((2, 4))
    qd = np.concatenate([knots.qd[: last + 1], none])
    qdd = np.concatenate([knots.qdd[: last + 1], none])
    cell = cell_of(asked)
    verdict = check(cell.scene, resealed(asked, forged(plan, (t, q, qd, qdd))))
    codes = {finding.code for finding in verdict.findings}
    assert Code.LIMIT in codes
    assert Code.DIGEST not in codes


def test_a_plan_for_the_machine_put_together_the_other_way_round_is_refused() -> None:
    """Its cranks do the same, its tool is elsewhere: the assembly mode is the robot's, and no plan's."""
    asked, found = changed()
    behind = copy.deepcopy(asked)
    behind["robot"]["five_bar"]["assembly"] = "back"
    plan = resealed(behind, the_plan(asked, found)[1])
    findings = check(cell_of(behind).scene, plan).findings
    assert Code.DIGEST not in {finding.code for finding in findings}
    assert Code.ARRIVAL in {finding.code for finding in findings}


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
    verdict = check(cell_of(asked).scene, resealed(asked, made))
    assert Code.LEGS not in {finding.code for finding in verdict.findings}
    assert {Code.ROW, Code.COVER} & {finding.code for finding in verdict.findings}


def test_the_digest_of_a_plan_that_is_changed_is_another() -> None:
    """What `resealed` is for: without it the tests above would show no more than that."""
    asked, found = changed()
    scene, plan = cell_of(asked).scene, the_plan(asked, found)[1]
    other = replace(plan, arrivals=())
    seal = digest(scene.digest, other.trajectory, other.legs, other.arrivals, other.certificate)
    assert seal != plan.certificate.digest
    assert Code.DIGEST in {finding.code for finding in check(scene, other).findings}


# Links of one robot against each other.

CROSSED_MM = (300, 0, 100)
"""In `left-left` both cranks would have to be at about the same place."""


def crossed(**changes: Any) -> Answer:
    asked = request()
    asked["task"][0]["move"]["to"]["at_mm"] = list(CROSSED_MM)
    asked["options"]["seed"] = 0  # with others the way that comes furthest may end at a singularity
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
