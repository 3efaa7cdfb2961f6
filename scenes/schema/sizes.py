"""How many items and keys a document has, looked at before its models read it: a model makes a fault of each item that
is wrong, and looks at how many there are behind them. What is refused here costs no more than its length."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from annotated_types import MaxLen
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from assur.scenes.bounds import MAX_JOINTS
from assur.scenes.faults import DocumentError, Path, dotted
from assur.scenes.schema.model import ByName
from assur.scenes.units import si_key

MOST_UNKNOWN = 20
"""So many keys more than a model has fields are left to the model, which tells what was probably meant by each."""


@dataclass(frozen=True, eq=False)
class _Shape:
    """What may stand at a place: of a list or an open mapping how many items at most (None: any number) and what they
    are, of a model its fields that hold such things, how many fields it has, and how many keys are names (`named`)."""

    most: int | None = None
    item: _Shape | None = None
    fields: dict[str, _Shape] | None = None
    keys: int = 0
    named: int = 0


def check_sizes(model: type[BaseModel], document: object) -> None:
    """Raises `DocumentError` at the first list or mapping that has more items than `model` takes there."""
    _check(_of_model(model), document, ())


def _check(shape: _Shape, value: object, path: Path) -> None:
    if isinstance(value, list):
        if shape.most is not None and len(value) > shape.most:
            raise DocumentError(dotted(path), value, f"at most {shape.most} items, not {len(value)}")
        if shape.item is not None:
            for i, item in enumerate(value):
                _check(shape.item, item, (*path, i))
    elif isinstance(value, dict):
        if shape.fields is not None:
            _check_model(shape, shape.fields, value, path)
        elif shape.most is not None and len(value) > shape.most:
            raise DocumentError(dotted(path), value, f"at most {shape.most} items, not {len(value)}")
        elif shape.item is not None:
            for key, item in value.items():
                _check(shape.item, item, (*path, str(key)))


def _check_model(shape: _Shape, fields: dict[str, _Shape], value: dict[Any, Any], path: Path) -> None:
    if shape.named:
        if len(value) > shape.keys + shape.named:
            also = f" and {shape.keys} other fields" if shape.keys else ""
            raise DocumentError(dotted(path), value, f"at most {shape.named} joints{also}, not {len(value)} keys")
    elif len(value) > shape.keys + MOST_UNKNOWN:
        raise DocumentError(dotted(path), value, f"at most {shape.keys} fields, not {len(value)} keys")
    if not fields:
        return
    for key, item in value.items():
        if isinstance(item, dict | list):
            twin = si_key(key)
            below = fields.get(key if twin is None else twin[0])
            if below is not None:
                _check(below, item, (*path, key))


@cache
def _of_model(model: type[BaseModel]) -> _Shape:
    found = {}
    for name, field in model.model_fields.items():
        shape = _of(field.annotation, tuple(field.metadata))
        if shape is not None:
            found[field.alias or name] = shape
    return _Shape(fields=found, keys=len(model.model_fields), named=MAX_JOINTS if issubclass(model, ByName) else 0)


def _of(annotation: Any, metadata: tuple[Any, ...]) -> _Shape | None:
    """The shape that an annotation allows; None: a single value, or a list of such, whose length its model looks at."""
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
        return None if item is None else _Shape(most=_most(metadata), item=item)
    return None


def _most(metadata: tuple[Any, ...]) -> int | None:
    inner = (part for each in metadata for part in (each.metadata if isinstance(each, FieldInfo) else (each,)))
    return next((part.max_length for part in inner if isinstance(part, MaxLen)), None)
