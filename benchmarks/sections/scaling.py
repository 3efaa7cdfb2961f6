"""How planning time grows: with the bodies of the cell, and with the control points of the task.

Bodies: 10 to 1,000 of the same density round one path, in cells of which each holds all smaller ones, so the search is
the same and only what it costs to rule the far ones out differs. Planning is timed on a built scene, building by
itself. Control points: 1 to 10 of them in the cell of ten, flown by (`via`), stopped at (`move`), and picked and placed
in turn (`pick`). Every size is built and planned anew in each repeat, one size after the other.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from assur.planner.checker import check
from assur.planner.model.outcome import NotPlanned
from assur.planner.pipeline import plan
from assur.scenes.requests import scene_of
from benchmarks.cold import forget
from benchmarks.figures import Figure, figure
from benchmarks.judged import problem_set, said, warm_up
from benchmarks.problem_set import Problem, ProblemSet
from benchmarks.recheck.arm import tool
from benchmarks.recheck.findings import recheck
from benchmarks.recheck.spline import Spline
from benchmarks.run_problems import trajectory
from benchmarks.section import Document, Item, Records, Section, Summary
from benchmarks.sections.cells import KINDS, LATEST_S, crowd, tour
from benchmarks.translation import Manners, request

BODIES, FEW_BODIES = (10, 30, 100, 300, 1000), (10, 100, 1000)
POINTS, FEW_POINTS = (1, 2, 5, 10), (1, 10)
CELLS, FEW_CELLS = 12, 3
REPEATS, FEW_REPEATS = 5, 2
MEET_M = 2e-6
"""How far from a control point the tool may be when it is met."""


def parameters(quick: bool) -> Document:
    return {
        "bodies": list(FEW_BODIES if quick else BODIES),
        "points": list(FEW_POINTS if quick else POINTS),
        "cells": FEW_CELLS if quick else CELLS,
        "repeats": FEW_REPEATS if quick else REPEATS,
        "stop": "first",
    }


def items(parameters: Document) -> list[Item]:
    return [Item(kind, f"{kind}/{cell}") for kind in ("bodies", *KINDS) for cell in range(parameters["cells"])]


@contextmanager
def measuring(parameters: Document, _group: str) -> Iterator[Callable[[str], Document]]:
    problems = problem_set("static")
    warm_up(problems)

    def measure(item: str) -> Document:
        kind, _, cell = item.partition("/")
        sizes = parameters["bodies" if kind == "bodies" else "points"]
        asked = {size: _asked(kind, int(cell), size, max(sizes), problems) for size in sizes}
        record: Document = {"findings": [], "sizes": {str(size): {"build_s": [], "plan_s": []} for size in sizes}}
        record["answers"] = parameters["repeats"] * len(sizes)
        for _ in range(parameters["repeats"]):
            for size in sizes:
                built, planned, found = timed(problems, *asked[size])
                row = record["sizes"][str(size)]
                row["build_s"].append(built)
                row["plan_s"].append(planned)
                record["findings"] += [f"{size}: {text}" for text in found]
        return record

    yield measure


def _asked(
    kind: str, cell: int, size: int, most: int, problems: ProblemSet
) -> tuple[Problem, Document, list[list[float]]]:
    if kind == "bodies":
        problem = crowd(cell, size)
        return problem, request(problem, problems.limits, Manners()), [problem["goal"]["pos"]]
    return tour(KINDS[KINDS.index(kind)], cell, size, most, problems.limits)


def timed(
    problems: ProblemSet, problem: Problem, document: Document, met: list[list[float]]
) -> tuple[float, float, list[str]]:
    """Seconds of building and of planning, and what is wrong with the answer; no plan is wrong, too: all have one."""
    forget()
    began = time.perf_counter()
    scene = scene_of(document)
    built = time.perf_counter()
    outcome = plan(scene)
    planned = time.perf_counter()
    if isinstance(outcome, NotPlanned):
        return built - began, planned - built, [f"not planned: {outcome.sentence}"]
    knots = trajectory(outcome.plan)
    line = {
        "status": "planned",
        "checked": check(scene, outcome.plan).ok,
        "duration_s": outcome.plan.trajectory.end,
        "trajectory": knots,
    }
    found = [said(finding) for finding in recheck(problems, problem, line, "position", LATEST_S)]
    times = [arrival.time for arrival in outcome.plan.arrivals]
    return built - began, planned - built, found + missed(knots, times, met)


def missed(knots: Document, times: list[float], met: list[list[float]]) -> list[str]:
    """Control points that the tool is not at when it is said to meet them."""
    if len(times) != len(met):
        return [f"{len(times)} arrivals at {len(met)} control points"]
    time_s, *columns = (np.array(knots[name]) for name in ("time_s", "position", "velocity", "acceleration"))
    q = Spline.through(time_s, *columns).evaluate(np.array(times))
    off = np.linalg.norm(tool(q, np.zeros_like(q)).position - np.array(met), axis=-1)
    return [f"point {i} is missed by {off[i] * 1e6:.2f} µm" for i in range(len(met)) if not off[i] <= MEET_M]


def summary(parameters: Document, records: Records) -> Summary:
    figures: list[Figure] = []
    data: Document = {}
    for kind in ("bodies", *KINDS):
        sizes = [str(size) for size in parameters["bodies" if kind == "bodies" else "points"]]
        of_kind = {item: record for item, record in records.items() if item.startswith(kind + "/")}
        clean = [record for record in of_kind.values() if not record["findings"]]
        least, most = sizes[0], sizes[-1]
        name = "bodies" if kind == "bodies" else f"control points ({kind})"

        def grown(rows: Any, key: str = "plan_s", least: str = least, most: str = most) -> float:
            return float(
                np.median([np.median(r["sizes"][most][key]) / np.median(r["sizes"][least][key]) for r in rows])
            )

        figures.append(figure(f"planning, {least} to {int(most):,} {name}", of_kind, grown, "times"))
        if kind == "bodies":
            figures.append(
                figure(
                    f"building, {least} to {int(most):,} bodies",
                    of_kind,
                    lambda rows, grown=grown: grown(rows, "build_s"),  # type: ignore[misc]
                    "times",
                )
            )
        data[kind] = {
            size: {
                key.removesuffix("_s") + "_ms": 1e3
                * float(np.median([np.median(r["sizes"][size][key]) for r in clean]))
                for key in ("build_s", "plan_s")
            }
            for size in sizes
            if clean
        }
    return Summary(tuple(figures), data)


SECTION = Section("scaling", "planning time over bodies and over control points", parameters, items, measuring, summary)
