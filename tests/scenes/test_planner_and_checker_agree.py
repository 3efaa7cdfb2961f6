"""What the planner proves, the checker accepts: arms without a yaw, and moves that are flown by, of every family.

A line of the census of stage `checker` is a fault of the planner: no search here has one.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from assur.planner.checker.statement.joints import BESIDE_S, WAY
from assur.scenes.requests import cell_of, check_document, plan_document
from benchmarks.checker_refusals import codes_of

Document = dict[str, Any]


def _joint(name: str, low: float, high: float, v: float, a: float, j: float) -> Document:
    return {
        "name": name, "range_rad": [low, high], "velocity_rad_s": v, "acceleration_rad_s2": a, "jerk_rad_s3": j
    }  # fmt: skip


def _lift(low: float, high: float) -> Document:
    return {"name": "j3", "range_m": [low, high], "velocity_m_s": 1.0, "acceleration_m_s2": 15, "jerk_m_s3": 800}


BASE, UPPER = _joint("j1", -2.6, 2.6, 3.5, 30, 1500), _joint("j2", -2.0, 0.4, 2.8, 25, 1250) | {"sign": -1}
FORE = _joint("j3", -2.4, -0.05, 3.5, 30, 1500)
PLANAR = [BASE, _joint("j2", -2.5, 2.5, 3.5, 30, 1500), _lift(0.1, 0.4)]
CRANKS = [_joint("j1", -0.9, 3.3, 6.0, 90, 4000), _joint("j2", -3.3, 0.9, 6.0, 90, 4000)]
NO_YAW = {
    "elbow": (
        {"elbow_arm": {"height_m": 0.3, "l1_m": 0.29, "l2_m": 0.26, "joints": [BASE, UPPER, FORE]}},
        {"j1_rad": -0.26, "j2_rad": -0.59, "j3_rad": -1.66},
        ([0.3, 0.1, 0.4], [0.1, 0.35, 0.3], [0.25, -0.2, 0.35]),
    ),
    "five-axis": (
        {"five_axis_arm": {"height_m": 0.3, "l1_m": 0.212, "l2_m": 0.24, "l3_m": 0.108, "joints": [
            BASE, UPPER, FORE, _joint("j4", -1.8, 1.8, 4, 40, 2000), _joint("j5", -3.1, 3.1, 5, 60, 3000)]}},
        {"j1_rad": -0.764, "j2_rad": -1.145, "j3_rad": -1.514, "j4_rad": 0.301, "j5_rad": -0.162},
        ([0.362, -0.106, 0.545], [0.07, -0.23, 0.767], [0.107, 0.455, 0.235]),
    ),
    "five-bar": (
        {"five_bar": {"separation_m": 0.085, "proximal_m": [0.2, 0.2], "distal_m": [0.26, 0.26], "assembly": "front",
                      "height_m": 0.1, "joints": CRANKS}},
        {"j1_rad": 0.87, "j2_rad": -0.87},
        ([0.3, 0.05, 0.1], [0.25, -0.05, 0.1], [0.28, 0.0, 0.1]),
    ),
    "three-axis SCARA": (
        {"scara": {"l1_m": 0.325, "l2_m": 0.225, "joints": PLANAR}},
        {"j1_rad": 0.0, "j2_rad": 1.0, "j3_m": 0.25},
        ([0.3, 0.25, 0.2], [0.35, 0.0, 0.3], [0.1, 0.4, 0.2]),
    ),
}  # fmt: skip
WITH_YAW = {
    "four-axis SCARA": (
        {"scara": {"l1_m": 0.325, "l2_m": 0.225, "joints": [*PLANAR, _joint("j4", -6.2, 6.2, 20, 200, 4000)]}},
        {"j1_rad": 0.0, "j2_rad": 1.0, "j3_m": 0.25, "j4_rad": 0.0},
        ([0.3, 0.25, 0.2], [0.35, 0.0, 0.3], [0.1, 0.4, 0.2]),
    ),
}
FAMILIES = {**NO_YAW, **WITH_YAW}


def request(family: str, task: list[Document], **more: Any) -> Document:
    """A request to an arm of a family, without solids."""
    arm, joints, _ = FAMILIES[family]
    (key, facts), = arm.items()  # fmt: skip
    robot = {key: facts | {"bodies": [], "self_pairs": []}, "tool": {"tcp_m": [0, 0, 0]}}
    options = {"stop": "first", "max_candidates": 60, "budget_s": 60, "elbow": "auto"} | more.pop("options", {})
    return {"schema": "assur/1", "robot": robot, "start": {"joints": joints}, "task": task, "options": options, **more}


def move(at: list[float], **more: Any) -> Document:
    return {"move": {"to": {"at_m": at}, **more}}


def agreed(asked: Document) -> Document:
    """The answer, against which the checker has nothing, nor had against any plan of the search."""
    answer: Document = dict(plan_document(asked))
    assert codes_of(answer, check_document(asked, answer)["findings"]) == [], answer.get("sentence")
    return answer


@pytest.mark.parametrize("family", FAMILIES)
def test_an_arm_flies_by_its_vias_or_all_its_joints_turn_round(family: str) -> None:
    points = FAMILIES[family][2]
    orders = [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)]
    planned = 0
    for order in orders:
        first, second, last = (list(points[k]) for k in order)
        answer = agreed(request(family, [move(first, via=True), move(second, via=True), move(last)]))
        planned += answer["status"] == "planned"
        if answer["status"] == "planned":
            for arrival in answer["arrivals"][:2]:
                assert not stopped(answer, arrival["time_s"])
    assert planned >= 4, family


def stopped(answer: Document, t: float) -> bool:
    """Whether the arm is at rest at a knot at this time although a joint goes on in its direction."""
    given = answer["trajectory"]
    time, q, qd = (np.array(given[key]) for key in ("time_s", "position", "velocity"))
    at = int(np.abs(time - t).argmin())
    assert abs(time[at] - t) < 1e-9
    if np.abs(qd[at]).max() > 1e-6:
        return False
    before, behind = (
        np.array([np.interp(t + beside, time, q[:, joint]) for joint in range(q.shape[1])])
        for beside in (-BESIDE_S, BESIDE_S)
    )
    came, goes = q[at] - before, behind - q[at]
    return bool(((np.minimum(abs(came), abs(goes)) > WAY) & (came * goes > 0)).any())


def test_the_five_axis_arm_that_stopped_at_its_via() -> None:
    task = [move([0.362, -0.106, 0.545], via=True), move([0.07, -0.23, 0.767]),
            {"move": {"to": {"at_m": [0.107, 0.455, 0.235], "pitch_rad": -0.397}}}]  # fmt: skip
    asked = request("five-axis", task)
    asked["options"] = {}
    agreed(asked)


@pytest.mark.parametrize("family", NO_YAW)
def test_an_arm_without_a_yaw_is_never_turned(family: str) -> None:
    """Its first candidates are in the way of a post: those that follow are not turned either."""
    points = FAMILIES[family][2]
    middle = [(a + b) / 2 for a, b in zip(points[0], points[1], strict=True)]
    post = {"name": "post", "shape": {"cylinder": {"radius_m": 0.02, "height_m": 0.1}}, "pose": {"at_m": middle}}
    for seed in range(3):
        task = [move(points[0]), move(points[1]), {"follow": {"to": {"at_m": points[2]}, "duration_s": 0.1}}]
        answer = agreed(request(family, task, bodies=[post], options={"seed": seed}))
        for arrival in answer.get("arrivals", ()):
            assert math.remainder(arrival["yaw_offset_rad"], math.tau) == 0.0


def test_the_elbow_arm_before_a_gate_that_was_turned() -> None:
    asked = request(
        "elbow",
        [{"follow": {"to": {"at_m": [0.22, -0.44, 0.35]}, "duration_s": 0.11}}, move([0.16, -0.32, 0.54])],
        frames={"gate": {"swing": {"pivot_m": [0.29, -0.24, 0.37], "amplitude_rad": 0.69, "period_s": 2.26}}},
        bodies=[{"name": "on-gate", "shape": {"cylinder": {"radius_m": 0.03, "height_m": 0.02}},
                 "pose": {"frame": "gate", "at_m": [0, -0.04, 0]}}],
        options={"seed": 2411, "max_candidates": 40},
    )  # fmt: skip
    arm = asked["robot"]["elbow_arm"]
    fore = {"name": "fore", "link": "link3", "shape": {"capsule": {"radius_m": 0.02, "length_m": 0.2, "axis": "x"}},
            "at_m": [0.13, 0, 0]}  # fmt: skip
    asked["robot"]["elbow_arm"] = arm | {"bodies": [fore]}
    asked["robot"]["base"] = {"at_m": [0.02, -0.06, 0.04]}
    asked["start"]["at_s"] = 0.97
    del asked["options"]["stop"], asked["options"]["elbow"], asked["options"]["budget_s"]
    agreed(asked)


def test_a_plan_for_a_turned_tool_is_refused_where_an_arm_has_no_yaw() -> None:
    """The guard that found it."""
    asked = request("elbow", [move([0.3, 0.1, 0.4])])
    answer = agreed(asked)
    answer["arrivals"][0]["yaw_offset_rad"] = math.pi / 6
    codes = {each["code"] for each in check_document(asked, answer)["findings"]}
    assert "ARRIVAL" in codes
    assert cell_of(asked).scene.robot.coordinates == ("x", "y", "z")
