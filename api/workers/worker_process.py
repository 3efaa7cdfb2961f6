"""One worker process, reached by a socket pair: what happens to it happens to one request.

The process is forked from a template that has loaded the libraries (`assur.api.workers.template`), plans once, and then
answers one job at a time. A process that crashed or did not end in time is killed and never used again, as is one whose
job listens, was called off, and did not end soon.
"""

from __future__ import annotations

import asyncio
import atexit
import ctypes
import errno
import multiprocessing
import pickle
import resource
import select
import signal
import socket
import tempfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing.context import ForkServerContext, ForkServerProcess
from typing import Any

from assur.api.workers.end import CALL_OFF, JOB, LENGTH, MESSAGE, RESULT, End, Tell, unpickled
from assur.api.workers.memory import FreedMemory, limit_memory
from assur.api.workers.quarantine import quarantined

ENDS_S = 2.0
"""A job that listens and is not wanted any more has so long to end, s, before its worker is killed: a search asks each
round. Any other has the rest of its time, so that a client that leaves costs nobody a worker."""

NO_MEMORY = "ended for want of memory"
"""How a worker died that had no memory left."""

TEMPLATE = ("assur.api.workers.template", "assur.api.command_line")
"""The module that makes a process the template from which workers are forked; and what runs `assur serve`, for each
process of multiprocessing imports the program that has started it."""
SHARED = "/dev/shm"  # noqa: S108 - a folder of the library's own, which nobody else may enter, is made there
"""Stands in for the folder of temporary files where none can be written, as in a container that may write nothing."""
NAME = b"assur-worker"
"""What the system calls a worker process; at most 15 characters."""
SET_NAME = 15
"""The option of prctl that sets it."""


