"""A shutter, a loader that comes again and again, a robot given by its plan's file: what must be true of the answers.

The motion of the arm is that of `tests.scenes.cells.second_kinematics`; where shutter and loader are follows from the
numbers of the request, by SciPy where a spline is asked.
"""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from assur.scenes import check, load, plan
from assur.scenes.cells import two_robots
from assur.scenes.scenarios import shipped
from tests.scenes.cells.second_kinematics import Array, Document, Motion, answer, apart, arrival, changed, leg

INSTANTS = 4001


def times(name: str, beyond: float = 0.0) -> Array:
    knots = answer(name)["trajectory"]["time_s"]
    return np.linspace(knots[0], knots[-1] + beyond, INSTANTS)


def lower_edge(t: Array) -> Array:
    """Of the shutter, m."""
    return 0.58 + 0.25 * np.sin(2.0 * math.pi * t / 3.0 - math.pi / 2.0)


def test_the_arm_is_in_the_doorway_only_while_the_shutter_is_above_it() -> None:
    at, t = Motion(answer("shutter")), times("shutter", 3.0)
    corners = at.link_2(t)
    inside = (corners[..., 0] > 0.425).any(axis=1)
    assert inside.any()
    assert (corners[0, :, 0] < 0.425).all()
    assert (lower_edge(t[inside]) > 0.585 + 0.008 - 1e-3).all()
    # it is not always so high, and the shaft, which is higher than link 2, goes under it, too
    assert lower_edge(t).min() < 0.34
    passing = np.abs(at.point(t)[:, 0] - 0.43) < 0.0175
    assert passing.any()
    top = at.joints(t)[:, 2] + 0.42
    assert (lower_edge(t[passing]) > top[passing] + 0.008 - 1e-3).all()


def test_with_the_shutter_up_for_good_the_arm_would_not_have_waited() -> None:
    def up(request: dict[str, Any]) -> None:
        request["frames"]["lift"]["oscillation"].update(amplitude_mm=0, at_mm=[430, 0, 980])

    free = plan(changed("shutter", up), certificate="digest")
    assert arrival(free, "clean")["time_s"] < arrival(answer("shutter"), "clean")["time_s"] - 0.2


def test_a_shutter_that_is_up_for_too_short_keeps_the_arm_out() -> None:
    def quick(request: dict[str, Any]) -> None:
        request["frames"]["lift"]["oscillation"]["period_s"] = 0.7
        request["options"]["max_candidates"] = 100

    assert plan(changed("shutter", quick), certificate="digest")["status"] == "not_planned"


def loader(t: Array) -> Array:
    """Position (T, 3) of the loader, m."""
    points = shipped("loader").request["frames"]["loader"]["keyframes"]["points"]
    knots = np.array([point["time_s"] for point in points])
    way = CubicSpline(knots, np.array([point["at_mm"] for point in points]) / 1000, bc_type="periodic")
    return np.asarray(way((t - knots[0]) % (knots[-1] - knots[0])))


def test_the_part_is_set_down_between_two_visits_of_the_loader() -> None:
    begin, end = leg(answer("loader"), "FOLLOW", 1)
    t = times("loader", 2.4)
    there = np.abs(loader(t)[:, :2] - [0.42, 0.0]).max(axis=1) < 0.02
    assert there.any()
    assert not there[(begin <= t) & (t <= end)].any()
    # it was there before, and comes again
    assert there[t < begin].any()
    assert there[t > end].any()
    # 4.4 s is in the second period: nothing of this law would be known if it did not repeat
    assert begin > 4.8


def test_arm_and_loader_keep_their_distance_at_every_instant() -> None:
    at, t = Motion(answer("loader")), times("loader", 2.4)
    shaft = at.point(t)
    gap = np.abs(shaft[:, :2] - loader(t)[:, :2]).max(axis=1) - 0.02 - 0.0125
    low, high = loader(t)[:, 2] - 0.06, loader(t)[:, 2] + 0.06
    beside = (shaft[:, 2] < high) & (shaft[:, 2] + 0.52 > low)
    assert beside.any()
    assert gap[beside].min() > 0.002 - 1e-6
    assert high.max() < 0.385 - 0.008  # link 2 is above it always


