"""What clients may delay has a time, and too many connections stop nobody: real sockets, a server in this process."""

from __future__ import annotations

import asyncio
import contextlib
import json
import re
import socket
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from typing import Any

import pytest
from starlette.requests import Request
from uvicorn.server import ServerState

from assur.api.problems import Problem
from assur.api.web import body_reader
from assur.api.web.addresses import network
from assur.api.web.body_reader import CHUNK_BYTES, FIRST_CHUNKS, Reading
from assur.api.web.connections import AGAIN, LOOK_S
from assur.api.web.serve import Server, listening, made
from assur.api.web.settings import Settings
from tests.api.processes import until

SHORT = Settings(
    workers=1, connections=40, connections_per_address=20, header_s=1.5, keep_alive_s=2.0, write_s=1.0, body_s=30.0
)
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
        return sum(not each.idle for each in self.server._connections.open())

    def status(self, data: bytes = LIVE, address: str = "127.0.0.1") -> int:
        with self.connect(data, address) as connection:
            return status(connection)


@contextmanager
def run(settings: Settings) -> Iterator[Running]:
    with listening("127.0.0.1", 0) as door:
        server = made(settings)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [door]})
        thread.start()
        try:
            yield Running(server, door.getsockname()[1])
        finally:
            server.should_exit = True
            thread.join()


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


def test_headers_that_trickle_are_refused_however_steadily_they_come(running: Running) -> None:
    with running.connect(b"GET /livez HTTP/1.1\r\nX: ") as connection:
        connection.settimeout(0.05)
        found = b""
        for _ in range(600):
            with contextlib.suppress(TimeoutError):
                found = connection.recv(4096)
                break
            connection.sendall(b"x")
    head, _, body = found.partition(b"\r\n\r\n")
    assert head.split()[1] == b"408"
    assert b"connection: close" in head.lower()
    assert json.loads(body)["type"] == "urn:assur:problem:too-slow"


@pytest.mark.parametrize("begun", [b"", b"GET /livez HT"], ids=["idle", "with half a request"])
def test_a_kept_connection_has_a_time_too(running: Running, begun: bytes) -> None:
    with running.connect(LIVE) as connection:
        assert status(connection) == 200
        connection.sendall(LIVE)
        assert status(connection) == 200
        connection.sendall(begun)
        assert (b" 408 " in rest(connection)) == bool(begun)


def test_half_a_request_behind_a_whole_one_has_a_time_too(running: Running) -> None:
    with running.connect(LIVE + b"GET /livez HT") as connection:
        statuses = [part.split()[0] for part in rest(connection).split(b"HTTP/1.1 ")[1:]]
    assert statuses == [b"200", b"408"]


def in_chunks(size: int, count: int) -> bytes:
    return CHUNKED + (b"%x\r\n" % size + b"x" * size + b"\r\n") * count + b"0\r\n\r\n"


@pytest.mark.parametrize(("size", "count"), [(1, 100_000), (1, 130), (CHUNK_BYTES - 100, 1000)])
def test_a_body_in_many_small_chunks_is_refused_before_it_is_parsed(running: Running, size: int, count: int) -> None:
    with running.connect(in_chunks(size, count)) as connection:
        head, _, body = rest(connection).partition(b"\r\n\r\n")  # the connection is closed behind the answer
    assert head.split()[1] == b"400"
    problem = json.loads(body)
    assert problem["type"] == "urn:assur:problem:bad-syntax"
    assert [error["field"] for error in problem["errors"]] == ["Transfer-Encoding"]


@pytest.mark.parametrize(("size", "count"), [(1, FIRST_CHUNKS), (CHUNK_BYTES, 500), (200_000, 2)])
def test_a_body_in_few_or_in_large_chunks_is_read(running: Running, size: int, count: int) -> None:
    last = LIVE.replace(b"Host: x", b"Host: x\r\nConnection: close")
    with running.connect(in_chunks(size, count) + last) as connection:
        found = rest(connection)
    assert [part[:3] for part in found.split(b"HTTP/1.1 ")[1:]] == [b"400", b"200"]
    assert b"Transfer-Encoding" not in found


