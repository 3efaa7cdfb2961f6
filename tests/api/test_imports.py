"""What each process loads: the web process no native planning library, the command line nothing for its help."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NATIVE = ("fcl", "ruckig", "trimesh", "scipy", "numba", "llvmlite")


def modules_after(program: str) -> set[str]:
    """Top-level modules that are loaded after `program` ran in a new process."""
    tell = "\nimport sys\nprint(*sorted({name.partition('.')[0] for name in sys.modules}))"
    run = subprocess.run([sys.executable, "-c", program + tell], cwd=ROOT, capture_output=True, text=True, check=True)
    return set(run.stdout.splitlines()[-1].split())


SERVED = """
from assur.api.workers.jobs import FIRST_PLAN
from tests.api.running import running
with running() as client:
    assert client.get("/v1/scenes").status_code == 200
    assert client.get("/v1/robots").status_code == 200
    assert client.get("/v1/schema").status_code == 200
    assert client.get("/openapi.json").status_code == 200
    assert client.post("/v1/plans", json=FIRST_PLAN).json()["status"] == "planned"
    assert client.post("/v1/plans", json={"schema": "assur/1"}).status_code == 422
    assert client.post("/v1/plans/check", json={}).status_code == 422
"""


def test_the_web_process_loads_no_planning_library_even_after_it_has_served() -> None:
    loaded = modules_after(SERVED)
    assert "assur" in loaded
    assert loaded.isdisjoint(NATIVE)


def test_the_rule_would_see_a_library_that_is_loaded() -> None:
    assert "scipy" in modules_after("import scipy.spatial")


@pytest.mark.parametrize("command", ["scenes", "robots", "schema", "--help"])
def test_a_command_that_only_lists_loads_no_planning_library(command: str) -> None:
    program = f"""
import sys
from assur.api.command_line import app
try:
    app([{command!r}])
except SystemExit as end:
    assert end.code == 0, end.code
"""
    assert modules_after(program).isdisjoint(NATIVE)
