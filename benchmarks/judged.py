"""An answer with what is wrong with it: the word of the checker, and the independent recheck."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from benchmarks.problem_set import Problem, ProblemSet, read_problem_set
from benchmarks.recheck.findings import Finding, recheck
from benchmarks.run_problems import answer
from benchmarks.translation import Manners, Match, unrelated_problem

Document = dict[str, Any]

FOLDER = Path(__file__).parent / "problems"
SETS: tuple[tuple[str, Match], ...] = (
    ("static", "position"),
    ("moving_bodies", "position"),
    ("moving_goal", "position"),
    ("moving_goal", "velocity"),
)
"""The problem sets, and whether a goal is met in position or with its velocity, too."""
WARM_UP_SEEDS = (987_654_321, 987_654_322)
"""Of the unrelated problems with which a process is warmed up, goal standing and moving."""
COLUMNS = ("status", "first_s", "proved_s", "elapsed_s", "duration_s", "reason")


def problem_set(name: str) -> ProblemSet:
    """A shipped set by its name."""
    return read_problem_set(FOLDER / f"{name}.json")


def label(name: str, match: str) -> str:
    """A set in words: ``moving goal, velocity``."""
    return name.replace("_", " ") + (", velocity" if match == "velocity" else "")


def warm_up(problems: ProblemSet) -> None:
    """Loads every library and takes every path once, on problems that are in no set."""
    for seed, moving in zip(WARM_UP_SEEDS, (False, True), strict=True):
        problem = unrelated_problem(seed, moving)
        for match in ("position", "velocity"):
            answer(problem, problems, Manners(match=match))


def judged(problems: ProblemSet, problem: Problem, line: Document, match: Match) -> Document:
    """A line of `run_problems` without its trajectory, its `findings` in words; `answers`: 1 if there is a plan."""
    findings = recheck(problems, problem, line, match)
    told = {"findings": [said(finding) for finding in findings], "answers": int(line["status"] == "planned")}
    return {column: line.get(column) for column in COLUMNS} | told


def said(finding: Finding) -> str:
    """A finding in words."""
    return f"{finding.kind}: {finding.text}"
