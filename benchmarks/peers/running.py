"""The peers as running programs in an environment of their own; a peer that cannot run is missing, with the reason.

The environment is made once, and pip installs the requirements of each peer separately, so that a peer that cannot be
installed does not affect the other one; a failed installation is tried again in the next run.
"""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from benchmarks.dialogue import Document, Program, ProgramDied
from benchmarks.machine import ROOT

REQUIREMENTS = Path(__file__).with_name("requirements.txt")
FOLDER = ROOT / ".venv-peers"
PYTHONS = ("3.11", "3.12")
"""For which the peers have wheels."""
MODULES: Mapping[str, str] = {
    "ompl": "benchmarks.peers.ompl_rrtconnect",
    "mplib": "benchmarks.peers.mplib_planner",
}
NEEDS: Mapping[str, tuple[str, ...]] = {
    "ompl": ("numpy", "python-fcl", "ruckig", "ompl"),
    "mplib": ("numpy", "python-fcl", "toppra", "mplib"),
}
"""What each peer's program cannot run without, in the versions of `requirements.txt`."""
INSTALL_S, START_S, LIMIT_S = 600.0, 60.0, 30.0
"""Longest time to install a requirement, to start a peer, and for one answer."""


@dataclass
class Peers:
    """Running peers by name, their `versions`, and why others are `missing`."""

    running: dict[str, Program] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    missing: dict[str, str] = field(default_factory=dict)

    def ask(self, name: str, question: Document) -> Document:
        """The peer's answer. One that dies is missing from then on, and its answer says so with status ``missing``."""
        if name not in self.missing:
            try:
                return self.running[name].ask(question, LIMIT_S)
            except ProgramDied as death:
                self.running.pop(name).close()
                self.missing[name] = f"its program died: {death}"
        return {"status": "missing", "reason": self.missing[name]}


@contextmanager
def peers(names: tuple[str, ...], commands: Mapping[str, list[str]] | None = None) -> Iterator[Peers]:
    """Starts the peers of these names. `commands`: other programs in their places."""
    there = Peers()
    if commands is None:
        python, there.missing = prepared()
        commands = {name: [str(python), "-m", MODULES[name]] for name in names}
    try:
        for name in names:
            if name in there.missing:
                continue
            try:
                program = Program(commands[name], folder=ROOT, start_s=START_S)
            except ProgramDied as death:
                there.missing[name] = f"its program does not start: {death}"
                continue
            there.running[name] = program
            there.versions[name] = str(program.greeting.get("version", ""))
        yield there
    finally:
        for program in there.running.values():
            program.close()


def prepared(folder: Path = FOLDER) -> tuple[Path, dict[str, str]]:
    """The interpreter of the environment, which is made where it is not there or its requirements have changed; and
    why peers cannot run in it."""
    python, stamp = folder / "bin" / "python", folder / "assur-peers.json"
    base = interpreter()
    if base is None:
        why = f"no Python {' or '.join(PYTHONS)} on this machine, and its wheels are for no other"
        return python, dict.fromkeys(MODULES, why)
    wanted = hashlib.sha256(REQUIREMENTS.read_bytes() + base.encode()).hexdigest()
    if not (stamp.exists() and stamp.read_text(encoding="utf-8") == wanted):
        if _run([base, "-m", "venv", "--clear", str(folder)]) != 0:
            return python, dict.fromkeys(MODULES, f"{base} could not make a virtual environment")
        missing = {peer: why for peer in MODULES if (why := installed(python, peer))}
        if missing:
            return python, missing
        stamp.write_text(wanted, encoding="utf-8")
    return python, {}


def installed(python: Path, peer: str) -> str:
    """Why a peer's requirements could not be installed; empty if they were."""
    pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    pip += ["--only-binary", ":all:", "--retries", "1", "--constraint", str(REQUIREMENTS), *NEEDS[peer]]
    return "" if _run(pip) == 0 else f"pip has no wheel of one of {', '.join(NEEDS[peer])} here, or reaches no index"


def interpreter() -> str | None:
    """An interpreter that the peers have wheels for; this one if it will do."""
    for version in (None, *PYTHONS):
        python = sys.executable if version is None else shutil.which(f"python{version}")
        # a shim may be on the path with nothing behind it
        code = f"import sys, venv, ensurepip; sys.exit('%d.%d' % sys.version_info[:2] not in {PYTHONS})"
        if python and subprocess.run([python, "-c", code], capture_output=True, check=False).returncode == 0:
            return python
    return None


def _run(command: Sequence[str]) -> int:
    try:
        return subprocess.run(
            command, stdin=subprocess.DEVNULL, stdout=sys.stderr, timeout=INSTALL_S, check=False
        ).returncode
    except subprocess.TimeoutExpired:
        return -1


def question(problem: Document, limits: Mapping[str, Any], budget_s: float, seed: int = 0) -> Document:
    """The request to a planning peer."""
    return {
        "problem": problem,
        "limits": {name: list(values) for name, values in limits.items()},
        "budget_s": budget_s,
        "seed": seed,
    }
