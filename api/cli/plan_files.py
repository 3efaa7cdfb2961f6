"""Plan files on the command line: a request and the answer to it, together or one by one."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from assur.api.cli.cell_reading import read_cell
from assur.api.cli.inputs import STANDARD, Target, json_file
from assur.api.documents import plan_file_bytes
from assur.planner.errors import InputError
from assur.scenes.faults import NOTHING, fault
from assur.scenes.plan_file import PlanFile, in_request, is_plan_file, plan_file_in
from assur.scenes.requests import validate
from assur.scenes.schema.differences import difference, stated_at

PLAN_OR_CELL = "A plan file, as `assur plan --out` writes it; or a cell: a scenario file, a request, a scenario's name."
"""What FILE is, where a command is about an answer."""
ANSWER = "An answer to the cell in FILE: a plan file, or the answer alone. Not needed if FILE is a plan file."
"""What PLAN is."""
NEEDED = "an answer to FILE, or in place of FILE a plan file, as `assur plan --out` writes it"


def answer_for(given: Target, path: Path | None) -> Any:
    """The answer that belongs to the cell that was given, which is read: that in the file PLAN, else that in FILE.

    Raises `InputError`, also for a plan file whose request is not that of the cell; or `OSError`.
    """
    found = answer_if_any(given, path)
    if found is None:
        raise InputError("PLAN", NOTHING, f"{NEEDED}; this FILE has a cell only")
    return found


def answer_if_any(given: Target, path: Path | None) -> Any:
    """The same, or None where no file has an answer."""
    cell = read_cell(given)
    digest = cell.scene.digest
    if path is None:
        if given.plan_file is None:
            return None
        given.plan_file.held_together(digest)
        return given.plan_file.plan
    document = json_file(path, "PLAN", "an answer or a plan file")
    if not is_plan_file(document):
        return document
    held = plan_file_in(document)
    with in_request():
        own = validate(held.request)
    at = difference(own, cell.request)
    if at is not None:
        there = stated_at(cell.document, at)
        allowed = f"what FILE has there{there and f': {there}'}; this file has a plan for another request"
        other = fault(held.request, at, allowed)
        raise InputError(f"PLAN: request.{other.field}", other.value, other.allowed)
    held.held_together(own.digest)
    return held.plan


def write(out: Path, given: Target, answer: dict[str, Any]) -> None:
    """Writes the plan file of an answer to what was given, to standard output where `out` is -. Raises `InputError`
    where it would be too long to be read."""
    data = plan_file_bytes(PlanFile(given.whole, answer, given.title, given.about), "--out")
    if str(out) == STANDARD:
        sys.stdout.buffer.write(data)
    else:
        out.write_bytes(data)
