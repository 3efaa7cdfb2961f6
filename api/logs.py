"""Logs: one JSON object a line on standard error, made of our own words and numbers.

Nothing that a caller sent is written: no path, no header, no body; a request is known by its id, by its `traceparent`
(hexadecimal digits), and by the digest of its body. What a library logs passes `printable`, so that no line can be
forged; in a worker, which reads what callers send, of a library's message only its place in the code is written.

No line is waited for: `assur.api.log_lines` says how.
"""

from __future__ import annotations

import io
import json
import logging
import sys
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from datetime import UTC, datetime
from pathlib import Path
from types import TracebackType
from typing import IO, TextIO

from assur.api.log_lines import AtOnce, Later, now, standard_error_as_lines
from assur.api.problems import printable

LOGGER = logging.getLogger("assur")
LONGEST_MESSAGE = 500
ABOUT: ContextVar[Mapping[str, str]] = ContextVar("assur_about")
"""The request that is worked on: what each line says of it."""


def where(trace: TracebackType | None, deepest: int = 12) -> list[str]:
    """The innermost `deepest` frames of a traceback as `module:function:line`, without any value."""
    frames = []
    while trace is not None:
        code = trace.tb_frame.f_code
        frames.append(f"{trace.tb_frame.f_globals.get('__name__', '?')}:{code.co_name}:{trace.tb_lineno}")
        trace = trace.tb_next
    return frames[-deepest:]


def _place(record: logging.LogRecord) -> str:
    return f"{record.module}:{record.funcName}:{record.lineno}"


class JsonLines(logging.Formatter):
    """A record as one line of JSON; `extra={"facts": {...}}` adds facts. Of an exception: its type and place only.

    `quoting`: whether the messages of libraries are written; else their place in the code is.
    """

    def __init__(self, *, quoting: bool = True) -> None:
        super().__init__()
        self._quoting = quoting

    def format(self, record: logging.LogRecord) -> str:
        line: dict[str, object] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "logger": record.name,
        }
        if self._quoting or record.name == LOGGER.name:
            line["event"] = printable(record.getMessage(), LONGEST_MESSAGE)
        else:
            line["event"] = "a library says something"
            line["place"] = _place(record)
        line.update(ABOUT.get({}))
        facts = getattr(record, "facts", None)
        if isinstance(facts, dict):
            line.update(facts)
        if record.exc_info and record.exc_info[0] is not None:
            line["fault"] = record.exc_info[0].__name__
            line["where"] = where(record.exc_info[2])
        return json.dumps(line, allow_nan=False, default=str)


class _Handler(logging.Handler):
    """Hands lines on to who writes them, and never waits."""

    def __init__(self, lines: Later | AtOnce, formatter: logging.Formatter) -> None:
        super().__init__()
        self._lines = lines
        self.setFormatter(formatter)

    def emit(self, record: logging.LogRecord) -> None:
        try:
            line = self.format(record)
        except Exception:  # noqa: BLE001 - a line that cannot be made must not end what it is about
            self.handleError(record)
            return
        self._lines.put(line)

    def handleError(self, record: logging.LogRecord) -> None:
        """Says that a line could not be made, and where; never its text."""
        line = {"time": now(), "level": "error", "logger": LOGGER.name, "event": "a line of the log could not be made"}
        self._lines.put(json.dumps({**line, "place": _place(record)}))


def configure(level: str, stream: IO[str] | None = None) -> None:
    """Sends every logger of this process to `stream`, as JSON lines. Default: to standard error, by a thread of its
    own, so that no caller waits for the reader."""
    if stream is None:
        handler: logging.Handler = _Handler(Later.on_standard_error(), JsonLines())
    else:
        handler = logging.StreamHandler(stream)
        handler.setFormatter(JsonLines())
    logging.basicConfig(handlers=[handler], level=level.upper(), force=True)


@contextmanager
def one_log() -> Iterator[None]:
    """Within it, whatever this process and its workers write to standard error is a line of JSON, too, and is not
    waited for. Nothing is done where `configure` has not sent the log there."""
    with standard_error_as_lines(_raw):
        yield


def _raw(text: str) -> str:
    """The line for what was written past the log: by a native library, or by an interpreter that ends."""
    line = {"time": now(), "level": "warning", "logger": "stderr", "event": printable(text, LONGEST_MESSAGE)}
    return json.dumps(line)


def configure_worker(level: str) -> None:
    """The same in a worker process: warnings are lines, too, and what Python code prints to standard error."""
    logging.basicConfig(handlers=[_Handler(AtOnce(2), JsonLines(quoting=False))], level=level.upper(), force=True)
    warnings.showwarning = _warned
    sys.stderr = Printed()


def _warned(
    message: Warning | str,  # noqa: ARG001 - it may quote what a caller sent
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,  # noqa: ARG001
    line: str | None = None,  # noqa: ARG001
) -> None:
    """Logs a warning: its kind and place, not what it says."""
    event("a library warns", logging.WARNING, kind=category.__name__, place=f"{Path(filename).stem}:{lineno}")


class Printed(io.TextIOBase):
    """What is printed to standard error in a worker: that it was is logged, and of an exception its type and place."""

    def writable(self) -> bool:
        return True

    def write(self, text: str) -> int:
        if text.strip() and not self._again():
            LOGGER.warning("a worker printed to standard error", exc_info=sys.exc_info()[0] is not None)
        return len(text)

    def _again(self) -> bool:
        """Whether this is the next piece of an exception that was logged: a traceback is printed line by line."""
        error = sys.exc_info()[1]
        again = error is not None and getattr(self, "_told", None) is error
        self._told = error
        return again


def event(message: str, level: int = logging.INFO, **facts: object) -> None:
    """Logs `message`, a sentence of our own, with `facts`."""
    LOGGER.log(level, message, extra={"facts": facts})
