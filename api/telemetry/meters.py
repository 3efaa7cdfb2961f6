"""The metrics of one service, as Prometheus reads them. A test holds the table in docs/operating.md to this module.

Labels have few values, all of them ours: a route, a status, a kind of problem, a reason. Nothing that a caller sent is
a label.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import Literal, get_args

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Gauge,
    Histogram,
    Info,
    ProcessCollector,
    disable_created_metrics,
    generate_latest,
)
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.metrics_core import Metric
from prometheus_client.registry import Collector

Cause = Literal["crash", "memory", "time", "called_off", "max_tasks", "idle", "start_failure"]
"""Why a worker was replaced: a signal or a fault ended it; it was out of memory; it did not end in its time; its client
left and it did not end soon; it had done its share of requests; it died while idle; it did not start."""
CAUSES: tuple[Cause, ...] = get_args(Cause)
STAGES = (
    "queue",
    "read",
    "build",
    "search",
    "explain",
    "margins",
    "check",
    "simulate",
    "draw",
    "export",
    "ik",
    "write",
)
"""Waiting for a worker; then what a worker does, in the order in which it does it."""
SECONDS = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0, 120.0)
"""Bounds of the histograms, s: from reading a request to the longest that one may take."""


class Meters:
    """Counts what happens in one service. The functions given to `gauge`, `counter` and `memory` are called when the
    metrics are read."""

    def __init__(self) -> None:
        # a series more for each series, with nothing but the time at which it began
        disable_created_metrics()  # type: ignore[no-untyped-call]
        self.registry = CollectorRegistry()
        count = partial(Counter, registry=self.registry)
        measure = partial(Histogram, registry=self.registry, buckets=SECONDS)
        of_answer = ("route", "method", "status", "outcome", "problem")
        self._requests = cache(count("assur_requests", "Requests that were answered.", of_answer).labels)
        about = "Time from the first byte of a request's head to the last of its answer, s."
        self._times = cache(measure("assur_request_seconds", about, ("route",)).labels)
        about = "Time of each stage of a request that a worker answered, s."
        self._stages = cache(measure("assur_stage_seconds", about, ("stage",)).labels)
        about = "Answers of workers, those to jobs, too, by what they say."
        self._answers = cache(count("assur_answers", about, ("work", "outcome", "reason")).labels)
        self._restarts = count("assur_worker_restarts", "Workers that were replaced, by cause.", ("cause",))
        self._turned_away = count(
            "assur_client_refusals", "Requests refused with 429, by kind of problem.", ("problem",)
        )
        about = "Requests for a plan, by whether its answer was kept from before."
        self.results = count("assur_result_cache", about, ("result",))
        self.faults = count("assur_faults", "Faults of the service, and of its workers, that were met.")
        for cause in CAUSES:
            self._restarts.labels(cause)  # there from the start, so that the first one is seen as a rise
        for stage in STAGES:
            self._stages(stage)
        self.build = Info("assur_build", "Which build this is.", registry=self.registry)
        ProcessCollector(registry=self.registry)  # the web process: its memory, processor time, descriptors

    def answered(self, route: str, method: str, status: int, outcome: str, problem: str, seconds: float) -> None:
        """Counts a request. `outcome` and `problem` are empty where there is none."""
        self._requests(route, method, str(status), outcome, problem).inc()
        self._times(route).observe(seconds)
        if status == 429:
            self._turned_away.labels(problem).inc()

    def queued(self, seconds: float) -> None:
        """A request has waited so long for its worker, s."""
        self._stages("queue").observe(seconds)

    def worked(self, work: str, outcome: str, reason: str, seconds: dict[str, float]) -> None:
        """A worker has answered: the kind of `work`, its outcome in a word, the reason of a refusal (else
        empty), and `seconds` by stage."""
        self._answers(work, outcome, reason).inc()
        for stage, each in seconds.items():
            self._stages(stage).observe(each)

    def restarted(self, cause: Cause) -> None:
        """A worker is replaced, or did not start and is started again."""
        self._restarts.labels(cause).inc()

    def gauge(self, name: str, about: str, read: Callable[[], float]) -> None:
        """A number that is read each time the metrics are read."""
        Gauge(name, about, registry=self.registry).set_function(read)

    def counter(self, name: str, about: str, read: Callable[[], float]) -> None:
        """The same for a number that never falls."""
        self.registry.register(Reading(lambda: CounterMetricFamily(name, about, value=read())))

    def memory(self, processes: Callable[[], Mapping[str, int | None]]) -> None:
        """The memory of processes, each known by its number; None: the process does not exist."""
        self.registry.register(Reading(lambda: _memory(processes())))

    def text(self) -> bytes:
        """All metrics in the text format of Prometheus."""
        return generate_latest(self.registry)


class Reading(Collector):
    """A metric that is not counted but read."""

    def __init__(self, read: Callable[[], Metric]) -> None:
        self._read = read

    def describe(self) -> Iterable[Metric]:
        """Nothing: no name is used twice."""
        return ()

    def collect(self) -> Iterable[Metric]:
        """The metric now."""
        yield self._read()


def _memory(processes: Mapping[str, int | None]) -> GaugeMetricFamily:
    about = "Memory in use: of the web process, of each worker, and of their template."
    memory = GaugeMetricFamily("assur_resident_memory_bytes", about, labels=("process",))
    for process, pid in processes.items():
        resident = None if pid is None else resident_bytes(pid)
        if resident is not None:
            memory.add_metric((process,), resident)
    return memory


def parent_of(pid: int) -> int | None:
    """The process from which a process was forked; None where it is gone, or the system does not say."""
    try:
        status = Path(f"/proc/{pid}/status").read_text(encoding="ascii", errors="replace")
    except OSError:
        return None
    found = re.search(r"^PPid:\s*(\d+)$", status, re.MULTILINE)
    return int(found[1]) if found else None


def resident_bytes(pid: int) -> int | None:
    """Memory that a process has in use; None where it is gone, or the system does not say."""
    try:
        pages = Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1]
    except (OSError, IndexError):
        return None
    return int(pages) * os.sysconf("SC_PAGE_SIZE")
