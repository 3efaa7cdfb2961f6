"""A log line is one line of JSON, whatever it is about."""

from __future__ import annotations

import io
import json
import logging
import threading
from collections.abc import Iterator

import pytest

from assur.api.logs import configure, event


@pytest.fixture
def log() -> Iterator[io.StringIO]:
    """What this thread logs through the two loggers of these tests.

    A server that an earlier test has stopped may still log its end, in its own thread, and asyncio logs what the
    garbage collector finds, in any thread.
    """
    root = logging.getLogger()
    before, level = root.handlers[:], root.level
    stream = io.StringIO()
    here = threading.get_ident()
    configure("info", stream)
    for handler in root.handlers:
        handler.addFilter(lambda record: record.thread == here and record.name in ("assur", "elsewhere"))
    yield stream
    root.handlers[:] = before
    root.setLevel(level)


def test_an_event_is_one_line_with_its_facts(log: io.StringIO) -> None:
    event("worker ready", worker=2, ready=True)
    (line,) = log.getvalue().splitlines()
    facts = json.loads(line)
    assert {key: facts[key] for key in ("level", "event", "worker", "ready")} == {
        "level": "info",
        "event": "worker ready",
        "worker": 2,
        "ready": True,
    }


def test_a_message_of_a_library_cannot_forge_a_second_line(log: io.StringIO) -> None:
    logging.getLogger("elsewhere").warning('x\n{"event": "forged"}\r\x1b[2J' + "y" * 10_000)
    (line,) = log.getvalue().splitlines()
    assert len(line) < 1_000
    assert "\x1b" not in line


def test_of_an_exception_type_and_place_are_logged_but_not_what_it_says(log: io.StringIO) -> None:
    try:
        raise KeyError("the secret of a request")
    except KeyError:
        logging.getLogger("assur").exception("a request met a fault")
    (line,) = log.getvalue().splitlines()
    facts = json.loads(line)
    assert facts["event"] == "a request met a fault"
    assert facts["fault"] == "KeyError"
    assert len(facts["where"]) == 1
    assert "secret" not in log.getvalue()


def test_what_is_below_the_level_is_not_logged(log: io.StringIO) -> None:
    event("request", logging.DEBUG)
    assert log.getvalue() == ""
