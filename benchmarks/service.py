"""``python -m benchmarks.service``: what HTTP adds to a plan, and what a check of documents takes.

A service with one worker runs as a process of its own on a free port; round trips go over one connection, one after
the other. The round trip less the planning time that the answer states is what reading, queueing, writing and the
network cost. Nothing is pinned. Answers are checked by `assur.scenes.check` and by the recheck.
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
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import track

from assur.scenes import check
from benchmarks.checker_refusals import codes_of
from benchmarks.figures import Document, figure, finish, quantile
from benchmarks.judged import judged, problem_set
from benchmarks.machine import ROOT
from benchmarks.translation import Terms, request, unrelated_problem

TRIPS, FEW_TRIPS = 60, 12
BUDGET_S = 5.0
"""Far longer than these problems take: no answer may depend on how busy the machine is."""
START_S = 300.0
WARM = 5
"""Requests before anything is timed."""


def main(quick: Annotated[bool, typer.Option("--quick", help="Few round trips.")] = False) -> None:
    """Measure round trips."""
    parameters: Document = {"trips": FEW_TRIPS if quick else TRIPS}
    problems = problem_set("static")
    solvable = [problem for problem in problems.problems if problem["witness"] is not None][: parameters["trips"]]
    records: dict[str, Document] = {}
    with served() as port:
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
        for i in range(WARM):
            trip(connection, request(unrelated_problem(i, False), problems.limits, Terms()), "full")
        for problem in track(solvable, "service", console=Console(stderr=True)):
            document = request(problem, problems.limits, Terms(BUDGET_S, "first"))
            digest_s, short = trip(connection, document, "digest")
            full_s, whole = trip(connection, document, "full")
            record = {"status": whole["status"], "findings": [f"refused: {code}" for code in codes_of(whole, None)]}
            if whole["status"] == "planned":
                began = time.perf_counter()
                verdict = check(document, whole)
                record["check_s"] = time.perf_counter() - began
                codes = codes_of(whole, verdict["findings"])
                told = whole | {"checked": verdict["ok"], "checker_refused": len(codes), "reason": "; ".join(codes)}
                record["findings"] = judged(problems, problem, told, "position", document)["findings"]
                record["digest_s"], record["full_s"] = digest_s - short["elapsed_s"], full_s - whole["elapsed_s"]
            if short.get("trajectory") != whole.get("trajectory"):
                record["findings"].append("the same request got another answer")
            records[str(problem["id"])] = record

    def at(key: str, share: float) -> Any:
        return lambda rows: quantile([1e3 * row[key] for row in rows if key in row], share)

    name = "HTTP round trip minus planning"
    figures = [
        figure(f"{name}, median, digest", [records], at("digest_s", 0.5), "ms", (1.5,), decimals=2),
        figure(f"{name}, 95 %, digest", [records], at("digest_s", 0.95), "ms", decimals=2),
        figure(f"{name}, median, certificate in full", [records], at("full_s", 0.5), "ms", decimals=2),
        figure("check of documents (assur.scenes.check), median", [records], at("check_s", 0.5), "ms", decimals=2),
    ]
    finish("service", "what HTTP adds to a plan", quick, parameters, records, figures)


@contextmanager
def served() -> Iterator[int]:
    """The port of a service that is ready; it ends with the block."""
    clean = {name: value for name, value in os.environ.items() if not name.startswith("ASSUR_")}
    settings = {"ASSUR_WORKERS": "1", "ASSUR_MAX_TASKS": "100000"}
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


def trip(connection: http.client.HTTPConnection, document: Document, detail: str) -> tuple[float, Document]:
    """Seconds of a round trip, from bytes to bytes, and the answer."""
    body = json.dumps(document).encode()
    began = time.perf_counter()
    connection.request("POST", f"/v1/plans?certificate={detail}", body, {"Content-Type": "application/json"})
    response = connection.getresponse()
    content = response.read()
    elapsed = time.perf_counter() - began
    answer: Document = json.loads(content)
    if response.status != http.client.OK:
        raise RuntimeError(f"HTTP {response.status}: {str(answer)[:300]}")
    return elapsed, answer


if __name__ == "__main__":
    typer.run(main)
