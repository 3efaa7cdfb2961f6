"""Peers answer over a pipe, are rechecked like us, and where one cannot run that is said and the rest goes on."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.judged import problem_set
from benchmarks.peers import environment as environments
from benchmarks.peers.arm import along as straight
from benchmarks.peers.arm import solutions
from benchmarks.peers.environment import NEEDS, Environment, installed, missing, prepared, requirements
from benchmarks.peers.running import MODULES, peers, question
from benchmarks.recheck.arm import tool
from benchmarks.sections.side_by_side import SECTION, rechecked
from tests.architecture.source_tree import imports, sources
from tests.benchmarks.hand_made import along, joints_at
from tests.benchmarks.hand_made import problem_set as one_problem

Document = dict[str, Any]
HERE = Environment(Path(sys.executable), "here")
START = [-0.6, 0.9, 0.15, 0.3]
PROBLEM: Document = {"id": "hand-made", "start": START, "goal": {"pos": [0.4, 0.2, 0.1], "yaw": 1.0}, "obstacles": []}
POST = {"type": "cylinder", "radius": 0.01, "height": 0.6, "pos": [0.5, 0.0, 0.3], "yaw": 0.0}

SCRIPTED = """
import sys
from benchmarks.dialogue import answer_lines
from benchmarks.peers.arm import solutions
def prepare():
    print("a banner")
    def answer(question):
        problem = question["problem"]
        if problem["id"] == "deadly":
            sys.exit(3)
        if problem["id"] == "hopeless":
            return {"status": "not_planned", "reason": "no path in the budget"}
        goal = solutions(problem["goal"]["pos"], problem["goal"]["yaw"], question["limits"])[0]
        still = [[0.0] * 4] * 2
        knots = {"time_s": [0.0, 2.0], "position": [problem["start"], goal], "velocity": still, "acceleration": still}
        return {"status": "planned", "first_s": 0.01, "duration_s": 2.0, "trajectory": knots}
    return {"version": "0.0"}, answer
