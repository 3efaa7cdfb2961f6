"""Poses with `at_s`: the body is at its place in the frame as written when the clock is there, and rides on."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

from assur import Cell as KeptCell
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.relaxation.changes import BELTS, _belts
from assur.scenes.requests import cell_of, check_document, plan_document, scene_of
from benchmarks.judge.cell import Cell
from benchmarks.judge.poses import Document, about
from benchmarks.judge.product import as_si, shown
from benchmarks.judge.simulation import simulated
from tests.scenes.bad_requests import GOOD_REQUEST
from tests.scenes.cells.answers import planned

FRAMES: dict[str, Document] = {
    "table": {"fixed": {"at_mm": [200, -300, 0], "yaw_deg": 45}},
    "cart": {"linear": {"at_mm": [0, 600, 0], "velocity_mm_s": [100, 20, -5], "at_s": 1}},
    "belt": {"conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": 250}},
    "slanting": {"conveyor": {"at_mm": [0, 350, 50], "yaw_deg": 30, "speed_mm_s": 250, "at_s": 2}},
    "stopped": {
        "conveyor": {
            "at_mm": [0, 350, 50],
            "speed_mm_s": 250,
            "changes": [{"at_s": 0.2, "speed_mm_s": 0, "acceleration_m_s2": 5, "jerk_m_s3": 50}],
        },
    },
    "tray": {"fixed": {"frame": "slanting", "at_mm": [-300, 20, 0], "yaw_deg": 90}},
    "dial": {"turntable": {"at_mm": [340, -150, 60], "yaw_deg": 10, "rate_deg_s": 60, "rise_mm_s": 2}},
    "star": {"indexer": {"at_mm": [0, -400, 0], "step_deg": 45, "move_ms": 300, "dwell_ms": 700}},
    "beam": {"indexer": {"at_mm": [0, -600, 0], "step_mm": 80, "move_ms": 300, "dwell_ms": 700}},
    "gate": {"swing": {"pivot_mm": [600, 300, 160], "yaw_deg": 5, "amplitude_deg": 50, "period_s": 1.6}},
    "shutter": {
        "oscillation": {"at_mm": [430, 0, 730], "direction": [0, 0, 1], "amplitude_mm": 250, "period_s": 3},
    },
    "lift": {"keyframes": {"points": [{"time_s": 0, "at_mm": [500, 0, 0]}, {"time_s": 9, "at_mm": [500, 0, 80]}]}},
}
BOX = {"box": {"size_mm": [20, 20, 20]}}
STATED = [name for name in FRAMES if name != "lift"]


def with_body(frame: str | None, at_s: Any, **more: Any) -> Document:
    """The good request with these frames, and a body in one of them."""
    request = copy.deepcopy(GOOD_REQUEST)
    request["frames"] = copy.deepcopy({**request["frames"], **FRAMES})
    pose = {"at_mm": [-150, 40, 10], "yaw_deg": 20, "at_s": at_s, **more}
    request["bodies"].append(
        {"name": "timed", "shape": BOX, "pose": pose if frame is None else {"frame": frame, **pose}}
    )
    return request


def from_belt(at_s: float | None, **uncertain: float) -> Document:
    """A part that comes on a belt, and is put down beside it."""
    pose = {"frame": "belt", "at_mm": [-300, 0, 10], **({} if at_s is None else {"at_s": at_s})}
    lift = {"approach": {"mm": 20}, "dwell_ms": 50, "depart": {"mm": 20}, "contact_tolerance_mm": 5}
    place = {"part": "a", "to": {"at_mm": [300, -250, 60], "yaw_deg": 0}, **lift}
    return {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}},
        "start": {"at_s": 0.1, "joints": {"j1_deg": 20, "j2_deg": 60, "j3_mm": 300, "j4_deg": 0}},
        "frames": {"belt": {"conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": 150}, "uncertainty": uncertain}},
        "bodies": [{"name": "a", "shape": BOX, "pose": pose}],
        "task": [{"pick": {"part": "a", "grasp_mm": [0, 0, 10], **lift}}, {"place": place}],
        "options": {"seed": 1, "budget_s": 60, "max_candidates": 100, "stop": "first"},
    }


@pytest.mark.parametrize("at_s", [0.4, -3.0, 7.25])
@pytest.mark.parametrize("name", STATED)
def test_at_its_time_a_body_is_where_the_frame_as_written_has_it(name: str, at_s: float) -> None:
    request = with_body(name, at_s)
    scene = scene_of(request)
    body = scene.index["timed"]
    there = scene.frames[body.frame].law.motion(np.array(at_s)).at(body.pose)
    if name == "tray":
        written = Pose(0.0, 0.35, 0.05, np.radians(30)).then(Pose(-0.3, 0.02, 0.0, np.radians(90)))
    else:
        (law,) = FRAMES[name].values()
        x, y, z = (1e-3 * each for each in law.get("pivot_mm", law.get("at_mm")))
        written = Pose(x, y, z, np.radians(law.get("yaw_deg", 0.0)))
    expected = written.then(Pose(-0.15, 0.04, 0.01, np.radians(20)))
    np.testing.assert_allclose(there.p, expected.position, atol=1e-9)
    assert np.remainder(float(there.yaw) - expected.yaw + 1.0, 2.0 * np.pi) == pytest.approx(1.0, abs=1e-9)

    frame, seat = Cell.of(as_si(request)).seats["timed"]
    assert frame == body.frame
    np.testing.assert_allclose(seat.p, body.pose.position, atol=1e-9)
    np.testing.assert_allclose(seat.r, about(2, body.pose.yaw), atol=1e-9)


def test_a_part_on_a_belt_is_as_far_upstream_as_the_belt_has_gone_by_then() -> None:
    pose = scene_of(with_body("belt", 0.4, at_mm=[-450, 0, 10])).index["timed"].pose
    assert (pose.x, pose.y, pose.z) == pytest.approx((-0.55, 0.0, 0.01), abs=1e-12)


def test_in_a_frame_that_stands_still_the_time_changes_nothing() -> None:
    timed, silent = (scene_of(with_body("table", at_s)).index["timed"] for at_s in (5.0, 9.0))
    without = with_body("table", 1.0)
    del without["bodies"][-1]["pose"]["at_s"]
    assert timed.pose == silent.pose == scene_of(without).index["timed"].pose


@pytest.mark.parametrize("uncertain", [{}, {"speed_mm_s": 4}])
def test_a_part_with_a_time_is_planned_and_met_and_the_judge_agrees(uncertain: Document) -> None:
    request = from_belt(-1.4, **uncertain)
    answer = planned(request)
    by_hand = from_belt(None, **uncertain)
    by_hand["bodies"][0]["pose"]["at_mm"] = [-90, 0, 10]
    if not uncertain:
        other = plan_document(by_hand)
        assert answer["duration_s"] == pytest.approx(other["duration_s"], rel=1e-9)
    assert simulated(as_si(request), answer, 6, np.random.default_rng(0))[0].faults == []
    elsewhere = simulated(as_si(from_belt(None, **uncertain)), answer, 2, np.random.default_rng(0))[0]
    assert {fault.kind for fault in elsewhere.faults} >= {"error"}


def test_a_plan_for_another_time_is_refused_by_the_checkers() -> None:
    request, other = from_belt(-1.4), from_belt(-1.2)
    answer = planned(request)
    digest = scene_of(other).digest
    assert digest != answer["request_digest"]
    assert not check_document(other, {**answer, "request_digest": digest})["ok"]


# What is uncertain of the speed counts from the time of the pose on.


@pytest.mark.parametrize(("at_s", "start_s"), [(0.4, 1.0), (1.0, 0.4), (-2.0, 3.0)])
def test_an_uncertain_speed_counts_from_the_time_of_the_pose(at_s: float, start_s: float) -> None:
    request = from_belt(at_s, speed_mm_s=2)
    request["start"]["at_s"] = start_s
    request["bodies"][0]["uncertainty"] = {"position_mm": 1, "yaw_deg": 3}
    within = scene_of(request).index["a"].uncertainty
    drift = 0.002 * abs(start_s - at_s)
    assert within.position_m == pytest.approx(0.001 + drift)
    assert (within.vertical_m, within.yaw_rad) == pytest.approx((0.0, np.radians(3)))
    assert Cell.of(as_si(request)).unknown_of["a"]["position_m"] == pytest.approx(0.001 + drift)


def test_on_a_line_that_rises_the_drift_is_upwards_too() -> None:
    request = with_body("cart", 0.0)
    request["frames"]["cart"]["linear"]["velocity_mm_s"] = [30, 0, 40]
    request["frames"]["cart"]["uncertainty"] = {"speed_mm_s": 10}
    request["start"]["at_s"] = 1.0
    within = scene_of(request).index["timed"].uncertainty
    assert (within.position_m, within.vertical_m) == pytest.approx((0.006, 0.008))


def test_in_a_frame_without_a_line_the_drift_is_in_every_horizontal_direction() -> None:
    request = with_body("dial", 0.0)
    request["frames"]["dial"]["uncertainty"] = {"speed_mm_s": 10}
    request["start"]["at_s"] = 1.0
    within = scene_of(request).index["timed"].uncertainty
    assert (within.position_m, within.vertical_m) == pytest.approx((0.01, 0.0))


def test_a_plan_that_counts_from_a_later_time_is_refused() -> None:
    """The part is at the same place in the moving frame; only since when it is known there differs."""
    soon, long_ago = from_belt(0.1, speed_mm_s=4), from_belt(-1.4, speed_mm_s=4)
    long_ago["bodies"][0]["pose"]["at_mm"] = [-525, 0, 10]
    scenes = scene_of(soon), scene_of(long_ago)
    assert scenes[0].index["a"].pose.x == pytest.approx(scenes[1].index["a"].pose.x, abs=1e-12)
    answer = planned(soon)
    verdict = check_document(long_ago, {**answer, "request_digest": scenes[1].digest})
    assert "ERROR" in {finding["code"] for finding in verdict["findings"]}
    assert not verdict["ok"]


def test_a_kept_cell_depends_on_the_start_only_where_a_speed_is_uncertain() -> None:
    def bodies(request: Document, start_s: float) -> Any:
        request["start"]["at_s"] = start_s
        return cell_of(copy.deepcopy(request)).scene.bodies

    known, uncertain = from_belt(0.4), from_belt(0.4, speed_mm_s=2)
    assert bodies(known, 0.0) is bodies(known, 5.0)
    soon, late = bodies(uncertain, 0.4), bodies(uncertain, 5.4)
    assert (soon[0].uncertainty.position_m, late[0].uncertainty.position_m) == pytest.approx((0.0, 0.01))
    assert bodies(uncertain, 0.4) is soon


def test_a_cell_of_python_counts_from_each_start() -> None:
    request = from_belt(-1.4, speed_mm_s=4)
    cell = KeptCell(request)
    for start_s in (0.1, 0.3, 0.1):
        start = {**request["start"], "at_s": start_s}
        answer = cell.plan(start=start)
        assert answer.planned
        error = answer["arrivals"][0]["error"]
        (part,) = [each for each in error["causes"] if each["cause"] == "part"]
        assert part["position_m"] == pytest.approx(0.004 * (start_s + 1.4), rel=1e-6)


def at_clock(clock_s: float) -> Document:
    """The part is seen, and the plan begins, at this time of the clock; it is put down on the belt again."""
    request = from_belt(clock_s)
    request["start"]["at_s"] = clock_s
    request["bodies"].append({"name": "nest", "shape": BOX, "pose": {"frame": "belt", "at_mm": [-500, 0, 10]}})
    request["bodies"][-1]["pose"]["at_s"] = clock_s
    request["task"][1]["place"]["to"] = {"body": "nest", "at_mm": [0, 0, 30], "yaw_deg": 0}
    return request


@pytest.mark.parametrize("clock_s", [700.0, 20_000.0, 66_000.0])
def test_a_conveyor_may_have_run_for_hours(clock_s: float) -> None:
    request = at_clock(clock_s)
    soon, late = planned(at_clock(0.0)), planned(request)
    assert late["duration_s"] == pytest.approx(soon["duration_s"], abs=1e-6)
    assert check_document(request, late)["ok"]
    assert shown(request, late) == ""
    outcome, _ = simulated(as_si(request), late, 4, np.random.default_rng(1))
    assert outcome.faults == []


def test_a_conveyor_that_has_run_too_far_is_refused_with_how_far() -> None:
    found = refused(at_clock(67_000.0))
    assert found.field == "frames.belt"
    assert "one is 10050.5 m from it (a conveyor that has run for so long is stated for a later time" in found.allowed
    later = at_clock(67_000.0)
    later["frames"]["belt"]["conveyor"]["at_s"] = 66_990.0
    assert check_document(later, planned(later))["ok"]


# What is refused.


def refused(request: Document) -> InputError:
    with pytest.raises(InputError) as error:
        scene_of(request)
    return error.value


@pytest.mark.parametrize("at_s", [float("nan"), float("inf"), 1e6, "0.4", None, True])
def test_a_time_is_a_finite_number(at_s: Any) -> None:
    assert refused(with_body("belt", at_s)).field == "bodies[-1].pose.at_s".replace(
        "-1", str(len(GOOD_REQUEST["bodies"]))
    )


@pytest.mark.parametrize(
    ("request_", "allowed"),
    [
        (with_body(None, 0.4), "none: a pose relative to a body, or in no frame"),
        (with_body(None, 0.4, body="bed"), "none: a pose relative to a body, or in no frame"),
        (with_body("lift", 0.4), "none: lift states no single pose; frames that do are fixed, linear, conveyor"),
        (with_body("belt", 1e5), ""),
    ],
    ids=["no frame", "on a body", "keyframes", "far"],
)
def test_a_time_is_refused_where_it_has_no_meaning(request_: Document, allowed: str) -> None:
    request_["frames"]["belt"]["conveyor"]["speed_mm_s"] = 2500
    error = refused(request_)
    assert error.field == f"bodies[{len(GOOD_REQUEST['bodies'])}].pose.at_s"
    assert error.allowed.startswith(allowed or "a time until which it goes 200000 m at most; it goes 250000 m")


def test_a_time_at_which_the_frame_is_not_known_is_refused() -> None:
    request = with_body("belt", 61.0)
    request["frames"]["belt"]["valid_s"] = [0, 60]
    error = refused(request)
    assert error.field.endswith("pose.at_s")
    assert error.allowed == "a time at which belt is known; it is known from 0 s to 60 s"


def test_nothing_is_relative_to_a_body_that_drifts() -> None:
    request = with_body("belt", 0.4)
    lamp = {"name": "lamp", "shape": BOX, "pose": {"body": "timed", "at_mm": [0, 0, 20]}}
    request["bodies"].append(lamp)
    request["frames"]["belt"]["uncertainty"] = {"speed_mm_s": 2}
    assert refused(request).field == f"bodies[{len(GOOD_REQUEST['bodies']) + 1}].pose.body"
    del request["frames"]["belt"]["uncertainty"]
    assert scene_of(request).index["lamp"].pose.x == pytest.approx(-0.25)

    step = with_body("belt", 0.4)
    step["frames"]["belt"]["uncertainty"] = {"speed_mm_s": 2}
    step["task"][2]["move"]["to"] = {"body": "timed", "at_mm": [0, 0, 100]}
    assert refused(step).field == "task[2].move.to.body"


def test_a_slower_belt_is_proposed_only_where_bodies_stay_where_they_are() -> None:
    for at_s, count in ((None, len(BELTS)), (-1.4, 0)):
        scene = scene_of(from_belt(at_s))
        assert len(list(_belts(scene, scene.task[0]))) == count
