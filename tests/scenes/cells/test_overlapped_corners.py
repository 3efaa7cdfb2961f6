"""Corners of lift, travel and descent: overlapped beyond the straight part, stopped at where that is asked for."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.model.outcome import LegKind, Plan
from assur.planner.model.scene import Scene
from assur.scenes.reading.plan import plan_of
from assur.scenes.requests import cell_of, shipped
from tests.scenes.cells import answers
from tests.scenes.cells.answers import Document, codes

OUTER = {LegKind.APPROACH: 0, LegKind.DEPART: -1}
"""Which end of a straight part is the outer one."""


def transfer(**changes: Any) -> Document:
    """The shipped transfer; changes of its picks and places by key."""
    request = copy.deepcopy(dict(shipped("transfer").request))
    for step in request["task"]:
        for facts in step.values():
            facts.update(copy.deepcopy(changes))
    return request


def planned(request: Document) -> tuple[Document, Plan]:
    answer = answers.planned(request)
    return answer, plan_of(answer, cell_of(request).conventions)[0]


def speeds(scene: Scene, plan: Plan) -> list[float]:
    """Vertical speed, m/s, of the tool at the outer end of each straight part."""
    ends = [(leg.t0, leg.t1)[OUTER[leg.kind]] for leg in plan.legs if leg.kind in OUTER]
    return [float(plan.trajectory.states(np.array([t]))[1][0, scene.robot.lift or 0]) for t in ends]


def test_the_standard_transfer_takes_what_travel_and_two_straight_parts_take() -> None:
    """25 mm up, 300 mm across, 25 mm down with the load: 174 ms of travel, and twice 20 ms for 3 mm."""
    _, plan = planned(transfer())
    grip, down, again, back = plan.arrivals
    ways = [down.time - grip.until, back.time - again.until]
    assert max(ways) <= 0.22
    assert sum(ways) <= 0.44
    spans = [leg.t1 - leg.t0 for leg in plan.legs if leg.step == 1]
    assert spans[0] == pytest.approx(0.1743, abs=1e-4)
    assert spans[1] == pytest.approx(0.0205, abs=1e-4)


def test_with_stops_at_the_corners_the_tool_stands_there_and_the_cycle_is_longer() -> None:
    request = transfer(approach={"mm": 3, "stop": True}, depart={"mm": 3, "stop": True})
    scene = cell_of(request).scene
    stopped, plan = planned(request)
    assert speeds(scene, plan) == [0.0] * 8
    moving, overlapped = planned(transfer())
    assert sum(abs(speed) > 0.2 for speed in speeds(scene, overlapped)) >= 5
    assert overlapped.arrivals[1].time - overlapped.arrivals[0].until < plan.arrivals[1].time - plan.arrivals[0].until
    assert moving["duration_s"] < stopped["duration_s"]


@pytest.mark.parametrize("end", ["approach", "depart"])
def test_a_plan_that_does_not_stop_where_a_stop_is_asked_for_is_refused(end: str) -> None:
    _, plan = planned(transfer())
    assert check(cell_of(transfer()).scene, plan).ok
    assert {*codes(transfer(**{end: {"mm": 3, "stop": True}}), plan)} == {Code.POINT}


@pytest.mark.parametrize("end", ["approach", "depart"])
def test_a_corner_that_is_cut_into_the_straight_part_is_refused(end: str) -> None:
    """The plan turns away 3 mm above its points; 5 mm of straight motion are asked for."""
    _, plan = planned(transfer())
    assert Code.POINT in codes(transfer(**{end: {"mm": 5}}), plan)


def test_a_straight_part_that_is_said_to_be_longer_than_it_is_is_refused() -> None:
    """The legs are moved to other times, so that the straight part takes in what belongs to the travel."""
    request = transfer(depart={"mm": 5})
    _, plan = planned(transfer())
    legs, knots = list(plan.legs), plan.trajectory.time
    for i, leg in enumerate(legs):
        if leg.kind is LegKind.DEPART and i + 1 < len(legs):
            later = float(knots[knots > leg.t1 + 0.006][0])
            legs[i], legs[i + 1] = replace(leg, t1=later), replace(legs[i + 1], t0=later)
    assert Code.POINT in codes(request, replace(plan, legs=tuple(legs)))


def test_an_arch_that_a_place_asks_for_is_flown_and_checked() -> None:
    _, plan = planned(transfer())
    assert next(leg.kind for leg in plan.legs if leg.step == 1) is LegKind.ARCH
    higher = transfer()
    higher["task"][1]["place"]["arch"] = {"top_mm": 66}
    assert Code.DIRECTION in codes(higher, plan)


def test_an_arch_that_is_lower_than_its_ends_is_no_hindrance() -> None:
    """The pick begins 30 mm above its point; 20 mm, and a height below the table, are asked for."""
    for top in (45, -100):
        request = transfer()
        del request["task"][2:]
        request["task"][0]["pick"]["arch"] = {"top_mm": top}
        request["task"][1]["place"]["arch"] = {"top_mm": top}
        request["bodies"] = [body for body in request["bodies"] if body["name"] != "rail"]
        _, plan = planned(request)
        assert next(leg.kind for leg in plan.legs if leg.step == 1) is LegKind.ARCH


def test_a_straight_part_is_long_enough_for_the_clearance_of_travel() -> None:
    """3 mm above the table the load would have to be 5 mm away from it."""
    request = transfer()
    request["options"]["clearance_mm"] = {"travel": 5, "near": 1}
    scene = cell_of(request).scene
    _, plan = planned(request)
    left = next(leg.t1 for leg in plan.legs if leg.kind is LegKind.DEPART)
    lift = scene.robot.lift or 0
    heights = [float(plan.trajectory.evaluate(t)[lift]) for t in (plan.arrivals[0].until, left)]
    assert heights[1] - heights[0] == pytest.approx(1.1 * 0.005, abs=1e-9)
    assert Code.POINT in codes(request, planned(transfer())[1])
    # with a stop the length is the one that is asked for: nothing is clear then
    request = transfer(approach={"mm": 3, "stop": True}, depart={"mm": 3, "stop": True})
    request["options"]["clearance_mm"] = {"travel": 5, "near": 1}
    assert "3 mm" in answers.not_planned(request)["sentence"]


def under_a_lip() -> Document:
    """A plate lies with one end under a lip, 5 mm above it: it has to leave sideways."""
    request = transfer()
    del request["task"][2:]
    pick, place = request["task"][0]["pick"], request["task"][1]["place"]
    pick["grasp_mm"], place["to"]["at_mm"] = [0, 0, 5], [420, 150, 25]
    del place["arch"]
    table, load, _ = request["bodies"]
    table["pose"]["at_mm"] = [420, 0, 0]
    load["shape"], load["pose"]["at_mm"] = {"box": {"size_mm": [40, 160, 10]}}, [420, -150, 25]
    lip = {"name": "lip", "shape": {"box": {"size_mm": [40, 25, 10]}}, "pose": {"at_mm": [420, -222, 40]}}
    request["bodies"] = [table, load, lip]
    request["options"]["seed"] = 3  # one of those with which it is found within the count
    return request


def test_under_a_lip_the_tool_stops_behind_the_straight_part_and_leaves_sideways() -> None:
    request = under_a_lip()
    _, plan = planned(request)
    assert speeds(cell_of(request).scene, plan)[1] == 0.0
    request["bodies"].pop()
    _, plan = planned(request)
    assert speeds(cell_of(request).scene, plan)[1] > 0.2


def test_behind_a_stop_the_arm_waits_for_a_gate() -> None:
    """The gate shuts off the way until 1 s: it is taller than the arm, and begins beside the base."""
    request = transfer()
    del request["task"][2:]
    request["options"]["max_candidates"] = 400
    points = [{"time_s": t, "at_mm": [390, 0, z], "yaw_deg": 0} for t, z in ((0, 0), (1, 0), (1.4, -700), (9, -700))]
    request["frames"] = {"gate": {"keyframes": {"points": points}}}
    gate = {
        "name": "gate",
        "shape": {"box": {"size_mm": [520, 20, 500]}},
        "pose": {"frame": "gate", "at_mm": [0, 0, 250]},
    }
    request["bodies"] = [*request["bodies"][:2], gate]
    _, plan = planned(request)
    assert plan.arrivals[0].until < 1.0 < plan.arrivals[1].time


def test_a_held_part_is_not_pulled_harder_than_it_may_be_at_a_corner() -> None:
    request = transfer()
    request["carry"] = {"acceleration_m_s2": 20}
    answer, plan = planned(request)
    scene = cell_of(request).scene
    moving = [speed for speed in speeds(scene, plan) if speed != 0.0]
    assert moving
    assert max(map(abs, moving)) < max(map(abs, speeds(scene, planned(transfer())[1])))
    assert answer["duration_s"] > 0.7
