"""Row 1: mutated requests over HTTP. Each answer is one that the service describes; no worker is lost, none is killed
at its time limit, and every line of the log is JSON."""

from __future__ import annotations

import json
import random
import threading
import time
from collections import Counter
from itertools import count
from pathlib import Path
from typing import Any

from benchmarks.soak_service.client import Client, Reply, fetch, together
from benchmarks.soak_service.mutations import MILD, Mutant, mutant
from benchmarks.soak_service.row import Numbers, RowError, Run, above
from benchmarks.soak_service.served import Service, Watch, served

PATH, CHECK_PATH = "/v1/plans", "/v1/plans/check"
REQUESTS, FEW_REQUESTS = 50_000, 400
LONGEST_S = 4000.0
"""A run ends after so long, and says how many requests it has sent."""
CONNECTIONS, WORKERS = 6, 2
FULL_SHARE, FULL_SHARE_OF_MILD = 0.04, 0.25
"""Of all requests, those that ask for the whole certificate; each plan of theirs is checked. Mild ones are planned more
often."""
KEPT = 200
"""Number of failing bodies that are kept."""
TURNED_AWAY = frozenset({429, 503})
MOST_AGAIN, MOST_TURNED_AWAY = 5, 0.01
SETTINGS: dict[str, object] = {
    "workers": WORKERS,
    "max_budget_s": 1.0,
    "max_tasks": 1_000_000,
    "queue": 2 * CONNECTIONS,
}
LIMITS = dict.fromkeys(
    (
        "undocumented", "status_500", "status_504", "worker_crashed", "workers_lost", "no_answer", "not_json",
        "without_field", "log_lines_not_json", "checks_refused",
    ),
    0.0,
)  # fmt: skip


def faults_of(reply: Reply, documented: set[int]) -> list[str]:
    """What is wrong with an answer to a mutant, as keys of the counts."""
    if reply.status == 0:
        return ["no_answer"]
    document = reply.document()
    found = [] if reply.status in documented else ["undocumented"]
    if reply.status == 500:
        found.append("status_500")
    if reply.status == 504:
        found.append("status_504")
    if reply.kind == "worker-crashed":
        found.append("worker_crashed")
    if not isinstance(document, dict):
        found.append("not_json")
    elif reply.status in (400, 422) and not _names_fields(document):
        found.append("without_field")
    return found


def _names_fields(document: dict[str, Any]) -> bool:
    errors = document.get("errors")
    return (
        isinstance(errors, list)
        and bool(errors)
        and all(isinstance(error, dict) and isinstance(error.get("field"), str) and error["field"] for error in errors)
    )


