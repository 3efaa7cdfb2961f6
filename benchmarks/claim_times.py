"""``python -m benchmarks.claim_times``: how long it takes to fill the tables of a plan's claim, and to write its bundle
as a document.

Each call is made in turn with the others, so none has warm caches of its own; process CPU time, medians.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable
from statistics import median
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from assur.planner.claim.filling import cell_of, claim_of, with_plan
from assur.planner.model.phases import phases
from assur.scenes import requests
from assur.scenes.bundle import bundle_of
from assur.scenes.kernels import load
from assur.scenes.scenarios import shipped
from benchmarks.figures import Document
from benchmarks.judged import problem_set
from benchmarks.translation import Terms, request

KINDS = ("cell", "scene", "plan", "bundle")


def main(
    moves: Annotated[int, typer.Option(min=1, help="Static moves, of the set's problems in order.")] = 20,
    repeats: Annotated[int, typer.Option(min=1, help="How often each call is made.")] = 31,
) -> None:
    """Print how long the tables of a cell, of a scene on it, and of a plan on that take, beside the whole bundle."""
    load()
    problems = problem_set("static")
    static = [request(problem, problems.limits, Terms()) for problem in problems.problems]
    table = Table("plan", *(f"{kind}, ms" for kind in KINDS), "plan / bundle")
    for name, documents, most in (("static move", static, moves), ("demo", [dict(shipped("demo").request)], 1)):
        found = [each for each in (times(document, repeats) for document in documents[: 2 * most]) if each][:most]
        medians = {kind: median(each[kind] for each in found) for kind in KINDS}
        share = medians["plan"] / medians["bundle"]
        table.add_row(f"{name} ({len(found)})", *(f"{medians[kind]:.3f}" for kind in KINDS), f"{share:.3f}")
    Console().print(table)


def times(document: Document, repeats: int) -> dict[str, float]:
    """The times of the claim of a request's plan, ms; none if it has no plan."""
    answer = requests.plan_document(document)
    if answer["status"] != "planned":
        return {}
    cell = requests.cell_of(document)
    scene, plan = cell.scene, requests.read_plan(cell, answer)[0]
    base, of_plan = claim_of(scene), phases(scene, plan.legs, plan.arrivals)
    calls: dict[str, Callable[[], object]] = {
        "cell": lambda: cell_of(scene),
        "scene": lambda: claim_of(scene, base.cell),
        "plan": lambda: with_plan(base, plan, of_plan),
        "bundle": lambda: bundle_of(scene, plan),
    }
    spent: dict[str, list[float]] = {kind: [] for kind in KINDS}
    gc.disable()  # a collection would add to the time of one call
    try:
        for _ in range(repeats):
            for kind, call in calls.items():
                begin = time.process_time_ns()
                call()
                spent[kind].append((time.process_time_ns() - begin) / 1e6)
    finally:
        gc.enable()
    return {kind: median(each) for kind, each in spent.items()}


if __name__ == "__main__":
    typer.run(main)
