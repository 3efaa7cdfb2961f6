"""What the service does with a body that has been read: admit it, hand it to a worker, answer.

A body goes to the worker as it came, and the worker's answer leaves as it comes: this process parses neither,
but for the body of a job, which is not accepted if it is not JSON.
"""

from __future__ import annotations

import asyncio
import hashlib
import json
import logging
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from assur.api.logs import event
from assur.api.problems import Problem
from assur.api.web.body_reader import READERS
from assur.api.web.settings import Settings
from assur.api.workers import jobs
from assur.api.workers.pool import Place, Workers
from assur.api.workers.worker_process import Tell
from assur.planner.errors import InputError
from assur.scenes.faults import fault
from assur.scenes.requests import shipped, stated_budgets, with_options
from assur.scenes.scenarios import with_files

SMALL_BYTES = 32768
"""Bodies up to this are looked through at once: it takes less than 1 ms, and the way to a thread and back half as long.
Larger ones, and scenarios, which are files, are read beside the event loop."""
STATED = re.compile(rb'"((?:explain_)?budget_m?s)"\s*:\s*(-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?)')
"""A budget in the text of a request. No other field of a request is called so."""


@dataclass(frozen=True, slots=True)
class Order:
    """What a worker is to do: the job and its arguments; the digest of the request; when it is killed, s; whether it
    tells how far it has come, and can be called off."""

    job: Callable[..., jobs.Reply]
    arguments: tuple[Any, ...]
    key: str
    wall_s: float
    watched: bool = False


