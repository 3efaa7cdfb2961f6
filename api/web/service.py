"""What the service does with a body that has been read: parse, admit, hand to a worker, tell."""

from __future__ import annotations

import asyncio
import hashlib
import logging
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from assur.api.logs import event
from assur.api.problems import FieldError, Problem, shown
from assur.api.web.body_reader import READERS
from assur.api.web.settings import Settings
from assur.api.workers import jobs
from assur.api.workers.pool import Workers
from assur.planner.errors import InputError
from assur.scenes.faults import fault
from assur.scenes.requests import parse_json, shipped, stated_budgets

SMALL_BYTES = 32768
"""Bodies up to this are parsed at once: it takes less than 1 ms, and the way to a thread and back half as long. Larger
ones, and scenarios, which are files, are read beside the event loop."""


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
        if len(body) <= SMALL_BYTES and b'"scenario"' not in body:
            order = self._read(body, certificate)
        else:
            order = await asyncio.to_thread(self._read, body, certificate)
        return await self._work(*order)

    async def check(self, body: bytes) -> jobs.Answer:
        """The checker's verdict on the request and plan in `body`. Raises `Problem`."""
        return await self._work(jobs.check, (body,), _digest("check", body), self.settings.check_s)

    def _read(self, body: bytes, certificate: jobs.Detail) -> tuple[Any, tuple[Any, ...], str, float]:
        """What to do about `body`: job, its arguments, digest of the request, wall."""
        try:
            document = parse_json(body)
        except InputError as error:
            raise Problem.of_input(error, "bad-syntax") from error
        if not isinstance(document, dict):
            found = FieldError("body", shown(document), 'a request, or {"scenario": NAME}')
            raise Problem("bad-input", str(found), (found,))
        if "scenario" in document:
            name = _scenario_name(document)
            try:
                wall_s = self._wall(scenario_request(name))
            except InputError as error:
                raise Problem.of_input(error) from error
            return jobs.plan_shipped, (name, certificate), _digest("scenario", name), wall_s
        return jobs.plan, (document, certificate), _digest("request", body), self._wall(document)

    def _wall(self, document: dict[str, Any]) -> float:
        """When a worker that plans `document` is killed: after both its budgets and the grace, s.

        Nothing else of a request is read here: the worker validates it. Raises the `Problem` of a request that asks
        for more than the service gives.
        """
        largest = self.settings.max_budget_s
        budgets = stated_budgets(document)
        for name, budget in budgets.items():
            if not budget <= largest:
                allowed = f"at most {largest:g} s, which is ASSUR_MAX_BUDGET_S of this service"
                raise Problem.of_input(fault(document, ("options", name), allowed))
        return sum(budgets.values()) + self.settings.grace_s

    async def _work(self, job: Any, arguments: tuple[Any, ...], key: str, wall_s: float) -> jobs.Answer:
        reply: jobs.Reply = await self.workers.run(job, arguments, key, wall_s)
        match reply:
            case jobs.Answer():
                return reply
            case Problem():
                raise reply
            case jobs.Fault():
                event("a worker met a fault", logging.ERROR, fault=reply.name, where=list(reply.where), digest=key)
                raise Problem("fault", f"The planner met a fault of its own; it is logged with digest {key}.")


@cache
def scenario_request(name: str) -> dict[str, Any]:
    """The request of the shipped scenario `name`, read once. Raises `InputError` for a name that is not shipped."""
    return shipped(name).request


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
