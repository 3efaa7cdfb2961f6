"""The environment of the peers: made once, by itself, and where a peer cannot be installed, that is said.

Pip installs one requirement after the other, so that one that is not to be had leaves the others usable.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.machine import ROOT

REQUIREMENTS = Path(__file__).with_name("requirements.txt")
FOLDER = ROOT / ".venv-peers"
PYTHONS = ("3.11", "3.12")
"""For which the peers have wheels."""
NEEDS: Mapping[str, tuple[str, ...]] = {
    "ompl": ("numpy", "python-fcl", "ruckig", "ompl"),
    "mplib": ("numpy", "python-fcl", "toppra", "mplib"),
    "toppra": ("numpy", "python-fcl", "toppra"),
}
"""What each peer's program cannot run without."""
INSTALL_S = 600.0
TRY_AGAIN_S = 1800.0
"""What could not be installed is tried again after this, not for every section of a run."""

Run = Callable[[Sequence[str]], int]


@dataclass(frozen=True, slots=True)
class Environment:
    """`python`: the interpreter, None if there is none. `missing`: peer → why it cannot run here."""

    python: Path | None
    version: str = ""
    missing: Mapping[str, str] = field(default_factory=dict)


def requirements() -> dict[str, str]:
    """Name → pinned requirement."""
    lines = (line.strip() for line in REQUIREMENTS.read_text(encoding="utf-8").splitlines())
    return {line.partition("==")[0]: line for line in lines if line and not line.startswith("#")}


def interpreter() -> tuple[str, str] | None:
    """An interpreter that the peers have wheels for, and its version; this one if it will do."""
    if f"{sys.version_info[0]}.{sys.version_info[1]}" in PYTHONS:
        return sys.executable, f"{sys.version_info[0]}.{sys.version_info[1]}"
    for version in PYTHONS:
        there = shutil.which(f"python{version}")
        if there is not None and _works(there, version):
            return there, version
    return None


def _works(python: str, version: str) -> bool:
    """Whether it is what it is called: a shim may be on the path with nothing behind it."""
    code = f"import sys, venv, ensurepip; sys.exit(sys.version_info[:2] != ({version.replace('.', ', ')}))"
    return subprocess.run([python, "-c", code], capture_output=True, check=False).returncode == 0


def prepared(folder: Path = FOLDER, log: Path | None = None) -> Environment:
    """The environment, made if it is not there or its requirements have changed."""
    found = interpreter()
    if found is None:
        why = f"no Python {' or '.join(PYTHONS)} on this machine, and its wheels are for no other"
        return Environment(None, "", dict.fromkeys(NEEDS, why))
    base, version = found
    python = folder / "bin" / "python"
    stamp = folder / "assur-peers.json"
    wanted = hashlib.sha256(REQUIREMENTS.read_bytes() + version.encode()).hexdigest()
    if stamp.exists() and python.exists():
        said = json.loads(stamp.read_text(encoding="utf-8"))
        lately = time.time() - stamp.stat().st_mtime < TRY_AGAIN_S
        if said["requirements"] == wanted and (lately or not said["failed"]):
            return Environment(python, version, missing(set(said["failed"]), version))
    with (log or Path(os.devnull)).open("ab") as stream:

        def run(command: Sequence[str]) -> int:
            try:
                return subprocess.run(
                    command, stdout=stream, stderr=stream, stdin=subprocess.DEVNULL, timeout=INSTALL_S, check=False
                ).returncode
            except subprocess.TimeoutExpired:
                return -1

        if run([base, "-m", "venv", "--clear", str(folder)]) != 0:
            why = f"Python {version} could not make a virtual environment"
            return Environment(None, version, dict.fromkeys(NEEDS, why))
        failed = installed(python, run)
    stamp.write_text(json.dumps({"requirements": wanted, "failed": sorted(failed)}), encoding="utf-8")
    return Environment(python, version, missing(failed, version))


def installed(python: Path, run: Run) -> set[str]:
    """Installs requirement by requirement; the names of those that could not be."""
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    pip += ["--only-binary", ":all:", "--retries", "1"]
    constraint = ["--constraint", str(REQUIREMENTS)]
    return {name for name, line in requirements().items() if run([*pip, *constraint, line]) != 0}


def missing(failed: set[str], version: str) -> dict[str, str]:
    """Peer → why it cannot run, given what could not be installed."""
    return {
        peer: f"pip has no wheel of {', '.join(requirements()[name] for name in needs if name in failed)} "
        f"for Python {version} here, or cannot reach an index"
        for peer, needs in NEEDS.items()
        if failed & set(needs)
    }
