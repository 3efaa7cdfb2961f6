"""A service inside this process, behind a real socket."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import cast

import httpx
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from assur.api.web.serve import Server, listening, made
from assur.api.web.settings import Settings

PATIENT = Settings(workers=1, queue=8, max_budget_s=30.0, grace_s=30.0)
"""The tests share their processors with other tests: nothing here is about how fast a plan is."""


@contextmanager
def running(settings: Settings = PATIENT, below: str = "") -> Iterator[httpx.Client]:
    """A client of a service that is ready; the service ends with the block.

    `below`: a path such as ``/cell-7``, below which a proxy that removes it has the service.
    """
    with (
        in_a_thread(settings, below) as (_, port),
        httpx.Client(base_url=f"http://127.0.0.1:{port}{below}", timeout=120.0) as client,
    ):
        while client.get("readyz").status_code != 200:
            time.sleep(0.1)
        yield client


@contextmanager
def in_a_thread(settings: Settings, below: str = "") -> Iterator[tuple[Server, int]]:
    """A server that runs in a thread of its own, and its port; its workers may not have planned yet."""
    with listening("127.0.0.1", 0) as listener:
        server = made(settings)
        if below:
            server.config.app = _below(below, cast(ASGIApp, server.config.app))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        try:
            yield server, listener.getsockname()[1]
        finally:
            server.should_exit = True
            thread.join()


def _below(path: str, app: ASGIApp) -> ASGIApp:
    """What a proxy does that has a service below a path: it removes the path, and nothing else is there."""

    async def proxy(scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "http":
            inner = scope["path"].removeprefix(path)
            if inner == scope["path"]:
                await PlainTextResponse("nothing here", 502)(scope, receive, send)
                return
            scope = {**scope, "path": inner, "raw_path": inner.encode()}
        await app(scope, receive, send)

    return proxy
