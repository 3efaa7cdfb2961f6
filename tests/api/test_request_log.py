"""The outermost ring: whatever goes wrong inside is answered, and nobody is shown how."""

from __future__ import annotations

import asyncio
import errno
import json
import logging
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from starlette.requests import ClientDisconnect
from starlette.types import Message, Receive, Scope, Send

from assur.api.problems import MEDIA_TYPE, Problem
from assur.api.web.request_log import RequestLog
from assur.api.workers.jobs import Fault, check, plan
from assur.api.workers.worker_process import About, Line

ROOT = Path(__file__).parents[2]


@pytest.fixture
def line() -> Iterator[Line]:
    """A line at whose other end nobody listens."""
    here, there = socket.socketpair()
    with here, there:
        yield Line(here, About({}, suspect=False))


def through(error: BaseException, *first: Message) -> list[Message]:
    """What the gate sends when what is behind it sends `first` and then raises `error`."""
    sent: list[Message] = []

    async def behind(_: Scope, __: Receive, send: Send) -> None:
        for message in first:
            await send(message)
        raise error

    async def receive() -> Message:
        return {"type": "http.disconnect"}

    async def send(message: Message) -> None:
        sent.append(message)

    asyncio.run(RequestLog(behind)({"type": "http", "method": "GET", "path": "/", "headers": []}, receive, send))
    return sent


def test_a_fault_is_answered_with_a_problem_that_bears_the_id_under_which_it_is_logged(
    caplog: pytest.LogCaptureFixture,
) -> None:
    with caplog.at_level(logging.INFO):
        start, body = through(RuntimeError("the secret of a request"))
    headers = {name.decode(): value.decode() for name, value in start["headers"]}
    assert start["status"] == 500
    assert headers["content-type"] == MEDIA_TYPE
    document = json.loads(body["body"])
    assert document["type"] == "urn:assur:problem:fault"
    assert headers["x-request-id"] in document["detail"]
    assert b"secret" not in body["body"]
    facts: Any = [record for record in caplog.records if record.message == "a request met a fault"]
    assert facts[0].facts == {"request": headers["x-request-id"]}


def test_a_fault_after_the_answer_has_begun_sends_nothing_more() -> None:
    begun: Message = {"type": "http.response.start", "status": 200, "headers": []}
    assert [message["type"] for message in through(RuntimeError(), begun)] == ["http.response.start"]


def test_a_client_that_left_is_sent_nothing() -> None:
    assert through(ClientDisconnect()) == []


def test_what_stops_the_process_is_not_held_up() -> None:
    with pytest.raises(KeyboardInterrupt):
        through(KeyboardInterrupt())


def test_a_fault_in_a_worker_is_told_by_its_type_and_place_without_a_value(
    monkeypatch: pytest.MonkeyPatch, line: Line
) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("the secret of a request")

    monkeypatch.setattr("assur.api.workers.jobs.plan_document", broken)
    reply = plan(b"{}", "full", 1.0, line)
    assert isinstance(reply, Fault)
    assert reply.name == "ZeroDivisionError"
    assert "secret" not in str(reply)
    assert any("broken" in frame for frame in reply.where)


def test_an_answer_that_json_cannot_hold_is_a_fault_and_not_sent(monkeypatch: pytest.MonkeyPatch, line: Line) -> None:
    monkeypatch.setattr(
        "assur.api.workers.jobs.plan_document", lambda *_, **__: {"status": "planned", "duration_s": float("nan")}
    )
    assert isinstance(plan(b"{}", "full", 1.0, line), Fault)


def test_a_check_of_no_json_is_a_problem(line: Line) -> None:
    reply = check(b"{", line)
    assert isinstance(reply, Problem)
    assert reply.kind == "bad-syntax"


def test_a_worker_without_memory_ends_and_says_so() -> None:
    program = """
import socket
from assur.api.workers import jobs
from assur.api.workers.worker_process import About, Line
def broken(*_, **__): raise MemoryError
jobs.plan_document = broken
jobs.plan(b"{}", "full", 1.0, Line(socket.socketpair()[0], About({}, False)))
"""
    run = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, timeout=60, check=False)
    assert run.returncode == errno.ENOMEM
    assert run.stderr == b""
