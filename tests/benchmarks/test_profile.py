"""A profile gives every millisecond of a request to a room; a measured request finds no cache filled."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Any

import pytest
import typer

from assur.scenes import meshes, units
from assur.scenes.requests import scene_of
from benchmarks import profile
from benchmarks.commits import planning
from benchmarks.judged import problem_set
from benchmarks.machine import ROOT
from benchmarks.planner_process import KEEP, NOBODY, by_room, planner, room_of
from benchmarks.problem_set import ProblemSet
from benchmarks.translation import Manners


def test_a_library_gives_its_time_to_the_rooms_that_call_it_in_proportion() -> None:
    search, proof = ("/x/planner/search/beam.py", 1, "run"), ("/x/planner/collision/proof.py", 1, "prove")
    library, deep, main = ("/numpy/core.py", 1, "sum"), ("~", 0, "<built-in sum>"), ("/x/main.py", 1, "main")

    def edge(seconds: float) -> tuple[int, int, float, float]:
        return (1, 1, 0.0, seconds)

    stats: Any = {
        main: (1, 1, 0.5, 9.5, {}),
        search: (1, 1, 1.0, 9.0, {main: edge(9.0)}),
        proof: (1, 1, 2.0, 5.0, {search: edge(5.0)}),
        library: (2, 2, 2.0, 6.0, {search: edge(1.5), proof: edge(4.5)}),
        deep: (2, 2, 4.0, 4.0, {library: edge(4.0)}),
    }
    assert by_room(stats) == pytest.approx({"search": 1.0 + 0.25 * 6.0, "collision": 2.0 + 0.75 * 6.0, NOBODY: 0.5})


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
        made = profile.profiled(program, small, Manners(budget_s=60.0), None, 2)
        with pytest.raises(RuntimeError, match="no problem was solved"):
            profile.profiled(program, ProblemSet("x", static.limits, (buried,)), Manners(), None, 1)
    assert sorted(made["problems"]) == sorted(str(problem["id"]) for problem in easy)
    assert sum(made["own_ms"].values()) == pytest.approx(made["total_ms"])
    assert {"search", "checker", "scenes"} <= set(made["own_ms"])
    assert "pipeline/pipeline: plan" in made["calls_ms"]


@pytest.mark.parametrize(
    ("name", "match", "field"),
    [("statik", "position", "SET"), ("static", "velocity", "--match"), ("moving_goal", "speed", "--match")],
)
def test_a_set_or_a_match_that_there_is_not_is_refused_by_its_own_name(name: str, match: str, field: str) -> None:
    with pytest.raises(typer.BadParameter) as refused:
        profile.refuse(name, match)
    assert refused.value.param_hint == field


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
    assert meshes._cover_of.cache_info().currsize > 0
    spelt = units.si_key.cache_info().currsize
    assert spelt > 0
    assert door.forget() > 0
    assert meshes._cover_of.cache_info().currsize == 0
    assert units.si_key.cache_info().currsize == spelt
    assert all(find_spec(f"assur.scenes.{name}") for name in KEEP)
