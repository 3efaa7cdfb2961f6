"""What the service does with a body that has been read: admit it, hand it to a worker, answer.

A body goes to the worker as it came, and the worker's answer leaves as it comes: this process parses neither,
but for the body of a job, which is not accepted if it is not JSON.
"""

from __future__ import annotations

import asyncio
import json
import logging
import re
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, partial
from typing import Any

from assur.api.documents import digest_of, to_json
from assur.api.logs import event
from assur.api.problems import Problem
from assur.api.telemetry.meters import Meters
from assur.api.telemetry.trace import current
from assur.api.version import version_document
from assur.api.web.body_reader import Reading
from assur.api.web.settings import Settings
from assur.api.web.uploads import Turns
from assur.api.workers import cell_jobs, file_jobs, jobs, simulation_jobs
from assur.api.workers.answer_parts import Parts
from assur.api.workers.client import Client, Demand, Ticket
from assur.api.workers.end import Tell
from assur.api.workers.pool import Work, Workers
from assur.api.workers.results import Results
from assur.api.workers.traced import warm
from assur.planner.errors import InputError
from assur.scenes.faults import fault, raised_as
from assur.scenes.meshes.folder import MeshFolder
from assur.scenes.requests import Detail, parse_json, shipped, stated_budgets, with_options
from assur.scenes.scenario import with_files
from assur.scenes.simulation.helps import PROVED

SMALL_BYTES = 32768
"""Bodies up to this are looked through at once: it takes less than 1 ms, and the way to a thread and back half as long.
Larger ones, and scenarios, which are files, are read beside the event loop, one at a time, the clients in turn: threads
share one interpreter with it, so more of them would not be faster, and each makes it wait. The body of a client that
leaves while it waits for this is not read at all."""
SHORT_BYTES = 1 << 20
"""Work without a budget on a body up to this is short. Common plans have a tenth of it."""
STATED = re.compile(rb'"((?:explain_)?budget_m?s)"\s*:\s*(-?\d+(?:\.\d+)?(?:[eE][+-]?\d+)?)')
"""A budget in the text of a request. No other field of a request is called so."""

OPTIONS = "options."
MOST_CELLS = 1024
"""Cells whose budgets are kept."""


@dataclass(frozen=True, slots=True)
class Order:
    """What a worker is to do, and what it demands of the workers."""

    work: Work
    demand: Demand