answer_lines(prepare)
"""
"""A peer that goes straight to the first goal, whatever is in its way."""


def asked(problem: Document) -> Document:
    return question(problem, one_problem(problem).limits, 1.0, 0)


def test_a_scripted_peer_is_asked_answers_and_is_rechecked() -> None:
    with peers(("ompl",), HERE, {"ompl": [sys.executable, "-c", SCRIPTED]}) as there:
        assert there.versions == {"ompl": "0.0"}
        free = there.ask("ompl", asked(PROBLEM))
        blocked = PROBLEM | {"obstacles": [POST]}
        through = there.ask("ompl", asked(blocked))
        none = there.ask("ompl", asked(PROBLEM | {"id": "hopeless"}))
    record = rechecked(one_problem(PROBLEM), PROBLEM, free)
    assert (record["status"], record["fatal"], record["limits"]) == ("planned", [], [])
    assert (record["first_s"], record["duration_s"]) == (0.01, 2.0)
    hit = rechecked(one_problem(blocked), blocked, through)
    assert any(text.startswith("collision") for text in hit["fatal"])
    assert rechecked(one_problem(PROBLEM), PROBLEM, none)["status"] == "not_planned"


def test_a_peer_that_dies_is_missing_from_then_on_and_the_others_go_on() -> None:
    command = [sys.executable, "-c", SCRIPTED]
    with peers(("ompl", "mplib"), HERE, {"ompl": command, "mplib": command}) as there:
        died = there.ask("ompl", asked(PROBLEM | {"id": "deadly"}))
        assert died["status"] == "missing"
        assert "died" in died["reason"]
        assert there.ask("ompl", asked(PROBLEM)) == died
        assert there.ask("mplib", asked(PROBLEM))["status"] == "planned"


def test_a_peer_that_cannot_start_or_be_installed_is_missing_with_its_reason() -> None:
    lacking = Environment(Path(sys.executable), "3.11", {"mplib": "no wheel"})
    with peers(("ompl", "mplib"), lacking, {"ompl": [sys.executable, "-c", "import nothing_of_this_name"]}) as there:
        assert there.missing["mplib"] == "no wheel"
        assert there.missing["ompl"].startswith("its program does not start")
        assert there.ask("mplib", asked(PROBLEM)) == {"status": "missing", "reason": "no wheel"}


def _answer(duration: float = 2.0) -> Document:
    goal = joints_at(PROBLEM["goal"]["pos"], PROBLEM["goal"]["yaw"], 1.0)
    return along([np.array(START), goal], [duration])


def test_a_peer_without_a_limit_of_jerk_may_jump_in_acceleration_at_its_ends_and_nothing_else() -> None:
    jumping = _answer()
    for row in (0, -1):
        jumping["trajectory"]["acceleration"][row] = [0.1, 0.0, 0.0, 0.0]
    record = rechecked(one_problem(PROBLEM), PROBLEM, jumping)
    assert record["fatal"] == []
    assert {"start", "goal velocity"} <= set(record["limits"])
    rolling = _answer()
    rolling["trajectory"]["velocity"][-1] = [0.01, 0.0, 0.0, 0.0]
    assert rechecked(one_problem(PROBLEM), PROBLEM, rolling)["fatal"]
    flying = _answer()
    flying["trajectory"]["velocity"][0] = [0.01, 0.0, 0.0, 0.0]
    assert rechecked(one_problem(PROBLEM), PROBLEM, flying)["fatal"]
    fast = rechecked(one_problem(PROBLEM), PROBLEM, _answer(0.1))
    assert fast["fatal"] == []
    assert {"velocity", "acceleration", "jerk"} <= set(fast["limits"])
    elsewhere = _answer()
    elsewhere["trajectory"]["position"][0][0] += 1e-3
    assert rechecked(one_problem(PROBLEM), PROBLEM, elsewhere)["fatal"]
    late = _answer(6.0)
    assert rechecked(one_problem(PROBLEM), PROBLEM, late)["fatal"]


def test_a_peers_collision_makes_its_problem_unsolved_and_refuses_nothing_of_ours() -> None:
    from tests.benchmarks.made_up import line, records

    parameters = SECTION.parameters(True)
    made = records("peers", parameters, SECTION.items(parameters))
    first = next(iter(made))
    made[first] = made[first] | {"ompl": made[first]["ompl"] | {"fatal": ["collision: x"]}}
    figures = {figure.name: figure for figure in SECTION.summary(parameters, made).figures}
    assert figures["OMPL RRTConnect: solved within 1 s"].value == 90.0
    assert figures["ours: solved within 1 s"].value == 100.0
    made[first] = made[first] | {"assur": line(findings=["collision: y"])}
    figures = {figure.name: figure for figure in SECTION.summary(parameters, made).figures}
    assert figures["ours: solved within 1 s"].value is None
    assert figures["OMPL RRTConnect: solved within 1 s"].value == 90.0


def test_all_closed_form_solutions_reach_the_goal_within_the_limits() -> None:
    problems = problem_set("static")
    limits = {name: list(values) for name, values in problems.limits.items()}
    for problem in problems.problems[:20]:
        goal = problem["goal"]
        found = np.array(solutions(goal["pos"], goal["yaw"], limits))
        assert len(found) >= 1
        reached = tool(found, np.zeros_like(found))
        assert np.abs(reached.position - np.array(goal["pos"])).max() < 1e-12
        assert np.abs(np.sin((reached.yaw - goal["yaw"]) / 2)).max() < 1e-12
        assert np.all((found >= limits["qmin"]) & (found <= limits["qmax"]))
        assert len(np.unique(np.round(found, 9), axis=0)) == len(found)
    assert solutions([1.0, 0.0, 0.1], 0.0, limits) == []


def test_a_straight_line_in_joint_space_is_a_straight_line_of_the_tool() -> None:
    start, end = [0.3, -0.25, 0.1], [0.35, 0.3, 0.18]
    q = straight(start, end, (0.1, 0.7), -1.0, 30)
    reached = tool(q, np.zeros_like(q))
    s = np.linspace(0, 1, 30)[:, None]
    assert np.abs(reached.position - (np.array(start) + s * (np.array(end) - np.array(start)))).max() < 1e-12
    assert np.abs(reached.yaw - np.linspace(0.1, 0.7, 30)).max() < 1e-12
    assert np.isnan(straight([0.7, 0, 0.1], [0.3, 0, 0.1], (0, 0), 1.0, 5)).any()


def test_where_pip_fails_for_one_requirement_the_other_peers_still_run() -> None:
    commands: list[Sequence[str]] = []

    def run(command: Sequence[str]) -> int:
        commands.append(command)
        return int("ompl" in command[-1])

    failed = installed(Path("python"), run)
    assert failed == {"ompl"}
    assert [command[-1] for command in commands] == list(requirements().values())
    assert set(missing(failed, "3.11")) == {"ompl"}
    assert requirements()["ompl"] in missing(failed, "3.11")["ompl"]
    assert set(missing({"numpy"}, "3.12")) == set(NEEDS)
    assert missing(set(), "3.11") == {}


def test_without_a_python_that_they_have_wheels_for_every_peer_says_so(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(environments, "PYTHONS", ("2.9",))
    made = prepared(tmp_path / "venv")
    assert made.python is None
    assert set(made.missing) == set(NEEDS) == set(MODULES)
    assert all("no Python 2.9 on this machine" in why for why in made.missing.values())
    assert not (tmp_path / "venv").exists()


def test_what_could_not_be_installed_is_not_tried_again_at_once(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    version = environments.PYTHONS[0]
    made: list[Path] = []

    def failing(python: Path, run: environments.Run) -> set[str]:
        made.append(python)
        python.parent.mkdir(parents=True, exist_ok=True)
        python.touch()
        return {"mplib"}

    monkeypatch.setattr(environments, "interpreter", lambda: ("true", version))
    monkeypatch.setattr(environments, "installed", failing)
    (tmp_path / "venv").mkdir()
    first = prepared(tmp_path / "venv")
    assert set(first.missing) == {"mplib"}
    assert prepared(tmp_path / "venv").missing == first.missing
    assert len(made) == 1
    monkeypatch.setattr(environments, "TRY_AGAIN_S", -1.0)
    prepared(tmp_path / "venv")
    assert len(made) == 2


def test_what_a_missing_peer_left_out_is_measured_when_the_run_is_resumed() -> None:
    from benchmarks.sections import legs
    from tests.benchmarks.made_up import records

    for section, peer in ((SECTION, "ompl"), (legs.SECTION, "toppra")):
        made = next(iter(records(section.name, {}, section.items(section.parameters(True))).values()))
        whole = made | {"mplib": {"status": "planned"}}
        assert not section.again(whole)
        assert section.again(whole | {peer: {"status": "missing", "reason": "no wheel"}})
        assert section.again({"findings": ["the measuring process died: x"]})


def test_every_requirement_is_pinned_and_needed_by_somebody() -> None:
    assert all(re.fullmatch(r"[a-z-]+==[\d.]+", line) for line in requirements().values())
    assert {name for needs in NEEDS.values() for name in needs} == set(requirements())


PROGRAMS = {name: source for source in sources("benchmarks") for name, of in MODULES.items() if source.name == of}
OURS = ("benchmarks.dialogue", "benchmarks.peers.arm", "benchmarks.recheck")
"""What runs in the peers' environment besides them."""
LIBRARY = {"fcl": "python-fcl"}


