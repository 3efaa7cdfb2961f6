"""The output of log lines. A caller that logs never waits: not for a disk, not for a pipe without a reader.

In the web process lines wait in a bounded queue for a thread that writes them. In a worker they are written at once, to
a pipe, if it takes them at once: what a worker logged before it died is kept that way. In both, a line for which there
is no room is dropped, and the number of dropped lines is logged as soon as there is room again.
"""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import queue
import secrets
import select
import threading
from collections.abc import Callable, Iterator
from datetime import UTC, datetime

MOST_LINES = 4096
"""So many lines wait to be written."""
LONGEST_LINE = 4096
"""Longest line, bytes with its end. A pipe takes so much whole (PIPE_BUF): lines of several processes do not mix."""
END_S = 1.0
"""So long is what still waits written at the end, s. Who does not read by then will not."""


def _bytes(line: str) -> bytes:
    """A line with its end. One that is too long keeps its short facts only."""
    data = line.encode("utf-8", "backslashreplace") + b"\n"
    if len(data) <= LONGEST_LINE:
        return data
    facts = {name: value for name, value in json.loads(line).items() if len(json.dumps(value)) <= 600}
    short = json.dumps({**facts, "shortened": True}).encode() + b"\n"
    return short if len(short) <= LONGEST_LINE else b'{"event": "a line of the log was too long"}\n'


def now() -> str:
    """The time of a line."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")


def _dropped(count: int) -> str:
    facts = {"level": "warning", "logger": "assur", "event": "lines of the log were dropped", "count": count}
    return json.dumps({"time": now(), **facts})


class AtOnce:
    """Writes to a descriptor what it takes without waiting."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._lock = threading.RLock()  # a line may be logged while one is: by what the garbage collector finds
        self.dropped = 0
        """Lines that were dropped and not yet reported."""

    def put(self, line: str) -> None:
        """Writes a line, or drops it."""
        with self._lock:
            if self.dropped and self._written(_bytes(_dropped(self.dropped))):
                self.dropped = 0
            if self.dropped or not self._written(_bytes(line)):
                self.dropped += 1

    def _written(self, data: bytes) -> bool:
        """Whether there was room. A pipe that is not full has room for one line."""
        try:
            poll = select.poll()
            poll.register(self._descriptor, select.POLLOUT)
            if not any(event & select.POLLOUT for _, event in poll.poll(0)):
                return False
            return os.write(self._descriptor, data) == len(data)
        except OSError:
            return False  # the reader is gone, or is too slow


class Later:
    """Lines that a thread writes to a descriptor, one after the other. `ended` is called when it ends."""

    _standard_error: Later | None = None

    def __init__(self, descriptor: int, most: int = MOST_LINES) -> None:
        self._descriptor = descriptor
        self._waiting: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
        self._most = most
        self._lock = threading.RLock()  # a line may be logged while one is: by what the garbage collector finds
        self.dropped = 0
        """Lines that were dropped and not yet reported."""
        self.dropped_ever = 0
        """Lines that were dropped since the start, for the metrics."""
        self._thread = threading.Thread(target=self._write, name="assur-log", daemon=True)
        self._thread.start()

    @classmethod
    def on_standard_error(cls) -> Later:
        """The one that writes to the standard error of this process, wherever that is led meanwhile."""
        if cls._standard_error is None:
            cls._standard_error = cls(os.dup(2))
            atexit.register(cls._standard_error.end)
        return cls._standard_error

    @classmethod
    def lost(cls) -> int:
        """Lines that this process has dropped since its start."""
        return 0 if cls._standard_error is None else cls._standard_error.dropped_ever

    def put(self, line: str) -> None:
        """Takes a line to be written, or drops it."""
        self.put_bytes(_bytes(line))

    def put_bytes(self, data: bytes) -> None:
        """Takes a whole line, as it is."""
        if self._waiting.qsize() < self._most:
            self._waiting.put(data)
            return
        with self._lock:
            self.dropped += 1
            self.dropped_ever += 1

    def end(self) -> None:
        """Writes what waits, for `END_S` at the most. Lines that come later are not written."""
        self._waiting.put(None)
        self._thread.join(END_S)

    def _write(self) -> None:
        while (data := self._waiting.get()) is not None:
            self._all(data)
            with self._lock:
                count, self.dropped = self.dropped, 0
            if count:
                self._all(_bytes(_dropped(count)))

    def _all(self, data: bytes) -> None:
        """Writes all of it, and waits for the reader. Without a reader, nothing is left to do."""
        poll = select.poll()
        poll.register(self._descriptor, select.POLLOUT)
        with contextlib.suppress(OSError):
            while data:
                try:
                    data = data[os.write(self._descriptor, data) :]
                except BlockingIOError:  # the owner of the descriptor made it so
                    poll.poll()


@contextlib.contextmanager
def standard_error_as_lines(raw: Callable[[str], str]) -> Iterator[None]:
    """Leads descriptor 2 of this process, and of the processes that it makes, into a pipe that takes what it has room
    for and never makes anyone wait. A thread passes on what is a line of a log, and what is not as `raw` makes it one.
    """
    out = Later.on_standard_error()
    end, pipe = os.pipe()
    os.set_blocking(pipe, False)
    before = os.dup(2)
    os.dup2(pipe, 2)
    last = secrets.token_hex(16).encode()
    reader = threading.Thread(target=_pass_on, args=(end, out, raw, last), name="assur-stderr", daemon=True)
    reader.start()
    try:
        yield
    finally:
        os.dup2(before, 2)
        os.close(before)
        with contextlib.suppress(OSError):
            os.write(pipe, b"\n" + last + b"\n")  # processes that end later hold the pipe, too
        os.close(pipe)
        reader.join(END_S)


def _pass_on(end: int, out: Later, raw: Callable[[str], str], last: bytes) -> None:
    """Reads lines until the `last`, or until nobody holds the other end."""
    rest = b""
    while data := os.read(end, 65536):
        *lines, rest = (rest + data).split(b"\n")
        for line in lines:
            if line == last:
                os.close(end)
                return
            _pass_line(line, out, raw)
        if len(rest) > LONGEST_LINE:
            _pass_line(rest, out, raw)
            rest = b""
    if rest:
        _pass_line(rest, out, raw)
    os.close(end)


def _pass_line(line: bytes, out: Later, raw: Callable[[str], str]) -> None:
    if not line.strip():
        return
    if line.startswith(b"{") and _is_ours(line):
        out.put_bytes(line + b"\n")
    else:
        out.put(raw(line[:LONGEST_LINE].decode("utf-8", "backslashreplace")))


def _is_ours(line: bytes) -> bool:
    """Whether a line is one of a log of ours."""
    try:
        found = json.loads(line)
    except ValueError:
        return False
    return isinstance(found, dict) and {"time", "level", "logger", "event"} <= found.keys()
