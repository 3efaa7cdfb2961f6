"""Cases of schemathesis, of all its phases, against a service that runs.

    python -m benchmarks.contract http://127.0.0.1:8000 --cases 20000 --seed 1 --out out/contract.json

Rounds with the seeds `seed`, `seed + 1`, ... are run until there are so many cases. The result is a JSON document: how
many cases there were, in which phases, and every failure with its seed. The exit code is 0 if there was none. Give the
service small budgets (`ASSUR_MAX_BUDGET_S=0.05`): most of what is generated has no meaning, and the rest need not be
planned well.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
PHASES = "examples,coverage,fuzzing,stateful"
EXPECTED = ["2XX", "400", "401", "404", "409", "422", "429", "503"]
"""Statuses of a request that keeps the description. 400: whole numbers beyond 2**53, where a field has no bound. 422 is
judged by `benchmarks.contract_hooks`."""
END_S = 30.0
"""What a round may take beyond its time to end, s."""
CONFIG = """\
[checks.use_after_free]
enabled = false

[checks.positive_data_acceptance]
expected-statuses = {expected}

[[operations]]
include-operation-id = ["start_job", "simulate", "simulate_cell"]
checks.negative_data_rejection.enabled = false
"""
"""A job is accepted before a worker has read its request: a fault of the request is the problem of a failed job. A
cancelled job is kept in that state."""


def round_of(
    url: str, seed: int, examples: int, phases: str, longest_s: float | None, operations: str | None
) -> dict[str, Any]:
    """One run: the number of its cases and its failures."""
    with tempfile.TemporaryDirectory() as folder:
        config, report = Path(folder, "schemathesis.toml"), Path(folder, "report.json")
        config.write_text(CONFIG.format(expected=json.dumps(EXPECTED)), encoding="utf-8")
        command = [sys.executable, "-m", "schemathesis.cli", "--config-file", str(config), "run"]
        command += [f"{url.rstrip('/')}/openapi.json", "--phases", phases, "--seed", str(seed), "--no-color"]
        command += ["--max-examples", str(examples), "--report-json-path", str(report), "--generation-database", "none"]
        command += ["--request-timeout", "60"]
        command += ["--suppress-health-check", "all", "--no-shrink", "--continue-on-failure"]
        command += [] if longest_s is None else ["--max-time", f"{longest_s:.0f}"]
        command += [] if operations is None else ["--include-operation-id-regex", operations]
        paths = os.pathsep.join(str(path) for path in (ROOT, ROOT / "src", os.environ.get("PYTHONPATH", "")) if path)
        environment = {**os.environ, "PYTHONPATH": paths, "SCHEMATHESIS_HOOKS": "benchmarks.contract_hooks"}
        limit_s = None if longest_s is None else longest_s + END_S
        finished = subprocess.run(
            command, env=environment, capture_output=True, text=True, check=False, timeout=limit_s
        )
        if not report.exists():
            raise RuntimeError(finished.stdout[-4000:] + finished.stderr[-4000:])
        found: dict[str, Any] = json.loads(report.read_text(encoding="utf-8"))
        return {"seed": seed, "exit": finished.returncode, "report": found, "output": finished.stdout}


def failures_of(done: dict[str, Any]) -> list[dict[str, Any]]:
    """What a round found, errors of its own making among it."""
    found = [{"seed": done["seed"], **failure} for failure in done["report"]["failures"]]
    _, _, errors = done["output"].partition(" ERRORS ")
    return found + [{"seed": done["seed"], "error": error, "told": errors[:3000]} for error in done["report"]["errors"]]


def phases_of(done: dict[str, Any]) -> set[str]:
    """The phases of a round in which there was something to do, and it was done."""
    ran = {"success", "failure"}
    names = {phase.lower() for phase, result in (done["report"]["phases"] or {}).items() if result["status"] in ran}
    return {phase for phase in PHASES.split(",") if any(name.startswith(phase) for name in names)}


def run(
    url: str,
    out: Path,
    cases: int,
    examples: int,
    seed: int,
    rounds: int = 1,
    longest_s: float | None = None,
    phases: str = PHASES,
    operations: str | None = None,
    say: Callable[[str], None] = print,
) -> dict[str, Any]:
    """Runs rounds until there are so many cases, or the time is over: the result, which is in `out` after each round.

    Raises `RuntimeError` for a round that made no case, and `subprocess.TimeoutExpired` for one that did not end."""
    started, next_seed = time.monotonic(), seed
    result: dict[str, Any] = {"cases": 0, "seeds": [], "phases": [], "failures": []}
    with ThreadPoolExecutor(rounds) as pool:
        running: set[Future[dict[str, Any]]] = set()
        while True:
            left = None if longest_s is None else longest_s - (time.monotonic() - started)
            while len(running) < rounds and result["cases"] < cases and (left is None or left >= 1.0):
                running.add(pool.submit(round_of, url, next_seed, examples, phases, left, operations))
                next_seed += 1
            if not running:
                return result
            ended, running = wait(running, return_when=FIRST_COMPLETED)
            for round_ in ended:
                _added(result, round_.result())
            out.parent.mkdir(parents=True, exist_ok=True)
            out.write_text(json.dumps(result, indent=1), encoding="utf-8")
            counts = f"{result['cases']} cases, {len(result['failures'])} failures"
            say(f"{counts}, {time.monotonic() - started:.0f} s")


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.contract", description="See the top of the file.")
    parser.add_argument("url", help="address of a service that runs")
    parser.add_argument("--cases", type=int, default=20_000, help="so many at least, unless --longest-s ends them")
    parser.add_argument("--examples", type=int, default=50, help="most of one operation in one phase of a round")
    parser.add_argument("--seed", type=int, default=1, help="of the first round")
    parser.add_argument("--rounds", type=int, default=1, help="so many at a time, each in a process of its own")
    parser.add_argument("--longest-s", type=float, help="no round begins later, and those under way end")
    parser.add_argument("--phases", default=PHASES)
    parser.add_argument("--operations", help="a regular expression of operation ids; silence: all")
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "contract.json")
    return 1 if run(**vars(parser.parse_args()))["failures"] else 0


def _added(result: dict[str, Any], done: dict[str, Any]) -> None:
    """Counts a round. Raises RuntimeError if it made no case at all."""
    cases = done["report"]["test_cases"]["generated"]
    if not cases:
        raise RuntimeError(f"seed {done['seed']} made no case: {done['output'][-4000:]}")
    result["cases"] += cases
    result["seeds"].append(done["seed"])
    result["phases"] = sorted(phases_of(done) | set(result["phases"]))
    result["failures"] += failures_of(done)


if __name__ == "__main__":
    sys.exit(main())
