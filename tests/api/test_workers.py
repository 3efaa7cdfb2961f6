"""Real worker processes with plain jobs: what happens to one happens to one request."""

from __future__ import annotations

import asyncio
import errno
import os
import signal
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import psutil
import pytest

from assur.api.problems import Problem
from assur.api.telemetry.trace import CURRENT, Trace
from assur.api.web.settings import Settings
from assur.api.workers import quarantine, worker_process
from assur.api.workers.client import Client, Demand
from assur.api.workers.pool import Work, Workers
from assur.api.workers.worker_process import NAME, CrashedError, KilledError, NotBegunError, WorkerProcess
from tests.api.test_metrics import value
from tests.api.watched_jobs import (
    all_but_the_last,
    counting,
    deaf,
    dies_unless,
    leaving,
    recalled_once,
    until_called_off,
)

SETTINGS = Settings(workers=2, queue=1, queue_wait_s=30.0, warm_s=60.0, max_tasks=1000)
ONE = replace(SETTINGS, workers=1)
pytestmark = pytest.mark.anyio
ANYONE = Client("anyone")


async def ran(
    workers: Workers,
    job: Callable[..., Any],
    arguments: tuple[Any, ...],
    key: str,
    wall_s: float,
    told: Callable[[Any], None] | None = None,
    *,
    client: Client = ANYONE,
    short: bool = True,
) -> Any:
    """What a job returns; one that tells is in touch, and listens."""
    ticket, tells = workers.admit(Demand(client, wall_s, short, kind="test")), told is not None
    return await workers.run(ticket, Work(job, arguments, key, in_touch=tells, listens=tells), told)


def with_workers(settings: Settings) -> pytest.MarkDecorator:
    """A test gets workers with these settings, and not with `ONE`."""
    return pytest.mark.parametrize("workers", [settings], indirect=True)


@asynccontextmanager
async def starting(settings: Settings, warm: Callable[[], Any] = os.getpid) -> AsyncIterator[Workers]:
    """Workers that start; they are stopped with the block."""
    made = Workers(settings, warm)
    assert not made.ready
    made.start()
    try:
        yield made
    finally:
        await made.stop()


@pytest.fixture
async def workers(request: pytest.FixtureRequest) -> AsyncIterator[Workers]:
    """Workers that have all started."""
    async with starting(getattr(request, "param", ONE)) as made:
        await until(lambda: made.ready)
        yield made


async def until(true: Callable[[], bool], within_s: float = 150.0) -> None:
    """Waits for something that a process does."""
    async with asyncio.timeout(within_s):
        while not true():
            await asyncio.sleep(0.02)


@dataclass
class Held:
    """A job that runs until it is released: it reads a pipe to which nobody has written yet."""

    pipe: Path
    end: int = -1

    def job(self, workers: Workers, *, short: bool = True) -> asyncio.Task[Any]:
        """The job, given to a worker; it returns what `release` writes."""
        return asyncio.create_task(ran(workers, Path.read_bytes, (self.pipe,), "held", 90.0, short=short))

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
    pid: int = await ran(workers, os.getpid, (), key, 30.0)
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
    try:
        workers.require_room(ANYONE)
    except Problem as problem:
        return problem.kind == "busy"
    return False


@with_workers(SETTINGS)
async def test_jobs_run_in_processes_of_their_own_at_the_same_time(workers: Workers, held: Held) -> None:
    job = held.job(workers)
    await held.begun()
    assert await pid_of(workers) != os.getpid()
    assert not job.done()
    held.release()
    assert await job == b"released"


@pytest.mark.parametrize(("job", "stays"), [(until_called_off, True), (deaf, False)])
async def test_a_job_that_is_called_off_keeps_its_worker_if_it_ends_soon(
    workers: Workers, job: Callable[..., Any], stays: bool
) -> None:
    """... and the next job is not told what the first one was."""
    told: list[int] = []
    working = asyncio.create_task(ran(workers, job, (), "watched", 90.0, told.append))
    await until(lambda: bool(told))
    working.cancel()
    with pytest.raises(asyncio.CancelledError):
        await working
    assert (await pid_of(workers) == told[0]) == stays
    assert told == told[:1]


