"""Documents that keep a JSON Schema, made at random, and mutants of them."""

from __future__ import annotations

import copy
import math
import random
import re
from typing import Any

NAMES = ("part", "belt", "front", "j1", "a", "rrpr", "0f" * 32)


def made(schema: dict[str, Any], whole: dict[str, Any], rng: random.Random) -> Any:
    """A document that keeps `schema`, a part of `whole`."""
    if "$ref" in schema:
        return made(whole["$defs"][schema["$ref"].rpartition("/")[2]], whole, rng)
    for union in ("oneOf", "anyOf"):
        if union in schema:
            return made(rng.choice(schema[union]), whole, rng)
    if "const" in schema:
        return schema["const"]
    if "enum" in schema:
        return rng.choice(schema["enum"])
    if schema["type"] == "object":
        return _mapping(schema, whole, rng)
    if schema["type"] == "array":
        least = schema.get("minItems", 0)
        count = rng.randint(least, min(schema["maxItems"], least + 2))
        return [made(schema["items"], whole, rng) for _ in range(count)]
    if schema["type"] == "string":
        text = [name for name in NAMES if re.search(schema.get("pattern", ""), name)]
        return rng.choice(text)
    if schema["type"] == "boolean":
        return rng.random() < 0.5
    return _number(schema, rng)


def _number(schema: dict[str, Any], rng: random.Random) -> float:
    low = float(schema.get("minimum", schema.get("exclusiveMinimum", 0)))
    high = float(schema.get("maximum", schema.get("exclusiveMaximum", 0)))
    ends = [float(schema[key]) for key in ("minimum", "maximum") if key in schema]
    if schema["type"] == "integer":
        return int(rng.choice([*ends, rng.randint(int(low), int(high))]))
    return float(rng.choice([*ends, low + (high - low) * rng.uniform(0.01, 0.99), max(low, min(high, 1))]))


def _mapping(schema: dict[str, Any], whole: dict[str, Any], rng: random.Random) -> dict[str, Any]:
    properties = schema.get("properties", {})
    keys = [key for key in properties if key in schema.get("required", ()) or rng.random() < 0.25]
    for rule in schema.get("allOf", ()):
        if "oneOf" in rule:
            of = [option["required"][0] for option in rule["oneOf"]]
            keys = [key for key in keys if key not in of] + [rng.choice(of)]
    for rule in schema.get("allOf", ()):
        if "not" in rule and set(rule["not"]["required"]) <= set(keys):
            keys.remove(rule["not"]["required"][1])
    found = {key: made(properties[key], whole, rng) for key in keys}
    for pattern, part in schema.get("patternProperties", {}).items():
        if rng.random() < 0.3:
            unit = pattern.rpartition("+_")[2].rstrip("$")
            found["j2_" + unit if pattern.startswith("^[A-Za-z0-9]+_") else "f1"] = made(part, whole, rng)
    return found


def mutant(document: Any, rng: random.Random) -> Any:
    """A copy of a document with one place changed."""
    changed = copy.deepcopy(document)
    places: list[tuple[Any, Any]] = []
    _collect(changed, places)
    if not places:
        return changed
    above, key = rng.choice(places)
    value = above[key]
    choice = rng.randrange(6)
    if type(value) in (int, float) and choice < 4:
        outwards = rng.choice([math.inf, -math.inf])
        above[key] = rng.choice([math.nextafter(value, outwards), -value, value * 1000, 0, 0.0, int(value)])
    elif choice == 4 and isinstance(above, dict):
        del above[key]
    elif choice == 5 and isinstance(above, dict):
        above[rng.choice(["x", "at_mm", "yaw_deg", "m", str(key) + "x"])] = value
    else:
        above[key] = rng.choice([[], {}, "x", True, 1, -1.5, [value]])
    return changed


def _collect(value: Any, places: list[tuple[Any, Any]]) -> None:
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, item in items:
        places.append((value, key))
        _collect(item, places)
