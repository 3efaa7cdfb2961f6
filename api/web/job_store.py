"""Jobs: plans and simulations that are worked on while their client is elsewhere. It can read how far they have come.

A job lives in this process: after a restart it is lost. A finished one is kept for a stated time, and as long as not
too many others have finished since.
"""

from __future__ import annotations

import asyncio
import secrets
from collections import Counter
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from typing import Any, Literal

from assur.api.logs import LOGGER
from assur.api.problems import Problem
from assur.api.web.service import Order, Service
from assur.api.workers import jobs
from assur.api.workers.client import Client, Ticket
from assur.api.workers.worker_process import ENDS_S

State = Literal["working", "done", "failed", "cancelled"]
"""Whether a job is waited for or worked on, has an answer, ended with a problem, or was called off."""


@dataclass(eq=False)
class Job:
    """A job, and what has become of it: how far it has come, its answer or its problem."""

    id: str
    client: Client
    leaves: bool = False
    """When it is called off, it ends after its worker has sent the answer that there is by then."""
    state: State = "working"
    progress: dict[str, Any] | None = None
    answer: jobs.Answer | None = None
    problem: Problem | None = None
    _changed: asyncio.Event = field(default_factory=asyncio.Event)
    _changes: int = 0
    work: asyncio.Task[None] | None = None

    def document(self) -> dict[str, Any]:
        """The job as a document, without its answer."""
        outcome = None if self.answer is None or self.state == "working" else self.answer.outcome
        problem = None if self.problem is None else self.problem.document()
        return {
            "id": self.id, "state": self.state, "progress": self.progress, "outcome": outcome, "problem": problem
        }  # fmt: skip

    def change(self) -> None:
        """Wakes all who wait for news."""
        self._changes += 1
        self._changed.set()
        self._changed = asyncio.Event()

    async def news(self, longest_s: float) -> AsyncIterator[bool]:
        """Yields at once, and then whenever something has changed, until the job has ended: True; False where nothing
        has changed for `longest_s`, s. The last one is of the job's end, whenever that is."""
        seen, ended = -1, False
        while not ended:
            if seen == self._changes:
                try:
                    async with asyncio.timeout(longest_s):
                        await self._changed.wait()
                except TimeoutError:
                    yield False
                    continue
            seen, ended = self._changes, self.state != "working"
            yield True


class JobStore:
    """The jobs of one service. Where too many have ended, the oldest of the client goes that has most."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._jobs: dict[str, Job] = {}

    def start(self, order: Order) -> Job:
        """A new job. Raises `Problem` where the service is busy."""
        ticket = self._service.workers.admit(order.demand)  # before anything is promised
        replica = self._service.settings.replica
        name = f"{replica}-{secrets.token_hex(16)}" if replica else secrets.token_hex(16)
        job = Job(name, order.demand.client, order.work.leaves)
        self._jobs[job.id] = job
        job.work = asyncio.get_running_loop().create_task(self._run(job, order, ticket))
        job.work.add_done_callback(lambda _: self._ended(job, ticket))  # also of a task that never began
        return job

    def __contains__(self, name: str) -> bool:
        """Whether there is a job of this id, whosever it is."""
        return name in self._jobs

    def __len__(self) -> int:
        """How many jobs are worked on or kept."""
        return len(self._jobs)

    def get(self, name: str, client: Client) -> Job:
        """A client's job by its id. Raises `Problem` for one that this process does not have, and for one that was
        started with another key."""
        job = self._jobs.get(name)
        if job is None or (self._service.settings.keys_file and job.client.name != client.name):
            kept = self._service.settings.job_kept_s
            raise Problem(
                "job-lost",
                f"This process has no such job: it ended more than {kept:g} s ago, was deleted, was taken by another "
                "process, or was lost when the service was started anew. Send its request again.",
            )
        return job

    def cancel(self, name: str, client: Client) -> Job:
        """Calls a job off that still runs, and keeps it as one that was called off; forgets one that has ended. A job
        that leaves an answer is still working until that is there.

        Raises `Problem`.
        """
        job = self.get(name, client)
        if job.state != "working":
            del self._jobs[name]
            return job
        if not job.leaves:
            job.state = "cancelled"
        if job.work is not None and not job.work.cancelling():  # the second time its worker would be killed
            job.work.cancel()
        job.change()
        return job

    async def stop(self) -> None:
        """Calls off what still runs."""
        running = [job.work for job in self._jobs.values() if job.work is not None]
        for work in running:
            work.cancel()
        if running:
            _, late = await asyncio.wait(running, timeout=ENDS_S)
            for work in late:  # nobody can fetch the answer that it would leave: its worker is killed
                work.cancel()
        await asyncio.gather(*running, return_exceptions=True)

    async def _run(self, job: Job, order: Order, ticket: Ticket) -> None:
        def report(sent: dict[str, Any] | jobs.Answer) -> None:
            if isinstance(sent, jobs.Answer):
                job.answer = sent
            elif job.state == "working":
                job.progress = sent
                job.change()

        try:
            answer = await self._service.do(order, report, ticket)
        except Problem as problem:
            self._end(job, "failed", problem=problem)
        except Exception:  # noqa: BLE001 - reported with the job, and logged
            self._service.meters.faults.inc()
            LOGGER.exception("a job met a fault")
            self._end(job, "failed", problem=Problem("fault", "The service met a fault of its own; it is logged."))
        else:
            self._end(job, "done", answer=answer)

    @staticmethod
    def _end(job: Job, state: State, *, answer: jobs.Answer | None = None, problem: Problem | None = None) -> None:
        """Says what has become of a job, unless it was called off: that has been reported."""
        if job.state == "working":
            job.state, job.answer, job.problem = state, answer or job.answer, problem

    def _ended(self, job: Job, ticket: Ticket) -> None:
        """Gives up the ticket of a job that has ended; keeps the job for a time, and not more than so many."""
        self._service.workers.give_up(ticket)
        self._end(job, "cancelled")
        job.change()
        settings = self._service.settings
        ended = [each for each in self._jobs.values() if each.state != "working"]
        while len(ended) > settings.jobs_kept:
            of = Counter(each.client.name for each in ended)
            oldest = next(each for each in ended if of[each.client.name] == max(of.values()))
            ended.remove(oldest)
            self._jobs.pop(oldest.id, None)
        asyncio.get_running_loop().call_later(settings.job_kept_s, self._jobs.pop, job.id, None)
