"""What the container, or the machine, gives this process: processors and memory.

Linux tells both through control groups: of version 2 in one folder for all, of version 1 in one for each kind. A limit
of any group above this process holds for it, too.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

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
    for folder in _folders(groups, own, ""):
        quota, _, period = _read(folder / "cpu.max").partition(" ")
        if quota.isdigit() and period.isdigit() and int(period):
            yield int(quota) / int(period)
    for folder in _folders(groups, own, "cpu"):
        quota, period = _read(folder / "cpu.cfs_quota_us"), _read(folder / "cpu.cfs_period_us")
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
