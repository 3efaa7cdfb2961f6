"""Exports: the file holds the motion that was proved, on the points that the file has, and nothing else leaves."""

from __future__ import annotations

import copy
import json
from typing import Any

import numpy as np
import pytest
import yaml

from assur.planner.checker.verdict import Code
from assur.planner.errors import InputError
from assur.planner.trajectory import Trajectory
from assur.scenes import check, plan
from assur.scenes.conventions import as_maker
from assur.scenes.exports import export as of_export
from assur.scenes.exports.documents import export_document
from assur.scenes.requests import cell_of, read_plan
from assur.scenes.resampling.certifying import Refutation, recertified
from tests.refused import refused_at
from tests.scenes.exports.controller import sampled, seconds
from tests.scenes.exports.plans import planned, request_of


def trajectory_in(export: dict[str, Any]) -> Any:
    """The planner's trajectory of the plan in an export."""
    return read_plan(cell_of(export["request"]), export["plan"])[0].trajectory


@pytest.mark.parametrize("tick", [{}, {"tick_ms": 1.0}])
@pytest.mark.parametrize("name", ["demo", "transfer"])
def test_joint_trajectory_controller_runs_exactly_the_motion_that_was_proved(name: str, tick: dict[str, float]) -> None:
    asked = {"format": "ros2", "jerk": "report", **tick}
    export = export_document(request_of(name), planned(name), asked)
    assert check(export["request"], export["plan"])["ok"]
    message = yaml.safe_load(export["file"])
    again = json.loads(export_document(request_of(name), planned(name), {**asked, "format": "ros2-json"})["file"])
    assert message == again
    plan_in = export["plan"]["trajectory"]
    assert message["joint_names"] == plan_in["joint_names"]
    rng = np.random.default_rng(1)
    last = seconds(message["points"][-1]["time_from_start"])
    t = np.sort(np.concatenate([rng.uniform(0.0, last, 2000), [0.0, last]]))
    cell = cell_of(export["request"])
    trajectory = trajectory_in(export)
    of_controller = sampled(message, t)
    at = np.clip(trajectory.start + t, trajectory.start, trajectory.end)
    for derivative, tolerance in ((0, 1e-9), (1, 1e-9), (2, 1e-4)):
        own = as_maker(trajectory.evaluate(at, derivative), cell.conventions)
        assert np.abs(own - of_controller[derivative]).max() < tolerance


def test_times_are_whole_nanoseconds_that_increase() -> None:
    export = export_document(request_of("demo"), planned("demo"), {"format": "ros2-json"})
    since = [point["time_from_start"] for point in json.loads(export["file"])["points"]]
    nanos = [each["sec"] * 10**9 + each["nanosec"] for each in since]
    assert all(isinstance(each, int) for each in nanos)
    assert nanos[0] == 0
    assert min(np.diff(nanos)) > 0
    time = np.array(export["plan"]["trajectory"]["time_s"])
    assert np.abs(time - time[0] - np.array(nanos) * 1e-9).max() < 1e-15
    planner = np.array(planned("demo")["trajectory"]["time_s"])
    assert 0.0 < np.abs(time - planner).max() <= 0.51e-9


def test_a_jerk_beyond_the_robots_is_refused_unless_it_is_asked_for() -> None:
    asked = {"format": "csv", "tick_ms": 1.0}
    with pytest.raises(InputError, match=r"jerk of .* is 1.* times its limit"):
        export_document(request_of("five-bar"), planned("five-bar"), asked)
    export = export_document(request_of("five-bar"), planned("five-bar"), {**asked, "jerk": "report"})
    assert export["jerk_raised"] > 1.0
    assert check(request_of("five-bar"), export["plan"])["ok"] is False


def test_a_plan_with_a_reserve_of_jerk_is_exported_within_the_robots_own() -> None:
    request = copy.deepcopy(request_of("rv-m1"))
    request["robot"]["limits"] = {"jerk": 0.7}
    answer = plan(request)
    export = export_document(request, answer, {"format": "csv", "tick_ms": 1.0})
    assert export["request"]["robot"]["model"] == "mitsubishi-rv-m1"
    assert 0.7 <= export["request"]["robot"]["limits"]["jerk"] <= 1.0
    assert check(export["request"], export["plan"])["ok"]


def test_the_knots_of_a_plan_leave_as_they_are() -> None:
    export = export_document(request_of("demo"), planned("demo"), {"format": "csv"})
    assert export["plan"]["trajectory"] == planned("demo")["trajectory"]
    assert check(request_of("demo"), export["plan"])["ok"]
    lines = export["file"].splitlines()
    rows = [line for line in lines if not line.startswith("#")]
    assert rows[0].split(",")[:5] == ["time_s", "j1_deg", "j1_deg_s", "j1_deg_s2", "j2_deg"]
    assert len(rows) == 1 + len(planned("demo")["trajectory"]["time_s"])
    first = dict(zip(rows[0].split(","), map(float, rows[1].split(",")), strict=True))
    assert first["j3_mm"] == pytest.approx(1e3 * planned("demo")["trajectory"]["position"][0][2])
    assert any("highest jerk" in line for line in lines if line.startswith("#"))


