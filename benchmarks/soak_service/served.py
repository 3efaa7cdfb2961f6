"""A service in a process of its own, observed from outside: its address, log, worker processes and their memory."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

import psutil

from benchmarks.machine import ROOT
from benchmarks.soak_service.client import Client, fetch, until
from benchmarks.soak_service.row import RowError

START_S, STOP_S = 180.0, 200.0
"""Longest start and longest stop of a service, s."""
WATCHED_S = 0.05
"""Time between two observations of the processes, s."""
MIB = 1 << 20
LOST = re.compile(r"^assur_worker_restarts_total\{(.*)\}\s+([\d.e+]+)$", re.MULTILINE)
"""Lines of /metrics that count workers by the cause of their end."""
PLANNED = frozenset({"max_tasks"})
"""Causes that are no loss: the service replaced a worker after its number of requests."""
TRACKER = "resource_tracker"
"""In the command of a process that is no worker."""
T = TypeVar("T")


class Service:
    """A running service; see `served`."""

    def __init__(self, process: subprocess.Popen[bytes], log: Path) -> None:
        self.process = process
        self.log = log
        self.web = psutil.Process(process.pid)
        self.port = 0

    def client(self, source: str = "127.0.0.1", key: str | None = None, timeout: float = 120.0) -> Client:
        """A client at `source`, with an API key or without."""
        return Client(self.port, source, {"Authorization": f"Bearer {key}"} if key else {}, timeout)

    def scene(self, name: str) -> dict[str, Any]:
        """The request of a shipped scenario. Raises `RowError` where it is not there."""
        document = fetch(self.port, f"/v1/scenes/{name}").document()
        if not (isinstance(document, dict) and "task" in document):
            raise RowError(f"the scenario {name} is not there")
        return document

    @property
    def ready(self) -> bool:
        """Whether it takes requests."""
        return fetch(self.port, "/readyz", timeout=5.0).status == 200

    def workers(self) -> list[psutil.Process]:
        """The worker processes that live: what the web process has spawned, or had forked from a template, but for the
        template and the tracker of multiprocessing."""
        # one that has just ended is not one to count
        living = {child.pid: (child, _read(child.cmdline, [TRACKER])) for child in self._children()}
        commands = {pid: " ".join(words) for pid, (_, words) in living.items()}
        found = []
        for child, _ in living.values():
            command = commands[child.pid]
            template = "forkserver" in command and "forkserver" not in commands.get(_read(child.ppid, 0), "")
            if not template and TRACKER not in command:
                found.append(child)
        return found

    def zombies(self) -> int:
        """Processes below the web process that have ended and were not waited for."""
        return sum(_read(child.status, "") == psutil.STATUS_ZOMBIE for child in _listed(self.web))

    def rss_mib(self) -> float:
        """Resident memory of the web process, MiB."""
        return float(self.web.memory_info().rss) / MIB

    def log_lines(self) -> tuple[list[dict[str, Any]], list[str]]:
        """The lines of the log that are JSON objects, and those that are not."""
        good, bad = [], []
        for line in self.log.read_text(encoding="utf-8", errors="replace").splitlines():
            try:
                document = json.loads(line)
            except ValueError:
                document = None
            if isinstance(document, dict):
                good.append(document)
            else:
                bad.append(line)
        return good, bad

    def lost(self) -> dict[str, float]:
        """Workers that ended without a request to end, by cause, from /metrics."""
        return lost_workers(fetch(self.port, "/metrics", timeout=10.0).body.decode(errors="replace"))

    def stop(self, patience_s: float = STOP_S) -> int | None:
        """SIGTERM, and the exit code; None where the process had to be killed, so long after."""
        self.process.send_signal(signal.SIGTERM)
        try:
            return self.process.wait(patience_s)
        except subprocess.TimeoutExpired:
            for child in _listed(self.web):
                child.kill()
            self.process.kill()
            self.process.wait()
            return None

    def _children(self) -> list[psutil.Process]:
        return [child for child in _listed(self.web) if _read(child.status, "") not in (psutil.STATUS_ZOMBIE, "")]


def lost_workers(metrics: str) -> dict[str, float]:
    """Numbers of workers that ended, by cause, in a text in the format of Prometheus. Raises `RowError` if it has
    none."""
    found: Counter[str] = Counter()
    lines = LOST.findall(metrics)
    if not lines:
        raise RowError("/metrics does not count the workers that ended")
    for labels, value in lines:
        cause = dict(re.findall(r'(\w+)="([^"]*)"', labels)).get("cause", "unknown")
        if cause not in PLANNED and float(value) > 0:
            found[cause] += float(value)  # type: ignore[assignment]
    return dict(found)


class Watch:
    """Observes the processes of a service while a block runs: which workers there were, and the memory of each."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)
        self.seen: set[int] = set()
        self.peak_kib: Counter[int] = Counter()
        self.web_peak_mib = 0.0

    def __enter__(self) -> Watch:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()

    @property
    def peak_mib(self) -> float:
        """The highest peak of any worker, MiB."""
        return max(self.peak_kib.values(), default=0) / 1024

    def _look(self) -> None:
        while not self._stop.wait(WATCHED_S):
            if self._service.process.poll() is not None:
                return
            living = {worker.pid for worker in self._service.workers()}
            self.seen |= living
            for pid in living:
                self.peak_kib[pid] = max(self.peak_kib[pid], peak_kib(pid))
            try:
                self.web_peak_mib = max(self.web_peak_mib, self._service.rss_mib())
            except psutil.Error:
                return


