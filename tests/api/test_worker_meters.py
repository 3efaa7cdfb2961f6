"""What happens to workers is counted by cause, and why one does not start is told."""

from __future__ import annotations

import asyncio
import os
import signal
from functools import partial

import pytest

from assur.api.problems import Problem
from assur.api.telemetry.trace import CURRENT, Trace
from assur.api.web.settings import Settings
from assur.api.workers.pool import Workers
from tests.api.test_metrics import value
from tests.api.test_workers import ran, until

ONE = Settings(workers=1, queue=1, queue_wait_s=30.0, warm_s=60.0, max_tasks=2)


def measured(workers: Workers, name: str, **labels: str) -> float:
    return value(workers.meters.text().decode(), name, **labels)


def restarts(workers: Workers, cause: str) -> float:
    return measured(workers, "assur_worker_restarts_total", cause=cause)


def test_deaths_and_replacements_are_counted_each_by_its_cause() -> None:
    async def story() -> None:
        workers = Workers(ONE, os.getpid)
        workers.start()
        try:
            await until(lambda: workers.ready)
            assert measured(workers, "assur_workers_ready") == measured(workers, "assur_workers") == 1
            trace = Trace("id", "traceparent")
            CURRENT.set(trace)
            first = await ran(workers, os.getpid, (), "a", 30.0)
            assert trace.queued_s is not None
            assert workers.processes()["worker-0"] == first
            assert measured(workers, "assur_requests_running") == measured(workers, "assur_requests_waiting") == 0
            assert await ran(workers, os.getpid, (), "a", 30.0) == first
            assert restarts(workers, "max_tasks") == 1
            with pytest.raises(Problem, match="quarantined"):
                await ran(workers, os.abort, (), "b", 30.0)
            assert restarts(workers, "crash") == 3
            pid = await ran(workers, os.getpid, (), "a", 30.0)
            os.kill(pid, signal.SIGKILL)
            await until(lambda: restarts(workers, "idle") == 1)
            assert restarts(workers, "crash") == 3
        finally:
            await workers.stop()

    asyncio.run(story())


def test_what_the_system_denies_to_a_worker_is_told_counted_and_tried_again() -> None:
    async def story() -> None:
        workers = Workers(ONE, partial(os.stat, "/no/such/place"))
        workers.start()
        try:
            await until(lambda: restarts(workers, "start_failure") >= 2)
            assert "FileNotFoundError ENOENT (No such file or directory)" in workers.trouble
            assert "/dev/shm" in workers.trouble
            assert "/no/such/place" not in workers.trouble
            assert not workers.ready
        finally:
            await workers.stop()

    asyncio.run(story())
