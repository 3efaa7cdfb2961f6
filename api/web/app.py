"""`create_app(settings)`: the service as an ASGI application."""

from __future__ import annotations

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

from fastapi import FastAPI
from fastapi.middleware.asyncexitstack import AsyncExitStackMiddleware
from fastapi.routing import APIRoute
from fastapi_offline import FastAPIOffline
from starlette.exceptions import HTTPException
from starlette.middleware.exceptions import ExceptionMiddleware
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Match

from assur.api.documents import problem_response
from assur.api.problems import Problem
from assur.api.version import version
from assur.api.web import openapi, simulation_routes
from assur.api.web.clients import Clients, KnowsClients
from assur.api.web.connections import Connections, Gate
from assur.api.web.idempotency import Idempotency
from assur.api.web.job_store import JobStore
from assur.api.web.operation_routes import watch
from assur.api.web.representation import Representation
from assur.api.web.request_log import FACTS, RequestLog
from assur.api.web.route_table import router
from assur.api.web.service import Service
from assur.api.web.settings import Settings
from assur.api.web.uploads import Uploads

HTTP_KINDS = {404: "not-found", 405: "method-not-allowed"}
"""What Starlette itself refuses, by status."""

OF_FILES = {"GET", "HEAD"}
"""Methods of a folder of files, which changes the path of its request so that no route has it."""


def create_app(settings: Settings | None = None) -> FastAPI:
    """The service with `settings` (default: from the environment). Its workers start with its lifespan."""
    service = Service(Settings.from_environment() if settings is None else settings)
    clients = Clients(service.settings)
    jobs = JobStore(service)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        service.workers.start()
        try:
            yield
        finally:
            await jobs.stop()
            await service.workers.stop()

    app: FastAPI = FastAPIOffline(
        title="assur",
        version=version(),
        description=openapi.TEXT,
        lifespan=lifespan,
        redirect_slashes=False,
        telemetry={"tracing": False, "metrics": False, "logs": False},  # docs/decisions/0031-operations.md
    )
    app.state.service, app.state.jobs = service, jobs
    app.state.keys = Idempotency(service.meters)
    app.state.uploads = Uploads(service.settings.mesh_quota_mib << 20)
    app.state.connections = Connections(service.settings)
    for page in app.router.routes:
        if isinstance(page, APIRoute):  # of FastAPI, which calls its function
            page.app = AsyncExitStackMiddleware(page.app)
    app.router.routes[:0] = router.routes  # included, they would be matched twice
    refusals = ExceptionMiddleware(app.router, {Problem: _on_problem, HTTPException: _on_http})
    known = KnowsClients(Representation(refusals), clients, router.routes)
    gate = Gate(known, app.state.connections)
    # in place of FastAPI's rings, which are for functions that it calls: `assur.api.web.route_table.Direct`
    app.middleware_stack = RequestLog(gate, watch(service, jobs, clients), app.routes)
    described = app.openapi

    def described_in_full() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = openapi.complete(
                described(),
                service.settings.max_budget_s,
                **simulation_routes.components(service.settings.max_simulated_minutes),
            )
        return app.openapi_schema

    app.openapi = described_in_full  # type: ignore[method-assign]
    return app


async def _on_problem(request: Request, problem: Any) -> Response:
    request.scope[FACTS]["problem"] = problem.kind
    return problem_response(problem)


async def _on_http(request: Request, error: Any) -> Response:
    """What Starlette refuses itself, as a problem; the path of the request is not repeated."""
    kind = HTTP_KINDS.get(error.status_code, "bad-syntax")
    request.scope[FACTS]["problem"] = kind
    headers = dict(error.headers or {})
    if "Allow" in headers:  # Starlette names the methods of the first route of a path only
        headers["Allow"] = ", ".join(sorted(_methods(request)))
    detail = f"Allowed here: {headers['Allow']}." if "Allow" in headers else "See /docs for what there is."
    return problem_response(Problem(kind, detail, headers=headers))


def _methods(request: Request) -> set[str]:
    """The methods that the address of `request` knows."""
    here = [route for route in request.app.routes if route.matches(request.scope)[0] is not Match.NONE]
    here = [route for route in here if getattr(route, "path", None) == request.scope["path"]] or here
    return {method for route in here for method in getattr(route, "methods", None) or ()} or OF_FILES
