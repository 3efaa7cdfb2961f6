"""Simulations over HTTP: jobs on workers of their own, with progress, figures and a page."""

from __future__ import annotations

import asyncio
import hashlib
import json
import os
import socket
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import pytest

import assur
from assur.api.problems import Problem
from assur.api.python import exchange
from assur.api.python.exchange import Exchange
from assur.api.workers import simulation_jobs
from assur.api.workers.jobs import Answer
from assur.api.workers.simulation_jobs import EventsForPage, question_in, simulate
from assur.api.workers.worker_process import About, Line
from assur.planner.errors import FaultError
from assur.scenes.report.run_report import run_report
from assur.scenes.scenarios import CELLS
from assur.scenes.session.recorded import Events, Several
from assur.scenes.simulation.run import Run
from assur.scenes.simulation.simulate import Simulation
from tests.api.running import PATIENT, running
from tests.api.test_jobs import events

Document = dict[str, Any]
FILE = CELLS / "shared" / "soap-flow.yaml"
CELL, TEXT = assur.load(FILE), FILE.read_text(encoding="utf-8")
WITHOUT_STREAMS = {key: value for key, value in CELL.items() if key != "streams"}
BODY = json.dumps(CELL).encode()
ADDRESS = f"v1/cells/{hashlib.sha256(BODY).hexdigest()}"
JSON = {"Content-Type": "application/json"}
BRIEF: Document = {"minutes": 0.25, "seeds": 2}
LONG: Document = {"minutes": 60}


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """A service with one worker for plans and one for simulations, which keeps the cell."""
    folder = tmp_path_factory.mktemp("meshes") / "kept"
    with running(replace(PATIENT, mesh_folder=str(folder))) as client:
        assert client.put(ADDRESS, content=BODY, headers=JSON).status_code == 201
        yield client


def started(service: httpx.Client, question: Document, address: str = f"{ADDRESS}/simulations") -> str:
    response = service.post(address, json=question)
    assert response.status_code == 202, response.text
    return str(response.url.join(response.headers["location"]).path)


def begun(service: httpx.Client) -> str:
    """A long simulation that has simulated some seconds."""
    job = started(service, LONG)
    for _, document in events(service, job):
        if (document["progress"] or {}).get("simulated_s", 0.0) > 3.0:
            break
    return job


def cancelled(service: httpx.Client, job: str) -> Document:
    """The last event of a job that is called off twice."""
    for _ in range(2):
        assert service.delete(job).status_code == 200
    name, last = [*events(service, job)][-1]
    assert name == last["state"] == "cancelled"
    return last


@pytest.mark.parametrize("cell", [None, CELL, TEXT], ids=["kept", "document", "text"])
def test_a_simulation_gives_what_python_gives_and_a_page(service: httpx.Client, cell: object) -> None:
    job = started(service, *((BRIEF,) if cell is None else ({**BRIEF, "cell": cell}, "v1/simulations")))
    told = [*events(service, job)]
    assert told[-1][0] == "done"
    assert (told[-1][1]["outcome"], told[-1][1]["problem"]) == ("complete", None)
    shares = [of["progress"]["share"] for _, of in told if (of["progress"] or {}).get("stage") == "runs"]
    assert shares == sorted(shares)
    seeds = [of["progress"]["seed"] for _, of in told if (of["progress"] or {}).get("seed")]
    assert seeds == sorted(seeds)
    assert {1} <= set(seeds) <= {1, 2}  # a run that is over before the next report is in none
    found = service.get(f"{job}/answer").json()
    assert found == json.loads(json.dumps(assur.simulate(CELL, **BRIEF)))
    page = service.get(f"{job}/page")
    assert page.headers["content-type"].startswith("text/html")
    first = found["runs"][0]
    assert f"<dd>{first['picked']}, {first['placed']}</dd>" in page.text


def test_values_are_set_and_what_would_help_is_tried(service: httpx.Client) -> None:
    values = {"streams.soap.mean_s": 0.8, "kinds.soap.dwell_ms": 900}
    job = started(service, {"minutes": 0.25, "set": values, "helps": True})
    told = [*events(service, job)]
    assert "no dwell" in {(of["progress"] or {}).get("change") for _, of in told}
    found = service.get(f"{job}/answer").json()
    assert "no dwell" in {row["what"] for row in found["helps"] if row["percent"] is not None}


def test_what_is_simulated_by_then_stays_of_a_simulation_that_is_called_off(service: httpx.Client) -> None:
    job = begun(service)
    assert service.get(f"{job}/answer").json()["type"] == "urn:assur:problem:job-not-done"
    assert cancelled(service, job)["outcome"] == "incomplete"
    found = service.get(f"{job}/answer").json()
    assert not found["complete"]
    assert 3.0 < found["runs"][0]["simulated_s"] < 3600.0
    assert service.get(f"{job}/page").json()["type"] == "urn:assur:problem:no-page"


