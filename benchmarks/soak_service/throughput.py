"""Row 9: how many requests a second two workers serve, against one request after another in this process. Slices of
both alternate, so that both meet the same machine."""

from __future__ import annotations

import json
import statistics
import threading
import time

from assur.scenes.requests import plan_document
from benchmarks.soak_service.client import Client, Reply, together
from benchmarks.soak_service.row import Numbers, RowError, Run
from benchmarks.soak_service.served import Service, served

SLICES, FEW_SLICES, SLICE_S = 10, 2, 4.0
CLIENTS, WORKERS = 4, 2
LEAST_MS, LEAST_RATIO = 20.0, 1.5
WARM, TIMED = 8, 15
OPTIONS: tuple[dict[str, object], ...] = (
    {},
    {"stop": "budget", "max_candidates": 300},
    {"stop": "budget", "max_candidates": 2000},
)
"""Options in addition to `stop: first`, tried in order until one plan takes long enough."""


def measure(run: Run) -> Numbers:
    """Serves and plans the same requests, each with a seed of its own, in turn."""
    slices = []
    with served(run.below("logs") / "throughput.log", workers=WORKERS, max_tasks=1_000_000) as service:
        document, options, each_ms = _dear_enough(service)
        seeds = iter(range(1, 1_000_000))
        _of_service(service, document, seeds_of(1000), 1.0)
        for _ in range(int(run.pick(FEW_SLICES, SLICES))):
            beside, failed = _of_service(service, document, seeds_of(next(seeds)), SLICE_S)
            alone = _in_process(document, seeds_of(next(seeds)), SLICE_S)
            slices.append({"service": round(beside, 2), "in_process": round(alone, 2), "failed": failed})
            run.say(str(slices[-1]))
    ratios = [each["service"] / each["in_process"] for each in slices]
    return {
        "options": options,
        "plan_ms": round(each_ms, 1),
        "slices": slices,
        "per_second": round(statistics.median(each["service"] for each in slices), 1),
        "in_process_per_second": round(statistics.median(each["in_process"] for each in slices), 1),
        "ratio": round(statistics.median(ratios), 2),
        "failed": sum(each["failed"] for each in slices),
    }


def seeds_of(number: int) -> range:
    """The seeds of a slice: no request is ever sent twice, so that nothing kept from before answers it."""
    return range(100_000 * number, 100_000 * (number + 1))


def _dear_enough(service: Service) -> tuple[dict[str, object], dict[str, object], float]:
    """The demo with options with which one plan takes 20 ms in this process; the options; the median, ms."""
    scene = service.scene("demo")
    for more in OPTIONS:
        options = {"stop": "first", "budget_s": 10.0, **more}
        document = {**scene, "options": {**scene["options"], **options}}
        for seed in range(WARM):
            _planned(document, seed)
        times = []
        for seed in range(TIMED):
            began = time.perf_counter()
            _planned(document, WARM + seed)
            times.append(1e3 * (time.perf_counter() - began))
        if statistics.median(times) >= LEAST_MS:
            return document, options, statistics.median(times)
    raise RowError(f"no options make one plan of the demo take {LEAST_MS:g} ms")


def _planned(document: dict[str, object], seed: int) -> bytes:
    """The answer to a request in this process, read from text and written as text, as a service has to."""
    answer = plan_document(json.loads(_body(document, seed)), certificate="digest")
    if answer["status"] != "planned":
        raise RowError(f"seed {seed} is {answer['status']}")
    return json.dumps(answer).encode()


def _body(document: dict[str, object], seed: int) -> bytes:
    options = document["options"]
    return json.dumps({**document, "options": {**options, "seed": seed}}).encode()  # type: ignore[dict-item]


def _in_process(document: dict[str, object], seeds: range, lasts_s: float) -> float:
    """Plans a second, one after another."""
    began, done = time.perf_counter(), 0
    while time.perf_counter() - began < lasts_s:
        _planned(document, seeds[done])
        done += 1
    return done / (time.perf_counter() - began)


def _of_service(service: Service, document: dict[str, object], seeds: range, lasts_s: float) -> tuple[float, int]:
    """Answers a second of four clients, and how many of their requests failed."""
    replies: list[Reply] = []
    end = time.monotonic() + lasts_s

    def asks(number: int, _: threading.Event) -> None:
        client: Client = service.client(f"127.0.0.{81 + number}")
        own = iter(seeds[number::CLIENTS])
        while time.monotonic() < end:
            replies.append(client.post("/v1/plans?certificate=digest", _body(document, next(own))))
        client.close()

    began = time.monotonic()
    with together(asks, CLIENTS):
        pass
    good = sum(reply.status == 200 for reply in replies)
    return good / (time.monotonic() - began), len(replies) - good


def judge(numbers: Numbers) -> list[str]:
    """One plan takes 20 ms or more, and every request was answered."""
    found = []
    if not numbers["plan_ms"] >= LEAST_MS:
        found.append(f"one plan takes {numbers['plan_ms']} ms, which is less than {LEAST_MS:g}")
    if numbers["failed"]:
        found.append(f"{numbers['failed']} requests failed")
    return found


def judge_times(numbers: Numbers) -> list[str]:
    """The ratio is 1.5 at least."""
    good = numbers["ratio"] >= LEAST_RATIO
    return [] if good else [f"{numbers['ratio']} times, required at least {LEAST_RATIO:g}"]


def summary(numbers: Numbers) -> str:
    """The ratio and what it is made of."""
    options = ", ".join(f"`{key}: {value}`" for key, value in numbers["options"].items())
    return (
        f"{numbers['ratio']} times ({numbers['per_second']} to {numbers['in_process_per_second']} a second, "
        f"{numbers['plan_ms']} ms a plan; {options})"
    )
