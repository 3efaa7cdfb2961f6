"""A document through its model: the first fault becomes a `DocumentError` at the field as it was written."""

from __future__ import annotations

import difflib
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from planner.errors import FaultError
from scenes.documents.model import NAME, REFERENCE
from scenes.faults import DocumentError, Path, as_written, dotted
from scenes.units import from_si, si_key, twin_of

Model = TypeVar("Model", bound=BaseModel)

MAX_FAULTS = 20
"""Faults that are told of one document; a reader needs no more at once."""

TYPES = {
    "float_type": "a number",
    "finite_number": "a finite number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "bool_type": "true or false",
    "string_type": "text",
    "list_type": "a list",
    "dict_type": "a mapping of fields",
    "model_type": "a mapping of fields",
    "model_attributes_type": "a mapping of fields",
    "invalid_key": "keys that are text",
    "string_unicode": "text in Unicode",
}
"""Pydantic's kinds of error in our words."""
COMPARISONS = {
    "greater_than": ("gt", "more than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}


def read(model: type[Model], document: object, prefix: Path = ()) -> Model:
    """The document as `model`. Raises `DocumentError`: unknown fields first, for they are usually misspelt others.

    `prefix`: where the document is, if it is part of another.
    """
    try:
        return model.model_validate(document)
    except ValidationError as error:
        faults = sorted(
            error.errors(include_url=False, include_input=False),
            key=lambda fault: 0 if fault["type"] == "extra_forbidden" else 1,
        )
        told = [_fault(model, document, dict(fault)) for fault in faults[:MAX_FAULTS]]
        first = told[0]
        more = tuple((dotted((*prefix, *path)), allowed) for path, _, allowed in told[1:])
        raise DocumentError(dotted((*prefix, *first[0])), first[1], first[2], more=more) from None


def _fault(model: type[BaseModel], document: object, error: dict[str, Any]) -> tuple[Path, object, str]:
    kind, context = error["type"], error.get("ctx", {})
    location: Path = tuple(part for part in error["loc"] if part != "[key]")
    if "keys" in context:
        location += tuple(context["keys"][:1])
    path, value = as_written(document, location)
    return path, value, _allowed(model, kind, context, location, path)


def _allowed(model: type[BaseModel], kind: str, context: dict[str, Any], location: Path, path: Path) -> str:
    if "allowed" in context:
        return str(context["allowed"])
    if kind == "missing":
        key = str(location[-1])
        twin = twin_of(key)
        return f"{key} or {twin}, which must be given" if twin else "a value, which must be given"
    if kind == "extra_forbidden":
        return _known(model, location)
    if kind in COMPARISONS:
        name, words = COMPARISONS[kind]
        return f"{words} {_in_unit_written(context[name], path)}"
    if kind in ("too_short", "too_long"):
        few = context.get("min_length", context.get("max_length"))
        return f"{'at least' if kind == 'too_short' else 'at most'} {few} items"
    if kind in ("string_too_short", "string_too_long"):
        few = context.get("min_length", context.get("max_length"))
        return f"{'at least' if kind == 'string_too_short' else 'at most'} {few} characters"
    if kind == "literal_error":
        return str(context["expected"])
    if kind == "string_pattern_mismatch":
        if context["pattern"] in (NAME, REFERENCE):
            return "a name: a letter, then up to 63 letters, digits, _ . -"
        return f"text that matches {context['pattern']}"
    return TYPES.get(kind, kind.replace("_", " "))


def _in_unit_written(limit: float, path: Path) -> str:
    key = next((part for part in reversed(path) if isinstance(part, str)), "")
    for part in (key, *(str(p) for p in reversed(path) if isinstance(p, str))):
        twin = si_key(part)
        if twin is not None:
            return f"{from_si(limit, twin[1]):.6g} ({twin[1]})"
    return f"{limit:.6g}"


def _known(model: type[BaseModel], location: Path) -> str:
    """The fields that the model at `location` has, the likeliest first."""
    here: type[BaseModel] | None = model
    for part in location[:-1]:
        if isinstance(part, str) and here is not None:
            here = _model_of(here, part)
    if here is None:
        raise FaultError(f"no model has the fields around {dotted(location)}")
    names = [field.alias or name for name, field in here.model_fields.items()]
    close = difflib.get_close_matches(str(location[-1]), names, n=1, cutoff=0.5)
    known = f"one of {', '.join(sorted(names))}"
    if not close:
        return known
    twin = twin_of(close[0])
    return f"{known}; did you mean {close[0]}{f' or {twin}' if twin else ''}?"


def _model_of(model: type[BaseModel], name: str) -> type[BaseModel] | None:
    """The model of a field, inside optionals, lists and mappings; the model itself for a key of a mapping."""
    for key, field in model.model_fields.items():
        if name in (key, field.alias):
            return _inside(field.annotation)
    return model


def _inside(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    for part in reversed(getattr(annotation, "__args__", ())):
        found = _inside(part)
        if found is not None:
            return found
    return None
