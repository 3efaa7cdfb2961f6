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

    def __init__(self) -> None:
        self._received = bytearray()
        self._report: Tell | None = None
        self._reply: asyncio.Future[tuple[bool, Any]] | None = None
        self._transport: asyncio.Transport
        self.closed = False

    def give(self, job: tuple[Any, ...], report: Tell | None) -> asyncio.Future[tuple[bool, Any]]:
        """Whether a job has returned, and what it returned or raised; `report` takes its messages. The result of the
        job before has come. Raises `ConnectionError` where the worker is gone and had not read the job, `EOFError`
        where it had."""
        data = pickle.dumps(job)
        self._report = report
        return self._written(JOB + LENGTH.pack(len(data)) + data)

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
        self.fail(exc or EOFError())

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
