"""The addresses of the service. Each says what it takes and gives; the work is in `assur.api.web.service`."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from functools import cache
from typing import Any, cast, get_args

from fastapi import APIRouter, Request
from fastapi.routing import APIRoute
from starlette.responses import HTMLResponse, PlainTextResponse, Response

from assur.api.documents import json_response, to_json
from assur.api.problems import Problem
from assur.api.web import plan_files
from assur.api.web.body_reader import read_body
from assur.api.web.clients import client_of
from assur.api.web.idempotency import Idempotency
from assur.api.web.openapi import (
    CHECK_BODY,
    EXPORT_BODY,
    IK_BODY,
    PARSE_BODY,
    PLAN_BODY,
    REPORT_BODY,
    SCENE_BODY,
    TRAJECTORY_BODY,
    VIEW_BODY,
    Live,
    Parsed,
    Ready,
    Scenes,
    component,
    problems,
)
from assur.api.web.request_log import CLIENT_GONE
from assur.api.web.service import Order, Service
from assur.api.web.settings import CHECK_BODY_BYTES, PLAN_BODY_BYTES
from assur.api.workers import jobs
from assur.planner.errors import InputError
from assur.scenes.requests import Detail, request_schema, robots, shipped_scenarios
from assur.scenes.scenarios import scenario_text
from assur.scenes.schema.answer import Answer, Verdict
from assur.scenes.schema.export import ExportAnswer, TrajectoryVerdict
from assur.scenes.schema.ik import IkAnswer
from assur.scenes.schema.view import ViewDocument

BODY_PROBLEMS = (
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
KEY_PROBLEMS = ("key-reused", "key-in-use")
WORKER_PROBLEMS = ("worker-crashed", "busy", "not-ready", "worker-timeout")


class Direct(APIRoute):
    """A route whose function reads its request itself. FastAPI describes it, and does not look at each request."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        handler: Callable[[Request], Coroutine[Any, Any, Response]] = self.endpoint
        return handler


router, bodies = APIRouter(), APIRouter(route_class=Direct)
# Routes that read files are plain functions: FastAPI runs those beside the event loop.


def service_of(request: Request) -> Service:
    service: Service = request.app.state.service
    return service


async def _unless_gone(request: Request, work: Awaitable[jobs.Answer]) -> Response:
    """The response to `work`, which is cancelled as soon as the client closes the connection."""
    working = asyncio.ensure_future(work)
    leaving = asyncio.ensure_future(_gone(request))
    leaving.add_done_callback(lambda _: working.cancel())
    try:
        answer = await working
    except asyncio.CancelledError:
        if not leaving.done():
            raise
        return Response(status_code=CLIENT_GONE)
    finally:
        leaving.cancel()
        working.cancel()
    return Response(answer.body, answer.status, answer.headers, answer.media_type)


async def once(request: Request, body: bytes, work: Callable[[], Awaitable[Response]]) -> Response:
    """What `work` answers; or what it answered before, if the request says that it is sent again. Raises `Problem`."""
    keys: Idempotency = request.app.state.keys
    return await keys.once(request, body, work)


def _known(parameters: tuple[str, ...]) -> str:
    return "a known parameter: " + ", ".join(parameters) if parameters else "no parameter at all"


async def _gone(request: Request) -> None:
    """Returns when the client has closed the connection; its body has been read before."""
    while (await request.receive())["type"] != "http.disconnect":
        pass


async def read_admitted(request: Request, limit: int, *parameters: str, json: bool = True) -> bytes:
    """The body of a request that is admitted. `json`: as `read_body`. Raises `Problem`."""
    admit(request, *parameters)
    service = service_of(request)
    with service.meters.reading():
        return await read_body(request, limit, service.settings.body_s, service.reading, json=json)


def admit(request: Request, *parameters: str) -> None:
    """Raises the `Problem` of a request that is turned away unread: for a parameter of the address that is not one of
    `parameters`, and when the queue is full."""
    for name in request.query_params:
        if name not in parameters:
            raise Problem.of_input(InputError(name, request.query_params[name], _known(parameters)))
    service_of(request).workers.require_room(client_of(request))


