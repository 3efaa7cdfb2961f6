"""A document through its model: its faults become a `DocumentError` at the fields as they were written."""

from __future__ import annotations

import difflib
import json
from collections.abc import Callable, Sequence
from functools import cache
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, TypeAdapter, ValidationError, create_model
from pydantic.fields import FieldInfo
from typing_extensions import get_type_hints, is_typeddict

from assur.planner.errors import FaultError
from assur.scenes.bounds import FAR_M
from assur.scenes.faults import MOST_FAULTS, DocumentError, Path, as_written, dotted, likeliest, together
from assur.scenes.schema.model import NAME, REFERENCE
from assur.scenes.schema.normal import normal
from assur.scenes.schema.sizes import check_sizes
from assur.scenes.schema.stated import PLAIN, STATED
from assur.scenes.units import SI_UNITS, any_unit, from_si, si_key, twin_of, unit_of

FEW_FIELDS = 6
"""If a mapping has at most so many fields, a message lists them where something else is in place of the mapping."""
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
FOLLOWS = "default_factory_not_called"
"""Pydantic's kind of error for a default that depends on a field which has a fault."""
COMPARISONS = {
    "greater_than": ("gt", "more than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}


def read(model: Any, document: object) -> Any:
    """The document, which may be written in any units and with numbers of NumPy, as `model`. Raises `DocumentError`."""
    return _read(model, document, adapter(model))


def _read(model: Any, document: object, by: TypeAdapter[Any]) -> Any:
    faults: list[DocumentError] = []
    found = document if check_sizes(model, document) else normal(document, faults)
    return _validated(model, document, (), lambda: by.validate_python(found), faults)


def read_fields(model: type[BaseModel], document: dict[str, Any]) -> dict[str, Any]:
    """The values of those fields of `model` that the document has, which are read as `read` reads them. Raises
    `DocumentError`."""
    found: BaseModel = _read(model, document, _of_fields(model))
    return {name: getattr(found, name) for name in found.model_fields_set}


def read_normal(model: Any, normal_document: object, document: object, prefix: Path = ()) -> Any:
    """A document in SI as `model`, a pydantic model or a TypedDict; `document`: as it was written.

    `prefix`: where the document is, if it is part of another. Raises `DocumentError`: unknown fields first, for they
    are usually misspelt others.
    """
    return _validated(model, document, prefix, lambda: adapter(model).validate_python(normal_document))


def read_written(model: Any, written: object, document: object, prefix: Path = ()) -> Any:
    """As `read_normal`, of a model with members of enumerations and other forms, as JSON has them."""
    return _validated(model, document, prefix, lambda: adapter(model).validate_json(json.dumps(written), strict=True))


def _validated(
    model: Any, document: object, prefix: Path, validated: Callable[[], Any], before: Sequence[DocumentError] = ()
) -> Any:
    """What `validated` returns. Raises the faults that were seen `before`, and those that it finds."""
    try:
        read = validated()
    except ValidationError as error:
        faults = [
            (location, fault["type"], fault.get("ctx", {}))
            for fault in error.errors(include_url=False, include_input=False)
            if fault["type"] != FOLLOWS and (location := _location(model, document, fault["loc"])) is not None
        ]
        # the other fields of a document of another kind are not compared
        faults = [fault for fault in faults if fault[:2] == (("schema",), "literal_error")] or faults
        faults.sort(key=lambda fault: 0 if fault[1] == "extra_forbidden" else 1)
        errors = [
            DocumentError(dotted((*prefix, *path)), value, allowed)
            for path, value, allowed in (_fault(model, document, *fault) for fault in faults[:MOST_FAULTS])
        ]
        errors[0].left_out = max(0, len(faults) - MOST_FAULTS)
        raise together([*before, *errors]) from None
    if before:
        raise together(before)
    return read


@cache
def adapter(model: Any) -> TypeAdapter[Any]:
    """What validates documents of a type."""
    return TypeAdapter(model)


@cache
def _of_fields(model: type[BaseModel]) -> TypeAdapter[Any]:
    """That of a model with the same fields, all of them optional."""
    fields: dict[str, Any] = {
        name: (field.rebuild_annotation(), FieldInfo(default=None, alias=field.alias))
        for name, field in model.model_fields.items()
    }
    return TypeAdapter(create_model(model.__name__, __config__=model.model_config, **fields))


def _location(model: Any, document: object, parts: Path) -> Path | None:
    """The keys on the path to a fault, from pydantic's location: without the form of a field and the mark of a
    mapping's key, which may have the name of a document's own key. None for a fault of the form of a field that was not
    given: pydantic tries both forms, and refuses both."""
    found: Path = ()
    seen: Path | None = None
    for part in parts:
        if part in (PLAIN, STATED) and found != seen and len(options_of(_annotation(model, found))) > 1:
            if isinstance(as_written(document, found)[1], dict) != (part == STATED):
                return None
            seen = found
        elif not (part == "[key]" and _has_names(_annotation(model, found[:-1]))):
            found += (part,)
    return found


def _fault(
    model: Any, document: object, location: Path, kind: str, context: dict[str, Any]
) -> tuple[Path, object, str]:
    if "keys" in context:
        location += tuple(context["keys"][:1])
    path, value = as_written(document, location)
    return path, value, _allowed(model, kind, context, location, path, value)


def _allowed(model: Any, kind: str, context: dict[str, Any], location: Path, path: Path, value: object) -> str:
    if "allowed" in context:
        return str(context["allowed"])
    if kind == "missing":
        key = str(location[-1])
        twin = twin_of(key)
        if twin is not None:
            return f"{key} or {twin}, which must be given"
        return f"{_words_of(_annotation(model, location)) or _fields_of(model, location, None)}, which must be given"
    if kind == "extra_forbidden":
        return _known(model, location, str(path[-1]), value)
    if kind in COMPARISONS:
        name, words = COMPARISONS[kind]
        return f"{words} {_in_unit_written(context[name], path)}{_millimetres(path, value)}"
    if kind in ("too_short", "too_long"):
        few = context.get("min_length", context.get("max_length"))
        given = f", not {len(value)}" if isinstance(value, list) else ""
        return f"{'at least' if kind == 'too_short' else 'at most'} {few} item{'' if few == 1 else 's'}{given}"
    if kind in ("string_too_short", "string_too_long"):
        few = context.get("min_length", context.get("max_length"))
        least = "at least" if kind == "string_too_short" else "at most"
        return f"{least} {few} character{'' if few == 1 else 's'}"
    if kind in ("literal_error", "enum"):
        return str(context["expected"])
    if kind == "string_pattern_mismatch":
        if context["pattern"] in (NAME, REFERENCE):
            return "a name: a letter, then up to 63 letters, digits, _ . -"
        if path[-1] in SHIPPED:
            return f"one of {likeliest(str(value), SHIPPED[path[-1]]())}"
        return f"text that matches {context['pattern']}"
    if kind in ("model_type", "model_attributes_type"):
        return _fields_of(model, location, value)
    words = TYPES.get(kind, kind.replace("_", " "))
    return f"{words}, or a mapping" if kind == "string_type" and _has_names(_annotation(model, location)) else words


def _fields_of(model: Any, location: Path, value: object) -> str:
    """The few fields of the mapping that belongs at `location`, and how a number was probably meant; "a value" where no
    mapping belongs."""
    here = _model_in(_annotation(model, location))
    if here is None:
        return "a value" if value is None else TYPES["model_type"]
    fields = list(_fields(here))
    names = [f"{name}/{twin_of(name)}" if twin_of(name) else name for name in fields]
    message = TYPES["model_type"] + (f": {', '.join(names)}" if 0 < len(names) <= FEW_FIELDS else "")
    required = _required(here)
    if type(value) in (int, float) and len(required) == 1:
        message += f"; did you mean {{{twin_of(required[0]) or required[0]}: {value}}}?"
    return message


def _millimetres(path: Path, value: object) -> str:
    """Which key was meant where a length in metres is so large that it must be one in millimetres."""
    key = next((part for part in reversed(path) if isinstance(part, str)), "")
    large = type(value) in (int, float) and abs(value) > FAR_M  # type: ignore[arg-type]
    return f"; did you mean {twin_of(key)}?" if large and unit_of(key, SI_UNITS) == "m" else ""


def _in_unit_written(limit: float, path: Path) -> str:
    key = next((part for part in reversed(path) if isinstance(part, str)), "")
    for part in (key, *(str(p) for p in reversed(path) if isinstance(p, str))):
        twin = si_key(part)
        if twin is not None:
            return f"{from_si(limit, twin[1]):.12g} ({twin[1]})"
    unit = unit_of(key, SI_UNITS)
    return f"{limit:.12g}" if unit is None else f"{limit:.12g} ({unit})"


def _known(model: Any, location: Path, key: str, value: object) -> str:
    """The fields that the model around `location` has, both ways to write each, and what was meant by `key`, as it is
    written: where else it is stated, or the likeliest field."""
    here = _model_in(_annotation(model, location[:-1]))
    if here is None:
        raise FaultError(f"no model has the fields around {dotted(location)}")
    fields = _fields(here)
    known = f"one of {', '.join(f'{n}/{twin_of(n)}' if twin_of(n) else n for n in sorted(fields))}"
    if place := getattr(here, "stated_elsewhere", {}).get(_stem(key)):
        return f"{known}; {key} is stated by {place.format(key=key)}"
    meant = [n for n in fields if _stem(n) == _stem(key) and _takes(fields[n], value)]
    meant = meant or difflib.get_close_matches(key, fields, n=1, cutoff=0.5)
    if not meant:
        return known
    return f"{known}; did you mean {' or '.join(w for n in meant for w in (n, twin_of(n)) if w)}?"


def _stem(key: str) -> str:
    """A key without the unit that it bears: `at_m`, `at_mm` and `at` have one stem."""
    unit = any_unit(key)
    return key if unit is None else key[: -len(unit)].removesuffix("_")


def _takes(annotation: Any, value: object) -> bool:
    """Whether a field of this type could hold `value`, judged by what it is: a list, a mapping, or neither."""
    lists = any(get_origin(option) is list for option in options_of(annotation))
    mappings = any(get_origin(option) is dict or _is_model(option) for option in options_of(annotation))
    return lists if isinstance(value, list) else mappings if isinstance(value, dict) else not (lists or mappings)


def _has_names(annotation: Any) -> bool:
    """Whether a field of this type can be a mapping whose keys are names that the document chooses."""
    return any(get_origin(option) is dict for option in options_of(annotation))


def _annotation(model: Any, location: Path) -> Any:
    """The type at `location` of a document of `model`, inside optionals, lists and mappings; None: nothing is there."""
    here: Any = model
    for part in location:
        here = next((found for option in options_of(here) if (found := _below(option, part)) is not None), None)
    return here


def _below(option: Any, part: str | int) -> Any:
    if _is_model(option):
        return _fields(option).get(str(part))
    return get_args(option)[-1] if get_origin(option) is (list if isinstance(part, int) else dict) else None


def options_of(annotation: Any) -> tuple[Any, ...]:
    """The types that an annotation stands for: each of a union, without what Annotated adds."""
    if get_origin(annotation) is Annotated:
        return options_of(get_args(annotation)[0])
    if get_origin(annotation) in (Union, UnionType):
        return tuple(option for part in get_args(annotation) for option in options_of(part))
    return (annotation,)


def _is_model(option: Any) -> bool:
    return is_typeddict(option) or (isinstance(option, type) and issubclass(option, BaseModel))


def _fields(model: Any) -> dict[str, Any]:
    """Key → type of each field of a model, as a document writes it."""
    if is_typeddict(model):
        return get_type_hints(model)
    return {field.alias or name: field.annotation for name, field in model.model_fields.items()}


def _required(model: Any) -> list[str]:
    """Keys of a model that must be given, as a document writes them."""
    if is_typeddict(model):
        return sorted(model.__required_keys__)
    return [field.alias or name for name, field in model.model_fields.items() if field.is_required()]


def _model_in(annotation: Any) -> Any:
    return next((option for option in options_of(annotation) if _is_model(option)), None)


def _words_of(annotation: Any) -> str:
    """The words that a field is one of, where it is."""
    words = [
        str(word) for option in options_of(annotation) if get_origin(option) is Literal for word in get_args(option)
    ]
    return f"one of {', '.join(words)}" if len(words) > 1 else "".join(words)


def _models() -> Sequence[str]:
    from assur.scenes.catalogue import models

    return models()


def _assets() -> Sequence[str]:
    from assur.scenes.meshes.assets import asset_names

    return asset_names()


SHIPPED: dict[str | int, Callable[[], Sequence[str]]] = {"model": _models, "asset": _assets}
"""Keys whose values are names of shipped files; the message about any other value lists these names."""
