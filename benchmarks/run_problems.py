"""``python -m benchmarks.run_problems FILE.json --out OUT.jsonl``: plan every problem of a set, one line for each.

The clock runs from a request in memory, a plain dict, to the first certified answer: reading and validating the
request, building the scene, planning and proving. The process is warm (unrelated problems were planned before), what
the request contains was never seen before. The checker judges each plan once more afterwards, outside of the time.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.checker_refusals import keep
from benchmarks.commits import ask, planning
from benchmarks.figures import quantile
from benchmarks.machine import ROOT
from benchmarks.problem_set import Problem, ProblemSet, read_problem_set
from benchmarks.translation import Document, Terms, request


def main(
    file: Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="A problem set.")],
    out: Annotated[Path, typer.Option(help="Where the answers go, one JSON object a line.")],
    budget_s: Annotated[float, typer.Option(min=0.001, help="Longest search for one problem.")] = 1.0,
    stop: Annotated[
        str, typer.Option(help="first: at the first certified plan; budget: the best in the budget.")
    ] = "first",
    match: Annotated[str, typer.Option(help="Meet a moving goal in position, or with its velocity.")] = "position",
    limit: Annotated[int | None, typer.Option(min=1, help="Only the first problems.")] = None,
    only: Annotated[list[str] | None, typer.Option(help="Only the problem with this id; repeatable.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the search.")] = 0,
) -> None:
    """Plan every problem of a set and print how it went."""
    problems = read_problem_set(file)
    chosen = choose(problems, limit, only or [])
    if stop not in ("first", "budget") or match not in ("position", "velocity"):
        raise typer.BadParameter("--stop is first or budget, --match position or velocity")
    terms = Terms(
        budget_s, "first" if stop == "first" else "budget", "velocity" if match == "velocity" else "position", seed
    )
    lines = []
    out.parent.mkdir(parents=True, exist_ok=True)
    with out.open("w", encoding="utf-8") as stream:
        for line in track(
            run(problems, chosen, terms, out.parent),
            "planning",
            len(chosen),
            console=Console(stderr=True),
            transient=True,
        ):
            stream.write(json.dumps(line, allow_nan=False) + "\n")
            stream.flush()
            lines.append(line)
    Console().print(summary(file.name, lines))
    if any(refused(line) for line in lines):
        raise typer.Exit(1)


def choose(problems: ProblemSet, limit: int | None, only: Sequence[str]) -> tuple[Problem, ...]:
    """The problems to run, in the order of the file. `ValueError` for an id that is not there."""
    missing = set(only) - {str(problem["id"]) for problem in problems.problems}
    if missing:
        raise ValueError(f"no problem is called {', '.join(sorted(missing))}")
    chosen = tuple(problem for problem in problems.problems if not only or problem["id"] in only)
    return chosen[:limit]


def run(problems: ProblemSet, chosen: Sequence[Problem], terms: Terms, out: Path) -> Iterator[Document]:
    """The line of each chosen problem, as soon as it is known. A fault in one is written into its line. If the checker
    refuses a plan, its request is kept in the folder `out`."""
    with planning(ROOT, problems) as program:
        for problem in chosen:
            line: Document = {"id": problem["id"], "match": terms.match}
            try:
                document = request(problem, problems.limits, terms)
                line |= ask(program, document)
            except ValueError as error:
                line |= {"status": "error", "reason": str(error)}
            if refused(line):
                keep(out, f"{problem['id']}-{terms.match}", document, line)
            yield line


def refused(line: Document) -> bool:
    """Whether the checker refused a plan, in the search or at the end."""
    return bool(line.get("checker_refused"))


def summary(name: str, lines: Sequence[Document]) -> Table:
    """Counts over all problems, times over the solved ones, and below them which were not solved, by reason."""
    solved = [line for line in lines if line["status"] == "planned" and line["checked"]]
    table = Table("", "", title=name, show_header=False)
    table.add_row("problems", str(len(lines)))
    for limit in (0.1, 1.0):
        table.add_row(f"solved within {limit:g} s", str(sum(line["first_s"] <= limit for line in solved)))
    for title, key, scale in (("first answer", "first_s", 1e3), ("duration", "duration_s", 1.0)):
        values = [quantile([scale * line[key] for line in solved], share) for share in (0.5, 0.95, 1.0)]
        shown = " / ".join("none" if value is None else f"{value:.3g}" for value in values)
        table.add_row(f"{title}, p50 / p95 / longest", f"{shown} {'ms' if scale > 1 else 's'}")
    table.add_row("refused by the checker", str(sum(map(refused, lines))))
    table.add_section()
    reasons = {str(line["id"]): str(line["reason"]).partition(":")[0] for line in lines if line["status"] != "planned"}
    for reason, count in Counter(reasons.values()).most_common():
        table.add_row(f"{count} {reason}", " ".join(problem for problem, why in reasons.items() if why == reason))
    return table


if __name__ == "__main__":
    typer.run(main)
