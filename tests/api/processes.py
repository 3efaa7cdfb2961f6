"""A service as a process of its own, with what it logs."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import psutil

from assur.api.workers.worker_process import NAME

ROOT = Path(__file__).parents[2]


@dataclass
class Server:
    """A running `assur serve`, its address, and the lines of its log so far."""

    process: subprocess.Popen[bytes]
    log: list[dict[str, Any]] = field(default_factory=list)
    raw: list[bytes] = field(default_factory=list)

    @property
    def address(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def port(self) -> int:
        until(lambda: bool(self.events("listening")) or self.process.poll() is not None)
        return int(self.events("listening")[0]["port"])

    def client(self) -> httpx.Client:
        return httpx.Client(base_url=self.address, timeout=150.0)

    def ready(self) -> bool:
        with self.client() as client:
            return client.get("/readyz").status_code == 200

    def workers(self) -> list[psutil.Process]:
        """Its worker processes."""
        found = []
        for child in psutil.Process(self.process.pid).children(recursive=True):
            with contextlib.suppress(psutil.Error):
                if child.name() == NAME.decode():
                    found.append(child)
        return found

    def read(self) -> None:
        assert self.process.stderr is not None
        for line in self.process.stderr:
            self.raw.append(line)
            with contextlib.suppress(ValueError):
                self.log.append(json.loads(line))

    def events(self, text: str) -> list[dict[str, Any]]:
        return [line for line in list(self.log) if line["event"] == text]


def until(true: Callable[[], bool], within_s: float = 150.0) -> None:
    """Waits for something that another process does."""
    end = time.monotonic() + within_s
    while not true():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.02)


def environment(others: Mapping[str, str] = os.environ, /, **settings: str) -> dict[str, str]:
    """An environment (default: this process's) with these settings and no others, by their names without the prefix."""
    kept = {name: value for name, value in others.items() if not name.startswith("ASSUR_")}
    return {**kept, **{f"ASSUR_{name}": value for name, value in settings.items()}}


@contextlib.contextmanager
def serving(
    port: int = 0,
    *,
    program: Sequence[str] = (sys.executable, "-m", "assur.api.command_line"),
    folder: Path = ROOT,
    others: Mapping[str, str] = os.environ,
    **settings: str,
) -> Iterator[Server]:
    """A service on `port` (0: any free one), with these settings: a `program` that runs in a `folder`."""
    command, given = [*program, "serve", "--port", str(port)], environment(others, **settings)
    process = subprocess.Popen(command, cwd=folder, env=given, stderr=subprocess.PIPE)
    server = Server(process)
    reader = threading.Thread(target=server.read)
    reader.start()
    try:
        yield server
    finally:
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
        try:
            assert process.wait(60) in (0, -signal.SIGKILL), b"".join(server.raw)
        finally:
            process.kill()
            process.wait()
            reader.join()
            assert process.stderr is not None
            process.stderr.close()
