"""``python -m benchmarks.profile SET``: where the milliseconds of the median request of a set go, room by room.

The set is planned once; the requests nearest to the median time are repeated under cProfile. cProfile slows small calls
down more than large ones; the figures are scaled to the time without it, so shares of code with many small calls are
somewhat too large. A library function, or a compiled kernel, counts to the room that calls it; what libraries do
inside counts to them.
"""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer
from rich.console import Console
from rich.table import Table

from benchmarks.commits import ask, planning, sources
from benchmarks.dialogue import Program
from benchmarks.judged import SETS, label, problem_set
from benchmarks.machine import pin
from benchmarks.problem_set import ProblemSet
from benchmarks.translation import Terms, request

MIDDLE = 5
"""Requests about the median that are profiled."""
SHOWN = 25
"""Rows of a table."""


def main(
    name: Annotated[str, typer.Argument(metavar="SET", help="static, moving_bodies or moving_goal.")],
    match: Annotated[str, typer.Option(help="position or velocity.")] = "position",
    limit: Annotated[int | None, typer.Option(min=1, help="Only the first problems of the set.")] = None,
    repeats: Annotated[int, typer.Option(min=1, help="How often each request is repeated.")] = 20,
    commit: Annotated[str | None, typer.Option(help="Profile this commit instead of the working tree.")] = None,
    out: Annotated[Path | None, typer.Option(help="Append the profile to this file, as a JSON line.")] = None,
) -> None:
    """Print where the milliseconds of the median request of a set go."""
    if (name, match) not in SETS:
        raise typer.BadParameter(f"{name} by {match} is none of {SETS}", param_hint="SET")
    pin()
    problems = problem_set(name)
    terms = Terms(match="velocity" if match == "velocity" else "position")
    with sources(commit) as folder, planning(folder, problems) as program:
        made = profiled(program, problems, terms, limit, repeats)
    title = f"{label(name, match)}, {commit or 'working tree'}"
    console = Console()
    for key, what in (
        ("own_ms", "room, with what it calls of libraries"),
        ("calls_ms", "function, with all that it calls"),
    ):
        table = Table(what, "ms", title=title)
        for row, value in made[key].items():
            table.add_row(row, f"{value:.2f}")
        console.print(table)
    console.print(f"all: {made['total_ms']:.2f} ms; mean of problems {' '.join(made['problems'])}")
    if out is not None:
        out.parent.mkdir(parents=True, exist_ok=True)
        with out.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps({"profile": title, **made}) + "\n")


def profiled(program: Program, problems: ProblemSet, terms: Terms, limit: int | None, repeats: int) -> Any:
    """Mean profile of the requests nearest to the median; `RuntimeError` if no problem of the set is solved."""
    requests = {str(p["id"]): request(p, problems.limits, terms) for p in problems.problems[:limit]}
    answers = {problem: ask(program, document) for problem, document in requests.items()}
    times = {problem: answer["wall_s"] for problem, answer in answers.items() if answer["status"] == "planned"}
    if not times:
        raise RuntimeError("no problem was solved, so none is the median")
    median = float(np.median(list(times.values())))
    chosen = sorted(times, key=lambda problem: abs(times[problem] - median))[:MIDDLE]
    found = [ask(program, requests[problem], profile=repeats) for problem in chosen]
    made: dict[str, Any] = {"problems": chosen, "total_ms": float(np.mean([one["total_ms"] for one in found]))}
    for key in ("own_ms", "calls_ms"):
        mean: dict[str, float] = defaultdict(float)
        for one in found:
            for row, value in one[key].items():
                mean[row] += value / len(found)
        made[key] = dict(sorted(mean.items(), key=lambda item: -item[1])[:SHOWN])
    return made


if __name__ == "__main__":
    typer.run(main)
