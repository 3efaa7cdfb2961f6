"""A profile says which stage each sample was in; together the stages are the time of a request."""

from __future__ import annotations

import time
from collections import Counter
from pathlib import Path

import pytest
import typer

from assur.planner.model.outcome import Outcome
from assur.planner.model.scene import Scene
from assur.planner.pipeline import plan
from assur.scenes import meshes, units
from assur.scenes.requests import scene_of
from benchmarks import profile, run_problems
from benchmarks.cold import KEEP, forget
from benchmarks.judged import problem_set
from benchmarks.problem_set import ProblemSet
from benchmarks.profile import profiled
from benchmarks.report import BLOCKS, NOTHING, printed
from benchmarks.stages import PARTS, REST, STAGES, WHOLE, milliseconds, sampled, stage
from benchmarks.translation import Manners
from tests.architecture.source_tree import sources


def test_every_module_that_a_stage_names_is_there() -> None:
    there = {source.name for source in sources("planner", "scenes")}
    assert [name for name, _ in (*WHOLE, *PARTS) if name not in there] == []
    assert [name for name in KEEP if name not in there] == []


@pytest.mark.parametrize(
    ("modules", "told"),
    [
        (["benchmarks.profile", "assur.scenes.requests", "pydantic.main"], "building"),
        (
            [
                "assur.planner.pipeline",
                "assur.planner.search.beam",
                "assur.planner.collision.screening",
                "assur.planner.robots.scara",
            ],
            "kinematics",
        ),
        (
            [
                "assur.planner.pipeline",
                "assur.planner.search.beam",
                "assur.planner.collision.screening",
                "numpy.linalg",
            ],
            "screening (supports)",
        ),
        (["assur.planner.pipeline", "assur.planner.checker.check", "assur.planner.robots.scara"], "checker"),
        (["assur.planner.pipeline", "assur.planner.report.margins", "assur.planner.collision.support_gaps"], "margins"),
        (["assur.planner.search.beam", "assur.planner.timing.solver"], "timing (ruckig)"),
        (["assur.planner.search.beam", "planner.timings_of_others"], REST),
        (["assur.planner.pipeline"], REST),
        (["numpy"], REST),
        ([], REST),
    ],
)
def test_a_stack_is_in_the_stage_of_its_innermost_module_or_of_its_judge(modules: list[str], told: str) -> None:
    assert stage(modules) == told


def test_samples_are_taken_while_the_block_runs_and_not_after() -> None:
    with sampled(1e-3) as counts:
        end = time.perf_counter() + 0.1
        while time.perf_counter() < end:
            sum(range(100))
    seen = sum(counts.values())
    assert seen > 0
    end = time.perf_counter() + 0.02
    while time.perf_counter() < end:
        sum(range(100))
    assert sum(counts.values()) == seen


def test_stages_are_scaled_to_the_time_that_a_request_takes_unwatched() -> None:
    told = milliseconds(Counter({"checker": 30, REST: 10}), 0.008)
    assert told == {"checker": pytest.approx(6.0), REST: pytest.approx(2.0)}
    assert milliseconds(Counter(), 1.0) == {}


def test_the_profile_of_a_set_adds_up_and_can_be_shown() -> None:
    static = problem_set("static")
    easy = tuple(problem for problem in static.problems if problem["direct"])[:2]
    data = profiled(ProblemSet("x", static.limits, easy), Manners(budget_s=20.0), None, 0.2)
    assert sorted(data["problems"]) == sorted(str(problem["id"]) for problem in easy)
    assert sum(data["stages_ms"].values()) == pytest.approx(data["total_ms"])
    assert {"building", "checker", "timing (ruckig)"} <= set(data["stages_ms"]) <= set(STAGES)
    whole = {"sample": False, "data": data}
    shown = BLOCKS["profile"]({"profile-static-after": whole, "profile-static-before": whole})
    assert shown.splitlines()[0] == "| stage, ms | static before | static after |"
    assert f"| **all** | **{data['total_ms']:.2f}** | **{data['total_ms']:.2f}** |" in shown
    assert list(printed("", shown).columns[0].cells)[-2:] == ["all", "commit"]
    other = {"profile-moving-bodies-before": whole, "profile-moving-goal-velocity": whole, "profile-static": whole}
    first = BLOCKS["profile"]({"profile-moving-goal-after": whole, **other, "profile-moving-goal": whole}).splitlines()[
        0
    ]
    inside = "static | moving bodies before | moving goal | moving goal after | moving goal velocity"
    assert first == f"| stage, ms | {inside} |"


