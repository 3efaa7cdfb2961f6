"""The peers as running programs, each asked over its pipe; one that is not to be had is missing with its reason."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any

from benchmarks.dialogue import Document, Program, ProgramDied
from benchmarks.machine import ROOT
from benchmarks.peers.environment import Environment

MODULES: Mapping[str, str] = MappingProxyType(
    {
        "ompl": "benchmarks.peers.ompl_rrtconnect",
        "mplib": "benchmarks.peers.mplib_planner",
        "toppra": "benchmarks.peers.toppra_legs",
    }
)
START_S, LIMIT_S = 60.0, 30.0
"""Longest time to start a peer, and for one answer."""


@dataclass
class Peers:
    """Running peers by name, their `versions`, and why others are `missing`."""

    running: dict[str, Program] = field(default_factory=dict)
    versions: dict[str, str] = field(default_factory=dict)
    missing: dict[str, str] = field(default_factory=dict)

    def ask(self, name: str, question: Document) -> Document:
        """The peer's answer. One that dies is missing from then on, and its answer says so with status ``missing``."""
        if name in self.missing:
            return {"status": "missing", "reason": self.missing[name]}
        try:
            return self.running[name].ask(question, LIMIT_S)
        except ProgramDied as death:
            self.running.pop(name).close()
            self.missing[name] = f"its program died: {death}"
            return {"status": "missing", "reason": self.missing[name]}


@contextmanager
def peers(
    names: tuple[str, ...], environment: Environment, commands: Mapping[str, list[str]] | None = None
) -> Iterator[Peers]:
    """Starts the peers of these names. `commands`: other programs in their places."""
    there = Peers()
    try:
        for name in names:
            if name in environment.missing:
                there.missing[name] = environment.missing[name]
                continue
            command = (commands or {}).get(name, [str(environment.python), "-m", MODULES[name]])
            try:
                program = Program(command, folder=ROOT, start_s=START_S)
            except ProgramDied as death:
                there.missing[name] = f"its program does not start: {death}"
                continue
            there.running[name] = program
            there.versions[name] = str(program.greeting.get("version", ""))
        yield there
    finally:
        for program in there.running.values():
            program.close()


def environment_of(log: Path | None = None) -> Environment:
    """The peers' environment, ready."""
    from benchmarks.peers.environment import prepared

    return prepared(log=log)


def question(problem: Document, limits: Mapping[str, Any], budget_s: float, seed: int) -> Document:
    """What a planning peer is asked."""
    return {
        "problem": problem,
        "limits": {name: list(values) for name, values in limits.items()},
        "budget_s": budget_s,
        "seed": seed,
    }
