"""Jobs over HTTP: a plan that is asked for now and fetched later, with its progress, by a real service."""

from __future__ import annotations

import asyncio
import copy
import json
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest

from assur.api.problems import Problem
from assur.api.web.job_store import JobStore
from assur.api.web.service import Order, Service
from assur.api.web.settings import Settings
from assur.api.workers import jobs
from assur.api.workers.client import Client, Demand
from assur.api.workers.pool import Work
from assur.scenes.requests import with_options
from tests.api.running import running
from tests.api.watched_jobs import deaf

pytestmark = pytest.mark.anyio

ANYONE = Client("anyone")


@pytest.fixture(scope="module")
def service() -> Iterator[httpx.Client]:
    """A client of a service with one worker, which keeps three jobs."""
    with running(Settings(workers=1, queue=2, max_budget_s=30.0, grace_s=30.0, jobs_kept=3)) as made:
        yield made


def long(request: dict[str, Any]) -> dict[str, Any]:
    """The request, searched for 30 s whatever is found."""
    lasting = copy.deepcopy(request)
    lasting["options"] = {"budget_s": 30.0, "stop": "budget"}
    return lasting


def started(service: httpx.Client, request: dict[str, Any]) -> str:
    response = service.post("/v1/jobs", json=request)
    assert response.status_code == 202
    told = response.json()
    assert told["state"] == "working"
    assert response.headers["location"] == f"jobs/{told['id']}"
    return str(response.url.join(response.headers["location"]).path)


def events(service: httpx.Client, job: str) -> Iterator[tuple[str, dict[str, Any]]]:
    with service.stream("GET", job + "/events") as stream:
        assert stream.headers["content-type"].startswith("text/event-stream")
        name = ""
        for line in stream.iter_lines():
            if line.startswith("event: "):
                name = line.removeprefix("event: ")
            elif line.startswith("data: "):
                yield name, json.loads(line.removeprefix("data: "))


def is_forgotten(service: httpx.Client, job: str) -> bool:
    """Whether a job that has ended is given once more when it is deleted, and is lost then."""
    last, once_more = service.get(job).json(), service.delete(job)
    gone = service.get(job)
    assert (once_more.status_code, once_more.json()) == (200, last)
    return (gone.status_code, gone.json()["type"]) == (404, "urn:assur:problem:job-lost")


def test_a_job_ends_with_the_answer_that_a_plan_would_have(service: httpx.Client, small: dict[str, Any]) -> None:
    at_once = service.post("/v1/plans", json=small).json()
    job = started(service, small)
    told = list(events(service, job))
    assert [name for name, _ in told][-1] == "done"
    assert {name for name, _ in told[:-1]} <= {"working"}
    last = told[-1][1]
    assert last == service.get(job).json()
    assert (last["state"], last["outcome"], last["problem"]) == ("done", "planned", None)
    assert last["progress"]["candidates"] >= 1
    answer = service.get(job + "/answer").json()
    assert {**answer, "elapsed_s": 0, "first_s": 0} == {**at_once, "elapsed_s": 0, "first_s": 0}
    assert is_forgotten(service, job)


def test_progress_is_told_while_the_search_goes_on(service: httpx.Client, small: dict[str, Any]) -> None:
    job = started(service, with_options(long(small), {"report": "full"}))
    seen: list[dict[str, Any]] = []
    for name, document in events(service, job):
        if document["progress"] is not None:
            seen.append(document["progress"])
        if len(seen) == 5 and name == "working":
            assert service.get(job + "/answer").status_code == 409
            assert service.delete(job).json()["state"] == "cancelled"
    assert len(seen) >= 5
    assert [each["candidates"] for each in seen] == sorted(each["candidates"] for each in seen)
    assert seen[-1]["duration_s"] >= seen[-1]["lower_bound_s"] >= 0


