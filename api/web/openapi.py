"""The description of the service at /openapi.json: every answer that it gives, with examples that a test posts."""

from __future__ import annotations

from typing import Any, Literal, NotRequired

from typing_extensions import TypedDict

from assur.api.problems import MEDIA_TYPE, STATUS
from assur.api.web.clients import needs_key
from assur.api.web.request_components import request_components
from assur.api.web.service import scenario_request
from assur.scenes.plan_file import FORM
from assur.scenes.requests import shipped_scenarios
from assur.scenes.schema.answer import facts_described
from assur.scenes.schema.view import ViewDocument
from assur.scenes.tasks.places import Place

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
        "errors_left_out": {"type": "integer", "description": "so many further errors there are; absent: none"},
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
    """What a scenario's text means: why the cell exists, the request, ready to be posted (not for a cell without a
    task, whose status is `cell`), and, with `draw`, the view of its cell and where what it shows is written. With `set`
    or `move` the texts that were changed."""

    status: Literal["parsed", "cell"]
    about: str
    request: NotRequired[dict[str, Any]]
    view: NotRequired[ViewDocument]
    places: NotRequired[list[Place]]
    text: NotRequired[str]
    cell: NotRequired[str]


ROBOTS: dict[str, Any] = {
    "type": "object",
    "description": "The shipped robots, every number with its status and source",
    "required": ["robots"],
    "properties": {"robots": {"type": "array", "items": {"type": "object", "additionalProperties": True}}},
}


SIMULATION: dict[str, Any] = {
    "type": "object",
    "description": "How many parts a minute a cell takes, and why: what `assur simulate --json` prints",
    "required": ["schema", "complete", "parts_per_minute", "interval", "missed", "moving", "waiting", "runs"],
    "properties": {"schema": {"const": "assur-simulation/1"}},
    "additionalProperties": True,
}


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
    problem = {MEDIA_TYPE: {"schema": ref("Problem")}}
    for kind in kinds:
        status, title = STATUS[kind]
        known = found.setdefault(status, {"description": "", "content": problem})
        known["description"] = "; ".join(filter(None, (known["description"], title)))
    return found


def component(name: str) -> dict[int | str, dict[str, Any]]:
    """The response of a route that answers with a component of `complete`."""
    return {200: {"description": "The answer", "content": {"application/json": {"schema": ref(name)}}}}


def body(schema: dict[str, Any], examples: dict[str, Any] | None = None, *parameters: dict[str, Any]) -> dict[str, Any]:
    """The request body of a route, as an `openapi_extra`, and the `parameters` of its address."""
    wrapped = {name: {"value": value} for name, value in (examples or {}).items()}
    content = {"application/json": {"schema": schema, "examples": wrapped}}
    found: dict[str, Any] = {"requestBody": {"required": True, "content": content}}
    return found | {"parameters": list(parameters)} if parameters else found


def parameter(name: str, about: str, schema: dict[str, Any], where: str = "query") -> dict[str, Any]:
    """A parameter of an address. One in its path is always there."""
    required = {"required": True} if where == "path" else {}
    return {"name": name, "in": where, "description": about, "schema": schema, **required}


def ref(name: str) -> dict[str, str]:
    """A component by its name."""
    return {"$ref": f"#/components/schemas/{name}"}


def fields(required: list[str], **properties: dict[str, Any]) -> dict[str, Any]:
    """An object with these properties and no others."""
    return {"type": "object", "required": required, "properties": properties, "additionalProperties": False}


MARKS: dict[str, Any] = {
    "schema": {"const": FORM, "description": "where the body is a plan file, as `assur plan --out` writes it"},
    "title": {"type": "string", "description": "what the cell is called"},
    "about": {"type": "string", "description": "why the cell exists"},
}
"""What a body with a request and a plan may say besides, so that a plan file can be posted as it is."""


