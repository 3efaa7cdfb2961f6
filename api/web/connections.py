"""The connections of one service: how many there are, which is closed when there are too many, and the stop.

`Connections` counts, in all and per address. It is asked when a connection comes, and looks at all of them twice a
second. `Gate` is the part that sees requests: what it turns away gets a problem, as any other refusal.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections import Counter
from collections.abc import MutableMapping
from typing import Any, Protocol

from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from assur.api.documents import problem_response
from assur.api.logs import event
from assur.api.problems import Problem
from assur.api.web.request_log import FACTS
from assur.api.web.settings import Settings
from assur.api.workers.admission import busy

HEALTH = frozenset({"/livez", "/readyz"})
"""Answered on every connection that is taken, also where there are too many."""
RESERVE = 32
"""So many connections are taken beyond the limits; only `HEALTH` is served on them."""
LOOK_S = 0.5
"""How often the connections are looked at, s: no time limit of theirs is more exact."""
AGAIN = 64
"""So many new connections of an address that has all it may have are taken between two looks; others of it give way.
Further ones are closed unseen: to make a connection and to close another takes the event loop ten times as long."""
CROWDED = "assur.crowded"
"""Key of the state of a request whose connection is one too many."""
SAID_S = 10.0
"""How often it is logged at most that connections are closed or refused, s."""


class Connection(Protocol):
    """A connection as `Connections` sees it."""

    address: str
    crowded: bool
    used: bool
    """Whether a request was answered on it."""
    since: float
    """When it began to do what it does now, by the clock of `time.monotonic`."""

    @property
    def idle(self) -> bool:
        """Whether it waits for a request, or for the rest of the headers of one."""

    @property
    def waiting(self) -> bool:
        """Whether only its client keeps it: it is idle, or its answer is not taken."""

    def look(self, now: float) -> None:
        """Closes it if what it waits for has not come in time."""

    def give_way(self) -> None:
        """Closes it, which is `waiting`, in favour of another."""


class Connections:
    """The open connections of one event loop, and whether the service is about to stop."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.draining = False
        """Not ready any more, and every answer closes its connection."""
        self._open: dict[Connection, None] = {}  # in the order in which they came
        self._of: Counter[str] = Counter()
        self._came: Counter[str] = Counter()  # since the last look, of addresses that have all they may have
        self._crowded = 0
        self._next_look: asyncio.TimerHandle | None = None
        self._said = -SAID_S

    def open(self) -> tuple[Connection, ...]:
        """The open connections, in the order in which they came."""
        return tuple(self._open)

    def takes(self, address: str) -> bool:
        """Whether a connection that comes from an address is to be made at all, and then to be asked for by `admit`."""
        if self._of[address] < self.settings.connections_per_address:
            return True
        self._came[address] += 1
        if self._came[address] <= AGAIN:
            return True
        self._tell("closed, too many at once")
        return False

    def admit(self, connection: Connection) -> bool:
        """Takes a new connection, and says whether it may stay.

        Where there are too many, in all or of its address, the one closes that has waited longest for its client. If
        none waits, the new one is `crowded`: one of `RESERVE` that are there for `HEALTH`.
        """
        full = len(self._open) - self._crowded >= self.settings.connections
        crowd = self._of[connection.address] >= self.settings.connections_per_address
        if full or crowd:
            rivals = [
                each
                for each in self._open
                if not each.crowded and (each.address == connection.address or not crowd) and each.waiting
            ]
            connection.crowded = not self._closes_one(rivals)
        if connection.crowded and self._crowded >= RESERVE:
            self._tell("refused")
            if not self._closes_one([each for each in self._open if each.waiting and each.crowded]):
                return False
        self._open[connection] = None
        if connection.crowded:
            self._crowded += 1
        else:
            self._of[connection.address] += 1
        if self._next_look is None:
            self._look_later()
        return True

    def leave(self, connection: Connection) -> None:
        """Forgets a connection that is closed, or about to be; any number of times."""
        if connection not in self._open:
            return
        del self._open[connection]
        if connection.crowded:
            self._crowded -= 1
            return
        self._of[connection.address] -= 1
        if not self._of[connection.address]:
            del self._of[connection.address]

    def _closes_one(self, rivals: list[Connection]) -> bool:
        """Closes the one of `rivals` that has been idle longest, first of those on which no request ever came."""
        if not rivals:
            return False
        self._tell("closed, idle longest")
        chosen = min(rivals, key=lambda each: (each.used, each.since))
        self.leave(chosen)
        chosen.give_way()
        return True

    def _tell(self, what: str) -> None:
        now = time.monotonic()
        if now - self._said >= SAID_S:
            self._said = now
            event("too many connections", logging.WARNING, what=what, open=len(self._open))

    def _look_later(self) -> None:
        self._next_look = asyncio.get_running_loop().call_later(LOOK_S, self._look)

    def _look(self) -> None:
        self._next_look = None
        if self._open:
            self._look_later()
        self._came.clear()
        now = time.monotonic()
        for connection in tuple(self._open):
            connection.look(now)


class Gate:
    """ASGI middleware. Refuses WebSockets, and all but `HEALTH` on a connection that is one too many; while the service
    drains, and on such a connection, each answer is the last one of its connection, and says so."""

    def __init__(self, app: ASGIApp, connections: Connections) -> None:
        self._app = app
        self._connections = connections

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        crowded = bool(scope.get("state", {}).get(CROWDED))

        async def sending(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start" and (crowded or self._connections.draining):
                others = [pair for pair in message["headers"] if pair[0].lower() != b"connection"]
                message["headers"] = [*others, (b"connection", b"close")]
            await send(message)

        problem: Problem | None = None
        if crowded and scope["path"] not in HEALTH:
            problem = busy(1.0, "There are too many connections, here or from your address.")
        elif _wants_websocket(Headers(scope=scope)):
            problem = Problem(
                "no-websockets",
                "Send requests of HTTP. GET /v1/jobs/{name}/events sends the progress of a job as server-sent events.",
            )
        if problem is None:
            await self._app(scope, receive, sending)
            return
        scope.get(FACTS, {})["problem"] = problem.kind
        await problem_response(problem)(scope, receive, sending)


def _wants_websocket(headers: Headers) -> bool:
    """Whether a request asks to go on as a WebSocket (RFC 6455, 4.1). Any other upgrade is ignored, as HTTP allows."""
    asked = {name.strip().lower() for line in headers.getlist("upgrade") for name in line.split(",")}
    tokens = {token.strip().lower() for line in headers.getlist("connection") for token in line.split(",")}
    return "websocket" in asked and "upgrade" in tokens
