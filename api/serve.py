"""Runs the service: uvicorn with our settings, our logs, and a stop that loses nothing."""

from __future__ import annotations

import os
import signal
import socket
from types import FrameType

import uvicorn

from api.app import create_app
from api.logs import configure, event
from api.settings import Settings
from planner.errors import InputError


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
        proxy_headers=False,
        ws="none",
        limit_concurrency=settings.connections,
        timeout_graceful_shutdown=int(settings.drain_s) + 1,
    )
    with _listening(settings.host, settings.port) as door:
        event("listening", host=settings.host, port=door.getsockname()[1])
        uvicorn.Server(config).run(sockets=[door])


def _listening(host: str, port: int) -> socket.socket:
    """A socket that listens on `host` (a name, an IPv4 or an IPv6 address) and `port`."""
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
        return socket.create_server(address[:2], family=family)
    except OSError as error:
        raise InputError("ASSUR_HOST, ASSUR_PORT", f"{host}, {port}", f"a free address ({error.strerror})") from error


def _stopped(_: int, __: FrameType | None) -> None:
    raise SystemExit(0)
