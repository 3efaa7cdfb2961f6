"""A run writes a line for every problem, and what it writes withstands the recheck."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.problem_set import ProblemSetError, read_problem_set
from benchmarks.recheck.__main__ import recheck_lines
from benchmarks.run_problems import answer, choose, run
from benchmarks.summary import figures
from benchmarks.translation import Document, Manners

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "benchmarks" / "problems"
FIELDS = {"id", "status", "match", "first_s", "proved_s", "elapsed_s", "duration_s", "trajectory", "checked", "reason"}


@pytest.mark.parametrize(
    ("name", "manners"),
    [
        ("static", Manners()),
        ("moving_bodies", Manners()),
        ("moving_goal", Manners()),
        ("moving_goal", Manners(match="velocity")),
    ],
    ids=["static", "moving bodies", "moving goal", "moving goal, velocity matched"],
)
def test_easy_problems_are_solved_and_withstand_the_recheck(name: str, manners: Manners, tmp_path: Path) -> None:
    problems = read_problem_set(FOLDER / f"{name}.json")
    easy = [problem for problem in problems.problems if problem["direct"]][:3]
    out = tmp_path / "made" / "if needed" / "answers.jsonl"
    lines = run(problems, easy, manners, out)
    written = out.read_bytes().splitlines()
    assert [line["status"] for line in lines] == ["planned"] * len(easy), lines
    assert [set(json.loads(text)) for text in written] == [FIELDS] * len(easy)
    assert recheck_lines(problems, written, partial=True)[0] == []


def test_a_problem_that_cannot_even_be_asked_gets_a_line_that_the_recheck_refuses() -> None:
    problems = read_problem_set(FOLDER / "static.json")
    broken = {**problems.problems[0], "start": [9.0, 0.0, 0.1, 0.0]}
    line = answer(broken, problems, Manners())
    assert set(line) == FIELDS
    assert line["status"] != "planned"
    odd = answer({**problems.problems[0], "obstacles": [{"type": "cone"}]}, problems, Manners())
    assert odd["status"] == "error"
    assert "cone" in odd["reason"]
    findings, _ = recheck_lines(problems, [json.dumps(odd).encode()], partial=True)
    assert [finding.kind for finding in findings] == ["status"]


def test_problems_are_chosen_by_name_and_number_in_the_order_of_the_file() -> None:
    problems = read_problem_set(FOLDER / "static.json")
    assert [problem["id"] for problem in choose(problems, None, ["A007", "A002"])] == ["A002", "A007"]
    assert len(choose(problems, 3, [])) == 3
    assert len(choose(problems, None, [])) == 100
    with pytest.raises(ProblemSetError, match="A999"):
        choose(problems, None, ["A999"])


def test_the_figures_count_only_what_the_checker_accepted() -> None:
    def line(status: str, first: float | None, checked: bool | None) -> Document:
        return {
            "id": "x",
            "status": status,
            "first_s": first,
            "proved_s": first,
            "duration_s": 0.5,
            "checked": checked,
            "reason": "R: why",
        }

    shown = figures(
        [
            line("planned", 0.02, True),
            line("planned", 0.3, True),
            line("planned", 1.2, True),
            line("planned", 0.01, False),
            line("not_planned", None, None),
        ]
    )
    assert shown["solved within 0.1 s"] == "1 (20 %)"
    assert shown["solved within 1 s"] == "2 (40 %)"
    assert shown["first answer, p50 / p95 / longest"].startswith("300.0 / ")
    assert shown["refused by the checker"] == "1"
    assert figures([])["solved within 1 s"] == "none"


def test_the_two_commands_work_as_they_are_written_in_the_documentation(tmp_path: Path) -> None:
    out = tmp_path / "answers.jsonl"
    file = str(FOLDER / "static.json")
    ran = _python(
        "benchmarks.run_problems", file, "--budget-s", "1.0", "--stop", "first", "--only", "A000", "--out", str(out)
    )
    assert ran.returncode == 0, ran.stderr
    assert "solved within 1 s" in ran.stdout
    good = _python("benchmarks.recheck", file, str(out), "--partial")
    assert (good.returncode, "nothing found" in good.stdout) == (0, True), good.stdout + good.stderr
    incomplete = _python("benchmarks.recheck", file, str(out))
    assert (incomplete.returncode, "has no line" in incomplete.stdout) == (1, True)


def _python(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-m", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