def reached(name: str) -> dict[str, set[str]]:
    """Modules that a peer's program imports, through ours too: library → of whom."""
    known = {source.name: source for source in sources("benchmarks")}
    seen, ahead, found = set(), [MODULES[name]], dict[str, set[str]]()
    while ahead:
        module = ahead.pop()
        if module in seen:
            continue
        seen.add(module)
        for imported, _ in imports(known[module].tree):
            if imported in known:
                ahead.append(imported)
            elif imported.partition(".")[0] != "benchmarks":
                found.setdefault(imported.partition(".")[0], set()).add(module)
    return found


@pytest.mark.parametrize("name", sorted(MODULES))
def test_a_peers_program_imports_only_what_its_environment_has(name: str) -> None:
    libraries = {library for library in reached(name) if library not in sys.stdlib_module_names}
    assert {LIBRARY.get(library, library) for library in libraries} <= set(NEEDS[name])
    assert name in libraries


def test_a_peer_that_keeps_every_limit_lowers_a_record_and_one_that_does_not_never_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from benchmarks.best_known import read
    from benchmarks.sections import side_by_side
    from tests.benchmarks.made_up import records

    path = tmp_path / "known.json"
    monkeypatch.setattr(side_by_side, "PATH", path)
    parameters = SECTION.parameters(True)
    made = records("peers", parameters, SECTION.items(parameters))
    for problem, kept in (("A000", {}), ("A010", {"limits": ["jerk"]}), ("A020", {"fatal": ["collision: x"]})):
        made[problem] = made[problem] | {"ompl": made[problem]["ompl"] | kept | {"duration_s": 0.3}}
    side_by_side.lower_records(parameters, made)
    after = read(path)["static"]
    assert after["A000"]["by"] == "OMPL RRTConnect 2"
    assert after["A000"]["duration_s"] == 0.3
    assert {"A010", "A020"} & set(after) == set()
