"""The problem sets, and an answer with what is wrong with it by the independent recheck."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from benchmarks.checker_refusals import keep
from benchmarks.judge.problems import recheck
from benchmarks.problem_set import Problem, ProblemSet, read_problem_set
from benchmarks.translation import Match

Document = dict[str, Any]

FOLDER = Path(__file__).parent / "problems"
REFUSED = Path("out/checker")
"""The folder of requests for which the checker refused a plan."""
SETS: tuple[tuple[str, Match], ...] = (
    ("static", "position"),
    ("moving_bodies", "position"),
    ("moving_goal", "position"),
    ("moving_goal", "velocity"),
)
"""The problem sets, and whether a goal is met in position or with its velocity, too."""


def problem_set(name: str) -> ProblemSet:
    """A shipped set by its name."""
    return read_problem_set(FOLDER / f"{name}.json")


def label(name: str, match: str) -> str:
    """A set in words: ``moving goal, velocity``."""
    return name.replace("_", " ") + (", velocity" if match == "velocity" else "")


def judged(problems: ProblemSet, problem: Problem, answer: Document, match: Match, request: Document) -> Document:
    """An answer without its trajectory, and its `findings` in words: what is wrong with its motion, and whether the
    checker refused a plan. If it did, the request is kept in `REFUSED`."""
    findings = [str(finding) for finding in recheck(problems, problem, answer, match)]
    if answer.get("checker_refused"):
        findings.append(f"the checker refused {answer['checker_refused']} plans of the search")
        keep(REFUSED, f"{problem['id']}-{match}", request, {"reason": answer["reason"]})
    return {key: value for key, value in answer.items() if key != "trajectory"} | {"findings": findings}
