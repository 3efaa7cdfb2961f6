"""``python -m benchmarks.kept_cell``: a new start and goal in a cell that is kept, through the public Python API.

The cells are those of problems of the sets; the starts and goals are those of the problems behind each, so that some
cannot be reached in its cell. Each answer is the first that is proved, and is there as a document inside of the time.

What building takes is measured in a cell file with fifty meshes: a new part and start in the cell that is kept, and the
same as a whole request, one after the other.
"""

from __future__ import annotations

import time
from typing import Annotated

import typer

from assur import Cell, check
from assur.planner.model.deadline import Stopwatch
from assur.scenes.requests import plan_document
from assur.scenes.tasks.kept_cell import KeptCellFile
from benchmarks.figures import Document, figure, finish, of_planned, progress
from benchmarks.judged import judged, label, problem_set
from benchmarks.machine import pin
from benchmarks.translation import Terms, request

SETS = ("static", "moving_bodies")
CELLS, FEW = 50, 5
EACH = 4
"""Starts and goals in a cell; those of one more are planned before, for the cell to be made."""


def main(quick: Annotated[bool, typer.Option("--quick", help="Few cells.")] = False) -> None:
    """Measure planning in kept cells."""
    parameters: Document = {"cells": FEW if quick else CELLS, "each": EACH, "pinned": pin()}
    groups = {name: measured(name, parameters["cells"]) for name in SETS}
    records = {f"{name}/{item}": record for name, group in groups.items() for item, record in group.items()}
    unplanned = sum(record["status"] != "planned" for record in records.values())
    note = (
        f"{' / '.join(label(name, 'position') for name in SETS)}; {len(records)} requests, {unplanned} without a plan"
    )
    figures = [
        figure(
            f"new start and goal in a kept cell, {words}",
            list(groups.values()),
            of_planned(key, share),
            "ms",
            decimals=2,
            note=note,
        )
        for words, key, share in (
            ("median", "wall_s", 0.5),
            ("95 %", "wall_s", 0.95),
            ("median, process CPU time", "cpu_s", 0.5),
        )
    ]
    meshes = with_meshes(FEW if quick else CELLS)
    figures += [
        figure(
            f"building a new part and start, 50 meshes, {words}", [meshes], of_planned(key, 0.5), "ms", bar, decimals=2
        )
        for words, key, bar in (("in a kept cell", "kept_s", (0.3,)), ("as a whole request", "whole_s", ()))
    ]
    records |= meshes
    finish("kept_cell", "a new start and goal in a kept cell", quick, parameters, records, figures)


def measured(name: str, cells: int) -> dict[str, Document]:
    """The records of the requests in the first cells of a set."""
    problems = problem_set(name)
    records: dict[str, Document] = {}
    for number in progress(range(cells), name):
        cell = Cell(request(problems.problems[number], problems.limits, Terms()))
        for ahead in range(1, EACH + 2):
            other = problems.problems[(number + ahead) % len(problems.problems)]
            problem = problems.problems[number] | {"start": other["start"], "goal": other["goal"]}
            document = request(problem, problems.limits, Terms())
            cpu, began = time.process_time(), time.perf_counter()
            answer = cell.plan(start=document["start"], task=document["task"])
            record = {"wall_s": time.perf_counter() - began, "cpu_s": time.process_time() - cpu}
            if ahead > 1:
                found = dict(answer) | {"checked": check(document, answer)["ok"]}
                findings = judged(problems, problem, found, "position", document)["findings"]
                item = f"{problem['id']} with the start and goal of {other['id']}"
                records[item] = record | {"status": answer["status"], "findings": findings}
    return records


MESHES = 50


def with_meshes(count: int) -> dict[str, Document]:
    """The records of new parts and starts in a cell with meshes: seconds of the stage `build`."""
    robot: Document = {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}}
    mesh = {"mesh": {"asset": "bracket", "unit": "mm"}}
    bodies = [
        {"name": f"mesh-{k}", "shape": mesh, "pose": {"at_mm": [30 * (k % 10) - 600, 60 * (k // 10) - 700, 0]}}
        for k in range(MESHES)
    ]
    kept = KeptCellFile({"schema": "assur-cell/1", "robot": robot, "bodies": bodies})
    records: dict[str, Document] = {}
    for number in range(count + 1):
        task = {
            "schema": "assur-task/1",
            "start": {"joints": {"j1_deg": number, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}},
            "parts": [{"name": "part", "shape": mesh, "pose": {"at_mm": [300 - number, 100 + number, 10]}}],
            "steps": [{"move": {"to": {"at_mm": [350, 0, 150]}}}],
            "options": {"stop": "first", "budget_s": 5.0},
        }
        own, whole = Stopwatch(), Stopwatch()
        made, answer = kept.plan(task, laps=own)
        other = plan_document(made.request, laps=whole)
        same = answer["trajectory"] == other["trajectory"] and check(made.request, answer)["ok"]
        if number:  # the cell is made with the first
            record = {"status": answer["status"], "findings": [] if same else ["not the answer of the request"]}
            records[f"part and start {number}"] = record | {
                "kept_s": own.seconds["build"], "whole_s": whole.seconds["build"],
            }  # fmt: skip
    return records


if __name__ == "__main__":
    typer.run(main)