def certificate_of(request: Request) -> Detail:
    """How much of the certificate is asked for. Raises `Problem`."""
    certificate = request.query_params.get("certificate", "full")
    if certificate not in get_args(Detail):
        raise Problem.of_input(InputError("certificate", certificate, " or ".join(get_args(Detail))))
    return cast(Detail, certificate)


async def scene_order(request: Request) -> Order:
    """What is asked about the shipped scenario that the address names. There may be no body. Raises `Problem`."""
    certificate, headers = certificate_of(request), request.headers
    empty = headers.get("content-length", "0") == "0" and "transfer-encoding" not in headers
    if empty and "content-type" not in headers:
        admit(request, "certificate")
        body = b""
    else:
        body = await read_admitted(request, PLAN_BODY_BYTES, "certificate")
    name, client = request.path_params["name"], client_of(request)
    try:
        return await service_of(request).scene_order(name, body, certificate, client)
    except InputError as error:
        raise Problem.of_input(error, "not-found") from error


def _answered_by(
    job: Callable[..., jobs.Reply],
    path: str,
    name: str,
    summary: str,
    body: dict[str, Any],
    limit: int = CHECK_BODY_BYTES,
    **more: Any,
) -> None:
    """An address whose body a worker answers by `job`, without a budget of its own. `more`: its `response_model` or
    `response_class`, and `tags` other than plans."""

    async def answered(request: Request) -> Response:
        given = await read_admitted(request, limit)
        return await _unless_gone(request, service_of(request).quick(job, client_of(request), given))

    described = {"operation_id": name, "tags": ["plans"], "summary": summary, "openapi_extra": body} | more
    bodies.post(path, responses=problems(*BODY_PROBLEMS, *WORKER_PROBLEMS), **described)(answered)


@bodies.post(
    "/v1/plans",
    operation_id="plan",
    tags=["plans"],
    summary="Plan a request",
    response_model=Answer,
    responses=plan_files.responses(problems(*BODY_PROBLEMS, *KEY_PROBLEMS, *WORKER_PROBLEMS)),
    openapi_extra=PLAN_BODY | {"parameters": PLAN_BODY["parameters"] + plan_files.PARAMETERS},
)
async def plan(request: Request) -> Response:
    how, client = plan_files.asked(request), client_of(request)
    if how is not None:
        body = await read_admitted(request, PLAN_BODY_BYTES, *plan_files.NAMES)
        return await once(
            request, body, lambda: _unless_gone(request, service_of(request).plan_file(body, how, client))
        )
    certificate = certificate_of(request)
    body = await read_admitted(request, PLAN_BODY_BYTES, "certificate")
    return await once(request, body, lambda: _unless_gone(request, service_of(request).plan(body, certificate, client)))


@bodies.post(
    "/v1/scenes/{name}/plans",
    operation_id="plan_scene",
    tags=["plans"],
    summary="Plan a shipped scenario",
    response_model=Answer,
    responses=problems("not-found", *BODY_PROBLEMS, *KEY_PROBLEMS, *WORKER_PROBLEMS),
    openapi_extra=SCENE_BODY,
)
async def plan_scene(request: Request) -> Response:
    order = await scene_order(request)
    key = order.work.key.encode()
    return await once(request, key, lambda: _unless_gone(request, service_of(request).do(order)))


