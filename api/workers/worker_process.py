"""One worker process, reached by a socket pair: what happens to it happens to one request.

The process is spawned, plans once, and then answers one job at a time: a length and a pickle in; a byte that says that
the job has begun, then a length and a pickle out. A process that crashed, did not end in time or whose caller has gone
is killed and never used again.
"""

from __future__ import annotations

import asyncio
import atexit
import errno
import multiprocessing
import pickle
import resource
import signal
import socket
import struct
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.context import SpawnProcess
from typing import Any

BEGUN = b"\x01"
"""What a worker writes when it has read a job: from then on the job may have had effects."""
LENGTH = struct.Struct("!Q")
"""Stands before each pickle: its length in bytes."""


class CrashedError(Exception):
    """The worker died under its job; `how` says by what."""

    def __init__(self, how: str) -> None:
        super().__init__(how)
        self.how = how


class NotBegunError(CrashedError):
    """The worker had died before it took the job: nothing of it has run, and it may be given to another."""


class KilledError(Exception):
    """The worker was killed because its job did not end in time."""


def prepare(memory_mib: int) -> None:
    """Runs first in a new worker: bounds its address space and makes it deaf to SIGTERM and SIGINT.

    A service manager may signal the whole group: the web process then drains, and its workers must go on meanwhile.
    """
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    size = memory_mib << 20
    resource.setrlimit(resource.RLIMIT_AS, (size, size))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def serve_jobs(end: socket.socket, memory_mib: int) -> None:
    """What a worker process does until the other end is closed: jobs, one after the other."""
    prepare(memory_mib)
    with suppress(ConnectionError), end, end.makefile("rwb") as stream:
        while head := stream.read(LENGTH.size):
            job, arguments = pickle.loads(stream.read(*LENGTH.unpack(head)))  # noqa: S301 - from our own web process
            stream.write(BEGUN)
            stream.flush()
            reply = pickle.dumps(_result(job, arguments))
            stream.write(LENGTH.pack(len(reply)))
            stream.write(reply)
            stream.flush()


def _result(job: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[bool, Any]:
    try:
        return True, job(*arguments)
    except Exception as error:  # noqa: BLE001 - it is raised again in the web process
        return False, error


def _how(code: int | None) -> str:
    if code is not None and code < 0:
        with suppress(ValueError):
            return f"was killed by {signal.Signals(-code).name}"
    return "ended for want of memory" if code == errno.ENOMEM else f"ended with exit code {code}"


class WorkerProcess:
    """A place for one worker process. Not `open` until it has planned once; not for two jobs at a time."""

    def __init__(self, memory_mib: int, warm: Callable[[], Any], warm_s: float) -> None:
        self._memory_mib = memory_mib
        self._warm = warm
        self._warm_s = warm_s
        self._process: SpawnProcess | None = None
        self._streams: tuple[asyncio.StreamReader, asyncio.StreamWriter] | None = None
        self._spoilt = False
        self.jobs = 0
        """Jobs that this worker has been given since it was started."""

    @property
    def open(self) -> bool:
        """Whether a job may be given to it: its process is there, has planned once, and nothing went wrong."""
        return self._streams is not None and not self._spoilt and not self._streams[0].at_eof()

    async def start(self) -> None:
        """Replaces the worker by a new one, and has it plan once.

        Raises `CrashedError` or `KilledError` when that fails.
        """
        await self.stop()
        ours, theirs = socket.socketpair()
        try:
            process = multiprocessing.get_context("spawn").Process(
                target=serve_jobs, args=(theirs, self._memory_mib), daemon=True
            )
            await asyncio.to_thread(process.start)
            atexit.register(process.kill)  # it is deaf to the signal that multiprocessing would send
            self._process = process
        finally:
            theirs.close()
        streams = await asyncio.open_connection(sock=ours)
        try:
            succeeded, value = await self._exchange(streams, self._warm, (), self._warm_s)
            if not succeeded:
                raise CrashedError(f"its first plan raised {type(value).__name__}") from value
        except BaseException:
            streams[1].close()
            await self.stop()
            raise
        self._streams, self._spoilt, self.jobs = streams, False, 0

    async def run(self, job: Callable[..., Any], arguments: tuple[Any, ...], wall_s: float) -> Any:
        """What `job(*arguments)` returns, or raises, in the worker. Both are pickled.

        Raises `CrashedError` when the worker dies and `KilledError` when it is killed after `wall_s`; after these,
        and when cancelled, the process is closed until `start` is called again.
        """
        if self._streams is None:
            raise NotBegunError("was not started")
        self.jobs += 1
        try:
            succeeded, value = await self._exchange(self._streams, job, arguments, wall_s)
        except BaseException:
            self._spoilt = True
            if self._process is not None:
                self._process.kill()
            raise
        if not succeeded:
            raise value
        return value

    async def stop(self) -> None:
        """Ends the worker, at once and whatever it does."""
        streams, self._streams = self._streams, None
        process, self._process = self._process, None
        if streams is not None:
            streams[1].close()
        if process is not None:
            process.kill()
            await asyncio.shield(asyncio.to_thread(process.join))
            atexit.unregister(process.kill)

    async def _exchange(
        self,
        streams: tuple[asyncio.StreamReader, asyncio.StreamWriter],
        job: Callable[..., Any],
        arguments: tuple[Any, ...],
        wall_s: float,
    ) -> tuple[bool, Any]:
        reader, writer = streams
        data = pickle.dumps((job, arguments))
        try:
            async with asyncio.timeout(wall_s):
                try:
                    writer.write(LENGTH.pack(len(data)) + data)
                    await writer.drain()
                    await reader.readexactly(len(BEGUN))
                except (asyncio.IncompleteReadError, ConnectionError) as gone:
                    raise NotBegunError("was dead before it began") from gone
                (length,) = LENGTH.unpack(await reader.readexactly(LENGTH.size))
                reply: tuple[bool, Any] = pickle.loads(await reader.readexactly(length))  # noqa: S301 - our own worker's
                return reply
        except (asyncio.IncompleteReadError, ConnectionError) as gone:
            raise CrashedError(_how(await self._exit_code())) from gone
        except TimeoutError as late:
            raise KilledError(f"no result after {wall_s:g} s") from late

    async def _exit_code(self) -> int | None:
        """The exit code of a process whose end of the pair is closed."""
        process = self._process
        if process is None:
            return None
        await asyncio.to_thread(process.join, 1.0)
        return process.exitcode
