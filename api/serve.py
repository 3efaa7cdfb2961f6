"""Runs the service: uvicorn with our settings, our logs, and a stop that loses nothing."""

from __future__ import annotations

import os
import signal
from types import FrameType

import uvicorn

from api.app import create_app
from api.logs import configure
from api.settings import Settings


def serve(settings: Settings) -> None:
    """Serves until SIGTERM or SIGINT, then answers what has been accepted and returns by `SystemExit(0)`."""
    configure(settings.log_level)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # a worker is one thread: its matrices are three by three
    signal.signal(signal.SIGTERM, _stopped)  # uvicorn repeats the signal when it has drained
    signal.signal(signal.SIGINT, _stopped)
    uvicorn.run(
        create_app(settings),
        host=settings.host,
        port=settings.port,
        log_config=None,
        access_log=False,
        server_header=False,
        proxy_headers=False,
        ws="none",
        limit_concurrency=settings.connections,
        timeout_graceful_shutdown=int(settings.drain_s) + 1,
    )


def _stopped(_: int, __: FrameType | None) -> None:
    raise SystemExit(0)
