"""The schema that clients see says what the reader takes: twins, one of several keys, no null, bounds."""

from __future__ import annotations

import json
import re
from typing import Any

from assur.scenes.bounds import MAX_BODIES, MAX_STEPS
from assur.scenes.requests import request_schema
from tests.scenes.bad_requests import GOOD_REQUEST

SCHEMA = request_schema()


def test_it_is_plain_json_without_null() -> None:
    assert json.loads(json.dumps(SCHEMA, allow_nan=False)) == SCHEMA
    assert '"null"' not in json.dumps(SCHEMA)


def test_the_lists_are_bounded() -> None:
    assert SCHEMA["properties"]["bodies"]["maxItems"] == MAX_BODIES
    assert SCHEMA["properties"]["task"]["maxItems"] == MAX_STEPS
    text = json.dumps(SCHEMA)
    assert text.count('"type": "array"') == text.count('"maxItems"')


def test_every_mapping_is_closed_but_for_joint_names() -> None:
    open_ones = {name for name, part in SCHEMA["$defs"].items() if part.get("additionalProperties") is not False}
    assert open_ones == {"JointValues", "LagDocument", "LimitsDocument"}
    assert SCHEMA["additionalProperties"] is False


def test_a_quantity_shows_both_its_keys_of_which_exactly_one_is_needed() -> None:
    conveyor = SCHEMA["$defs"]["ConveyorDocument"]
    assert {"speed_m_s", "speed_mm_s", "at_m", "at_mm", "yaw_rad", "yaw_deg"} <= set(conveyor["properties"])
    assert {"oneOf": [{"required": ["speed_m_s"]}, {"required": ["speed_mm_s"]}]} in conveyor["allOf"]
    assert {"not": {"required": ["yaw_rad", "yaw_deg"]}} in conveyor["allOf"]


def test_the_good_request_keeps_the_schema_by_a_second_reading() -> None:
    assert list(faults(GOOD_REQUEST, SCHEMA)) == []


def test_the_second_reading_is_not_blind() -> None:
    for spoilt in (
        {**GOOD_REQUEST, "extra": 1},
        {**GOOD_REQUEST, "carry": None},
        {**GOOD_REQUEST, "task": []},
        {**GOOD_REQUEST, "execution": {"start_tolerance_s": 1, "start_tolerance_ms": 1}},
        {**GOOD_REQUEST, "frames": {"a": {}}},
    ):
        assert list(faults(spoilt, SCHEMA))


def faults(value: Any, schema: dict[str, Any], path: str = "") -> Any:
    """What of the schema (the part of JSON Schema that ours uses) the value does not keep."""
    if "$ref" in schema:
        schema = {
            **SCHEMA["$defs"][schema["$ref"].rsplit("/", 1)[1]],
            **{k: v for k, v in schema.items() if k != "$ref"},
        }
    kinds: dict[str, tuple[type, ...]] = {
        "object": (dict,),
        "array": (list,),
        "string": (str,),
        "number": (int, float),
        "integer": (int,),
        "boolean": (bool,),
    }
    if "type" in schema and not isinstance(value, kinds[schema["type"]]):
        yield f"{path}: not {schema['type']}"
        return
    if "const" in schema and value != schema["const"]:
        yield f"{path}: not {schema['const']}"
    if "enum" in schema and value not in schema["enum"]:
        yield f"{path}: not in {schema['enum']}"
    for key, holds in (
        ("minimum", lambda limit: value >= limit),
        ("maximum", lambda limit: value <= limit),
        ("exclusiveMinimum", lambda limit: value > limit),
        ("exclusiveMaximum", lambda limit: value < limit),
        ("minItems", lambda limit: len(value) >= limit),
        ("maxItems", lambda limit: len(value) <= limit),
        ("pattern", lambda pattern: re.search(pattern, value) is not None),
    ):
        if key in schema and not holds(schema[key]):
            yield f"{path}: {key}"
    if isinstance(value, list):
        for i, item in enumerate(value):
            yield from faults(item, schema.get("items", {}), f"{path}[{i}]")
    if isinstance(value, dict):
        yield from _faults_of_mapping(value, schema, path)


def _faults_of_mapping(value: dict[str, Any], schema: dict[str, Any], path: str) -> Any:
    for key in schema.get("required", ()):
        if key not in value:
            yield f"{path}.{key}: missing"
    extra = schema.get("additionalProperties", {})
    for key, item in value.items():
        known = schema.get("properties", {}).get(key, extra)
        for pattern, part in schema.get("patternProperties", {}).items():
            if re.search(pattern, key):
                known = part
        if known is False:
            yield f"{path}.{key}: unknown"
        else:
            yield from faults(item, {} if known is True else known, f"{path}.{key}")
    for rule in schema.get("allOf", ()):
        if not _keeps(value, rule):
            yield f"{path}: {rule}"


def _keeps(value: dict[str, Any], rule: dict[str, Any]) -> bool:
    if "required" in rule:
        return all(key in value for key in rule["required"])
    if "not" in rule:
        return not _keeps(value, rule["not"])
    if "oneOf" in rule:
        return sum(_keeps(value, part) for part in rule["oneOf"]) == 1
    if "anyOf" in rule:
        return any(_keeps(value, part) for part in rule["anyOf"])
    if "allOf" in rule:
        return all(_keeps(value, part) for part in rule["allOf"])
    raise AssertionError(rule)
