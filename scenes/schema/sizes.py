"""The number of items and keys of a document, and whether it is plain and in SI: seen before its models read it.

A model makes a fault of each wrong item before it checks their number. A refusal here costs no more than the document's
length.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from annotated_types import MaxLen
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from assur.scenes.bounds import MAX_JOINTS
from assur.scenes.faults import DocumentError, Path, dotted
from assur.scenes.schema.model import ByName
from assur.scenes.schema.normal import SINGLE
from assur.scenes.units import si_key, twin_of

MOST_UNKNOWN = 20
"""Most keys in addition to a model's fields that are left to the model, which suggests a field for each."""


@dataclass(frozen=True, eq=False)
class _Shape:
    """What may be at a place: how many items or keys at most (None: any number), the words of a refusal, which take
    their number, and what they are: all alike (`item`), or by the name of a field. Single values are left out.
    `names`: those of all fields in SI."""

    most: int | None
    allowed: str
    item: _Shape | None = None
    fields: dict[object, _Shape] = field(default_factory=dict)
    names: frozenset[str] = frozenset()


def check_sizes(model: type[BaseModel], document: object) -> bool:
    """Raises `DocumentError` at the first list or mapping that has more items than `model` takes there. Returns whether
    the document is as `normal` makes it: in SI and of plain types, as most that programs write."""
    if _is_normal(_of_model(model), document):
        return True
    left: list[tuple[_Shape, Any, Path]] = [(_of_model(model), document, ())]
    while left:
        shape, value, path = left.pop()
        mapping = isinstance(value, dict)
        if not (mapping or isinstance(value, list)):
            continue
        if shape.most is not None and len(value) > shape.most and (mapping or shape.item):
            raise DocumentError(dotted(path), value, shape.allowed.format(len(value)))
        inside = [
            (below, item, (*path, str(key) if mapping else key))
            for key, item in (value.items() if mapping else enumerate(value))
            if type(item) not in SINGLE and (below := shape.item or shape.fields.get(key)) is not None
        ]
        left += reversed(inside)  # the first is read next
    return False


def _is_normal(shape: _Shape, document: object) -> bool:
    """Whether a document of this shape is as `normal` makes it, and nothing in it has more items than may be."""
    left: list[tuple[_Shape, Any]] = [(shape, document)]
    for shape, value in left:  # which grows
        kind = type(value)
        if (kind is not dict and kind is not list) or (shape.most is not None and len(value) > shape.most):
            return False
        if kind is list:
            left += [(shape.item or _ANYTHING, item) for item in value if type(item) not in SINGLE]
            continue
        if not value.keys() <= shape.names and any(map(si_key, value)):
            return False
        for key, item in value.items():
            # most lists are points
            if type(item) not in SINGLE and (type(item) is not list or not SINGLE.issuperset(map(type, item))):
                left.append((shape.item or shape.fields.get(key) or _ANYTHING, item))
    return True


_ANYTHING = _Shape(-1, "")
"""What a model says nothing of, in few levels: what is deeper counts as not normal."""
for _ in range(8):
    _ANYTHING = _Shape(None, "", _ANYTHING)


@cache
def _of_model(model: type[BaseModel]) -> _Shape:
    fields, keys = model.model_fields.items(), len(model.model_fields)
    shapes = {field.alias or name: _of(field.annotation, tuple(field.metadata)) for name, field in fields}
    most, allowed = keys + MOST_UNKNOWN, f"at most {keys} fields, not {{}} keys"
    if issubclass(model, ByName):
        also = f" and {keys} other fields" if keys else ""
        most, allowed = keys + MAX_JOINTS, f"at most {MAX_JOINTS} joints{also}, not {{}} keys"
    known: dict[object, _Shape] = {
        key: shape for name, shape in shapes.items() if shape for key in (name, twin_of(name) or name)
    }
    return _Shape(most, allowed, None, known, frozenset(shapes))


def _of(annotation: Any, metadata: tuple[Any, ...]) -> _Shape | None:
    """The shape that an annotation allows; None: a single value, or a list of such, whose length its model checks."""
    if get_origin(annotation) is Annotated:
        first, *more = get_args(annotation)
        return _of(first, (*metadata, *more))
    if get_origin(annotation) in (Union, UnionType):
        options = [shape for part in get_args(annotation) if (shape := _of(part, metadata)) is not None]
        return options[0] if len(options) == 1 else None
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return _of_model(annotation)
    if get_origin(annotation) in (list, dict):
        item = _of(get_args(annotation)[-1], ())
        most = _most(metadata)
        return None if item is None else _Shape(most, f"at most {most} items, not {{}}", item)
    return None


def _most(metadata: tuple[Any, ...]) -> int | None:
    inner = (part for each in metadata for part in (each.metadata if isinstance(each, FieldInfo) else (each,)))
    return next((part.max_length for part in inner if isinstance(part, MaxLen)), None)
