"""Places in a document: paths of keys and indices, what stands there, and how it is changed."""

from __future__ import annotations

from typing import Any

Place = tuple[str | int, ...]
NAMING = frozenset({"name", "frame", "part", "to", "robot", "model", "at", "body", "with", "contact_with"})
"""Keys below which names of the document stand."""


def every_place(document: Any, below: Place = ()) -> list[Place]:
    """All places but the root, in the order in which they are written."""
    found: list[Place] = []
    keys = document if isinstance(document, dict) else range(len(document)) if isinstance(document, list) else ()
    for key in keys:
        found.append((*below, key))
        found += every_place(document[key], (*below, key))
    return found


def value_at(document: Any, place: Place) -> Any:
    """What stands at a place."""
    for key in place:
        document = document[key]
    return document


def put(document: Any, place: Place, value: Any) -> None:
    """Puts a value at a place whose parent is there."""
    value_at(document, place[:-1])[place[-1]] = value


def removed(document: Any, place: Place) -> None:
    """Takes away what stands at a place."""
    del value_at(document, place[:-1])[place[-1]]


def numbers_in(document: Any) -> list[Place]:
    """The places of numbers; truth values are none."""
    return [place for place in every_place(document) if type(value_at(document, place)) in (int, float)]


def names_in(document: Any) -> list[Place]:
    """The places of text below a key that holds a name."""
    return [
        place
        for place in every_place(document)
        if isinstance(value_at(document, place), str) and any(key in NAMING for key in place)
    ]
