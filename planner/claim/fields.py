"""Fields of a document's objects and the columns of a table that they are: one description for writing and reading."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from assur.planner.claim import columns as c
from assur.planner.errors import InputError

Document = dict[str, Any]
Kind = Literal["number", "whole", "flag"]
JOINTS = 0
"""As `Field.count`: one number for each joint of the robot, in columns for `columns.MOST_JOINTS`."""
LARGEST_WHOLE = 2**53
"""Beyond this a double is no longer every whole number."""


@dataclass(frozen=True, slots=True)
class Field:
    """A key and its column. `count`: the value is a list of so many numbers, from this column on; None: it is one.
    `open`: the list may be shorter, and columns that it leaves are -1. `empty`: the list is empty where that column is
    that number, 0 or 1. `unread`: so many numbers that follow in the list have no column, and are written as 0."""

    key: str
    column: int
    kind: Kind = "number"
    count: int | None = None
    open: bool = False
    empty: tuple[int, float] | None = None
    unread: int = 0


def written(form: Iterable[Field], row: Sequence[float], joints: int = 0) -> Document:
    """The object of a row, for a robot with so many joints."""
    return {field.key: _value(field, row, joints) for field in form}


def _value(field: Field, row: Sequence[float], joints: int) -> Any:
    if field.count is None:
        return _plain(field.kind, row[field.column])
    if field.empty is not None and row[field.empty[0]] == field.empty[1]:
        return []
    values = [_plain(field.kind, x) for x in row[field.column : field.column + (field.count or joints)]]
    return [x for x in values if x >= 0.0] if field.open else [*values, *[0.0] * field.unread]


def _plain(kind: Kind, value: float) -> Any:
    if kind == "flag":
        return value > 0.0
    return int(value) if kind == "whole" else value


def read_row(form: Iterable[Field], document: Document, width: int, joints: int = 0) -> list[float]:
    """The row (width,) of an object; columns without a field are 0. Raises `InputError` for a value of another kind."""
    row = [0.0] * width
    for field in form:
        key, value = field.key, document[field.key]
        if field.count is None:
            row[field.column] = scalar(field.kind, value, key)
            continue
        if field.empty is not None:
            row[field.empty[0]] = field.empty[1] if value == [] else 1.0 - field.empty[1]
            if value == []:
                continue
        count = field.count or joints
        found = numbers(value, key, None if field.open else count + field.unread, kind=field.kind)
        if field.open and (len(found) > count or min(found, default=0.0) < 0.0):
            raise InputError(key, value, f"up to {count} numbers from 0 on")
        row[field.column : field.column + count] = [*found, *[-1.0] * (count - len(found))][:count]
    return row


def scalar(kind: Kind, value: object, key: str) -> float:
    """A value as a number. Raises `InputError` for one of another kind, and for what is not finite."""
    if kind == "flag":
        if not isinstance(value, bool):
            raise InputError(key, value, "true or false")
        return float(value)
    if kind == "whole":
        if type(value) is not int or not -1 <= value <= LARGEST_WHOLE:
            raise InputError(key, value, "a whole number from -1 on")
        return float(value)
    if type(value) not in (int, float) or not -c.LIMITLESS <= value <= c.LIMITLESS:  # type: ignore[operator]
        raise InputError(key, value, "a finite number")
    return float(value)  # type: ignore[arg-type]


def numbers(value: object, key: str, count: int | None = None, room: int = 0, *, kind: Kind = "number") -> list[float]:
    """A list of numbers, `count` of them, filled up with zeros to `room`. Raises `InputError` otherwise."""
    found = [scalar(kind, x, key) for x in items(value, key, count)]
    if room and len(found) > room:
        raise InputError(key, len(found), f"up to {room} numbers")
    return [*found, *[0.0] * (room - len(found))]


def index(value: object, count: int, key: str) -> int:
    """The number of one of `count` things. Raises `InputError` otherwise."""
    if type(value) is not int or not 0 <= value < count:
        raise InputError(key, value, f"a whole number from 0 on, below {count}")
    return value


def items(value: object, key: str, count: int | None = None) -> list[Any]:
    """A list, of `count` items. Raises `InputError` otherwise."""
    if not isinstance(value, list) or (count is not None and len(value) != count):
        raise InputError(key, value, "a list" if count is None else f"a list of {count}")
    return value


def member(value: object, form: Iterable[Field], *others: str) -> Document:
    """An object with exactly the keys of a form and these others. Raises `InputError` otherwise."""
    keys = {*others, *(field.key for field in form)}
    if not isinstance(value, dict) or set(value) != keys:
        raise InputError("bundle", value, f"an object with the keys {', '.join(sorted(keys))}")
    return value


def text(value: object, key: str) -> str:
    """A text. Raises `InputError` otherwise."""
    if not isinstance(value, str):
        raise InputError(key, value, "a text")
    return value
