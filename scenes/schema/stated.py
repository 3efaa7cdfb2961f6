"""A number, or several that belong together, with their source.

Every fact about an arm is written either plainly, ``l1_mm: 325``, or as a mapping that says where it comes from,
``l1_mm: {value: 325, status: vendor, source: data sheet, page 3}``.
"""

from __future__ import annotations

from typing import Annotated, Any, Generic, Literal, TypeVar, get_args

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema
from pydantic_core.core_schema import simple_ser_schema, union_schema

from assur.scenes import bounds
from assur.scenes.schema.model import Document

T = TypeVar("T")

Status = Literal["vendor", "vendor_config", "third_party", "disputed", "defined", "measured", "estimated"]
"""The source of a fact.

vendor         the maker's own data
vendor_config  from a configuration file of the maker's, where it may be a placeholder
third_party    second hand
disputed       second hand, and sources differ
defined        exact, because the arm exists only in the document that defines it
measured       found on such an arm, with the error that its source states
estimated      plausible, measured by nobody
"""
SURE: frozenset[str] = frozenset({"vendor", "defined"})
"""Statuses that need no mention among a plan's assumptions."""
PLAIN, STATED = "[plain]", "[stated]"
"""The two forms of a field, as the reader's errors name them; they are no part of its path."""


class Stated(Document, Generic[T]):
    """A fact with its status and its source."""

    value: T
    status: Status
    source: Annotated[str, Field(min_length=1, max_length=bounds.MAX_TEXT)]


class _BothForms:
    """Reads a union of a type and a mapping, as the stated form of a fact is one; which of them is given is seen from
    its being a mapping.

    The JSON Schema of the field itself shows both, so that its twin in mm or deg has both, too.
    """

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        plain, stated = get_args(source)
        forms: list[CoreSchema | tuple[CoreSchema, str]] = [
            (handler.generate_schema(plain), PLAIN),
            (handler.generate_schema(stated), STATED),
        ]
        return union_schema(forms, mode="left_to_right", serialization=simple_ser_schema("any"))

    def __get_pydantic_json_schema__(self, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        plain, stated = handler(core_schema)["anyOf"]
        stated = dict(handler.resolve_ref_schema(stated))
        stated.pop("title", None)
        return {"oneOf": [plain, stated]}


BOTH_FORMS = _BothForms()
"""Marks a field that takes both forms: ``Annotated[Size | Stated[Size], BOTH_FORMS]``."""


def value_of(fact: T | Stated[T]) -> T:
    """The value of a fact, in SI, however it was written."""
    return fact.value if isinstance(fact, Stated) else fact
