"""The service as a process of its own, with real sockets and real signals."""

from __future__ import annotations

import asyncio
import contextlib
import copy
import os
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import httpx
import psutil
import pytest

from assur.api.web.serve import listening
from assur.api.workers.jobs import FIRST_PLAN
from assur.planner.errors import InputError
from tests.api.processes import ROOT, Server, environment, serving, until

pytestmark = pytest.mark.slow

SECRET = "the-customers-own-words"


def endless(budget_s: float) -> dict[str, Any]:
    """A request that is planned for as long as its budget lasts."""
    request = copy.deepcopy(FIRST_PLAN)
    request["options"] = {"budget_s": budget_s, "stop": "budget", "elbow": "auto"}
    return request


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    """One worker and no queue; what comes while it works is turned away."""
    with serving(WORKERS="1", QUEUE="0", BODY_S="1.5", GRACE_S="20", QUEUE_WAIT_S="120") as made:
        until(made.ready)
        yield made


@pytest.fixture
def aside() -> Iterator[ThreadPoolExecutor]:
    with ThreadPoolExecutor(4) as made:
        yield made


def post(server: Server, request: dict[str, Any]) -> httpx.Response:
    with server.client() as client:
        return client.post("/v1/plans", json=request, params={"certificate": "digest"})


def begun(server: Server, aside: ThreadPoolExecutor, request: dict[str, Any]) -> tuple[Future[httpx.Response], int]:
    """A request that a worker has begun to plan, and the worker's process."""
    (worker,) = server.workers()
    before = sum(worker.cpu_times()[:2])
    answer = aside.submit(post, server, request)
    until(lambda: sum(worker.cpu_times()[:2]) >= before + 0.2 or answer.done())
    assert not answer.done()
    return answer, worker.pid


@contextlib.contextmanager
def halted(server: Server) -> Iterator[None]:
    """The worker stands still meanwhile: what it was given is neither finished nor lost."""
    (worker,) = server.workers()
    worker.suspend()
    try:
        yield
    finally:
        worker.resume()


def one_too_many(
    server: Server, aside: ThreadPoolExecutor, places: int
) -> tuple[httpx.Response, list[Future[httpx.Response]]]:
    """Of `places + 1` requests at a time the one that is turned away, and the others, which have been accepted."""
    asked = [aside.submit(post, server, FIRST_PLAN) for _ in range(places + 1)]
    until(lambda: any(answer.done() for answer in asked))
    (refused,) = (answer for answer in asked if answer.done())
    return refused.result(), [answer for answer in asked if answer is not refused]


def served(server: Server) -> None:
    """The next request is planned."""
    answer = post(server, FIRST_PLAN)
    assert answer.status_code == 200, answer.text
    assert answer.json()["status"] == "planned"


def test_a_plan_whose_worker_is_killed_is_planned_by_another(server: Server, aside: ThreadPoolExecutor) -> None:
    answer, pid = begun(server, aside, endless(5.0))
    os.kill(pid, signal.SIGKILL)
    assert answer.result().json()["status"] == "planned"
    (told,) = server.events("worker died")
    assert "SIGKILL" in told["how"]
    assert not server.events("request quarantined")
    served(server)
    assert pid not in [worker.pid for worker in server.workers()]


def test_a_client_that_leaves_in_the_middle_of_its_body_is_no_fault(server: Server) -> None:
    faults = len(server.events("a request met a fault"))
    with socket.create_connection(("127.0.0.1", server.port)) as connection:
        connection.sendall(
            b"POST /v1/plans HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\nContent-Length: 9000\r\n\r\n{"
        )
    until(lambda: any(line.get("status") == 499 for line in server.events("request")))
    assert len(server.events("a request met a fault")) == faults


def test_nothing_that_a_caller_sends_is_logged(server: Server) -> None:
    with server.client() as client:
        client.get(f"/{SECRET}")
        client.get(f"/v1/scenes/{SECRET}")
        client.post(f"/v1/plans?{SECRET}=1", json={SECRET: SECRET}, headers={"X-Request-Id": SECRET, "Cookie": SECRET})
        client.post("/v1/plans", json={**FIRST_PLAN, SECRET: SECRET})
        client.post("/v1/plans/check", json={"request": {SECRET: 1}, "plan": SECRET})
    with socket.create_connection(("127.0.0.1", server.port)) as connection:
        connection.sendall(f"{SECRET}\r\n\r\n".encode())
        connection.recv(100)
    served(server)
    assert len(server.events("request")) >= 6
    assert SECRET.encode() not in b"".join(server.raw)
    assert len(server.raw) == len(server.log), "a line that is not JSON"