@pytest.mark.parametrize("leaves", [True, False])
async def test_a_job_that_leaves_an_answer_has_time_for_the_step_that_it_is_at(
    workers: Workers, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, leaves: bool
) -> None:
    monkeypatch.setattr("assur.api.workers.pool.ENDS_S", 0.02)
    step, told = tmp_path / "step", list[Any]()
    ticket = workers.admit(Demand(ANYONE, 90.0, short=True, kind="test"))
    work = Work(leaving, (str(step),), "leaving", in_touch=True, listens=True, leaves=leaves)
    working = asyncio.create_task(workers.run(ticket, work, told.append))
    await until(lambda: bool(told))
    working.cancel()
    await asyncio.sleep(0.2)
    step.touch()
    with pytest.raises(asyncio.CancelledError):
        await working
    assert told[1:] == (["what there is"] if leaves else [])
    assert (await pid_of(workers) == told[0]) == leaves


@with_workers(replace(ONE, check_s=0.1))
async def test_a_job_that_leaves_no_answer_in_time_loses_its_worker(workers: Workers) -> None:
    told = list[Any]()
    ticket = workers.admit(Demand(ANYONE, 90.0, short=True, kind="test"))
    work = Work(deaf, (), "deaf", in_touch=True, listens=True, leaves=True)
    working = asyncio.create_task(workers.run(ticket, work, told.append))
    await until(lambda: bool(told))
    working.cancel()
    with pytest.raises(asyncio.CancelledError):
        await working
    assert await pid_of(workers) != told[0]


async def test_a_job_that_does_not_listen_goes_on_when_its_client_leaves_and_keeps_its_worker(
    workers: Workers, held: Held, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker_process, "ENDS_S", 0.02)

    pid = await pid_of(workers)
    job = held.job(workers)
    await held.begun()
    job.cancel()
    await asyncio.sleep(10 * worker_process.ENDS_S)
    assert not job.done()
    held.release()
    with pytest.raises(asyncio.CancelledError):
        await job
    assert await pid_of(workers) == pid


async def test_a_job_that_does_not_listen_is_killed_at_its_own_limit_when_its_client_has_left(workers: Workers) -> None:
    pid = await pid_of(workers)
    job = asyncio.create_task(ran(workers, time.sleep, (600.0,), "asleep", 1.0))
    await until(lambda: workers.admission.running == 1)
    job.cancel()
    with pytest.raises(asyncio.CancelledError):
        await job
    await until(lambda: not alive(pid))
    assert await pid_of(workers) != pid
    assert not is_full(workers)


@with_workers(SETTINGS)
async def test_what_a_job_tells_arrives_in_order_and_before_its_result(workers: Workers) -> None:
    told: list[int] = []
    assert await ran(workers, counting, (500,), "counting", 90.0, told.append) == 500
    assert told == list(range(500))
    assert await pid_of(workers) > 0


async def test_workers_are_not_ready_before_every_one_has_planned_once() -> None:
    async with starting(SETTINGS) as workers:
        seen = set()
        while not is_ready(workers):
            seen.add(workers.warmed)
            await asyncio.sleep(0.005)
        assert max(seen) < 2
        assert workers.warmed == 2


async def test_workers_whose_first_plan_fails_are_never_ready_and_take_no_job() -> None:
    async with starting(Settings(workers=1, queue_wait_s=2.0), os.abort) as workers:
        problem = await refused(ran(workers, os.getpid, (), "x", 1.0))
        assert problem.kind == "not-ready"
        assert not is_ready(workers)


