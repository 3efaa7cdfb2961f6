"""Changes of documents: answers, bundles and requests.

A path names what is changed: keys and numbers of items, `*` for all items, `lasting` for the first row that takes time,
`middle` for the item in the middle, or the name of an item.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

Document = dict[str, Any]
Change = Callable[[Document], object]


def places(items: Any, path: list[str]) -> Iterator[tuple[Any, Any]]:
    """Each container and key that a path names."""
    key, *rest = path
    keys: list[Any] = [key]
    if isinstance(items, list):
        if key == "*":
            keys = list(range(len(items)))
        elif key == "lasting":
            keys = [next(i for i, row in enumerate(items) if row["t1"] > row["t0"])]
        elif key == "middle":
            keys = [len(items) // 2]
        elif key.lstrip("-").isdigit():
            keys = [int(key)]
        else:
            keys = [next(i for i, item in enumerate(items) if item["name"] == key)]
    elif key == "*":
        keys = list(items)
    for each in keys:
        if not rest:
            yield items, each
        elif items[each] is not None:
            yield from places(items[each], rest)


def put(path: str, value: Any) -> Change:
    """Puts a value, or what a function makes of the old value, where a path says."""

    def change(document: Document) -> None:
        for items, key in list(places(document, path.split("."))):
            items[key] = value(items[key]) if callable(value) else value

    return change


def plus(by: float) -> Callable[[float], float]:
    return lambda x: x + by


def times(by: float) -> Callable[[Any], Any]:
    return lambda x: [by * each for each in x] if isinstance(x, list) else by * x


def update(path: str, **values: Any) -> Change:
    """Puts values into the object that is where a path says, under some keys."""
    return put(path, lambda old: {**old, **values})


def append(path: str, item: Any) -> Change:
    """Puts an item behind the others of a list."""
    return put(path, lambda old: [*old, item])


def drop(path: str) -> Change:
    """Removes the field or the item at a path."""

    def change(document: Document) -> None:
        for items, key in list(places(document, path.split("."))):
            del items[key]

    return change


def reverse(path: str) -> Change:
    """Turns a list round."""
    return put(path, lambda old: old[::-1])


def both(*changes: Change) -> Change:
    """One change after the other."""

    def change(document: Document) -> None:
        for each in changes:
            each(document)

    return change