def test_a_message_that_would_be_too_long_to_be_read_back_does_not_leave(monkeypatch: pytest.MonkeyPatch) -> None:
    request, answer = request_of("demo"), planned("demo")
    whole = {form: len(export_document(request, answer, {"format": form})["file"]) for form in ("ros2", "ros2-json")}
    for form, size in whole.items():
        monkeypatch.setattr(of_export, "MAX_JSON_BYTES", size)
        assert len(export_document(request, answer, {"format": form})["file"]) == size
        monkeypatch.setattr(of_export, "MAX_JSON_BYTES", size - 1)
        with pytest.raises(InputError, match="csv, or a longer tick"):
            export_document(request, answer, {"format": form})


def test_parabolic_blends_leave_as_knots_only() -> None:
    name = "parabolic-blend"
    knots = export_document(request_of(name), planned(name), {"format": "csv"})
    assert all(each["highest"] is None for each in knots["jerk"])
    with refused_at("format", match="two knots at one time"):
        export_document(request_of(name), planned(name), {"format": "ros2"})
    for tick in (1.0, 10.0):
        with refused_at("tick_ms", match="no parabolas that could be proved"):
            export_document(request_of(name), planned(name), {"format": "csv", "tick_ms": tick})


@pytest.mark.parametrize(("jumps", "code"), [(True, Code.START), (False, Code.FORM)])
@pytest.mark.parametrize("tick", [0.001, 0.2])
def test_blends_on_ticks_are_refused_because_the_checker_cannot_prove_them(
    *, jumps: bool, code: Code, tick: float
) -> None:
    cell = cell_of(request_of("parabolic-blend"))
    made = read_plan(cell, planned("parabolic-blend"))[0]
    trajectory = made.trajectory
    time = np.linspace(trajectory.start, trajectory.end, 1 + round(trajectory.duration / tick))
    found = recertified(cell.scene, made, Trajectory(time, *trajectory.states(time), jumps=jumps))
    assert isinstance(found, Refutation)
    assert code in {finding.code for finding in found.findings}


def test_an_end_that_moves_is_said() -> None:
    request = copy.deepcopy(request_of("demo"))
    request["task"] = request["task"][:2]
    request["options"]["end"] = "moving"
    answer = plan(request)
    assert any(answer["trajectory"]["velocity"][-1])
    for tick in ({}, {"tick_ms": 1.0}):
        export = export_document(request, answer, {"format": "ros2", "jerk": "report", **tick})
        assert export["ends_moving"] is True
        assert "allow_nonzero_velocity_at_trajectory_end: true" in export["file"]
        assert check(export["request"], export["plan"])["ok"]
    still = export_document(request_of("demo"), planned("demo"), {"format": "ros2"})
    assert (still["ends_moving"], "allow_nonzero" in still["file"]) == (False, False)


@pytest.mark.parametrize(
    ("asked", "field"),
    [
        ({"format": "dxf"}, "format"),
        ({"format": "csv", "tick_ms": 0.0}, "tick_ms"),
        ({"format": "csv", "tick_ms": float("nan")}, "tick_ms"),
        ({"format": "csv", "tick_s": 2.0}, "tick_s"),
        ({"format": "csv", "tick_ms": 2000}, "tick_ms"),
        ({"format": "csv", "tick_ms": 0.004}, "tick_ms"),
        ({"format": "glb", "tick_ms": 4}, "tick_ms"),
        ({"format": "csv", "lead_ms": 4}, "lead_ms"),
        ({"format": "csv", "jerk": "any"}, "jerk"),
        ({"format": "csv", "tock_ms": 1.0}, "tock_ms"),
        ({}, "format"),
    ],
)
def test_what_is_asked_wrongly_is_named(asked: dict[str, Any], field: str) -> None:
    with refused_at(field):
        export_document(request_of("demo"), planned("demo"), asked)


def test_a_plan_that_is_not_right_does_not_leave() -> None:
    wrong = copy.deepcopy(planned("demo"))
    middle = len(wrong["trajectory"]["position"]) // 2
    wrong["trajectory"]["position"][middle][0] += 1e-3
    with pytest.raises(InputError, match="one that can be proved"):
        export_document(request_of("demo"), wrong, {"format": "csv"})
    longer = {**planned("demo"), "duration_s": 1.0}
    with pytest.raises(InputError, match="duration_s"):
        export_document(request_of("demo"), longer, {"format": "csv"})
    with pytest.raises(InputError, match="request_digest is"):
        export_document(request_of("demo"), plan(request_of("transfer"), certificate="digest"), {"format": "csv"})


def test_ticks_that_are_too_long_to_track_a_point_are_refused_with_what_to_do() -> None:
    with pytest.raises(InputError, match=r"the tool is not at its point, .*; try a shorter tick, or none"):
        export_document(request_of("demo"), planned("demo"), {"format": "csv", "tick_ms": 8, "jerk": "report"})


def test_a_motion_is_proved_anew_whatever_its_answer_claims_of_it() -> None:
    request, wrong = request_of("transfer"), copy.deepcopy(planned("transfer"))
    wrong["margins"]["nearest"]["gap_m"] += 1.0
    wrong["certificate"]["t1_s"][0] += 1.0
    assert not check(request, wrong)["ok"]
    export = export_document(request, wrong, {"format": "csv"})
    assert check(export["request"], export["plan"])["ok"]
    assert export["plan"] == export_document(request, planned("transfer"), {"format": "csv"})["plan"]
    wrong["arrivals"][0]["joints"][0] += 0.1
    with pytest.raises(InputError, match=r"^plan: got 'this answer'"):
        export_document(request, wrong, {"format": "csv"})
