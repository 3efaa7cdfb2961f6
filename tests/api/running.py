"""A service inside this process, behind a real socket, or as a process of its own."""

from __future__ import annotations

import re
import signal
import subprocess
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import httpx
import uvicorn
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send

from assur.api.web.app import create_app
from assur.api.web.serve import listening
from assur.api.web.settings import Settings

PATIENT = Settings(workers=1, queue=8, max_budget_s=30.0, grace_s=30.0)
"""The tests share their processors with other tests: nothing here is about how fast a plan is."""


@contextmanager
def running(settings: Settings = PATIENT, below: str = "") -> Iterator[httpx.Client]:
    """A client of a service that is ready; the service ends with the block.

    `below`: a path such as ``/cell-7``, below which a proxy that removes it has the service.
    """
    with listening("127.0.0.1", 0) as door:
        app = create_app(settings)
        served = _below(below, app) if below else app
        server = uvicorn.Server(uvicorn.Config(served, log_config=None, access_log=False, ws="none"))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [door]})
        thread.start()
        try:
            with httpx.Client(base_url=f"http://127.0.0.1:{door.getsockname()[1]}{below}", timeout=120.0) as client:
                while client.get("readyz").status_code != 200:
                    time.sleep(0.1)
                yield client
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


@contextmanager
def started(command: Sequence[str], folder: Path, environment: Mapping[str, str], log: Path) -> Iterator[str]:
    """The address of a service that is ready: the process of `command` (`assur serve` on any free port) with one
    worker, run in `folder`, which writes into `log`. It ends with the block, and well."""
    kept = {name: value for name, value in environment.items() if not name.startswith("ASSUR_")}
    settings = {**kept, "ASSUR_WORKERS": "1", "ASSUR_GRACE_S": "30"}
    with log.open("wb") as stream:
        process = subprocess.Popen([*command, "--port", "0"], cwd=folder, env=settings, stderr=stream)
    try:
        end = time.monotonic() + 120
        while '"ready": true' not in log.read_text(encoding="utf-8"):
            assert process.poll() is None, log.read_text(encoding="utf-8")
            assert time.monotonic() < end
            time.sleep(0.1)
        (port,) = re.findall(r'"event": "listening".*"port": (\d+)', log.read_text(encoding="utf-8"))
        address = f"http://127.0.0.1:{port}"
        assert httpx.get(f"{address}/readyz").status_code == 200
        yield address
        process.send_signal(signal.SIGTERM)
        assert process.wait(60) == 0
    finally:
        process.kill()
        process.wait()
