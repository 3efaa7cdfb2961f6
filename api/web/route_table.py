"""The table of all addresses: what answers there, and how the description at /openapi.json has it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from inspect import iscoroutinefunction
from types import MappingProxyType
from typing import Any, NamedTuple, get_args

from fastapi import APIRouter, Request
from fastapi.routing import APIRoute
from starlette.concurrency import run_in_threadpool
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.types import Receive, Scope, Send

from assur.api.version import VersionDocument
from assur.api.web import (
    cell_routes,
    job_routes,
    mesh_routes,
    operation_routes,
    plan_files,
    routes,
    simulation_routes,
)
from assur.api.web.cell_routes import StoredCell
from assur.api.web.job_routes import JobDocument
from assur.api.web.mesh_routes import KeptMesh
from assur.api.web.openapi import (
    MARKS,
    Live,
    Parsed,
    Ready,
    Scenes,
    body,
    component,
    fields,
    parameter,
    problems,
    ref,
)
from assur.api.web.routes import answered_by
from assur.api.web.settings import PLAN_BODY_BYTES
from assur.api.workers import jobs, text_jobs
from assur.api.workers.answer_parts import LEAST_DIGITS, MOST_DIGITS
from assur.scenes.scenarios import scenario_text
from assur.scenes.schema.answer import Answer, Verdict
from assur.scenes.schema.export import ExportAnswer, TrajectoryVerdict
from assur.scenes.schema.ik import IkAnswer
from assur.scenes.schema.shapes import MeshFormat, MeshUnit
from assur.scenes.schema.view import ViewDocument

OF_BODY = (
    "unauthorized",
    "too-many-requests",
    "bad-syntax",
    "too-slow",
    "too-large",
    "wrong-media-type",
    "bad-input",
    "quarantined",
    "fault",
)
OF_KEY = ("key-reused", "key-in-use")
OF_WORKER = ("worker-crashed", "busy", "not-ready", "worker-timeout")
OF_FOLDER = ("no-mesh-folder", "mesh-folder-full", "mesh-folder-fault")
"""Kinds of problems of a route that reads a body, that may be sent again with a key, that asks a worker, and that keeps
a mesh."""
WORKED = (*OF_BODY, *OF_WORKER)
PLANNED = (*OF_BODY, *OF_KEY, *OF_WORKER)
OF_TASK = ("cell-unknown", "no-mesh-folder", *PLANNED)
STARTED = (*OF_BODY, *OF_KEY, "busy", "not-ready")
SIMULATED = ("no-simulations", *STARTED)
JOB_ANSWERED = (
    "job-lost", "job-not-done", "bad-input", "quarantined", "fault", "worker-crashed", "busy", "not-ready",
    "worker-timeout", "simulation-fault",
)  # fmt: skip

CERTIFICATE = parameter(
    "certificate",
    "the whole table of the proof, or its digest and size",
    {"type": "string", "enum": ["full", "digest"], "default": "full"},
)
PLAN: dict[str, Any] = body(ref("Request"), {}, CERTIFICATE) | {
    "description": 'A body `{"scenario": NAME}` is planned, too, as by `/v1/scenes/{name}/plans`.'
}
PLAN_OR_FILE = PLAN | {"parameters": [CERTIFICATE, *plan_files.PARAMETERS]}
SCENARIO = parameter("name", "name of a shipped scenario", {"type": "string"}, "path")
JOB: dict[str, Any] = {"parameters": [parameter("name", "id of a job", {"type": "string"}, "path")]}
SCENE: dict[str, Any] = body(
    ref("SceneQuestion"),
    {"a short search": {"options": {"stop": "first"}}},
    SCENARIO,
    CERTIFICATE,
) | {"description": "There may be no body at all."}
SCENE["requestBody"]["required"] = False
SHA256 = parameter("sha256", "SHA-256 of the file's bytes", {"type": "string", "pattern": "^[0-9a-f]{64}$"}, "path")
MESH: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
    },
    "parameters": [
        SHA256,
        *(
            parameter(
                name,
                f"with `{other}`: have the mesh covered now, as requests will name it",
                {"type": "string", "enum": list(get_args(kind))},
            )
            for name, other, kind in (("format", "unit", MeshFormat), ("unit", "format", MeshUnit))
        ),
    ],
}
CELL: dict[str, Any] = body(ref("Cell"), {}, SHA256)
TASK: dict[str, Any] = body(
    ref("Task"),
    {},
    SHA256,
    CERTIFICATE,
    parameter("fields", "names of fields of the answer, or paths, separated by commas; `status` is always there",
              {"type": "string"}),
    parameter("digits", "significant digits of the numbers of the answer",
              {"type": "integer", "minimum": LEAST_DIGITS, "maximum": MOST_DIGITS}),
    *plan_files.PARAMETERS,
)  # fmt: skip
IK_EXAMPLE = {
    "robot": {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}},
    "pose": {"at_mm": [350, 0, 150], "yaw_deg": 90},
}


def _with_plan(*kinds: str) -> dict[str, Any]:
    """The body of a request and its answer, which is one of these components."""
    plan: dict[str, Any] = ref(kinds[0]) if len(kinds) == 1 else {"oneOf": [ref(kind) for kind in kinds]}
    return body(fields(["request", "plan"], request=ref("Request"), plan=plan, **MARKS))


VIEWED = _with_plan("PlannedAnswer", "NotPlannedAnswer", "CheckedPlan")
TEXT = body(
    fields(
        [],
        text={"type": "string", "description": "a scenario in YAML; beside a cell, one of its tasks"},
        cell={"type": "string", "description": "the text of a cell, in YAML; without a text, the cell alone"},
        draw={"type": "boolean", "default": False, "description": "give a view of the cell at its start, too"},
        set={"type": "object", "description": "values of the request, by their paths, that are written into the texts"},
        move={"type": "object", "description": "a body, or a step by its number, whose place in the texts is moved"},
    ),
    {"a scenario": {"text": scenario_text("transfer")}},
)


class Direct(APIRoute):
    """A route whose function gets the request and gives the response; a plain function is called beside the event loop.
    FastAPI describes it, and does not look at each request."""

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        if self.methods and scope["method"] not in self.methods:
            await super().handle(scope, receive, send)  # which refuses it
            return
        request = Request(scope, receive, send)
        response = await (self.endpoint(request) if self._waits else run_in_threadpool(self.endpoint, request))
        await response(scope, receive, send)

    @cached_property
    def _waits(self) -> bool:
        return iscoroutinefunction(self.endpoint)


class Row(NamedTuple):
    """An address, and the function that answers there.

    `operation`: its name in the description, with its `tag` and `summary`; empty: it is not described. `gives`: a model
    or a class of responses; `status`: of its answer; `responses` by status: further ones, described. `problems`: kinds
    that it may answer with. `takes`: body and parameters, as an `openapi_extra`.
    """

    method: str
    path: str
    answers: Callable[..., Any]
    operation: str = ""
    tag: str = ""
    summary: str = ""
    gives: Any = None
    problems: tuple[str, ...] = ()
    takes: dict[str, Any] | None = None
    status: int = 200
    responses: Mapping[int | str, dict[str, Any]] = MappingProxyType({})

    def add_to(self, router: APIRouter) -> None:
        """Adds the address to a router."""
        is_class = isinstance(self.gives, type) and issubclass(self.gives, Response)
        gives = {"response_class": self.gives} if is_class else {"response_model": self.gives}
        router.add_api_route(
            self.path,
            self.answers,
            methods=[self.method],
            operation_id=self.operation or None,
            tags=[self.tag],
            summary=self.summary,
            openapi_extra=self.takes,
            include_in_schema=bool(self.operation),
            route_class_override=Direct,
            status_code=self.status,
            responses={**problems(*self.problems), **self.responses},
            **gives,
        )


JOB_ANSWER: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The answer",
        "content": {
            "application/json": {
                "schema": {"anyOf": [ref(name) for name in ("PlannedAnswer", "NotPlannedAnswer", "SimulationResult")]}
            }
        },
    }
}
EVENTS = {"content": {"text/event-stream": {}}, "description": "events called as the state; data as JobDocument"}
METRICS = {"content": {"text/plain": {"schema": {"type": "string"}}}, "description": "text of Prometheus"}
TABLE = (
    Row("POST", "/v1/plans", routes.plan, "plan", "plans", "Plan a request", Answer, PLANNED, PLAN_OR_FILE,
        responses=plan_files.responses(problems(*PLANNED))),
    Row("POST", "/v1/cells/{sha256}/plans", cell_routes.plan_task, "plan_task", "cells",
        "Plan a task in a cell that is kept", None, OF_TASK, TASK,
        responses=plan_files.responses(problems(*OF_TASK))),
    Row("POST", "/v1/scenes/{name}/plans", routes.plan_scene, "plan_scene", "plans", "Plan a shipped scenario", Answer,
        ("not-found", *PLANNED), SCENE),
    Row("POST", "/v1/plans/check", answered_by(jobs.check), "check_plan", "plans", "Check a plan against its request",
        Verdict, WORKED, _with_plan("PlannedAnswer")),
    Row("POST", "/v1/plans/view", answered_by(jobs.view), "view_plan", "plans",
        "What a viewer plays of a plan, or of a refusal: poses over time, meshes, curves", ViewDocument, WORKED,
        VIEWED),
    Row("POST", "/v1/plans/report", answered_by(jobs.report), "report_plan", "plans",
        "A page that plays a plan, or a refusal, and says all of it", HTMLResponse, WORKED, VIEWED),
    Row("POST", "/v1/plans/export", answered_by(jobs.export), "export_plan", "plans",
        "A plan as a controller's file, proved on the points of the file", ExportAnswer, WORKED,
        body(ref("ExportQuestion"))),
    Row("POST", "/v1/trajectories/check", answered_by(jobs.check_trajectory), "check_trajectory", "plans",
        "Prove or refute a trajectory that was made elsewhere", TrajectoryVerdict, WORKED,
        body(ref("TrajectoryQuestion"))),
    Row("POST", "/v1/ik", answered_by(jobs.ik, PLAN_BODY_BYTES), "solve_ik", "kinematics",
        "All joint positions at a pose of the tool, or the pose of the tool at joints", IkAnswer, WORKED,
        body(ref("IkQuestion"), {"a robot of the catalogue": IK_EXAMPLE})),
    Row("POST", "/v1/scenes/parse", answered_by(text_jobs.parse, PLAN_BODY_BYTES), "parse_scene", "scenes",
        "The request that the text of a scenario means, or its faults with their lines", Parsed, WORKED, TEXT),
    Row("GET", "/v1/robots", routes.list_robots, "list_robots", "kinematics", "The robot catalogue",
        responses=component("Robots")),
    Row("GET", "/v1/scenes", routes.list_scenes, "list_scenes", "scenes", "The shipped scenarios", Scenes),
    Row("GET", "/v1/scenes/{name}", routes.show_scene, "show_scene", "scenes",
        "The request of a shipped scenario, ready to be posted", None, ("not-found",), {"parameters": [SCENARIO]},
        responses=component("Request")),
    Row("GET", "/v1/scenes/{name}/text", routes.show_scene_text, "show_scene_text", "scenes",
        "The text of a shipped scenario, as it is in its file", PlainTextResponse, ("not-found",),
        {"parameters": [SCENARIO]}, responses={200: {"content": {"application/yaml": {}}}}),
    Row("GET", "/v1/schema", routes.schema, "show_request_schema", "plans", "JSON Schema of the request",
        responses=component("JsonSchema")),
    Row("GET", "/livez", routes.live, "show_live", "service", "Whether the service runs", Live),
    Row("GET", "/readyz", routes.ready, "show_ready", "service",
        "Whether every worker has planned once, and the service is not about to stop", Ready,
        ("not-ready", "draining")),
    Row("POST", "/v1/jobs", job_routes.start, "start_job", "jobs", "Plan a request while the client is elsewhere",
        JobDocument, STARTED, PLAN, 202),
    Row("POST", "/v1/scenes/{name}/jobs", job_routes.start_scene, "start_scene_job", "jobs",
        "Plan a shipped scenario while the client is elsewhere", JobDocument, ("not-found", *STARTED), SCENE, 202),
    Row("POST", "/v1/simulations", simulation_routes.simulate, "simulate", "jobs",
        "How many parts a minute a cell takes", JobDocument, SIMULATED, body(ref("Simulation")), 202),
    Row("POST", "/v1/cells/{sha256}/simulations", simulation_routes.simulate_kept, "simulate_cell", "cells",
        "How many parts a minute a cell takes that is kept", JobDocument,
        ("cell-unknown", "no-mesh-folder", *SIMULATED), body(ref("SimulationOfCell"), {}, SHA256), 202),
    Row("GET", "/v1/jobs/{name}", job_routes.show, "show_job", "jobs", "How far a job has come", JobDocument,
        ("job-lost",), JOB),
    Row("GET", "/v1/jobs/{name}/answer", job_routes.answer, "show_job_answer", "jobs",
        "The answer of a job that is done: a plan, as POST /v1/plans would have given it, or figures of a simulation",
        None, JOB_ANSWERED, JOB, responses=JOB_ANSWER),
    Row("GET", "/v1/jobs/{name}/page", job_routes.page, "show_job_page", "jobs",
        "The page of a simulation that is done: what the arm does in its first run", HTMLResponse,
        ("no-page", *JOB_ANSWERED), JOB),
    Row("GET", "/v1/jobs/{name}/events", job_routes.events, "watch_job", "jobs",
        "The progress of a job as server-sent events, until it has ended", None, ("job-lost",), JOB,
        responses={200: EVENTS}),
    Row("DELETE", "/v1/jobs/{name}", job_routes.cancel, "delete_job", "jobs",
        "Call a job off, or forget one that has ended", JobDocument, ("job-lost",), JOB),
    Row("GET", "/studio", operation_routes.studio),
    Row("GET", "/studio/{name}", operation_routes.studio_file),
    Row("PUT", "/v1/meshes/{sha256}", mesh_routes.put_mesh, "keep_mesh", "meshes",
        "Keep a mesh file, so that requests can name it by its digest", KeptMesh, (*WORKED, *OF_FOLDER), MESH,
        responses={201: {"model": KeptMesh, "description": "It is new here"}}),
    Row("GET", "/v1/meshes/{sha256}", mesh_routes.show_mesh, "show_mesh", "meshes",
        "Whether a mesh is known, its size, and until when it is kept", KeptMesh,
        ("mesh-unknown", "no-mesh-folder", "bad-input"), {"parameters": [SHA256]}),
    Row("HEAD", "/v1/meshes/{sha256}", mesh_routes.show_mesh),
    Row("PUT", "/v1/cells/{sha256}", cell_routes.put_cell, "keep_cell", "cells",
        "Keep a cell, so that tasks can be planned in it by its digest", StoredCell, (*WORKED, *OF_FOLDER), CELL,
        responses={201: {"model": StoredCell, "description": "It is new here"}}),
    Row("GET", "/v1/cells/{sha256}", cell_routes.show_cell, "show_cell", "cells",
        "Whether a cell is known, its size, and until when it is kept", StoredCell,
        ("cell-unknown", "no-mesh-folder", "bad-input"), {"parameters": [SHA256]}),
    Row("HEAD", "/v1/cells/{sha256}", cell_routes.show_cell),
    Row("GET", "/", operation_routes.index),
    Row("GET", "/v1/version", operation_routes.show_version, "show_version", "service", "Which build this is",
        VersionDocument),
    Row("GET", "/metrics", operation_routes.metrics, "show_metrics", "service",
        "Metrics for operators, as Prometheus reads them", Response, responses={200: METRICS}),
)  # fmt: skip
"""All addresses, the most used first."""

router = APIRouter()
for _each in TABLE:
    _each.add_to(router)