def peak_kib(pid: int) -> int:
    """Highest resident memory of a process since it began, or since `forget_peak`, KiB; 0 if it is not there."""
    try:
        text = Path(f"/proc/{pid}/status").read_text(encoding="ascii", errors="replace")
    except OSError:
        return 0
    found = re.search(r"^VmHWM:\s+(\d+) kB", text, re.MULTILINE)
    return int(found.group(1)) if found else 0


def forget_peak(pid: int) -> None:
    """Begins anew with the highest resident memory of a process of ours."""
    Path(f"/proc/{pid}/clear_refs").write_text("5", encoding="ascii")


def _read(read: Callable[[], T], ended: T) -> T:
    """What is read of a process; `ended` for one that has just ended."""
    try:
        return read()
    except psutil.Error:
        return ended


def _listed(process: psutil.Process) -> list[psutil.Process]:
    return _read(lambda: process.children(recursive=True), [])


@contextmanager
def served(
    log: Path,
    port: int = 0,
    settings: Mapping[str, object] | None = None,
    patience_s: float = STOP_S,
    **more: object,
) -> Iterator[Service]:
    """A service that is ready, with `settings` and `more` (``workers=2`` is ASSUR_WORKERS); its log is written to
    `log`. It ends with the block, and nothing of it stays: by SIGTERM, and what is left `patience_s` later is killed.

    Raises `RowError` where it does not become ready, as with a setting that it does not know.
    """
    clean = {name: value for name, value in os.environ.items() if not name.startswith("ASSUR_")}
    given = {f"ASSUR_{name.upper()}": str(value) for name, value in {**(settings or {}), **more}.items()}
    command = [sys.executable, "-m", "assur.api.command_line", "serve", "--port", str(port)]
    with log.open("wb") as stream:
        process = subprocess.Popen(command, cwd=ROOT, env=clean | given, stdout=stream, stderr=stream)
    service = Service(process, log)
    try:
        _wait_until_ready(service)
        yield service
    finally:
        if service.process.poll() is None:
            service.stop(patience_s)


def _wait_until_ready(service: Service) -> None:
    def text() -> str:
        return service.log.read_text(encoding="utf-8", errors="replace")

    def listens() -> bool:
        found = re.search(r'"event": "listening".*"port": (\d+)', text())
        service.port = int(found.group(1)) if found else 0
        return service.port > 0 or service.process.poll() is not None

    def ready() -> bool:
        return service.ready or service.process.poll() is not None

    ready_in_time = until(START_S, listens) and until(START_S, ready)
    if service.process.poll() is not None:
        last = next(iter(text().strip().splitlines()[-1:]), "")
        raise RowError(f"the service ended while it started: {last[:300]!r}")
    if not ready_in_time:
        raise RowError(f"the service did not become ready in {START_S:g} s: {text()[-300:]!r}")
