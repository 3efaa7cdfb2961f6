"""The planner and the checker, called from outside: the only module of the oracle that imports them."""

from __future__ import annotations

import json
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.bundle import bundle_document
from assur.scenes.requests import check_document, plan_document, validate
from benchmarks.judge.poses import Document

BAD_INPUT = "BAD_INPUT"
"""In place of a reason: the request is bad input."""


def as_si(document: object) -> Document:
    """A request as the judge reads it: every quantity in SI, without fields that are not stated."""
    return dict(validate(document).model_dump(mode="json", exclude_unset=True, by_alias=True))


def planned(request: Document) -> tuple[Document | None, str]:
    """The answer with its certificate; None and the field if the request is bad input."""
    try:
        return dict(plan_document(request, certificate="full")), ""
    except InputError as error:
        return None, error.field


def checked(request: Document, answer: Document) -> list[dict[str, Any]] | None:
    """Findings of the product's own checker; None if it does not take answers of this kind."""
    try:
        return list(check_document(request, answer)["findings"])
    except InputError:
        if answer["status"] == "planned":
            raise
        return None


def shown(request: Document, answer: Document) -> str:
    """Why the second checker does not accept the bundle of a planned answer; empty if it does."""
    from assur.prover.prove import prove  # which needs the packages of the proof

    accepted, result = prove(json.dumps(bundle_document(request, answer)).encode())
    return "" if accepted else str(result[0])
