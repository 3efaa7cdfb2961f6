"""Cells that were sent once, in a worker: each is read and built with its first plan, and kept for the next ones."""

from __future__ import annotations

import time
from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

from assur.api.documents import to_json
from assur.api.problems import Problem
from assur.api.workers.answer_parts import Parts, part_of
from assur.api.workers.file_jobs import file_of
from assur.api.workers.jobs import TASK, Answer, Reply, bordered, document_in, how_planned, repeatable
from assur.api.workers.worker_process import Line
from assur.planner.errors import InputError
from assur.scenes.meshes import process_covers
from assur.scenes.meshes.folder import DIGEST, TOUCHED_S
from assur.scenes.requests import Detail, parse_json
from assur.scenes.schema.cell_file import TASK as SCHEMA
from assur.scenes.tasks.kept_cell import KeptCellFile

MOST_CELLS = 16
"""Cells that a worker keeps, those that were planned last."""


@dataclass(eq=False)
class _Cell:
    """A cell, the digests of the meshes that it names, and when their use was last noted, s."""

    file: KeptCellFile
    meshes: frozenset[str]
    noted: float


_cells: OrderedDict[str, _Cell] = OrderedDict()


def check_cell(body: bytes, line: Line) -> Reply:
    """Whether the document in `body` is a cell, with all that it names. Raises nothing: faults are the reply."""

    def work() -> Answer:
        document = document_in(body, "a cell", line, "check_cell")
        KeptCellFile(document).check()
        return Answer(to_json({"status": "read"}), "read")

    return bordered(work)


def plan_task(digest: str, body: bytes, certificate: Detail, parts: Parts, most_budget_s: float, line: Line) -> Reply:
    """The answer to the task in `body`, in the cell with this digest; `parts`: what of it is wanted. The rest as
    `plan`."""
    given = how_planned(certificate, most_budget_s, line)
    laps = given["laps"]

    def work() -> Answer:
        _, answer = kept_cell(digest).plan(_task_in(body), **given)
        laps.lap("write")
        found = to_json(part_of(answer, parts))
        laps.lap("write")
        reason = str(answer.get("reason", "")) if answer["status"] == "not_planned" else ""
        return Answer(found, str(answer["status"]), reason, laps.seconds, repeatable(answer))

    return bordered(work)


def plan_task_file(digest: str, body: bytes, how: dict[str, Any], most_budget_s: float, line: Line) -> Reply:
    """The file of the plan of the task in `body`, in the cell with this digest, as `plan_file`."""
    given = how_planned("full", most_budget_s, line)

    def work() -> Answer:
        made, answer = kept_cell(digest).plan(_task_in(body), **given)
        return file_of(made.request, answer, how, given["laps"])

    return bordered(work)


def _task_in(body: bytes) -> dict[str, Any]:
    """The task in a body. Raises `Problem`, and `InputError` where it names a cell."""
    task = document_in(body, TASK)
    if "cell" in task:
        raise InputError("cell", task["cell"], "no cell: the address names it")
    return {"schema": SCHEMA, **task}


def kept_cell(digest: str) -> KeptCellFile:
    """The cell with this digest; its use is noted, and that of its meshes. Raises `Problem` where it is not here."""
    folder, now = process_covers().folder, time.monotonic()
    if folder is None or not folder.use(digest, "cell"):
        _cells.pop(digest, None)
        raise unknown(digest)
    cell = _cells.get(digest)
    if cell is None:
        content = folder.content(digest, "cell")
        if content is None:
            raise unknown(digest)
        document = parse_json(content)
        cell = _cells[digest] = _Cell(KeptCellFile(document), frozenset(_digests(document)), now)
        while len(_cells) > MOST_CELLS:
            _cells.popitem(last=False)
    _cells.move_to_end(digest)
    if now - cell.noted > TOUCHED_S:
        cell.noted = now
        for mesh in cell.meshes:
            folder.use(mesh)
    return cell.file


def unknown(digest: str) -> Problem:
    """The problem of a request for a cell that is not here."""
    return Problem("cell-unknown", f"Send the document of the cell with PUT /v1/cells/{digest}.")


def _digests(document: Any) -> list[str]:
    """The digests of the meshes that a document names."""
    found: list[str] = []
    left = [document]
    for each in left:  # which grows
        if isinstance(each, dict):
            digest = each.get("sha256")
            found += [digest] if isinstance(digest, str) and DIGEST.fullmatch(digest) else []
            left += each.values()
        elif isinstance(each, list):
            left += each
    return found
