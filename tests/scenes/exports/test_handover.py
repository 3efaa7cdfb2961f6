"""A plan that follows a running one: what each way of sending comes to under each rule of the
joint_trajectory_controller, and which running plans are refused."""

from __future__ import annotations

import copy
import json
import re
from functools import cache
from typing import Any

import numpy as np
import pytest
import yaml

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.trajectory import Trajectory
from assur.scenes import check, plan
from assur.scenes.exports.documents import export_document
from assur.scenes.plan_file import PlanFile
from assur.scenes.requests import cell_of, read_plan
from tests.refused import refused_at
from tests.scenes.exports.controller import KEYS, Rule, commanded, sampled, seconds

PERIOD_S, SWITCH = 0.01, 30
"""The controller's update period, and the tick of the switch."""
SWITCH_S = 0.3
ARRIVES, LATE = SWITCH - 5, SWITCH + 6
"""Ticks at which the follow-on motion arrives."""
EXACT = 1e-9
BASE: dict[str, Any] = {
    "schema": "assur/1",
    "robot": {
        "model": "mitsubishi-rh-6frh5520",
        "tool": {"tcp_mm": [0, 0, -100]},
        "limits": {"velocity": 0.387},  # 2.7 rad/s of j1
    },
    "options": {"stop": "first", "budget_s": 10},
}
RUNNING: dict[str, Any] = {
    **BASE,
    "start": {"joints": {"j1_deg": -60, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}},
    "task": [{"move": {"to": {"at_mm": [50, 450, 120]}}}],
}


@cache
def running() -> PlanFile:
    """The plan that runs."""
    return PlanFile(RUNNING, plan(RUNNING))


def motion_of(held: PlanFile) -> Trajectory:
    """The motion of a plan; the arm counts its joints as its maker does."""
    return read_plan(cell_of(held.request), held.plan)[0].trajectory


def start_at(t: float) -> dict[str, Any]:
    """The state of the running plan, as the start of a request."""
    q, v, a = motion_of(running()).state(t)
    units = ("j1_rad", "j2_rad", "j3_m", "j4_rad")
    return {
        "at_s": t,
        "joints": dict(zip(units, q.tolist(), strict=True)),
        "velocity": {f"{unit}_s": x for unit, x in zip(units, v.tolist(), strict=True)},
        "acceleration": {f"{unit}_s2": x for unit, x in zip(units, a.tolist(), strict=True)},
    }


@cache
def following() -> PlanFile:
    """The plan that goes on from its state at the switch, to another place."""
    request = {**BASE, "start": start_at(SWITCH_S), "task": [{"move": {"to": {"at_mm": [150, 380, 160]}}}]}
    answer = plan(request)
    assert answer["status"] == "planned"
    return PlanFile(request, answer)


@cache
def message(which: str, *, lead_ms: float | None = None, after: bool = False) -> dict[str, Any]:
    """The message of a plan."""
    held = running() if which == "running" else following()
    asked: dict[str, Any] = {"format": "ros2-json"}
    if lead_ms is not None:
        asked["lead_ms"] = lead_ms
    if after:
        asked["after"] = running().document
    found: dict[str, Any] = json.loads(export_document(held.request, held.plan, asked)["file"])
    return found


def truth(ticks: int) -> FloatArray:
    """j1 (ticks,) of the running plan up to the switch, then of the one that follows."""
    t = PERIOD_S * np.arange(ticks, dtype=np.float64)
    first, second = motion_of(running()), motion_of(following())
    states = [each.evaluate(np.clip(t, each.start, each.end))[:, 0] for each in (first, second)]
    return np.asarray(np.where(t < SWITCH_S, *states), dtype=np.float64)


def error(rule: Rule, sent: list[tuple[int, float, dict[str, Any]]]) -> float:
    """By how much j1 is off at any tick, rad."""
    ticks = 10 + round(motion_of(following()).end / PERIOD_S)
    found = commanded(rule, [(0, 0.0, sent[0][2]), *sent[1:]], PERIOD_S, ticks)[:, 0]
    return float(np.abs(found - truth(ticks)).max())


