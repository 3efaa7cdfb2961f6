"""The schema and the reader say the same: at each limit of each number in each unit, and of documents at random."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from typing import Annotated, Any

import jsonschema_rs
import pytest
from pydantic import TypeAdapter, ValidationError

from assur.planner.errors import InputError
from assur.scenes.requests import ik_schema, request_schema, validate
from assur.scenes.schema.model import Document
from assur.scenes.schema.normal import normal
from assur.scenes.units import si_key
from benchmarks.contract_words import AT_MOST, NOT_IN_SCHEMA
from tests.scenes.schema.documents import made, mutant

SCHEMA = request_schema()
ALL = {**SCHEMA["$defs"], **ik_schema()["$defs"]}
LIMITS = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")


def models(model: type[Document] = Document) -> Iterator[type[Document]]:
    for each in model.__subclasses__():
        yield each
        yield from models(each)


MODELS = {model.__name__: model for model in models()}


def numbers(field: dict[str, Any], wrap: Any = lambda x: x) -> Iterator[tuple[dict[str, Any], Any]]:
    """The schemas of the numbers in that of a field, each with what makes a value of the field of such a number."""
    if field.get("type") in ("number", "integer") and any(limit in field for limit in LIMITS):
        yield field, wrap
    elif field.get("type") == "array" and isinstance(field.get("items"), dict):
        yield from numbers(field["items"], lambda x: wrap([x] * max(1, field.get("minItems", 1))))
    for union in ("oneOf", "anyOf"):
        for option in field.get(union, ()):
            yield from numbers(option, wrap)
    if "value" in field.get("properties", ()):
        yield from numbers(
            field["properties"]["value"], lambda x: wrap({"value": x, "status": "vendor", "source": "data sheet"})
        )


def around(field: dict[str, Any]) -> Iterator[float]:
    """A number at each limit, and the next one to either side."""
    step = 1 if field["type"] == "integer" else 0
    for name in LIMITS:
        if name in field:
            limit = field[name]
            yield limit
            for outwards in (math.inf, -math.inf):
                if limit == 0:
                    yield math.copysign(step or 1e-9, outwards)
                else:
                    yield limit + math.copysign(step, outwards) if step else math.nextafter(limit, outwards)


PLACES = [
    (name, key, field, wrap)
    for name, part in sorted(ALL.items())
    for key, whole in part.get("properties", {}).items()
    for field, wrap in numbers(whole)
    if name in MODELS
]


def reads(model: type[Document], key: str, value: Any) -> bool:
    """Whether the field of a model takes a value as it is written."""
    converted = si_key(key)
    name = key if converted is None else converted[0]
    field = next(field for called, field in model.model_fields.items() if name in (called, field.alias))
    try:
        given = normal({key: value})[name]
        form: Any = Annotated[(field.annotation, None, *field.metadata)]
        TypeAdapter(form).validate_python(given)
    except (ValidationError, InputError):
        return False
    return True


def test_every_unit_is_among_the_places() -> None:
    assert len(PLACES) > 250
    units = {converted[1] for _, key, _, _ in PLACES if (converted := si_key(key)) is not None}
    assert {"mm", "deg", "ms", "mm_s", "deg_s", "mm_s2", "deg_s2", "mm_s3", "deg_s3"} <= units


@pytest.mark.parametrize("name", sorted({place[0] for place in PLACES}))
def test_schema_and_reader_agree_at_every_limit(name: str) -> None:
    for model, key, field, wrap in PLACES:
        if model != name:
            continue
        judge = jsonschema_rs.Draft202012Validator({**ALL[name]["properties"][key], "$defs": ALL})
        said = set()
        for number in around(field):
            value = wrap(number)
            said.add(judge.is_valid(value))
            assert judge.is_valid(value) == reads(MODELS[name], key, value), (name, key, value)
        assert said == {True, False}, (name, key)


def foreseeable(document: Any) -> str | None:
    """What the reader says against a document, but for what no schema can say; None: nothing."""
    try:
        validate(document)
    except InputError as error:
        unsaid = any(words in error.allowed for words in NOT_IN_SCHEMA) or error.allowed.startswith(AT_MOST)
        return None if unsaid else str(error)
    return None


def accepted(document: Any) -> bool:
    try:
        validate(document)
    except InputError:
        return False
    return True


def test_schema_and_reader_agree_on_documents_made_at_random_and_their_mutants() -> None:
    rng, judge = random.Random(12), jsonschema_rs.Draft202012Validator(SCHEMA)
    kept = refused = 0
    for _ in range(300):
        first = made(SCHEMA, SCHEMA, rng)
        for document in (first, *(mutant(first, rng) for _ in range(8))):
            if judge.is_valid(document):
                kept += 1
                assert foreseeable(document) is None, document
            else:
                refused += 1
                assert not accepted(document), (document, next(judge.iter_errors(document)).message)
    assert min(kept, refused) > 300
