"""The worker processes as the service sees them: admission in front, a wall clock behind, new ones for dead ones.

A request that is under way when its worker dies is tried again by itself, in a fresh worker. If that dies too, and the
next one, the request is shown to be the cause, and is quarantined.
"""

from __future__ import annotations

import asyncio
import errno
import logging
import os
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from functools import partial
from typing import Any

from assur.api.logs import LOGGER, event
from assur.api.problems import Problem
from assur.api.telemetry.meters import Meters, parent_of
from assur.api.telemetry.trace import current
from assur.api.web.settings import Settings
from assur.api.workers.admission import Admission, Places
from assur.api.workers.client import Client, Demand, Ticket
from assur.api.workers.end import Tell
from assur.api.workers.quarantine import Quarantine
from assur.api.workers.traced import Traced
from assur.api.workers.worker_process import (
    ENDS_S,
    NO_MEMORY,
    About,
    CrashedError,
    KilledError,
    Meaning,
    NotBegunError,
    WorkerProcess,
)

RETRIES = 2
"""So many fresh workers a request must end, after the first death, before it is quarantined."""
LONGEST_RETRY_S = 30.0
"""Longest pause between two attempts to start a worker that does not start, s."""


@dataclass(frozen=True, slots=True)
class Work:
    """What a worker is to do: the job and its arguments, and the digest of the request's body. `in_touch`: the last
    argument of the job is a `Line`, by which it tells how far it has come. `listens`: it asks there again and again
    whether it is called off; any other goes on when its client leaves, and its result is dropped. `leaves`: when it is
    called off it sends the `Answer` that there is by then, and has `check_s` for the step that it is at."""

    job: Callable[..., Any]
    arguments: tuple[Any, ...]
    key: str
    in_touch: bool = False
    listens: bool = False
    leaves: bool = False


class RecalledError(Exception):
    """The worker is wanted back that a long request has borrowed."""