def test_a_job_that_is_called_off_leaves_its_worker_to_others(service: httpx.Client, small: dict[str, Any]) -> None:
    job = started(service, long(small))
    while service.get(job).json()["progress"] is None:
        time.sleep(0.02)
    told = service.delete(job).json()
    assert told["state"] == "cancelled"
    # the search goes on for a round, and what it says of itself is not the job's any more
    for _ in range(10):
        time.sleep(0.05)
        assert service.get(job).json() == told
    none = service.get(job + "/answer")
    assert (none.status_code, none.json()["type"]) == (409, "urn:assur:problem:job-not-done")
    assert "was called off" in none.json()["detail"]
    assert "retry-after" not in none.headers
    assert [name for name, _ in events(service, job)] == ["cancelled"]
    assert is_forgotten(service, job)
    # the only worker plans the next request; a new one would first have to load its libraries, and nothing be ready
    assert service.post("/v1/plans", json=small).json()["status"] == "planned"
    assert service.get("/readyz").status_code == 200


def test_a_job_of_a_bad_request_fails_with_its_problem(service: httpx.Client, small: dict[str, Any]) -> None:
    small["robot"] = {"model": "no-such-robot"}
    job = started(service, small)
    assert [name for name, _ in events(service, job)][-1] == "failed"
    told = service.get(job).json()
    assert told["problem"]["status"] == 422
    answer = service.get(job + "/answer")
    assert (answer.status_code, answer.json()) == (422, told["problem"])


@pytest.mark.parametrize("body", [b'{"scenario": "no-such-scenario"}', b'{"options": {"budget_s": 31}}'])
def test_what_can_be_refused_at_once_is_no_job(service: httpx.Client, body: bytes) -> None:
    response = service.post("/v1/jobs", content=body, headers={"Content-Type": "application/json"})
    assert response.status_code == 422
    assert response.headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize(
    "body", [b"", b"{", b"[]", b"no", b'{"a": NaN}', b'{"a": 1, "a": 2}', b"\xff", b'"' + b"x" * 50000]
)
def test_what_is_no_json_object_is_refused_as_a_plan_would_be(service: httpx.Client, body: bytes) -> None:
    headers = {"Content-Type": "application/json"}
    as_job, as_plan = (service.post(to, content=body, headers=headers) for to in ("/v1/jobs", "/v1/plans"))
    assert as_job.status_code == (422 if body == b"[]" else 400)
    assert (as_job.status_code, as_job.json()) == (as_plan.status_code, as_plan.json())


def test_every_job_that_is_accepted_at_the_same_time_has_a_place(service: httpx.Client, small: dict[str, Any]) -> None:
    def post(_: int) -> httpx.Response:
        return service.post("/v1/jobs", json=long(small))

    with ThreadPoolExecutor(24) as clients:
        responses = list(clients.map(post, range(24)))
    taken = [f"/v1/jobs/{each.json()['id']}" for each in responses if each.status_code == 202]
    refused = [each for each in responses if each.status_code != 202]
    assert (len(taken), len(refused)) == (3, 21)
    assert {(each.status_code, each.json()["type"]) for each in refused} == {(503, "urn:assur:problem:busy")}
    assert all(int(each.headers["retry-after"]) >= 1 for each in refused)
    assert [service.get(job).json()["state"] for job in taken] == ["working"] * 3
    for job in taken:
        assert service.delete(job).json()["state"] == "cancelled"
    # their places are free again
    assert service.post("/v1/plans", json=small).json()["status"] == "planned"
    assert list(events(service, started(service, small)))[-1][0] == "done"


@pytest.mark.parametrize("name", ["x", "0" * 32, "..%2f..", "%00"])
@pytest.mark.parametrize("end", ["", "/answer", "/events"])
def test_a_job_that_is_not_there_is_lost(service: httpx.Client, name: str, end: str) -> None:
    response = service.get(f"/v1/jobs/{name}{end}")
    assert response.status_code == 404


def test_only_so_many_jobs_wait_and_only_so_many_are_kept(service: httpx.Client, small: dict[str, Any]) -> None:
    running_jobs = [started(service, long(small)) for _ in range(3)]
    refused = service.post("/v1/jobs", json=small)
    assert (refused.status_code, refused.json()["type"]) == (503, "urn:assur:problem:busy")
    assert int(refused.headers["retry-after"]) >= 1
    for job in running_jobs:
        assert service.delete(job).status_code == 200
    ended = []
    for _ in range(4):
        ended.append(started(service, small))
        list(events(service, ended[-1]))
    assert service.get(ended[0]).status_code == 404
    assert [service.get(job).json()["state"] for job in ended[1:]] == ["done"] * 3


