"""``python -m benchmarks.durations``: durations of motions found within a budget, over the shortest known.

The bars are at 20 ms and 0.2 s, on all problems; other budgets are run on every fourth, for the curve. Only problems
count for which `benchmarks.best_known` has searched: a run that is compared with itself would always be near 1. The
answers of a run count among the known, so no ratio is below 1.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from benchmarks.best_known import PATH, Known, found, lower, merged, read
from benchmarks.commits import ask, planning
from benchmarks.figures import Document, Figure, Records, figure, finish, progress, quantile
from benchmarks.first_answer import refusals
from benchmarks.judged import SETS, judged, label, problem_set
from benchmarks.machine import ROOT, pin
from benchmarks.translation import Terms, request

BARS: Mapping[float, tuple[float, float]] = {0.02: (1.05, 1.5), 0.2: (1.005, 1.15)}
"""Budget in seconds → bar of the median and of 95 %."""
CURVE_S = (0.05, 0.1, 0.5, 1.0)
EVERY, CURVE_EVERY = 10, 4
"""A sample takes every tenth problem and no curve."""


def main(quick: Annotated[bool, typer.Option("--quick", help="A sample of the problems.")] = False) -> None:
    """Measure the durations of motions for each budget."""
    parameters: Document = {"budgets_s": list(BARS), "curve_s": [] if quick else list(CURVE_S), "pinned": pin()}
    budgets = dict.fromkeys(BARS, EVERY if quick else 1)
    budgets |= {} if quick else dict.fromkeys(CURVE_S, CURVE_EVERY)
    before = read(PATH)
    records: dict[str, Document] = {}
    new: Known = {}
    for name, match in SETS:
        problems, title = problem_set(name), label(name, match)
        with planning(ROOT, problems) as program:
            runs = [(budget, problem) for budget, every in budgets.items() for problem in problems.problems[::every]]
            for budget, problem in progress(runs, title):
                document = request(problem, problems.limits, Terms(budget, "budget", match))
                answer = judged(problems, problem, ask(program, document), match, document)
                records[f"{budget:g}/{title}/{problem['id']}"] = answer
                new = merged(new, found(title, {problem["id"]: answer}, f"assur, {budget:g} s, seed 0"))[0]
    after = merged(before, new)[0]
    for item, record in records.items():
        _, title, problem_id = item.split("/")
        long = before.get(title, {}).get(problem_id, {}).get("searched_s", 0.0) > 0
        record["best_s"] = after[title][problem_id]["duration_s"] if long else None
    figures = [*figures_of(records), *refusals(records)]
    finish("durations", "duration of the motion over the best known", quick, parameters, records, figures)
    if not quick:
        lower(PATH, new)


def ratios(rows: list[Document]) -> list[float]:
    """Durations over the best known, of the problems that were solved and have a record."""
    return [row["duration_s"] / row["best_s"] for row in rows if row["status"] == "planned" and row["best_s"]]


def figures_of(records: Records) -> list[Figure]:
    """Median and 95 % of the ratios at each bar, a value for each set."""
    figures = []
    for budget, bars in BARS.items():
        groups = [of(records, budget, label(*pair)) for pair in SETS]
        missed = sorted(
            item.rpartition("/")[2]
            for group in groups
            for item, record in group.items()
            if record["best_s"] and record["status"] != "planned"
        )
        note = f"known but not solved here: {' '.join(missed)}" if missed else ""
        for title, share, bar in (("median", 0.5, bars[0]), ("95 %", 0.95, bars[1])):

            def value(rows: list[Document], share: float = share) -> float | None:
                return quantile(ratios(rows), share)

            name = f"duration at {budget:g} s over the best known, {title}"
            figures.append(figure(name, groups, value, "", (bar,) * len(SETS), decimals=3, note=note))
    return figures


def of(records: Records, budget: float, title: str) -> dict[str, Document]:
    """Records of one budget and set."""
    return {item: record for item, record in records.items() if item.startswith(f"{budget:g}/{title}/")}


def curve(records: Records, title: str) -> list[tuple[float, Any, Any]]:
    """Budget, median and 95 % of the ratios, over the problems that every budget solves, lest a longer budget looks
    worse for solving a harder problem."""
    groups = {
        budget: {item.rpartition("/")[2]: r for item, r in of(records, budget, title).items()}
        for budget in sorted({*BARS, *CURVE_S})
    }
    rows = [{problem for problem, r in group.items() if ratios([r])} for group in groups.values()]
    common = set.intersection(*rows)
    points = []
    for budget, group in groups.items():
        values = ratios([group[problem] for problem in common])
        points.append((budget, quantile(values, 0.5), quantile(values, 0.95)))
    return points


if __name__ == "__main__":
    typer.run(main)
