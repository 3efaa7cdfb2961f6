"""Runs the service: uvicorn with our settings, our logs, and a stop that loses nothing."""

from __future__ import annotations

import os
import signal
import socket
import time
from functools import partial
from types import FrameType
from typing import Any, cast

import uvicorn

from assur.api.logs import configure, event, one_log
from assur.api.web.app import create_app
from assur.api.web.connections import Connections, TimedProtocol
from assur.api.web.settings import Settings
from assur.planner.errors import InputError

TAKEN_AT_ONCE = 32
"""So many new connections are taken between other work of the event loop."""
WAITING = 2048
"""So many may wait to be taken; the system has a limit of its own."""


def serve(settings: Settings) -> None:
    """Serves until SIGTERM or SIGINT, then answers what has been accepted and ends by `SystemExit(0)`.

    Raises `InputError` when the address cannot be listened on.
    """
    configure(settings.log_level)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # a worker is one thread: its matrices are three by three
    signal.signal(signal.SIGTERM, _stopped)  # uvicorn repeats the signal when it has drained
    signal.signal(signal.SIGINT, _stopped)
    with listening(settings.host, settings.port) as listener, one_log():
        server = made(settings)
        event("listening", host=settings.host, port=listener.getsockname()[1])
        server.run(sockets=[listener])


def made(settings: Settings) -> Server:
    """The server with its application, not yet running."""
    app = create_app(settings)
    connections: Connections = app.state.connections
    config = uvicorn.Config(
        app,
        http=cast(Any, partial(TimedProtocol, connections)),
        loop="asyncio",
        log_config=None,
        access_log=False,
        server_header=False,
        proxy_headers=bool(settings.forwarded_from),
        forwarded_allow_ips=settings.forwarded_from,
        ws="none",
        backlog=TAKEN_AT_ONCE,
        timeout_keep_alive=cast(int, settings.keep_alive_s),
        timeout_graceful_shutdown=int(settings.stop_s) + 1,
    )
    return Server(config, connections)


class Server(uvicorn.Server):
    """uvicorn's server, which goes on for a while at a signal to stop, so that nobody sends it new requests.

    At SIGTERM or SIGINT `/readyz` begins to fail and answers close their connections. After `drain_s`, or at a second
    signal, it takes no connection any more, and ends when what it has accepted is answered.
    """

    def __init__(self, config: uvicorn.Config, connections: Connections) -> None:
        super().__init__(config)
        self._connections = connections
        self._drained_at = 0.0
        self._logged = False

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        for listener in sockets or []:
            listener.listen(WAITING)  # asyncio has one number for what waits and for what it takes at once

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        if self._connections.draining or not self._connections.settings.drain_s:
            self._connections.draining = True
            super().handle_exit(sig, frame)
            return
        self._captured_signals.append(sig)  # which `uvicorn.Server` repeats at its end
        self._connections.draining = True
        self._drained_at = time.monotonic() + self._connections.settings.drain_s

    async def on_tick(self, counter: int) -> bool:
        if self._connections.draining and not self._logged:
            self._logged = True
            event("stopping", drain_s=self._connections.settings.drain_s)  # not in the handler of a signal
        drained = self._connections.draining and time.monotonic() >= self._drained_at
        return await super().on_tick(counter) or drained


def listening(host: str, port: int) -> socket.socket:
    """A socket that listens on `host` (a name, an IPv4 or an IPv6 address) and `port`.

    It says that its protocol is TCP: asyncio switches Nagle's algorithm off only where it reads that, and with it on
    every answer on a connection that is kept waits 40 ms for an acknowledgement.

    Raises `InputError` when no address of that name is here and free.
    """
    found = []
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, proto=socket.IPPROTO_TCP)
        reason = "it has no address"
    except OSError as error:
        reason = str(error.strerror)
    for family, kind, protocol, _, address in found:
        listener = socket.socket(family, kind, protocol)
        try:
            listener.setsockopt(
                socket.SOL_SOCKET, socket.SO_REUSEADDR, 1
            )  # a restart need not wait for old connections
            listener.bind(address)
            listener.listen()
        except OSError as error:
            listener.close()
            reason = str(error.strerror)
        else:
            return listener
    raise InputError(
        "ASSUR_HOST, ASSUR_PORT", f"{host}, {port}", f"a free address ({reason}); --host and --port give another"
    )


def _stopped(_: int, __: FrameType | None) -> None:
    raise SystemExit(0)
