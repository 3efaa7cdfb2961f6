"""The description of the service at /openapi.json: every answer that it gives, with examples that a test posts."""

from __future__ import annotations

from typing import Any

from assur.api.problems import MEDIA_TYPE, STATUS
from assur.api.service import scenario_request
from assur.scenes.requests import request_schema

TEXT = """\
Plans jerk-limited motion of SCARA-class robots through moving control points among moving bodies, proved free of
collision **against the model**. Not a safety function under ISO 10218 or ISO 13849; persons are not in the model.

Numbers are SI and radians; keys bear their units. A request that cannot be planned is answered with 200 and
`status: not_planned`; problems (RFC 9457) are for requests that should not have been sent, and for faults of ours.
"""

PROBLEM_SCHEMA: dict[str, Any] = {
    "type": "object",
    "required": ["type", "title", "status", "detail"],
    "properties": {
        "type": {"type": "string", "enum": [f"urn:assur:problem:{kind}" for kind in STATUS]},
        "title": {"type": "string"},
        "status": {"type": "integer"},
        "detail": {"type": "string"},
        "errors": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["field", "allowed"],
                "properties": {
                    "field": {"type": "string", "description": "dotted path, as in task[0].pick.part"},
                    "value": {"description": "what the field held, shortened; not there when the field is missing"},
                    "allowed": {"type": "string"},
                },
            },
        },
    },
}

PLANNED_SCHEMA: dict[str, Any] = {
    "type": "object",
    "required": ["schema", "status", "census", "assumptions", "seed", "elapsed_s", "notice"],
    "properties": {
        "status": {"enum": ["planned", "not_planned"]},
        "duration_s": {"type": "number"},
        "trajectory": {
            "type": "object",
            "properties": {
                "joint_names": {"type": "array", "items": {"type": "string"}},
                "time_s": {"type": "array", "items": {"type": "number"}},
                **{
                    name: {"type": "array", "items": {"type": "array", "items": {"type": "number"}}}
                    for name in ("position", "velocity", "acceleration")
                },
                "acceleration_jumps": {"type": "boolean"},
            },
        },
        "arrivals": {"type": "array", "items": {"type": "object"}},
        "legs": {"type": "array", "items": {"type": "object"}},
        "margins": {"type": "object"},
        "certificate": {"type": "object"},
        "census": {"type": "object"},
        "reason": {"type": "string"},
        "proved": {"type": "boolean"},
        "sentence": {"type": "string"},
    },
}

VERDICT_SCHEMA: dict[str, Any] = {
    "type": "object",
    "required": ["ok", "findings"],
    "properties": {"ok": {"type": "boolean"}, "findings": {"type": "array", "items": {"type": "object"}}},
}


def responses(schema: str, *kinds: str) -> dict[int | str, dict[str, Any]]:
    """The responses of a route: 200 with component `schema`, and a problem for each status of `kinds`."""
    found: dict[int | str, dict[str, Any]] = {
        200: {
            "description": "The answer",
            "content": {"application/json": {"schema": {"$ref": f"#/components/schemas/{schema}"}}},
        }
    }
    problem = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
    for kind in kinds:
        status, title = STATUS[kind]
        known = found.setdefault(status, {"description": "", "content": problem})
        known["description"] = "; ".join(filter(None, (known["description"], title)))
    return found


def body(schema: dict[str, Any], examples: dict[str, Any]) -> dict[str, Any]:
    """The request body of a route, as an `openapi_extra`."""
    wrapped = {name: {"value": value} for name, value in examples.items()}
    return {"requestBody": {"required": True, "content": {"application/json": {"schema": schema, "examples": wrapped}}}}


PLAN_BODY = body(
    {
        "oneOf": [
            {"$ref": "#/components/schemas/Request"},
            {
                "type": "object",
                "required": ["scenario"],
                "properties": {"scenario": {"type": "string", "description": "a name of GET /v1/scenes"}},
                "additionalProperties": False,
            },
        ]
    },
    {"a shipped scenario": {"scenario": "demo"}},
)

CHECK_BODY = body(
    {
        "type": "object",
        "required": ["request", "plan"],
        "properties": {
            "request": {"$ref": "#/components/schemas/Request"},
            "plan": {"$ref": "#/components/schemas/Answer"},
        },
        "additionalProperties": False,
    },
    {},
)


def complete(document: dict[str, Any]) -> dict[str, Any]:
    """FastAPI's own description with our schemas and the demo's whole request as an example."""
    request = request_schema()
    parts = {name: _moved(part) for name, part in request.pop("$defs", {}).items()}
    request.pop("$schema", None)
    document.setdefault("components", {}).setdefault("schemas", {}).update(
        parts,
        Request=_moved(request),
        Answer=PLANNED_SCHEMA,
        Verdict=VERDICT_SCHEMA,
        Document={"description": "a JSON document"},
        Problem=PROBLEM_SCHEMA,
    )
    plans = document["paths"]["/v1/plans"]["post"]["requestBody"]["content"]["application/json"]
    plans["examples"] = {**plans["examples"], "the demo in full": {"value": scenario_request("demo")}}
    return document


def _moved(schema: Any) -> Any:
    """`schema` with its references pointing at the components of the description."""
    if isinstance(schema, dict):
        return {
            key: value.replace("#/$defs/", "#/components/schemas/") if key == "$ref" else _moved(value)
            for key, value in schema.items()
        }
    return [_moved(item) for item in schema] if isinstance(schema, list) else schema
