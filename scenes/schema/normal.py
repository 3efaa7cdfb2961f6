"""A document as its models read it: SI keys and values, Python's own numbers, no null. One pass, before any model.

It must refuse a value that looks like a number and is no number of a document: units are converted by type, so an
`np.float64` of millimetres would be taken for as many metres.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.scenes.bounds import MAX_DEPTH, MAX_INTEGER
from assur.scenes.faults import DocumentError, Path, dotted, together
from assur.scenes.units import SI_UNITS, si_key, to_si, unit_of

SINGLE = frozenset((str, float, int, bool))
"""Types of a document's single values."""
LEAVES = SINGLE | {type(None)}
"""The same, and what is refused where a key has it."""
UNCHANGED = LEAVES - {int}
"""Types of values that are plain as they are: a whole number may be too large."""
ALLOWED = "a number that a float or an int is exactly"
OF_NAMES = frozenset(("frames", "kinds", "positions", "slots", "slot", "set"))
"""Keys of the mappings whose keys are names that the document gives, or paths, whatever they end in."""


def normal(document: object, faults: list[DocumentError] | None = None) -> Any:
    """The document in SI: `at_mm` becomes `at_m`, and what is below it is converted. The document is not changed.

    `faults` gets a key that is written in both its units, a number that is 0 in SI and not as it is written, a null,
    and a number that is not exactly one of Python's. Whatever else is no number is left for the model to refuse, NaN
    and infinity, too. Raises `DocumentError` for nesting without end, and without `faults` for those.
    """
    own: list[DocumentError] = []
    found = _inside(document, (), own if faults is None else faults)
    if own:
        raise together(own)
    return found


def plain(document: object) -> Any:
    """The document with numbers and arrays of NumPy as plain numbers and lists, and nothing else changed. Raises
    `DocumentError` at a whole number that no JSON of ours has, and for nesting without end."""
    return _inside(document, (), None)


def _inside(value: object, path: Path, faults: list[DocumentError] | None) -> Any:
    """`faults`: where those of a document go that is brought to SI; None: it is not, and a fault is raised."""
    kind, in_si = type(value), faults is not None
    if kind in LEAVES:
        if kind is int and not in_si and not -MAX_INTEGER <= value <= MAX_INTEGER:  # type: ignore[operator]
            raise DocumentError(dotted(path), value, "a whole number up to 2**53")
        return value
    if len(path) >= MAX_DEPTH:
        raise DocumentError(dotted(path[:4]), "deeper nesting", f"nesting up to {MAX_DEPTH} levels")
    if isinstance(value, dict):
        if faults is not None:
            return _mapping(value, path, faults)
        return {
            key: item if type(item) in UNCHANGED else _inside(item, (*path, str(key)), None)
            for key, item in value.items()
        }
    if isinstance(value, list):
        return _listed(value, path, faults)
    if isinstance(value, np.ndarray) and value.ndim:
        return [_inside(item, (*path, i), faults) for i, item in enumerate(value)]
    try:
        return _scalar(value[()] if isinstance(value, np.ndarray) else value, path)
    except DocumentError as fault:
        if faults is None:
            raise
        faults.append(fault)
        return value


def _listed(values: list[Any], path: Path, faults: list[DocumentError] | None) -> list[Any]:
    """Columns and rows of numbers are evaluated as a whole."""
    quick, kinds = UNCHANGED if faults is None else LEAVES, {*map(type, values)}
    if kinds <= quick or (kinds == {int} and min(values) >= -MAX_INTEGER and max(values) <= MAX_INTEGER):
        return values.copy()
    if kinds == {list} and len(path) + 1 < MAX_DEPTH:
        return [_listed(item, (*path, i), faults) for i, item in enumerate(values)]
    return [item if type(item) in quick else _inside(item, (*path, i), faults) for i, item in enumerate(values)]


def _mapping(mapping: dict[Any, Any], path: Path, faults: list[DocumentError]) -> dict[Any, Any]:
    found = {}
    of_names = bool(path) and path[-1] in OF_NAMES
    for key, value in mapping.items():
        if value is None:
            faults.append(DocumentError(dotted((*path, str(key))), None, "a value; leave the key out if there is none"))
        elif type(value) not in LEAVES:
            value = _inside(value, (*path, str(key)), faults)
        twin = None if of_names or type(key) is not str else si_key(key)
        if twin is None:
            found[key] = value
        elif twin[0] in mapping:
            faults.append(DocumentError(dotted((*path, key)), mapping[key], f"{key} or {twin[0]}, not both"))
        else:
            found[twin[0]] = converted = to_si(value, twin[1])
            if converted == 0.0 and value != 0.0 and type(value) is float:
                allowed = f"a number that is not rounded to 0 in {unit_of(twin[0], SI_UNITS)}"
                faults.append(DocumentError(dotted((*path, key)), value, allowed))
    return found


def _scalar(value: object, path: Path) -> object:
    if isinstance(value, str):
        return str(value)
    if isinstance(value, bool | np.bool_):
        return bool(value)
    if isinstance(value, np.timedelta64):  # NumPy counts it among the whole numbers, whatever its unit
        raise DocumentError(dotted(path), value, ALLOWED)
    if isinstance(value, int | np.integer):
        return int(value)
    if isinstance(value, float | np.floating):
        number = float(value)
        if number == value or number != number:
            return number
    elif not any(hasattr(value, name) for name in ("__float__", "__index__", "__complex__")):
        return value
    raise DocumentError(dotted(path), value, ALLOWED)