def test_the_part_is_out_of_the_nest_before_the_other_robot_comes() -> None:
    name = "two-robots-late"
    request = shipped(name).request["neighbours"][0]
    own = json.loads((two_robots.CELLS / request["plan"]["file"]).read_bytes())["trajectory"]
    late = {"trajectory": own | {"time_s": [t + request["starts_at_s"] for t in own["time_s"]]}}
    ours, its = Motion(answer(name)), Motion(late, base=(0.8, 0.0, math.pi))
    t = np.linspace(0.0, 3.0, INSTANTS)
    assert apart(ours.link_2(t), its.link_2(t)).min() > 0.0
    at_nest = t[np.linalg.norm(its.point(t) - [0.4, 0.0, 0.05], axis=1) < 1e-5]
    assert leg(answer(name), "DEPART", 0)[1] < at_nest[0] < arrival(answer(name), "home")["time_s"]
    # whoever begins at once, as its knots say, is there first; `load` has put the file's trajectory in
    early = load(name)
    del early["neighbours"][0]["starts_at_s"]
    assert arrival(plan(early, certificate="digest"), "pick-1")["time_s"] > own["time_s"][-1] - 0.5


def test_the_file_holds_the_answer_to_the_other_robot_s_own_request() -> None:
    document = json.loads((two_robots.CELLS / two_robots.PLAN_FILE).read_bytes())
    assert set(document) == set(answer("two-robots-neighbour"))
    its = Motion(document, base=(0.8, 0.0, math.pi))
    for point in document["arrivals"]:
        assert np.abs(its.point(np.array([point["time_s"]]))[0] - point["at_m"]).max() < 2e-6
    assert len(document["arrivals"]) == two_robots.STEPS["two-robots.yaml"]


ROUND: list[Document] = [
    {"time_s": 0, "at_mm": [400, 0, 100], "yaw_deg": 0},
    {"time_s": 0.5, "at_mm": [430, 60, 110], "yaw_deg": 80},
    {"time_s": 1.1, "at_mm": [360, 40, 130], "yaw_deg": 250},
    {"time_s": 1.7, "at_mm": [400, 0, 100], "yaw_deg": 360},
]
UP = [0.3, 0, 1]
FOLLOWS: Document = {
    "schema": "assur/1",
    "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}, "limits": {"acceleration": 0.6}},
    "start": {"at_s": 100.3, "joints": {"j1_deg": -40, "j2_deg": 80, "j3_mm": 250, "j4_deg": 0}},
    "frames": {
        "lift": {
            "oscillation": {"at_mm": [400, 0, 120], "direction": [0.3, 0, 1], "amplitude_mm": 20, "period_s": 1.1}
        },
        "loop": {"keyframes": {"repeat": True, "points": ROUND}},
    },
    "task": [
        {"follow": {"to": {"frame": "lift", "at_mm": [0, 0, 0], "yaw_deg": 30}, "duration_ms": 1200}},
        {"follow": {"to": {"frame": "loop", "at_mm": [5, 0, 0], "yaw_deg": 0}, "duration_ms": 1800}},
    ],
    "options": {"max_candidates": 100, "budget_s": 60, "stop": "first", "elbow": "auto"},
}


def test_the_tool_follows_a_lift_and_a_loop_over_more_than_a_period() -> None:
    found = plan(FOLLOWS)
    assert found["status"] == "planned"
    assert check(FOLLOWS, found)["ok"]
    at = Motion(found)
    t = np.linspace(*leg(found, "FOLLOW", 0), 50)
    rise = 0.02 * np.sin(2.0 * math.pi * t / 1.1) / math.hypot(0.3, 1.0)
    there = np.stack([0.4 + 0.3 * rise, 0.0 * t, 0.12 + rise], axis=1)
    assert np.abs(at.point(t) - there).max() < 1e-5
    begin, end = leg(found, "FOLLOW", 1)
    assert begin // 1.7 < end // 1.7  # over a seam
    t, knots = np.linspace(begin, end, 50), np.array([point["time_s"] for point in ROUND])
    values = np.array([[*point["at_mm"], point["yaw_deg"] - 360.0 * point["time_s"] / 1.7] for point in ROUND])
    x, y, z, rest = CubicSpline(knots, values, bc_type="periodic")(t % 1.7).T
    yaw = np.radians(rest + 360.0 * t / 1.7)
    there = np.stack([x + 5.0 * np.cos(yaw), y + 5.0 * np.sin(yaw), z], axis=1) / 1000.0
    assert np.abs(at.point(t) - there).max() < 1e-5
    turned = at.tool(t)[:, 3] - yaw
    assert np.abs(turned - 2.0 * math.pi * np.round(turned / (2.0 * math.pi))).max() < 1e-4
