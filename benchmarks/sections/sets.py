"""The problem sets: how many are solved, and how soon the first answer is in hand.

One core, `stop: first`, clearance and margin 0, from a request in memory; building the scene, the planner's own check
and the margins are inside. Each set runs in a fresh warm process, with adaptivity and once more without.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from benchmarks.cold import forget
from benchmarks.figures import Figure, figure, quantile
from benchmarks.judged import SETS, judged, label, problem_set, warm_up
from benchmarks.run_problems import answer
from benchmarks.section import Document, Item, Records, Section, Summary
from benchmarks.translation import Manners

FAST_S, SOON_S = 0.1, 1.0
SAMPLE = 10
"""In a quick run every tenth problem is run."""
LEARNING = {True: "adaptive", False: "not adaptive"}


def parameters(quick: bool) -> Document:
    return {"budget_s": SOON_S, "stop": "first", "seed": 0, "every": SAMPLE if quick else 1}


def items(parameters: Document) -> list[Item]:
    made = []
    for name, match in SETS:
        for learning in LEARNING.values():  # one after the other: what the machine does meanwhile is much the same
            group = f"{name}/{match}/{learning}"
            problems = problem_set(name).problems[:: parameters["every"]]
            made += [Item(group, f"{group}/{problem['id']}") for problem in problems]
    return made


@contextmanager
def measuring(parameters: Document, group: str) -> Iterator[Callable[[str], Document]]:
    name, match, learning = group.split("/")
    problems = problem_set(name)
    by_id = {problem["id"]: problem for problem in problems.problems}
    manners = Manners(
        parameters["budget_s"],
        "first",
        "velocity" if match == "velocity" else "position",
        parameters["seed"],
        learning == LEARNING[True],
    )
    warm_up(problems)

    def measure(item: str) -> Document:
        problem = by_id[item.rpartition("/")[2]]
        forget()
        return judged(problems, problem, answer(problem, problems, manners), manners.match)

    yield measure


def summary(_parameters: Document, records: Records) -> Summary:
    figures: list[Figure] = []
    data: Document = {}
    for learning in LEARNING.values():
        for name, match in SETS:
            group = f"{name}/{match}/{learning}/"
            of_set = {item[len(group) :]: record for item, record in records.items() if item.startswith(group)}
            title = label(name, match)
            figures += set_figures(title, learning == LEARNING[True], of_set)
            rows = [[problem, record.get("first_s"), record.get("duration_s")] for problem, record in of_set.items()]
            data[f"{title}/{learning}"] = rows
    return Summary(tuple(figures), {"columns": ["problem", "first_s", "duration_s"], "sets": data})


def set_figures(title: str, adaptive: bool, records: Mapping[str, Mapping[str, Any]]) -> list[Figure]:
    """The figures of one set."""
    suffix = "" if adaptive else ", not adaptive"
    unsolved = [name for name, record in records.items() if record.get("first_s") is None]
    note = f"not solved: {' '.join(unsolved)}" if unsolved else ""

    def share(limit: float) -> Callable[[Sequence[Mapping[str, Any]]], float]:
        return lambda rows: 100 * sum(t <= limit for t in first(rows)) / len(rows)

    def at(part: float) -> Callable[[Sequence[Mapping[str, Any]]], float | None]:
        def of(rows: Sequence[Mapping[str, Any]]) -> float | None:
            found = quantile(first(rows), part)
            return None if found is None else 1e3 * found

        return of

    return [
        figure(f"{title}: solved within 0.1 s{suffix}", records, share(FAST_S), "%"),
        figure(f"{title}: solved within 1 s{suffix}", records, share(SOON_S), "%", note=note),
        figure(f"{title}: first answer, median{suffix}", records, at(0.5), "ms"),
        figure(f"{title}: first answer, 95 %{suffix}", records, at(0.95), "ms"),
    ]


def first(rows: Sequence[Mapping[str, Any]]) -> list[float]:
    """Times to the first answer over the solved ones, s."""
    return [row["first_s"] for row in rows if row["first_s"] is not None]


SECTION = Section(
    "sets", "the problem sets: solved, and time to the first answer", parameters, items, measuring, summary
)