class Workers:
    """The worker processes, and which are free. One per event loop; `start`, then any number of `run`, then `stop`."""

    def __init__(self, settings: Settings, warm: Callable[[], Any], meters: Meters | None = None) -> None:
        self._settings = settings
        self.meters = meters or Meters()
        self._processes = [
            WorkerProcess(settings.worker_mib, warm, settings.warm_s, partial(self._lost, number))
            for number in range(settings.processes + settings.simulation_workers)
        ]
        self.total = settings.processes
        """How many workers there are, without those for simulations."""
        self._free: set[int] = set()
        places = Places(
            settings.processes, settings.reserved, settings.queue, settings.queue_wait_s, settings.simulation_workers
        )
        self.admission = Admission(places, lambda: self._free)
        self._given: dict[Ticket, asyncio.Future[int]] = {}
        self._recalls: dict[Ticket, asyncio.Future[None]] = {}
        self._filling: set[int] = set()
        self._awaited: dict[int, asyncio.Future[None]] = {}
        self.quarantine = Quarantine(settings.quarantine_s)
        self._tasks: set[asyncio.Task[None]] = set()
        self._warmed: set[int] = set()
        self.trouble = ""
        """Why the last worker that was started did not start; empty once one did."""
        self._measure()

    def _measure(self) -> None:
        """Adds the workers, and the requests for them, to the metrics."""
        gauge, books = self.meters.gauge, self.admission
        gauge("assur_requests_waiting", "Requests that wait for a worker.", lambda: books.waiting)
        gauge("assur_requests_running", "Requests that a worker works on.", lambda: books.running)
        gauge("assur_owed_seconds", "What all accepted requests are expected to take yet, s.", lambda: books.owed_s)
        gauge("assur_workers", "Workers that there should be.", lambda: self.total)
        gauge(
            "assur_workers_ready",
            "Workers that can take a request, or work on one.",
            lambda: sum(process.open for process in self._processes[: self.total]),
        )
        gauge("assur_quarantined_requests", "Requests that are not tried again.", lambda: len(self.quarantine))
        self.meters.memory(self.processes)

    def processes(self) -> dict[str, int | None]:
        """The numbers of the web process, of each worker and of the template of the workers; None: not started yet."""
        workers = {f"worker-{number}": process.pid for number, process in enumerate(self._processes)}
        parents = {parent_of(pid) for pid in workers.values() if pid is not None} - {None, os.getpid(), 1}
        template = min(parents, default=None)  # type: ignore[type-var]
        return {"web": os.getpid(), "template": template, **workers}

    @property
    def ready(self) -> bool:
        """Whether every worker has planned once, and at least one is there now; those for simulations do not count."""
        return self.warmed == self.total and any(process.open for process in self._processes[: self.total])

    @property
    def warmed(self) -> int:
        """How many places have had a worker that planned."""
        return sum(number < self.total for number in self._warmed)

    def start(self) -> None:
        """Starts all workers in the background, but for those for simulations, which the first one starts; returns at
        once."""
        for number in range(self.total):
            self._refill(number)

    async def stop(self) -> None:
        """Ends all workers, whatever they do; the service has been drained before."""
        self._free.clear()  # none is replaced any more
        tasks = tuple(self._tasks)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        await asyncio.gather(*(process.stop() for process in self._processes))

    def require_room(self, client: Client, *, simulation: bool = False) -> None:
        """Raises the `Problem` of a client whose request would be turned away, whatever it is: too-many-requests,
        busy."""
        self.admission.require_room(client, simulation=simulation)

    def admit(self, demand: Demand) -> Ticket:
        """Accepts a request, which waits from now on: `run` it, or `give_up` its ticket. Raises `Problem`:
        too-many-requests, busy."""
        if demand.simulation:
            for number in range(self.total, len(self._processes)):
                if number not in self._warmed:
                    self._refill(number)
        ticket = self.admission.enter(demand)
        self._given[ticket] = asyncio.get_running_loop().create_future()
        self._hand_out()
        return ticket

    def give_up(self, ticket: Ticket) -> None:
        """Ends a ticket that was not run; one that has ended stays so."""
        given = self._given.pop(ticket, None)
        self.admission.leave(ticket)
        if given is not None and given.done() and not given.cancelled():
            self._leave(given.result())

    async def run(self, ticket: Ticket, work: Work, report: Tell | None = None) -> Any:
        """What the job of `work` returns in a worker, once it is the turn of `ticket`, which ends here. `report` takes
        how far the job has come. Cancelling it: as `WorkerProcess.run` has it.

        Raises `Problem`: busy, not-ready, quarantined, worker-crashed, worker-timeout.
        """
        number = None
        try:
            self.quarantine.refuse(work.key)
            while True:
                number = await self._number(ticket)
                current().queued_s = ticket.waited_s
                asyncio.get_running_loop().call_soon(self.meters.queued, ticket.waited_s)  # while the worker works
                try:
                    return await self._on(number, work, ticket, report)
                except RecalledError:
                    self._put_back(ticket, number)
        except asyncio.CancelledError:
            if number is not None and not self._processes[number].open and number not in self._filling:
                self.meters.restarted("called_off")
            raise
        except KilledError as killed:
            self.meters.restarted("time")
            wall_s = ticket.demand.wall_s
            event("worker killed: no end in time", logging.WARNING, wall_s=wall_s, digest=work.key)
            raise Problem("worker-timeout", f"It was given {wall_s:g} s, its budgets included.") from killed
        finally:
            self.give_up(ticket)

    async def _number(self, ticket: Ticket) -> int:
        """The number of the worker that is given to a ticket. It is given back when the ticket is given up."""
        late_s, given = self._settings.queue_wait_s, self._given[ticket]
        if given.done():
            return given.result()
        try:
            async with asyncio.timeout(None if ticket.demand.simulation else late_s):
                return await asyncio.shield(given)
        except TimeoutError as late:
            if not self.ready:
                raise Problem("not-ready", f"No worker was ready within {late_s:g} s.", again_s=5) from late
            raise self.admission.full() from late

    def _put_back(self, ticket: Ticket, number: int) -> None:
        """Has a request wait again, and frees the worker that it had borrowed."""
        self.admission.put_back(ticket)
        self._given[ticket] = asyncio.get_running_loop().create_future()
        self._leave(number)

    async def _on(self, number: int, work: Work, ticket: Ticket, report: Tell | None) -> Any:
        """What the job returns on worker `number`, or on fresh ones in its place. Raises `RecalledError`."""
        meanings: list[str] = []

        def hear(value: Any) -> None:
            if isinstance(value, Meaning):
                meanings.append(value.digest)
            elif report is not None:
                report(value)

        deaths, traced = 0, Traced(work.job, current().carried())
        while True:
            if ticket.borrows and ticket.recalled:
                raise RecalledError
            if not self._processes[number].open:
                await self._renewed(number)
            left_s = self.quarantine.left_s()
            about = About(left_s, suspect=deaths > 0, reported=report is not None) if work.in_touch else None
            try:
                wall_s = ticket.demand.wall_s
                ends_s = None if not work.listens else self._settings.check_s if work.leaves else ENDS_S
                running = self._processes[number].run(traced, work.arguments, wall_s, hear, about, ends_s=ends_s)
                return await (self._unless_recalled(ticket, running) if ticket.borrows else running)
            except NotBegunError:
                self.meters.restarted("idle")
                continue  # it had died before: nothing of this request has run
            except CrashedError as died:
                deaths += 1
                self.meters.restarted("memory" if died.how == NO_MEMORY else "crash")
                event("worker died", logging.ERROR, how=died.how, digest=work.key, suspect=deaths > 1)
                if deaths > RETRIES:
                    event("request quarantined", logging.ERROR, digest=work.key, for_s=self._settings.quarantine_s)
                    why = f"The last of {deaths} workers {died.how}. "
                    raise self.quarantine.add(work.key, *meanings, why=why) from died

    async def _unless_recalled(self, ticket: Ticket, running: Coroutine[Any, Any, Any]) -> Any:
        """What `running` returns. Raises `RecalledError` where the worker is wanted back; then it was called off."""
        task, recall = asyncio.ensure_future(running), asyncio.get_running_loop().create_future()
        self._recalls[ticket] = recall
        try:
            await asyncio.wait({task, recall}, return_when=asyncio.FIRST_COMPLETED)
            if task.done():
                return task.result()
        finally:
            del self._recalls[ticket]
            if not task.done():
                task.cancel()
                await asyncio.wait({task})
                if not task.cancelled():
                    task.exception()  # it ended by itself meanwhile, and is worked on again
        raise RecalledError

    async def _renewed(self, number: int) -> None:
        """Returns when place `number`, whose holder waits here, has a new worker."""
        self._awaited[number] = asyncio.get_running_loop().create_future()
        self._refill(number)
        within_s = self._settings.queue_wait_s
        try:
            async with asyncio.timeout(within_s):
                await self._awaited[number]
        except TimeoutError as late:
            detail = f"No other worker could be started within {within_s:g} s. Others may be served."
            raise Problem("worker-crashed", detail, again_s=5) from late
        finally:
            del self._awaited[number]

    def _lost(self, number: int) -> None:
        """Replaces a worker that died while it was free, so that no request has to wait for it."""
        if number in self._free:
            self.meters.restarted("idle")
            self._free.discard(number)
            self._refill(number)

    def _hand_out(self) -> None:
        """Gives free workers to those that wait; those that are kept for short requests are lent last."""
        if not self.admission.waiting:
            return
        for lend in (False, True):
            for number in sorted(self._free):
                ticket = self.admission.next(number, lend=lend)
                if ticket is not None:
                    self._free.discard(number)
                    self._given[ticket].set_result(number)
        recalled = self.admission.recall()
        if recalled is not None and recalled in self._recalls:
            self._recalls[recalled].set_result(None)

    def _leave(self, number: int) -> None:
        """Frees a worker that is well, and replaces any other."""
        process = self._processes[number]
        if process.open and process.jobs < self._settings.max_tasks:
            self._free.add(number)
        else:
            if process.open:
                self.meters.restarted("max_tasks")
            self._refill(number)
        self._hand_out()

    def _refill(self, number: int) -> None:
        """Gives place `number` a new worker, unless that is under way."""
        if number not in self._filling:
            self._filling.add(number)
            self._background(self._fill(number))

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
                break
        self.trouble = ""
        self._warmed.add(number)
        self._filling.discard(number)
        event("worker ready", worker=number, ready=self.ready)
        awaited = self._awaited.get(number)
        if awaited is None or awaited.done():
            self._free.add(number)
            self._hand_out()
        else:
            awaited.set_result(None)

    def _background(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._ended)

    def _ended(self, task: asyncio.Task[None]) -> None:
        self._tasks.discard(task)
        fault = None if task.cancelled() else task.exception()
        if fault is not None:
            LOGGER.error("looking after the workers met a fault", exc_info=fault)


