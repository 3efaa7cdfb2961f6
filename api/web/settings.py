"""What the operator decides, read from the environment once: `Settings.from_environment()`.

Every variable begins with `ASSUR_`. A variable of that prefix that is not known is refused, for a misspelt limit is
a limit that is not there. The table in docs/service.md is held to this module by a test.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from math import isfinite
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_BUDGET_S

PREFIX = "ASSUR_"
LOG_LEVELS = ("debug", "info", "warning", "error")

PLAN_BODY_BYTES = 1 << 20
"""Largest body of a plan, 1 MiB: meshes inline included."""
CHECK_BODY_BYTES = 16 << 20
"""Largest body of a check, 16 MiB: a request and a plan with its full certificate."""


def _whole(lowest: int, highest: int) -> Callable[[str, str], int]:
    def read(name: str, text: str) -> int:
        if not (text.isascii() and text.isdigit() and len(text) <= 12 and lowest <= int(text) <= highest):
            raise InputError(name, text, f"a whole number from {lowest} to {highest}")
        return int(text)

    return read


def _seconds(lowest: float, highest: float) -> Callable[[str, str], float]:
    def read(name: str, text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = float("nan")
        if not (isfinite(value) and lowest <= value <= highest):
            raise InputError(name, text, f"seconds from {lowest:g} to {highest:g}")
        return value

    return read


def _one_of(*allowed: str) -> Callable[[str, str], str]:
    def read(name: str, text: str) -> str:
        if text not in allowed:
            raise InputError(name, text, "one of " + ", ".join(allowed))
        return text

    return read


def _host(name: str, text: str) -> str:
    if not text or len(text) > 253 or not all(c.isalnum() or c in ".:-" for c in text) or not text.isascii():
        raise InputError(name, text, "an address or a host name to listen on")
    return text


def _replica(name: str, text: str) -> str:
    if not re.fullmatch(r"(?:[a-z0-9]{1,40})?", text):
        raise InputError(name, text, "up to 40 lower case letters and digits")
    return text


def processors() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)


def _setting(default: Any, read: Callable[[str, str], Any], about: str) -> Any:
    return field(default=default, metadata={"read": read, "about": about})


@dataclass(frozen=True)
class Settings:
    """Settings of the service; see the `about` of each field. Seconds, bytes, counts."""

    host: str = _setting("127.0.0.1", _host, "address to listen on; in the container 0.0.0.0")
    port: int = _setting(8000, _whole(0, 65535), "port to listen on; 0: any free one")
    workers: int = _setting(0, _whole(0, 256), "worker processes; 0: one per processor")
    queue: int = _setting(8, _whole(0, 10_000), "requests that may wait for a worker; one more gets 503")
    queue_wait_s: float = _setting(30.0, _seconds(0.1, 3600.0), "longest wait for a worker; then 503")
    max_budget_s: float = _setting(
        MAX_BUDGET_S, _seconds(0.01, MAX_BUDGET_S), "largest budget_s and explain_budget_s that a request may ask for"
    )
    grace_s: float = _setting(0.5, _seconds(0.1, 60.0), "time beyond both budgets after which a worker is killed")
    check_s: float = _setting(30.0, _seconds(0.1, 600.0), "time after which a check is killed")
    warm_s: float = _setting(120.0, _seconds(1.0, 3600.0), "time a new worker has to plan for the first time")
    body_s: float = _setting(10.0, _seconds(0.1, 600.0), "time in which a body must have arrived; then 408")
    max_tasks: int = _setting(1000, _whole(1, 1_000_000), "requests after which a worker is replaced by a new one")
    worker_memory_mib: int = _setting(
        4096, _whole(512, 1 << 20), "address space of a worker; beyond it the request ends with 503"
    )
    jobs_kept: int = _setting(50, _whole(1, 10_000), "jobs that have ended and are kept; the oldest goes first")
    job_kept_s: float = _setting(600.0, _seconds(1.0, 86_400.0), "time for which a job is kept that has ended")
    connections: int = _setting(
        512, _whole(1, 100_000), "connections at a time; beyond it the one is closed that has been idle longest"
    )
    log_level: str = _setting("info", _one_of(*LOG_LEVELS), "least severity that is logged")
    connections_per_address: int = _setting(256, _whole(1, 100_000), "the same of one address, a proxy's too")
    header_s: float = _setting(
        5.0,
        _seconds(0.1, 600.0),
        "time in which headers must have arrived, from the connection or their first byte on",
    )
    keep_alive_s: float = _setting(75.0, _seconds(0.1, 3600.0), "time for which a connection is kept that is not used")
    write_s: float = _setting(20.0, _seconds(0.1, 3600.0), "time in which a client must take 64 KiB of its answer")
    drain_s: float = _setting(
        0.0, _seconds(0.0, 3600.0), "time after SIGTERM in which /readyz fails and requests are still accepted"
    )
    replica: str = _setting("", _replica, "name of this replica, with which the ids of its jobs begin; empty: none")

    @staticmethod
    def from_environment(environment: Mapping[str, str] | None = None) -> Settings:
        """Settings from the variables of `environment` (default: this process's own).

        Raises `InputError` that names the variable when it is unknown or its value is not allowed.
        """
        given = os.environ if environment is None else environment
        known = {PREFIX + f.name.upper(): f for f in fields(Settings)}
        values: dict[str, Any] = {}
        for name in sorted(name for name in given if name.startswith(PREFIX)):
            if name not in known:
                near = get_close_matches(name, known, n=1)
                meant = f"; did you mean {near[0]}?" if near else ""
                raise InputError(name, given[name], f"one of {', '.join(known)}{meant}")
            values[known[name].name] = known[name].metadata["read"](name, given[name].strip())
        return Settings(**values)

    @property
    def processes(self) -> int:
        """How many worker processes there are."""
        return self.workers or processors()

    @property
    def stop_s(self) -> float:
        """How long a stopping service may take: what it has accepted is read, waits, is planned and is written."""
        return self.body_s + self.queue_wait_s + max(2 * self.max_budget_s + self.grace_s, self.check_s) + 5.0
