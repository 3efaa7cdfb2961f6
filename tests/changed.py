"""A copy of a document with other values at some of its places.

A place is written as faults name it: `bodies[1].pose.frame`. `[+]` is the place after the last item of a list. Keys
that cannot be written so stand in a tuple.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any, Final

GONE: Final = object()
"""In place of a value: there is none."""

Place = str | tuple[str | int, ...]


def steps(place: Place) -> tuple[str | int, ...]:
    """The keys and numbers that lead to a place."""
    return place if isinstance(place, tuple) else tuple(_read(place))


def _read(place: str) -> Iterator[str | int]:
    for number, end, key in re.findall(r"\[(?:(\d+)|(\+))\]|([^.\[\]]+)", place):
        yield int(number) if number else end or key


def own(document: Any) -> Any:
    """A copy of a document in which nothing is in two places, so that each of them can be changed by itself."""
    if isinstance(document, Mapping):
        return {key: own(item) for key, item in document.items()}
    return [own(item) for item in document] if isinstance(document, list) else document


def changed(document: Any, changes: Mapping[Any, Any]) -> Any:
    """A copy of `document` with the value of each of the `changes` at its place; all of it is the copy's own."""
    made = own(document)
    for place, value in changes.items():
        *above, last = steps(place)
        here = made
        for step in above:
            here = here[step]
        if value is GONE:
            del here[last]
        elif last == "+":
            here.append(own(value))
        else:
            here[last] = own(value)
    return made
