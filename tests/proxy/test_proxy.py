"""The shipped proxy in front of two services: what it keeps away from them, and what it passes on."""

from __future__ import annotations

import contextlib
import http.server
import json
import socket
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest

from assur.api.web.settings import CHECK_BODY_BYTES, PLAN_BODY_BYTES
from assur.api.workers.jobs import FIRST_PLAN
from tests.api.processes import Server, until
from tests.proxy.conftest import ATTACKER, SHIPPED, Pair, answered, on_this_machine, program, proxied, sending

pytestmark = pytest.mark.timeout(600)  # two services start before the first test
POST = b"POST /v1/plans HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\nContent-Length: 1000\r\n\r\n"
IDENTITY = "0123456789abcdef"
STREAMS, STREAMS_OF_A_REPLICA = 16, 64
ENDLESS = {**FIRST_PLAN, "options": {"budget_s": 55.0, "stop": "budget", "elbow": "auto"}}


def checked(text: str, folder: Path) -> subprocess.CompletedProcess[str]:
    file = folder / "checked.cfg"
    file.write_text(text, encoding="utf-8")
    return subprocess.run([program(), "-c", "-f", str(file)], capture_output=True, text=True, check=False)


def test_the_shipped_file_is_valid_and_a_spoilt_one_is_not(tmp_path: Path) -> None:
    text = SHIPPED.read_text(encoding="utf-8")
    assert checked(text, tmp_path).returncode == 0
    # names of replicas are found where there are some; nothing else is warned of
    run = checked(on_this_machine(text, 8080, {"a": 8001, "b": 8002}), tmp_path)
    assert (run.returncode, "WARNING" in run.stderr + run.stdout) == (0, False), run.stderr
    assert checked(text.replace("timeout http-request 5s", "timeout http-request 5 potatoes"), tmp_path).returncode != 0


def seen(*servers: Server) -> int:
    """How many requests of bodies the services have seen."""
    return sum(line.get("route") == "/v1/plans" for server in servers for line in server.events("request"))


def served(pair: Pair) -> None:
    """Others are alive and plan. The line of a request is written after its answer: it is waited for."""
    before = seen(pair.a, pair.b)
    assert pair.client.get("/livez").status_code == 200
    answer = pair.client.post("/v1/plans", json=FIRST_PLAN, params={"certificate": "digest"})
    assert answer.json()["status"] == "planned"
    until(lambda: seen(pair.a, pair.b) > before)


@pytest.mark.slow
def test_slow_headers_and_slow_bodies_never_reach_a_service_and_are_nobodys_trouble(pair: Pair) -> None:
    before = seen(pair.a, pair.b)
    slow = [sending(pair.port, POST + b"{", ATTACKER) for _ in range(64)]
    slow += [sending(pair.port, b"GET /livez HTTP/1.1\r\nHost: x\r\nX-Slow: ", ATTACKER) for _ in range(16)]
    served(pair)
    for connection in slow:
        with contextlib.suppress(OSError):
            connection.sendall(b" ")
    heads = [answered(connection).split(b"\r\n")[0] for connection in slow]
    for connection in slow:
        connection.close()
    assert [head.split()[1] for head in heads] == [b"408"] * 80
    served(pair)
    assert seen(pair.a, pair.b) == before + 2


@pytest.mark.slow
def test_idle_connections_of_one_address_are_bounded_and_closed(pair: Pair) -> None:
    with contextlib.ExitStack() as stack:
        idle = []
        for _ in range(512):
            with contextlib.suppress(ConnectionResetError):  # refused before this side was done with connecting
                idle.append(stack.enter_context(sending(pair.port, b"", ATTACKER)))
        assert len(idle) >= 128
        served(pair)
        assert {answered(connection) for connection in idle} == {b""}
    served(pair)


def test_large_bodies_are_refused_by_their_length_and_those_of_checks_pass(pair: Pair) -> None:
    before = seen(pair.a, pair.b)
    answer = pair.client.post("/v1/plans", content=b" " * (PLAN_BODY_BYTES + 1))
    assert (answer.status_code, answer.json()["type"]) == (413, "urn:assur:problem:too-large")
    answer = pair.client.post("/v1/plans/check", content=b" " * (CHECK_BODY_BYTES + 1))
    assert (answer.status_code, answer.json()["status"]) == (413, 413)
    assert seen(pair.a, pair.b) == before
    typed = {"Content-Type": "application/json"}
    answer = pair.client.post("/v1/plans/check", content=b" " * CHECK_BODY_BYTES, headers=typed)
    assert (answer.status_code, answer.json()["type"]) == (400, "urn:assur:problem:bad-syntax")
    answer = pair.client.post("/v1/plans", content=b" " * PLAN_BODY_BYTES, headers=typed)
    assert (answer.status_code, answer.json()["type"]) == (400, "urn:assur:problem:bad-syntax")


def test_jobs_are_found_in_their_replica_and_their_events_come_as_they_happen(pair: Pair) -> None:
    jobs = [pair.client.post("/v1/jobs", json=ENDLESS).json()["id"] for _ in range(4)]
    assert {job.partition("-")[0] for job in jobs} == {"a", "b"}
    for job in jobs:
        assert pair.client.get(f"/v1/jobs/{job}").json()["state"] == "working"
    first = jobs[0]
    with pair.client.stream("GET", f"/v1/jobs/{first}/events") as stream:
        lines = stream.iter_lines()
        assert next(lines) == "event: working"
        assert "content-encoding" not in stream.headers
        # the stream goes on, so nothing between has waited for its end
        assert pair.client.get(f"/v1/jobs/{first}").json()["state"] == "working"
        for job in jobs:
            assert pair.client.delete(f"/v1/jobs/{job}").json()["state"] == "cancelled"
        assert "event: cancelled" in list(lines)
    lost = pair.client.get("/v1/jobs/a-0123456789")
    assert (lost.status_code, lost.json()["type"]) == (404, "urn:assur:problem:job-lost")


