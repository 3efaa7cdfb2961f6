"""The outermost ring of the service: an id for each request, one log line, and no exception ever leaves it."""

from __future__ import annotations

import logging
import time
from collections.abc import MutableMapping
from typing import Any
from uuid import uuid4

from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from assur.api.documents import problem_response
from assur.api.logs import LOGGER, event
from assur.api.problems import Problem

HEADERS = (
    (b"cache-control", b"no-store"),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
)
FACTS = "assur.facts"
"""Key of the request scope under which routes leave what is to be logged with the request."""
CLIENT_GONE = 499
"""Logged, never seen: who would have read it has closed the connection."""
QUIET = frozenset({"/livez", "/readyz"})
"""Routes that are asked every few seconds: logged at debug level only."""


class RequestLog:
    """ASGI middleware. A fault inside is answered with a problem that bears the id under which it was logged."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        identity = uuid4().hex
        began = time.monotonic()
        facts: dict[str, Any] = {}
        scope[FACTS] = facts
        status = 0

        async def sending(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                _add_headers(message, identity)
            await send(message)

        try:
            await self._app(scope, receive, sending)
        except ClientDisconnect:
            status = CLIENT_GONE
        except Exception:  # noqa: BLE001 - the last ring: whatever it is, it is logged and answered, never shown
            LOGGER.exception("a request met a fault", extra={"facts": {"request": identity}})
            if status == 0:
                detail = f"It is logged as request {identity}. The request may be sent again."
                await problem_response(Problem("fault", detail))(scope, receive, sending)
        finally:
            route = getattr(scope.get("route"), "path", "none")
            event(
                "request",
                logging.DEBUG if route in QUIET else logging.INFO,
                request=identity,
                route=route,
                status=status,
                ms=round(1e3 * (time.monotonic() - began), 1),
                **facts,
            )


def _add_headers(message: MutableMapping[str, Any], identity: str) -> None:
    present = {name.lower() for name, _ in message["headers"]}
    added = [*HEADERS, (b"x-request-id", identity.encode())]
    message["headers"] = [*message["headers"], *((name, value) for name, value in added if name not in present)]