def test_a_client_that_leaves_the_events_does_not_end_the_job(service: httpx.Client, small: dict[str, Any]) -> None:
    job = started(service, long(small))
    for _ in events(service, job):
        break
    assert service.get(job).json()["state"] == "working"
    assert service.delete(job).status_code == 200


def test_a_client_that_leaves_its_plan_costs_no_worker(service: httpx.Client, small: dict[str, Any]) -> None:
    with pytest.raises(httpx.ReadTimeout):
        service.post("/v1/plans", json=long(small), timeout=0.5)
    # long before 30 s, and by the same worker
    assert service.post("/v1/plans", json=small, timeout=20.0).json()["status"] == "planned"
    assert service.get("/readyz").status_code == 200


async def test_jobs_that_come_before_any_has_begun_have_places_of_their_own() -> None:
    service = Service(Settings(workers=1, queue=2))  # its workers are not started: every job waits
    work = Work(lambda: Problem("fault", "not to be reached"), (), "")
    store, order = JobStore(service), Order(work, Demand(ANYONE, 30.0, short=True, kind="test"))
    taken = [store.start(order) for _ in range(2)]
    with pytest.raises(Problem, match="busy"):
        store.start(order)
    assert store.cancel(taken[0].id, ANYONE).state == "cancelled"  # before it has begun
    await asyncio.gather(*(job.work for job in taken[:1] if job.work is not None), return_exceptions=True)
    await asyncio.sleep(0)
    taken.append(store.start(order))
    await store.stop()
    await asyncio.sleep(0)
    assert {job.state for job in taken} == {"cancelled"}
    service.workers.require_room(ANYONE)
    assert service.workers.admission.waiting == 0


async def test_the_end_of_the_service_does_not_wait_for_an_answer_that_a_job_would_leave(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("assur.api.web.job_store.ENDS_S", 0.05)
    service = Service(Settings(workers=1, check_s=600.0))
    service.workers.start()
    store, work = JobStore(service), Work(deaf, (), "deaf", in_touch=True, listens=True, leaves=True)
    try:
        async with asyncio.timeout(300.0):  # a guard against a hang: the job would have 600 s
            job = store.start(Order(work, Demand(ANYONE, 600.0, short=True, kind="test")))
            while job.progress is None:
                await asyncio.sleep(0.02)
            await store.stop()
    finally:
        await service.workers.stop()
    assert (job.state, job.answer) == ("cancelled", None)


async def test_a_client_whose_jobs_end_in_numbers_drives_out_its_own_first() -> None:
    store = JobStore(Service(Settings(workers=1, queue=99, jobs_kept=3)))  # its workers are not started
    work = Work(lambda: Problem("fault", "not to be reached"), (), "")

    async def ended(client: Client) -> str:
        job = store.start(Order(work, Demand(client, 30.0, short=True, kind="test")))
        store.cancel(job.id, client)
        assert job.work is not None
        await asyncio.gather(job.work, return_exceptions=True)
        await asyncio.sleep(0)
        return job.id

    mine, other = Client("mine"), Client("other")
    first = await ended(mine)
    theirs = [await ended(other) for _ in range(10)]
    assert store.get(first, mine).state == "cancelled"
    assert [job for job in theirs if job in store] == theirs[-2:]
    mine_too = [await ended(mine) for _ in range(2)]
    assert [job for job in (first, *theirs, *mine_too) if job in store] == [theirs[-1], *mine_too]


def test_a_check_of_a_large_body_does_not_count_as_short() -> None:
    async def asked(size: int) -> Demand:
        service = Service(Settings(workers=2))
        seen: list[Order] = []

        async def do(order: Order) -> Any:
            seen.append(order)

        service.do = do  # type: ignore[method-assign, assignment]
        await service.quick(jobs.check, ANYONE, b" " * size)
        return seen[0].demand

    small, large = asyncio.run(asked(1 << 20)), asyncio.run(asked((1 << 20) + 1))
    assert (small.short, large.short) == (True, False)
    assert small.kind != large.kind
