"""A service inside this process, behind a real socket."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import uvicorn

from assur.api.web.app import create_app
from assur.api.web.serve import listening
from assur.api.web.settings import Settings

PATIENT = Settings(workers=1, queue=8, max_budget_s=30.0, grace_s=30.0)
"""The tests share their processors with other tests: nothing here is about how fast a plan is."""


@contextmanager
def running(settings: Settings = PATIENT) -> Iterator[httpx.Client]:
    """A client of a service that is ready; the service ends with the block."""
    with listening("127.0.0.1", 0) as door:
        server = uvicorn.Server(uvicorn.Config(create_app(settings), log_config=None, access_log=False, ws="none"))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [door]})
        thread.start()
        try:
            with httpx.Client(base_url=f"http://127.0.0.1:{door.getsockname()[1]}", timeout=120.0) as client:
                while client.get("/readyz").status_code != 200:
                    time.sleep(0.1)
                yield client
        finally:
            server.should_exit = True
            thread.join()
