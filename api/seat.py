"""One worker process, in a Pebble pool of its own: what happens to it happens to one request.

In a pool that workers share, one that is killed while it holds the pipe poisons the others, and an idle one that dies
breaks the pool for good (`BrokenProcessPool: All workers expired`). Here the pool of a worker that crashed, was
killed or was cancelled is thrown away with it, and a worker takes requests only after it has planned once.
"""

from __future__ import annotations

import asyncio
import errno
import multiprocessing
import resource
import signal
from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from typing import Any

import pebble

TERMINATE_S = 0.1
"""How long Pebble waits between SIGTERM, which our workers ignore, and SIGKILL, s."""
BACKSTOP_S = 5.0
"""Time beyond the wall after which a worker is given up even if Pebble has not killed it, s."""


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
    """Runs first in a new worker: bounds its address space and makes it deaf to SIGTERM.

    A service manager may signal the whole group: the web process then drains, and its workers must go on meanwhile.
    """
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    size = memory_mib << 20
    resource.setrlimit(resource.RLIMIT_AS, (size, size))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _how(code: int | None) -> str:
    if code is not None and code < 0:
        with suppress(ValueError):
            return f"was killed by {signal.Signals(-code).name}"
    return "ended for want of memory" if code == errno.ENOMEM else f"ended with exit code {code}"


class Seat:
    """A place for one worker process. Not `open` until it has planned once; not for two jobs at a time."""

    def __init__(self, memory_mib: int, warm: Callable[[], Any], warm_s: float) -> None:
        self._memory_mib = memory_mib
        self._warm = warm
        self._warm_s = warm_s
        self._pool: pebble.ProcessPool | None = None
        self._spoilt = False
        self.jobs = 0
        """Jobs that this worker has been given since it was started."""

    @property
    def open(self) -> bool:
        """Whether a job may be given to it: its process is there, has planned once and has not been spoilt."""
        return self._pool is not None and not self._spoilt and self._pool.active

    async def start(self) -> None:
        """Replaces the worker by a new one, and has it plan once.

        Raises `CrashedError` or `KilledError` when that fails.
        """
        await self.stop()
        pebble.CONSTS.term_timeout = TERMINATE_S
        pool = pebble.ProcessPool(
            max_workers=1,
            initializer=prepare,
            initargs=(self._memory_mib,),
            context=multiprocessing.get_context("spawn"),
        )
        try:
            await asyncio.to_thread(_launch, pool)
            await self._run(pool, self._warm, (), self._warm_s)
        except BaseException as failed:
            await _dispose(pool)
            if isinstance(failed, Exception) and not isinstance(failed, CrashedError | KilledError):
                raise CrashedError(f"its first plan raised {type(failed).__name__}") from failed
            raise
        self._pool, self._spoilt, self.jobs = pool, False, 0

    async def run(self, job: Callable[..., Any], arguments: tuple[Any, ...], wall_s: float) -> Any:
        """What `job(*arguments)` returns in the worker. Both are pickled; `job` must not raise.

        Raises `CrashedError` when the worker dies and `KilledError` when it is killed after `wall_s`; after these,
        and when cancelled, the seat is closed until `start` is called again.
        """
        if self._pool is None:
            raise NotBegunError("was not started")
        self.jobs += 1
        try:
            return await self._run(self._pool, job, arguments, wall_s)
        except BaseException:
            self._spoilt = True
            raise

    async def stop(self) -> None:
        """Ends the worker, at once and whatever it does."""
        pool, self._pool = self._pool, None
        if pool is not None:
            await _dispose(pool)

    @staticmethod
    async def _run(pool: pebble.ProcessPool, job: Callable[..., Any], arguments: tuple[Any, ...], wall_s: float) -> Any:
        try:
            async with asyncio.timeout(wall_s + BACKSTOP_S):
                # a pool that runs only puts it in its queue
                return await asyncio.wrap_future(pool.schedule(job, args=arguments, timeout=wall_s))
        except pebble.ProcessExpired as expired:
            raise CrashedError(_how(expired.exitcode)) from expired
        except TimeoutError as late:
            raise KilledError(f"no result after {wall_s:g} s") from late
        except (BrokenProcessPool, RuntimeError) as broken:
            raise NotBegunError("was dead before it began") from broken


def _launch(pool: pebble.ProcessPool) -> bool:
    """Starts the process of a new pool, which takes a while."""
    return bool(pool.active)


async def _dispose(pool: pebble.ProcessPool) -> None:
    """Ends a pool and its process, off the event loop: joining waits for Pebble's threads."""
    pool.stop()  # type: ignore[no-untyped-call]
    await asyncio.shield(asyncio.to_thread(pool.join))
