"""Logs: one JSON object a line on standard error, made of our own words and numbers.

Nothing that a caller sent is written: no path, no header, no body; a request is known by its id and by the digest of
its body. What a library logs passes `printable`, so that no line can be forged.
"""

from __future__ import annotations

import json
import logging
import sys
from datetime import UTC, datetime
from types import TracebackType
from typing import IO

from assur.api.problems import printable

LOGGER = logging.getLogger("assur")
LONGEST_MESSAGE = 500


def where(trace: TracebackType | None, deepest: int = 12) -> list[str]:
    """The innermost `deepest` frames of a traceback as `module:function:line`, without any value."""
    frames = []
    while trace is not None:
        code = trace.tb_frame.f_code
        frames.append(f"{trace.tb_frame.f_globals.get('__name__', '?')}:{code.co_name}:{trace.tb_lineno}")
        trace = trace.tb_next
    return frames[-deepest:]


class JsonLines(logging.Formatter):
    """A record as one line of JSON; `extra={"facts": {...}}` adds facts. Of an exception: its type and place only."""

    def format(self, record: logging.LogRecord) -> str:
        line: dict[str, object] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "event": printable(record.getMessage(), LONGEST_MESSAGE),
        }
        facts = getattr(record, "facts", None)
        if isinstance(facts, dict):
            line.update(facts)
        if record.exc_info and record.exc_info[0] is not None:
            line["fault"] = record.exc_info[0].__name__
            line["where"] = where(record.exc_info[2])
        return json.dumps(line, allow_nan=False, default=str)


def configure(level: str, stream: IO[str] | None = None) -> None:
    """Sends every logger of this process to `stream` (default: standard error) as JSON lines."""
    handler = logging.StreamHandler(sys.stderr if stream is None else stream)
    handler.setFormatter(JsonLines())
    logging.basicConfig(handlers=[handler], level=level.upper(), force=True)


def event(message: str, level: int = logging.INFO, **facts: object) -> None:
    """Logs `message`, a sentence of our own, with `facts`."""
    LOGGER.log(level, message, extra={"facts": facts})