def test_health_is_answered_while_bodies_come_in_small_chunks(running: Running) -> None:
    with ExitStack() as stack:
        small = [stack.enter_context(running.connect()) for _ in range(8)]
        senders = [threading.Thread(target=sent, args=(each, in_chunks(1, 1_000_000))) for each in small]
        for sender in senders:
            sender.start()
        assert running.status() == 200
        assert any(sender.is_alive() for sender in senders) or all(b" 400 " in rest(each) for each in small)
        for sender in senders:
            sender.join()


def sent(connection: socket.socket, data: bytes) -> None:
    """Sends as much as is taken."""
    with contextlib.suppress(OSError):
        connection.sendall(data)


@pytest.mark.parametrize("times", [1, 3], ids=["one request", "three in a row"])
def test_a_client_that_has_finished_writing_gets_its_answers(running: Running, times: int) -> None:
    with running.connect(LARGE * times) as connection:
        connection.shutdown(socket.SHUT_WR)
        found = rest(connection)
    assert found.count(b"HTTP/1.1 200") == times
    assert found.endswith(b"}")


def test_a_client_that_finishes_in_the_middle_of_its_body_is_gone(running: Running) -> None:
    with running.connect(SLOW + b"{") as connection:
        connection.shutdown(socket.SHUT_WR)
        assert rest(connection) == b""


def test_a_client_that_does_not_take_its_answer_is_dropped(running: Running) -> None:
    with socket.socket() as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        connection.settimeout(60.0)
        connection.connect(("127.0.0.1", running.port))
        with contextlib.suppress(ConnectionResetError, BrokenPipeError):
            connection.sendall(LARGE * 400)
        until(lambda: running.at_work == 1)
        until(lambda: running.at_work == 0)
        assert rest(connection).count(b"HTTP/1.1 200") < 400, "all of it was taken"


@pytest.mark.slow
def test_a_client_that_takes_its_answer_slowly_gets_all_of_it(running: Running) -> None:
    with socket.socket() as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 65536)
        connection.settimeout(60.0)
        connection.connect(("127.0.0.1", running.port))
        connection.sendall(LARGE * 100)
        connection.shutdown(socket.SHUT_WR)
        began, found = time.monotonic(), b""
        while time.monotonic() - began < 3 * SHORT.write_s:
            found += connection.recv(65536)  # much more than the least rate, and much less than would be sent
            time.sleep(0.02)
        found += rest(connection)
    assert found.count(b"HTTP/1.1 200") == 100
    assert found.endswith(b"}")


def test_an_answer_that_is_not_taken_gives_way_to_a_new_connection() -> None:
    with run(replace(SHORT, connections_per_address=4, write_s=100.0)) as running, ExitStack() as unread:
        for _ in range(4):
            connection = unread.enter_context(socket.socket())
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            connection.connect(("127.0.0.1", running.port))
            connection.setblocking(False)
            with contextlib.suppress(BlockingIOError):
                connection.send(LARGE * 200)
        until(lambda: running.at_work == 4)
        until(lambda: all(each.waiting for each in running.server._connections.open()))
        assert running.status(LIVE.replace(b"/livez", b"/v1/robots")) == 200


def test_beyond_the_limit_of_an_address_the_longest_idle_one_is_closed(running: Running) -> None:
    with ExitStack() as stack:
        kept = stack.enter_context(running.connect(LIVE))
        assert status(kept) == 200
        idle = [stack.enter_context(running.connect()) for _ in range(3 * SHORT.connections_per_address)]
        assert running.status() == 200
        kept.sendall(LIVE)
        assert status(kept) == 200  # those go first on which nothing ever came
        assert rest(idle[0]) == b""


