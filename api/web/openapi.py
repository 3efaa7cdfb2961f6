"""The description of the service at /openapi.json: every answer that it gives, with examples that a test posts."""

from __future__ import annotations

from typing import Any, Literal

from typing_extensions import TypedDict

from assur.api.problems import MEDIA_TYPE, STATUS
from assur.api.web.service import scenario_request
from assur.scenes.exports.doors import export_schemas
from assur.scenes.plan_file import FORM
from assur.scenes.requests import ik_schema, request_schema
from assur.scenes.scenarios import scenario_text

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
                    "line": {"type": "integer", "description": "of the field, in a text that was posted"},
                },
            },
        },
    },
}


class SceneAbout(TypedDict):
    """A shipped scenario, and why it exists."""

    name: str
    about: str


class Scenes(TypedDict):
    """The shipped scenarios."""

    scenes: list[SceneAbout]


class Parsed(TypedDict):
    """What a scenario's text means: why the cell exists, and the request, ready to be posted."""

    status: Literal["parsed"]
    about: str
    request: dict[str, Any]


class Live(TypedDict):
    """The service runs."""

    live: bool


class Ready(TypedDict):
    """Every worker has planned once."""

    ready: bool
    workers: int


def problems(*kinds: str) -> dict[int | str, dict[str, Any]]:
    """The responses of a route that are problems: one for each status of `kinds`."""
    found: dict[int | str, dict[str, Any]] = {}
    problem = {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
    for kind in kinds:
        status, title = STATUS[kind]
        known = found.setdefault(status, {"description": "", "content": problem})
        known["description"] = "; ".join(filter(None, (known["description"], title)))
    return found


def component(name: str) -> dict[int | str, dict[str, Any]]:
    """The response of a route that answers with a component of `complete`."""
    schema = {"$ref": f"#/components/schemas/{name}"}
    return {200: {"description": "The answer", "content": {"application/json": {"schema": schema}}}}


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
) | {
    "parameters": [
        {
            "name": "certificate",
            "in": "query",
            "description": "the whole table of the proof, or its digest and size",
            "schema": {"type": "string", "enum": ["full", "digest"], "default": "full"},
        }
    ]
}

MARKS: dict[str, Any] = {
    "schema": {"const": FORM, "description": "where the body is a plan file, as `assur plan --out` writes it"},
    "title": {"type": "string", "description": "what the cell is called"},
    "about": {"type": "string", "description": "why the cell exists"},
}
"""What a body with a request and a plan may say besides, so that a plan file can be posted as it is."""

CHECK_BODY = body(
    {
        "type": "object",
        "required": ["request", "plan"],
        "properties": {
            "request": {"$ref": "#/components/schemas/Request"},
            "plan": {"$ref": "#/components/schemas/PlannedAnswer"},
            **MARKS,
        },
        "additionalProperties": False,
    },
    {},
)


PARSE_BODY = body(
    {
        "type": "object",
        "required": ["text"],
        "properties": {"text": {"type": "string", "description": "a scenario in YAML"}},
        "additionalProperties": False,
    },
    {"a scenario": {"text": scenario_text("transfer")}},
)

VIEWED: dict[str, Any] = {
    "type": "object",
    "required": ["request", "plan"],
    "properties": {
        "request": {"$ref": "#/components/schemas/Request"},
        "plan": {
            "oneOf": [
                {"$ref": "#/components/schemas/PlannedAnswer"},
                {"$ref": "#/components/schemas/NotPlannedAnswer"},
                {"$ref": "#/components/schemas/CheckedPlan"},
            ]
        },
        **MARKS,
    },
    "additionalProperties": False,
}
VIEW_BODY = REPORT_BODY = body(VIEWED, {})
EXPORT_BODY = body({"$ref": "#/components/schemas/ExportQuestion"}, {})
TRAJECTORY_BODY = body({"$ref": "#/components/schemas/TrajectoryQuestion"}, {})

IK_BODY = body(
    {"$ref": "#/components/schemas/IkQuestion"},
    {
        "a robot of the catalogue": {
            "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}},
            "pose": {"at_mm": [350, 0, 150], "yaw_deg": 90},
        }
    },
)


def complete(document: dict[str, Any]) -> dict[str, Any]:
    """FastAPI's own description with our schemas and the demo's whole request as an example."""
    request, question, export, trajectory = request_schema(), ik_schema(), *export_schemas()
    every = request, question, export, trajectory
    parts = {name: _moved(part) for of in every for name, part in of.pop("$defs", {}).items()}
    for asked, needed in ((export, ["request", "plan"]), (trajectory, ["request"])):
        asked["properties"]["request"] = {"$ref": "#/components/schemas/Request"}
        asked["properties"]["plan"] = {"$ref": "#/components/schemas/PlannedAnswer"}
        asked["properties"] |= MARKS if asked is export else {}
        asked["required"] = [*needed, *asked.get("required", [])]
    question["properties"]["request"] = {"$ref": "#/components/schemas/Request"}
    question["allOf"].append({"oneOf": [{"required": ["request"]}, {"required": ["robot"]}]})
    request.pop("$schema", None)
    document.setdefault("components", {}).setdefault("schemas", {}).update(
        parts,
        Request=_moved(request),
        IkQuestion=_moved(question),
        ExportQuestion=_moved(export),
        TrajectoryQuestion=_moved(trajectory),
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