def test_the_profile_of_a_part_of_a_set_is_not_published() -> None:
    whole = {"sample": False, "data": {"stages_ms": {"checker": 2.0}, "total_ms": 2.0}}
    sample = {**whole, "sample": True}
    assert BLOCKS["profile"]({"profile-static": sample}) == NOTHING
    shown = BLOCKS["profile"]({"profile-static": sample, "profile-moving-goal": whole})
    assert shown.splitlines()[0] == "| stage, ms | moving goal |"


def test_the_profile_of_a_part_of_a_set_goes_beside_the_results_unless_told_where(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = {"problems": ["A000"], "samples": 1, "stages_ms": {"checker": 2.0}, "total_ms": 2.0}
    monkeypatch.setattr(profile, "profiled", lambda *_: made)
    monkeypatch.setattr(profile, "pin", lambda: None)
    monkeypatch.setattr(profile, "RESULTS", tmp_path / "results")
    monkeypatch.setattr(profile, "SAMPLES", tmp_path / "samples")
    profile.main("static", limit=10, match="position", seconds=1.0, tag="", out=None)
    assert [path.parent.name for path in tmp_path.rglob("profile-static.json")] == ["samples"]
    profile.main("static", limit=10, out=tmp_path / "told", match="position", seconds=1.0, tag="")
    profile.main("static", limit=None, match="position", seconds=1.0, tag="before", out=None)
    assert (tmp_path / "told" / "profile-static.json").exists()
    assert [path.name for path in (tmp_path / "results").iterdir()] == ["profile-static-before.json"]


@pytest.mark.parametrize(
    ("name", "match", "field", "told"),
    [
        ("statik", "position", "SET", "none of static, moving_bodies, moving_goal"),
        ("static", "velocity", "--match", "not position, which static"),
        ("moving_goal", "speed", "--match", "not position or velocity, which moving_goal"),
    ],
)
def test_a_set_or_a_match_that_there_is_not_is_refused_by_its_own_name(
    name: str, match: str, field: str, told: str
) -> None:
    with pytest.raises(typer.BadParameter, match=told) as refused:
        profile.refuse(name, match)
    assert refused.value.param_hint == field


def test_a_set_of_which_nothing_is_solved_has_no_median() -> None:
    static = problem_set("static")
    buried = dict(static.problems[0])
    buried["obstacles"] = [{"type": "box", "size": [3.0, 3.0, 3.0], "pos": [0, 0, 0], "yaw": 0.0}]
    with pytest.raises(RuntimeError, match="no problem was solved"):
        profiled(ProblemSet("x", static.limits, (buried,)), Manners(budget_s=0.05), None, 0.1)


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
    scene_of(request)
    assert meshes._cover_of.cache_info().currsize > 0
    spelt = units.si_key.cache_info().currsize
    assert spelt > 0
    assert forget() > 0
    assert meshes._cover_of.cache_info().currsize == 0
    assert units.si_key.cache_info().currsize == spelt


def test_adaptivity_is_switched_off_in_the_planner_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    static = problem_set("static")
    easy = next(problem for problem in static.problems if problem["direct"])
    switches = []

    def watched(scene: Scene, *, adaptive: bool) -> Outcome:
        switches.append(adaptive)
        return plan(scene, adaptive=adaptive)

    monkeypatch.setattr(run_problems, "plan", watched)
    for adaptive in (True, False):
        line = run_problems.answer(easy, static, Manners(budget_s=20.0, adaptive=adaptive))
        assert line["checked"] is True
    assert switches == [True, False]
