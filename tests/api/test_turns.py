"""Bodies are read one at a time, the clients in turn."""

from __future__ import annotations

import asyncio
import json
import threading
from typing import Any

import pytest

from assur.api.problems import Problem
from assur.api.web.service import SMALL_BYTES, Service
from assur.api.web.settings import Settings
from assur.api.web.uploads import Turns
from assur.api.workers import jobs
from assur.api.workers.client import Client
from assur.api.workers.jobs import FIRST_PLAN

pytestmark = pytest.mark.anyio

GREEDY, OTHER, THIRD = (Client(name, waiting=8) for name in ("greedy", "other", "third"))


async def ask(turns: Turns, order: list[str], *clients: Client) -> list[asyncio.Task[None]]:
    """Each of the clients asks for a turn, and notes its name when it has it."""

    async def one(client: Client) -> None:
        await turns.take(client)
        order.append(client.name)

    tasks = [asyncio.create_task(one(client)) for client in clients]
    await asyncio.sleep(0)
    return tasks


async def give_on(turns: Turns, times: int) -> None:
    for _ in range(times):
        turns.give_on()
        await asyncio.sleep(0)


async def test_clients_have_turns_one_after_the_other_however_much_each_asks_for() -> None:
    turns, order = Turns(), list[str]()
    await ask(turns, order, *[GREEDY] * 5, OTHER, OTHER, THIRD)
    assert (order, len(turns)) == (["greedy"], 7)
    await give_on(turns, 7)
    assert order == ["greedy", "greedy", "other", "third", "greedy", "other", "greedy", "greedy"]
    await give_on(turns, 1)
    await ask(turns, order, OTHER)
    assert order[-1] == "other"


async def test_who_waits_no_more_takes_no_turn() -> None:
    turns, order = Turns(), list[str]()
    tasks = await ask(turns, order, GREEDY, OTHER, THIRD, GREEDY)
    tasks[1].cancel()
    await asyncio.sleep(0)
    turns.give_on()
    tasks[2].cancel()  # it has just been given the turn
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    assert (order, len(turns)) == (["greedy", "greedy"], 0)


async def test_so_many_of_a_client_wait_and_so_many_in_all() -> None:
    turns, order = Turns(most=10), list[str]()
    await ask(turns, order, *[GREEDY] * 9)
    with pytest.raises(Problem) as of_one:
        await turns.take(GREEDY)
    assert of_one.value.kind == "too-many-requests"
    await ask(turns, order, OTHER, OTHER)
    with pytest.raises(Problem) as in_all:
        await turns.take(THIRD)
    assert in_all.value.kind == "busy"
    assert int(in_all.value.headers["Retry-After"]) >= 1


LARGE = b'{"options": {"seed": [' + b",".join([b'{"a": 0}'] * 30_000) + b"]}}"


async def test_a_large_body_of_one_client_is_read_before_the_many_of_another_and_each_pays() -> None:
    service = Service(Settings(workers=1))
    ended: list[str] = []

    async def post(client: Client) -> None:
        with pytest.raises(Problem):
            await service.scene_order("demo", LARGE, "full", client)
        ended.append(client.name)

    poor = Client("greedy", waiting=8, seconds=1e-6)
    service.workers.require_room(poor)
    others = [asyncio.create_task(post(poor)) for _ in range(8)]
    await asyncio.sleep(0)
    await post(OTHER)
    assert ended.count("greedy") <= 2
    await asyncio.gather(*others)
    with pytest.raises(Problem) as spent:
        service.workers.require_room(poor)
    assert spent.value.kind == "too-many-requests"


async def test_the_event_loop_goes_on_while_the_options_of_a_scenario_are_read(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """They are read in another thread than that of the loop."""
    threads, read = list[int](), jobs.options_in

    def noted(body: bytes) -> dict[str, Any]:
        threads.append(threading.get_ident())
        return read(body)

    monkeypatch.setattr(jobs, "options_in", noted)
    with pytest.raises(Problem):
        await Service(Settings(workers=1)).scene_order("demo", LARGE, "full", OTHER)
    assert len(threads) == 1
    assert threads != [threading.get_ident()]


async def test_a_small_job_does_not_wait_for_large_ones() -> None:
    service = Service(Settings(workers=1))
    large = asyncio.create_task(service.order(LARGE, "full", OTHER, parsed=True))
    await asyncio.sleep(0)
    small = json.dumps(FIRST_PLAN).encode()
    assert len(small) <= SMALL_BYTES
    assert (await service.order(small, "full", OTHER, parsed=True)).work.arguments[0] == small
    assert not large.done()
    await large
