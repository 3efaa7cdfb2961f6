"""`assur.Client` and `assur.AsyncClient` against a service that runs, and against what is none."""

from __future__ import annotations

import asyncio
import copy
import pickle
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, ClassVar

import httpx
import numpy as np
import pytest

import assur
from assur.api.documents import to_json
from assur.api.problems import MEDIA_TYPE, STATUS, Problem
from assur.api.python import exchange
from assur.api.workers.jobs import FIRST_PLAN
from assur.request import Request, ToolPose, mm

pytestmark = pytest.mark.anyio

POSE = {"at_mm": [350, 0, 150], "yaw_deg": 0}
CLOCKS = ("elapsed_s", "first_s")
"""What is not the same in two answers to one request."""


@pytest.fixture
def url(client: httpx.Client) -> str:
    return str(client.base_url)


@pytest.fixture
def service(url: str) -> Iterator[assur.Client]:
    with assur.Client(url) as made:
        yield made


def without_clocks(answer: assur.Answer) -> dict[str, Any]:
    return {key: value for key, value in answer.items() if key not in CLOCKS}


def test_a_plan_of_the_service_is_that_of_this_process(service: assur.Client) -> None:
    there, here = service.plan(FIRST_PLAN), assur.plan(FIRST_PLAN)
    assert there.planned
    assert without_clocks(there) == without_clocks(here)
    assert (there.trajectory.sample(0.004).positions == here.trajectory.sample(0.004).positions).all()


def test_the_service_checks_what_either_planned(service: assur.Client) -> None:
    answer = service.plan(FIRST_PLAN)
    assert service.check(FIRST_PLAN, answer)["ok"]
    assert service.check(FIRST_PLAN, answer.document)["ok"]
    assert assur.check(FIRST_PLAN, answer)["ok"]
    wrong = copy.deepcopy(answer.document)
    wrong["arrivals"] = wrong["arrivals"][1:]
    assert service.check(FIRST_PLAN, wrong) == assur.check(FIRST_PLAN, wrong)
    assert not service.check(FIRST_PLAN, wrong)["ok"]


def test_every_form_of_a_request_is_taken(service: assur.Client) -> None:
    built = Request.of(FIRST_PLAN)
    arrays = {**FIRST_PLAN, "robot": {**FIRST_PLAN["robot"], "tool": {"tcp_mm": np.array([0.0, 0.0, -100.0])}}}
    plain = {**FIRST_PLAN, "robot": {**FIRST_PLAN["robot"], "tool": {"tcp_mm": [0.0, 0.0, -100.0]}}}
    answer = service.plan(built, certificate="digest")
    assert answer["request_digest"] == built.digest
    assert set(answer["certificate"]) == {"digest", "rows", "covers"}
    assert service.plan(arrays)["request_digest"] == service.plan(plain)["request_digest"]


def test_a_refusal_is_an_answer(service: assur.Client) -> None:
    request = {**FIRST_PLAN, "task": [{"move": {"to": {"at_mm": [1500, 0, 250]}}}]}
    answer = service.plan(request)
    assert not answer.planned
    assert answer.sentence == assur.plan(request).sentence


def test_the_catalogue_and_the_scenarios_are_those_of_the_service(service: assur.Client) -> None:
    assert service.robots() == assur.robots()
    assert service.scenarios() == assur.scenarios()
    assert service.load("demo") == assur.load("demo")
    named = service.plan({"scenario": "demo"}, certificate="digest")
    assert named["request_digest"] == Request.of(assur.load("demo")).digest


def test_inverse_kinematics_is_that_of_this_process(service: assur.Client) -> None:
    assert service.ik(FIRST_PLAN, pose=POSE) == assur.ik(FIRST_PLAN, pose=POSE)
    assert service.ik(FIRST_PLAN, pose=ToolPose(at_m=mm(350, 0, 150), yaw_rad=0.0)) == assur.ik(FIRST_PLAN, pose=POSE)
    robot = {"model": "mitsubishi-rh-6frh5520", "tool": {"tcp_mm": [0, 0, -100]}}
    assert service.ik(robot=robot, pose=POSE)["status"] == "reached"


