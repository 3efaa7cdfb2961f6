"""The claims of plans state what their requests ask: shipped scenarios, variants of them, random cells."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from assur.planner.checker.claim.verdict import check_claim
from assur.planner.errors import InputError
from assur.planner.model.outcome import Plan
from assur.scenes.resampling.grid import arrivals_on, legs_on, on_nanoseconds, on_ticks
from assur.scenes.scenarios import shipped_scenarios
from benchmarks.random_requests.random_cells import KINDS, random_cell
from tests.planner.checker.statement.cases import VARIANTS, case_of, claim_of, differences, planned, sealed
from tests.prover.test_meshes import CASES as MESHES

NOT_PLANNED = frozenset(
    (
        "bead-beyond-reach",
        "behind-the-base-keep",
        "behind-the-base-straight",
        "carton-high-rim",
        "dense-flow-uncertain",
        "dense-flow-uncorrected",
        "fast-belt-long-follow",
        "five-bar-type-2",
        "heavy-casting-refused",
        "inside-a-mesh",
        "long-bar",
        "shut-gate",
        "two-robots-parked",
    )
)
"""Shipped scenarios that are refused."""


@pytest.mark.parametrize("name", sorted(set(shipped_scenarios()) - NOT_PLANNED))
def test_the_claim_of_a_shipped_scenario_is_accepted(name: str) -> None:
    assert differences(case_of(name)) == []


@pytest.mark.parametrize("name", VARIANTS)
def test_the_claim_of_a_variant_is_accepted_by_both_checkers(name: str) -> None:
    assert differences(case_of(name)) == []
    assert check_claim(case_of(name).claim).findings == ()


@pytest.mark.parametrize("name", MESHES)
def test_the_claim_of_an_arm_among_meshes_is_accepted(name: str) -> None:
    case = planned(MESHES[name])
    assert case is not None
    assert len(case.claim.triangles) > 0
    assert differences(case) == []


@pytest.mark.parametrize(("name", "tick_s"), [("demo", 0.004), ("rv-m1, straight way", 0.004), ("shutter", None)])
def test_the_claim_of_a_motion_through_other_knots_is_accepted(name: str, tick_s: float | None) -> None:
    case = case_of(name)
    path = case.plan.trajectory
    other = on_nanoseconds(path) if tick_s is None else on_ticks(case.scene, case.plan, tick_s)
    assert not np.array_equal(other.time, path.time)
    plan = Plan(other, legs_on(case.plan, other), arrivals_on(case.plan, other), case.plan.certificate)
    plan = sealed(case.scene, plan)
    assert differences(case, claim_of(case.scene, plan), plan) == []


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
    assert len(accepted(90, 8)) == len(KINDS)
