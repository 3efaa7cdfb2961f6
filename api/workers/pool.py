"""The worker processes as the service sees them: a bounded queue in front, a wall clock behind, new ones for dead ones.

Admission is counted here: at most `workers + queue` requests are accepted at a time, one more is told when to come
again. A request that crashed two workers is not given a third.
"""

from __future__ import annotations

import asyncio
import logging
import math
import time
from collections import OrderedDict
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from typing import Any

from assur.api.logs import LOGGER, event
from assur.api.problems import Problem
from assur.api.telemetry.meters import Meters, Readings
from assur.api.telemetry.trace import current
from assur.api.web.settings import Settings
from assur.api.workers.worker_process import (
    NO_MEMORY,
    CrashedError,
    KilledError,
    NotBegunError,
    Tell,
    WorkerProcess,
    why_not_started,
)

CRASHES = 2
"""So many crashes and a request is quarantined."""
REMEMBERED = 1000
"""So many crashed requests are remembered, the oldest forgotten first."""
PATROL_S = 1.0
"""How often idle workers are looked after, s."""
LONGEST_RETRY_S = 30.0
"""Longest pause between two attempts to start a worker that does not start, s."""


@dataclass(eq=False)
class Place:
    """A place in the queue: its request counts as accepted until it is given up. `wall_s`: as of the request, s."""

    wall_s: float
    held: bool = True