async def test_a_killed_worker_costs_nothing_but_time_and_its_request_is_tried_again(
    workers: Workers, held: Held
) -> None:
    victim = await pid_of(workers)
    job = held.job(workers)
    await held.begun()
    os.kill(victim, signal.SIGKILL)
    await until(lambda: not alive(victim))
    # the next worker may read the pipe by now: while an end is open to write, it waits
    again = Held(held.pipe)
    await again.begun()
    os.close(held.end)
    again.release()
    assert await job == b"released"
    assert await pid_of(workers) != victim


@pytest.mark.parametrize(
    ("job", "argument", "how"),
    [
        (signal.raise_signal, signal.SIGSEGV, "SIGSEGV"),
        (signal.raise_signal, signal.SIGABRT, "SIGABRT"),
        (os._exit, 3, "exit code 3"),
        (os._exit, errno.ENOMEM, "want of memory"),
    ],
)
async def test_a_request_that_ends_every_worker_is_quarantined_and_told_by_what(
    workers: Workers, job: Callable[..., Any], argument: int, how: str
) -> None:
    problem = await refused(ran(workers, job, (argument,), "bad", 30.0))
    assert problem.kind == "quarantined"
    assert f"The last of 3 workers {'ended' if 'S' not in how else 'was'}" in problem.detail
    assert how in problem.detail
    assert int(problem.headers["Retry-After"]) == 600
    before = await pid_of(workers)
    assert (await refused(ran(workers, job, (argument,), "bad", 30.0))).kind == "quarantined"
    assert await pid_of(workers) == before  # it was not given a fourth


@pytest.mark.parametrize("deaths", [1, 2])
async def test_a_request_that_a_fresh_worker_serves_is_not_the_cause(
    workers: Workers, deaths: int, tmp_path: Path
) -> None:
    told: list[Any] = []
    for _ in range(3):
        (tmp_path / "deaths").write_text(str(deaths), encoding="utf-8")
        assert await ran(workers, dies_unless, (str(tmp_path),), "same body", 90.0, told.append) == "planned"
    assert told == []  # what a request means is for the service alone


@pytest.mark.slow
@with_workers(Settings(workers=1, quarantine_s=10.0))
async def test_a_request_in_quarantine_is_known_by_its_meaning_and_forgotten_in_time(
    workers: Workers, tmp_path: Path
) -> None:
    async def asked(key: str) -> Any:
        return await ran(workers, dies_unless, (str(tmp_path),), key, 90.0, lambda _: None)

    (tmp_path / "deaths").write_text("3", encoding="utf-8")
    assert (await refused(asked("a body"))).kind == "quarantined"
    worker = await pid_of(workers)
    assert (await refused(asked("another body"))).kind == "quarantined"
    assert await pid_of(workers) == worker
    await until(lambda: len(workers.quarantine) == 0)
    assert await asked("a body") == "planned"


