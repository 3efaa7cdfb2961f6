"""Row 7: a client posts a search of 10 s and closes, again and again. The only worker stays ready, and others are
served."""

from __future__ import annotations

import socket
import statistics
import threading
import time
from contextlib import closing

from benchmarks.soak_service.attackers import HEAD
from benchmarks.soak_service.client import Reply, counted, served_times, together
from benchmarks.soak_service.greedy_client import body_of
from benchmarks.soak_service.large_bodies import small
from benchmarks.soak_service.row import Numbers, Run, above
from benchmarks.soak_service.served import served

SECONDS, FEW_SECONDS = 60.0, 16.0
EACH_S, OPEN_S = 2.0, 0.3
"""A post is made each 2 s, and closed so long after, s."""
PROBE_S, QUICK_S = 0.1, 0.4
PLANS = "/v1/plans?certificate=digest"
LIMITS: dict[str, float] = {"readyz_failed": 0, "quick_failed": 0, "workers_lost": 0}


def measure(run: Run) -> Numbers:
    """Aborts posts of a service with one worker, asks /readyz all the time, and for a quick plan now and then."""
    with served(run.below("logs") / "aborted-posts.log", workers=1, max_tasks=1_000_000) as service:
        long, quick = body_of(service, 10.0), small(options={"stop": "first", "budget_s": 5})
        ready: list[Reply] = []
        plans: list[Reply] = []

        def asks(number: int, stop: threading.Event) -> None:
            replies, pause_s = ((ready, PROBE_S), (plans, QUICK_S))[number]
            with closing(service.client(f"127.0.0.{41 + number}", timeout=30.0)) as client:
                while not stop.wait(pause_s):
                    replies.append(client.post(PLANS, quick) if number else client.get("/readyz"))

        aborted, end = 0, time.monotonic() + run.pick(FEW_SECONDS, SECONDS)
        with together(asks, 2):
            while time.monotonic() < end:
                _abort(service.port, long)
                aborted += 1
                time.sleep(EACH_S - OPEN_S)
        lost = service.lost()
    times = served_times(plans)
    return {
        "aborted": aborted,
        "readyz": len(ready),
        "readyz_failed": sum(reply.status != 200 for reply in ready),
        "quick": len(plans),
        "quick_failed": sum(reply.status != 200 for reply in plans),
        "quick_replies": counted(plans),
        "quick_median_s": round(statistics.median(times), 3) if times else None,
        "quick_longest_s": round(max(times), 3) if times else None,
        "workers_lost": int(sum(lost.values())),
        "workers_lost_by_cause": lost,
    }


def _abort(port: int, body: bytes) -> None:
    head = HEAD.format(len(body)).encode()
    with socket.create_connection(("127.0.0.1", port), source_address=("127.0.0.43", 0)) as connection:
        connection.sendall(head + body)
        time.sleep(OPEN_S)


def judge(numbers: Numbers) -> list[str]:
    """Readiness never fails, quick plans are all planned, no worker is lost; and there were posts and plans."""
    found = above(numbers, LIMITS)
    if not (numbers["aborted"] and numbers["readyz"] and numbers["quick"]):
        found.append("nothing was aborted, or nothing was requested")
    return found


def summary(numbers: Numbers) -> str:
    """The share of readiness that failed."""
    share = 100 * numbers["readyz_failed"] / max(1, numbers["readyz"])
    return (
        f"{share:.3g} % of {numbers['readyz']}; {numbers['aborted']} aborts, {numbers['workers_lost']} workers lost; "
        f"{numbers['quick'] - numbers['quick_failed']} of {numbers['quick']} quick plans"
    )
