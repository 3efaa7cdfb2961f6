"""Motions on ticks keep the limits that the request sets; where they do not, the export says by how much."""

from __future__ import annotations

import copy
import re
from functools import cache
from typing import Any

import numpy as np
import pytest
import yaml

from assur.planner.errors import InputError
from assur.scenes import check, plan
from assur.scenes.exports.documents import export_document
from assur.scenes.requests import cell_of, read_plan
from tests.docs.pages import ROOT
from tests.scenes.exports.plans import planned, request_of

WARNING = "between ticks the jerk exceeds the limit of the request: "
SWING: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}},
    "start": {"joints": {"j1_deg": -40, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}},
    "task": [{"move": {"to": {"at_mm": [100, 420, 120]}}}],
    "options": {"stop": "first", "budget_s": 10},
}
HELD = {
    "bodies": [{"name": "part", "shape": {"box": {"size_mm": [40, 40, 20]}}, "mass_kg": 0.5}],
    "start": {
        "joints": {"j1_deg": -40, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0},
        "holding": {"part": "part", "grasp_mm": [0, 0, 10]},
    },
    "task": [
        {
            "place": {
                "part": "part",
                "to": {"at_mm": [100, 420, 40], "yaw_deg": 0},
                "approach": {"mm": 20},
                "dwell_ms": 50,
                "depart": {"mm": 20},
            }
        }
    ],
}
"""In place of what is in SWING: the gripper holds a part, which it places."""

HEAVY = {
    "tool": {"tcp_mm": [0, 0, -100], "mass_kg": 4.8},
    "limits": {"acceleration_by_load": [{"mass_kg": 3, "share": 1.0}, {"mass_kg": 6, "share": 0.5}]},
}
"""A tool that leaves 0.7 of the accelerations and jerks."""


@cache
def belt_cell() -> tuple[dict[str, Any], dict[str, Any]]:
    """The cell of the tutorial, with a scale of the jerk of 0.8, and its plan."""
    request = yaml.safe_load((ROOT / "docs" / "first-belt-cell.yaml").read_text())["request"]
    request["options"]["seed"] = 7
    return request, plan(request)


def shares(request: dict[str, Any], answer: dict[str, Any]) -> dict[str, float]:
    """The greatest share of its limit of jerk in the request that each joint uses; nothing heavy may be carried."""
    cell = cell_of(request)
    low, high = read_plan(cell, answer)[0].trajectory.extrema(3)
    share = np.maximum(high, -low) / cell.scene.robot.limits.jerk
    return {joint.name: x for joint, x in zip(cell.conventions, share.tolist(), strict=True)}


@pytest.mark.parametrize("tick_ms", [2, pytest.param(1, marks=pytest.mark.slow)])
def test_the_tutorials_scale_of_the_jerk_is_kept_on_ticks(tick_ms: float) -> None:
    request, answer = belt_cell()
    export = export_document(request, answer, {"format": "ros2", "tick_ms": tick_ms})
    assert export["request"] == request
    assert check(request, export["plan"])["findings"] == []
    assert max(shares(request, export["plan"]).values()) <= 1.0
    assert (export["warnings"], export["jerk_raised"], WARNING in export["file"]) == ([], 1.0, False)


@pytest.mark.parametrize(
    "changed",
    [
        {"robot": {"limits": {"velocity": 0.4, "jerk": 0.6}}},
        {"robot": {"limits": {"acceleration": 0.5}}},
        {"robot": HEAVY},
    ],
    ids=["velocity-and-jerk", "acceleration", "load"],
)
def test_every_limit_of_the_request_is_kept_on_ticks(changed: dict[str, Any]) -> None:
    request = {**SWING, **changed, "robot": {**SWING["robot"], **changed.get("robot", {})}}
    answer = plan(request)
    assert answer["status"] == "planned"
    export = export_document(request, answer, {"format": "csv", "tick_ms": 2})
    assert export["request"] == request
    assert check(request, export["plan"])["findings"] == []
    assert export["warnings"] == []


@pytest.mark.parametrize("most", [15, 8])
def test_what_the_part_bears_is_kept_and_where_it_cannot_be_the_export_is_refused(most: float) -> None:
    robot = {**SWING["robot"], "limits": {"jerk": 0.6}}
    request = {**SWING, **HELD, "robot": robot, "carry": {"acceleration_m_s2": most}}
    answer = plan(request)
    assert answer["status"] == "planned"
    if most == 8:  # states on ticks exceed it by some share
        with pytest.raises(InputError, match="MOVE: the tool is faster or slower, or accelerates harder"):
            export_document(request, answer, {"format": "csv", "tick_ms": 2})
        return
    export = export_document(request, answer, {"format": "csv", "tick_ms": 2})
    assert export["request"]["carry"] == request["carry"]
    assert check(export["request"], export["plan"])["findings"] == []
    (line,) = export["warnings"]
    assert line.startswith(f"{WARNING}j3 by ")


def test_with_jerk_report_the_export_names_each_joint_that_exceeds_its_limit_and_by_how_much() -> None:
    request, answer = belt_cell()
    export = export_document(request, answer, {"format": "ros2", "tick_ms": 2, "jerk": "report"})
    beyond = {name: share for name, share in shares(request, export["plan"]).items() if share > 1.0}
    assert set(beyond) == {"j1", "j2", "j3"}
    (line,) = export["warnings"]
    said = {name: float(x) for name, x in re.findall(r"(\w+) by ([\d.]+) %", line.removeprefix(WARNING))}
    assert said == pytest.approx({name: 100.0 * (share - 1.0) for name, share in beyond.items()}, rel=0.05)
    assert export["statement"][0] == line
    assert export["file"].startswith(f"# {line}\n")
    # the smaller change: it stays nearer to the plan than the motion that keeps the limits
    kept = export_document(request, answer, {"format": "ros2", "tick_ms": 2})
    assert kept["deviation"][0]["at_most"] > 10 * export["deviation"][0]["at_most"]


def test_the_limit_of_the_robot_counts_where_that_of_the_request_cannot_be_kept() -> None:
    request = copy.deepcopy(request_of("five-bar"))
    request["robot"]["limits"] = {"jerk": 0.8}
    answer = plan(request)
    export = export_document(request, answer, {"format": "csv", "tick_ms": 2})
    worst = max(shares(request, export["plan"]).values())
    assert 1.0 < worst < 1.0 / 0.8
    assert export["file"].startswith(f"# {WARNING}")
    assert export["jerk_raised"] == pytest.approx(worst, rel=1e-5)
    assert check(export["request"], export["plan"])["ok"]
    assert not check(request, export["plan"])["ok"]


def test_the_highest_jerk_is_that_of_the_motion_with_a_heavy_load_too() -> None:
    request = {**SWING, "robot": {**SWING["robot"], **HEAVY}}
    export = export_document(request, plan(request), {"format": "csv"})
    low, high = read_plan(cell_of(request), export["plan"])[0].trajectory.extrema(3)
    assert [each["highest"] for each in export["jerk"]] == pytest.approx(np.maximum(high, -low).tolist())
    assert 0.65 < max(each["highest"] / each["of_request"] for each in export["jerk"]) <= 0.7


def test_a_plan_at_its_knots_exceeds_nothing() -> None:
    assert export_document(request_of("demo"), planned("demo"), {"format": "csv"})["warnings"] == []
