"""``python -m benchmarks.first_answer``: time to the first answer of each problem, and how many are solved.

One core, `stop: first`, clearance and margin 0, from a request in memory to the checked answer; three seeds, each a
single run, pooled. With `--beside COMMIT` the planner of that commit answers each request in turn with this one.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import replace
from typing import Annotated, Any

import typer

from benchmarks.commits import ask, planning, sources
from benchmarks.figures import Document, Figure, Records, figure, finish, of_planned, progress
from benchmarks.judged import SETS, judged, label, problem_set
from benchmarks.machine import ROOT, pin
from benchmarks.translation import Terms, request

BUDGET_S = 1.0
SEEDS = 3
SAMPLE = 10
"""A sample takes every tenth problem, with one seed."""
OURS = "this commit"


def main(
    quick: Annotated[bool, typer.Option("--quick", help="A sample of the problems.")] = False,
    beside: Annotated[str | None, typer.Option(help="A commit whose planner answers in turn with this one.")] = None,
) -> None:
    """Measure the time to the first answer over all sets."""
    seeds = 1 if quick else SEEDS
    parameters: Document = {"budget_s": BUDGET_S, "seeds": seeds, "every": SAMPLE if quick else 1, "pinned": pin()}
    records: dict[str, Document] = {}
    for name, match in SETS:
        problems = problem_set(name)
        with ExitStack() as stack:
            programs = {OURS: stack.enter_context(planning(ROOT, problems))}
            if beside is not None:
                programs[beside] = stack.enter_context(planning(stack.enter_context(sources(beside)), problems))
            runs = [(seed, problem) for seed in range(seeds) for problem in problems.problems[:: parameters["every"]]]
            for i, (seed, problem) in enumerate(progress(runs, label(name, match))):
                document = request(problem, problems.limits, Terms(BUDGET_S, "first", match, seed))
                for by in list(programs) if i % 2 else reversed(programs):
                    answer = judged(problems, problem, ask(programs[by], document), match, document)
                    records[f"{by}/{label(name, match)}/{seed}/{problem['id']}"] = answer
    figures = figures_of(records, OURS)
    if beside is not None:
        others = {each.name: each.reached() for each in figures_of(records, beside)}
        figures = [replace(each, beside=f"{beside[:10]}: {others[each.name]}") for each in figures]
    finish("first_answer", "the sets: solved, and time to the first answer", quick, parameters, records, figures)


def figures_of(records: Records, by: str) -> list[Figure]:
    """The figures of one planner, a value for each set."""
    labels = [label(*pair) for pair in SETS]
    groups = [{item: r for item, r in records.items() if item.startswith(f"{by}/{name}/")} for name in labels]

    def within(limit: float) -> Any:
        return lambda rows: 100 * sum(r["status"] == "planned" and r["first_s"] <= limit for r in rows) / len(rows)

    everything = {item: record for group in groups for item, record in group.items()}
    return [
        figure("first answer, median", groups, of_planned("wall_s", 0.5), "ms", (1.5,) * 4, decimals=2),
        figure("first answer, 95 %, process CPU time", groups, of_planned("cpu_s", 0.95), "ms", (5, 20, 20, 12)),
        figure("first answer, 95 %, wall time", groups, of_planned("wall_s", 0.95), "ms"),
        figure("solved within 0.1 s", groups, within(0.1), "%", (93, 95, 96, 95), at_least=True, note=_late(groups)),
        figure("solved within 1 s", groups, within(1.0), "%", (94, 96, 97, 97), at_least=True),
        figure("check of an answer, median", [everything], of_planned("check_s", 0.5), "ms", (0.5,), decimals=2),
        *refusals(everything),
    ]


def refusals(records: Records) -> list[Figure]:
    """Counts that must be 0: the prover accepts and the checker refuses, or the recheck reports a fault."""
    refused = sum(record.get("checker_refused", 0) for record in records.values())
    wrong = sum(record.get("findings") != [] for record in records.values())
    answers = sum(record["status"] == "planned" for record in records.values())
    return [
        Figure("prover accepts, checker refuses", (float(refused),), "", (0.0,), decimals=0),
        Figure("answers that the recheck refuses", (float(wrong),), "", (0.0,), decimals=0, note=f"of {answers}"),
    ]


def _late(groups: Sequence[Records]) -> str:
    """Problems that some seed did not solve at all."""
    names = {item.rpartition("/")[2] for group in groups for item, r in group.items() if r["status"] != "planned"}
    return f"not solved by every seed: {' '.join(sorted(names))}" if names else ""


if __name__ == "__main__":
    typer.run(main)
