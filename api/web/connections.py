"""The connections of one service: how many there are, how long their headers may take, and the stop.

uvicorn's h11 protocol gives a kept connection a time to begin its next request, and nothing else: a client may send
headers for ever, and as many may connect as there are files. `TimedProtocol` adds a time for headers, `Connections` a
number. `Gate` is the part that sees requests: what it refuses gets a problem, as any other refusal.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import MutableMapping
from typing import Any, cast

import h11
from h11._connection import DEFAULT_MAX_INCOMPLETE_EVENT_SIZE
from starlette.types import ASGIApp, Receive, Scope, Send
from uvicorn.config import Config
from uvicorn.protocols.http.h11_impl import H11Protocol, RequestResponseCycle
from uvicorn.server import ServerState

from assur.api.documents import problem_response
from assur.api.logs import event
from assur.api.problems import Problem
from assur.api.web.header_values import Pairs, values_of
from assur.api.web.request_log import FACTS
from assur.api.web.settings import Settings

CHUNK_BYTES = 512
"""Least size of the chunks of a body, on average."""
FIRST_CHUNKS = 128
"""So many chunks do not count: a small body may come in pieces of any size."""
LEAVES = "assur.leaves"
"""Key of the request scope: what is called when its client closes the connection; None: that has happened."""
LOGGED_S = 10.0
"""How often it is logged at most that connections are closed for others, s."""


class Connections:
    """The open connections of one event loop, and whether the service is about to stop."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.draining = False
        """Not ready any more, and every answer closes its connection."""
        self.open: set[TimedProtocol] = set()
        """The open connections."""
        self._logged = -LOGGED_S

    def admit(self, connection: TimedProtocol) -> None:
        """Takes a new connection. Where there are too many, the one is closed that has waited longest for its client,
        first of those on which no request was answered; if none waits, the new one is closed."""
        self.open.add(connection)
        if len(self.open) <= self.settings.connections:
            return
        rivals = [each for each in self.open if each.waiting and each is not connection]
        closed = min(rivals, key=lambda each: (each.used, each.since), default=connection)
        self.open.discard(closed)
        closed.transport.abort()
        if time.monotonic() - self._logged >= LOGGED_S:
            self._logged = time.monotonic()
            event("too many connections", logging.WARNING, open=len(self.open))

    def leave(self, connection: TimedProtocol) -> None:
        """Forgets a connection that is closed; any number of times."""
        self.open.discard(connection)


class CountedConnection(h11.Connection):
    """The server's side of a connection, which counts the chunks of each body: one read from the system may hold
    40,000 of them, and parsing these takes longer than anybody else should wait."""

    def __init__(self, most_incomplete: int) -> None:
        super().__init__(h11.SERVER, most_incomplete)
        self._chunks = self._bytes = 0

    def next_event(self) -> h11.Event | type[h11.NEED_DATA] | type[h11.PAUSED]:
        """As h11's. Raises `RemoteProtocolError` at the first chunk that is one too many."""
        event = super().next_event()
        if type(event) is h11.Request:  # exactly that: `isinstance` with classes of h11 runs Python code
            self._chunks = self._bytes = 0
        elif type(event) is h11.Data:
            self._chunks += event.chunk_start
            if self._chunks - FIRST_CHUNKS > self._bytes / CHUNK_BYTES:
                raise h11.RemoteProtocolError("too many small chunks")
            self._bytes += len(event.data)
        return event


class TimedProtocol(H11Protocol):
    """One connection, with a time for the headers of each request. Make it by `functools.partial` with the
    `Connections` of the service."""

    def __init__(
        self,
        connections: Connections,
        config: Config,
        server_state: ServerState,
        app_state: dict[str, Any],
        _loop: asyncio.AbstractEventLoop | None = None,
    ) -> None:
        super().__init__(config, server_state, app_state, _loop)
        self.conn = CountedConnection(config.h11_max_incomplete_event_size or DEFAULT_MAX_INCOMPLETE_EVENT_SIZE)
        self._all = connections
        self._clock: asyncio.TimerHandle | None = None
        self.used = False
        """Whether a request was answered on it."""
        self.since = time.monotonic()
        """When it began to wait for its next request."""

    @property
    def idle(self) -> bool:
        """Whether it waits for a request, or for the rest of the headers of one."""
        cycle: RequestResponseCycle | None = self.cycle  # None before the first request, whatever uvicorn declares
        return cycle is None or cycle.response_complete

    @property
    def waiting(self) -> bool:
        """Whether only its client keeps it: it is idle, its body is not complete, its answer is being sent, or the
        answer before, which its client has not taken, holds up the next one."""
        return self.idle or self.cycle.more_body or self.cycle.response_started or self.flow.write_paused

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        self._limit(self._all.settings.header_s)
        self._all.admit(self)

    def connection_lost(self, exc: Exception | None) -> None:
        self._all.leave(self)
        self._unset_clock()
        self._unset_keepalive_if_required()
        super().connection_lost(exc)
        if not self.idle:
            scope = cast(dict[str, Any], self.cycle.scope)
            leave, scope[LEAVES] = scope.get(LEAVES), None
            if leave is not None:
                leave()

    def handle_events(self) -> None:
        """As uvicorn's. The time runs from the first byte of a request until its headers are complete, and while a body
        comes whose request was answered before."""
        super().handle_events()
        state = self.conn.their_state
        if not self.idle or (self.used and state is h11.IDLE and not self.conn.trailing_data[0]):
            self._unset_clock()
        else:
            self._limit(self._all.settings.body_s if state is h11.SEND_BODY else self._all.settings.header_s)

    def on_response_complete(self) -> None:
        self.used, self.since = True, time.monotonic()
        super().on_response_complete()

    def _unsupported_upgrade_warning(self) -> None:
        """Nothing: a request for another protocol is no fault of the service. `Gate` refuses WebSockets."""

    def _limit(self, within_s: float) -> None:
        if self._clock is None and not self.transport.is_closing():
            self._clock = self.loop.call_later(within_s, self.transport.abort)

    def _unset_clock(self) -> None:
        if self._clock is not None:
            self._clock.cancel()
            self._clock = None


class Gate:
    """ASGI middleware. Refuses WebSockets; while the service drains, each answer is the last one of its connection, and
    states this."""

    def __init__(self, app: ASGIApp, connections: Connections) -> None:
        self._app = app
        self._connections = connections

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        async def sending(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start" and self._connections.draining:
                others = [pair for pair in message["headers"] if pair[0].lower() != b"connection"]
                message["headers"] = [*others, (b"connection", b"close")]
            await send(message)

        if scope["type"] == "http" and b"upgrade" in dict(scope["headers"]) and _wants_websocket(scope["headers"]):
            problem = Problem(
                "no-websockets",
                "Send requests of HTTP. GET /v1/jobs/{name}/events sends the progress of a job as server-sent events.",
            )
            scope.get(FACTS, {})["problem"] = problem.kind
            await problem_response(problem)(scope, receive, sending)
            return
        await self._app(scope, receive, sending)


def _wants_websocket(headers: Pairs) -> bool:
    """Whether a request asks to go on as a WebSocket (RFC 6455, 4.1). Any other upgrade is ignored, as HTTP allows."""
    wanted, tokens = (
        {item.strip().lower() for line in values_of(headers, name) for item in line.split(",")}
        for name in (b"upgrade", b"connection")
    )
    return "websocket" in wanted and "upgrade" in tokens
