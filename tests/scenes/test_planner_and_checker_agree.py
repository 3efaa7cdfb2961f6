"""What the planner proves, the checker accepts: arms without a yaw, and moves that are flown by, of every family.

A line of the census of stage `checker` is a fault of the planner: no search here has one.
"""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pytest

from assur.planner.checker.statement.joints import BESIDE_S, WAY
from assur.scenes.requests import cell_of, check_document, plan_document
from benchmarks.checker_refusals import codes_of
from tests.scenes.cells.answers import findings_of

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
    options = {"stop": "first", "max_candidates": 60, "budget_s": 60, "elbow": "auto", "report": "full"}
    options |= more.pop("options", {})
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
    codes = findings_of(asked, answer)
    assert "ARRIVAL" in codes
    assert cell_of(asked).scene.robot.coordinates == ("x", "y", "z")


def test_the_peak_of_a_five_bar_near_the_edge_of_its_reach() -> None:
    """Bounds of a closed loop round its acceleration by most of what a peak may be off at its instant."""
    robot = {"model": "mitsubishi-rp-5ah", "tool": {"tcp_m": [0.0, 0.0, -0.025]}}
    joints = {"j1_rad": 0.5057149525077078, "j2_rad": -0.6042824685483593, "j3_m": 0.0950952676500108,
              "j4_rad": -0.010798768505105933}  # fmt: skip
    goal = {"at_m": [0.05831636114666705, -0.12326142898673302, 0.035], "yaw_rad": -1.6566503445902563}
    asked: Document = {
        "schema": "assur/1", "robot": robot, "start": {"joints": joints}, "task": [{"move": {"to": goal}}],
        "options": {"seed": 26, "budget_s": 60, "max_candidates": 1, "stop": "first", "elbow": "auto", "report": "full",
                    "singularity_margin": 0.0},
    }  # fmt: skip
    answer = agreed(asked)
    for share in (0.999, 1.001):
        wrong = copy.deepcopy(answer)
        wrong["margins"]["tool"]["acceleration_m_s2"] *= share
        assert "RATE" in findings_of(asked, wrong)


def test_the_peak_of_a_five_bar_whose_couplers_are_nearly_stretched() -> None:
    """Bounds of its acceleration are 0.02 % of it."""
    asked = request(
        "five-bar",
        [
            move([0.262290091294961, 0.012276054569912407, 0.1], via=True),
            move([0.2532227955934378, -0.0589396321096774, 0.1]),
            move([0.2804928613034429, 0.019455977152977155, 0.1]),
        ],
        options={"max_candidates": 12, "seed": 544},
    )
    asked["robot"] = copy.deepcopy(asked["robot"])
    first, second = asked["robot"]["five_bar"]["joints"]
    first |= {"velocity_rad_s": 6000.0, "acceleration_rad_s2": 90000.0, "jerk_rad_s3": 4000.0}
    second |= {"velocity_rad_s": 6.0, "acceleration_rad_s2": 90000.0, "jerk_rad_s3": 276.3979438122845}
    answer = agreed(asked)
    assert answer["status"] == "planned"
    answer["margins"]["tool"]["acceleration_m_s2"] *= 1.001
    assert "RATE" in findings_of(asked, answer)


def test_a_neighbour_that_may_start_late_needs_few_rows() -> None:
    """How far it is ahead was halved twelve times where its time had to be: more rows than the checker evaluates."""
    tolerance, at, base = 0.009740278632485869, 34290.471744081355, [0.4449925364705781, -0.3772476736992115, -0.434]
    task = [
        {"move": {"to": {"at_m": [0.08555357471108502, -0.22266002327170192, -0.5711], "yaw_free": True}, "via": True}},
        {"move": {"to": {"at_m": [0.05155063172427035, -0.3054069523255666, -0.6155], "yaw_rad": -3.0282545929479405}}},
    ]
    position = [[-0.22561328474076645, 0.9153887581251855, 0.13899577522641418, 3.1250505342177592],
                [0.47271733742130284, 1.2064388405744546, 0.18066336146217732, 1.7342041612750918],
                [0.2787272688731496, -1.133471202491422, 0.19756120495805282, -1.3219014167356975]]  # fmt: skip
    rest = [[0.0] * 4] * 3
    neighbour = {
        "name": "other", "start_uncertainty_s": 0.0181508361107226,
        "robot": {"model": "benchmark-scara", "tool": {"tcp_m": [0.0, 0.0, 0.0]},
                  "base": {"at_m": [0.8056520028266455, 0.22774039552266023, -0.434], "yaw_rad": 3.6317110454944936}},
        "trajectory": {"joint_names": ["q1", "q2", "z", "q4"], "joint_units": ["rad", "rad", "m", "rad"],
                       "time_s": [34290.84863638996, 34291.62325356116, 34292.14994659851],
                       "position": position, "velocity": rest, "acceleration": rest},
    }  # fmt: skip
    asked: Document = {
        "schema": "assur/1",
        "robot": {"model": "fiuba-scara", "tool": {"tcp_m": [0.0, 0.0, -0.08021834966420908]},
                  "base": {"at_m": base, "yaw_rad": 0.42271066262071866}},
        "start": {"at_s": at, "joints": {"theta1_rad": 1.2933525968289126, "theta2_rad": -1.8049787384764144,
                                         "d3_m": -0.06151864220919173, "theta4_rad": -2.800462526799759}},
        "task": task, "neighbours": [neighbour], "execution": {"start_tolerance_s": tolerance},
        "options": {"seed": 138, "budget_s": 60, "max_candidates": 24, "stop": "first", "elbow": "auto",
                    "singularity_margin": 0.17, "stay_safe_s": 0.52,
                    "clearance_m": {"travel": 1.4e-4, "near": 6.4e-4}},
    }  # fmt: skip
    answer = agreed(asked)
    assert answer["status"] == "planned"
    assert len(answer["certificate"]["t0_s"]) < 500