LINKS: dict[tuple[str, str, int], dict[str, dict[str, Any]]] = {
    ("/v1/scenes", "get", 200): {
        operation: {"operationId": operation, "parameters": {"name": "$response.body#/scenes/0/name"}}
        for operation in ("show_scene", "show_scene_text", "plan_scene", "start_scene_job")
    },
    ("/v1/scenes/{name}", "get", 200): {
        operation: {"operationId": operation, "requestBody": "$response.body"} for operation in ("plan", "start_job")
    },
    ("/v1/scenes/parse", "post", 200): {
        "plan": {"operationId": "plan", "requestBody": "$response.body#/request"},
    },
    ("/v1/plans", "post", 200): {
        operation: {
            "operationId": operation,
            "description": "of an answer that is planned, with the full certificate",
            "requestBody": {"request": "$request.body", "plan": "$response.body"},
        }
        for operation in ("check_plan", "view_plan", "report_plan")
    },
    **{
        (path, "post", 202): {
            operation: {"operationId": operation, "parameters": {"name": "$response.body#/id"}}
            for operation in ("show_job", "show_job_answer", *pages, "watch_job", "delete_job")
        }
        for path, *pages in (
            ("/v1/jobs",),
            ("/v1/scenes/{name}/jobs",),
            ("/v1/simulations", "show_job_page"),
            ("/v1/cells/{sha256}/simulations", "show_job_page"),
        )
    },
}
"""From a response (address, method, status) to what can be requested next: name of the link to its description."""
TAGS = {
    "plans": "Plan a request, and what can be done with a plan",
    "jobs": "Plan or simulate now, fetch later",
    "scenes": "The shipped scenarios, and the text of others",
    "kinematics": "Robots, and where a tool can be",
    "cells": "Cells that are sent once, and planned with many tasks",
    "meshes": "Mesh files that are sent once and named by requests",
    "service": "Whether the service runs, and how",
}
HEADERS = {
    "RequestId": {"description": "under which the service logs this request", "schema": {"type": "string"}},
    "RetryAfter": {"description": "seconds after which to ask again", "schema": {"type": "integer", "minimum": 0}},
    "Location": {
        "description": "address of the job, relative to that of the request",
        "schema": {"type": "string", "format": "uri-reference"},
    },
}
KEY = {
    "type": "http",
    "scheme": "bearer",
    "description": "a key of the service, where it has keys (ASSUR_KEYS_FILE); else none is needed",
}
AGAIN = (429, 503)
"""Statuses of problems that say when to ask again, where it is known."""


def complete(document: dict[str, Any], most_budget_s: float, **questions: dict[str, Any]) -> dict[str, Any]:
    """FastAPI's own description with our schemas, links and headers, and the demo's whole request as an example.

    `most_budget_s`: largest budget that the service gives, s. `questions`: further components, by their names.
    """
    components = document.setdefault("components", {})
    facts_described(components.setdefault("schemas", {}))
    components.setdefault("schemas", {}).update(
        request_components(MARKS, most_budget_s),
        Robots=ROBOTS,
        SimulationResult=SIMULATION,
        **questions,
        JsonSchema={"type": "object", "description": "a JSON Schema", "additionalProperties": True},
        Problem=PROBLEM_SCHEMA,
    )
    components["headers"] = HEADERS
    components["securitySchemes"] = {"key": KEY}
    document["tags"] = [{"name": name, "description": about} for name, about in TAGS.items()]
    plans = document["paths"]["/v1/plans"]["post"]["requestBody"]["content"]["application/json"]
    plans["examples"] = {"the demo": {"value": scenario_request("demo")}}
    for path, item in document["paths"].items():
        for method, operation in item.items():
            if needs_key(path):
                operation["security"] = [{}, {"key": []}]
                for status, response in problems("unauthorized").items():
                    operation["responses"].setdefault(str(status), response)
            for status, response in operation["responses"].items():
                headers = {"X-Request-Id": {"$ref": "#/components/headers/RequestId"}}
                if int(status) in AGAIN:
                    headers["Retry-After"] = {"$ref": "#/components/headers/RetryAfter"}
                if int(status) == 202:
                    headers["Location"] = {"$ref": "#/components/headers/Location"}
                response.setdefault("headers", {}).update(headers)
                links = LINKS.get((path, method, int(status)))
                if links:
                    response["links"] = links
            for parameter in operation.get("parameters", ()):
                if parameter["name"] == "name" and path.startswith("/v1/scenes/"):
                    parameter["schema"] = {"type": "string", "enum": list(shipped_scenarios())}
                    parameter["description"] = "name of a shipped scenario"
    return document