@pytest.mark.slow
def test_an_address_that_comes_again_and_again_beyond_its_limit_is_closed_unseen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with run(SHORT) as running, ExitStack() as stack:
        connections, made_ = running.server._connections, Counter[str]()
        admit = connections.admit

        def counted(connection: Any) -> bool:
            made_[connection.address] += 1
            return admit(connection)

        monkeypatch.setattr(connections, "admit", counted)
        began = time.monotonic()
        for _ in range(2_000):
            stack.enter_context(running.connect(address="127.0.0.9"))
        assert running.status(address="127.0.0.8") == 200
        looks = (time.monotonic() - began) / LOOK_S + 2
        assert SHORT.connections_per_address <= made_["127.0.0.9"] <= SHORT.connections_per_address + AGAIN * looks
        until(lambda: running.status(address="127.0.0.9") == 200, within_s=10.0)


def test_with_all_connections_at_work_health_is_answered_and_other_addresses_are_served(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(body_reader, "FIRST_S", 100.0)  # nothing ends by itself
    robots = LIVE.replace(b"/livez", b"/v1/robots")
    with run(replace(SHORT, connections=24, connections_per_address=16, body_s=100.0, queue=1000)) as running:
        with ExitStack() as slow:
            for _ in range(16):
                slow.enter_context(running.connect(SLOW))
            until(lambda: running.at_work == 16)
            assert running.status() == 200
            with running.connect(robots) as connection:
                head, _, body = rest(connection).partition(b"\r\n\r\n")
            assert (head.split()[1], json.loads(body)["type"]) == (b"503", "urn:assur:problem:busy")
            assert b"connection: close" in head.lower()
            assert running.status(robots, "127.0.0.2") == 200
            for _ in range(8):
                slow.enter_context(running.connect(SLOW, "127.0.0.2"))
            until(lambda: running.at_work == 24)
            assert running.status(robots, "127.0.0.3") == 503
            assert running.status(LIVE, "127.0.0.3") == 200
        until(lambda: running.at_work == 0)
        assert running.status(robots) == 200


@pytest.mark.parametrize("count", [512, 1000])
def test_idle_connections_do_not_stop_anybody(running: Running, count: int) -> None:
    with ExitStack() as idle:
        for number in range(count):
            idle.enter_context(running.connect(address=f"127.0.0.{2 + number % 4}"))
        for _ in range(20):
            assert running.status() == 200
        assert len(running.server._connections.open()) <= SHORT.connections


def test_a_body_that_comes_too_slowly_is_given_up_before_its_time(running: Running) -> None:
    with running.connect(SLOW + b"{") as connection:
        assert status(connection) == 408  # `body_s` is as long as the socket waits


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


def test_connections_of_one_network_are_counted_together() -> None:
    async def address(of: str) -> str:
        server = made(SHORT)
        server.config.load()
        kind: Any = server.config.http_protocol_class
        protocol = kind(server.config, ServerState(), {})
        protocol.connection_made(asyncio.Transport({"peername": (of, 1)}))
        return str(protocol.address)

    assert asyncio.run(address("2001:db8::1")) == asyncio.run(address("2001:db8::2")) == "2001:db8::/64"
    assert asyncio.run(address("127.0.0.1")) != asyncio.run(address("127.0.0.2"))


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


def test_what_is_on_its_way_when_the_door_closes_is_answered() -> None:
    with run(Settings(workers=1)) as running:
        new, begun = running.connect(), running.connect(b"GET /livez HT")
        time.sleep(0.2)
        running.server.should_exit = True
        asyncio.run(closed(running.port))
        begun.sendall(b"TP/1.1\r\nHost: x\r\n\r\n")
        for connection in (begun, new):
            with connection:
                found = rest(connection)
                assert found == b"" if connection is new else found.startswith(b"HTTP/1.1 200")


async def closed(port: int) -> None:
    """Waits until nobody listens there."""
    for _ in range(1000):
        try:
            _, writer = await asyncio.open_connection("127.0.0.1", port)
        except OSError:
            return
        writer.close()
        await asyncio.sleep(0.02)