@dataclass
class Service:
    """Settings and workers of one running service."""

    settings: Settings
    workers: Workers = field(init=False)
    readers: asyncio.Semaphore = field(init=False)

    def __post_init__(self) -> None:
        self.workers = Workers(self.settings, jobs.warm)
        self.readers = asyncio.Semaphore(READERS)

    async def plan(self, body: bytes, certificate: jobs.Detail) -> jobs.Answer:
        """The answer to the request in `body`, or to the shipped scenario that it names. Raises `Problem`."""
        return await self.do(await self.order(body, certificate))

    async def order(self, body: bytes, certificate: jobs.Detail) -> Order:
        """What is to be done about `body`, as `plan` has it. Raises `Problem`."""
        if len(body) <= SMALL_BYTES and b'"scenario"' not in body:
            return self._read(body, certificate)
        return await asyncio.to_thread(self._read, body, certificate)

    async def job_order(self, body: bytes, certificate: jobs.Detail) -> Order:
        """The same of a body that is read as JSON before its job is accepted. Raises `Problem`."""
        return await asyncio.to_thread(self._read, body, certificate, parsed=True)

    async def scene_order(self, name: str, body: bytes, certificate: jobs.Detail) -> Order:
        """What is to be done to plan the shipped scenario `name`, with the options in `body`. Raises `Problem`."""
        return await asyncio.to_thread(self._scene, name, jobs.options_in(body), certificate)

    async def check(self, body: bytes) -> jobs.Answer:
        """The checker's verdict on the request and plan in `body`. Raises `Problem`."""
        return await self.do(Order(jobs.check, (body,), _digest("check", body), self.settings.check_s))

    async def view(self, body: bytes) -> jobs.Answer:
        """What a viewer plays of the request and plan in `body`. Raises `Problem`."""
        return await self.do(Order(jobs.view, (body,), _digest("view", body), self.settings.check_s))

    async def report(self, body: bytes) -> jobs.Answer:
        """The page that plays the request and plan in `body`. Raises `Problem`."""
        return await self.do(Order(jobs.report, (body,), _digest("report", body), self.settings.check_s))

    async def export(self, body: bytes) -> jobs.Answer:
        """The plan in `body` as a controller's file. Raises `Problem`."""
        return await self.do(Order(jobs.export, (body,), _digest("export", body), self.settings.check_s))

    async def check_trajectory(self, body: bytes) -> jobs.Answer:
        """The verdict on the trajectory in `body`. Raises `Problem`."""
        return await self.do(Order(jobs.check_trajectory, (body,), _digest("trajectory", body), self.settings.check_s))

    async def ik(self, body: bytes) -> jobs.Answer:
        """The joint positions, or the pose of the tool, that `body` asks for. Raises `Problem`."""
        return await self.do(Order(jobs.ik, (body,), _digest("ik", body), self.settings.check_s))

    async def parse(self, body: bytes) -> jobs.Answer:
        """What the text of a scenario in `body` means. Raises `Problem`."""
        return await self.do(Order(jobs.parse, (body,), _digest("parse", body), self.settings.check_s))

    def _read(self, body: bytes, certificate: jobs.Detail, *, parsed: bool = False) -> Order:
        document = (None if parsed else self._budgets(body)) or jobs.request_in(body)
        if "scenario" not in document:
            wall_s, most_s = self._wall(document), self.settings.max_budget_s
            return Order(jobs.plan, (body, certificate, most_s), _digest("request", body), wall_s, watched=True)
        try:
            return self._scene(_scenario_name(document), {}, certificate)
        except InputError as error:
            raise Problem.of_input(error) from error

    def scene(self, name: str) -> dict[str, Any]:
        """The request of the shipped scenario `name`, its budgets cut to what the service gives: it can be posted here.

        Raises `InputError`."""
        request, most_s = scenario_request(name), self.settings.max_budget_s
        budgets = stated_budgets(request)
        cut: dict[str, Any] = {key: most_s for key, value in budgets.items() if value > most_s}
        return with_options(request, cut) if cut else request

    def _scene(self, name: str, options: dict[str, Any], certificate: jobs.Detail) -> Order:
        """As `scene_order`. Raises `InputError` for a scenario that is not there."""
        own, most_s = stated_budgets(scenario_request(name)), self.settings.max_budget_s
        # what the scenario's file states is not what the caller asks for: it is cut, and not refused
        budgets = {key: min(value, most_s) for key, value in own.items()}
        wall_s = self._wall(with_options({"options": budgets}, options))
        key = _digest("scenario", name + json.dumps(options, sort_keys=True) if options else name)
        return Order(jobs.plan_shipped, (name, options, certificate, most_s), key, wall_s, watched=True)

    def _budgets(self, body: bytes) -> dict[str, Any] | None:
        """A request with the budgets that stand in the text of one, which the worker validates, and nothing else.

        None where only parsing can tell: a scenario may be named, a key may be escaped or given twice, or a budget is
        above what the service gives and may be no budget, but a field in the wrong place.
        """
        if b'"scenario"' in body or b"\\" in body:
            return None
        found = STATED.findall(body)
        request = {"options": {name.decode(): float(value) for name, value in found}}
        twice = len(request["options"]) < len(found)
        largest = self.settings.max_budget_s
        return None if twice or max(stated_budgets(request, largest).values()) > largest else request

    def _wall(self, document: dict[str, Any]) -> float:
        """When a worker that plans `document` is killed: after both its budgets and the grace, s.

        Raises the `Problem` of a request that asks for more than the service gives.
        """
        largest = self.settings.max_budget_s
        budgets = stated_budgets(document, largest)
        for name, budget in budgets.items():
            if not budget <= largest:
                allowed = f"at most {largest:g} s, which is ASSUR_MAX_BUDGET_S of this service"
                raise Problem.of_input(fault(document, ("options", name), allowed))
        return sum(budgets.values()) + self.settings.grace_s

    async def do(self, order: Order, told: Tell | None = None, place: Place | None = None) -> jobs.Answer:
        """The answer to an order; `told` takes how far it has come, if it is watched. `place`: that the caller holds
        for it, and gives up. Raises `Problem`."""
        listener = (told or _nobody) if order.watched else None
        reply: jobs.Reply = await self.workers.run(order.job, order.arguments, order.key, order.wall_s, listener, place)
        match reply:
            case jobs.Answer():
                return reply
            case Problem():
                raise reply
            case jobs.Fault():
                event(
                    "a worker met a fault", logging.ERROR, fault=reply.name, where=list(reply.where), digest=order.key
                )
                raise Problem("fault", f"The planner met a fault of its own; it is logged with digest {order.key}.")


def _nobody(_: Any) -> None:
    """Listens to a job only so that it can be called off."""


@cache
def scenario_request(name: str) -> dict[str, Any]:
    """The request of the shipped scenario `name`, what its files hold in it, read once. Raises `InputError` for a name
    that is not shipped."""
    scenario = shipped(name)
    request: dict[str, Any] = with_files(scenario.request, scenario.folder)
    return request


def _scenario_name(document: dict[str, Any]) -> str:
    """The name in a body {"scenario": NAME}. Raises `Problem` when there is anything else in it."""
    for name, value in document.items():
        if name != "scenario":
            raise Problem.of_input(InputError(name, value, 'no field beside "scenario"'))
    if not isinstance(document["scenario"], str):
        raise Problem.of_input(InputError("scenario", document["scenario"], "the name of a shipped scenario"))
    return document["scenario"]


def _digest(kind: str, content: str | bytes) -> str:
    data = content.encode() if isinstance(content, str) else content
    return hashlib.sha256(kind.encode() + b"\n" + data).hexdigest()