# Why a worker does not start, and what an operator can do about it.

_FOLDERS = (
    "Planning reads the installed package and its compiled kernels (`assur kernels` makes them): "
    "see that both are there and readable, and that /tmp or /dev/shm can be written, where the socket is made by which "
    "workers are forked."
)
_SPACE = "Make room on the volume, or in /dev/shm, or mount a larger one."
_PROCESSES = "Raise the limit of processes and threads (pids_limit of the container), or lower ASSUR_WORKERS."
_FILES = "Raise the limit of open files, or lower ASSUR_CONNECTIONS."
_MEMORY = "Raise the limit of memory, or ASSUR_WORKER_MEMORY_MIB, or lower ASSUR_WORKERS."
WHAT_TO_DO = {
    errno.ENOENT: _FOLDERS,
    errno.EACCES: _FOLDERS,
    errno.EPERM: _FOLDERS,
    errno.EROFS: _FOLDERS,
    errno.ENOSYS: _FOLDERS,
    errno.ENOSPC: _SPACE,
    errno.EDQUOT: _SPACE,
    errno.EAGAIN: _PROCESSES,
    errno.EMFILE: _FILES,
    errno.ENFILE: _FILES,
    errno.ENOMEM: _MEMORY,
}
"""What an operator can do about an error of the system, by its number."""


def why_not_started(error: Exception) -> str:
    """Why a worker did not start, and what to do. It repeats only names of errors of the system."""
    cause = error if isinstance(error, OSError) else error.__cause__
    if not isinstance(cause, OSError):
        return str(error)
    name = errno.errorcode.get(cause.errno or 0, "no number")
    todo = WHAT_TO_DO.get(cause.errno or 0, "See what the system denies to this process, and allow it.")
    before = "its process was not made" if error is cause else str(error)
    return f"{before}: {type(cause).__name__} {name} ({cause.strerror}). {todo}"
