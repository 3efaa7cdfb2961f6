"""A shutter, a loader that comes again and again, a robot given by its plan's file: what their laws change."""

from __future__ import annotations

import json

import numpy as np
import pytest

from assur.scenes import check, plan
from assur.scenes.cells import two_robots
from assur.scenes.requests import scene_of
from assur.scenes.scenarios import shipped
from benchmarks.judge.arrivals_kept import Targets, arrivals_kept
from benchmarks.judge.joints_kept import joints_kept
from benchmarks.judge.motion import Motion
from benchmarks.judge.product import as_si
from benchmarks.judge.promises import broken_promises
from tests.changed import changed
from tests.scenes.cells.answers import Document, answer


def test_with_the_shutter_up_for_good_the_arm_would_not_have_waited() -> None:
    lift = "frames.lift.oscillation"
    up = changed(shipped("shutter").request, {f"{lift}.amplitude_mm": 0, f"{lift}.at_mm": [430, 0, 980]})
    (free, waited) = (each["arrivals"][0]["time_s"] for each in (plan(up, certificate="digest"), answer("shutter")))
    assert free < waited - 0.2


def test_a_shutter_that_is_up_for_too_short_keeps_the_arm_out() -> None:
    quick = {"frames.lift.oscillation.period_s": 0.7, "options.max_candidates": 100}
    assert plan(changed(shipped("shutter").request, quick), certificate="digest")["status"] == "not_planned"


def test_the_part_is_set_down_in_the_second_period_of_the_loader() -> None:
    """Nothing of this law would be known then if it did not repeat."""
    assert answer("loader")["arrivals"][1]["time_s"] > 4.8


def test_the_file_holds_the_answer_to_the_other_robot_s_own_request() -> None:
    document = json.loads((two_robots.CELLS / two_robots.PLAN_FILE).read_bytes())
    assert set(document) == set(answer("two-robots-neighbour"))
    motion = Motion(as_si(shipped("two-robots-neighbour").request), document)
    assert [*joints_kept(motion), *arrivals_kept(motion, Targets(motion))] == []
    assert len(document["arrivals"]) == two_robots.STEPS["two-robots.yaml"]


@pytest.mark.parametrize("name", two_robots.STEPS)
def test_the_other_robots_knots_are_what_the_script_writes_from_its_own_start(name: str) -> None:
    path = two_robots.CELLS / name
    text = path.read_text(encoding="utf-8").split(two_robots.BEGIN)[1].split(two_robots.END)[0]
    trajectory = shipped(path.stem).request["neighbours"][0]["trajectory"]
    assert two_robots.knots(trajectory) == text
    start = scene_of(two_robots.neighbour_request(two_robots.STEPS[name])).start
    assert np.allclose(trajectory["position"][0], start.q, atol=1e-12, rtol=0)


ROUND: list[Document] = [
    {"time_s": 0, "at_mm": [400, 0, 100], "yaw_deg": 0},
    {"time_s": 0.5, "at_mm": [430, 60, 110], "yaw_deg": 80},
    {"time_s": 1.1, "at_mm": [360, 40, 130], "yaw_deg": 250},
    {"time_s": 1.7, "at_mm": [400, 0, 100], "yaw_deg": 360},
]
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
    "options": {"max_candidates": 100, "budget_s": 60, "stop": "first", "elbow": "auto", "report": "full"},
}


def test_the_tool_follows_a_lift_and_a_loop_over_more_than_a_period() -> None:
    found = plan(FOLLOWS)
    assert found["status"] == "planned"
    assert check(FOLLOWS, found)["ok"]
    assert broken_promises(as_si(FOLLOWS), found) == []
    second = [leg for leg in found["legs"] if leg["kind"] == "FOLLOW"][1]
    assert second["from_s"] // 1.7 < second["to_s"] // 1.7  # over a seam