@pytest.mark.slow
def test_streams_of_events_are_bounded_for_each_client_and_keep_nobody_from_jobs(pair: Pair) -> None:
    job = pair.client.post("/v1/jobs", json=ENDLESS).json()["id"]
    asking = f"GET /v1/jobs/{job}/events HTTP/1.1\r\nHost: x\r\n\r\n".encode()
    with contextlib.ExitStack() as stack:
        clients = [f"127.0.0.{number}" for number in range(3, 7)]
        streams = [
            stack.enter_context(sending(pair.port, asking, client)) for client in clients for _ in range(STREAMS)
        ]
        begun = [stream.recv(12) for stream in streams]
        assert set(begun) == {b"HTTP/1.1 200"}
        one_more = stack.enter_context(sending(pair.port, asking, clients[0]))
        assert one_more.recv(12) == b"HTTP/1.1 429"
        # all places for streams of this replica are taken: jobs and plans have places of their own
        assert len(streams) == STREAMS_OF_A_REPLICA
        assert pair.client.get(f"/v1/jobs/{job}", timeout=20.0).json()["state"] == "working"
        assert {pair.client.get("/v1/robots", timeout=20.0).status_code for _ in range(4)} == {200}
        assert pair.client.delete(f"/v1/jobs/{job}", timeout=20.0).json()["state"] == "cancelled"


@contextlib.contextmanager
def recorder() -> Iterator[tuple[int, list[tuple[str, dict[str, str]]]]]:
    """A server that is ready and says 200 to everything: its port, and the paths and headers it was sent."""
    found: list[tuple[str, dict[str, str]]] = []

    class Recording(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            if self.path not in {"/readyz", "/livez"}:
                found.append((self.path, {name.lower(): value for name, value in self.headers.items()}))
            self.send_response(200)
            self.send_header("Content-Length", "0")
            self.send_header("X-Request-Id", IDENTITY)
            self.end_headers()

        def log_message(self, *_: object) -> None:
            """Says nothing."""

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Recording)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield int(server.server_address[1]), found
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


@pytest.mark.slow
def test_what_a_caller_says_of_itself_is_not_passed_on_and_metrics_are_not_told(tmp_path: Path) -> None:
    with recorder() as (port, found), proxied(tmp_path, {"a": port, "b": port}) as proxy:
        said = {"X-Forwarded-For": "8.8.8.8", "Forwarded": "for=8.8.8.8", "X-Real-IP": "8.8.8.8",
                "X-Forwarded-Host": "evil", "X-Forwarded-Proto": "https"}  # fmt: skip
        assert httpx.get(f"http://127.0.0.1:{proxy}/v1/robots", headers=said).status_code == 200
        for path in ("/metrics", "/metrics/", "//metrics", "/%6Detrics", "/metrics?a=1"):
            request = f"GET {path} HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n"
            with sending(proxy, request.encode()) as connection:
                assert b"urn:assur:problem:not-found" in answered(connection), path
        assert httpx.get(f"http://127.0.0.1:{proxy}/v1/metrics").status_code == 200
    # each line of the log is JSON, has the id under which the service has logged the request, and nothing of the caller
    log = (tmp_path / "haproxy.log").read_text(encoding="utf-8")
    lines = [json.loads(line) for line in log.splitlines() if '"proxied"' in line]
    assert [line["request"] for line in lines if line["status"] == 200] == [IDENTITY] * 2
    assert not any(word in log for word in ("8.8.8.8", "evil", "/v1/", "metrics"))
    (_, headers), (other, _) = found
    assert other == "/v1/metrics"
    assert (headers["x-forwarded-for"], headers["x-forwarded-proto"]) == ("127.0.0.1", "http")
    assert "8.8.8.8" not in headers.values()
    assert not {"forwarded", "x-real-ip", "x-forwarded-host"} & set(headers)


@pytest.mark.slow
def test_without_a_replica_the_answer_is_a_problem(tmp_path: Path) -> None:
    with socket.socket() as nobody:
        nobody.bind(("127.0.0.1", 0))
        closed = int(nobody.getsockname()[1])
        with proxied(tmp_path, {"a": closed, "b": closed}) as port:
            for path, status, kind in (("/v1/robots", 503, "not-ready"), ("/v1/jobs/b-17", 404, "job-lost")):
                where = f"http://127.0.0.1:{port}{path}"
                # before the checks have failed twice, a job is not known to be lost
                until(lambda where=where, status=status: httpx.get(where).status_code == status)  # type: ignore[misc]
                answer = httpx.get(where, timeout=60.0)
                assert (answer.headers.get("retry-after") == "5") == (status == 503)
                assert (answer.status_code, answer.json()["status"]) == (status, status)
                assert answer.json()["type"] == f"urn:assur:problem:{kind}"
                assert answer.headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize("name", ["a", "b"])
def test_every_answer_that_the_proxy_makes_is_json(name: str) -> None:
    texts = [line.split("string '")[1].split("'")[0] for line in SHIPPED.read_text().splitlines() if "string '" in line]
    assert len(texts) >= 10
    for text in texts:
        assert {"type", "title", "status", "detail"} == set(json.loads(text))
    assert f"use_backend job_{name} if {{ path_beg /v1/jobs/{name}- }}" in SHIPPED.read_text()