def follow_on(arrives: int) -> list[tuple[int, float, dict[str, Any]]]:
    return [(0, 0.0, message("running")), (arrives, SWITCH_S, message("following"))]


def whole(lead_ms: float | None) -> list[tuple[int, float, dict[str, Any]]]:
    return [
        (0, 0.0, message("running", lead_ms=lead_ms)),
        (ARRIVES, 0.0, message("following", lead_ms=lead_ms, after=True)),
    ]


def test_the_arm_is_fast_at_the_switch() -> None:
    speed = motion_of(running()).evaluate(SWITCH_S, 1)[0]
    assert speed == pytest.approx(2.7, abs=0.01)


@pytest.mark.parametrize(
    ("rule", "lead_ms"), [(Rule.HUMBLE, None), (Rule.JAZZY, 1e3 * PERIOD_S), (Rule.LYRICAL, 1e3 * PERIOD_S)]
)
def test_the_whole_motion_on_one_time_base_is_exact(rule: Rule, lead_ms: float | None) -> None:
    assert error(rule, whole(lead_ms)) < EXACT
    other = None if lead_ms else 1e3 * PERIOD_S
    assert error(rule, whole(other)) > 0.026  # one update period at 2.7 rad/s


@pytest.mark.parametrize(("rule", "least"), [(Rule.HUMBLE, 1e-3), (Rule.JAZZY, 0.02), (Rule.LYRICAL, 0.02)])
def test_a_follow_on_motion_with_a_future_stamp_is_not(rule: Rule, least: float) -> None:
    assert least < error(rule, follow_on(ARRIVES)) < 0.1


def test_merging_shifts_what_is_late() -> None:
    assert error(Rule.MERGING, follow_on(LATE)) > 0.1  # some 40 ms at 2.7 rad/s
    assert error(Rule.MERGING, whole(1e3 * PERIOD_S)) > 0.5  # the whole motion is late by 250 ms
    with_merging_off = Rule.JAZZY
    assert error(with_merging_off, whole(1e3 * PERIOD_S)) < EXACT


@pytest.mark.parametrize("rule", list(Rule))
def test_a_run_that_is_slowed_down_jumps(rule: Rule) -> None:
    found = commanded(rule, whole(None), PERIOD_S, 60, speed=0.5)[:, 0]
    steps = np.abs(np.diff(found))
    if rule is Rule.MERGING:  # at the place where the slow run is it begins the motion anew, from its first point
        assert steps.max() > 0.1
    else:
        assert steps[: ARRIVES - 1].max() < 0.03
        assert steps[ARRIVES - 1] > 0.1


def test_fewer_states_are_another_motion() -> None:
    held = running()
    asked = {"format": "ros2-json", "tick_ms": 20, "jerk": "report"}
    export = export_document(held.request, held.plan, asked)
    whole_message, moves = json.loads(export["file"]), motion_of(PlanFile(export["request"], export["plan"]))
    t = np.linspace(0.0, seconds(whole_message["points"][-1]["time_from_start"]), 400)
    own = moves.evaluate(np.minimum(t, moves.end))[:, 0]
    off = []
    for known in (1, 2, 3):
        cut = copy.deepcopy(whole_message)
        for point in cut["points"]:
            for key in KEYS[known:]:
                del point[key]
        off.append(np.abs(sampled(cut, t)[0][:, 0] - own).max())
    line, cubic, quintic = off
    assert line > 1e-3
    assert line > 10 * cubic > 1e-5
    assert quintic < EXACT


def test_the_file_holds_the_running_points_and_then_the_plans() -> None:
    first, own, both = message("running"), message("following"), message("following", after=True)
    times = [seconds(point["time_from_start"]) for point in both["points"]]
    switch = int(np.argmin(np.abs(np.array(times) - SWITCH_S)))
    assert both["points"][:switch] == first["points"][:switch]
    for there, here in zip(both["points"][switch:], own["points"], strict=True):
        since = seconds(there["time_from_start"]) - SWITCH_S
        assert since == pytest.approx(seconds(here["time_from_start"]), abs=1e-12)
        for key in KEYS:
            assert there[key] == pytest.approx(here[key], abs=1e-9)