def test_a_service_that_is_ready_says_so(service: assur.Client) -> None:
    health = service.health()
    assert health == assur.Health(ready=True, workers=1, detail="")


def test_a_field_that_is_not_right_is_the_same_error_here_and_there(service: assur.Client) -> None:
    request = copy.deepcopy(FIRST_PLAN)
    request["start"]["joints"]["j1_deg"] = "-40"
    errors = []
    for plan in (assur.plan, service.plan):
        with pytest.raises(assur.InputError) as caught:
            plan(request)
        errors.append(caught.value)
    here, there = errors
    assert (there.field, there.value, there.allowed) == (here.field, here.value, here.allowed)
    assert isinstance(there, assur.RemoteInputError)
    assert (there.status, there.kind) == (422, "bad-input")
    assert there.document["type"] == "urn:assur:problem:bad-input"
    assert there.errors[0] == {"field": here.field, "value": here.value, "allowed": here.allowed}
    assert here.field in str(there)
    assert there.url in str(there)
    again = pickle.loads(pickle.dumps(there))
    assert (type(again), str(again), again.field, again.document) == (
        type(there),
        str(there),
        here.field,
        there.document,
    )


def test_a_field_that_is_missing_has_no_value(service: assur.Client) -> None:
    with pytest.raises(assur.RemoteInputError) as caught:
        service.plan({key: value for key, value in FIRST_PLAN.items() if key != "start"})
    assert (caught.value.field, caught.value.value) == ("start", None)
    assert "value" not in caught.value.errors[0]


def test_a_scenario_that_is_not_there_is_the_callers_fault(service: assur.Client) -> None:
    for name in ("demmo", "../robots", "a/b?c=d"):
        with pytest.raises(assur.ServiceError):
            service.load(name)
    with pytest.raises(assur.RemoteInputError, match="demo") as caught:
        service.load("demmo")
    assert caught.value.kind == "not-found"


@pytest.mark.parametrize(
    ("value", "allowed"), [(float("nan"), "finite"), (float("inf"), "finite"), ({1}, "a list"), (b"x", "text")]
)
def test_what_json_has_no_form_for_is_refused_before_it_is_sent(
    service: assur.Client, value: object, allowed: str
) -> None:
    request = {**FIRST_PLAN, "options": {"clearance_mm": {"travel": [1, value]}}}
    with pytest.raises(assur.InputError, match=allowed) as caught:
        service.plan(request)
    assert caught.value.field == "options.clearance_mm.travel[1]"
    assert not isinstance(caught.value, assur.ServiceError)


async def test_the_awaited_client_does_the_same(url: str) -> None:
    async with assur.AsyncClient(url) as service:
        answer, robots, health = await asyncio.gather(service.plan(FIRST_PLAN), service.robots(), service.health())
        assert without_clocks(answer) == without_clocks(assur.plan(FIRST_PLAN))
        assert (await service.check(FIRST_PLAN, answer))["ok"]
        assert await service.ik(FIRST_PLAN, pose=POSE) == assur.ik(FIRST_PLAN, pose=POSE)
        assert robots == assur.robots()
        assert await service.scenarios() == assur.scenarios()
        assert await service.load("demo") == assur.load("demo")
        assert health.ready
        with pytest.raises(assur.RemoteInputError):
            await service.plan({})


def test_both_clients_have_the_same_methods() -> None:
    def methods(client: type) -> set[str]:
        return {name for name in vars(client) if not name.startswith("_")}

    assert methods(assur.Client) - {"close"} == methods(assur.AsyncClient) - {"aclose"}
    assert {"plan", "check", "ik", "scenarios", "robots", "health"} <= methods(assur.Client)


@pytest.mark.parametrize("kind", sorted(STATUS))
def test_every_kind_of_problem_is_an_error_that_tells_it(kind: str) -> None:
    problem = Problem(kind, "A sentence.", headers={"Retry-After": "2"} if kind == "busy" else {})
    headers = {"Content-Type": MEDIA_TYPE, **problem.headers}
    asked = exchange.planning(FIRST_PLAN, "full")
    with pytest.raises(assur.ProblemError) as caught:
        asked.result("http://there", problem.status, headers, to_json(problem.document()))
    assert (caught.value.kind, caught.value.status) == (kind, STATUS[kind][0])
    assert caught.value.document == problem.document()
    assert caught.value.retry_after_s == (2.0 if kind == "busy" else None)
    assert not isinstance(caught.value, assur.InputError)


