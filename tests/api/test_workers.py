"""Real worker processes with plain jobs: what happens to one happens to one request."""

from __future__ import annotations

import asyncio
import os
import signal
import time
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import psutil
import pytest

from assur.api.problems import Problem
from assur.api.web.settings import Settings
from assur.api.workers.pool import Workers
from assur.api.workers.worker_process import WorkerProcess
from tests.api.watched_jobs import counting, deaf, until_called_off

SETTINGS = Settings(workers=2, queue=1, queue_wait_s=30.0, warm_s=60.0, max_tasks=1000)


def with_workers(settings: Settings, story: Callable[[Workers], Awaitable[None]]) -> None:
    """Tells `story` with workers that have all started, and stops them."""

    async def tell() -> None:
        workers = Workers(settings, os.getpid)
        workers.start()
        try:
            await until(lambda: workers.ready)
            await story(workers)
        finally:
            await workers.stop()

    asyncio.run(tell())


async def until(true: Callable[[], bool], within_s: float = 60.0) -> None:
    """Waits for something that a process does."""
    async with asyncio.timeout(within_s):
        while not true():
            await asyncio.sleep(0.02)


@dataclass
class Held:
    """A job that runs until it is released: it reads a pipe to which nobody has written yet."""

    pipe: Path
    end: int = -1

    def job(self, workers: Workers) -> asyncio.Task[Any]:
        """The job, given to a worker; it returns what `release` writes."""
        return asyncio.create_task(workers.run(Path.read_bytes, (self.pipe,), "held", 90.0))

    async def begun(self) -> None:
        """Returns when the job runs: a pipe can be opened for writing only once it is read."""
        while self.end < 0:
            try:
                self.end = os.open(self.pipe, os.O_WRONLY | os.O_NONBLOCK)
            except OSError:
                await asyncio.sleep(0.01)

    def release(self) -> None:
        os.write(self.end, b"released")
        os.close(self.end)


@pytest.fixture
def held(tmp_path: Path) -> Held:
    os.mkfifo(tmp_path / "pipe")
    return Held(tmp_path / "pipe")


async def pid_of(workers: Workers, key: str = "pid") -> int:
    pid: int = await workers.run(os.getpid, (), key, 30.0)
    return pid


async def refused(work: Awaitable[Any]) -> Problem:
    with pytest.raises(Problem) as caught:
        await work
    return caught.value


