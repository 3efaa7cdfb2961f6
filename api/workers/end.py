"""The web process's end of the socket pair to a worker, and the messages on it.

A message is a byte that says what it is, and, where there is something to say, a length and a pickle.
"""

from __future__ import annotations

import asyncio
import pickle
import struct
from collections.abc import Callable
from typing import Any, cast

JOB, CALL_OFF = b"J", b"C"
"""What the web process writes: a job, and that the result of the job that runs is not wanted any more."""
MESSAGE, RESULT = b"T", b"R"
"""What a worker writes: what the job means and how far it has come, and its result."""
LENGTH = struct.Struct("!Q")
"""Stands before each pickle: its length in bytes."""
HEAD_BYTES = 1 + LENGTH.size
"""What a message is, and its length."""
Tell = Callable[[Any], None]
"""Takes how far a job has come; None: nothing to say, but the job may have been called off."""


def unpickled(data: bytes) -> Any:
    """What a process of this service has pickled. Nothing else may come here: reading a pickle runs code."""
    return pickle.loads(data)  # noqa: S301 - from our own process


class End(asyncio.Protocol):
    """Writes a job, and reads what the worker writes until its result.

    A worker that has read its job may have had effects. Whether it had read it is known when it is gone: Linux resets
    the connection where something that was written to it has not been read, and else ends it.
    """

    def __init__(self, lost: Callable[[End], None]) -> None:
        """`lost`: is called with this when the pair is closed, by whomever."""
        self._lost = lost
        self._received = bytearray()
        self._report: Tell | None = None
        self._reply: asyncio.Future[tuple[bool, Any]] | None = None
        self._ends_by = 0.0
        self._clock: asyncio.TimerHandle | None = None
        """Rings when the job must have ended, or before: it is not set anew for each job."""
        self._transport: asyncio.Transport
        self.closed = False

    def give(self, job: tuple[Any, ...], report: Tell | None, ends_by: float) -> asyncio.Future[tuple[bool, Any]]:
        """Whether a job has returned, and what it returned or raised; `report` takes its messages. The result of the
        job before has come. Raises `ConnectionError` where the worker is gone and had not read the job, `EOFError`
        where it had, and `TimeoutError` where there is no result when the clock of the loop is `ends_by`, s."""
        data = pickle.dumps(job)
        self._report, self._ends_by = report, ends_by
        if not self.closed and (self._clock is None or self._clock.when() > ends_by):
            self._set_clock()
        return self._written(JOB + LENGTH.pack(len(data)) + data)

    def _set_clock(self) -> None:
        self._unset_clock()
        self._clock = asyncio.get_running_loop().call_at(self._ends_by, self._ring)

    def _unset_clock(self) -> None:
        if self._clock is not None:
            self._clock.cancel()
            self._clock = None

    def _ring(self) -> None:
        self._clock = None
        if self._reply is None or self._reply.done():
            return
        if asyncio.get_running_loop().time() < self._ends_by:
            self._set_clock()
        else:
            self.fail(TimeoutError())

    def call_off(self) -> asyncio.Future[tuple[bool, Any]]:
        """Writes that the job is called off. Gives what `give` gave, also to one who has cancelled that."""
        reply = self._reply
        return self._written(CALL_OFF) if reply is None or reply.cancelled() else reply

    def _written(self, message: bytes) -> asyncio.Future[tuple[bool, Any]]:
        """Writes a message; the result of the job that comes after it."""
        reply = self._reply = asyncio.get_running_loop().create_future()
        if self.closed:
            reply.set_exception(ConnectionResetError())
        else:
            self._transport.write(message)
        return reply

    def close(self) -> None:
        """Closes the pair, which ends a worker that waits for a job."""
        self._transport.close()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast(asyncio.Transport, transport)

    def connection_lost(self, exc: Exception | None) -> None:
        self.closed = True
        self._unset_clock()
        self.fail(exc or EOFError())
        self._lost(self)

    def data_received(self, data: bytes) -> None:
        self._received += data
        while len(self._received) >= HEAD_BYTES:
            end = HEAD_BYTES + LENGTH.unpack_from(self._received, 1)[0]
            if len(self._received) < end:
                return
            is_result, message = self._received.startswith(RESULT), bytes(self._received[HEAD_BYTES:end])
            del self._received[:end]
            try:
                value = unpickled(message)
                if not is_result and self._report is not None:
                    self._report(value)
            except Exception as fault:  # noqa: BLE001 - raised where the reply is awaited
                self.fail(fault)
            else:
                if is_result and self._reply is not None and not self._reply.done():
                    self._reply.set_result(value)

    def fail(self, error: Exception) -> None:
        """Has who waits for the result get an error."""
        if self._reply is not None and not self._reply.done():
            self._reply.set_exception(error)
