"""The JSON Schema of a field in the unit that is not of SI: the same with its numbers in that unit.

The limits are derived from those in SI by the very conversion with which a document is read: the largest number that a
schema allows is the largest float that is still within the limit once it is converted.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from assur.planner.errors import FaultError
from assur.scenes.units import TWIN_UNITS, from_si, si_key, to_si

LIMITS = ("minimum", "maximum", "exclusiveMinimum", "exclusiveMaximum")
"""Keywords that hold a number in the unit of the field."""
LEFT_OUT = ("default", "title", "examples")
"""Keywords that are said once, of the field in SI."""


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
