"""The outermost ring of the service: an id and a trace for each request, its metrics, one log line, and no exception
ever leaves it."""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping, MutableMapping, Sequence
from os import urandom
from typing import Any

from starlette.requests import ClientDisconnect
from starlette.routing import BaseRoute, Match
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from assur.api.documents import problem_response
from assur.api.logs import ABOUT, LOGGER, event
from assur.api.problems import Problem
from assur.api.telemetry.meters import Meters
from assur.api.telemetry.trace import CURRENT, Trace, new_traceparent
from assur.api.web.header_values import values_of

HEADERS = (
    (b"cache-control", b"no-store"),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
)
FACTS = "assur.facts"
"""Key of the request scope under which routes leave what is to be logged with the request."""
CLIENT_GONE = 499
"""Logged, never seen: who would have read it has closed the connection."""
QUIET = frozenset({"/livez", "/readyz", "/metrics"})
"""Routes that are called every few seconds: logged at debug level only, but for requests that are wrong."""
METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
"""Methods that are logged by their name. Any other is a word of the caller."""


class RequestLog:
    """ASGI middleware. A fault inside is answered with a problem that bears the id under which it was logged."""

    def __init__(self, app: ASGIApp, meters: Meters | None = None, routes: Sequence[BaseRoute] = ()) -> None:
        self._app = app
        self._meters = meters or Meters()
        self._routes = routes

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        trace = Trace(urandom(16).hex(), new_traceparent(values_of(scope["headers"], b"traceparent")))
        original = dict(scope)  # a part of the application that is mounted changes what the scope says of its path
        scope[FACTS] = trace.facts
        began = time.monotonic()
        status = taken = 0

        async def receiving() -> Message:
            nonlocal taken
            message = await receive()
            taken += len(message.get("body", b""))
            return message

        async def sending(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                _add_headers(message, trace)
            await send(message)

        tokens = CURRENT.set(trace), ABOUT.set(trace.carried())
        try:
            await self._app(scope, receiving, sending)
        except ClientDisconnect:
            status = CLIENT_GONE
        except Exception:  # noqa: BLE001 - the last ring: whatever it is, it is logged and answered, never shown
            self._meters.faults.inc()
            LOGGER.exception("a request met a fault", extra={"facts": {"request": trace.identity}})
            trace.facts["problem"] = "fault"
            if not status:
                detail = f"It is logged as request {trace.identity}. The request may be sent again."
                await problem_response(Problem("fault", detail))(scope, receive, sending)
        finally:
            CURRENT.reset(tokens[0])
            ABOUT.reset(tokens[1])
            method = scope["method"] if scope["method"] in METHODS else "OTHER"
            route = self._route(scope, original)
            self._count(route, method, status, trace, time.monotonic() - began)
            event(
                "request",
                logging.DEBUG if route in QUIET and not 400 <= status < 500 else logging.INFO,
                **trace.carried(),
                method=method,
                route=route,
                status=status,
                ms=round(1e3 * (time.monotonic() - began), 1),
                bytes_in=taken,
                **trace.log_facts(),
            )

    def _route(self, scope: Scope, original: Scope) -> str:
        """The address of a route; FastAPI leaves its own routes in the scope, Starlette (pages, files) does not."""
        found = scope.get("route") or next(
            (each for each in self._routes if each.matches(original)[0] is not Match.NONE), None
        )
        return str(getattr(found, "path", "none"))

    def _count(self, route: str, method: str, status: int, trace: Trace, seconds: float) -> None:
        facts: Mapping[str, Any] = trace.facts
        outcome, problem = (str(facts.get(name, "")) for name in ("outcome", "problem"))
        self._meters.answered(route, method, status, outcome, problem, seconds)


def _add_headers(message: MutableMapping[str, Any], trace: Trace) -> None:
    present = {name.lower() for name, _ in message["headers"]}
    added = [*HEADERS, (b"x-request-id", trace.identity.encode()), (b"traceparent", trace.traceparent.encode())]
    timing = trace.server_timing()
    if timing:
        added.append((b"server-timing", timing.encode()))
    added += [(name.encode(), value.encode()) for name, value in trace.kept_headers().items()]
    message["headers"] = [*message["headers"], *[pair for pair in added if pair[0] not in present]]