class Workers:
    """The worker processes, and which are free. One per event loop; `start`, then any number of `run`, then `stop`."""

    def __init__(self, settings: Settings, warm: Callable[[], Any], meters: Meters | None = None) -> None:
        self._settings = settings
        self.meters = meters or Meters()
        self.meters.workers(self.readings)
        self._processes = [
            WorkerProcess(settings.worker_memory_mib, warm, settings.warm_s) for _ in range(settings.processes)
        ]
        self._free: asyncio.Queue[int] = asyncio.Queue()
        self._crashes: OrderedDict[str, int] = OrderedDict()
        self._tasks: set[asyncio.Task[None]] = set()
        self._accepted = 0
        self._owed_s = 0.0
        self._warmed: set[int] = set()
        self._running = 0
        self.trouble = ""
        """Why the last worker that was started did not start; empty once one did."""

    def readings(self) -> Readings:
        """The workers as they are now, for the metrics."""
        quarantined = sum(count >= CRASHES for count in self._crashes.values())
        processes = tuple(process.pid for process in self._processes)
        return Readings(
            waiting=max(0, self._accepted - self._running),
            running=self._running,
            owed_s=max(0.0, self._owed_s),
            ready=sum(process.open for process in self._processes),
            total=len(self._processes),
            quarantined=quarantined,
            processes=processes,
        )

    @property
    def ready(self) -> bool:
        """Whether every worker has planned once, and at least one is there now."""
        return self.warmed == len(self._processes) and any(process.open for process in self._processes)

    @property
    def warmed(self) -> int:
        """How many places have had a worker that planned."""
        return len(self._warmed)

    @property
    def total(self) -> int:
        """How many workers there are."""
        return len(self._processes)

    @property
    def full(self) -> bool:
        """Whether one more request would be turned away."""
        return self._accepted >= len(self._processes) + self._settings.queue

    def start(self) -> None:
        """Starts all workers in the background; returns at once."""
        for number, _ in enumerate(self._processes):
            self._background(self._fill(number))
        self._background(self._patrol())

    async def stop(self) -> None:
        """Ends all workers, whatever they do; the service has been drained before."""
        tasks = tuple(self._tasks)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        await asyncio.gather(*(process.stop() for process in self._processes))

    def busy(self) -> Problem:
        """The problem of a request that finds the queue full: when the accepted ones will have ended at the latest."""
        after = min(60, max(1, math.ceil(self._owed_s / len(self._processes))))
        return Problem("busy", f"Come again in {after} s.", headers={"Retry-After": str(after)})

    def admit(self, wall_s: float) -> Place:
        """Accepts a request now that is run later, or not at all: `give_up` the place then. Raises `Problem`: busy."""
        if self.full:
            raise self.busy()
        self._accepted += 1
        self._owed_s += wall_s
        return Place(wall_s)

    def give_up(self, place: Place) -> None:
        """Frees a place; what is free already stays so."""
        if place.held:
            place.held = False
            self._accepted -= 1
            self._owed_s -= place.wall_s

    async def run(
        self,
        job: Callable[..., Any],
        arguments: tuple[Any, ...],
        key: str,
        wall_s: float,
        told: Tell | None = None,
        place: Place | None = None,
    ) -> Any:
        """What `job(*arguments)` returns in a worker; `key` is the digest of the request, for the quarantine. `told`,
        and what cancelling does: as `WorkerProcess.run` has it. `place`: the caller's, who gives it up; None: one is
        taken now, and given up at the end.

        Raises `Problem`: busy, not-ready, quarantined, worker-crashed, worker-timeout.
        """
        if self._crashes.get(key, 0) >= CRASHES:
            raise Problem("quarantined", f"It did so {CRASHES} times. Tell us, and change it before you send it again.")
        own = self.admit(wall_s) if place is None else None
        try:
            try:
                return await self._in_a_process(job, arguments, wall_s, told)
            except NotBegunError:
                self.meters.restarted("idle")
                return await self._in_a_process(job, arguments, wall_s, told)
        except CrashedError as crashed:
            raise self._crashed(key, crashed) from crashed
        except KilledError as killed:
            self.meters.restarted("time")
            event("worker killed: no end in time", logging.WARNING, wall_s=wall_s, digest=key)
            raise Problem("worker-timeout", f"It was given {wall_s:g} s, its budgets included.") from killed
        finally:
            if own is not None:
                self.give_up(own)

    async def _in_a_process(
        self, job: Callable[..., Any], arguments: tuple[Any, ...], wall_s: float, told: Tell | None
    ) -> Any:
        asked = time.monotonic()
        number = await self._free_process()
        current().queued_s = waited = time.monotonic() - asked
        self.meters.queued(waited)
        self._running += 1
        try:
            return await self._processes[number].run(job, arguments, wall_s, told)
        except asyncio.CancelledError:
            if not self._processes[number].open:
                self.meters.restarted("called_off")
            raise
        finally:
            self._running -= 1
            self._leave(number)

    async def _free_process(self) -> int:
        """The number of a free worker, first come first served."""
        try:
            async with asyncio.timeout(self._settings.queue_wait_s):
                while True:
                    number = await self._free.get()
                    if self._processes[number].open:
                        return number
                    self.meters.restarted("idle")
                    self._background(self._fill(number))
        except TimeoutError as late:
            raise Problem(
                "busy" if self.ready else "not-ready",
                f"No worker became free within {self._settings.queue_wait_s:g} s.",
                headers={"Retry-After": "5"},
            ) from late

    def _leave(self, number: int) -> None:
        """Frees a worker that is well, and replaces any other."""
        process = self._processes[number]
        if process.open and process.jobs < self._settings.max_tasks:
            self._free.put_nowait(number)
        else:
            if process.open:
                self.meters.restarted("max_tasks")
            self._background(self._fill(number))

    def _crashed(self, key: str, crashed: CrashedError) -> Problem:
        count = self._crashes.pop(key, 0) + 1
        self._crashes[key] = count
        while len(self._crashes) > REMEMBERED:
            self._crashes.popitem(last=False)
        self.meters.restarted("memory" if crashed.how == NO_MEMORY else "crash")
        event("worker crashed", logging.ERROR, how=crashed.how, digest=key, times=count)
        return Problem(
            "worker-crashed",
            f"Its process {crashed.how}; nothing was planned. Other requests are not touched.",
            headers={"Retry-After": "1"},
        )

    async def _fill(self, number: int) -> None:
        """Gives place `number` a new worker, and tries again until one has planned."""
        pause = 1.0
        while True:
            try:
                await self._processes[number].start()
            except (CrashedError, KilledError, OSError) as failed:
                self.trouble = why_not_started(failed)
                self.meters.restarted("start_failure")
                event("worker does not start", logging.ERROR, why=self.trouble, again_in_s=pause)
                await asyncio.sleep(pause)
                pause = min(2 * pause, LONGEST_RETRY_S)
            else:
                self.trouble = ""
                self._warmed.add(number)
                self._free.put_nowait(number)
                event("worker ready", worker=number, ready=self.ready)
                return

    async def _patrol(self) -> None:
        """Replaces workers that died while idle, so that no request has to wait for it."""
        while True:
            await asyncio.sleep(PATROL_S)
            for number in [self._free.get_nowait() for _ in range(self._free.qsize())]:
                if not self._processes[number].open:
                    self.meters.restarted("idle")
                self._leave(number)

    def _background(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._ended)

    def _ended(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        fault = None if task.cancelled() else task.exception()
        if fault is not None:
            LOGGER.error("looking after the workers met a fault", exc_info=fault)
