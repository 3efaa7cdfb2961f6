"""The HTTP service: what it adds to a plan, and what a second worker brings.

Two services run side by side, one with one worker and one with two, each a process of its own on a free port. Round
trips go to the first over one connection, one after the other: the round trip less the planning time that the answer
states is what reading, queueing, writing and the network cost. For throughput, four connections keep both services
busy in turn, with `stop: budget` and `budget_s: 0.2`. Nothing is pinned here. Answers are checked by
`assur.scenes.check` and by the recheck.
"""

from __future__ import annotations

import http.client
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from threading import Thread
from typing import Any

import numpy as np

from assur.scenes import check
from benchmarks.figures import figure, quantile
from benchmarks.judged import problem_set, said
from benchmarks.machine import ROOT
from benchmarks.recheck.findings import recheck
from benchmarks.section import Document, Item, Records, Section, Summary
from benchmarks.translation import Manners, request, unrelated_problem

TRIPS, FEW_TRIPS = 60, 12
ROUNDS, FEW_ROUNDS = 5, 2
LOAD, FEW_LOAD = 40, 12
CONNECTIONS = 4
BUDGET_S = 0.2
TRIP_BUDGET_S = 5.0
"""Far longer than these problems take: no answer may depend on how busy the machine is."""
START_S = 180.0
WORKERS = (1, 2)
WARM = 5
"""Requests before anything is timed: connections, and workers once more."""


def parameters(quick: bool) -> Document:
    return {
        "trips": FEW_TRIPS if quick else TRIPS,
        "rounds": FEW_ROUNDS if quick else ROUNDS,
        "load": FEW_LOAD if quick else LOAD,
        "connections": CONNECTIONS,
        "budget_s": BUDGET_S,
    }


def items(parameters: Document) -> list[Item]:
    """Round trips with the proof in full and without, and the rounds of load."""
    solvable = [problem["id"] for problem in problem_set("static").problems if problem["witness"] is not None]
    trips = [f"trip/{name}/{detail}" for name in solvable[: parameters["trips"]] for detail in ("full", "digest")]
    return [Item("service", name) for name in [*trips, *(f"load/{i}" for i in range(parameters["rounds"]))]]


@contextmanager
def served(workers: int) -> Iterator[int]:
    """The port of a service that is ready; it ends with the block."""
    clean = {name: value for name, value in os.environ.items() if not name.startswith("ASSUR_")}
    settings = {"ASSUR_WORKERS": str(workers), "ASSUR_QUEUE": "64", "ASSUR_MAX_TASKS": "100000"}
    command = [sys.executable, "-m", "assur.api.command_line", "serve", "--port", "0"]
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder, "log")
        with log.open("wb") as stream:
            process = subprocess.Popen(command, cwd=ROOT, env=clean | settings, stderr=stream, stdout=stream)
        try:
            end = time.monotonic() + START_S
            while '"ready": true' not in (text := log.read_text(encoding="utf-8")):
                if process.poll() is not None or time.monotonic() > end:
                    raise RuntimeError(f"the service does not start: {text[-500:]}")
                time.sleep(0.05)
            found = re.search(r'"event": "listening".*"port": (\d+)', text)
            if found is None:
                raise RuntimeError(f"the service names no port: {text[-500:]}")
            yield int(found.group(1))
        finally:
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


class Client:
    """One connection that is kept."""

    def __init__(self, port: int) -> None:
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)

    def plan(self, document: Document, detail: str) -> tuple[float, Document]:
        """Seconds of the round trip, from bytes to bytes, and the answer."""
        body = json.dumps(document).encode()
        headers = {"Content-Type": "application/json"}
        began = time.perf_counter()
        self.connection.request("POST", f"/v1/plans?certificate={detail}", body, headers)
        response = self.connection.getresponse()
        content = response.read()
        elapsed = time.perf_counter() - began
        answer = json.loads(content)
        if response.status != http.client.OK:
            raise RuntimeError(f"HTTP {response.status}: {str(answer)[:300]}")
        return elapsed, answer


