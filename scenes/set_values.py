"""Values that are set in a document by their paths: `options.seed`, `bodies.table.pose.at_mm`, `task.0.move.to`.

Keys of a path are names of fields; an entry of a list is named by its `name`, a step by that of the step, or by its
number from 0, `task.0` or `task[0]`.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import AbstractContextManager
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_DEPTH
from assur.scenes.faults import DocumentError, choices, documented, dotted, likeliest, raised_as
from assur.scenes.units import from_si, si_key, to_si, twin_of

Keys = Sequence[str]
Path = tuple[str | int, ...]
NUMBER = re.compile(r"\[(\d+)\]")
GIVEN = "--set "
"""Mark of values that are set on the command line."""
OF_NAMES = ("frames", "kinds", "positions", "slots", "streams")
"""Where the mappings are whose keys are names: a path through a name that is not there is misspelt."""


def with_values(document: Mapping[str, Any], values: object) -> dict[str, Any]:
    """A document in which each path has its value, in this order. What is not on a path is the same object as before.

    A field that the document leaves out is added, and one in the other unit is replaced, or converted where a part of
    it is set; whether a field of that name exists is for the reader of the document to say. Raises `InputError` for no
    mapping of paths, for an entry that a list has not, for a path through a name that is not there, and for one
    through what is neither mapping nor list.
    """
    changed: Any = dict(document)
    for path, value in _paths(values).items():
        changed = _with(changed, _keys(path), value, (), [])
    return dict(changed)


def unknown_paths(values: Mapping[str, object], mark: str, fields: Iterable[str]) -> dict[str, DocumentError]:
    """A fault for each path that begins with none of these fields, at the path behind its `mark`."""
    known, found = sorted(set(fields)), dict[str, DocumentError]()
    for path, value in values.items():
        first, _, rest = str(path).partition(".")
        if first.partition("[")[0] not in known:
            within = rest.partition(".")[0].partition("[")[0] in known
            names = f"{', '.join(known)}; did you mean {rest}?" if within else likeliest(first, known)
            found[path] = DocumentError(f"{mark}{path}", value, f"a path that begins with one of {names}")
    return found


class Changed:
    """A `document` in which values were set, as `with_values` does, that knows which of its fields were. `mark`: what
    is written before a path where the values are, such as `set.`: faults of the paths are there."""

    def __init__(self, document: Mapping[str, Any], values: object, mark: str) -> None:
        """Raises `InputError`, as `with_values`, at the path that is wrong."""
        self.document, self.mark = dict(document), mark
        self._whole: dict[str, str] = {}
        """The path of each value, by the field that it became."""
        self._made: dict[str, str] = {}
        """The same by each field around it that the document had not."""
        for path, value in _paths(values).items():
            made: list[Path] = []
            try:
                self.document = dict(_with(self.document, _keys(path), value, (), made))  # type: ignore[call-overload]
            except InputError as error:
                raise DocumentError(f"{mark}{path}", error.value, error.allowed) from error
            field = dotted(made[-1])
            self._whole = {
                each: of for each, of in self._whole.items() if not each.startswith((f"{field}.", f"{field}["))
            }
            self._whole[field] = path
            self._made |= {dotted(each): path for each in made[:-1]}

    @property
    def fields(self) -> tuple[str, ...]:
        """The fields that were set."""
        return tuple(self._whole)

    def located(self) -> AbstractContextManager[None]:
        """A fault of the document inside is at the place where the value was set."""
        return raised_as(lambda error: documented(error).relocated(self.field))

    def field(self, field: str) -> str:
        """Where a field of the document was written: where it was set, or in the document."""
        return self.origin(field) or field

    def origin(self, field: str) -> str | None:
        """Where a field of the document was set, in the words of the paths; None: it was not."""
        head = field
        while head and head not in self._whole and head not in self._made:
            head = head[: max(head.rfind("."), head.rfind("["), 0)]
        if not head:
            return None
        if head in self._whole:
            return f"{self.mark}{self._whole[head]}{field[len(head) :]}"
        return f"{self.mark}{self._made[head] if head == field else field}"


def _paths(values: object) -> dict[str, object]:
    if not isinstance(values, dict) or not all(isinstance(path, str) and path for path in values):
        raise InputError("set", values, "a mapping of values by their paths, as in {'options.seed': 3}")
    return values


def _keys(path: str) -> Keys:
    keys = NUMBER.sub(r".\1", path).split(".")
    if len(keys) > MAX_DEPTH:
        raise InputError("set", path, f"a path of at most {MAX_DEPTH} keys")
    return keys


def _with(node: object, keys: Keys, value: object, above: Path, made: list[Path]) -> object:
    """A copy of a node in which `value` is at these keys; `above`: the keys of the node itself. `made` gets the path of
    each node that is new, that of the value last."""
    if not keys:
        made.append(above)
        return value
    if isinstance(node, list):
        number, rest = _entry(node, keys, above)
        return [*node[:number], _with(node[number], rest, value, (*above, number), made), *node[number + 1 :]]
    if not isinstance(node, dict):
        raise DocumentError(dotted((*above, keys[0])), node, "a mapping or a list, in which a value can be set")
    key, rest = _longest(keys, node) or (keys[0], keys[1:])
    if rest and len(above) == 1 and above[0] in OF_NAMES and key not in node:
        raise DocumentError(dotted((*above, key)), key, f"one of {choices(node, key)}")
    twin = twin_of(key) or (si_key(key) or ("",))[0]
    if rest and key not in node and twin not in node:
        made.append((*above, key))
    kept = {name: each for name, each in node.items() if name != twin}
    inside = node.get(key, {}) if twin not in node else in_other_unit(node[twin], twin)
    return {**kept, key: _with(inside, rest, value, (*above, key), made)}


def in_other_unit(value: object, key: str) -> object:
    """A value, whose key has a unit, in the other unit of that quantity: of `at_mm` as `at_m` has it."""
    twin = si_key(key)
    if twin is not None:
        return to_si(value, twin[1])
    if isinstance(value, list):
        return [in_other_unit(each, key) for each in value]
    if isinstance(value, dict):
        return {name: in_other_unit(each, key) for name, each in value.items()}
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return from_si(float(value), si_key(str(twin_of(key)))[1]) if number else value  # type: ignore[arg-type, index]


def _entry(entries: list[Any], keys: Keys, above: Path) -> tuple[int, Keys]:
    """The number of the entry that the first keys name, and the keys behind it."""
    names = [_name_of(each) for each in entries]
    found = _longest(keys, [name for name in names if name is not None])
    if found is not None:
        return names.index(found[0]), found[1]
    if keys[0].isdecimal() and int(keys[0]) < len(entries):
        return int(keys[0]), keys[1:]
    named = [name for name in names if isinstance(name, str)]
    allowed = f"a number from 0 to {len(entries) - 1}" if entries else "none: the list is empty"
    if named:
        allowed += f", or the name of an entry: {choices(named, keys[0])}"
    if above == ("steps",):
        allowed += "; a transfer is one step of the task, and its picks and places are steps of the request alone"
    raise DocumentError(dotted((*above, keys[0])), keys[0], allowed)


def _name_of(entry: object) -> object:
    """The name of an entry of a list, or of the step that it is; None: it has none."""
    if not isinstance(entry, dict):
        return None
    inside = next(iter(entry.values()), None)
    return inside.get("name") if isinstance(inside, dict) and len(entry) == 1 else entry.get("name")


def _longest(keys: Keys, names: Mapping[str, object] | Sequence[object]) -> tuple[str, Keys] | None:
    """The longest name that the first keys are, for a name may have dots in it, and the keys behind it."""
    for count in range(len(keys), 0, -1):
        name = ".".join(keys[:count])
        if name in names:
            return name, keys[count:]
    return None
