"""What the operator decides, read from the environment once: `Settings.from_environment()`.

Every variable begins with `ASSUR_`. A variable of that prefix that is not known is refused, for a misspelt limit is
a limit that is not there. The table in docs/operating.md is held to this module by a test.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from ipaddress import ip_network
from math import isfinite
from typing import Any

from assur.api.container import memory_mib, processors
from assur.api.workers.memory import MEMORY_MIB
from assur.planner.errors import InputError
from assur.scenes.bounds import MAX_BUDGET_S
from assur.scenes.meshes.folder import MeshFolder

PREFIX = "ASSUR_"
LOG_LEVELS = ("debug", "info", "warning", "error")

WEB_MIB = 512
"""What the web process may need, MiB: 76 when idle; what large bodies of several clients take at a time is the rest."""
LEAST_MIB = 512
"""A worker with less could not even plan once, MiB."""
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


def _name(name: str, text: str) -> str:
    if text and not re.fullmatch("[a-z0-9]([a-z0-9-]{0,61}[a-z0-9])?", text):
        raise InputError(name, text, "up to 63 letters from a to z, digits and hyphens within, or nothing")
    return text


def _mark(name: str, text: str) -> str:
    if not re.fullmatch(r"[0-9A-Za-z._+-]{0,64}", text):
        raise InputError(name, text, "up to 64 letters, digits and . _ + -")
    return text


def _text(name: str, text: str) -> str:
    if len(text) > 1000 or not text.isprintable():
        raise InputError(name, text, "up to 1,000 characters that can be printed")
    return text


def _networks(name: str, text: str) -> str:
    for part in text.split(",") if text else ():
        try:
            ip_network(part.strip())
        except ValueError:
            raise InputError(name, text, "addresses or networks, with commas between them") from None
    return text


def _folder(name: str, text: str) -> str:
    if "\0" in text or len(text) > 4096:
        raise InputError(name, text, "the path of a folder")
    return text


def _setting(default: Any, read: Callable[[str, str], Any], about: str) -> Any:
    return field(default=default, metadata={"read": read, "about": about})


@dataclass(frozen=True)
class Settings:
    """Settings of the service; see the `about` of each field. Seconds, bytes, counts."""

    host: str = _setting("127.0.0.1", _host, "address to listen on; in the container 0.0.0.0")
    port: int = _setting(8000, _whole(0, 65535), "port to listen on; 0: any free one")
    workers: int = _setting(0, _whole(0, 256), "worker processes; 0: one per processor that the container may use")
    queue: int = _setting(32, _whole(0, 10_000), "requests that may wait for a worker; one more gets 503")
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
        0,
        _whole(0, 1 << 20),
        "memory of a worker; a request that needs more ends it; 0: what the container leaves it, at most 2048",
    )
    jobs_kept: int = _setting(50, _whole(1, 10_000), "jobs that have ended and are kept; the oldest goes first")
    job_kept_s: float = _setting(600.0, _seconds(1.0, 86_400.0), "time for which a job is kept that has ended")
    connections: int = _setting(
        512, _whole(1, 100_000), "connections at a time; beyond it the one is closed that has been idle longest"
    )
    log_level: str = _setting("info", _one_of(*LOG_LEVELS), "least severity that is logged")
    short_s: float = _setting(
        2.0,
        _seconds(0.0, 120.0),
        "a request whose budgets are at most this in sum is short, as checks and the like are",
    )
    short_workers: int = _setting(
        1, _whole(0, 256), "workers that take only short requests; one at the least is left for all others"
    )
    client_running: int = _setting(0, _whole(0, 10_000), "requests of a client that are worked on; 0: no limit")
    client_waiting: int = _setting(8, _whole(0, 10_000), "requests of a client that may wait; one more gets 429")
    client_seconds: int = _setting(
        0, _whole(0, 1_000_000), "seconds of workers that a client has each minute; then 429; 0: no limit"
    )
    keys_file: str = _setting("", _text, "file of API keys, which `assur keys` makes; without one nobody needs a key")
    forwarded_from: str = _setting(
        "", _networks, "proxies whose X-Forwarded-For says who asks: addresses or networks, with commas between them"
    )
    quarantine_s: float = _setting(
        600.0, _seconds(1.0, 86_400.0), "time for which a request is refused that ended three workers"
    )
    replica: str = _setting(
        "", _name, "name with which the ids of jobs begin, for a proxy with several services behind it"
    )
    results_mib: int = _setting(0, _whole(0, 1 << 20), "memory for answers that are kept and given again; 0: none is")
    commit: str = _setting("", _mark, "what /v1/version says of where the build comes from")
    mesh_folder: str = _setting(
        "", _folder, "folder for uploaded meshes and for covers, shared by workers and restarts; empty: none"
    )
    mesh_quota_mib: int = _setting(1024, _whole(1, 1 << 20), "room that files in that folder may take")
    mesh_kept_s: float = _setting(
        604_800.0, _seconds(1.0, 1e9), "time for which a file in that folder is kept after its last use"
    )
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

    @staticmethod
    def of_meshes(environment: Mapping[str, str]) -> Settings:
        """The settings of the folder for meshes alone, for a program that is no service. Raises `InputError`."""
        given = {name: text for name, text in environment.items() if name.startswith(f"{PREFIX}MESH_")}
        return Settings.from_environment(given)

    def folder_of_meshes(self) -> MeshFolder | None:
        """The folder for meshes; None: there is none. Raises `InputError` where it cannot be read and written."""
        if not self.mesh_folder:
            return None
        quota = self.mesh_quota_mib << 20
        return MeshFolder.at(self.mesh_folder, quota, self.mesh_kept_s, f"{PREFIX}MESH_FOLDER")

    @property
    def processes(self) -> int:
        """How many worker processes there are."""
        return self.workers or processors()

    @property
    def reserved(self) -> int:
        """How many of them take only short requests."""
        return min(self.short_workers, self.processes - 1)

    @property
    def worker_mib(self) -> int:
        """How much memory a worker may have of its own, MiB. Raises `InputError` where there is not so much for all
        workers in the container."""
        has, most = memory_mib(), self.worker_memory_mib or MEMORY_MIB
        share = most if has is None else (has - WEB_MIB) // self.processes
        if self.worker_memory_mib == 0:
            most = min(most, share)
        if not LEAST_MIB <= most <= share:
            raise InputError(
                "ASSUR_WORKERS, ASSUR_WORKER_MEMORY_MIB",
                f"{self.processes}, {self.worker_memory_mib}",
                f"workers of at least {LEAST_MIB} MiB each which, with {WEB_MIB} MiB for the web process, fit in "
                + ("any container" if has is None else f"the {has} MiB of this container"),
            )
        return most

    @property
    def stop_s(self) -> float:
        """How long a stopping service may take: what it has accepted is read, waits, is planned and is written."""
        return self.body_s + self.queue_wait_s + max(2 * self.max_budget_s + self.grace_s, self.check_s) + 5.0
