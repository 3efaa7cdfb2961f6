"""``python -m benchmarks.same_bytes``: are the answers the same, byte by byte, in another process and on any processor?

Every shipped scenario, all of which end by a count, is planned in three processes: twice with kernels compiled for this
processor, and once for the least of its family (`NUMBA_CPU_NAME=generic`, as in the image). The clock's readings are
left out of the comparison. Code for another processor is compiled first, which takes about a minute, and is kept
beside the other. This covers code generation; the mathematical library may differ between hosts.
"""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from collections.abc import Mapping
from typing import Annotated, Any

import typer
from rich.console import Console

from benchmarks.machine import ROOT

GENERIC = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
PROCESSES: Mapping[str, Mapping[str, str]] = {"this processor": {}, "another process": {}, "any processor": GENERIC}
READINGS = frozenset({"elapsed_s", "first_s"})
"""Of the clock."""


def without_readings(answer: Any) -> Any:
    """A document without readings of the clock, at any depth."""
    if isinstance(answer, dict):
        return {key: without_readings(value) for key, value in answer.items() if key not in READINGS}
    return [without_readings(value) for value in answer] if isinstance(answer, list) else answer


def digests(names: list[str]) -> dict[str, str]:
    """Scenario → what its answer is, certificate in full, as a digest of its bytes."""
    from assur.scenes.kernels import load
    from assur.scenes.requests import plan_scenario
    from assur.scenes.scenarios import shipped, shipped_scenarios

    load()
    found = {}
    for name in names or shipped_scenarios():
        answer = json.loads(json.dumps(plan_scenario(shipped(name), certificate="full")))
        content = json.dumps(without_readings(answer), sort_keys=True, allow_nan=False).encode()
        found[name] = f"{answer['status']} {len(content)} {hashlib.sha256(content).hexdigest()[:16]}"
    return found


def main(
    only: Annotated[list[str] | None, typer.Option(help="Only this scenario; repeatable.")] = None,
    here: Annotated[bool, typer.Option("--here", help="Print the digests of this process, as JSON.")] = False,
) -> None:
    """Compare answers between processes and processors. Exit 1 where any differs."""
    names = only or []
    if here:
        print(json.dumps(digests(names)))
        return
    again = [sys.executable, "-m", "benchmarks.same_bytes", "--here", *(f"--only={name}" for name in names)]
    told = {}
    for process, variables in PROCESSES.items():
        ran = subprocess.run(again, cwd=ROOT, env=os.environ | variables, capture_output=True, text=True, check=True)
        told[process] = json.loads(ran.stdout)
    first, *others = told.values()
    console = Console()
    for name, digest in first.items():
        same = all(other[name] == digest for other in others)
        console.print(name, digest, "same" if same else f"differs: {[other[name] for other in others]}")
    raise typer.Exit(0 if all(other == first for other in others) else 1)


if __name__ == "__main__":
    typer.run(main)