class CalledOffError(Exception):
    """The result of the job is not wanted any more."""


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a job says before it does anything that might end its worker: the digest of what its request means."""

    digest: str


@dataclass(frozen=True)  # with slots, Python code would pickle it
class About:
    """What a job in touch gets. `banned`: the keys of requests in quarantine, and for how long they are, s;
    `suspect`: a worker has died under this very request; `reported`: somebody takes how far it has come."""

    banned: dict[str, float]
    suspect: bool
    reported: bool = True


class Line:
    """What a job in touch has of the web process."""

    def __init__(self, end: socket.socket, about: About) -> None:
        self._end = end
        self._about = about

    def means(self, digest: Callable[[], str]) -> None:
        """Says what the request means, where that matters. Raises the `Problem` of a request in quarantine."""
        if not (self._about.banned or self._about.suspect):
            return
        found = digest()
        if found in self._about.banned:
            raise quarantined(self._about.banned[found])
        _send(self._end, MESSAGE, Meaning(found))

    def tell(self, value: Any) -> None:
        """Says how far the job has come; None: nothing. Raises `CalledOffError` if it was called off."""
        readable, _, _ = select.select([self._end], [], [], 0.0)
        if readable:
            _received(self._end, len(CALL_OFF))  # nothing else is sent while a job runs; or the other end is closed
            raise CalledOffError
        if value is not None and self._about.reported:
            _send(self._end, MESSAGE, value)


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
    """Runs first in a new worker: names it, bounds its memory, and makes it deaf to SIGTERM and SIGINT.

    A service manager may signal the whole group: the web process then drains, and its workers must go on meanwhile.
    """
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    limit_memory(memory_mib)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    ctypes.CDLL(None).prctl(SET_NAME, NAME, 0, 0, 0)


def serve_jobs(end: socket.socket, memory_mib: int) -> None:
    """What a worker process does until the other end is closed: jobs, one after the other."""
    prepare(memory_mib)
    freed = FreedMemory()
    with suppress(ConnectionError), end:
        while kind := _received(end, len(JOB)):
            if kind == CALL_OFF:
                continue  # of a job that has ended meanwhile
            _serve_job(end)
            freed.give_back()


def _serve_job(end: socket.socket) -> None:
    job, arguments, about = unpickled(_received_pickle(end))
    _send(end, RESULT, _result(job, arguments if about is None else (*arguments, Line(end, about))))


def _send(end: socket.socket, kind: bytes, value: Any) -> None:
    data = pickle.dumps(value)
    end.sendall(kind + LENGTH.pack(len(data)) + data)


def _received(end: socket.socket, size: int) -> bytes:
    """So many bytes; none if the other end is closed."""
    found = bytearray()
    while len(found) < size:
        part = end.recv(size - len(found))
        if not part:
            return b""
        found += part
    return bytes(found)


def _received_pickle(end: socket.socket) -> bytes:
    """A pickle behind its length. Raises `ConnectionError` where the other end is closed before its end."""
    head = _received(end, LENGTH.size)
    data = _received(end, *LENGTH.unpack(head)) if head else b""
    if not data:
        raise ConnectionError("the web process is gone")
    return data


def _result(job: Callable[..., Any], arguments: tuple[Any, ...]) -> tuple[bool, Any]:
    try:
        return True, job(*arguments)
    except Exception as error:  # noqa: BLE001 - it is raised again in the web process
        return False, error


def _how(code: int | None) -> str:
    if code is not None and code < 0:
        with suppress(ValueError):
            return f"was killed by {signal.Signals(-code).name}"
    return NO_MEMORY if code == errno.ENOMEM else f"ended with exit code {code}"


def _context() -> ForkServerContext:
    """Where workers come from: one template for all workers of this process."""
    try:
        tempfile.gettempdir()
    except FileNotFoundError:
        tempfile.tempdir = SHARED  # the socket of the template needs a folder, and no other file is made
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(list(TEMPLATE))
    return context


class WorkerProcess:
    """A place for one worker process. Not `open` until it has planned once; not for two jobs at a time."""

    def __init__(self, memory_mib: int, warm: Callable[[], Any], warm_s: float, lost: Callable[[], None]) -> None:
        """`lost`: is called when a process that had planned is gone and was not stopped."""
        self._lost = lost
        self._memory_mib = memory_mib
        self._warm = warm
        self._warm_s = warm_s
        self._process: ForkServerProcess | None = None
        self._end: End | None = None
        self._spoilt = False
        self._ended_early = False
        self.jobs = 0
        """Jobs that this worker has been given since it was started."""

    @property
    def open(self) -> bool:
        """Whether a job may be given to it: its process is there, has planned once, and nothing went wrong."""
        return self._end is not None and not self._spoilt and not self._end.closed

    @property
    def pid(self) -> int | None:
        """Of its process; None while there is none."""
        return None if self._process is None else self._process.pid

    async def start(self) -> None:
        """Replaces the worker by a new one, and has it plan once.

        Raises `CrashedError` or `KilledError` when that fails, and `OSError` where no process can be made.
        """
        await self.stop()
        ours, theirs = socket.socketpair()
        try:
            process = _context().Process(target=serve_jobs, args=(theirs, self._memory_mib), daemon=True)
            try:
                await asyncio.to_thread(process.start)
            except (EOFError, OSError) as error:
                raise CrashedError(f"could not be forked from its template: {type(error).__name__}") from error
            atexit.register(process.kill)  # it is deaf to the signal that multiprocessing would send
            self._process = process
        except BaseException:
            ours.close()
            raise
        finally:
            theirs.close()
        _, end = await asyncio.get_running_loop().create_connection(partial(End, self._closed), sock=ours)
        try:
            succeeded, value = await self._in_time(end, (self._warm, (), None), self._warm_s)
            if not succeeded:
                raise CrashedError(f"its first plan raised {type(value).__name__}") from value
        except BaseException:
            end.close()
            await self.stop()
            raise
        self._end, self._spoilt, self.jobs = end, False, 0

    async def run(
        self,
        job: Callable[..., Any],
        arguments: tuple[Any, ...],
        wall_s: float,
        report: Tell | None = None,
        about: About | None = None,
        *,
        ends_s: float | None = None,
    ) -> Any:
        """What `job(*arguments)` returns, or raises, in the worker. Both are pickled.

        `about`: the job is in touch: it takes one more argument, a `Line`, and `report` takes what it sends there.
        `ends_s`: it asks there whether it is called off, which cancelling does; it is killed if it does not end
        within this time, s. Any other (None) goes on when this is cancelled, up to `wall_s`, and its result is dropped;
        the second time it is killed. The process stays if the job has ended.

        Raises `CrashedError` when the worker dies and `KilledError` when it is killed after `wall_s`. A process that
        died or was killed is closed until `start` is called again.
        """
        if self._end is None:
            raise NotBegunError("was not started")
        self.jobs += 1
        try:
            most_s = wall_s if ends_s is None else ends_s
            succeeded, value = await self._in_time(self._end, (job, arguments, about), wall_s, report, ends_s=most_s)
        except BaseException:
            if not self._ended_early:
                self._spoilt = True
                if self._process is not None:
                    self._process.kill()
            raise
        if not succeeded:
            raise value
        return value

    async def stop(self) -> None:
        """Ends the worker, at once and whatever it does."""
        end, self._end = self._end, None
        process, self._process = self._process, None
        if end is not None:
            end.close()
        if process is not None:
            process.kill()
            await asyncio.shield(asyncio.to_thread(process.join))
            atexit.unregister(process.kill)

    def _closed(self, end: End) -> None:
        if end is self._end:
            self._lost()

    async def _in_time(
        self, end: End, job: tuple[Any, ...], wall_s: float, report: Tell | None = None, *, ends_s: float = 0.0
    ) -> tuple[bool, Any]:
        """What `end` gives, within a time. `ends_s`: how long the job may go on when this is cancelled, at most to the
        end of `wall_s`."""
        self._ended_early = False
        loop = asyncio.get_running_loop()
        end_s = loop.time() + wall_s
        try:
            return await end.give(job, report, end_s)
        except TimeoutError as late:
            raise KilledError(f"no result after {wall_s:g} s") from late
        except asyncio.CancelledError:
            if ends_s > 0.0:
                self._ended_early = await _ends_when_called_off(end, min(ends_s, end_s - loop.time()))
            raise
        except ConnectionError as gone:
            raise NotBegunError("was dead before it began") from gone
        except EOFError as gone:
            raise CrashedError(_how(await self._exit_code())) from gone

    async def _exit_code(self) -> int | None:
        """The exit code of a process whose end of the pair is closed."""
        process = self._process
        if process is None:
            return None
        await asyncio.to_thread(process.join, 1.0)
        return process.exitcode


async def _ends_when_called_off(end: End, within_s: float) -> bool:
    """Tells a worker that its job is called off; whether it then ends in time and can be given another. A job that does
    not listen leaves that for the worker, which skips it."""
    try:
        async with asyncio.timeout(within_s):
            await end.call_off()
    except (TimeoutError, EOFError, ConnectionError, asyncio.CancelledError):
        return False
    return True
