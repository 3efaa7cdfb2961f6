"""How long the motions are that a budget buys, over the shortest known (`benchmarks.best_known`).

The bar is at 0.2 s, on all problems; other budgets are run on every fourth, for the curve. Only problems count for
which `benchmarks.best_known` has searched: a run that is compared with itself would always be near 1. The answers of a
run count among the known, so no ratio is below it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

from benchmarks.best_known import PATH, Known, found, merged, read, write
from benchmarks.cold import forget
from benchmarks.figures import Figure, figure, quantile, unclean
from benchmarks.judged import SETS, judged, label, problem_set, warm_up
from benchmarks.run_problems import answer
from benchmarks.section import Document, Item, Records, Section, Summary
from benchmarks.translation import Manners

BUDGET_S = 0.2
CURVE_S = (0.05, 0.1, 0.2, 0.5, 1.0)
CURVE_EVERY = 4
NAME = "duration at 0.2 s over the best known"
PARTS = {"median": 0.5, "95 %": 0.95}
SAMPLE, CURVE_SAMPLE = 10, 50


def parameters(quick: bool) -> Document:
    return {
        "budget_s": BUDGET_S,
        "every": SAMPLE if quick else 1,
        "curve_s": list(CURVE_S),
        "curve_every": CURVE_SAMPLE if quick else CURVE_EVERY,
        "stop": "budget",
        "seed": 0,
    }


def items(parameters: Document) -> list[Item]:
    made = []
    for budget in sorted({BUDGET_S, *parameters["curve_s"]}):
        every = parameters["every"] if budget == parameters["budget_s"] else parameters["curve_every"]
        for name, match in SETS:
            group = f"{name}/{match}/{budget:g}"
            made += [Item(group, f"{group}/{problem['id']}") for problem in problem_set(name).problems[::every]]
    return made


@contextmanager
def measuring(parameters: Document, group: str) -> Iterator[Callable[[str], Document]]:
    name, match, budget = group.split("/")
    problems = problem_set(name)
    by_id = {problem["id"]: problem for problem in problems.problems}
    met = Manners(float(budget), "budget", "velocity" if match == "velocity" else "position", parameters["seed"])
    warm_up(problems)

    def measure(item: str) -> Document:
        problem = by_id[item.rpartition("/")[2]]
        forget()
        return judged(problems, problem, answer(problem, problems, met), met.match)

    yield measure


def of_group(records: Records, group: str) -> dict[str, Document]:
    """Records by problem of one set and budget."""
    return {item[len(group) + 1 :]: record for item, record in records.items() if item.startswith(group + "/")}


def new_records(parameters: Document, records: Records) -> Known:
    """What this run found, to be merged into the records."""
    new: Known = {}
    for budget in sorted({parameters["budget_s"], *parameters["curve_s"]}):
        for name, match in SETS:
            by = f"assur, {budget:g} s, seed {parameters['seed']}"
            new = merged(new, found(label(name, match), of_group(records, f"{name}/{match}/{budget:g}"), by))[0]
    return new


def summary(parameters: Document, records: Records) -> Summary:
    before = read(PATH)
    known = merged(before, new_records(parameters, records))[0]
    figures: list[Figure] = []
    curve: Document = {}
    ratios_of: Document = {}
    for name, match in SETS:
        title = label(name, match)
        long = [problem for problem, record in before.get(title, {}).items() if record["searched_s"] > 0]
        best = {problem: known[title][problem]["duration_s"] for problem in long}
        at_bar = of_group(records, f"{name}/{match}/{parameters['budget_s']:g}")
        own = {problem: record | {"best_s": best.get(problem)} for problem, record in at_bar.items()}
        figures += both(title, own, _note(own))
        ratios_of[title] = {
            problem: record["duration_s"] / record["best_s"]
            for problem, record in own.items()
            if record.get("duration_s") is not None and record["best_s"]
        }
        groups = {
            f"{budget:g}": of_group(records, f"{name}/{match}/{budget:g}") for budget in sorted(parameters["curve_s"])
        }
        curve[title] = points(groups, best)
    return Summary(tuple(figures), {"curve": curve, "ratios": ratios_of})


def points(groups: Mapping[str, Mapping[str, Document]], best: Mapping[str, float]) -> Document:
    """The curve of one set: budget → median and 95 % of the ratios, over the problems that every budget solves, lest a
    longer budget looks worse for solving a harder problem. Budgets with an answer that is not clean have none."""
    in_all = [set(rows) for rows in groups.values()]
    there = sorted(set(best).intersection(*in_all)) if in_all else []
    common = [p for p in there if all(rows[p].get("duration_s") is not None for rows in groups.values())]
    found = {}
    for budget, rows in groups.items():
        clean = unclean(rows.items()) is None
        ratios = [rows[p]["duration_s"] / best[p] for p in common] if clean else []
        solved = sum(rows[p].get("duration_s") is not None for p in there)
        ends = {"median": quantile(ratios, 0.5), "p95": quantile(ratios, 0.95)}
        found[budget] = ends | {"problems": len(ratios), "solved": solved, "of": len(there)}
    return found


def both(title: str, records: dict[str, Document], note: str) -> list[Figure]:
    """Median and 95 % of the ratios."""

    if not any(record["best_s"] for record in records.values()):
        why = "no record to compare with: python -m benchmarks.best_known makes them"
        return [Figure(f"{title}: {NAME}, {part}", None, refused=why) for part in PARTS]

    def at(share: float) -> Callable[[Any], float | None]:
        return lambda rows: quantile(
            [row["duration_s"] / row["best_s"] for row in rows if row.get("duration_s") and row["best_s"]], share
        )

    return [figure(f"{title}: {NAME}, {part}", records, at(share), note=note) for part, share in PARTS.items()]


def _note(records: dict[str, Document]) -> str:
    there = [problem for problem, record in records.items() if record["best_s"]]
    missed = [problem for problem in there if records[problem].get("duration_s") is None]
    note = f"of {len(there)} with a record, of {len(records)}"
    return note + (f"; known but not solved here: {' '.join(missed)}" if missed else "")


def lower_records(parameters: Document, records: Records) -> None:
    """What this run found better goes into the repository's records."""
    all_of_them, lowered = merged(read(PATH), new_records(parameters, records))
    if lowered:
        write(PATH, all_of_them)


SECTION = Section(
    "durations",
    "duration of the motion over the best known, by budget",
    parameters,
    items,
    measuring,
    summary,
    after=lower_records,
)
