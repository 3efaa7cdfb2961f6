"""Fields of a document's objects and the columns of a table that they are: one description for writing and reading."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from assur.planner.claim import columns as c
from assur.planner.errors import InputError

Document = dict[str, Any]
Kind = Literal["number", "whole", "flag"]
LARGEST_WHOLE = 2**53
"""Beyond this a double is no longer every whole number."""


@dataclass(frozen=True, slots=True)
class Field:
    """A key and its column. `count`: the value is a list of so many numbers, from this column on; else it is one.
    `open`: the list may be shorter, and columns that it leaves are -1."""

    key: str
    column: int
    kind: Kind = "number"
    count: int | None = None
    open: bool = False


def written(form: Iterable[Field], row: Sequence[float]) -> Document:
    """The object of a row."""
    return {field.key: _value(field, row) for field in form}


def _value(field: Field, row: Sequence[float]) -> Any:
    if field.count is None:
        return _plain(field.kind, row[field.column])
    values = [_plain(field.kind, x) for x in row[field.column : field.column + field.count]]
    return [x for x in values if x >= 0.0] if field.open else values


def _plain(kind: Kind, value: float) -> Any:
    if kind == "flag":
        return value > 0.0
    return int(value) if kind == "whole" else value


def read_row(form: Iterable[Field], document: Document, width: int, where: str) -> list[float]:
    """The row (width,) of an object; columns without a field are 0. Raises `InputError` for a value of another kind."""
    row = [0.0] * width
    for field in form:
        at, value = f"{where}.{field.key}", document[field.key]
        if field.count is None:
            row[field.column] = scalar(field.kind, value, at)
            continue
        values = items(value, at, None if field.open else field.count)
        if field.open and len(values) > field.count:
            raise InputError(at, len(values), f"up to {field.count} numbers")
        numbers = [scalar(field.kind, x, at) for x in values]
        if field.open and any(x < 0.0 for x in numbers):
            raise InputError(at, value, "numbers from 0 on")
        row[field.column : field.column + field.count] = [*numbers, *[-1.0] * (field.count - len(numbers))]
    return row


def scalar(kind: Kind, value: object, where: str) -> float:
    """A value as a number. Raises `InputError` for one of another kind, and for what is not finite."""
    if kind == "flag":
        if not isinstance(value, bool):
            raise InputError(where, value, "true or false")
        return float(value)
    if kind == "whole":
        if type(value) is not int or not -1 <= value <= LARGEST_WHOLE:
            raise InputError(where, value, "a whole number from -1 on")
        return float(value)
    if type(value) not in (int, float) or not -c.LIMITLESS <= value <= c.LIMITLESS:  # type: ignore[operator]
        raise InputError(where, value, "a finite number")
    return float(value)  # type: ignore[arg-type]


def numbers(value: object, where: str, count: int | None = None, room: int | None = None) -> list[float]:
    """A list of numbers, `count` of them, filled up with zeros to `room`. Raises `InputError` otherwise."""
    found = [scalar("number", x, where) for x in items(value, where, count)]
    if room is None:
        return found
    if len(found) > room:
        raise InputError(where, len(found), f"up to {room} numbers")
    return [*found, *[0.0] * (room - len(found))]


def index(value: object, count: int, where: str) -> int:
    """The number of one of `count` things. Raises `InputError` otherwise."""
    if type(value) is not int or not 0 <= value < count:
        raise InputError(where, value, f"a whole number from 0 to {count - 1}")
    return value


def items(value: object, where: str, count: int | None = None) -> list[Any]:
    """A list, of `count` items. Raises `InputError` otherwise."""
    if not isinstance(value, list) or (count is not None and len(value) != count):
        raise InputError(where, value, "a list" if count is None else f"a list of {count}")
    return value


def member(value: object, keys: Iterable[str], where: str) -> Document:
    """An object with exactly these keys. Raises `InputError` otherwise."""
    if not isinstance(value, dict) or set(value) != set(keys):
        raise InputError(where, value, f"an object with the keys {', '.join(sorted(keys))}")
    return value


def text(value: object, where: str) -> str:
    """A text. Raises `InputError` otherwise."""
    if not isinstance(value, str):
        raise InputError(where, value, "a text")
    return value
