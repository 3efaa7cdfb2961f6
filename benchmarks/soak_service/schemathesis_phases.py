"""Row 2: schemathesis, all of its phases, against a running service."""

from __future__ import annotations

import subprocess
from importlib.util import find_spec

from benchmarks import contract
from benchmarks.soak_service.row import NotThereError, Numbers, RowError, Run, above
from benchmarks.soak_service.served import served

CASES, FEW_CASES = 20_000, 100
LONGEST_S, FEW_LONGEST_S = 5400.0, 90.0
EXAMPLES, FEW_EXAMPLES = 60, 2
"""Most of one operation in one phase of a round. A request takes Hypothesis half a second to make."""
ROUNDS = 2
"""Rounds at a time."""
FEW_OPERATIONS = "^(plan_scene|parse_scene|start_scene_job|delete_job|keep_mesh|list_.*|show_.*)$"
"""In the short form: those whose bodies are made quickly."""
PHASES = frozenset(contract.PHASES.split(","))
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
    """Runs the rounds against a service with two workers."""
    if find_spec("schemathesis") is None:
        raise NotThereError("schemathesis")
    folder, cases = run.below("schemathesis"), int(run.pick(FEW_CASES, CASES))
    with served(
        run.below("logs") / "schemathesis.log", settings={**SETTINGS, "mesh_folder": str(folder / "meshes")}
    ) as service:
        try:
            result = contract.run(
                f"http://127.0.0.1:{service.port}",
                folder / "result.json",
                cases,
                int(run.pick(FEW_EXAMPLES, EXAMPLES)),
                run.seed,
                rounds=1 if run.short else ROUNDS,
                longest_s=run.pick(FEW_LONGEST_S, LONGEST_S),
                operations=FEW_OPERATIONS if run.short else None,
                say=run.say,
            )
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            raise RowError(str(error)[:300]) from error
    return {"asked": cases, "cases": result["cases"], "failures": len(result["failures"]), "phases": result["phases"]}


def judge(numbers: Numbers) -> list[str]:
    """All cases were run, in all phases, without a failure."""
    found = above(numbers, {"failures": 0})
    if numbers["cases"] < numbers["asked"]:
        found.append(f"{numbers['cases']} of {numbers['asked']} cases were run")
    missing = PHASES - set(numbers["phases"])
    if missing:
        found.append(f"phases that were not run: {', '.join(sorted(missing))}")
    return found


def summary(numbers: Numbers) -> str:
    """Cases and failures."""
    return f"{numbers['cases']:,}: {numbers['failures']} failures; phases {', '.join(numbers['phases']) or 'none'}"
