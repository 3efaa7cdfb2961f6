"""Row 2: schemathesis, all of its phases, against a running service. The runner is a program of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec
from typing import IO

from benchmarks.machine import ROOT
from benchmarks.soak_service.row import NotThereError, Numbers, Row, Run, above
from benchmarks.soak_service.served import served

RUNNER = "benchmarks.contract"
"""``python -m RUNNER URL --cases COUNT --seed SEED --out FILE``: FILE is JSON with `cases`, `failures` (a list or a
count) and `phases` (those that ran)."""
CASES, FEW_CASES = 20_000, 100
LONGEST_S, FEW_LONGEST_S = 5400.0, 90.0
EXAMPLES, FEW_EXAMPLES = 60, 2
"""Most of one operation in one phase of a round. A request takes Hypothesis half a second to make."""
ROUNDS = 2
"""Rounds at a time."""
FEW_OPERATIONS = "^(plan_scene|parse_scene|start_scene_job|delete_job|keep_mesh|list_.*|show_.*)$"
"""In the short form: those whose bodies are made quickly."""
END_S = 30.0
"""What a runner may take beyond its time to end, s."""
PHASES = frozenset({"examples", "coverage", "fuzzing", "stateful"})
SETTINGS: dict[str, object] = {
    "workers": 2,
    "max_budget_s": 0.05,
    "max_tasks": 1_000_000,
    "queue": 1_000,
    "client_waiting": 1_000,
    "queue_wait_s": 3600.0,
    "grace_s": 30.0,
}
"""As docs/service.md says for such runs: nobody is turned away, for schemathesis takes any 503 for a fault."""


def measure(run: Run) -> Numbers:
    """Runs the runner against a service with two workers."""
    for needed, what in ((RUNNER, "the runner of schemathesis"), ("schemathesis", "schemathesis")):
        if find_spec(needed) is None:
            raise NotThereError(what)
    meshes = str(run.below("schemathesis") / "meshes")
    with served(run.below("logs") / "schemathesis.log", settings={**SETTINGS, "mesh_folder": meshes}) as service:
        url = f"http://127.0.0.1:{service.port}"
        out = run.below("schemathesis") / "result.json"
        out.unlink(missing_ok=True)
        cases, longest_s = int(run.pick(FEW_CASES, CASES)), run.pick(FEW_LONGEST_S, LONGEST_S)
        command = [sys.executable, "-m", RUNNER, url, "--cases", str(cases), "--seed", str(run.seed), "--out", str(out)]
        command += ["--examples", str(int(run.pick(FEW_EXAMPLES, EXAMPLES))), "--longest-s", str(longest_s)]
        command += ["--operations", FEW_OPERATIONS] if run.short else ["--rounds", str(ROUNDS)]
        path = run.below("schemathesis") / "output.txt"
        with path.open("w", encoding="utf-8") as stream:
            code = _ended(command, stream, longest_s + END_S)
        text = out.read_text(encoding="utf-8") if out.exists() else ""
    return {"asked": cases, "exit_code": code, **summary(text)}


def _ended(command: list[str], stream: IO[str], limit_s: float) -> int | None:
    """The exit code of a command; None where it had to be killed."""
    try:
        return subprocess.run(
            command, cwd=ROOT, stdout=stream, stderr=subprocess.STDOUT, timeout=limit_s, check=False
        ).returncode
    except subprocess.TimeoutExpired:
        return None


def summary(text: str) -> Numbers:
    """The cases, failures and phases that the runner's file has; 0 cases where it has none."""
    try:
        document = json.loads(text)
    except ValueError:
        document = None
    if not isinstance(document, dict) or "cases" not in document:
        return {"cases": 0, "failures": None, "phases": []}
    failures, phases = document.get("failures"), document.get("phases", [])
    return {
        "cases": document["cases"],
        "failures": len(failures) if isinstance(failures, list) else failures,
        "phases": sorted(phases.split(",") if isinstance(phases, str) else phases),
    }


def judge(numbers: Numbers) -> list[str]:
    """All cases were run, in all phases, without a failure."""
    found = above(numbers, {"failures": 0})
    if numbers["cases"] < numbers["asked"]:
        found.append(f"{numbers['cases']} of {numbers['asked']} cases were run")
    missing = PHASES - set(numbers["phases"])
    if missing:
        found.append(f"phases that were not run: {', '.join(sorted(missing))}")
    if numbers["exit_code"] != 0:
        found.append(f"the runner ended with {numbers['exit_code']}")
    return found


def told(numbers: Numbers) -> str:
    """Cases and failures."""
    return f"{numbers['cases']:,}: {numbers['failures']} failures; phases {', '.join(numbers['phases']) or 'none'}"


ROW = Row(
    "schemathesis",
    "schemathesis, all phases, cases: failures",
    "fuzzing impossible",
    "20,000: 0",
    measure,
    judge,
    told,
)
