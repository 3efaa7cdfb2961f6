"""Whole requests, as they are and with the compiled functions in place of the originals, in turn in one process.

Times are those of the processor: all of it runs on one thread, and so the two ways can be compared on a machine that
has other things to do.
"""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, field
from typing import Any

from benchmarks.cold import forget
from benchmarks.compiled import packing
from benchmarks.compiled.replacements import replaced
from benchmarks.judged import SETS, label, problem_set, said
from benchmarks.problem_set import Problem, ProblemSet
from benchmarks.recheck.findings import recheck
from benchmarks.run_problems import trajectory
from benchmarks.translation import Manners, Match, request
from planner.checker import check
from planner.outcome import Planned
from planner.pipeline import plan
from scenes.requests import scene_of

Document = dict[str, Any]
BEFORE, AFTER = "original", "compiled"
WAYS = (BEFORE, AFTER)


@dataclass(frozen=True, eq=False)
class Question:
    """A problem of a set as a request."""

    title: str
    problems: ProblemSet
    problem: Problem
    match: Match
    document: Document


@dataclass(frozen=True, eq=False)
class Answer:
    """What a request came to, with the time of the processor to it, s, and the independent word on it, made outside
    of that time."""

    elapsed_s: float
    digest: str | None
    duration_s: float | None
    findings: tuple[str, ...]


@dataclass
class Both:
    """The answers to a question by the way they were made, round by round."""

    question: Question
    answers: dict[str, list[Answer]] = field(default_factory=lambda: {way: [] for way in WAYS})

    @property
    def name(self) -> str:
        return f"{self.question.title}/{self.question.problem['id']}"

    @property
    def findings(self) -> list[str]:
        return [text for way in WAYS for answer in self.answers[way] for text in answer.findings]

    def first_s(self, way: str) -> float | None:
        """The quickest round, for the machine has other things to do; None where a round found none."""
        there = self.answers[way]
        if not there or any(answer.digest is None for answer in there):
            return None
        return min(answer.elapsed_s for answer in there)

    @property
    def same(self) -> bool:
        """Whether both ways came to the same motion."""
        durations = {answer.duration_s for way in WAYS for answer in self.answers[way]}
        return len(durations) == 1


def questions(every: int = 1, budget_s: float = 1.0) -> dict[str, list[Question]]:
    """Set in words → every so many of its problems."""
    found = {}
    for name, match in SETS:
        problems, title = problem_set(name), label(name, match)
        manners = Manners(budget_s=budget_s, match=match)
        found[title] = [
            Question(title, problems, problem, match, request(problem, problems.limits, manners))
            for problem in problems.problems[::every]
        ]
    return found


def answered(question: Question, way: str) -> Answer:
    """The first answer to a request, caches cold, in one way; judged by checker and recheck, both as they are."""
    forget()
    packing.forget()
    with replaced() if way == AFTER else nullcontext():
        began = time.process_time()
        scene = scene_of(question.document)
        outcome = plan(scene)
        elapsed = time.process_time() - began
    if not isinstance(outcome, Planned):
        return Answer(elapsed, None, None, ())
    verdict = check(scene, outcome.plan)
    line = {
        "id": question.problem["id"],
        "status": "planned",
        "match": question.match,
        "first_s": elapsed,
        "duration_s": outcome.plan.trajectory.end,
        "trajectory": trajectory(outcome.plan),
        "checked": verdict.ok,
        "reason": None if verdict.ok else "; ".join(str(finding) for finding in verdict.findings),
    }
    found = recheck(question.problems, question.problem, line, question.match)
    digest, duration = outcome.plan.certificate.digest, outcome.plan.trajectory.end
    return Answer(elapsed, digest, duration, tuple(said(finding) for finding in found))


def in_turn(asked: Sequence[Question], rounds: int) -> Iterator[Both]:
    """Each question in both ways, `rounds` times, beginning with the one and the other in turn; what neither way
    solves is asked once."""
    for number, question in enumerate(asked):
        both = Both(question)
        for turn in range(rounds):
            order = WAYS if (number + turn) % 2 == 0 else WAYS[::-1]
            for way in order:
                both.answers[way].append(answered(question, way))
            if all(both.answers[way][-1].digest is None for way in WAYS):
                break
        yield both
