"""Answers as small as they are wanted: `fields` and `digits` of an address."""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple, get_args, get_origin, is_typeddict

from typing_extensions import get_type_hints
from typing_extensions import is_typeddict as is_typed

from assur.planner.errors import InputError
from assur.scenes.faults import likeliest
from assur.scenes.schema.answer import NotPlannedAnswer, PlannedAnswer
from assur.scenes.schema.read import options_of

NAMES = ("fields", "digits")
MOST_FIELDS = 64
LEAST_DIGITS, MOST_DIGITS = 3, 17
"""With 17 significant digits every number is the same to the bit."""
ALWAYS = "status"
"""Field that every answer has, whatever is wanted of it."""


class Parts(NamedTuple):
    """What is wanted of an answer: paths of its fields (none: all), and significant digits (None: all)."""

    fields: tuple[tuple[str, ...], ...] = ()
    digits: int | None = None


def parts_wanted(fields: str | None, digits: str | None) -> Parts:
    """What the parameters of an address say. Raises `InputError` that names the parameter."""
    paths: list[tuple[str, ...]] = []
    names = [] if fields is None else fields.split(",")
    if len(names) > MOST_FIELDS:
        raise InputError("fields", f"{len(names)} fields", f"at most {MOST_FIELDS}")
    for name in names:
        path = tuple(name.split("."))
        models: tuple[Any, ...] = (PlannedAnswer, NotPlannedAnswer)
        for count, key in enumerate(path):
            known = _below(models)
            if key not in known:
                around = ".".join(path[:count])
                what = "a list" if any(get_origin(model) is list for model in models) else "a value"
                known_there = f"one of {likeliest(key, known)}{f' in {around}' if around else ''}"
                raise InputError("fields", name, known_there if known else f"{around}, which is {what} and given whole")
            models = known[key]
        paths.append(path)
    if digits is None:
        return Parts(tuple(paths))
    if not (digits.isascii() and digits.isdigit() and len(digits) < 3 and LEAST_DIGITS <= int(digits) <= MOST_DIGITS):
        raise InputError("digits", digits, f"a whole number from {LEAST_DIGITS} to {MOST_DIGITS}")
    return Parts(tuple(paths), int(digits))


@cache
def _below(models: tuple[Any, ...]) -> dict[str, tuple[Any, ...]]:
    """The fields of the mappings among some types, with their types."""
    found: dict[str, tuple[Any, ...]] = {}
    for model in models:
        if is_typeddict(model) or is_typed(model):
            for key, hint in get_type_hints(model).items():
                found[key] = (*found.get(key, ()), *options_of(_bare(hint)))
    return found


def _bare(hint: Any) -> Any:
    """A type without the mark that its field may be left out."""
    return get_args(hint)[0] if "NotRequired" in str(getattr(hint, "__origin__", "")) else hint


def part_of(answer: dict[str, Any], parts: Parts) -> dict[str, Any]:
    """The fields of an answer that are wanted and that it has, and its status, with numbers rounded."""
    found = answer
    if parts.fields:
        found = {ALWAYS: answer[ALWAYS]}
        for path in parts.fields:
            _copy(answer, found, path)
    if parts.digits is None:
        return found
    rounded: dict[str, Any] = _rounded(found, parts.digits)
    return rounded


def _copy(source: Any, found: dict[str, Any], path: tuple[str, ...]) -> None:
    """Copies what is at a path of a mapping, where it is there. What is copied is not changed."""
    key, *rest = path
    if not isinstance(source, dict) or key not in source:
        return
    if not rest or found.get(key) is source[key]:
        found[key] = source[key]
    elif isinstance(source[key], dict):
        _copy(source[key], found.setdefault(key, {}), tuple(rest))


def _rounded(value: Any, digits: int) -> Any:
    if type(value) is float:
        return float(f"{value:.{digits}g}")
    if isinstance(value, dict):
        return {key: _rounded(each, digits) for key, each in value.items()}
    return [_rounded(each, digits) for each in value] if isinstance(value, list | tuple) else value
