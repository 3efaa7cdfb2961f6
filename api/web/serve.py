"""Runs the service: uvicorn with our settings, our logs, and a stop that loses nothing."""

from __future__ import annotations

import os
import signal
import socket
from types import FrameType

import uvicorn

from assur.api.logs import configure, event, one_log
from assur.api.web.app import create_app
from assur.api.web.settings import Settings
from assur.planner.errors import InputError


def serve(settings: Settings) -> None:
    """Serves until SIGTERM or SIGINT, then answers what has been accepted and ends by `SystemExit(0)`.

    Raises `InputError` when the address cannot be listened on.
    """
    configure(settings.log_level)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # a worker is one thread: its matrices are three by three
    signal.signal(signal.SIGTERM, _stopped)  # uvicorn repeats the signal when it has drained
    signal.signal(signal.SIGINT, _stopped)
    config = uvicorn.Config(
        create_app(settings),
        log_config=None,
        access_log=False,
        server_header=False,
        proxy_headers=bool(settings.forwarded_from),
        forwarded_allow_ips=settings.forwarded_from,
        ws="none",
        limit_concurrency=settings.connections,
        timeout_graceful_shutdown=int(settings.drain_s) + 1,
    )
    with listening(settings.host, settings.port) as door, one_log():
        event("listening", host=settings.host, port=door.getsockname()[1])
        uvicorn.Server(config).run(sockets=[door])


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
        door = socket.socket(family, kind, protocol)
        try:
            door.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)  # a restart need not wait for old connections
            door.bind(address)
            door.listen()
        except OSError as error:
            door.close()
            reason = str(error.strerror)
        else:
            return door
    raise InputError("ASSUR_HOST, ASSUR_PORT", f"{host}, {port}", f"a free address ({reason})")


def _stopped(_: int, __: FrameType | None) -> None:
    raise SystemExit(0)