class _Sender:
    """Sends mutants from several connections, and counts."""

    def __init__(self, run: Run, service: Service, total: int) -> None:
        self.run, self.service, self.total = run, service, total
        self.folder = run.below("mutated-requests")
        self.counts: Counter[str] = Counter()
        self.replies: Counter[str] = Counter()
        self.beyond: list[float] = []
        self.sent = 0
        self._numbers, self._lock = count(), threading.Lock()
        self._ends = time.monotonic() + LONGEST_S
        document = description(service)
        self._documented = statuses(document, "post", PATH)
        names = [scene["name"] for scene in fetch(service.port, "/v1/scenes").document()["scenes"]]
        self.scenarios = {name: service.scene(name) for name in names}
        if not self.scenarios:
            raise RowError("GET /v1/scenes gives no scenario")

    def connection(self, number: int, _: threading.Event) -> None:
        """What one connection does until all are sent."""
        client = self.service.client(f"127.0.0.{11 + number}")
        while time.monotonic() < self._ends:
            with self._lock:
                at = next(self._numbers)
            if at >= self.total or self.service.process.poll() is not None:
                break
            self._send(client, mutant(self.run.seed, at, self.scenarios))
        client.close()

    def _send(self, client: Client, sent: Mutant) -> None:
        share = FULL_SHARE_OF_MILD if sent.kind in MILD else FULL_SHARE
        full = random.Random(f"full/{sent.number}").random() < share
        reply = self._answered(client, f"{PATH}?certificate={'full' if full else 'digest'}", sent.body)
        faults = faults_of(reply, self._documented)
        document = reply.document()
        if full and isinstance(document, dict) and document.get("status") == "planned":
            verdict = self._answered(client, CHECK_PATH, b'{"request": %b, "plan": %b}' % (sent.body, reply.body))
            verified = verdict.document()
            good = verdict.status == 200 and isinstance(verified, dict) and verified.get("ok") is True
            self._count("checks")
            if not good:
                faults.append("checks_refused")
        outcome = document.get("status") if reply.status == 200 and isinstance(document, dict) else reply.kind
        with self._lock:
            self.sent += 1
            self.replies[f"{reply.status} {outcome}".strip()] += 1
            self.counts.update(faults)
            if faults and sum(self.counts[name] for name in LIMITS) <= KEPT:
                _keep(self.folder, sent, reply, faults)
            if self.sent % max(1, self.total // 20) == 0:
                self.run.say(f"{self.sent} of {self.total}: {dict(self.replies)}; faults {dict(self.counts)}")

    def _answered(self, client: Client, path: str, body: bytes) -> Reply:
        """The answer; where the service says that it is busy, the request is sent again when it asks for it."""
        reply = client.post(path, body)
        for _ in range(MOST_AGAIN):
            if reply.status not in TURNED_AWAY or reply.kind == "worker-crashed" or "retry-after" not in reply.headers:
                break
            self._count("turned_away")
            time.sleep(min(reply.again_s, 5.0))
            reply = client.post(path, body)
        return reply

    def _count(self, name: str) -> None:
        with self._lock:
            self.counts[name] += 1


def _keep(folder: Path, sent: Mutant, reply: Reply, faults: list[str]) -> None:
    stem = f"{sent.number:06d}-{faults[0]}"
    (folder / f"{stem}.body").write_bytes(sent.body)
    report = {
        "mutation": sent.kind, "scenario": sent.scenario, "faults": faults, "status": reply.status,
        "fault": reply.fault, "seconds": reply.seconds, "answer": reply.body[:4000].decode(errors="replace"),
    }  # fmt: skip
    (folder / f"{stem}.json").write_text(json.dumps(report, indent=1), encoding="utf-8")


def measure(run: Run) -> Numbers:
    """Sends the mutants of a seed to a service with two workers."""
    total = FEW_REQUESTS if run.short else REQUESTS
    began = time.monotonic()
    with served(run.below("logs") / "mutated-requests.log", settings=SETTINGS) as service:
        sender = _Sender(run, service, total)
        idle_mib = service.rss_mib()
        with Watch(service) as watch:
            with together(sender.connection, CONNECTIONS):
                pass
            lost = service.lost()
            rss_mib = service.rss_mib()
        _, bad_lines = service.log_lines()
    took_s = time.monotonic() - began
    return {
        "requests": sender.sent,
        "asked": total,
        "per_second": round(sender.sent / took_s, 1),
        "replies": dict(sorted(sender.replies.items())),
        **{name: sender.counts[name] for name in (*LIMITS, "turned_away", "checks")},
        "workers_lost": int(sum(lost.values())),
        "workers_lost_by_cause": lost,
        "log_lines_not_json": len(bad_lines),
        "examples_of_log_lines": [line[:160] for line in bad_lines[:5]],
        "worker_peak_mib": round(watch.peak_mib),
        "web_mib": [round(idle_mib), round(rss_mib)],
        "seed": run.seed,
    }


def judge(numbers: Numbers) -> list[str]:
    """Every count of faults is 0; all were sent; few were turned away; and some were planned and checked."""
    found = above(numbers, LIMITS)
    if numbers["requests"] < numbers["asked"]:
        found.append(f"only {numbers['requests']} of {numbers['asked']} were sent in {LONGEST_S:g} s")
    if numbers["turned_away"] > MOST_TURNED_AWAY * numbers["requests"]:
        found.append(f"{numbers['turned_away']} were rejected with Retry-After: that measures nothing")
    if not numbers["checks"]:
        found.append("no plan was checked")
    return found


def summary(numbers: Numbers) -> str:
    """Undocumented statuses, 504 and workers lost, of how many."""
    return (
        f"{numbers['undocumented'] + numbers['status_500']} / {numbers['status_504']} / {numbers['workers_lost']} of "
        f"{numbers['requests']:,}; {numbers['checks']} plans checked; "
        f"{numbers['log_lines_not_json']} lines of log not JSON"
    )


def description(service: Service) -> dict[str, Any]:
    """The description of a running service."""
    reply = fetch(service.port, "/openapi.json")
    document = reply.document()
    if reply.status != 200 or not isinstance(document, dict):
        raise RowError(f"/openapi.json was answered with {reply.status} {reply.fault}".strip())
    return document


def statuses(document: dict[str, Any], method: str, path: str) -> set[int]:
    """The statuses that the description has for an operation; all of a hundred where it says 5XX, all for default."""
    found: set[int] = set()
    for status in document["paths"][path][method.lower()]["responses"]:
        if status == "default":
            found |= set(range(100, 600))
        elif status.upper().endswith("XX"):
            found |= set(range(100 * int(status[0]), 100 * int(status[0]) + 100))
        else:
            found.add(int(status))
    return found
