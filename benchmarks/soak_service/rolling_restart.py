"""Row 8: two replicas behind the shipped proxy are restarted one after the other under load. No request is lost, and
the client of each job receives its final state."""

from __future__ import annotations

import json
import threading
import time
from collections import Counter
from contextlib import ExitStack
from typing import Any

from benchmarks.soak_service.client import Client, Reply, counted, fetch, together
from benchmarks.soak_service.greedy_client import body_of
from benchmarks.soak_service.large_bodies import small
from benchmarks.soak_service.proxy import free_port, proxied
from benchmarks.soak_service.row import Numbers, Run, above
from benchmarks.soak_service.served import Service, served

CLIENTS, REPLICAS = 4, 2
ROUNDS, FEW_ROUNDS = 3, 1
SETTLED_S = 3.0
JOBS, JOB_S, STATE_S = 3, 4.0, 60.0
LIMITS: dict[str, float] = {"lost": 0, "jobs_not_told": 0, "ended_badly": 0}
DRAIN_S = 3.0
"""A replica takes requests for so long after the signal to stop, s. The proxy requests its readiness each 0.5 s."""
NAMES = "ab"
"""Names of the replicas, with which the ids of their jobs begin; the proxy has them in this order."""
SETTINGS: dict[str, object] = {
    "workers": 1,
    "max_budget_s": 10.0,
    "drain_s": DRAIN_S,
    "forwarded_from": "127.0.0.1",
}


class _Replicas:
    """The replicas by number, each on a port of its own that it keeps."""

    def __init__(self, run: Run, stack: ExitStack) -> None:
        self._run, self._stack = run, stack
        self.ports = [free_port() for _ in range(REPLICAS)]
        self.services: list[Service] = [self._started(number, 0) for number in range(REPLICAS)]

    def _started(self, number: int, times: int) -> Service:
        log = self._run.below("logs") / f"replica-{number}-{times}.log"
        return self._stack.enter_context(served(log, self.ports[number], SETTINGS, replica=NAMES[number]))

    def restart(self, number: int, times: int) -> tuple[int | None, float]:
        """Its exit code after SIGTERM, and how long the end took, s; then it is ready again."""
        began = time.monotonic()
        code = self.services[number].stop()
        took_s = time.monotonic() - began
        self.services[number] = self._started(number, times)
        return code, took_s


def measure(run: Run) -> Numbers:
    """Restarts each replica in turn while four clients ask through the proxy."""
    replies: list[Reply] = []
    body = small(options={"stop": "first", "budget_s": 5})
    ends: list[tuple[int | None, float]] = []
    jobs: list[str] = []
    with ExitStack() as stack:
        replicas = _Replicas(run, stack)
        long = body_of(replicas.services[0], JOB_S)
        port = stack.enter_context(proxied(run.below("rolling-restart"), replicas.ports))

        def asks(number: int, stop: threading.Event) -> None:
            client = Client(port, f"127.0.0.{61 + number}", timeout=60.0)
            while not stop.is_set():
                replies.append(client.post("/v1/plans?certificate=digest", body))
            client.close()

        with together(asks, CLIENTS):
            for times in range(1, int(run.pick(FEW_ROUNDS, ROUNDS)) + 1):
                for number in range(REPLICAS):
                    time.sleep(SETTLED_S)
                    places = [_posted(port, long) for _ in range(JOBS)]
                    ends.append(replicas.restart(number, times))
                    jobs += [_final_state(port, place) for place in places]
                    run.say(f"replica {number}: {ends[-1]}; {counted(replies)}; jobs {jobs}")
            time.sleep(SETTLED_S)
    failed = [reply for reply in replies if reply.status != 200]
    return {
        "restarts": len(ends),
        "requests": len(replies),
        "lost": len(failed),
        "lost_by": counted(failed),
        "ended_badly": sum(code != 0 for code, _ in ends),
        "longest_end_s": round(max(took_s for _, took_s in ends), 1),
        "jobs": dict(Counter(jobs)),
        "jobs_not_told": sum(job.startswith("?") for job in jobs),
    }


def _posted(port: int, body: bytes) -> str | None:
    """The address of the accepted job; None if the service rejected it."""
    reply = fetch(port, "/v1/jobs", body, "127.0.0.71", timeout=30.0)
    document: Any = reply.document()
    return f"/v1/jobs/{document['id']}" if reply.status == 202 and isinstance(document, dict) else None


def _final_state(port: int, place: str | None) -> str:
    """The final state that the client of a job receives; it begins with ? if none comes in time."""
    if place is None:
        return "not accepted"
    client = Client(port, "127.0.0.71", timeout=30.0)
    end = time.monotonic() + STATE_S
    state_or_fault = "? nothing"
    while time.monotonic() < end:
        reply = client.get(place)
        document: Any = reply.document()
        state = document.get("state", reply.kind) if isinstance(document, dict) else reply.fault
        state_or_fault = f"? {reply.status} {state}"
        if reply.status == 404 and state == "job-lost":
            state_or_fault = "lost, and told so"
            break
        if reply.status == 200 and state in ("done", "failed", "cancelled"):
            state_or_fault = str(state)
            break
        time.sleep(0.2)
    client.close()
    return state_or_fault


def judge(numbers: Numbers) -> list[str]:
    """Nothing is lost, each job's client gets its state, each replica ends with exit code 0; and there was load."""
    found = above(numbers, LIMITS)
    if numbers["requests"] < 10 * numbers["restarts"] or not numbers["restarts"]:
        found.append(f"{numbers['requests']} requests for {numbers['restarts']} restarts: no load")
    if not numbers["jobs"] or set(numbers["jobs"]) == {"not accepted"}:
        found.append("no job was accepted")
    return found


def summary(numbers: Numbers) -> str:
    """Requests lost, of how many; what became of the jobs."""
    jobs = json.dumps(numbers["jobs"]).strip("{}").replace('"', "")
    return f"{numbers['lost']} of {numbers['requests']:,}, {numbers['restarts']} restarts; jobs: {jobs}"