def test_a_lead_changes_stamps_only_and_the_proof_is_the_same() -> None:
    held = running()
    plain = export_document(held.request, held.plan, {"format": "ros2"})
    later = export_document(held.request, held.plan, {"format": "ros2", "lead_ms": 4})
    assert later["plan"] == plain["plan"]
    assert check(later["request"], later["plan"])["ok"]
    points, moved = (yaml.safe_load(each["file"])["points"] for each in (plain, later))
    assert moved[0] == points[0]  # it stands for 4 ms first
    assert [p["positions"] for p in moved[1:]] == [p["positions"] for p in points]
    assert [seconds(p["time_from_start"]) for p in moved[1:]] == pytest.approx(
        [0.004 + seconds(p["time_from_start"]) for p in points], abs=1e-12
    )
    assert "stamps are 4 ms later" in later["file"]
    none = export_document(held.request, held.plan, {"format": "ros2", "lead_ms": 0})
    assert none["file"] == plain["file"]


def test_what_runs_may_be_the_proof_of_an_export_on_ticks() -> None:
    held, second = running(), following()
    sent = export_document(held.request, held.plan, {"format": "ros2-json", "tick_ms": 10, "jerk": "report"})
    ran = PlanFile(sent["request"], sent["plan"])
    states = motion_of(ran).state(SWITCH_S)
    request = copy.deepcopy(second.request)
    for key, state in zip(("joints", "velocity", "acceleration"), states, strict=True):
        request["start"][key] = dict(zip(request["start"][key], state.tolist(), strict=True))
    asked = {"format": "ros2-json", "tick_ms": 10, "jerk": "report", "after": ran.document}
    export = export_document(request, plan(request), asked)
    assert check(export["request"], export["plan"])["ok"]
    both, first = json.loads(export["file"])["points"], json.loads(sent["file"])["points"]
    assert both[:SWITCH] == first[:SWITCH]
    since = [seconds(point["time_from_start"]) for point in both]
    assert since == pytest.approx([PERIOD_S * k for k in range(len(both))], abs=1e-12)


def changed(**of_request: Any) -> dict[str, Any]:
    """The running plan's file with another request, planned anew."""
    request = {**RUNNING, **of_request}
    return PlanFile(request, plan(request)).document


FILES: dict[str, tuple[dict[str, Any], str, str]] = {
    "other-joints": (
        {
            "robot": {"model": "benchmark-scara", "tool": {"tcp_mm": [0, 0, 0]}},
            "start": {"joints": {"q1_deg": -30, "q2_deg": 60, "z_mm": 150, "q4_deg": 0}},
            "task": [{"move": {"to": {"at_mm": [200, 350, 150]}}}],
        },
        "after.request.robot",
        "j1, j2, j3, j4",
    ),
    "other-robot": (
        {
            "robot": {**BASE["robot"], "model": "mitsubishi-rh-6crh6020"},
            "start": {"joints": {"j1_deg": -60, "j2_deg": 60, "j3_mm": 100, "j4_deg": 0}},
            "task": [{"move": {"to": {"at_mm": [50, 450, 0]}}}],
        },
        "after.request.robot",
        "mitsubishi-rh-6frh5520",
    ),
    "other-base": (
        {"robot": {**BASE["robot"], "base": {"at_mm": [0, 0, 5]}}},
        "after.request.robot.base",
        "the base",
    ),
    "other-clock": ({"start": {**RUNNING["start"], "at_s": 5}}, "start.at_s", "it is 4.7 s too early"),
    "same-time": ({"start": {**RUNNING["start"], "at_s": 0.3}}, "start.at_s", "it is the same time"),
    "long-over": ({"start": {**RUNNING["start"], "at_s": -5}}, "start.at_s", "s too late"),
    "not-whole-nanoseconds": ({"start": {**RUNNING["start"], "at_s": 3e-10}}, "start.at_s", "whole nanoseconds"),
    "other-state": (
        {"start": {"joints": {"j1_deg": -59, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}}},
        "start.joints.j1_rad",
        "they differ by 0.0",
    ),
}
"""How running plans differ from the one that is gone on from, and how each is refused."""


