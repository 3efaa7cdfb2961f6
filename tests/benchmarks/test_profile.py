"""A profile gives every millisecond to a room or to libraries; a measured request finds no cache filled."""

from __future__ import annotations

from importlib.util import find_spec

import pytest

from assur.scenes import meshes, units
from assur.scenes.requests import scene_of
from benchmarks import profile
from benchmarks.commits import planning
from benchmarks.judged import problem_set
from benchmarks.machine import ROOT
from benchmarks.planner_process import KEEP, planner, room_of
from benchmarks.problem_set import ProblemSet
from benchmarks.translation import Terms


def test_a_room_is_the_folder_below_the_planner_or_the_module_there() -> None:
    assert room_of(("/a/src/assur/planner/search/beam.py", 1, "f")) == "search"
    assert room_of(("/a/planner/pipeline.py", 1, "f")) == "pipeline"
    assert room_of(("/a/scenes/schema/read.py", 1, "f")) == "scenes"
    assert room_of(("~", 0, "<built-in>")) is None


def test_the_profile_of_a_set_adds_up() -> None:
    static = problem_set("static")
    easy = tuple(problem for problem in static.problems if problem["direct"])[:2]
    small = ProblemSet("x", static.limits, easy)
    buried = {**easy[0], "obstacles": [{"type": "box", "size": [3.0, 3.0, 3.0], "pos": [0, 0, 0], "yaw": 0.0}]}
    with planning(ROOT, static) as program:
        made = profile.profiled(program, small, Terms(budget_s=60.0), None, 2)
        with pytest.raises(RuntimeError, match="no problem was solved"):
            profile.profiled(program, ProblemSet("x", static.limits, (buried,)), Terms(), None, 1)
    assert sorted(made["problems"]) == sorted(str(problem["id"]) for problem in easy)
    assert sum(made["own_ms"].values()) == pytest.approx(made["total_ms"])
    assert {"search", "checker", "scenes"} <= set(made["own_ms"])
    assert "pipeline/pipeline: plan" in made["calls_ms"]


def test_caches_are_emptied_that_may_hold_something_of_a_request() -> None:
    request = {
        "schema": "assur/1",
        "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_m": [0, 0, 0]}},
        "start": {"joints": {"j1_deg": 0, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}},
        "bodies": [
            {"name": "part", "shape": {"mesh": {"asset": "bracket", "unit": "mm"}}, "pose": {"at_m": [0.4, -0.2, 0.02]}}
        ],
        "task": [{"move": {"to": {"at_m": [0.4, 0.0, 0.25]}}}],
    }
    door = planner()
    scene_of(request)
    assert meshes.process_covers.cache_info().currsize > 0
    spelt = units.si_key.cache_info().currsize
    assert spelt > 0
    assert door.forget() > 0
    assert meshes.process_covers.cache_info().currsize == 0
    assert units.si_key.cache_info().currsize == spelt
    assert all(find_spec(f"assur.{name}") for name in KEEP)
