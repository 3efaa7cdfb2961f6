"""Replicas behind the shipped proxy are restarted, one after the other, under load: no request is lost."""

from __future__ import annotations

import contextlib
import signal
import threading
from collections import Counter
from pathlib import Path

import httpx
import pytest

from assur.api.workers.jobs import FIRST_PLAN
from tests.api.processes import Server, until
from tests.proxy.conftest import proxied, replica

pytestmark = [pytest.mark.slow, pytest.mark.timeout(900)]  # four services start, one after the other


class Load:
    """Clients that plan without a pause, half of them on a new connection each time, and the statuses that they get."""

    def __init__(self, address: str, clients: int) -> None:
        self.statuses: Counter[int | str] = Counter()
        self._ended = threading.Event()
        self._threads = [threading.Thread(target=self._ask, args=(address, n % 2 == 0)) for n in range(clients)]

    def __enter__(self) -> Load:
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._ended.set()
        for thread in self._threads:
            thread.join()

    def more(self, than: int) -> bool:
        return self.statuses.total() > than

    def _ask(self, address: str, kept: bool) -> None:
        headers = {} if kept else {"Connection": "close"}
        with httpx.Client(base_url=address, timeout=120.0, headers=headers) as client:
            while not self._ended.is_set():
                try:
                    answer = client.post("/v1/plans", json=FIRST_PLAN, params={"certificate": "digest"})
                    self.statuses[answer.status_code] += 1
                except httpx.HTTPError as error:
                    self.statuses[type(error).__name__] += 1


def ended(server: Server) -> None:
    server.process.send_signal(signal.SIGTERM)
    until(lambda: server.process.poll() is not None, within_s=100.0)
    assert server.process.returncode == 0


def test_no_request_is_lost_when_replicas_restart_under_load_and_lost_jobs_are_told(tmp_path: Path) -> None:
    with contextlib.ExitStack() as stack:
        a, b = stack.enter_context(replica("a")), stack.enter_context(replica("b"))
        ports = {"a": a.port, "b": b.port}
        port = stack.enter_context(proxied(tmp_path, ports))
        client = stack.enter_context(httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=120.0))
        until(lambda: client.get("/readyz").status_code == 200)
        with Load(f"http://127.0.0.1:{port}", 4) as load:
            jobs = [client.post("/v1/jobs", json=FIRST_PLAN).json()["id"] for _ in range(6)]
            (of_a, *_), (of_b, *_) = (sorted(job for job in jobs if job.startswith(name)) for name in ("a-", "b-"))
            for name, server in (("a", a), ("b", b)):
                asked = load.statuses.total()
                ended(server)
                stack.enter_context(replica(name, ports[name]))
                until(lambda asked=asked: load.more(asked + 20))  # type: ignore[misc]
                if name == "a":
                    assert client.get(f"/v1/jobs/{of_b}").status_code == 200
                lost = client.get(f"/v1/jobs/{of_a}")
                assert (lost.status_code, lost.json()["type"]) == (404, "urn:assur:problem:job-lost")
        assert set(load.statuses) == {200}, load.statuses
        assert load.statuses[200] > 40