def alive(pid: int) -> bool:
    try:
        return bool(psutil.Process(pid).status() != psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return False


def is_ready(workers: Workers) -> bool:
    """Asked anew each time, whatever a type checker believes to know from before."""
    return workers.ready


def is_full(workers: Workers) -> bool:
    return workers.full


def test_jobs_run_in_processes_of_their_own_at_the_same_time(held: Held) -> None:
    async def story(workers: Workers) -> None:
        job = held.job(workers)
        await held.begun()
        assert await pid_of(workers) != os.getpid()
        assert not job.done()
        held.release()
        assert await job == b"released"

    with_workers(SETTINGS, story)


@pytest.mark.parametrize(("job", "stays"), [(until_called_off, True), (deaf, False)])
def test_a_job_that_is_called_off_keeps_its_worker_if_it_ends_soon(job: Callable[..., Any], stays: bool) -> None:
    """... and the next job is not told what the first one was."""

    async def story(workers: Workers) -> None:
        told: list[int] = []
        working = asyncio.create_task(workers.run(job, (), "watched", 90.0, told.append))
        await until(lambda: bool(told))
        working.cancel()
        with pytest.raises(asyncio.CancelledError):
            await working
        assert (await pid_of(workers) == told[0]) == stays
        assert told == told[:1]

    with_workers(replace(SETTINGS, workers=1), story)


def test_what_a_job_tells_arrives_in_order_and_before_its_result() -> None:
    async def story(workers: Workers) -> None:
        told: list[int] = []
        assert await workers.run(counting, (500,), "counting", 90.0, told.append) == 500
        assert told == list(range(500))
        assert await pid_of(workers) > 0

    with_workers(SETTINGS, story)


def test_workers_are_not_ready_before_every_one_has_planned_once() -> None:
    async def tell() -> None:
        workers = Workers(SETTINGS, os.getpid)
        assert not is_ready(workers)
        workers.start()
        seen = set()
        while not is_ready(workers):
            seen.add(workers.warmed)
            await asyncio.sleep(0.005)
        assert max(seen) < 2
        assert workers.warmed == 2
        await workers.stop()

    asyncio.run(tell())


def test_workers_whose_first_plan_fails_are_never_ready_and_take_no_job() -> None:
    async def tell() -> None:
        workers = Workers(Settings(workers=1, queue_wait_s=2.0), os.abort)
        workers.start()
        problem = await refused(workers.run(os.getpid, (), "x", 1.0))
        assert problem.kind == "not-ready"
        assert not is_ready(workers)
        await workers.stop()

    asyncio.run(tell())


def test_a_killed_worker_costs_its_own_request_only_and_is_replaced(held: Held) -> None:
    async def story(workers: Workers) -> None:
        innocent = held.job(workers)
        await held.begun()
        victim = await pid_of(workers)
        guilty = asyncio.create_task(workers.run(time.sleep, (60.0,), "guilty", 90.0))
        await asyncio.sleep(0.3)
        os.kill(victim, signal.SIGKILL)
        problem = await refused(guilty)
        assert problem.kind == "worker-crashed"
        assert "SIGKILL" in problem.detail
        assert await pid_of(workers) != victim
        assert not innocent.done()
        held.release()
        assert await innocent == b"released"

    with_workers(SETTINGS, story)


@pytest.mark.parametrize("number", [signal.SIGSEGV, signal.SIGABRT])
def test_a_crash_inside_a_library_is_told_by_its_signal(number: signal.Signals) -> None:
    async def story(workers: Workers) -> None:
        problem = await refused(workers.run(signal.raise_signal, (number,), "crash", 30.0))
        assert problem.kind == "worker-crashed"
        assert number.name in problem.detail
        assert await pid_of(workers)

    with_workers(Settings(workers=1), story)


def test_a_worker_that_ends_by_itself_without_a_word_is_a_crash_too() -> None:
    async def story(workers: Workers) -> None:
        problem = await refused(workers.run(os._exit, (3,), "exit", 30.0))
        assert "exit code 3" in problem.detail
        assert await pid_of(workers)

    with_workers(Settings(workers=1), story)


@pytest.mark.parametrize(
    ("job", "argument"), [(time.sleep, 60.0), (signal.raise_signal, signal.SIGSTOP)], ids=["asleep", "deaf to signals"]
)
def test_a_job_that_does_not_end_is_killed_and_the_next_is_served(job: Callable[..., Any], argument: Any) -> None:
    async def story(workers: Workers) -> None:
        stuck = await pid_of(workers)
        problem = await refused(workers.run(job, (argument,), "stuck", 0.5))
        assert problem.kind == "worker-timeout"
        assert await pid_of(workers) != stuck
        assert not alive(stuck)

    with_workers(Settings(workers=1), story)


def test_a_worker_that_does_not_read_its_job_is_killed_too() -> None:
    async def story(workers: Workers) -> None:
        stuck = await pid_of(workers)
        os.kill(stuck, signal.SIGSTOP)
        problem = await refused(workers.run(len, (bytes(20 << 20),), "unread", 0.5))
        assert problem.kind == "worker-timeout"
        assert await pid_of(workers) != stuck

    with_workers(Settings(workers=1), story)


def test_what_a_job_raises_is_raised_here_and_its_worker_goes_on() -> None:
    async def story(workers: Workers) -> None:
        pid = await pid_of(workers)
        with pytest.raises(ZeroDivisionError):
            await workers.run(divmod, (1, 0), "raises", 30.0)
        assert await pid_of(workers) == pid

    with_workers(Settings(workers=1), story)


def test_a_job_whose_caller_has_gone_is_killed() -> None:
    async def story(workers: Workers) -> None:
        pid = await pid_of(workers)
        job = asyncio.create_task(workers.run(time.sleep, (60.0,), "gone", 90.0))
        await asyncio.sleep(0.3)
        job.cancel()
        await until(lambda: not alive(pid))
        assert await pid_of(workers) != pid
        assert not is_full(workers)

    with_workers(Settings(workers=1), story)


def test_a_short_job_whose_caller_has_gone_ends_and_costs_no_worker() -> None:
    async def story(workers: Workers) -> None:
        pid = await pid_of(workers)
        for _ in range(5):
            job = asyncio.create_task(workers.run(time.sleep, (0.2,), "gone", 90.0))
            await asyncio.sleep(0.05)
            job.cancel()
            with pytest.raises(asyncio.CancelledError):
                await job
            assert await pid_of(workers) == pid
        assert not is_full(workers)

    with_workers(Settings(workers=1), story)


def test_one_request_more_than_workers_and_queue_is_told_when_to_come_again(held: Held) -> None:
    async def story(workers: Workers) -> None:
        running = held.job(workers)
        waiting = asyncio.create_task(pid_of(workers))
        await held.begun()
        assert is_full(workers)
        problem = await refused(pid_of(workers))
        assert problem.kind == "busy"
        assert 1 <= int(problem.headers["Retry-After"]) <= 60
        held.release()
        assert await running == b"released"
        assert await waiting
        assert not is_full(workers)
        assert await pid_of(workers)

    with_workers(Settings(workers=1, queue=1), story)


def test_a_request_that_waited_too_long_for_a_worker_is_told_so(held: Held) -> None:
    async def story(workers: Workers) -> None:
        first = held.job(workers)
        await held.begun()
        assert (await refused(pid_of(workers))).kind == "busy"
        held.release()
        assert await first == b"released"
        assert await pid_of(workers)

    with_workers(Settings(workers=1, queue=1, queue_wait_s=0.5), story)


def test_a_request_that_crashed_two_workers_is_not_given_a_third_and_others_are_served() -> None:
    async def story(workers: Workers) -> None:
        for _ in range(2):
            crashed = await refused(workers.run(signal.raise_signal, (signal.SIGSEGV,), "bad", 30.0))
            assert crashed.kind == "worker-crashed"
        before = await pid_of(workers)
        quarantined = await refused(workers.run(signal.raise_signal, (signal.SIGSEGV,), "bad", 30.0))
        assert quarantined.kind == "quarantined"
        assert quarantined.status == 422
        assert await pid_of(workers) == before

    with_workers(Settings(workers=1), story)


def test_a_worker_that_dies_while_idle_is_replaced_before_anyone_asks() -> None:
    async def story(workers: Workers) -> None:
        pid = await pid_of(workers)
        os.kill(pid, signal.SIGKILL)
        await until(lambda: not is_ready(workers))
        await until(lambda: workers.ready)
        assert await pid_of(workers) not in (0, pid)

    with_workers(Settings(workers=1), story)


def test_a_request_in_the_moment_after_an_idle_worker_died_is_served() -> None:
    async def story(workers: Workers) -> None:
        pid = await pid_of(workers)
        os.kill(pid, signal.SIGKILL)
        assert await pid_of(workers) != pid

    with_workers(Settings(workers=1), story)


def test_a_worker_is_replaced_after_its_share_of_jobs() -> None:
    async def story(workers: Workers) -> None:
        pids = [await pid_of(workers) for _ in range(4)]
        assert pids[0] == pids[1] != pids[2] == pids[3]

    with_workers(Settings(workers=1, max_tasks=2), story)


def test_a_worker_is_deaf_to_the_signals_that_stop_the_service(held: Held) -> None:
    async def story(workers: Workers) -> None:
        pid = await pid_of(workers)
        job = held.job(workers)
        await held.begun()
        os.kill(pid, signal.SIGTERM)
        os.kill(pid, signal.SIGINT)
        held.release()
        assert await job == b"released"
        assert await pid_of(workers) == pid

    with_workers(Settings(workers=1), story)


def test_a_worker_cannot_take_more_memory_than_it_was_given() -> None:
    async def tell() -> None:
        process = WorkerProcess(512, os.getpid, 60.0)
        await process.start()
        with pytest.raises(MemoryError):
            await process.run(bytearray, (1 << 30,), 30.0)
        await process.stop()

    asyncio.run(tell())


def test_a_large_result_and_a_large_argument_pass_through() -> None:
    async def story(workers: Workers) -> None:
        data = os.urandom(1 << 20) * 20
        assert await workers.run(bytes.__add__, (data, b"x"), "large", 60.0) == data + b"x"

    with_workers(Settings(workers=1), story)


def test_when_stopped_no_process_is_left() -> None:
    before = set(psutil.Process().children(recursive=True))
    seen: list[int] = []

    async def story(workers: Workers) -> None:
        seen.append(await pid_of(workers))

    with_workers(Settings(workers=1), story)
    assert not alive(seen[0])
    left = set(psutil.Process().children(recursive=True)) - before
    assert [child.pid for child in left if "spawn_main" in " ".join(child.cmdline())] == []