@contextmanager
def measuring(parameters: Document, _group: str) -> Iterator[Callable[[str], Document]]:
    problems = problem_set("static")
    by_id = {problem["id"]: problem for problem in problems.problems}
    with ExitStack() as stack:
        ports = {workers: stack.enter_context(served(workers)) for workers in WORKERS}
        one = Client(ports[1])
        for i in range(WARM):
            for port in ports.values():
                Client(port).plan(request(unrelated_problem(i, False), problems.limits, Manners()), "full")
            one.plan(request(unrelated_problem(i, False), problems.limits, Manners()), "full")

        def trip(name: str, detail: str) -> Document:
            asked = request(by_id[name], problems.limits, Manners(TRIP_BUDGET_S, "first"))
            trip_s, answer = one.plan(asked, detail)
            record = {"trip_s": trip_s, "planning_s": answer["elapsed_s"], "status": answer["status"]}
            unlike = []
            if answer["status"] == "planned" and detail == "digest":
                # the proof is not in it: the same request again, in full, must be the same answer
                whole = one.plan(asked, "full")[1]
                if whole.get("trajectory") != answer["trajectory"]:
                    unlike = ["the same request got another answer"]
                answer = whole
            record["answers"] = int(answer["status"] == "planned")
            return record | {"findings": unlike + wrong(name, asked, answer)}

        def wrong(name: str, asked: Document, answer: Document) -> list[str]:
            if answer["status"] != "planned":
                return []
            verdict = check(asked, answer)
            line = {
                "status": "planned",
                "checked": verdict["ok"],
                "duration_s": answer["duration_s"],
                "trajectory": answer["trajectory"],
            }
            return [said(finding) for finding in recheck(problems, by_id[name], line, "position")]

        def load(number: int) -> Document:
            rates: Document = {}
            findings: list[str] = []
            planned = 0
            for workers in WORKERS if number % 2 else reversed(WORKERS):
                seconds, answers = under_load(ports[workers], number)
                rates[str(workers)] = len(answers) / seconds
                for name, asked, answer in answers:
                    findings += wrong(name, asked, answer)
                    planned += answer["status"] == "planned"
            return {"rates": rates, "findings": findings, "answers": planned}

        def under_load(port: int, number: int) -> tuple[float, list[tuple[str, Document, Document]]]:
            names = [problem["id"] for problem in problems.problems if problem["direct"]]
            waiting = [names[(number + i) % len(names)] for i in range(parameters["load"])]
            answers: list[tuple[str, Document, Document]] = []
            failures: list[str] = []
            asked = {
                name: request(by_id[name], problems.limits, Manners(parameters["budget_s"], "budget"))
                for name in set(waiting)
            }

            def work() -> None:
                client = Client(port)
                while True:
                    try:
                        name = waiting.pop()
                    except IndexError:
                        return
                    try:
                        answers.append((name, asked[name], client.plan(asked[name], "full")[1]))
                    except (RuntimeError, OSError, http.client.HTTPException) as error:
                        failures.append(str(error))
                        return

            threads = [Thread(target=work) for _ in range(parameters["connections"])]
            began = time.perf_counter()
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            seconds = time.perf_counter() - began
            if failures:
                raise RuntimeError(failures[0])
            return seconds, answers

        def measure(item: str) -> Document:
            kind, *rest = item.split("/")
            return trip(rest[0], rest[1]) if kind == "trip" else load(int(rest[0]))

        yield measure


def summary(_parameters: Document, records: Records) -> Summary:
    trips = {
        detail: {item: r for item, r in records.items() if item.startswith("trip/") and item.endswith("/" + detail)}
        for detail in ("full", "digest")
    }
    loads = {item: r for item, r in records.items() if item.startswith("load/")}

    def added(share: float) -> Callable[[Any], float | None]:
        return lambda rows: quantile(
            [1e3 * (r["trip_s"] - r["planning_s"]) for r in rows if r["status"] == "planned"], share
        )

    def rate(workers: str) -> Callable[[Any], float]:
        return lambda rows: float(np.median([r["rates"][workers] for r in rows]))

    def speed_up(rows: Any) -> float:
        return float(np.median([r["rates"]["2"] / r["rates"]["1"] for r in rows]))

    name = "HTTP round trip minus planning"
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    note = f"{cores} cores for two workers, the web process and the client"
    figures = (
        figure(f"{name}, median", trips["full"], added(0.5), "ms", note="certificate in full"),
        figure(f"{name}, 95 %", trips["full"], added(0.95), "ms"),
        figure(f"{name}, median, digest only", trips["digest"], added(0.5), "ms"),
        figure("two workers over one", loads, speed_up, "times", note=note),
        figure("one worker", loads, rate("1"), "requests/s"),
        figure("two workers", loads, rate("2"), "requests/s"),
    )
    return Summary(figures)


SECTION = Section(
    "service", "what HTTP adds, and what a second worker brings", parameters, items, measuring, summary, one_core=False
)