@pytest.mark.parametrize("name", FILES)
def test_a_plan_that_this_one_does_not_go_on_from_is_refused(name: str) -> None:
    held, (changes, field, says) = following(), FILES[name]
    with refused_at(field, says):
        export_document(held.request, held.plan, {"format": "ros2", "after": changed(**changes)})


@pytest.mark.parametrize(("key", "least"), [("joints", 1e-8), ("velocity", 1e-8), ("acceleration", 1e-7)])
@pytest.mark.parametrize("joint", [0, 1])
def test_a_state_that_differs_is_refused_with_joint_and_amount(key: str, least: float, joint: int) -> None:
    request = copy.deepcopy(following().request)
    name = list(request["start"][key])[joint]
    request["start"][key][name] -= least
    with pytest.raises(InputError) as caught:
        export_document(request, plan(request), {"format": "ros2", "after": running().document})
    assert caught.value.field == f"start.{key}.{name}"
    amount = re.search(r"they differ by (\S+) ", caught.value.allowed)
    assert amount is not None
    assert float(amount[1]) == pytest.approx(least, rel=1e-3, abs=1e-11)


def spoilt() -> list[tuple[object, str]]:
    """What is no plan file of a motion that can be gone on from, and the field that is named."""
    good = running().document
    forged = copy.deepcopy(good)
    forged["plan"]["trajectory"]["position"][3][0] += 1e-3
    other = copy.deepcopy(good)
    other["request"]["task"][0]["move"]["to"]["at_mm"] = [50, 440, 120]
    refused = copy.deepcopy(good)
    far = {**RUNNING, "task": [{"move": {"to": {"at_mm": [5000, 0, 120]}}}]}
    refused.update(request=far, plan=plan(far))
    return [
        (7, "after"),
        ([], "after"),
        ({}, "after.schema"),
        ({**good, "more": 1}, "after.more"),
        ({**good, "request": {}}, "after.request"),
        (forged, "after.plan"),
        (other, "after.plan.request_digest"),
        (refused, "after.plan"),
    ]


@pytest.mark.parametrize("number", range(8))
def test_what_is_no_running_plan_is_refused_by_its_field(number: int) -> None:
    document, field = spoilt()[number]
    held = following()
    with pytest.raises(InputError) as caught:
        export_document(held.request, held.plan, {"format": "ros2", "after": document})
    assert caught.value.field.startswith(field)


def test_a_part_that_the_running_plan_does_not_hold_is_refused() -> None:
    request = copy.deepcopy(following().request)
    request["bodies"] = [{"name": "part", "shape": {"box": {"size_mm": [20, 20, 20]}}, "mass_kg": 0.1}]
    request["start"]["holding"] = {"part": "part", "grasp_mm": [0, 0, 10]}
    answer = plan(request)
    assert answer["status"] == "planned"
    with refused_at("start.holding"):
        export_document(request, answer, {"format": "ros2", "after": running().document})


@pytest.mark.parametrize("lead", [-1, float("nan"), float("inf"), 1e9, 100.1, "4", True, [4], 1e-7])
def test_a_lead_that_is_none_is_refused(lead: object) -> None:
    held = running()
    with pytest.raises(InputError) as caught:
        export_document(held.request, held.plan, {"format": "ros2", "lead_ms": lead})
    assert caught.value.field == "lead_ms"


@pytest.mark.parametrize("form", ["csv", "glb", "spel", "melfa"])
def test_only_messages_of_ros_have_a_lead_and_a_running_plan(form: str) -> None:
    held = following()
    for asked, field in (({"lead_ms": 4}, "lead_ms"), ({"after": running().document}, "after")):
        with refused_at(field):
            export_document(held.request, held.plan, {"format": form, **asked})


def test_a_motion_that_begins_in_motion_has_a_lead_only_after_another() -> None:
    held = following()
    with refused_at("lead_ms", "after"):
        export_document(held.request, held.plan, {"format": "ros2", "lead_ms": 4})
