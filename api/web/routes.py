"""What answers at the addresses of plans, robots, scenarios and health (`assur.api.web.route_table`); the work is in
`assur.api.web.service`. What reads files is a plain function: those are called beside the event loop."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Coroutine
from functools import cache
from typing import Any, cast, get_args

from fastapi import Request
from starlette.responses import Response

from assur.api.documents import json_response, to_json
from assur.api.problems import Problem
from assur.api.web import plan_files
from assur.api.web.body_reader import read_body
from assur.api.web.clients import client_of
from assur.api.web.connections import LEAVES
from assur.api.web.idempotency import Idempotency
from assur.api.web.request_log import CLIENT_GONE
from assur.api.web.service import Order, Service
from assur.api.web.settings import CHECK_BODY_BYTES, PLAN_BODY_BYTES
from assur.api.workers import jobs
from assur.planner.errors import InputError
from assur.scenes.faults import raised_as
from assur.scenes.requests import Detail, request_schema, robots, shipped_scenarios
from assur.scenes.scenarios import scenario_text

DETAILS = get_args(Detail)


def service_of(request: Request) -> Service:
    service: Service = request.app.state.service
    return service


async def unless_gone(request: Request, work: Awaitable[jobs.Answer]) -> Response:
    """The response to `work`, which is cancelled as soon as the client closes the connection."""
    working, gone = asyncio.current_task(), False
    assert working is not None  # noqa: S101 - a coroutine runs in a task

    def leave() -> None:
        nonlocal gone
        gone = working.cancel()

    if request.scope.setdefault(LEAVES, leave) is None:
        leave()
    try:
        answer = await work
    except asyncio.CancelledError:
        if not gone or working.uncancel():
            raise
        return Response(status_code=CLIENT_GONE)
    finally:
        del request.scope[LEAVES]
    return Response(answer.body, answer.status, answer.headers, answer.media_type)


async def once(request: Request, body: bytes, work: Callable[[], Awaitable[Response]]) -> Response:
    """What `work` answers; or what it answered before, if the request says that it is sent again. Raises `Problem`."""
    keys: Idempotency = request.app.state.keys
    return await keys.once(request, body, work)


def _known(parameters: tuple[str, ...]) -> str:
    return "a known parameter: " + ", ".join(parameters) if parameters else "no parameter at all"


async def read_admitted(
    request: Request, limit: int, *parameters: str, json: bool = True, simulation: bool = False
) -> bytes:
    """The body of a request that is admitted. `json`: as `read_body`. Raises `Problem`."""
    service = admit(request, *parameters, simulation=simulation)
    return await read_body(request, limit, service.settings.body_s, service.reading, json=json)


def admit(request: Request, *parameters: str, simulation: bool = False) -> Service:
    """The service, for a request that is not turned away unread. Raises the `Problem` of one that is: for a parameter
    of the address that is not one of `parameters` or is there twice, and when the queue is full."""
    given, service = request.query_params, service_of(request)
    for name in given:
        if name not in parameters:
            raise Problem.of_input(InputError(name, given[name], _known(parameters)))
        if len(values := given.getlist(name)) > 1:
            raise Problem.of_input(InputError(name, ", ".join(values), f"{name} once"))
    service.workers.require_room(client_of(request), simulation=simulation)
    return service


def certificate_of(request: Request) -> Detail:
    """How much of the certificate is wanted. Raises `Problem`."""
    certificate = request.query_params.get("certificate", "full")
    if certificate not in DETAILS:
        raise Problem.of_input(InputError("certificate", certificate, " or ".join(DETAILS)))
    return cast(Detail, certificate)


async def scene_order(request: Request) -> Order:
    """The order for the shipped scenario that the address names. There may be no body. Raises `Problem`."""
    certificate, headers = certificate_of(request), request.headers
    empty = headers.get("content-length", "0") == "0" and "transfer-encoding" not in headers
    if empty and "content-type" not in headers:
        admit(request, "certificate")
        body = b""
    else:
        body = await read_admitted(request, PLAN_BODY_BYTES, "certificate")
    name, client = request.path_params["name"], client_of(request)
    with raised_as(_unknown):
        return await service_of(request).scene_order(name, body, certificate, client)


def _unknown(error: InputError) -> Problem:
    """The problem of a scenario that is not there."""
    return Problem.of_input(error, "not-found")


def answered_by(
    job: Callable[..., jobs.Reply], limit: int = CHECK_BODY_BYTES
) -> Callable[[Request], Coroutine[Any, Any, Response]]:
    """What answers at an address whose body a worker answers by `job`, without a budget of its own."""

    async def answered(request: Request) -> Response:
        given = await read_admitted(request, limit)
        return await unless_gone(request, service_of(request).quick(job, client_of(request), given))

    return answered


async def plan(request: Request) -> Response:
    how, client = plan_files.file_wanted(request), client_of(request)
    if how is not None:
        body = await read_admitted(request, PLAN_BODY_BYTES, *plan_files.NAMES)
        return await once(request, body, lambda: unless_gone(request, service_of(request).plan_file(body, how, client)))
    certificate = certificate_of(request)
    body = await read_admitted(request, PLAN_BODY_BYTES, "certificate", *plan_files.NAMES)
    return await once(request, body, lambda: unless_gone(request, service_of(request).plan(body, certificate, client)))


async def plan_scene(request: Request) -> Response:
    order = await scene_order(request)
    key = order.work.key.encode()
    return await once(request, key, lambda: unless_gone(request, service_of(request).do(order)))


def list_robots(_: Request) -> Response:
    return json_response({"robots": robots()})


def list_scenes(_: Request) -> Response:
    scenes = [{"name": name, "about": about} for name, about in shipped_scenarios().items()]
    return json_response({"scenes": scenes})


def show_scene(request: Request) -> Response:
    name = request.path_params["name"]
    if name == "parse":  # no scenario, but an address that takes a POST
        raise Problem("method-not-allowed", "Allowed here: POST.", headers={"Allow": "POST"})
    with raised_as(_unknown):
        return json_response(service_of(request).scene(name))


def show_scene_text(request: Request) -> Response:
    with raised_as(_unknown):
        return Response(scenario_text(request.path_params["name"]), media_type="application/yaml")


def schema(_: Request) -> Response:
    return json_response(_schema())


@cache
def _schema() -> bytes:
    return to_json(request_schema())


async def live(_: Request) -> Response:
    return json_response({"live": True})


async def ready(request: Request) -> Response:
    if request.app.state.connections.draining:
        raise Problem("draining", "The service is about to stop. Send new requests elsewhere.")
    workers = service_of(request).workers
    if not workers.ready:
        detail = f"{workers.warmed} of {workers.total} workers have planned."
        if workers.trouble:
            detail += f" The last one that was started did not plan: {workers.trouble}"
        raise Problem("not-ready", detail, again_s=1)
    return json_response({"ready": True, "workers": workers.total})
