"""Documents and files that are known, and are no requests or scenarios: messages for a caller who gives one as such."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.faults import NOTHING, WHOLE, DocumentError, fault
from assur.scenes.plan_file import FORMS, is_plan_file
from assur.scenes.schema.cell_file import CELL, TASK
from assur.scenes.schema.request import SCHEMA
from assur.scenes.schema.robots import FAMILIES

BUNDLE = "assur-bundle/"
"""What the version of every proof bundle begins with."""


def refuse_other(document: object) -> None:
    """Raises `InputError` for a document of another known kind."""
    if isinstance(document, str | Path):
        allowed = "a request, which is a mapping; assur.load reads the one in a file or of a shipped scenario"
        raise InputError(WHOLE, document, allowed)
    if not isinstance(document, dict):
        return  # its model says what a request is
    schema = document["schema"] if isinstance(document.get("schema"), str) else ""
    if schema in (CELL, TASK):
        allowed = (
            f"{SCHEMA}: a cell and a task make a request together; assur.load reads the one of a task file, and "
            "assur.Cell takes a cell"
        )
        raise fault(document, ("schema",), allowed)
    status = document.get("status")
    if isinstance(status, str) and status in ("planned", "not_planned"):
        raise fault(document, ("status",), "no status: this is an answer, not a request")
    if schema.startswith(BUNDLE):
        raise fault(document, ("schema",), f"{SCHEMA}: this is a proof bundle, which assur prove reads")
    if is_plan_file(document):
        raise fault(document, ("schema",), f"{SCHEMA}: this is a plan file; its part `request` is the request")
    if isinstance(document.get("request"), dict):
        what = "a scenario" if "about" in document else "a document with a request in it"
        raise fault(document, ("request",), f"no request within: this is {what}; its part `request` is the request")


TAKEN = "a scenario or a task in YAML, a request or a plan file in JSON"
BEGINNING_BYTES = 4096
"""Length of the part of a file that shows its kind."""
KINDS = (
    (
        re.compile(rb"<(!doctype\s+html|html)\b"),
        "a web page",
        "a browser shows it; the plan of a report is in the plan file that assur plan --out wrote",
    ),
    (re.compile(rb"<(?s:.*)<robot\b|<robot\b"), "a robot in URDF", "assur robots import makes a robot's file of it"),
    (re.compile(rb"<[?!\w]"), "XML", ""),
    (
        re.compile(rb"solid\b|ply\s|gltf"),
        "a mesh",
        "a scenario has it as shape: {{mesh: {{file: {name}, unit: mm}}}}",
    ),
    (
        re.compile(rb"(#[^\n]*\n)*time_s,"),
        "motion over time in CSV",
        "assur check-trajectory FILE {name} checks it, and assur fit-limits {name} reads recorded motion",
    ),
)
"""How a file begins, in small letters, what it is, and what is done with it."""


def _of_schema(begins: str) -> str:
    """How a document is recognized, in YAML or JSON, whose schema begins so."""
    return rf"""(^|[{{,])\s*["']?schema["']?\s*:\s*["']?{begins}"""


OURS = tuple(
    (re.compile(pattern.encode(), re.MULTILINE), what)
    for pattern, what in (
        (_of_schema(FORMS), "a plan file"),
        (_of_schema(BUNDLE), "a proof bundle"),
        (_of_schema(TASK), "a task file"),
        (_of_schema(CELL), "a cell file"),
        (_of_schema(rf'{SCHEMA}"\s*,\s*"status"'), "an answer without its request"),
        (r"^request\s*:", "a scenario"),
        (_of_schema(SCHEMA), "a request"),
        (rf"^({'|'.join(FAMILIES)})\s*:", "a robot's file"),
    )
)
"""A pattern in the first part of each document of this project, and what the document is."""


def refuse_text(data: bytes, path: Path) -> None:
    """Raises `DocumentError` for the content of a file of another known kind."""
    beginning = _beginning(data)
    for begins, what, use in KINDS:
        if begins.match(beginning):
            does = f"; {use.format(name=path.name)}" if use else ""
            raise DocumentError(path.name, what, f"{TAKEN}{does}")


def refuse_but(wanted: str, data: bytes, path: Path, allowed: str) -> None:
    """Raises `DocumentError` for the content of a file of a known kind that is not the `wanted` one."""
    beginning = _beginning(data)
    found = [what for begins, what, _ in KINDS if begins.match(beginning)]
    found += [what for pattern, what in OURS if pattern.search(beginning)]
    if found and wanted not in found:
        raise DocumentError(path.name, found[0], allowed)


def _beginning(data: bytes) -> bytes:
    return data[:BEGINNING_BYTES].removeprefix(b"\xef\xbb\xbf").lstrip().lower()


def refuse_document(document: Any, path: Path) -> None:
    """Raises `DocumentError` for the document of a robot's file, and of a task or a cell that does not say so."""
    if not isinstance(document, dict) or "request" in document:
        return
    if not document.keys().isdisjoint(FAMILIES):
        raise DocumentError(path.name, "a robot's file", f"{TAKEN}; assur robots {path.name} shows it")
    if "schema" not in document:
        kind, schema = ("task", TASK) if "steps" in document else ("cell", CELL)
        if kind == "task" or not document.keys().isdisjoint(("kinds", "positions", "slots")):
            allowed = f"schema: {schema}, which must be given: the keys are those of a {kind}"
            raise DocumentError("schema", NOTHING, allowed, 1)
