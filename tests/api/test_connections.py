"""What clients may delay has a time, and too many connections stop nobody: real sockets, a server in this process."""

from __future__ import annotations

import asyncio
import contextlib
import json
import re
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace

import pytest
from starlette.requests import Request

from assur.api.problems import Problem
from assur.api.web import body_reader
from assur.api.web.addresses import network
from assur.api.web.body_reader import Reading
from assur.api.web.connections import CHUNK_BYTES, FIRST_CHUNKS, LEAVES
from assur.api.web.request_log import CLIENT_GONE
from assur.api.web.routes import unless_gone
from assur.api.web.serve import Server
from assur.api.web.settings import Settings
from assur.api.workers.jobs import FIRST_PLAN, Answer
from tests.api.processes import until
from tests.api.running import in_a_thread

SHORT = Settings(workers=1, connections=40, header_s=1.5, keep_alive_s=2.0, body_s=30.0)
"""Times short enough to wait for. No test needs a worker, so none waits for one."""
LIVE = b"GET /livez HTTP/1.1\r\nHost: x\r\n\r\n"
LARGE = b"GET /openapi.json HTTP/1.1\r\nHost: x\r\n\r\n"
JSON = [(b"content-type", b"application/json")]
CHUNKED = b"POST /v1/jobs HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\nTransfer-Encoding: chunked\r\n\r\n"
SLOW = b"POST /v1/plans HTTP/1.1\r\nHost: x\r\nContent-Type: application/json\r\nContent-Length: 1000\r\n\r\n"

ANSWER = re.compile(rb"HTTP/1.1 \d+ .*?\r\ncontent-length: \d+\r\n.*?\r\n\r\n.", re.DOTALL)
"""An answer has come: its head, and some of its body, which is written behind it in one piece."""


class Running:
    """A server that runs in a thread of its own."""

    def __init__(self, server: Server, port: int) -> None:
        self.server, self.port = server, port

    def connect(self, data: bytes = b"", address: str = "127.0.0.1") -> socket.socket:
        connection = socket.create_connection(("127.0.0.1", self.port), timeout=30.0, source_address=(address, 0))
        connection.sendall(data)
        return connection

    @property
    def at_work(self) -> int:
        """Connections on which a request is read or answered."""
        return sum(not each.idle for each in list(self.server._connections.open))

    def status(self, data: bytes = LIVE, address: str = "127.0.0.1") -> int:
        with self.connect(data, address) as connection:
            return status(connection)


@contextmanager
def run(settings: Settings) -> Iterator[Running]:
    with in_a_thread(settings) as (server, port):
        yield Running(server, port)


@pytest.fixture(scope="module")
def running() -> Iterator[Running]:
    with run(SHORT) as made_:
        yield made_


def status(connection: socket.socket) -> int:
    """The status of the answer that comes on a connection; 0: it is closed without one."""
    found = b""
    with contextlib.suppress(ConnectionResetError):
        while not ANSWER.match(found) and (part := connection.recv(4096)):
            found += part
    return int(found.split()[1]) if found else 0


def rest(connection: socket.socket) -> bytes:
    """All that comes until it is closed."""
    found = b""
    with contextlib.suppress(ConnectionResetError):
        while part := connection.recv(65536):
            found += part
    return found


def test_a_connection_on_which_nothing_comes_is_closed(running: Running) -> None:
    with running.connect() as connection:
        assert rest(connection) == b""


def test_headers_that_trickle_end_with_their_connection_however_steadily_they_come(running: Running) -> None:
    with running.connect(b"GET /livez HTTP/1.1\r\nX: ") as connection:
        connection.settimeout(0.05)
        found = None
        for _ in range(600):
            with contextlib.suppress(TimeoutError):
                found = rest(connection)
                break
            with contextlib.suppress(OSError):
                connection.sendall(b"x")
    assert found == b""


def test_a_body_that_goes_on_after_its_answer_has_a_time() -> None:
    refused = SLOW.replace(b"application/json", b"text/plain")
    with run(replace(SHORT, body_s=1.0)) as running, running.connect(refused) as connection:
        assert status(connection) == 415
        connection.settimeout(0.05)
        found = None
        for _ in range(600):
            with contextlib.suppress(OSError):
                connection.sendall(b"x")
            with contextlib.suppress(TimeoutError):
                found = rest(connection)
                break
        assert found is not None


def test_a_body_that_ends_after_its_answer_leaves_the_connection_open() -> None:
    refused = SLOW.replace(b"application/json", b"text/plain").replace(b"1000", b"2")
    quick = replace(SHORT, body_s=0.5, header_s=0.5, keep_alive_s=30.0)
    with run(quick) as running, running.connect(refused) as connection:
        assert status(connection) == 415
        connection.sendall(b"{")
        time.sleep(0.1)
        connection.sendall(b"}")
        time.sleep(1.0)
        connection.sendall(LIVE)
        assert status(connection) == 200