def test_a_service_that_is_not_ready_yet_is_healthy_enough_to_say_so() -> None:
    problem = Problem("not-ready", "0 of 1 workers have planned.", headers={"Retry-After": "1"})
    body = to_json(problem.document())
    found = exchange.health().result("http://there", problem.status, {"Content-Type": MEDIA_TYPE}, body)
    assert found == assur.Health(ready=False, workers=None, detail="0 of 1 workers have planned.")


def test_nobody_at_the_address() -> None:
    with socket.socket() as held:
        held.bind(("127.0.0.1", 0))  # bound and not listening: connections are refused
        address = f"http://127.0.0.1:{held.getsockname()[1]}"
        with assur.Client(address) as service, pytest.raises(assur.ServiceError, match="assur serve") as caught:
            service.health()
    assert caught.value.url == address
    assert not isinstance(caught.value, assur.ProblemError)


def test_an_answer_that_does_not_come_in_time() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        address = f"http://127.0.0.1:{silent.getsockname()[1]}"
        with (
            assur.Client(address, timeout=0.05) as service,
            pytest.raises(assur.ServiceError, match=r"no answer within 0\.05 s"),
        ):
            service.plan(FIRST_PLAN)

        async def awaited() -> None:
            async with assur.AsyncClient(address, timeout=0.05) as service:
                await service.robots()

        with pytest.raises(assur.ServiceError, match=r"no answer within 0\.05 s"):
            asyncio.run(awaited())


class Other(SimpleHTTPRequestHandler):
    """A server of something else, which notes who asks."""

    tokens: ClassVar[list[str | None]] = []

    def send_head(self) -> None:
        self.tokens.append(self.headers.get("Authorization"))
        self.send_error(404)

    def log_message(self, format: str, *arguments: object) -> None:  # noqa: A002 - as its base calls it
        """Writes nothing."""


def test_another_server_at_the_address_is_told_from_the_service() -> None:
    with ThreadingHTTPServer(("127.0.0.1", 0), Other) as other:
        thread = threading.Thread(target=other.serve_forever)
        thread.start()
        try:
            address = f"http://127.0.0.1:{other.server_address[1]}"
            with assur.Client(address, headers={"Authorization": "Bearer mine"}) as service:
                with pytest.raises(assur.ServiceError, match="answered 404 with text/html"):
                    service.health()
                with pytest.raises(assur.ServiceError, match="answered 501"):
                    service.plan(FIRST_PLAN)
            assert Other.tokens == ["Bearer mine"]
        finally:
            other.shutdown()
            thread.join()


@pytest.mark.parametrize("url", ["", "127.0.0.1:8000", "ftp://127.0.0.1", "http://", "http://127.0.0.1:port"])
def test_what_is_no_address_is_refused(url: str) -> None:
    for client in (assur.Client, assur.AsyncClient):
        with pytest.raises(assur.InputError, match="url: got"):
            client(url)


@pytest.mark.parametrize("timeout", [0.0, -1.0, float("nan")])
def test_a_time_that_is_none_is_refused(timeout: float) -> None:
    with pytest.raises(assur.InputError, match="timeout: got"):
        assur.Client("http://127.0.0.1:8000", timeout=timeout)


async def test_a_client_that_is_closed_says_so(url: str) -> None:
    service = assur.Client(url)
    service.close()
    with pytest.raises(assur.ServiceError, match="this client is closed; make another one"):
        service.health()

    there = assur.AsyncClient(url)
    await there.aclose()
    with pytest.raises(assur.ServiceError, match="this client is closed; make another one"):
        await there.robots()


def test_without_httpx_one_error_says_what_to_install() -> None:
    code = "import sys; sys.modules['httpx'] = None; import assur; assur.Client('http://127.0.0.1:8000')"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ended.returncode == 1
    assert ended.stderr.count("Traceback") == 1
    assert "pip install 'assur[client]'" in ended.stderr.splitlines()[-1]
