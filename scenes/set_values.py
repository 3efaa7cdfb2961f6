"""Values that are set in a document by their paths: `options.seed`, `bodies.table.pose.at_mm`, `task.0.move.to`.

Keys of a path are names of fields; an entry of a list is named by its `name`, or by its number from 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.faults import DocumentError, choices, dotted
from assur.scenes.units import si_key, twin_of

Keys = Sequence[str]


def with_values(document: Mapping[str, Any], values: object) -> dict[str, Any]:
    """A document in which each path has its value, in this order. What is not on a path is the same object as before.

    A field that the document leaves out is added, and one in the other unit is replaced; whether a field of that name
    exists is for the reader of the document to say. Raises `InputError` for no mapping of paths, for an entry that a
    list has not, and for a path through what is neither mapping nor list.
    """
    if not isinstance(values, dict) or not all(isinstance(path, str) and path for path in values):
        raise InputError("set", values, "a mapping of values by their paths, as in {'options.seed': 3}")
    changed: Any = dict(document)
    for path, value in values.items():
        changed = _with(changed, path.split("."), value, ())
    return dict(changed)


def _with(node: object, keys: Keys, value: object, above: tuple[str | int, ...]) -> object:
    """A copy of a node in which `value` is at these keys; `above`: the keys of the node itself."""
    if not keys:
        return value
    if isinstance(node, list):
        number, rest = _entry(node, keys, above)
        return [*node[:number], _with(node[number], rest, value, (*above, number)), *node[number + 1 :]]
    if not isinstance(node, dict):
        raise DocumentError(dotted((*above, keys[0])), node, "a mapping or a list, in which a value can be set")
    key, rest = _longest(keys, node) or (keys[0], keys[1:])
    twin = twin_of(key) or (si_key(key) or ("",))[0]
    kept = {name: each for name, each in node.items() if rest or name != twin}
    return {**kept, key: _with(kept.get(key, {} if rest else None), rest, value, (*above, key))}


def _entry(entries: list[Any], keys: Keys, above: tuple[str | int, ...]) -> tuple[int, Keys]:
    """The number of the entry that the first keys name, and the keys behind it."""
    names = [each.get("name") if isinstance(each, dict) else None for each in entries]
    found = _longest(keys, [name for name in names if name is not None])
    if found is not None:
        return names.index(found[0]), found[1]
    if keys[0].isdecimal() and int(keys[0]) < len(entries):
        return int(keys[0]), keys[1:]
    named = choices([name for name in names if isinstance(name, str)], keys[0])
    numbers = f"a number from 0 to {len(entries) - 1}" if entries else "none: the list is empty"
    raise DocumentError(dotted((*above, keys[0])), keys[0], f"{numbers}, or the name of an entry: {named}")


def _longest(keys: Keys, names: Mapping[str, object] | Sequence[object]) -> tuple[str, Keys] | None:
    """The longest name that the first keys are, for a name may have dots in it, and the keys behind it."""
    for count in range(len(keys), 0, -1):
        name = ".".join(keys[:count])
        if name in names:
            return name, keys[count:]
    return None