def test_plans_are_made_while_all_workers_for_simulations_work(service: httpx.Client, small: Document) -> None:
    job = begun(service)
    for _ in range(3):
        assert service.post("v1/plans", json=small).json()["status"] == "planned"
    assert service.get(job).json()["state"] == "working"
    assert cancelled(service, job)["outcome"] == "incomplete"


def test_simulations_wait_for_their_turn_in_a_queue_with_a_bound(service: httpx.Client) -> None:
    job = begun(service)
    waiting = [started(service, {**BRIEF, "seed": seed}) for seed in range(PATIENT.queue)]
    refused = service.post(f"{ADDRESS}/simulations", json=LONG)
    assert (refused.status_code, refused.json()["type"]) == (503, "urn:assur:problem:busy")
    assert int(refused.headers["retry-after"]) > 1
    for each in waiting[1:]:
        assert service.get(each).json()["progress"] is None
        assert service.delete(each).status_code == 200
        assert [*events(service, each)][-1][1]["state"] == "cancelled"
        assert service.get(f"{each}/answer").json()["type"] == "urn:assur:problem:job-not-done"
    assert cancelled(service, job)["outcome"] == "incomplete"
    assert [*events(service, waiting[0])][-1][1]["outcome"] == "complete"


@pytest.mark.parametrize(
    ("question", "field", "allowed"),
    [
        ({"minute": 3}, "minute", "no field but minutes, seed, seeds"),
        ({"cell": CELL}, "cell", "no field but"),
        ({"minutes": "x"}, "minutes", "a finite number"),
        ({"minutes": 0}, "minutes", "0.01 to 1440"),
        ({"minutes": 61}, "minutes", "at most 60"),
        ({"minutes": 7, "seeds": 10}, "minutes", "at most 6 with seeds 10: ASSUR_MAX_SIMULATED_MINUTES is 60"),
        ({"seed": -1}, "seed", "a whole number"),
        ({"seeds": 1.5}, "seeds", "a whole number, 1 to 1000"),
        ({"seeds": True}, "seeds", "a whole number"),
        ({"planning_ms": 1e9}, "planning_ms", "0 to 60000"),
        ({"set": []}, "set", "an object"),
        ({"set": {f"options.{i}": 1 for i in range(257)}}, "set", "at most 256"),
        ({"helps": 1}, "helps", "true or false"),
    ],
)
def test_a_question_that_is_not_right_is_no_job(
    service: httpx.Client, question: Document, field: str, allowed: str
) -> None:
    refused = service.post(f"{ADDRESS}/simulations", json=question)
    (error,) = refused.json()["errors"]
    assert (refused.status_code, error["field"]) == (422, field)
    assert allowed in error["allowed"]


@pytest.mark.parametrize(
    ("question", "field", "allowed"),
    [
        ({"set": {"stream.soap.mean_s": 1}}, "set.stream.soap.mean_s", "did you mean streams?"),
        ({"set": {"streams.soap.mean_s": 0.1}}, "set.streams.soap.mean_s", "0.4807 s or more"),
        ({"planning_ms": 6000}, "planning_ms", "at most 450 ms"),
        ({"minutes": 0.02}, "minutes", "so long that a part of each stream is known"),
        ({"cell": WITHOUT_STREAMS}, "cell.streams", "at least one stream"),
        ({"cell": {"schema": "assur-cell/1"}}, "cell.robot", "must be given"),
    ],
)  # fmt: skip
def test_a_fault_of_the_cell_ends_the_job_and_is_named(
    service: httpx.Client, question: Document, field: str, allowed: str
) -> None:
    job = started(service, {"cell": CELL, **question}, "v1/simulations")
    _, last = [*events(service, job)][-1]
    assert (last["state"], last["problem"]["status"]) == ("failed", 422)
    errors = {error["field"]: error["allowed"] for error in last["problem"]["errors"]}
    assert allowed in errors[field], errors
    assert service.get(f"{job}/page").json() == service.get(f"{job}/answer").json() == last["problem"]


@pytest.mark.parametrize(
    ("text", "values", "field", "line"),
    [
        (TEXT.replace("kind: soap", "kind: sop"), {}, "cell: streams.soap.kind", 29),
        (TEXT, {"streams.soap.kind": "sop"}, "set.streams.soap.kind", None),
        (TEXT.partition("streams:")[0], {}, "cell: streams", 1),
        ("schema: [", {}, "cell", 2),
        ("[]", {}, "cell", 1),
        ("schema: 1\nschema: 2", {}, "cell: schema", 2),
    ],
)
def test_a_fault_of_a_text_has_its_line(
    service: httpx.Client, text: str, values: Document, field: str, line: int | None
) -> None:
    _, last = [*events(service, started(service, {"cell": text, "set": values}, "v1/simulations"))][-1]
    error = last["problem"]["errors"][0]
    assert (error["field"], error.get("line")) == (field, line), error


