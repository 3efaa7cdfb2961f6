"""The first value in which two requests, or two other documents, differ."""

from __future__ import annotations

import json
from collections.abc import Iterable
from typing import Any

from assur.scenes.faults import NOTHING, Path, as_written
from assur.scenes.schema.request import RequestDocument

LONGEST_SHOWN = 100
"""Most characters of a value that a message repeats."""


def difference(
    one: RequestDocument, other: RequestDocument, fields: Iterable[str] = RequestDocument.model_fields
) -> Path | None:
    """The path to the first value of these fields that two requests have not in common; None: there is none."""
    for key in fields:
        if getattr(one, key) != getattr(other, key):
            stated = (each.model_dump(by_alias=True, exclude_none=True, include={key}) for each in (one, other))
            if path := first_difference(*stated):
                return path
    return None


def stated_at(document: object, path: Path) -> str:
    """What a document has at a path, as it is written, with its key; empty: it is too long to be repeated."""
    written, value = as_written(document, path)
    text = "nothing" if value is NOTHING else json.dumps({written[-1]: value})[1:-1]
    return text if len(text) <= LONGEST_SHOWN else ""


def first_difference(one: Any, other: Any) -> Path:
    """The path to the first value that two documents, which differ, have not in common. A list of plain values is one
    value."""
    if isinstance(one, list) and isinstance(other, list) and any(isinstance(each, dict) for each in (*one, *other)):
        one, other = dict(enumerate(one)), dict(enumerate(other))
    if isinstance(one, dict) and isinstance(other, dict):
        for key in {**other, **one}:
            if key not in one or key not in other:
                return (key,)
            if one[key] != other[key]:
                return (key, *first_difference(one[key], other[key]))
    return ()
