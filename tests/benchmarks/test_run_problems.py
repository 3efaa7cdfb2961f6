"""A run writes a line for every problem, and what it writes withstands the recheck."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.judged import SETS, problem_set
from benchmarks.recheck import recheck_lines
from benchmarks.run_problems import choose, run
from benchmarks.translation import Match, Terms

ROOT = Path(__file__).parents[2]
PATIENT_S = 60.0


@pytest.mark.slow
@pytest.mark.parametrize(("name", "match"), SETS)
def test_easy_problems_are_solved_and_withstand_the_recheck(name: str, match: Match, tmp_path: Path) -> None:
    problems = problem_set(name)
    easy = [problem for problem in problems.problems if problem["direct"]][:3]
    lines = list(run(problems, easy, Terms(PATIENT_S, match=match), tmp_path))
    assert [(line["status"], line["checked"], line["match"]) for line in lines] == [("planned", True, match)] * 3
    assert all(0 < line["build_s"] < line["proved_s"] <= line["wall_s"] for line in lines)
    assert recheck_lines(problems, [json.dumps(line).encode() for line in lines], partial=True)[0] == []


@pytest.mark.slow
def test_a_problem_that_cannot_even_be_asked_gets_a_line_that_the_recheck_refuses(tmp_path: Path) -> None:
    problems = problem_set("static")
    first = problems.problems[0]
    broken = ({**first, "start": [9.0, 0.0, 0.1, 0.0]}, {**first, "obstacles": [{"type": "cone"}]})
    lines = list(run(problems, broken, Terms(), tmp_path))
    assert [line["status"] for line in lines] == ["error", "error"]
    assert "cone" in lines[1]["reason"]
    findings, _ = recheck_lines(problems, [json.dumps(lines[1]).encode()], partial=True)
    assert [finding.kind for finding in findings] == ["status"]


def test_problems_are_chosen_by_name_and_number_in_the_order_of_the_file() -> None:
    problems = problem_set("static")
    assert [problem["id"] for problem in choose(problems, None, ["A007", "A002"])] == ["A002", "A007"]
    assert len(choose(problems, 3, [])) == 3
    assert len(choose(problems, None, [])) == 100
    with pytest.raises(ValueError, match="A999"):
        choose(problems, None, ["A999"])


@pytest.mark.slow
def test_the_two_commands_work_as_they_are_written_in_the_documentation(tmp_path: Path) -> None:
    out, file = str(tmp_path / "made" / "if needed" / "answers.jsonl"), "benchmarks/problems/static.json"
    ran = _python(
        "benchmarks.run_problems", file, "--budget-s", "60", "--stop", "first", "--only", "A000", "--out", out
    )
    assert ran.returncode == 0, ran.stderr
    assert "solved within 1 s" in ran.stdout
    good = _python("benchmarks.recheck", file, out, "--partial")
    assert (good.returncode, "nothing found" in good.stdout) == (0, True), good.stdout + good.stderr
    incomplete = _python("benchmarks.recheck", file, out)
    assert (incomplete.returncode, "has no line" in incomplete.stdout) == (1, True)


def _python(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
