"""``python -m benchmarks.run_problems FILE.json --out OUT.jsonl``: plan every problem of a set, one line for each.

The clock runs from a request in memory, a plain dict, to the first certified answer: reading and validating the
request, building the scene, planning and proving. The process is warm (one unrelated problem was planned before), what
the request contains was never seen before. The checker judges each plan afterwards, outside of the time.
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from assur.planner.checker import check
from assur.planner.model.outcome import NotPlanned, Plan
from assur.planner.pipeline import plan
from assur.scenes.requests import scene_of
from benchmarks.problem_set import Problem, ProblemSet, ProblemSetError, read_problem_set
from benchmarks.summary import summary
from benchmarks.translation import Document, Manners, request, unrelated_problem

WARM_UP_SEED = 987_654_321
"""Of the unrelated problem; the sets were made from seeds of another form."""


def main(
    file: Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="A problem set.")],
    out: Annotated[Path, typer.Option(help="Where the answers go, one JSON object a line.")],
    budget_s: Annotated[float, typer.Option(min=0.001, help="Longest search for one problem.")] = 1.0,
    stop: Annotated[
        str, typer.Option(help="first: at the first certified plan; budget: the best in the budget.")
    ] = "first",
    match: Annotated[str, typer.Option(help="Meet a moving goal in position only, or with its velocity.")] = "position",
    limit: Annotated[int | None, typer.Option(min=1, help="Only the first problems.")] = None,
    only: Annotated[list[str] | None, typer.Option(help="Only the problem with this id; repeatable.")] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the search.")] = 0,
) -> None:
    """Plan every problem of a set and print how it went."""
    if stop not in ("first", "budget"):
        raise typer.BadParameter("first or budget", param_hint="--stop")
    if match not in ("position", "velocity"):
        raise typer.BadParameter("position or velocity", param_hint="--match")
    try:
        problems = read_problem_set(file)
        chosen = choose(problems, limit, only or [])
    except ProblemSetError as error:
        raise typer.BadParameter(str(error), param_hint="FILE") from error
    manners = Manners(
        budget_s, "first" if stop == "first" else "budget", "velocity" if match == "velocity" else "position", seed
    )
    lines = run(problems, chosen, manners, out)
    Console().print(summary(file.name, lines))


def choose(problems: ProblemSet, limit: int | None, only: Sequence[str]) -> tuple[Problem, ...]:
    """The problems to run, in the order of the file. `ProblemSetError` for an id that is not there."""
    missing = set(only) - {str(problem["id"]) for problem in problems.problems}
    if missing:
        raise ProblemSetError(f"no problem is called {', '.join(sorted(missing))}")
    chosen = tuple(problem for problem in problems.problems if not only or problem["id"] in only)
    return chosen[:limit]


def run(problems: ProblemSet, chosen: Sequence[Problem], manners: Manners, out: Path) -> list[Document]:
    """Plan the chosen problems, warm; write each line to `out` as soon as it is known; and give all lines back."""
    moving = any("v" in problem["goal"] for problem in problems.problems)
    answer(unrelated_problem(WARM_UP_SEED, moving), problems, manners)
    lines = []
    out.parent.mkdir(parents=True, exist_ok=True)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with (
        out.open("w", encoding="utf-8") as stream,
        Progress(*columns, console=Console(stderr=True), transient=True) as progress,
    ):
        for problem in progress.track(chosen, description="planning"):
            line = answer(problem, problems, manners)
            stream.write(json.dumps(line, allow_nan=False) + "\n")
            stream.flush()
            lines.append(line)
    return lines


def answer(problem: Problem, problems: ProblemSet, manners: Manners) -> Document:
    """The line for one problem. An exception is written into its line, which the recheck refuses, and the run goes on:
    a set with one fault in it still tells about the other problems."""
    line: Document = {
        "id": problem["id"],
        "status": "error",
        "match": manners.match,
        "first_s": None,
        "proved_s": None,
        "elapsed_s": None,
        "duration_s": None,
        "trajectory": None,
        "checked": None,
        "reason": None,
    }
    try:
        return line | planned(request(problem, problems.limits, manners), adaptive=manners.adaptive)
    except Exception as error:  # noqa: BLE001
        return line | {"reason": f"{type(error).__name__}: {error}"}


def planned(document: Document, *, adaptive: bool = True) -> Document:
    """What a request comes to, timed and then checked: the columns of a line that are not those of its problem."""
    began = time.perf_counter()
    scene = scene_of(document)
    built = time.perf_counter() - began
    outcome = plan(scene, adaptive=adaptive)
    elapsed = time.perf_counter() - began
    if isinstance(outcome, NotPlanned):
        return {"status": "not_planned", "elapsed_s": elapsed, "reason": f"{outcome.reason}: {outcome.sentence}"}
    # With stop: first the clock stops with the answer in hand, which the planner's own last check and the margins are
    # part of; with stop: budget only the planner can say when it had one.
    proved = built + outcome.first_s
    first = elapsed if document["options"]["stop"] == "first" else proved
    verdict = check(scene, outcome.plan)
    found = None if verdict.ok else "; ".join(str(finding) for finding in verdict.findings)
    return {
        "status": "planned",
        "first_s": first,
        "proved_s": proved,
        "elapsed_s": elapsed,
        "duration_s": outcome.plan.trajectory.end,
        "trajectory": trajectory(outcome.plan),
        "checked": verdict.ok,
        "reason": found,
    }


def trajectory(found: Plan) -> dict[str, Any]:
    """The knots, in the q of the problems: the planner's own, for this robot's flange is the tool tip."""
    knots = found.trajectory
    columns = {"time_s": knots.time, "position": knots.q, "velocity": knots.qd, "acceleration": knots.qdd}
    return {name: values.tolist() for name, values in columns.items()}


if __name__ == "__main__":
    typer.run(main)
