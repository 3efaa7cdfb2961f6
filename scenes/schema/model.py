"""The rules that all documents share: closed, strict, finite, no null, units in keys, one of several keys.

A model declares its fields in SI (`at_m`), and reads a document that `normal` has brought to SI. A caller may also
write the twin (`at_mm`), so the model's schema shows both. Groups of keys that exclude each other are declared as
class variables (exactly one of them, or at most one, may be given), so that the reader and the schema agree on them.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Mapping
from functools import partial
from itertools import combinations
from typing import Annotated, Any, ClassVar, Self

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    SerializerFunctionWrapHandler,
    model_serializer,
)
from pydantic_core import CoreSchema, PydanticCustomError
from pydantic_core.core_schema import no_info_before_validator_function

from assur.planner.errors import FaultError
from assur.planner.geometry.shapes import LARGEST_M, SMALLEST_M
from assur.scenes import bounds
from assur.scenes.schema.described import description
from assur.scenes.units import TWIN_UNITS, from_si, si_key, to_si, twin_of

Group = tuple[str, ...]
LONGEST_KEY = 40
MOST_KEYS = 3
"""Longest text of unknown keys that a message repeats."""


class Document(BaseModel):
    """A mapping of fields. Frozen; every number in SI once it is read."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)

    exactly_one: ClassVar[tuple[Group, ...]] = ()
    at_most_one: ClassVar[tuple[Group, ...]] = ()
    stated_elsewhere: ClassVar[Mapping[str, str]] = {}
    """By keys without their units that the mapping has not: which part of a document has such a `{key}`."""

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        schema = handler(source)
        model: Any = schema
        while model["type"] != "model":
            model = model["schema"]
        # inside, as pydantic's own do: around the model it would run twice; a field of another model comes guarded
        if (cls.exactly_one or cls.at_most_one) and model["schema"]["type"] != "function-before":
            rules = [(frozenset(group), group, "exactly one") for group in cls.exactly_one]
            rules += [(frozenset(group), group, "at most one") for group in cls.at_most_one]
            model["schema"] = no_info_before_validator_function(partial(cls._keep_groups, rules), model["schema"])
        return schema

    @classmethod
    def _keep_groups(cls, rules: list[tuple[frozenset[str], Group, str]], data: Any) -> Any:
        """Refuses a mapping that does not keep the groups of keys of its model."""
        if type(data) is not dict:
            return data
        for names, group, allowed in rules:
            count = len(names.intersection(data))
            if count > 1 or (count == 0 and allowed == "exactly one"):
                given = [key for key in group if key in data]
                strange = [] if given else [key for key in data if not cls._has(key)]
                raise _refusal("one_of", given[1:], f"{allowed} of {', '.join(group)}{_strange(strange, group)}")
        return data

    def __deepcopy__(self, memo: object = None) -> Self:
        """Itself: it is frozen, so whatever has it as its default may share it."""
        return self

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy, with the values of `update` in place of its own. Raises `pydantic.ValidationError` for values and
        fields that the model refuses, like the constructor. `deep` changes nothing: frozen values are shared."""
        if not update:
            return super().model_copy(deep=deep)
        keys = {name: field.alias or name for name, field in type(self).model_fields.items()}
        own = {keys.get(name, name): getattr(self, name) for name in self.model_fields_set}
        return type(self).model_validate(own | {keys.get(name, name): value for name, value in update.items()})

    def document(self) -> dict[str, Any]:
        """The given values as a plain document, in SI. Values that were left out are left out here, too."""
        return self.model_dump(by_alias=True, exclude_unset=True, exclude_none=True)

    @classmethod
    def _has(cls, key: object) -> bool:
        return any(key in (name, field.alias) for name, field in cls.model_fields.items())

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        schema = handler.resolve_ref_schema(handler(core_schema))
        properties = schema.get("properties", {})
        required = set(schema.get("required", ()))
        of_groups = {key for group in cls.exactly_one for key in group}
        rules: list[dict[str, Any]] = [
            {"oneOf": [{"required": [key]} for key in _both_units(group)]} for group in cls.exactly_one
        ]
        rules += [
            {"not": {"required": [first, second]}}
            for group in cls.at_most_one
            for first, second in combinations(_both_units(group), 2)
            if second != twin_of(first)
        ]
        for name, field in list(properties.items()):
            _forget_null(field)
            field["description"] = description(cls, name)
            twin = twin_of(name)
            if twin is None:
                continue
            properties[twin] = twin_schema(field, twin, handler.resolve_ref_schema)
            properties[twin]["description"] = description(cls, twin)
            if name in required:
                rules.append({"oneOf": [{"required": [name]}, {"required": [twin]}]})
            elif name not in of_groups:
                rules.append({"not": {"required": [name, twin]}})
            required.discard(name)
        if "required" in schema:
            schema["required"] = sorted(required)
        if rules:
            schema["allOf"] = rules
        return schema


class ByName(Document):
    """A mapping whose keys, fields apart, are names that come from elsewhere, such as those of a robot's joints."""

    model_config = ConfigDict(extra="allow")

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        schema = super().__get_pydantic_json_schema__(core_schema, handler)
        schema["patternProperties"] = by_unit(schema["additionalProperties"])
        return schema

    @model_serializer(mode="wrap")
    def _sorted(self, written: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return dict(sorted(written(self).items()))


def _both_units(group: Group) -> list[str]:
    """The keys of a group, each followed by its twin."""
    return [key for name in group for key in (name, twin_of(name)) if key is not None]


def _forget_null(field: dict[str, Any]) -> None:
    """Optional fields may be left out, never null; their schema says so."""
    options = [option for option in field.get("anyOf", ()) if option != {"type": "null"}]
    if len(options) == 1:
        del field["anyOf"]
        field.update(options[0])
    elif options:
        field["anyOf"] = options
    if field.get("default", 0) is None:
        del field["default"]


def _strange(keys: list[str], group: Group) -> str:
    """Which keys were given that are no fields, where one of `group` is missing: probably misspelt."""
    if not keys:
        return ""
    shown = ", ".join(str(key)[:LONGEST_KEY] for key in keys[:MOST_KEYS])
    close = difflib.get_close_matches(str(keys[0]), group, n=1, cutoff=0.5)
    return f"; {shown} is none of them" + (f", did you mean {close[0]}?" if close else "")


def _refusal(kind: str, keys: list[str], allowed: str) -> PydanticCustomError:
    # Braces in a name would be read as a template by PydanticCustomError: the text travels in the context only.
    return PydanticCustomError(kind, "allowed: {allowed}", {"keys": keys, "allowed": allowed})


def _whole(value: object) -> object:
    """A whole number that is written with a fraction of 0 as the whole number: JSON knows no difference."""
    whole = type(value) is float and value.is_integer() and abs(value) <= bounds.MAX_INTEGER
    return int(value) if whole else value  # type: ignore[call-overload]


WHOLE = BeforeValidator(_whole)
"""Marks a field that is a whole number."""
Coordinate = Annotated[float, Field(ge=-bounds.FAR_M, le=bounds.FAR_M)]
Distance = Annotated[float, Field(ge=0.0, le=bounds.FAR_M)]
Size = Annotated[float, Field(ge=SMALLEST_M, le=LARGEST_M)]
Angle = Annotated[float, Field(ge=-bounds.TURNS_RAD, le=bounds.TURNS_RAD)]
Speed = Annotated[float, Field(ge=-bounds.FAST_M_S, le=bounds.FAST_M_S)]
Rate = Annotated[float, Field(ge=-bounds.FAST_RAD_S, le=bounds.FAST_RAD_S)]
Positive = Annotated[float, Field(ge=bounds.LEAST, le=bounds.STRONG)]
Strength = Annotated[float, Field(ge=-bounds.STRONG, le=bounds.STRONG)]
Instant = Annotated[float, Field(ge=-bounds.LONG_S, le=bounds.LONG_S)]
Duration = Annotated[float, Field(ge=0.0, le=bounds.LONG_S)]
Span = Annotated[float, Field(ge=bounds.LEAST, le=bounds.LONG_S)]
Mass = Annotated[float, Field(ge=0.0, le=bounds.HEAVY_KG)]
Load = Annotated[float, Field(ge=bounds.LEAST, le=bounds.HEAVY_KG)]
Inertia = Annotated[float, Field(ge=0.0, le=bounds.HEAVY_KGM2)]
Scale = Annotated[float, Field(ge=bounds.LEAST, le=1.0)]

MOST_YAW_ERROR_RAD = 1.6
"""An error of a yaw is less than a little more than a quarter of a turn: what is known less is free."""
YawError = Annotated[float, Field(ge=0.0, le=MOST_YAW_ERROR_RAD)]

Point = Annotated[list[Coordinate], Field(min_length=3, max_length=3)]
ORIGIN = [0.0, 0.0, 0.0]
"""The place of a pose that states none."""
Interval = Annotated[list[Instant], Field(min_length=2, max_length=2)]
Stretch = Annotated[list[Coordinate], Field(min_length=2, max_length=2)]

NAME = r"^[A-Za-z][A-Za-z0-9_.-]{0,63}$"
"""Names that a document gives: frames, bodies, control points, neighbours."""
REFERENCE = r"^[A-Za-z][A-Za-z0-9_.-]{0,63}(/[A-Za-z][A-Za-z0-9_.-]{0,63})?$"
"""Names that a document uses: those, and a neighbour's frames and bodies, NEIGHBOUR/name."""
Mode = Annotated[str, Field(pattern=r"^[a-z][a-z-]{0,31}$")]
"""A working mode of an arm, or what an option says in place of one."""
Name = Annotated[str, Field(pattern=NAME)]
Reference = Annotated[str, Field(pattern=REFERENCE)]


class PoseUncertaintyDocument(Document):
    """How far a part may be from its pose: in every horizontal direction, up or down, and about its own vertical."""

    position_m: Distance = 0.0
    vertical_m: Distance = 0.0
    yaw_rad: YawError = 0.0


KNOWN = PoseUncertaintyDocument()
"""Of a part that is exactly at its pose: the default."""


class PoseDocument(Document):
    """A pose in a parent that the context names."""

    at_m: Point = ORIGIN
    yaw_rad: Angle = 0.0


# The JSON Schema of a field in the unit that is not of SI: the same with its numbers in that unit.
#
# The limits are derived from those in SI by the very conversion with which a document is read: the largest number that
# a schema allows is the largest float that is still within the limit once it is converted.

LIMITS = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")
"""Keywords that hold a number in the unit of the field."""
LEFT_OUT = ("default", "title", "examples")
"""Keywords that are stated once, for the field in SI."""


def twin_schema(field: dict[str, Any], twin: str, resolved: Callable[[dict[str, Any]], dict[str, Any]]) -> Any:
    """The schema of the key `twin` (`at_mm`), from that of the field in SI (`at_m`). `resolved`: what a reference
    stands for."""
    converted = si_key(twin)
    if converted is None:
        raise FaultError(f"{twin} bears no unit that is converted")
    return _in_unit(field, converted[1], resolved)


def by_unit(values: dict[str, Any]) -> dict[str, Any]:
    """The schemas of the values of a mapping whose keys are names of joints with units (`j1_deg`), by a pattern of the
    key: one for each unit that is converted. `values`: that in SI. The name of a joint has no underscore."""
    return {f"^[A-Za-z0-9]+_{unit}$": _in_unit(values, unit, lambda part: part) for unit in TWIN_UNITS}


def _in_unit(field: dict[str, Any], unit: str, resolved: Callable[[dict[str, Any]], dict[str, Any]]) -> Any:
    if "$ref" in field:
        field = resolved(field)
    copy = {key: value for key, value in field.items() if key not in (*LIMITS, *LEFT_OUT)}
    for keyword in LIMITS:
        if keyword in field:
            name, limit = _limit(keyword, field[keyword], unit)
            copy[name] = limit
    if isinstance(copy.get("items"), dict):
        copy["items"] = _in_unit(copy["items"], unit, resolved)
    for union in ("anyOf", "oneOf"):
        if union in copy:
            copy[union] = [_in_unit(option, unit, resolved) for option in copy[union]]
    if "properties" in copy:  # of a fact with status and source only the value is converted, for it alone is a number
        copy["properties"] = {name: _in_unit(part, unit, resolved) for name, part in copy["properties"].items()}
    return copy


def _limit(keyword: str, limit: float, unit: str) -> tuple[str, float]:
    """The keyword and the number that say in `unit` what `limit` says in SI."""
    if limit == 0:
        return keyword, limit
    lowest, exclusive = keyword.lower().endswith("minimum"), keyword.startswith("exclusive")

    def keeps(value: float) -> bool:
        found: Any = to_si(value, unit)
        if found == limit:
            return not exclusive
        return bool(found > limit) if lowest else bool(found < limit)

    outwards = -math.inf if lowest else math.inf
    last = from_si(float(limit), unit)
    while not keeps(last):
        last = math.nextafter(last, -outwards)
    while keeps(beyond := math.nextafter(last, outwards)):
        last = beyond
    return ("minimum" if lowest else "maximum"), last