@pytest.mark.parametrize("begun", [b"", b"GET /livez HT"], ids=["idle", "with half a request"])
def test_a_kept_connection_has_a_time_too(running: Running, begun: bytes) -> None:
    with running.connect(LIVE) as connection:
        assert status(connection) == 200
        connection.sendall(LIVE)
        assert status(connection) == 200
        connection.sendall(begun)
        assert rest(connection) == b""


def test_half_a_request_behind_a_whole_one_has_a_time_too(running: Running) -> None:
    with running.connect(LIVE + b"GET /livez HT") as connection:
        statuses = [part.split()[0] for part in rest(connection).split(b"HTTP/1.1 ")[1:]]
    assert statuses == [b"200"]


def in_chunks(size: int, count: int) -> bytes:
    return CHUNKED + (b"%x\r\n" % size + b"x" * size + b"\r\n") * count + b"0\r\n\r\n"


@pytest.mark.parametrize(("size", "count"), [(1, 100_000), (1, 130), (CHUNK_BYTES - 100, 1000)])
def test_a_body_in_many_small_chunks_is_refused_before_it_is_parsed(running: Running, size: int, count: int) -> None:
    with running.connect() as connection:
        sent(connection, in_chunks(size, count))
        found = rest(connection)
    # while more comes, the answer may be lost; it is one of uvicorn, and not of the service, which knows no such body
    assert found.startswith(b"HTTP/1.1 400") or (found == b"" and count > 130)
    assert b"urn:assur" not in found


@pytest.mark.parametrize(("size", "count"), [(1, FIRST_CHUNKS), (CHUNK_BYTES, 500), (200_000, 2)])
def test_a_body_in_few_or_in_large_chunks_is_read(running: Running, size: int, count: int) -> None:
    last = LIVE.replace(b"Host: x", b"Host: x\r\nConnection: close")
    with running.connect(in_chunks(size, count) + last) as connection:
        found = rest(connection)
    assert [part[:3] for part in found.split(b"HTTP/1.1 ")[1:]] == [b"400", b"200"]
    assert b"urn:assur" in found


def test_health_is_answered_while_bodies_come_in_small_chunks(running: Running) -> None:
    with ExitStack() as stack:
        small = [stack.enter_context(running.connect()) for _ in range(8)]
        senders = [threading.Thread(target=sent, args=(each, in_chunks(1, 1_000_000))) for each in small]
        for sender in senders:
            sender.start()
        assert running.status() == 200
        for sender in senders:
            sender.join()


def sent(connection: socket.socket, data: bytes) -> None:
    """Sends as much as is taken."""
    with contextlib.suppress(OSError):
        connection.sendall(data)


def test_a_client_that_finishes_in_the_middle_of_its_body_is_gone(running: Running) -> None:
    with running.connect(SLOW + b"{") as connection:
        connection.shutdown(socket.SHUT_WR)
        assert rest(connection) == b""


@pytest.mark.anyio
@pytest.mark.parametrize("before", [True, False])
async def test_work_ends_when_its_client_leaves_or_has_left_before(before: bool) -> None:
    async def endless() -> Answer:
        await asyncio.Event().wait()
        raise AssertionError

    request = Request({"type": "http", **({LEAVES: None} if before else {})})
    task = asyncio.create_task(unless_gone(request, endless()))
    await asyncio.sleep(0)
    if not before:
        request.scope[LEAVES]()
    assert (await asyncio.wait_for(task, 30.0)).status_code == CLIENT_GONE


@pytest.mark.anyio
async def test_work_that_the_service_ends_is_not_taken_for_that_of_a_client_that_leaves() -> None:
    request = Request({"type": "http"})
    task = asyncio.create_task(unless_gone(request, asyncio.Event().wait()))  # type: ignore[arg-type]
    await asyncio.sleep(0)
    task.cancel()
    with pytest.raises(asyncio.CancelledError):
        await task
    assert LEAVES not in request.scope


@pytest.mark.slow
def test_a_client_that_takes_its_answer_slowly_gets_all_of_it(running: Running) -> None:
    with socket.socket() as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 65536)
        connection.settimeout(60.0)
        connection.connect(("127.0.0.1", running.port))
        connection.sendall(LARGE * 100)
        began, found = time.monotonic(), b""
        while time.monotonic() - began < 3.0:
            found += connection.recv(65536)  # much less than would be sent
            time.sleep(0.02)
        while found.count(b"HTTP/1.1 200") < 100 or not found.endswith(b"}"):
            found += connection.recv(65536)
    assert found.count(b"HTTP/1.1 200") == 100
    assert found.endswith(b"}")


def test_an_answer_that_is_not_taken_gives_way_to_a_new_connection() -> None:
    with run(replace(SHORT, connections=4)) as running, ExitStack() as unread:
        for _ in range(4):
            connection = unread.enter_context(socket.socket())
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            connection.connect(("127.0.0.1", running.port))
            connection.setblocking(False)
            with contextlib.suppress(BlockingIOError):
                connection.send(LARGE * 200)
        until(lambda: running.at_work == 4)
        until(lambda: all(each.waiting for each in list(running.server._connections.open)))
        # a connection whose client took a part of its answer just now does not wait at that moment
        until(lambda: running.status(LIVE.replace(b"/livez", b"/v1/robots")) == 200)


