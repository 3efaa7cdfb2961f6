"""The claims of plans state what their requests ask: shipped scenarios, variants of them, random cells."""

from __future__ import annotations

from collections import Counter

import pytest

from assur.planner.errors import InputError
from assur.scenes.scenarios import shipped_scenarios
from benchmarks.soak.random_cells import KINDS, random_cell
from tests.planner.checker.statement.cases import VARIANTS, case_of, case_or_none, differences, planned
from tests.prover.test_meshes import CASES as MESHES

PLANNED = 30
"""Shipped scenarios that have a plan."""


def test_the_claims_of_all_shipped_scenarios_are_accepted() -> None:
    cases = {name: case_or_none(name) for name in shipped_scenarios()}
    made = {name: case for name, case in cases.items() if case is not None}
    assert len(made) == PLANNED
    assert {name: differences(case) for name, case in made.items()} == {name: [] for name in made}


@pytest.mark.parametrize("name", VARIANTS)
def test_the_claim_of_a_variant_is_accepted(name: str) -> None:
    assert differences(case_of(name)) == []


@pytest.mark.parametrize("name", MESHES)
def test_the_claim_of_an_arm_among_meshes_is_accepted(name: str) -> None:
    case = planned(MESHES[name])
    assert case is not None
    assert len(case.claim.triangles) > 0
    assert differences(case) == []


def accepted(count: int, seed: int) -> Counter[str]:
    """Plans random cells of all kinds in turn, until there are so many plans; how many of each kind. Asserts that the
    claim of each is accepted."""
    seen, number = Counter[str](), 0
    while seen.total() < count:
        kind = list(KINDS)[number % len(KINDS)]
        own = seed * 1_000_000 + number // len(KINDS)
        number += 1
        assert number < 20 * count
        try:
            request = random_cell(kind, own)
            request["options"] = {**request.get("options", {}), "stop": "first", "budget_s": 60.0, "max_candidates": 60}
            case = planned(request)
        except InputError:
            continue
        if case is not None:
            assert (kind, own, differences(case)) == (kind, own, [])
            seen[kind] += 1
    return seen


def test_the_claims_of_random_cells_are_accepted() -> None:
    assert len(accepted(8, 7)) == 8


@pytest.mark.slow
def test_the_claims_of_many_random_cells_are_accepted() -> None:
    assert len(accepted(150, 8)) == len(KINDS)