@dataclass
class Service:
    """Settings and workers of one running service."""

    settings: Settings
    meters: Meters = field(init=False)
    results: Results = field(init=False)
    workers: Workers = field(init=False)
    reading: Reading = field(init=False)
    meshes: MeshFolder | None = field(init=False)
    mesh_bytes: int = 0
    """Room that files in the folder for meshes took when it was last measured."""
    _turns: Turns = field(default_factory=Turns)
    _cell_budgets: dict[str, dict[str, Any]] = field(default_factory=dict)
    """The budgets of cells by their digests, s: what a task has that states none."""

    def __post_init__(self) -> None:
        self.meters = Meters()
        self.meshes = self.settings.folder_of_meshes()
        build = to_json(version_document(self.settings.commit)).decode()
        self.results = Results(self.settings.results_mib << 20, build, self.meters)
        self.workers = Workers(self.settings, partial(warm, self.settings.log_level, self.meshes), self.meters)
        self.reading = Reading()
        self.meters.gauge("assur_bodies_being_read", "Bodies that arrive.", lambda: self.reading.bodies)

    async def plan(self, body: bytes, certificate: Detail, client: Client) -> jobs.Answer:
        """The answer to the request in `body`, or to the shipped scenario that it names. Raises `Problem`."""
        return await self.do(await self.order(body, certificate, client))

    async def plan_file(self, body: bytes, how: dict[str, Any], client: Client) -> jobs.Answer:
        """The file, as `how` asks for it, of the plan of what is in `body`. Raises `Problem`."""
        order = await self.order(body, "full", client)
        source = order.work.arguments[0] if order.work.job is jobs.plan_shipped else body
        return await self.do(self._file_order(order, file_jobs.plan_file, how, source))

    def _file_order(self, order: Order, job: Callable[..., jobs.Reply], how: dict[str, Any], *source: object) -> Order:
        """The order for the file, as `how` asks for it, of the plan of another order; `job` makes it of `source`."""
        key = digest_of(job.__name__, order.work.key, json.dumps(how))
        work = replace(order.work, job=job, arguments=(*source, how, self.settings.max_budget_s), key=key)
        # the file is made after the plan, as an export of it would be
        return Order(work, replace(order.demand, wall_s=order.demand.wall_s + self.settings.check_s))

    async def order(self, body: bytes, certificate: Detail, client: Client, *, parsed: bool = False) -> Order:
        """What is to be done about `body`, as `plan` has it. `parsed`: it is read as JSON before it is accepted, as
        that of a job is. Raises `Problem`."""
        read = partial(self._read, body, certificate, client, parsed=parsed)
        if len(body) <= SMALL_BYTES and b'"scenario"' not in body:
            return read()
        return await self._beside(client, read)

    async def scene_order(self, name: str, body: bytes, certificate: Detail, client: Client) -> Order:
        """What is to be done to plan the shipped scenario `name`, with the options in `body`. Raises `Problem`, and
        `InputError` for a scenario that is not there."""

        def read() -> Order:
            return self._scene(name, jobs.options_in(body), certificate, client)

        return await (self._beside(client, read) if body else asyncio.to_thread(read))

    async def task_order(self, digest: str, body: bytes, certificate: Detail, parts: Parts, client: Client) -> Order:
        """What is to be done about the task in `body`, in the cell with this digest. Raises `Problem`."""
        read = partial(self._task, digest, body, certificate, parts, client)
        at_once = len(body) <= SMALL_BYTES and digest in self._cell_budgets
        return read() if at_once else await self._beside(client, read)

    async def task_file_order(self, digest: str, body: bytes, how: dict[str, Any], client: Client) -> Order:
        """The same for the file of its plan, as `how` asks for it. Raises `Problem`."""
        order = await self.task_order(digest, body, "full", Parts(), client)
        return self._file_order(order, cell_jobs.plan_task_file, how, digest, body)

    def _task(self, digest: str, body: bytes, certificate: Detail, parts: Parts, client: Client) -> Order:
        task = None if b'"set"' in body else self._budgets(body)
        task, own = task or jobs.document_in(body, jobs.TASK), self._cell_budgets.get(digest)
        if own is None:
            content = None if self.meshes is None else self.meshes.content(digest, "cell")
            if content is None:
                raise cell_jobs.unknown(digest)
            own = self._cell_budgets[digest] = dict(stated_budgets(parse_json(content), self.settings.max_budget_s))
            while len(self._cell_budgets) > MOST_CELLS:
                del self._cell_budgets[next(iter(self._cell_budgets))]
        options: Any = task.get("options")
        given: Any = task.get("set")
        stated = with_options({"options": {**own}}, options if isinstance(options, dict) else {})["options"]
        if isinstance(given, dict):
            stated |= {path.removeprefix(OPTIONS): value for path, value in given.items() if path.startswith(OPTIONS)}
        demand = self._demand({"options": stated}, client)
        arguments = digest, body, certificate, parts, self.settings.max_budget_s
        key = digest_of("plan_task", digest, body)
        return Order(Work(cell_jobs.plan_task, arguments, key, in_touch=True, listens=True), demand)

    async def simulation_order(self, digest: str | None, body: bytes, client: Client) -> Order:
        """What is to be done about the simulation in `body`, of the cell with this digest; None: the body has the cell.
        Raises `Problem`."""
        read = partial(self._simulation, digest, body, client)
        return read() if len(body) <= SMALL_BYTES else await self._beside(client, read)

    def _simulation(self, digest: str | None, body: bytes, client: Client) -> Order:
        with raised_as(Problem.of_input):
            question = simulation_jobs.question_in(body, with_cell=digest is None)
            own, most = question.arguments, self.settings.max_simulated_minutes
            if own.minutes * own.seeds > most:
                allowed = f"at most {most / own.seeds:g} with seeds {own.seeds}: ASSUR_MAX_SIMULATED_MINUTES is {most}"
                raise InputError("minutes", own.minutes, allowed)
        most_s = max(question.simulated_s * (1 + PROVED * question.helps), self.settings.check_s)
        work = Work(
            simulation_jobs.simulate,
            (digest, question, most_s),
            digest_of("simulate", digest or "", body),
            in_touch=True,
            listens=True,
            leaves=True,
        )
        # its page is drawn after the runs
        return Order(
            work, Demand(client, most_s + self.settings.check_s, short=False, kind="simulation", simulation=True)
        )

    async def quick(self, job: Callable[..., jobs.Reply], client: Client, *question: bytes | str) -> jobs.Answer:
        """The answer of a job without a budget, for its work is bounded by the question. Raises `Problem`."""
        kind = job.__name__
        short = sum(map(len, question)) <= SHORT_BYTES
        demand = Demand(client, self.settings.check_s, short, kind=kind if short else f"long {kind}")
        return await self.do(Order(Work(job, question, digest_of(kind, *question), in_touch=True), demand))

    async def _beside(self, client: Client, read: Callable[[], Order]) -> Order:
        """What `read` returns, in a thread, when it is the turn of `client`, which pays for its time. A thread cannot
        be stopped: its turn ends with it, also where nobody waits any more. Raises `Problem`, also as `Turns.take`."""
        await self._turns.take(client)
        took_s: list[float] = []

        def timed() -> Order:
            began = time.thread_time()
            try:
                return read()
            finally:
                took_s.append(time.thread_time() - began)

        def ended(reading: asyncio.Future[Order]) -> None:
            self._turns.give_on()
            self.workers.admission.charge(client, sum(took_s))
            if not reading.cancelled():
                reading.exception()  # the caller has it, too, if it still waits

        reading = asyncio.ensure_future(asyncio.to_thread(timed))
        reading.add_done_callback(ended)
        return await asyncio.shield(reading)

    def _read(self, body: bytes, certificate: Detail, client: Client, *, parsed: bool = False) -> Order:
        document = (None if parsed else self._budgets(body)) or jobs.request_in(body)
        if "scenario" not in document:
            arguments = body, certificate, self.settings.max_budget_s
            work = Work(jobs.plan, arguments, digest_of("plan", body), in_touch=True, listens=True)
            return Order(work, self._demand(document, client))
        with raised_as(Problem.of_input):
            return self._scene(_scenario_name(document), {}, certificate, client)

    def scene(self, name: str) -> dict[str, Any]:
        """The request of the shipped scenario `name`, its budgets cut to what the service gives: it can be posted here.

        Raises `InputError`."""
        request, most_s = scenario_request(name), self.settings.max_budget_s
        budgets = stated_budgets(request)
        cut: dict[str, Any] = {key: most_s for key, value in budgets.items() if value > most_s}
        return with_options(request, cut) if cut else request

    def _scene(self, name: str, options: dict[str, Any], certificate: Detail, client: Client) -> Order:
        """As `scene_order`. Raises `InputError` for a scenario that is not there."""
        own, most_s = stated_budgets(scenario_request(name)), self.settings.max_budget_s
        # what the scenario's file states is not what the caller asks for: it is cut, and not refused
        budgets = {key: min(value, most_s) for key, value in own.items()}
        demand = self._demand(with_options({"options": budgets}, options), client)
        key = digest_of("scenario", name, *([json.dumps(options, sort_keys=True)] if options else []))
        arguments = name, options, certificate, most_s
        return Order(Work(jobs.plan_shipped, arguments, key, in_touch=True, listens=True), demand)

    def _budgets(self, body: bytes) -> dict[str, Any] | None:
        """A request with the budgets that are in the text of one, which the worker validates, and nothing else.

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

    def _demand(self, document: dict[str, Any], client: Client) -> Demand:
        """What planning `document` asks of the workers: both its budgets, and the grace after which it is killed.

        Raises the `Problem` of a request that asks for more than the service gives.
        """
        largest = self.settings.max_budget_s
        budgets = stated_budgets(document, largest)
        for name, budget in budgets.items():
            if not budget <= largest:
                allowed = f"at most {largest:g} s, which is ASSUR_MAX_BUDGET_S of this service"
                raise Problem.of_input(fault(document, ("options", name), allowed))
        allowed_s = sum(budgets.values())
        short = allowed_s <= self.settings.short_s
        return Demand(client, allowed_s + self.settings.grace_s, short, kind="short plan" if short else "long plan")

    async def do(self, order: Order, report: Tell | None = None, ticket: Ticket | None = None) -> jobs.Answer:
        """The answer to an order; `report` takes how far it has come. `ticket`: of its admission; None: it is admitted
        now. Raises `Problem`."""
        work, trace = order.work, current()
        trace.facts["digest"] = work.key
        kept = self.results.find(work.job, work.arguments)
        if kept is not None:
            if ticket is not None:
                self.workers.give_up(ticket)
            answer, age_s = kept
            trace.facts["outcome"] = answer.outcome
            trace.replayed("result", age_s)
            return answer
        ticket = ticket or self.workers.admit(order.demand)
        reply: jobs.Reply = await self.workers.run(ticket, work, report)
        match reply:
            case jobs.Answer():
                trace.answered(reply.outcome, reply.reason, reply.stages)
                self.results.keep(work.job, work.arguments, reply)
                worked = partial(self.meters.worked, work.job.__name__, reply.outcome, reply.reason, reply.stages)
                asyncio.get_running_loop().call_soon(worked)  # when the answer is on its way
                return reply
            case Problem():
                raise reply
            case jobs.Fault():
                where = list(reply.where)
                self.meters.faults.inc()
                event("a worker met a fault", logging.ERROR, fault=reply.name, where=where, digest=work.key)
                raise Problem("fault", f"The planner met a fault of its own; it is logged with digest {work.key}.")


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
            allowed = 'no field beside "scenario"; POST /v1/scenes/{name}/plans takes other options'
            raise Problem.of_input(InputError(name, value, allowed))
    if not isinstance(document["scenario"], str):
        raise Problem.of_input(InputError("scenario", document["scenario"], "the name of a shipped scenario"))
    return document["scenario"]
