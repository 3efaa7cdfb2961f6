"""Jobs: plans that are worked on while their client is elsewhere. Who asks is told how far they have come.

A job lives in this process: after a restart it is lost. A finished one is kept for a stated time, and as long as not
too many others have finished since.
"""

from __future__ import annotations

import asyncio
import secrets
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from typing import Any, Literal

from assur.api.logs import LOGGER
from assur.api.problems import Problem
from assur.api.web.service import Order, Service
from assur.api.workers import jobs

State = Literal["working", "done", "failed", "cancelled"]
"""Whether a job is waited for or worked on, has an answer, ended with a problem, or was called off."""


@dataclass(eq=False)
class Job:
    """A job, and what has become of it: how far it has come, its answer or its problem."""

    id: str
    state: State = "working"
    progress: dict[str, Any] | None = None
    answer: jobs.Answer | None = None
    problem: Problem | None = None
    _changed: asyncio.Event = field(default_factory=asyncio.Event)
    _changes: int = 0
    work: asyncio.Task[None] | None = None

    def document(self) -> dict[str, Any]:
        """What is told of it, without its answer."""
        outcome = None if self.answer is None else self.answer.outcome
        problem = None if self.problem is None else self.problem.document()
        return {
            "id": self.id, "state": self.state, "progress": self.progress, "outcome": outcome, "problem": problem
        }  # fmt: skip

    def change(self) -> None:
        """Wakes whoever waits for news."""
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
    """The jobs of one service."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._jobs: dict[str, Job] = {}

    def start(self, order: Order) -> Job:
        """A new job. Raises `Problem` where the service is busy."""
        if self._service.workers.full:
            raise self._service.workers.busy()
        job = Job(secrets.token_hex(16))
        self._jobs[job.id] = job
        job.work = asyncio.get_running_loop().create_task(self._run(job, order))
        return job

    def __getitem__(self, name: str) -> Job:
        """A job by its id. Raises `Problem` for one that this process does not have."""
        job = self._jobs.get(name)
        if job is None:
            kept = self._service.settings.job_kept_s
            raise Problem(
                "job-lost",
                f"This process has no such job: it ended more than {kept:g} s ago, was taken by another process, or "
                "was lost when the service was started anew. Send its request again.",
            )
        return job

    def cancel(self, name: str) -> Job:
        """Calls a job off, if it still runs, and forgets its answer. Raises `Problem`."""
        job = self[name]
        if job.work is not None:
            job.work.cancel()
        if job.state == "working":
            job.state = "cancelled"
            job.change()
        del self._jobs[name]
        return job

    async def stop(self) -> None:
        """Calls off what still runs."""
        running = [job.work for job in self._jobs.values() if job.work is not None]
        for work in running:
            work.cancel()
        await asyncio.gather(*running, return_exceptions=True)

    async def _run(self, job: Job, order: Order) -> None:
        def told(progress: dict[str, Any]) -> None:
            job.progress = progress
            job.change()

        try:
            job.answer = await self._service.do(order, told)
            job.state = "done"
        except Problem as problem:
            job.problem, job.state = problem, "failed"
        except asyncio.CancelledError:
            job.state = "cancelled"
            raise
        except Exception:  # noqa: BLE001 - told to whoever asks for the job, and logged
            LOGGER.exception("a job met a fault")
            job.problem, job.state = Problem("fault", "The service met a fault of its own; it is logged."), "failed"
        finally:
            job.change()
            self._retire(job)

    def _retire(self, job: Job) -> None:
        """Keeps a job that has ended for a time, and not more than so many."""
        settings = self._service.settings
        ended = [each for each in self._jobs.values() if each.state != "working"]
        for each in ended[: max(0, len(ended) - settings.jobs_kept)]:
            self._jobs.pop(each.id, None)
        asyncio.get_running_loop().call_later(settings.job_kept_s, self._jobs.pop, job.id, None)
