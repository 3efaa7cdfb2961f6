"""Claims of plans are accepted: of the shipped scenarios, of random cells, and of both with kernels as plain Python."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import Any

import pytest

from assur.planner.checker.claim.verdict import MOST_WORK, check_claim
from assur.planner.errors import InputError
from assur.scenes.bundle import bundle_document
from assur.scenes.requests import plan_document
from assur.scenes.scenarios import shipped_scenarios
from benchmarks.random_requests.random_cells import KINDS, random_cell
from tests.forgeries.claims import read
from tests.prover.bundles import bundle
from tests.scenes.cells.answers import answer

SMALL = ("standard-cycle", "five-bar", "rv-m1", "tray")
"""With all kinds of chains, and a surface."""
SEED, QUICK, WIDE = 31, 16, 600


@pytest.mark.parametrize("name", shipped_scenarios())
def test_the_claim_of_every_plan_of_a_shipped_scenario_is_accepted(name: str) -> None:
    if answer(name)["status"] != "planned":
        return
    claim = read(bundle(name))
    verdict = check_claim(claim)
    assert verdict.findings == ()
    assert verdict.accepted
    assert 0 < verdict.rows <= len(claim.rows)
    assert 0 < verdict.pairs <= verdict.work < MOST_WORK
    assert verdict.deepest <= 6


def claims_of_random_cells(count: int, seed: int) -> list[tuple[str, dict[str, Any]]]:
    """Bundles of plans of random cells, of all kinds in turn."""
    bundles, number = list[tuple[str, dict[str, Any]]](), 0
    while len(bundles) < count:
        kind, own = list(KINDS)[number % len(KINDS)], seed * 1_000_000 + number // len(KINDS)
        number += 1
        request = random_cell(kind, own)
        request["options"] = {**request.get("options", {}), "stop": "first", "budget_s": 60.0}
        try:
            planned = plan_document(request)
        except InputError:
            continue  # an arm that cannot be in the working mode that was drawn
        if planned["status"] == "planned":
            bundles.append((f"{kind} {own}", bundle_document(request, planned)))
    return bundles


def refused(count: int, seed: int) -> dict[str, object]:
    """What the checker finds in claims of random cells that it does not accept."""
    verdicts = {name: check_claim(read(document)) for name, document in claims_of_random_cells(count, seed)}
    assert len(verdicts) == count
    return {name: verdict.findings for name, verdict in verdicts.items() if not verdict.accepted}


def test_claims_of_random_cells_are_accepted() -> None:
    assert refused(QUICK, SEED) == {}


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_claims_of_many_random_cells_are_accepted() -> None:
    assert refused(WIDE, SEED + 1) == {}


PLAIN = """
import json, sys
from assur.planner.checker.claim.verdict import check_claim
from assur.planner.compiled import KERNELS
from tests.forgeries.claims import read
assert not any(hasattr(kernel, "py_func") for kernel in KERNELS.values())
for document in json.load(sys.stdin):
    print(json.dumps(check_claim(read(document))))
"""


def test_kernels_as_plain_python_give_the_same_verdicts() -> None:
    documents = []
    for name in SMALL:
        documents += [bundle(name), bundle(name), bundle(name)]
        documents[-2]["required"].update(travel=0.2, near=0.2)
        documents[-1]["rows"] = documents[-1]["rows"][: len(documents[-1]["rows"]) // 2]
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    given = json.dumps(documents)
    command = [sys.executable, "-c", PLAIN]
    ran = subprocess.run(command, input=given, env=environment, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    plain = [json.loads(line) for line in ran.stdout.splitlines()]
    compiled = [json.loads(json.dumps(check_claim(read(document)))) for document in documents]
    assert plain == compiled
    assert [verdict[0] for verdict in plain] == [True, False, False] * len(SMALL)
