"""Answers that are given again: only where the same request would get them, and only for as long as was said."""

from __future__ import annotations

import asyncio
import copy
import json
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import httpx
import pytest
from starlette.requests import Request
from starlette.responses import Response

from assur.api.problems import Problem
from assur.api.telemetry.meters import Meters
from assur.api.web.idempotency import Idempotency
from assur.api.workers import jobs
from assur.api.workers.jobs import FIRST_PLAN
from assur.api.workers.results import BESIDE_BYTES, Results
from tests.api.running import PATIENT, running

pytestmark = pytest.mark.anyio

MADE = jobs.Answer(b"x" * 100, "planned", repeatable=True)


@pytest.fixture(scope="module")
def keeping() -> Iterator[httpx.Client]:
    """A client of a service that keeps answers."""
    with running(replace(PATIENT, results_mib=1)) as made:
        yield made


def test_the_same_request_gets_the_same_bytes_and_is_told_their_age(keeping: httpx.Client) -> None:
    began = time.monotonic()
    first = keeping.post("/v1/plans", json=FIRST_PLAN)
    again = keeping.post("/v1/plans", json=FIRST_PLAN)
    assert "x-cache" not in first.headers
    assert again.headers["x-cache"] == "hit"
    time.sleep(1.1)
    age = int(keeping.post("/v1/plans", json=FIRST_PLAN).headers["age"])
    assert int(again.headers["age"]) < age <= time.monotonic() - began
    assert "server-timing" not in again.headers
    assert again.content == first.content
    other = keeping.post("/v1/plans", json=FIRST_PLAN, params={"certificate": "digest"})
    assert "x-cache" not in other.headers


def test_what_the_clock_cut_is_not_kept(keeping: httpx.Client) -> None:
    request = copy.deepcopy(FIRST_PLAN)
    request["options"] = {"budget_s": 0.2, "stop": "budget", "elbow": "auto"}
    answers = [keeping.post("/v1/plans", json=request) for _ in range(2)]
    assert all(answer.json()["cut_by_clock"] for answer in answers)
    assert not any("x-cache" in answer.headers for answer in answers)


def test_what_was_used_longest_ago_goes_when_there_is_no_room() -> None:
    kept = Results(2 * (100 + BESIDE_BYTES), "build", Meters())
    for body in (b"a", b"b"):
        kept.keep(jobs.plan, (body, "full"), MADE)
    assert kept.find(jobs.plan, (b"a", "full")) is not None
    kept.keep(jobs.plan, (b"c", "full"), MADE)
    assert kept.find(jobs.plan, (b"b", "full")) is None
    assert kept.find(jobs.plan, (b"a", "full")) is not None
    assert kept.bytes == 2 * (100 + BESIDE_BYTES)


def test_nothing_is_kept_that_is_off_too_large_not_repeatable_or_no_plan() -> None:
    off, on = Results(0, "build", Meters()), Results(1200, "build", Meters())
    off.keep(jobs.plan, (b"a", "full"), MADE)
    on.keep(jobs.plan, (b"a", "full"), replace(MADE, repeatable=False))
    on.keep(jobs.plan, (b"b", "full"), replace(MADE, body=b"x" * 1000))
    on.keep(jobs.check, (b"c",), MADE)
    assert off.bytes == on.bytes == 0
    assert on.find(jobs.check, (b"c",)) is None


def test_parts_of_a_request_do_not_run_into_each_other() -> None:
    kept = Results(1 << 20, "build", Meters())
    kept.keep(jobs.plan, (b"ab", "c"), MADE)
    assert kept.find(jobs.plan, (b"a", "bc")) is None
    assert kept.find(jobs.plan_shipped, (b"ab", "c")) is None


def test_the_same_key_is_the_same_job_and_another_body_is_refused(client: httpx.Client, small: dict[str, Any]) -> None:
    sent = [client.post("/v1/jobs", json=small, headers={"Idempotency-Key": '"one"'}) for _ in range(2)]
    assert [answer.status_code for answer in sent] == [202, 202]
    assert sent[0].headers["location"] == sent[1].headers["location"]
    assert [answer.headers.get("idempotent-replayed") for answer in sent] == [None, "true"]
    small["options"]["seed"] = 7
    other = client.post("/v1/jobs", json=small, headers={"Idempotency-Key": "one"})
    assert (other.status_code, other.json()["type"]) == (422, "urn:assur:problem:key-reused")
    plan = client.post("/v1/plans", json=small, headers={"Idempotency-Key": "one"})
    assert plan.status_code == 200, "a key belongs to its address"
    again = client.post("/v1/plans", json=small, headers={"Idempotency-Key": "one"})
    assert again.content == plan.content
    parameters = client.post("/v1/plans?certificate=digest", json=small, headers={"Idempotency-Key": "one"})
    assert parameters.status_code == 422


def test_a_request_that_met_a_problem_may_be_sent_again(client: httpx.Client, small: dict[str, Any]) -> None:
    key = {"Idempotency-Key": "problem"}
    assert client.post("/v1/plans", json={}, headers=key).status_code == 422
    assert client.post("/v1/plans", json=small, headers=key).status_code == 200


@pytest.mark.parametrize("key", ["", '""', "two words", "ä", "x" * 256, 'a"b', "a\\b"])
def test_what_is_no_key_is_refused(client: httpx.Client, small: dict[str, Any], key: str) -> None:
    headers = [(b"Content-Type", b"application/json"), (b"Idempotency-Key", key.encode())]
    answer = client.post("/v1/plans", content=json.dumps(small), headers=headers)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["field"] == "Idempotency-Key"


def asked(key: str, host: str = "10.0.0.1") -> Request:
    """A post to /v1/plans with this key, from this address."""
    return Request(
        {"type": "http", "method": "POST", "path": "/v1/plans", "query_string": b"", "client": (host, 1),
         "scheme": "http", "server": ("x", 80), "headers": [(b"idempotency-key", key.encode())]}
    )  # fmt: skip


async def test_a_key_that_is_in_use_is_told_and_is_free_when_its_request_was_given_up() -> None:
    keys, gate = Idempotency(Meters()), asyncio.Event()

    async def slow() -> Response:
        await gate.wait()
        return Response(b"first")

    async def quick() -> Response:
        return Response(b"quick")

    working = asyncio.create_task(keys.once(asked("k"), b"body", slow))
    await asyncio.sleep(0)
    with pytest.raises(Problem, match="key-in-use"):
        await keys.once(asked("k"), b"body", quick)
    assert (await keys.once(asked("k", "10.0.0.2"), b"body", quick)).body == b"quick", "another client"
    working.cancel()
    await asyncio.gather(working, return_exceptions=True)
    assert (await keys.once(asked("k"), b"body", quick)).body == b"quick"
    gate.set()
    assert (await keys.once(asked("k"), b"body", slow)).body == b"quick"


async def test_keys_are_forgotten_after_their_time_and_when_there_are_too_many() -> None:
    async def work() -> Response:
        return Response(b"x" * 10)

    brief = Idempotency(Meters(), kept_s=0.0)
    await brief.once(asked("k"), b"one", work)
    await brief.once(asked("k"), b"another", work)
    few = Idempotency(Meters(), most=2)
    small = Idempotency(Meters(), most_bytes=25)
    for key in "abc":
        await few.once(asked(key), b"", work)
        await small.once(asked(key), b"", work)
    assert (len(few), few.bytes) == (len(small), small.bytes) == (2, 20)
    with pytest.raises(Problem, match="key-reused"):
        await few.once(asked("c"), b"another", work)
    await few.once(asked("a"), b"another", work)
