"""The plan of every shipped scenario leaves at its knots and on a tick of 1 ms: proved, run as proved, accepted back,
and refused once it is spoilt."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from assur.planner.errors import InputError
from assur.planner.trajectory import Trajectory
from assur.scenes import check
from assur.scenes.conventions import as_maker
from assur.scenes.exports.documents import check_trajectory_document, export_document
from assur.scenes.reading.cell import Cell
from assur.scenes.requests import cell_of, read_plan
from assur.scenes.scenario import with_files
from assur.scenes.scenarios import shipped, shipped_scenarios
from tests.scenes.cells.answers import answer
from tests.scenes.exports.controller import sampled, seconds
from tests.scenes.exports.test_foreign import table, text

pytestmark = pytest.mark.slow

JUMPS = "parabolic-blend"
"""Parabolic blends leave as CSV at their knots alone: see test_export."""
PLANNED = [name for name in shipped_scenarios() if shipped(name).expect["status"] == "planned" and name != JUMPS]
TICK_S = 1e-3


def request_of(name: str) -> dict[str, Any]:
    """The request of a shipped scenario, with what files hold in it."""
    scenario = shipped(name)
    found: dict[str, Any] = with_files(scenario.request, scenario.folder)
    return found


def made_of(request: dict[str, Any], plan: dict[str, Any]) -> tuple[Cell, Trajectory]:
    """The cell of a request, and the motion of a plan of it."""
    cell = cell_of(request)
    return cell, read_plan(cell, plan)[0].trajectory


def states_jerk_and_limit(export: dict[str, Any], given: dict[str, Any]) -> None:
    """An export says the highest jerk of each joint, and the limit against which it was proved."""
    cell, trajectory = made_of(export["request"], export["plan"])
    limits, own = cell.scene.robot.limits, cell_of(given).scene.robot.limits
    for kind in ("velocity", "acceleration", "lower", "upper"):
        assert (getattr(limits, kind) == getattr(own, kind)).all()
    assert (limits.jerk <= 1.75 * own.jerk * (1 + 1e-6)).all()
    assert export["jerk_raised"] == pytest.approx(max(1.0, float((limits.jerk / own.jerk).max())), rel=1e-9)
    highest = np.maximum(trajectory.extrema(3)[1], -trajectory.extrema(3)[0])
    told = {each["joint"]: each for each in export["jerk"]}
    assert sorted(each["limit"] for each in told.values()) == pytest.approx(sorted(limits.jerk.tolist()))
    assert sorted(each["highest"] for each in told.values()) == pytest.approx(sorted(highest.tolist()), rel=1e-6)
    assert all(each["highest"] <= each["limit"] * (1 + 1e-6) for each in told.values())
    (line,) = [line for line in export["statement"] if line.startswith("highest jerk")]
    assert all(f"{joint} {each['highest']:.6g}" in line or each["highest"] < 1e-9 for joint, each in told.items())


def runs_as_proved(export: dict[str, Any]) -> None:
    """The controller's quintics through the points of a message are the motion that was proved."""
    message = json.loads(export["file"])
    cell, trajectory = made_of(export["request"], export["plan"])
    last = seconds(message["points"][-1]["time_from_start"])
    t = np.sort(np.random.default_rng(3).uniform(0.0, last, 500))
    own = as_maker(trajectory.evaluate(np.minimum(trajectory.start + t, trajectory.end)), cell.conventions)
    assert np.abs(own - sampled(message, t)[0]).max() < 1e-9


