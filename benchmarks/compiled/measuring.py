"""The whole experiment, in the order in which it must be: compare, then time; and its result as a document."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from datetime import UTC, datetime
from typing import Any

import numpy as np

from benchmarks.compiled import calls, door, packing
from benchmarks.compiled.comparing import ALIKE, WRONG
from benchmarks.compiled.floor import floor
from benchmarks.compiled.replacements import REPLACEMENTS, replaced
from benchmarks.compiled.requests import AFTER, BEFORE, WAYS, Both, Question, answered, in_turn, questions
from benchmarks.compiled.starting import LIBRARIES, starts
from benchmarks.figures import Figure, quantile
from benchmarks.judged import warm_up
from benchmarks.machine import commit, machine, versions

Document = dict[str, Any]
Say = Callable[[str], None]

FAST_S = 0.1
ALIKE_EVERY = 5
"""In every so manieth problem all calls are compared."""
MIDDLE = 5
"""Requests about the median, and about the 95 %, whose stages are looked at."""
SHARES = {"median": 0.5, "95 %": 0.95}
ABOUT = "the hot functions compiled by numba, beside the NumPy originals"


def parameters(quick: bool) -> Document:
    """All that decides what is measured."""
    return {
        "every": 10 if quick else 1,
        "rounds": 1 if quick else 2,
        "budget_s": 1.0,
        "compared_every": 1 if quick else ALIKE_EVERY,
        "seconds": 0.5 if quick else 1.0,
        "middle": 2 if quick else MIDDLE,
        "repeats": calls.REPEATS,
        "alike": ALIKE,
        "wrong": WRONG,
    }


def experiment(quick: bool, pinned: str, say: Say) -> Document:
    """The document of the result. Raises `replacements.Gone` and `comparing.Differs`."""
    given = parameters(quick)
    asked = questions(given["every"], given["budget_s"])
    say("first requests of a process")
    start = starts()
    for of_set in asked.values():
        with replaced():
            warm_up(of_set[0].problems)
        warm_up(of_set[0].problems)
    say("comparing the compiled functions with their originals")
    compared = calls.compared([q for of_set in asked.values() for q in of_set[:: given["compared_every"]]])
    # every variant that a request asks for is there before anything is timed
    for of_set in asked.values():
        for question in of_set[:: given["compared_every"]]:
            answered(question, AFTER)
    variants, fallbacks = door.variants(), packing.FALLBACKS.copy()
    packing.FALLBACKS.clear()
    answers: dict[str, list[Both]] = {}
    for title, of_set in asked.items():
        say(f"whole requests: {title}")
        answers[title] = list(in_turn(of_set, given["rounds"]))
    left, late = dict(packing.FALLBACKS), door.variants() - variants
    stages: Document = {}
    for title, of_both in answers.items():
        for name, share in SHARES.items():
            near, about = nearest(of_both, share, given["middle"])
            if near:
                say(f"stages: {title}, {name}")
                stages[f"{title}/{name}"] = floor(near, given["seconds"], about)
    say("function by function")
    medians = [nearest(of_both, SHARES["median"], 1)[0] for of_both in answers.values()]
    functions = calls.timed([question for of_set in medians for question in of_set], compared)
    return {
        "schema": "assur-benchmark/1",
        "section": "compiled",
        "about": ABOUT,
        "sample": quick,
        "date": datetime.now(UTC).date().isoformat(),
        **commit(),
        "machine": machine() | {"numba": versions(LIBRARIES)},
        "pinned": pinned,
        "parameters": given,
        "answers": {
            "checked": sum(len(both.answers[way]) for of_set in answers.values() for both in of_set for way in WAYS),
            "not_clean": [both.name for of_set in answers.values() for both in of_set if both.findings],
        },
        "figures": [figure.document() for title, of_set in answers.items() for figure in figures(title, of_set)],
        "data": {
            "sets": {title: rows(of_set) for title, of_set in answers.items()},
            "columns": ["problem", "original_s", "compiled_s", "same"],
            "stages": stages,
            "functions": functions,
            "start": start,
            "left_to_the_original": {"compared": dict(fallbacks), "timed": left},
            "compiled_late": late,
            "replaced": [replacement.name for replacement in REPLACEMENTS],
        },
    }


def nearest(of_set: Sequence[Both], share: float, many: int) -> tuple[list[Question], float]:
    """The questions nearest to a quantile of the original's times, and that quantile, s."""
    times = {both.name: both.first_s(BEFORE) for both in of_set}
    there = {name: t for name, t in times.items() if t is not None}
    if not there:
        return [], 0.0
    middle = float(np.quantile(list(there.values()), share))
    chosen = sorted(there, key=lambda name: abs(there[name] - middle))[:many]
    by_name = {both.name: both.question for both in of_set}
    return [by_name[name] for name in chosen], middle


def rows(of_set: Sequence[Both]) -> list[list[Any]]:
    return [[both.question.problem["id"], both.first_s(BEFORE), both.first_s(AFTER), both.same] for both in of_set]


def figures(title: str, of_set: Sequence[Both]) -> Iterator[Figure]:
    """The figures of a set; refused if an answer is not clean."""
    unclean = [both for both in of_set if both.findings]
    why = f"{len(unclean)} not clean, first {unclean[0].name}: {unclean[0].findings[0]}" if unclean else None
    for way in WAYS:
        times = [t for both in of_set if (t := both.first_s(way)) is not None]
        for name, share in SHARES.items():
            found = quantile(times, share)
            value = None if why or found is None else 1e3 * found
            reason = why or ("no answer to measure" if found is None else None)
            yield Figure(f"{title}: first answer, {name}, {way}", value, "ms", reason)
        fast = 100 * sum(t <= FAST_S for t in times) / len(of_set)
        yield Figure(f"{title}: solved within 0.1 s, {way}", None if why else fast, "%", why)
    both_solved = [(both.first_s(AFTER), both.first_s(BEFORE)) for both in of_set]
    ratios = [after / before for after, before in both_solved if after is not None and before is not None]
    ratio = quantile(ratios, 0.5)
    reason = why or ("no answer to measure" if ratio is None else None)
    yield Figure(f"{title}: compiled over original, median", None if reason else ratio, "", reason)
    same = sum(both.same for both in of_set)
    yield Figure(f"{title}: the same motion in both ways", None if why else 100 * same / len(of_set), "%", why)
