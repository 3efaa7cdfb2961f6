"""JSON Schema of the documents that are written by hand, with both ways to write each quantity."""

from __future__ import annotations

from typing import Any, Literal

from assur.scenes.scenarios import ScenarioDocument
from assur.scenes.schema.cell_file import CellDocument, TaskDocument
from assur.scenes.schema.ik import IkDocument
from assur.scenes.schema.model import Document
from assur.scenes.schema.request import SCHEMA, RequestDocument

Kind = Literal["request", "scenario", "cell", "task"]
KINDS: dict[Kind, type[Document]] = {
    "request": RequestDocument,
    "scenario": ScenarioDocument,
    "cell": CellDocument,
    "task": TaskDocument,
}
"""Kinds of documents. A scenario is a file with a request."""


def request_schema() -> dict[str, Any]:
    """JSON Schema of a request."""
    return {**schema_of("request"), "$id": SCHEMA}


def schema_of(kind: Kind) -> dict[str, Any]:
    """JSON Schema of a document of this kind."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **KINDS[kind].model_json_schema()}


def ik_schema() -> dict[str, Any]:
    """JSON Schema of a question of `ik_document`."""
    return IkDocument.model_json_schema()