@pytest.mark.parametrize("name", PLANNED)
def test_a_plan_leaves_on_ticks_proved_and_comes_back_accepted(name: str) -> None:
    request, plan = request_of(name), answer(name)
    export = export_document(request, plan, {"format": "csv", "tick_s": TICK_S, "jerk": "report"})
    assert check(export["request"], export["plan"])["findings"] == []
    states_jerk_and_limit(export, request)
    trajectory, before = made_of(export["request"], export["plan"])[1], made_of(request, plan)[1]
    assert np.abs(np.diff(trajectory.time) - TICK_S).max() < 1e-12
    t = np.linspace(before.start, before.end, 5_001)
    off = np.abs(trajectory.evaluate(np.minimum(t, trajectory.end)) - before.evaluate(t)).max()
    assert off <= max(each["at_most"] for each in export["deviation"]) < 1e-3
    asked = {"file": export["file"], "format": "csv", "jerk": "report"}
    verdict = check_trajectory_document(request, asked, plan)
    assert (verdict["ok"], verdict["findings"], verdict["judged_as"]) == (True, [], "plan")
    own = plan["margins"]["nearest"]
    if own is not None:
        assert verdict["clearance"]["gap_m"] == pytest.approx(own["gap_m"], abs=2e-4)
    _spoilt_is_refused(request, plan, export["file"])


def _spoilt_is_refused(request: dict[str, Any], plan: dict[str, Any], file: str) -> None:
    """A velocity that is a spike is refused with the joint and the time."""
    header, rows = table(file)
    column = next(k for k, title in enumerate(header) if title.endswith(("_deg_s", "_mm_s")))
    k = len(rows) // 2
    rows[k][column] = repr(float(rows[k][column]) + 20_000.0)
    verdict = check_trajectory_document(request, {"file": text(header, rows), "format": "csv", "jerk": "report"}, plan)
    joint, first = header[column].rsplit("_", 2)[0], verdict["first"]
    assert verdict["ok"] is False
    assert first["what"].startswith(f"{joint} breaks its ")
    assert float(rows[k - 1][0]) == pytest.approx(first["time_s"], abs=1e-9)


@pytest.mark.parametrize("name", PLANNED)
def test_joint_trajectory_controller_runs_the_knots_as_they_were_proved(name: str) -> None:
    request = request_of(name)
    export = export_document(request, answer(name), {"format": "ros2-json"})
    assert check(request, export["plan"])["ok"]
    states_jerk_and_limit(export, request)
    runs_as_proved(export)


@pytest.mark.parametrize("name", ["standard-cycle", "five-bar"])
def test_joint_trajectory_controller_runs_the_ticks_as_they_were_proved(name: str) -> None:
    export = export_document(
        request_of(name), answer(name), {"format": "ros2-json", "tick_s": 4 * TICK_S, "jerk": "report"}
    )
    assert check(export["request"], export["plan"])["ok"]
    runs_as_proved(export)


@pytest.mark.parametrize(
    ("name", "joint", "by"), [("shutter", "j2_deg", 80.0), ("crowded", "j1_deg", 150.0), ("full-dial", "j3_mm", -100.0)]
)
def test_a_sample_in_an_obstacle_is_refused_with_the_time_and_the_pair(name: str, joint: str, by: float) -> None:
    request, plan = request_of(name), answer(name)
    header, rows = table(export_document(request, plan, {"format": "csv"})["file"])
    k, column = len(rows) // 2, header.index(joint)
    rows[k][column] = repr(float(rows[k][column]) + by)
    verdict = check_trajectory_document(request, {"file": text(header, rows), "format": "csv", "jerk": "report"}, plan)
    near = [finding for finding in verdict["findings"] if finding["code"] == "SEPARATION"]
    assert near
    assert " and " in near[0]["what"]
    at = float(near[0]["where"].rpartition(", ")[2].removesuffix(" s"))
    assert float(rows[k - 1][0]) - 2e-3 <= at <= float(rows[k + 1][0]) + 2e-3


def test_what_cannot_be_proved_is_refused() -> None:
    request, plan = request_of("five-bar"), answer("five-bar")
    with pytest.raises(InputError, match=r"jerk of .* times its limit"):
        export_document(request, plan, {"format": "csv", "tick_s": TICK_S})
    with pytest.raises(InputError) as caught:
        export_document(request, plan, {"format": "csv", "tick_s": 0.1, "jerk": "report"})
    assert caught.value.field in ("plan", "tick_s")