def test_a_cell_that_is_not_there_or_not_given_is_refused(service: httpx.Client) -> None:
    unknown = service.post(f"v1/cells/{'0' * 64}/simulations", json=BRIEF)
    assert unknown.json()["type"] == "urn:assur:problem:cell-unknown"
    for question in ({}, {"cell": None}, {"cell": [CELL]}):
        refused = service.post("v1/simulations", json=question).json()
        assert refused["errors"][0]["field"] == "cell"


def test_a_plan_has_no_page(service: httpx.Client, small: Document) -> None:
    job = started(service, small, "v1/jobs")
    assert [*events(service, job)][-1][0] == "done"
    assert service.get(f"{job}/page").json()["type"] == "urn:assur:problem:no-page"


def test_a_service_without_workers_for_simulations_makes_none() -> None:
    with running(replace(PATIENT, simulation_workers=0)) as client:
        refused = client.post("v1/simulations", json={"cell": CELL})
        assert (refused.status_code, refused.json()["type"]) == (404, "urn:assur:problem:no-simulations")


def test_a_client_simulates_a_cell_that_it_has_sent_and_one_that_it_sends(service: httpx.Client) -> None:
    there = json.loads(json.dumps(assur.simulate(CELL, minutes=0.1)))
    with assur.Client(str(service.base_url)) as client:
        for cell in (client.put_cell(CELL), CELL, assur.Cell(CELL)):
            assert client.simulate(cell, minutes=0.1) == there
        assert client.simulate(CELL, minutes=0.1, set={"selection": "fifo"})["selection"] == "fifo"
        with pytest.raises(assur.InputError, match=r"minutes: .*at most 60"):
            client.simulate(CELL, minutes=61)
        with pytest.raises(assur.InputError, match=r"minuten: .*no field but minutes"):
            client.simulate(CELL, minuten=1)  # type: ignore[call-arg]
        for other in ("cell.yaml", Path("cell.yaml"), "0" * 63):
            with pytest.raises(assur.InputError, match=r"cell: .*assur\.load reads the one in a file"):
                client.simulate(other)  # type: ignore[arg-type]
        with pytest.raises(assur.InputError, match=r"cell\.streams: .*at least one stream"):
            client.simulate(WITHOUT_STREAMS)


def test_an_interrupt_of_a_client_cancels_its_simulation(
    service: httpx.Client, monkeypatch: pytest.MonkeyPatch
) -> None:
    jobs = list[str]()

    def interrupted(job: str) -> Exchange[None]:
        jobs.append(job)
        raise KeyboardInterrupt

    monkeypatch.setattr(exchange, "end_of", interrupted)
    with assur.Client(str(service.base_url)) as client, pytest.raises(KeyboardInterrupt):
        client.simulate(CELL, minutes=50)
    assert [*events(service, f"v1/jobs/{jobs[0]}")][-1][0] == "cancelled"


def test_an_awaited_client_simulates(service: httpx.Client) -> None:
    async def simulated() -> Any:
        async with assur.AsyncClient(str(service.base_url)) as client:
            return await client.simulate(CELL, minutes=0.1)

    assert asyncio.run(simulated()) == json.loads(json.dumps(assur.simulate(CELL, minutes=0.1)))


@pytest.fixture
def line(monkeypatch: pytest.MonkeyPatch) -> Iterator[Line]:
    """What a job has of the web process, which reads nothing of it; the process keeps its priority."""
    monkeypatch.setattr(os, "setpriority", lambda *_: None)
    ours, theirs = socket.socketpair()
    with ours, theirs:
        yield Line(theirs, About({}, suspect=False, reported=False))


def asked(**question: Any) -> simulation_jobs.Question:
    return question_in(json.dumps({"cell": CELL, **question}).encode(), with_cell=True)


def test_a_simulation_whose_time_is_over_gives_what_is_simulated_by_then(line: Line) -> None:
    found = simulate(None, asked(minutes=10), 0.5, line)
    assert isinstance(found, Answer)
    assert (found.outcome, json.loads(found.body)["complete"]) == ("incomplete", False)
    assert b"parts a minute" in found.page


def test_an_error_that_ends_a_run_is_the_problem(line: Line, monkeypatch: pytest.MonkeyPatch) -> None:
    def step(_: Run) -> None:
        raise FaultError("standing in the refuge is not proved")

    monkeypatch.setattr(Run, "step", step)
    found = simulate(None, asked(), 60.0, line)
    assert isinstance(found, Problem)
    assert (found.kind, found.detail) == ("simulation-fault", "standing in the refuge is not proved")


def test_the_page_is_the_same_without_the_tables_of_later_plans() -> None:
    whole, reduced = Events(), EventsForPage()
    Simulation(CELL, 1.2, 1, 1, 20.0).run(record=Several(whole, reduced))
    assert len(json.dumps(reduced.events)) < 0.95 * len(json.dumps(whole.events))
    pages = [run_report(each.events, title="a", about="", version="0") for each in (whole, reduced)]
    assert pages[0] == pages[1]
