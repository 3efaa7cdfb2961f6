"""The addresses of jobs: a plan or a simulation that is ordered now and fetched later, with its progress as server-sent
events."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import Any, Literal

from fastapi import Request
from starlette.responses import Response, StreamingResponse
from typing_extensions import TypedDict

from assur.api.documents import json_response, to_json
from assur.api.problems import Problem
from assur.api.web.clients import client_of
from assur.api.web.job_store import Job, JobStore
from assur.api.web.routes import (
    certificate_of,
    once,
    read_admitted,
    scene_order,
    service_of,
)
from assur.api.web.service import Order
from assur.api.web.settings import PLAN_BODY_BYTES
from assur.api.workers.jobs import Answer
from assur.api.workers.simulation_jobs import SimulationProgress
from assur.planner.model.deadline import Progress

SILENCE_S = 15.0
"""A stream without events sends a comment this often, s, so that no proxy takes it for dead."""


class JobDocument(TypedDict):
    """A job. `progress`: null before a worker has begun; `outcome`: the status of its answer, of a simulation
    `complete` or `incomplete`; `problem`: why there is none, as the service would have answered at once."""

    id: str
    state: Literal["working", "done", "failed", "cancelled"]
    progress: Progress | SimulationProgress | None
    outcome: str | None
    problem: dict[str, Any] | None


def _store(request: Request) -> JobStore:
    store: JobStore = request.app.state.jobs
    return store


def _job(request: Request) -> Job:
    """The job that the address names. Raises `Problem`."""
    return _store(request).get(request.path_params["name"], client_of(request))


def _response(job: Job, status: int = 200, headers: dict[str, str] | None = None) -> Response:
    return json_response(job.document(), status, {"Cache-Control": "no-store", **(headers or {})})


def accepted(request: Request, order: Order, jobs: str) -> Response:
    """The response to a request whose job has begun. `jobs`: where jobs are, relative to the address of the request:
    a proxy may have put a prefix before both. Raises `Problem`."""
    job = _store(request).start(order)
    return _response(job, 202, {"Location": f"{jobs}/{job.id}"})


async def start(request: Request) -> Response:
    certificate = certificate_of(request)
    body = await read_admitted(request, PLAN_BODY_BYTES, "certificate")

    async def begun() -> Response:
        order = await service_of(request).order(body, certificate, client_of(request), parsed=True)
        return accepted(request, order, "jobs")

    return await once(request, body, begun)


async def start_scene(request: Request) -> Response:
    order = await scene_order(request)

    async def begun() -> Response:
        return accepted(request, order, "../../jobs")

    return await once(request, order.work.key.encode(), begun)


async def show(request: Request) -> Response:
    return _response(_job(request))


def _answer(job: Job) -> Answer:
    """The answer of a job that has ended. Raises `Problem`."""
    if job.problem is not None:
        raise job.problem
    if job.state == "working":
        raise Problem("job-not-done", "The job is working.", again_s=1)
    if job.answer is None:
        raise Problem("job-not-done", "The job was called off, so it has no answer. Send its request again.")
    return job.answer


async def answer(request: Request) -> Response:
    return json_response(_answer(_job(request)).body)


async def page(request: Request) -> Response:
    found = _answer(_job(request)).page
    if not found:
        raise Problem("no-page", "Only a simulation that has gone to its end has a page. GET …/answer has the answer.")
    return Response(found, media_type="text/html")


async def events(request: Request) -> Response:
    job = _job(request)

    async def stream() -> AsyncIterator[bytes]:
        async for changed in job.news(SILENCE_S):
            if changed:
                yield b"event: " + job.state.encode() + b"\ndata: " + to_json(job.document()) + b"\n\n"
            else:
                yield b": still working\n\n"

    # a proxy between must pass each event on as it comes
    headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}
    return StreamingResponse(stream(), media_type="text/event-stream", headers=headers)


async def cancel(request: Request) -> Response:
    return _response(_store(request).cancel(request.path_params["name"], client_of(request)))