def test_of_too_many_requests_in_quarantine_the_one_to_be_freed_first_is_forgotten(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(quarantine, "MOST", 2)
    now = iter(range(100))
    kept = quarantine.Quarantine(50.0, lambda: float(next(now)))
    for keys in (("a", "b"), ("a",), ("c",)):
        assert kept.add(*keys).kind == "quarantined"
    assert set(kept.left_s()) == {"a", "c"}


@pytest.mark.parametrize(
    ("job", "argument"), [(time.sleep, 60.0), (signal.raise_signal, signal.SIGSTOP)], ids=["asleep", "deaf to signals"]
)
async def test_a_job_that_does_not_end_is_killed_and_the_next_is_served(
    workers: Workers, job: Callable[..., Any], argument: Any
) -> None:
    stuck = await pid_of(workers)
    problem = await refused(ran(workers, job, (argument,), "stuck", 0.5))
    assert problem.kind == "worker-timeout"
    assert await pid_of(workers) != stuck
    assert not alive(stuck)


async def test_a_worker_that_does_not_read_its_job_is_killed_too(workers: Workers) -> None:
    stuck = await pid_of(workers)
    os.kill(stuck, signal.SIGSTOP)
    problem = await refused(ran(workers, len, (bytes(20 << 20),), "unread", 0.5))
    assert problem.kind == "worker-timeout"
    assert await pid_of(workers) != stuck


async def test_what_a_job_raises_is_raised_here_and_its_worker_goes_on(workers: Workers) -> None:
    pid = await pid_of(workers)
    with pytest.raises(ZeroDivisionError):
        await ran(workers, divmod, (1, 0), "raises", 30.0)
    assert await pid_of(workers) == pid


async def test_a_short_job_whose_caller_has_gone_ends_and_costs_no_worker(workers: Workers) -> None:
    pid = await pid_of(workers)
    for _ in range(5):
        job = asyncio.create_task(ran(workers, time.sleep, (0.2,), "gone", 90.0))
        await asyncio.sleep(0.05)
        job.cancel()
        with pytest.raises(asyncio.CancelledError):
            await job
        assert await pid_of(workers) == pid
    assert not is_full(workers)


@with_workers(Settings(workers=1, queue=1))
async def test_one_request_more_than_workers_and_queue_is_told_when_to_come_again(workers: Workers, held: Held) -> None:
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


@with_workers(Settings(workers=1, queue=1, queue_wait_s=0.5))
async def test_a_request_that_waited_too_long_for_a_worker_is_told_so(workers: Workers, held: Held) -> None:
    first = held.job(workers)
    await held.begun()
    assert (await refused(pid_of(workers))).kind == "busy"
    held.release()
    assert await first == b"released"
    assert await pid_of(workers)


@with_workers(SETTINGS)
async def test_a_long_job_gives_back_the_worker_that_it_has_borrowed_and_is_done_again(
    workers: Workers, held: Held, tmp_path: Path
) -> None:
    first = held.job(workers, short=False)
    await held.begun()  # on the worker for all; the next long one borrows the other
    second = asyncio.create_task(
        ran(workers, recalled_once, (str(tmp_path / "begun"),), "long", 90.0, lambda _: None, short=False)
    )
    await until((tmp_path / "begun").exists)
    assert await pid_of(workers) > 0  # a short one is served at once
    assert not first.done()
    assert not second.done()
    (tmp_path / "begun").unlink()
    held.release()
    assert await first == b"released"
    await until((tmp_path / "begun").exists)  # the second has begun again, on the worker for all
    assert await pid_of(workers) > 0  # and keeps it, for there is another for short ones
    assert not second.done()
    second.cancel()
    with pytest.raises(asyncio.CancelledError):
        await second


@pytest.mark.parametrize("noticed", [True, False])
async def test_a_worker_that_dies_while_idle_is_replaced_and_the_next_request_is_served(
    workers: Workers, *, noticed: bool
) -> None:
    pid = await pid_of(workers)
    os.kill(pid, signal.SIGKILL)
    if noticed:
        await until(lambda: restarts(workers, "idle") == 1.0)
        await until(lambda: workers.ready)
    assert await pid_of(workers) not in (0, pid)


@pytest.mark.parametrize(("begins", "error"), [(True, CrashedError), (False, NotBegunError)])
async def test_a_worker_that_is_gone_is_known_to_have_begun_its_job_or_not(
    held: Held, begins: bool, error: type[CrashedError]
) -> None:
    process = WorkerProcess(512, os.getpid, 60.0, lambda: None)
    await process.start()
    try:
        if not begins:
            psutil.Process(process.pid).suspend()
        running = asyncio.create_task(process.run(Path.read_bytes, (held.pipe,), 60.0))
        await (held.begun() if begins else asyncio.sleep(0.1))
        psutil.Process(process.pid).kill()
        with pytest.raises(CrashedError) as raised:
            await running
        assert type(raised.value) is error
        assert not process.open
    finally:
        await process.stop()


@with_workers(Settings(workers=1, max_tasks=2))
async def test_a_worker_is_replaced_after_its_share_of_jobs(workers: Workers) -> None:
    pids = [await pid_of(workers) for _ in range(4)]
    assert pids[0] == pids[1] != pids[2] == pids[3]


async def test_a_worker_is_deaf_to_the_signals_that_stop_the_service(workers: Workers, held: Held) -> None:
    pid = await pid_of(workers)
    job = held.job(workers)
    await held.begun()
    os.kill(pid, signal.SIGTERM)
    os.kill(pid, signal.SIGINT)
    held.release()
    assert await job == b"released"
    assert await pid_of(workers) == pid


async def test_each_job_has_its_own_time_whatever_the_jobs_before_had() -> None:
    process = WorkerProcess(512, os.getpid, 60.0, lambda: None)
    await process.start()
    try:
        await process.run(os.getpid, (), 0.2)
        await process.run(time.sleep, (0.6,), 60.0)  # its time begins while that of the job before is not over
        assert process.open
        with pytest.raises(KilledError):
            await process.run(time.sleep, (60.0,), 0.2)
        assert not process.open
    finally:
        await process.stop()


async def test_a_worker_cannot_take_more_memory_than_it_was_given() -> None:
    process = WorkerProcess(512, os.getpid, 60.0, lambda: None)
    await process.start()
    with pytest.raises(MemoryError):
        await process.run(bytearray, (1 << 30,), 30.0)
    await process.stop()


@pytest.mark.slow
async def test_a_worker_gives_back_what_a_large_job_took(workers: Workers) -> None:
    worker = psutil.Process(await pid_of(workers))
    before = worker.memory_info().rss
    assert await ran(workers, all_but_the_last, (200,), "large", 60.0) == worker.pid
    await until(lambda: worker.memory_info().rss < before + (32 << 20))


async def test_a_large_result_and_a_large_argument_pass_through(workers: Workers) -> None:
    data = os.urandom(1 << 20) * 20
    assert await ran(workers, bytes.__add__, (data, b"x"), "large", 60.0) == data + b"x"


async def test_when_stopped_no_process_is_left() -> None:
    before = set(psutil.Process().children(recursive=True))
    async with starting(ONE) as workers:
        pid = await pid_of(workers)
    assert not alive(pid)
    left = set(psutil.Process().children(recursive=True)) - before
    assert [child.pid for child in left if child.name() == NAME.decode()] == []


def measured(workers: Workers, name: str, **labels: str) -> float:
    return value(workers.meters.text().decode(), name, **labels)


def restarts(workers: Workers, cause: str) -> float:
    return measured(workers, "assur_worker_restarts_total", cause=cause)


@with_workers(replace(ONE, max_tasks=2))
async def test_deaths_and_replacements_are_counted_each_by_its_cause(workers: Workers) -> None:
    assert measured(workers, "assur_workers_ready") == measured(workers, "assur_workers") == 1
    trace = Trace("id", "traceparent")
    CURRENT.set(trace)
    first = await pid_of(workers)
    assert trace.queued_s is not None
    assert workers.processes()["worker-0"] == first
    assert measured(workers, "assur_requests_running") == measured(workers, "assur_requests_waiting") == 0
    assert await pid_of(workers) == first
    assert restarts(workers, "max_tasks") == 1
    assert (await refused(ran(workers, os.abort, (), "b", 30.0))).kind == "quarantined"
    assert restarts(workers, "crash") == 3
    pid = await pid_of(workers)
    os.kill(pid, signal.SIGKILL)
    await until(lambda: restarts(workers, "idle") == 1)
    assert restarts(workers, "crash") == 3


async def test_what_the_system_denies_to_a_worker_is_reported_counted_and_tried_again() -> None:
    async with starting(ONE, partial(os.stat, "/no/such/place")) as workers:
        await until(lambda: restarts(workers, "start_failure") >= 2)
        assert "FileNotFoundError ENOENT (No such file or directory)" in workers.trouble
        assert "/dev/shm" in workers.trouble
        assert "/no/such/place" not in workers.trouble
        assert not workers.ready