def test_the_service_is_not_ready_before_its_workers_have_planned_and_then_it_is() -> None:
    with serving(WORKERS="2") as server:
        with server.client() as client:
            early = client.get("/readyz")
            assert early.status_code == 503
            assert early.json()["type"] == "urn:assur:problem:not-ready"
            assert client.get("/livez").status_code == 200
        until(server.ready)
        assert len(server.events("worker ready")) == 2
        assert [line["ready"] for line in server.events("worker ready")] == [False, True]


def test_on_sigterm_what_was_accepted_is_answered_and_no_process_is_left(aside: ThreadPoolExecutor) -> None:
    with serving(WORKERS="1", QUEUE="1", GRACE_S="50") as server:
        until(server.ready)
        port = server.port
        (worker,) = server.workers()
        with halted(server):
            refused, accepted = one_too_many(server, aside, places=2)
            assert refused.status_code == 503
            server.process.send_signal(signal.SIGTERM)
            until(lambda: not _open(port))
            assert not any(answer.done() for answer in accepted)
        for answer in accepted:
            assert answer.result().json()["status"] == "planned"
        assert server.process.wait(60) == 0
        until(lambda: not worker.is_running())


def _open(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


def test_a_service_killed_without_warning_leaves_no_worker_behind() -> None:
    with serving(WORKERS="1") as server:
        until(server.ready)
        (worker,) = server.workers()
        server.process.kill()
        server.process.wait()
        until(lambda: not worker.is_running() or worker.status() == psutil.STATUS_ZOMBIE)


def started(port: str, **settings: str) -> subprocess.CompletedProcess[str]:
    """A service that is expected to end by itself."""
    command = [sys.executable, "-m", "assur.api.command_line", "serve", "--port", port]
    given = environment(**settings)
    return subprocess.run(command, cwd=ROOT, env=given, capture_output=True, text=True, timeout=60, check=False)


@pytest.mark.parametrize(("name", "value"), [("PORT", "http"), ("WORKER", "2"), ("MAX_BUDGET_S", "nan")])
def test_a_service_with_a_wrong_setting_does_not_start_and_says_which(name: str, value: str) -> None:
    run = started("0", **{name: value})
    assert run.returncode == 2
    assert run.stderr.startswith(f"assur: ASSUR_{name}: got ")
    assert run.stderr.count("\n") == 1


def test_a_port_that_is_taken_is_bad_input() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        run = started(port)
    assert run.returncode == 2
    assert "Traceback" not in run.stderr


def test_answers_on_a_kept_connection_do_not_wait_for_acknowledgements() -> None:
    async def nodelay() -> int:
        with listening("127.0.0.1", 0) as door:
            seen: asyncio.Future[int] = asyncio.get_running_loop().create_future()

            async def accepted(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
                connection = writer.get_extra_info("socket")
                seen.set_result(connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))
                writer.close()

            async with await asyncio.start_server(accepted, sock=door):
                _, writer = await asyncio.open_connection(*door.getsockname())
                value = await seen
                writer.close()
                return value

    assert asyncio.run(nodelay()) == 1


@pytest.mark.parametrize("host", ["127.0.0.1", "localhost", "0.0.0.0"])
def test_the_service_listens_on_addresses_and_on_names(host: str) -> None:
    with listening(host, 0) as door:
        assert door.getsockname()[1] > 0


def test_an_address_that_is_not_of_this_machine_is_bad_input() -> None:
    with pytest.raises(InputError, match="ASSUR_HOST"):
        listening("203.0.113.1", 0)


@pytest.mark.parametrize(("trusted", "client"), [("127.0.0.0/8", "192.0.2.7"), ("", "127.0.0.1")])
def test_who_asks_is_told_by_a_proxy_that_is_known_and_by_nobody_else(trusted: str, client: str) -> None:
    with serving(WORKERS="1", FORWARDED_FROM=trusted) as server:
        with server.client() as asking:
            asking.get("/v1/scenes", headers={"X-Forwarded-For": "198.51.100.1, 192.0.2.7"})
        until(lambda: bool(server.events("request")))
        assert [line["client"] for line in server.events("request")] == [client]
