"""The machine of a measurement: processor, cores, versions, commit. No host name, no path, nothing of the user."""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
MEASURED = ("planner", "scenes", "api", "experiments", "benchmarks")
"""Packages whose source decides what a figure is."""
LIBRARIES = ("numpy", "scipy", "python-fcl", "ruckig", "pydantic", "fastapi", "uvicorn")


def machine() -> dict[str, Any]:
    """Processor, cores, operating system, and versions of Python and of the libraries that are measured."""
    return {
        "cpu": _cpu(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "libraries": versions(LIBRARIES),
    }


def versions(names: Iterable[str]) -> dict[str, str]:
    """Name → version of what is installed in this environment; what is not is left out."""
    found = {}
    for name in names:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def commit() -> dict[str, Any]:
    """The commit that is checked out, and whether tracked files differ from it; None for both outside of git."""
    head = _git("rev-parse", "HEAD")
    if head is None:
        return {"commit": None, "changed": None}
    # results and records are written by the benchmark itself: they change nothing that is measured
    status = _git("status", "--porcelain", "--untracked-files=no", "--", *MEASURED, ":!benchmarks/*.json") or ""
    return {"commit": head, "changed": bool(status)}


def sources() -> str:
    """Digest of all Python sources that decide what is measured: a run is resumed only over the same."""
    digest = hashlib.sha256()
    for package in MEASURED:
        for path in sorted((ROOT / package).rglob("*.py")):
            digest.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]


def pin() -> str:
    """Keep this process, and those it starts, on one core where the system can; in words, what was done."""
    if not hasattr(os, "sched_setaffinity"):
        return "not pinned: this system cannot"
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    return "one core by sched_setaffinity, one thread each for OpenMP, OpenBLAS and MKL"


def _cpu() -> str:
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text(encoding="utf-8", errors="replace").splitlines():
            name, _, value = line.partition(":")
            if name.strip() == "model name":
                return value.strip()
    return platform.processor() or platform.machine()


def _git(*arguments: str) -> str | None:
    try:
        ran = subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        return None
    return ran.stdout.strip() if ran.returncode == 0 else None