_answered_by(
    jobs.check,
    "/v1/plans/check",
    "check_plan",
    "Check a plan against its request",
    CHECK_BODY,
    response_model=Verdict,
)
_answered_by(
    jobs.view,
    "/v1/plans/view",
    "view_plan",
    "What a viewer plays of a plan, or of a refusal: poses over time, meshes, curves",
    VIEW_BODY,
    response_model=ViewDocument,
)
_answered_by(
    jobs.report,
    "/v1/plans/report",
    "report_plan",
    "A page that plays a plan, or a refusal, and says all of it",
    REPORT_BODY,
    response_class=HTMLResponse,
)
_answered_by(
    jobs.export,
    "/v1/plans/export",
    "export_plan",
    "A plan as a controller's file, proved on the points of the file",
    EXPORT_BODY,
    response_model=ExportAnswer,
)
_answered_by(
    jobs.check_trajectory,
    "/v1/trajectories/check",
    "check_trajectory",
    "Prove or refute a trajectory that was made elsewhere",
    TRAJECTORY_BODY,
    response_model=TrajectoryVerdict,
)
_answered_by(
    jobs.ik,
    "/v1/ik",
    "solve_ik",
    "All joint positions at a pose of the tool, or the pose of the tool at joints",
    IK_BODY,
    response_model=IkAnswer,
    limit=PLAN_BODY_BYTES,
    tags=["kinematics"],
)


@router.get(
    "/v1/robots",
    operation_id="list_robots",
    tags=["kinematics"],
    summary="The robot catalogue",
    responses=component("Robots"),
)
def list_robots() -> Response:
    return json_response(to_json({"robots": robots()}))


@router.get(
    "/v1/scenes", operation_id="list_scenes", tags=["scenes"], summary="The shipped scenarios", response_model=Scenes
)
def list_scenes() -> Response:
    scenes = [{"name": name, "about": about} for name, about in shipped_scenarios().items()]
    return json_response(to_json({"scenes": scenes}))


@router.get(
    "/v1/scenes/{name}",
    operation_id="show_scene",
    tags=["scenes"],
    summary="The request of a shipped scenario, ready to be posted",
    responses={**component("Request"), **problems("not-found")},
)
def show_scene(request: Request, name: str) -> Response:
    if name == "parse":  # no scenario, but an address that takes a POST
        raise Problem("method-not-allowed", "Allowed here: POST.", headers={"Allow": "POST"})
    try:
        return json_response(to_json(service_of(request).scene(name)))
    except InputError as error:
        raise Problem.of_input(error, "not-found") from error


@router.get(
    "/v1/scenes/{name}/text",
    operation_id="show_scene_text",
    tags=["scenes"],
    summary="The text of a shipped scenario, as it is in its file",
    response_class=PlainTextResponse,
    responses={200: {"content": {"application/yaml": {}}}, **problems("not-found")},
)
def show_scene_text(name: str) -> Response:
    try:
        return Response(scenario_text(name), media_type="application/yaml")
    except InputError as error:
        raise Problem.of_input(error, "not-found") from error


_answered_by(
    jobs.parse,
    "/v1/scenes/parse",
    "parse_scene",
    "The request that the text of a scenario means, or its faults with their lines",
    PARSE_BODY,
    response_model=Parsed,
    limit=PLAN_BODY_BYTES,
    tags=["scenes"],
)


@router.get(
    "/v1/schema",
    operation_id="show_request_schema",
    tags=["plans"],
    summary="JSON Schema of the request",
    responses=component("JsonSchema"),
)
def schema() -> Response:
    return json_response(_schema())


@cache
def _schema() -> bytes:
    return to_json(request_schema())


@router.get(
    "/livez", operation_id="show_live", tags=["service"], summary="Whether the service runs", response_model=Live
)
async def live() -> Response:
    return json_response(to_json({"live": True}))


@router.get(
    "/readyz",
    operation_id="show_ready",
    tags=["service"],
    summary="Whether every worker has planned once, and the service is not about to stop",
    response_model=Ready,
    responses=problems("not-ready", "draining"),
)
async def ready(request: Request) -> Response:
    if request.app.state.connections.draining:
        raise Problem("draining", "The service was told to stop. Send new requests elsewhere.")
    workers = service_of(request).workers
    if not workers.ready:
        detail = f"{workers.warmed} of {workers.total} workers have planned."
        if workers.trouble:
            detail += f" The last one that was started did not plan: {workers.trouble}"
        raise Problem("not-ready", detail, headers={"Retry-After": "1"})
    return json_response(to_json({"ready": True, "workers": workers.total}))
