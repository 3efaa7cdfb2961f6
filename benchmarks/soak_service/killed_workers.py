"""Row 3: a worker is killed every 5 s while four clients send the same request. Only requests in flight at a kill are
lost; no request is quarantined for it, and no answer is wrong."""

from __future__ import annotations

import json
import random
import signal
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import psutil

from benchmarks.soak_service.client import Reply, counted, together, until
from benchmarks.soak_service.row import Numbers, RowError, Run, above
from benchmarks.soak_service.served import Service, served

SECONDS, FEW_SECONDS, BETWEEN_S = 600.0, 30.0, 5.0
CLIENTS, WORKERS = 4, 2
SIGNALS = (signal.SIGKILL, signal.SIGSEGV, signal.SIGABRT)
BEGUN_S = 3.0
"""A younger worker is not killed, s: it may still start, and this row is about workers that plan."""
AFTER_S = 0.25
"""Longest time from the end of a killed worker, as it is measured here, to the answer of its request, s."""
TIMES = ("elapsed_s", "first_s")
"""What differs between two answers to one request."""
LIMITS: dict[str, float] = {
    "lost_beyond": 0,
    "quarantined": 0,
    "wrong": 0,
    "zombies": 0,
    "web_growth_mib": 32,
}


def request_of(service: Service) -> bytes:
    """The request that all send: the demo, ended by its first plan, so that no clock decides."""
    document = service.scene("demo")
    options = {**document.get("options", {}), "stop": "first", "budget_s": 10.0}
    return json.dumps({**document, "options": options}).encode()


def same(reply: Reply) -> Any:
    """An answer without its times."""
    document = reply.document()
    return {key: value for key, value in document.items() if key not in TIMES} if isinstance(document, dict) else None


def lost_beyond(failed: Sequence[tuple[float, float]], kills: Sequence[float]) -> int:
    """How many requests that failed, each from when to when it was under way, are not explained by a kill. A worker has
    one request at a time, so each kill explains one, that was under way at that moment."""
    free = sorted(kills)
    beyond = 0
    for began, ended in sorted(failed, key=lambda each: each[1]):
        explaining = next((kill for kill in free if began <= kill <= ended + AFTER_S), None)
        if explaining is None:
            beyond += 1
        else:
            free.remove(explaining)
    return beyond


def measure(run: Run) -> Numbers:
    """Kills under load, and compares every answer with that of an undisturbed service."""
    lasts_s = run.pick(FEW_SECONDS, SECONDS)
    replies: list[Reply] = []
    kills: list[float] = []
    busy = 0
    with served(run.below("logs") / "killed-workers.log", workers=WORKERS, max_tasks=1_000_000) as service:
        body = request_of(service)
        right = _undisturbed(service, body)
        before_mib = service.rss_mib()

        def asks(number: int, stop: threading.Event) -> None:
            client = service.client(f"127.0.0.{21 + number}")
            while not stop.is_set():
                reply = client.post("/v1/plans", body)
                replies.append(reply)
                if reply.status != 200:
                    stop.wait(min(reply.again_s, 1.0))
            client.close()

        rng, end = random.Random(run.seed), time.monotonic() + lasts_s
        with together(asks, CLIENTS) as stop:
            while not stop.wait(BETWEEN_S) and time.monotonic() < end:
                workers = service.workers()
                if not workers:
                    busy += 1
                    continue
                victim = _victim(rng, workers)
                kills.append(time.monotonic())
                victim.send_signal(SIGNALS[len(kills) % len(SIGNALS)])
                if len(kills) % 10 == 0:
                    run.say(f"{len(kills)} kills, {counted(replies)}")
        until(5.0, lambda: service.zombies() == 0)
        zombies, after_mib = service.zombies(), service.rss_mib()
        lost = service.lost()
    failed = [(reply.began, reply.ended) for reply in replies if reply.status != 200]
    good = [reply for reply in replies if reply.status == 200]
    return {
        "seconds": lasts_s,
        "kills": len(kills),
        "no_worker_to_kill": busy,
        "replies": counted(replies),
        "served": len(good),
        "failed": len(failed),
        "lost_beyond": lost_beyond(failed, kills),
        "quarantined": sum(reply.kind == "quarantined" for reply in replies),
        "wrong": sum(same(reply) != right for reply in good),
        "zombies": zombies,
        "web_mib": [round(before_mib, 1), round(after_mib, 1)],
        "web_growth_mib": round(after_mib - before_mib, 1),
        "workers_lost_by_cause": lost,
    }


def _victim(rng: random.Random, workers: list[psutil.Process]) -> psutil.Process:
    """One of those that have had time to begin; the oldest if none had."""
    now, ages = time.time(), {}
    for worker in workers:
        with suppress(psutil.Error):
            ages[worker] = now - worker.create_time()
    begun = [worker for worker in workers if ages.get(worker, 0.0) > BEGUN_S]
    return rng.choice(begun) if begun else max(workers, key=lambda worker: ages.get(worker, 0.0))


def _undisturbed(service: Service, body: bytes) -> Any:
    client = service.client()
    first, second = (client.post("/v1/plans", body) for _ in range(2))
    client.close()
    if first.status != 200 or same(first) != same(second):
        raise RowError(f"two undisturbed answers to one request differ ({first.status}, {second.status})")
    return same(first)


def judge(numbers: Numbers) -> list[str]:
    """Nothing is lost beyond a kill, and there were kills and answers."""
    found = above(numbers, LIMITS)
    if numbers["kills"] < 0.7 * numbers["seconds"] / BETWEEN_S - 1:
        found.append(f"only {numbers['kills']} kills in {numbers['seconds']:g} s")
    if numbers["served"] < numbers["seconds"]:
        found.append(f"only {numbers['served']} answers in {numbers['seconds']:g} s")
    return found


def summary(numbers: Numbers) -> str:
    """Lost beyond those in flight, of how many."""
    return (
        f"{numbers['lost_beyond']} lost beyond {numbers['failed'] - numbers['lost_beyond']} in flight, "
        f"{numbers['quarantined']} quarantined, {numbers['wrong']} wrong of {numbers['served']:,} served; "
        f"{numbers['kills']} kills"
    )
