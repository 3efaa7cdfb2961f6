"""``python -m benchmarks.service``: what HTTP adds to a plan, and what a check of documents takes.

A service with one worker runs as a process of its own on a free port; round trips go over one connection, one after
the other. The round trip less the planning time that the answer states is what reading, queueing, writing and the
network cost. Nothing is pinned. Answers are checked by `assur.scenes.check` and by the recheck.

The same requests are planned as tasks in cells that were registered before, each between two trips of the other kind.
"""

from __future__ import annotations

import hashlib
import http.client
import json
import tempfile
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from assur.scenes import check
from benchmarks.checker_refusals import codes_of
from benchmarks.figures import Document, figure, finish, progress, quantile
from benchmarks.judged import judged, problem_set
from benchmarks.soak_service.client import Client
from benchmarks.soak_service.served import served
from benchmarks.translation import Terms, request, unrelated_problem

TRIPS, FEW_TRIPS = 60, 12
BUDGET_S = 5.0
"""Far longer than these problems take: no answer may depend on how busy the machine is."""
WARM = 5
"""Requests before anything is timed."""


def main(quick: Annotated[bool, typer.Option("--quick", help="Few round trips.")] = False) -> None:
    """Measure round trips."""
    parameters: Document = {"trips": FEW_TRIPS if quick else TRIPS}
    problems = problem_set("static")
    solvable = [problem for problem in problems.problems if problem["witness"] is not None][: parameters["trips"]]
    records: dict[str, Document] = {}
    with (
        tempfile.TemporaryDirectory() as folder,
        served(Path(folder, "log"), workers=1, max_tasks=100_000, mesh_folder=folder) as service,
    ):
        client = service.client(timeout=60.0)
        for i in range(WARM):
            trip(client, request(unrelated_problem(i, False), problems.limits, Terms()), "full")
        for problem in progress(solvable, "service"):
            document = request(problem, problems.limits, Terms(BUDGET_S, "first"))
            digest_s, short = trip(client, document, "digest")
            full_s, whole = trip(client, document, "full")
            kept_s, kept = in_cell(client, document)
            record = {"status": whole["status"], "findings": [f"refused: {code}" for code in codes_of(whole, None)]}
            if whole["status"] == "planned":
                began = time.perf_counter()
                verdict = check(document, whole)
                record["check_s"] = time.perf_counter() - began
                codes = codes_of(whole, verdict["findings"])
                full = whole | {"checked": verdict["ok"], "checker_refused": len(codes), "reason": "; ".join(codes)}
                record["findings"] = judged(problems, problem, full, "position", document)["findings"]
                record["digest_s"], record["full_s"] = digest_s - short["elapsed_s"], full_s - whole["elapsed_s"]
                record["kept_s"] = kept_s - kept["elapsed_s"]
            if not short.get("trajectory") == whole.get("trajectory") == kept.get("trajectory"):
                record["findings"].append("the same request got another answer")
            records[str(problem["id"])] = record

    def at(key: str, share: float) -> Any:
        return lambda rows: quantile([1e3 * row[key] for row in rows if key in row], share)

    name = "HTTP round trip minus planning"
    figures = [
        figure(f"{name}, median, digest", [records], at("digest_s", 0.5), "ms", (1.5,), decimals=2),
        figure(f"{name}, 95 %, digest", [records], at("digest_s", 0.95), "ms", decimals=2),
        figure(f"{name}, median, certificate in full", [records], at("full_s", 0.5), "ms", decimals=2),
        figure(f"{name}, median, digest, registered cell", [records], at("kept_s", 0.5), "ms", (1.2,), decimals=2),
        figure("check of documents (assur.scenes.check), median", [records], at("check_s", 0.5), "ms", decimals=2),
    ]
    finish("service", "what HTTP adds to a plan", quick, parameters, records, figures)


def trip(client: Client, document: Document, detail: str) -> tuple[float, Document]:
    """Seconds of a round trip, from bytes to bytes, and the answer."""
    reply = client.post(f"/v1/plans?certificate={detail}", json.dumps(document).encode())
    answer: Document = reply.document()
    if reply.status != http.client.OK:
        raise RuntimeError(f"HTTP {reply.status}: {reply.fault or str(answer)[:300]}")
    return reply.seconds, answer


def in_cell(client: Client, document: Document) -> tuple[float, Document]:
    """Seconds of the round trip of a request as a task in its cell, which is registered and was planned once."""
    of_cell = {key: document[key] for key in ("robot", "frames", "bodies", "execution") if key in document}
    cell = json.dumps({"schema": "assur-cell/1", **of_cell}).encode()
    address = f"/v1/cells/{hashlib.sha256(cell).hexdigest()}"
    reply = client.send("PUT", address, cell, {"Content-Type": "application/json"})
    if reply.status not in (http.client.OK, http.client.CREATED):
        raise RuntimeError(f"HTTP {reply.status}: {reply.fault or str(reply.document())[:300]}")
    task = {"start": document["start"], "steps": document["task"], "options": document["options"]}
    for _ in range(2):
        reply = client.post(f"{address}/plans?certificate=digest", json.dumps(task).encode())
        if reply.status != http.client.OK:
            raise RuntimeError(f"HTTP {reply.status}: {reply.fault or str(reply.document())[:300]}")
    return reply.seconds, reply.document()


if __name__ == "__main__":
    typer.run(main)
