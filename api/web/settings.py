"""The settings of the operator, read from the environment once: `Settings.from_environment()`.

Every variable begins with `ASSUR_`. An unknown variable with that prefix is refused, because a misspelt limit would
have no effect. The table in docs/operating.md is held to this module by a test.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from ipaddress import ip_network
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple

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


class Reader(NamedTuple):
    """How a variable is read: `value` gives the value of a text, and None for a text that is not `allowed`."""

    allowed: str
    value: Callable[[str], Any]

    def read(self, name: str, text: str) -> Any:
        """The value of a variable. Raises `InputError` that names it."""
        found = self.value(text)
        if found is None:
            raise InputError(name, text, self.allowed)
        return found


def _whole(lowest: int, highest: int) -> Reader:
    def value(text: str) -> int | None:
        right = text.isascii() and text.isdigit() and len(text) <= 12 and lowest <= int(text) <= highest
        return int(text) if right else None

    return Reader(f"a whole number from {lowest} to {highest}", value)


def _seconds(lowest: float, highest: float) -> Reader:
    def value(text: str) -> float | None:
        try:
            found = float(text)
        except ValueError:
            return None
        return found if isfinite(found) and lowest <= found <= highest else None

    return Reader(f"seconds from {lowest:.10g} to {highest:.10g}", value)


def _one_of(*allowed: str) -> Reader:
    return Reader("one of " + ", ".join(allowed), lambda text: text if text in allowed else None)


def _host(text: str) -> str | None:
    right = text and len(text) <= 253 and all(c.isalnum() or c in ".:-" for c in text) and text.isascii()
    return text if right else None


def _networks(text: str) -> str | None:
    try:
        for part in text.split(",") if text else ():
            ip_network(part.strip())
    except ValueError:
        return None
    return text


def _text(allowed: str, right: Callable[[str], object]) -> Reader:
    return Reader(allowed, lambda text: text if right(text) else None)


HOST = Reader("an address or a host name to listen on", _host)
NETWORKS = Reader("addresses or networks, separated by commas; or empty", _networks)
FILE = _text("up to 1000 printable characters; or empty", lambda text: len(text) <= 1000 and text.isprintable())
FOLDER = _text("the path of a folder; or empty", lambda text: "\0" not in text and len(text) <= 4096)
NAME = _text(
    "up to 63 characters: a to z, 0 to 9, and hyphens between them; or empty",
    re.compile("(?:[a-z0-9](?:[a-z0-9-]{0,61}[a-z0-9])?)?").fullmatch,
)
MARK = _text("up to 64 letters, digits and . _ + -; or empty", re.compile(r"[0-9A-Za-z._+-]{0,64}").fullmatch)


def _setting(default: Any, reader: Reader, about: str) -> Any:
    return field(default=default, metadata={"reader": reader, "about": about})


@dataclass(frozen=True)
class Settings:
    """Settings of the service; see the `about` of each field. Seconds, bytes, counts."""

    host: str = _setting("127.0.0.1", HOST, "address to listen on; in the container 0.0.0.0")
    port: int = _setting(8000, _whole(0, 65535), "port to listen on; 0: any free port")
    workers: int = _setting(0, _whole(0, 256), "worker processes; 0: one per processor that the container may use")
    simulation_workers: int = _setting(
        1,
        _whole(0, 256),
        "further worker processes, for simulations alone; they start with the first one; 0: no simulations",
    )
    max_simulated_minutes: int = _setting(
        60, _whole(1, 100_000), "largest product of minutes and seeds that a simulation may ask for"
    )
    queue: int = _setting(32, _whole(0, 10_000), "requests that may wait for a worker; further ones get 503")
    queue_wait_s: float = _setting(30.0, _seconds(0.1, 3600.0), "longest wait for a worker; then 503")
    max_budget_s: float = _setting(
        MAX_BUDGET_S, _seconds(0.01, MAX_BUDGET_S), "largest budget_s and explain_budget_s that a request may ask for"
    )
    grace_s: float = _setting(
        2.0, _seconds(0.1, 60.0), "extra time of a plan beyond its two budgets; then its worker is killed"
    )
    check_s: float = _setting(30.0, _seconds(0.1, 600.0), "time limit of short work; then its worker is killed")
    warm_s: float = _setting(120.0, _seconds(1.0, 3600.0), "time limit for the first plan of a new worker")
    body_s: float = _setting(10.0, _seconds(0.1, 600.0), "time limit for the body of a request; then 408")
    max_tasks: int = _setting(1000, _whole(1, 1_000_000), "requests after which a worker is replaced")
    worker_memory_mib: int = _setting(
        0,
        _whole(0, 1 << 20),
        "memory limit of a worker, MiB; a worker that needs more ends; 0: what the container has for it, at most 2048",
    )
    jobs_kept: int = _setting(
        50, _whole(1, 10_000), "ended jobs that are kept; the oldest of the client with most is removed first"
    )
    job_kept_s: float = _setting(600.0, _seconds(1.0, 86_400.0), "time for which an ended job is kept")
    connections: int = _setting(
        512,
        _whole(1, 100_000),
        "connections at a time; beyond this, a new one replaces the one that has waited longest for its client",
    )
    log_level: str = _setting("info", _one_of(*LOG_LEVELS), "lowest severity that is logged")
    short_s: float = _setting(2.0, _seconds(0.0, 120.0), "largest sum of budget_s and explain_budget_s of a short plan")
    short_workers: int = _setting(
        1, _whole(0, 256), "workers reserved for short work and short plans; at least one worker is not reserved"
    )
    client_running: int = _setting(0, _whole(0, 10_000), "requests of one client in progress at a time; 0: no limit")
    client_waiting: int = _setting(8, _whole(0, 10_000), "waiting requests of one client; further ones get 429")
    client_seconds: int = _setting(
        0, _whole(0, 1_000_000), "worker seconds of one client per minute; then 429; 0: no limit"
    )
    keys_file: str = _setting("", FILE, "file of API keys, made by `assur keys`; empty: nobody needs a key")
    forwarded_from: str = _setting("", NETWORKS, "proxies whose X-Forwarded-For gives the address of the client")
    quarantine_s: float = _setting(
        600.0, _seconds(1.0, 86_400.0), "time for which a request is refused that ended three workers"
    )
    replica: str = _setting("", NAME, "name with which job ids begin, for a proxy in front of several services")
    results_mib: int = _setting(0, _whole(0, 1 << 20), "memory for answers that are kept and given again, MiB; 0: none")
    commit: str = _setting("", MARK, "commit of the build, as GET /v1/version states it")
    mesh_folder: str = _setting(
        "", FOLDER, "folder for uploaded meshes and for covers, shared by workers and restarts; empty: none"
    )
    mesh_quota_mib: int = _setting(1024, _whole(1, 1 << 20), "total size of the files in that folder, MiB")
    mesh_kept_s: float = _setting(
        604_800.0, _seconds(1.0, 1e9), "time for which a file in that folder is kept after its upload or last use"
    )
    header_s: float = _setting(
        5.0, _seconds(0.1, 600.0), "time limit for the headers, from the connection or from their first byte"
    )
    keep_alive_s: float = _setting(75.0, _seconds(0.1, 3600.0), "time for which an idle connection is kept open")
    drain_s: float = _setting(
        0.0,
        _seconds(0.0, 3600.0),
        "time after SIGTERM in which /readyz fails and requests are still accepted; in the image 5",
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
            values[known[name].name] = known[name].metadata["reader"].read(name, given[name].strip())
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
        share = most if has is None else (has - WEB_MIB) // (self.processes + self.simulation_workers)
        if self.worker_memory_mib == 0:
            most = min(most, share)
        if not LEAST_MIB <= most <= share:
            raise InputError(
                "ASSUR_WORKERS, ASSUR_SIMULATION_WORKERS, ASSUR_WORKER_MEMORY_MIB",
                f"{self.processes}, {self.simulation_workers}, {self.worker_memory_mib}",
                f"workers of at least {LEAST_MIB} MiB each which, with {WEB_MIB} MiB for the web process, fit in "
                + ("any container" if has is None else f"the {has} MiB of this container"),
            )
        return most

    @property
    def stop_s(self) -> float:
        """How long a stopping service may take: what it has accepted is read, waits, is planned and is written."""
        return self.body_s + self.queue_wait_s + max(2 * self.max_budget_s + self.grace_s, self.check_s) + 5.0


# What the container, or the machine, gives this process: processors and memory.
#
# Linux tells both through control groups: of version 2 in one folder for all, of version 1 in one for each kind. A
# limit of any group above this process holds for it, too.

GROUPS = Path("/sys/fs/cgroup")
OWN = Path("/proc/self/cgroup")
NO_LIMIT = 1 << 60
"""Version 1 says a number beyond this where there is no limit of memory."""


def processors(groups: Path = GROUPS, own: Path = OWN) -> int:
    """How many processors this process may use, by its affinity and by the quota of its group; at least one."""
    seen = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else (os.cpu_count() or 1)
    quotas = [seen, *_quotas(groups, own)]
    return max(1, int(min(quotas)))


def memory_mib(groups: Path = GROUPS, own: Path = OWN) -> int | None:
    """How much memory this process and those that it starts may use, MiB; None: as much as there is."""
    found = []
    for folder in (*_folders(groups, own, ""), *_folders(groups, own, "memory")):
        for name in ("memory.max", "memory.limit_in_bytes"):
            text = _read(folder / name)
            if text.isdigit() and int(text) < NO_LIMIT:
                found.append(int(text) >> 20)
    return min(found, default=None)


def _quotas(groups: Path, own: Path) -> Iterator[float]:
    found = [_read(folder / "cpu.max") for folder in _folders(groups, own, "")]
    for folder in _folders(groups, own, "cpu"):
        found.append(f"{_read(folder / 'cpu.cfs_quota_us')} {_read(folder / 'cpu.cfs_period_us')}")
    for text in found:
        quota, _, period = text.partition(" ")
        if quota.isdigit() and period.isdigit() and int(period):
            yield int(quota) / int(period)


def _folders(groups: Path, own: Path, kind: str) -> Iterator[Path]:
    """The folders of this process's group and of all above it; `kind`: of version 1, or none for version 2.

    In a container the group's own path is often that of the machine outside, and its folder is the top one.
    """
    for line in _read(own).splitlines():
        number, _, rest = line.partition(":")
        kinds, _, path = rest.partition(":")
        if (number == "0" and not kind) if not kinds else kind in kinds.split(","):
            top = groups / kind
            inner = [part for part in path.split("/") if part not in ("", ".", "..")]
            for depth in range(len(inner), -1, -1):
                yield top.joinpath(*inner[:depth])


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="ascii", errors="replace").strip()
    except OSError:
        return ""  # no such group here
