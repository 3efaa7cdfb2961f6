"""Documents that are known, and are not requests: messages for a caller who gives one as a request."""

from __future__ import annotations

from pathlib import Path

from assur.planner.errors import InputError
from assur.scenes.faults import WHOLE, fault
from assur.scenes.plan_file import is_plan_file
from assur.scenes.schema.cell_file import CELL, TASK
from assur.scenes.schema.request import SCHEMA


def refuse_other(document: object) -> None:
    """Raises `InputError` for a document of another known kind."""
    if isinstance(document, str | Path):
        allowed = "a request, which is a mapping; assur.load reads the one in a file or of a shipped scenario"
        raise InputError(WHOLE, document, allowed)
    if not isinstance(document, dict):
        return  # its model says what a request is
    if document.get("schema") in (CELL, TASK):
        allowed = (
            f"{SCHEMA}: a cell and a task make a request together; assur.load reads the one of a task file, and "
            "assur.Cell takes a cell"
        )
        raise fault(document, ("schema",), allowed)
    status = document.get("status")
    if isinstance(status, str) and status in ("planned", "not_planned"):
        raise fault(document, ("status",), "no status: this is an answer, not a request")
    if is_plan_file(document):
        raise fault(document, ("schema",), f"{SCHEMA}: this is a plan file; its part `request` is the request")
    if isinstance(document.get("request"), dict):
        what = "a scenario" if "about" in document else "a document with a request in it"
        raise fault(document, ("request",), f"no request within: this is {what}; its part `request` is the request")