def test_beyond_the_limit_those_are_closed_first_on_which_nothing_ever_came(running: Running) -> None:
    with ExitStack() as stack:
        kept = stack.enter_context(running.connect(LIVE))
        assert status(kept) == 200
        idle = [stack.enter_context(running.connect()) for _ in range(SHORT.connections + 5)]
        assert running.status() == 200
        kept.sendall(LIVE)
        assert status(kept) == 200
        assert rest(idle[0]) == b""


def test_bodies_that_are_not_complete_give_way_to_new_connections(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(body_reader, "FIRST_S", 100.0)  # nothing ends by itself
    with run(replace(SHORT, connections=8, body_s=100.0, queue=1000)) as running, ExitStack() as slow:
        first = slow.enter_context(running.connect(SLOW))
        until(lambda: running.at_work == 1)
        for _ in range(7):
            slow.enter_context(running.connect(SLOW))
        until(lambda: running.at_work == 8)
        assert running.status() == 200
        assert rest(first) == b""


def test_where_no_connection_waits_for_its_client_the_new_one_is_closed() -> None:
    endless = json.dumps({**FIRST_PLAN, "options": {"budget_s": 30.0, "stop": "budget"}}).encode()
    head = SLOW.replace(b"1000", str(len(endless)).encode())
    with run(replace(SHORT, connections=2, max_budget_s=30.0)) as running, ExitStack() as stack:
        working = [stack.enter_context(running.connect(head + endless)) for _ in range(2)]
        until(lambda: running.at_work == 2)
        until(lambda: not any(each.waiting for each in list(running.server._connections.open)))
        assert running.status() == 0
        assert running.at_work == 2
        working[0].close()
        until(lambda: running.status() == 200)


@pytest.mark.parametrize("count", [512, 1000])
def test_idle_connections_do_not_stop_anybody(running: Running, count: int) -> None:
    with ExitStack() as idle:
        for number in range(count):
            idle.enter_context(running.connect(address=f"127.0.0.{2 + number % 4}"))
        for _ in range(20):
            assert running.status() == 200
        assert len(running.server._connections.open) <= SHORT.connections


def test_a_body_that_comes_too_slowly_is_given_up_before_its_time(running: Running) -> None:
    with running.connect(SLOW + b"{") as connection:
        assert status(connection) == 408  # `body_s` is as long as the socket waits


def test_a_body_has_a_time_however_steadily_it_comes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(body_reader, "FIRST_S", 100.0)  # its rate does not count

    async def coming() -> dict[str, object]:
        await asyncio.sleep(0.02)
        return {"type": "http.request", "body": b"1", "more_body": True}

    request = Request({"type": "http", "method": "POST", "headers": JSON, "client": ("::1", 1)}, coming)
    with pytest.raises(Problem, match="not complete"):
        asyncio.run(body_reader.read_body(request, 100, 0.2, Reading()))


def test_bodies_of_one_address_leave_room_for_others() -> None:
    reading = Reading(in_all=100, of_one=50)
    reading.take("a", 50)
    with pytest.raises(Problem, match="busy"):
        reading.take("a", 1)
    reading.take("b", 50)
    with pytest.raises(Problem, match="busy"):
        reading.take("c", 1)
    reading.give_back("a", 50)
    reading.take("c", 50)


def test_bodies_of_one_network_are_counted_together() -> None:
    reading = Reading(in_all=100, of_one=50)
    reading.take(network("2001:db8::2"), 50)

    async def coming() -> dict[str, object]:
        return {"type": "http.request", "body": b"1", "more_body": False}

    request = Request({"type": "http", "method": "POST", "headers": JSON, "client": ("2001:db8::1", 1)}, coming)
    with pytest.raises(Problem, match="busy"):
        asyncio.run(body_reader.read_body(request, 100, 1.0, reading))


def test_a_stop_waits_for_a_drain_and_answers_close_their_connections() -> None:
    with run(Settings(workers=1, drain_s=30.0)) as running:
        kept = running.connect(LIVE)
        assert status(kept) == 200
        running.server.handle_exit(15, None)
        for connection in (kept, running.connect()):
            with connection:
                connection.sendall(LIVE.replace(b"/livez", b"/readyz"))
                head, _, body = rest(connection).partition(b"\r\n\r\n")
                assert head.split()[1] == b"503"
                assert b"connection: close" in head.lower()
                assert json.loads(body)["type"] == "urn:assur:problem:draining"
        assert running.status() == 200
        assert not running.server.should_exit
        running.server.handle_exit(15, None)
        until(lambda: running.server.should_exit)
        running.server._captured_signals.clear()  # not the process of the tests is to end
