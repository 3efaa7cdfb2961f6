"""What an answer states beside its plan is stated by the claim; where it is not, the statement checker reports it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from assur.planner.checker.claim.verdict import check_claim
from assur.planner.checker.statement import Handling, state_answer
from assur.planner.checker.verdict import Code, Finding
from assur.planner.claim import columns as c
from assur.planner.claim import filling
from assur.planner.claim.answer import with_answer
from assur.planner.claim.columns import Claim
from assur.planner.model.claims import NOTHING, Claims
from assur.planner.model.outcome import Plan
from assur.planner.model.phases import phases
from assur.scenes.scenarios import shipped_scenarios
from tests.planner.checker.statement.cases import Case, case_of, differences
from tests.planner.checker.statement.test_claims_of_plans import NOT_PLANNED

T = Code
Said = Callable[[Any], Claims]


@cache
def answered(name: str) -> tuple[Case, Claim]:
    """The case of a scenario, whose answer names the nearest pairs, too; and the claim of its answer."""
    case = case_of(name)
    smallest = [each[0] for each in (case.claims.nearest,) if each is not None]
    case = replace(case, claims=replace(case.claims, pairs=tuple(each for each in smallest if each is not None)))
    base, of_plan = filling.claim_of(case.scene), phases(case.scene, case.plan.legs, case.plan.arrivals)
    return case, with_answer(base, case.claim, case.plan, of_plan, case.claims)


def reported(name: str, claims: Claims | None = None, plan: Plan | None = None) -> list[Finding]:
    """What is reported of other statements about a case, or of another plan, whose claim is that of the right one."""
    case, claim = answered(name)
    return state_answer(Handling(case.scene, plan or case.plan), claims or case.claims, claim)


@pytest.mark.parametrize("name", sorted(set(shipped_scenarios()) - NOT_PLANNED))
def test_the_claim_of_the_answer_of_a_shipped_scenario_is_accepted(name: str) -> None:
    case, claim = answered(name)
    assert all((case.claims.peaks, case.claims.tool, case.claims.singularity, case.claims.carried))
    assert reported(name) == []
    assert differences(case, claim) == []
    assert check_claim(claim).findings == ()


def test_an_answer_that_states_nothing_needs_no_rows() -> None:
    case, _ = answered("demo")
    arrivals = tuple(replace(each, grip_m=None, support_m=None) for each in case.plan.arrivals)
    assert state_answer(Handling(case.scene, replace(case.plan, arrivals=arrivals)), NOTHING, case.claim) == []


def gripped(k: Claims) -> Claims:
    """The nearest pair is one that may touch: the tool and the part that it grips, which are stated to be near."""
    assert k.nearest is not None
    assert k.nearest[0] is not None
    when = answered("demo")[0].plan.arrivals[0].until
    return replace(k, nearest=(replace(k.nearest[0], bodies=("cup", "part"), phase="FOLLOW", time=when),))


FALSE: dict[str, tuple[Code, Said]] = {
    "a pair that may touch": (T.NEAREST, gripped),
    "a clearance that is no number": (
        T.NEAREST,
        lambda k: replace(k, nearest=tuple(replace(each, gap_m=math.nan) for each in k.nearest)),
    ),
    "a peak that is no number": (
        T.PEAK,
        lambda k: replace(k, peaks=tuple(replace(each, velocity=math.nan) for each in k.peaks)),
    ),
    "a margin that is no number": (T.SINGULARITY, lambda k: replace(k, singularity=(math.nan,))),
}


@pytest.mark.parametrize("what", FALSE)
def test_a_false_statement_is_reported(what: str) -> None:
    """No answer that is read has a number that is none, and no writer says how near a pair is that may touch."""
    code, change = FALSE[what]
    assert code in {each.code for each in reported("demo", change(answered("demo")[0].claims))}


FAULTS: dict[str, tuple[str, Code, str, int | slice, int, float]] = {
    "a nearer second distance": ("demo", T.NEAREST, "required", 0, c.REQUIRED_NEAREST, -1e-6),
    "a nearer distance of parts": ("demo", T.NEAREST, "required", 0, c.REQUIRED_PLACED, -1e-6),
    "distances at another time": ("demo", T.NEAREST, "distances", slice(None), c.DISTANCE_TIME, 1e-6),
    "distances in another phase": ("demo", T.NEAREST, "distances", slice(None), c.DISTANCE_PHASE, 1.0),
    "distances of other bodies": ("demo", T.NEAREST, "distances", slice(None), c.DISTANCE_BODY, 1.0),
    "distances that are larger": ("demo", T.NEAREST, "distances", slice(None), c.DISTANCE_MOST, 1e-6),
    "peaks from later on": ("demo", T.PEAK, "sums", slice(None), c.SUM_T0, 1e-3),
    "peaks of other joints": ("demo", T.PEAK, "sums", slice(None), c.SUM_SHARE, 0.5),
    "peaks of another order": ("demo", T.PEAK, "sums", slice(None), c.SUM_ORDER, 1.0),
    "higher bounds of peaks": ("demo", T.PEAK, "sums", slice(None), c.SUM_HIGH, 1e-2),
    "lower bounds of peaks": ("demo", T.PEAK, "sums", slice(None), c.SUM_LOW, -1e-2),
    "another point of the tool": ("demo", T.PEAK, "rates", slice(None), c.RATE_POINT, 1e-6),
    "another link": ("demo", T.PEAK, "rates", slice(None), c.RATE_LINK, -1.0),
    "a faster point": ("demo", T.PEAK, "rates", slice(None), c.RATE_MOST, 1e-2),
    "margins of another link": ("demo", T.SINGULARITY, "axes", slice(None), c.AXIS_LINK, -1.0),
    "margins from later on": ("demo", T.SINGULARITY, "axes", slice(None), c.AXIS_T0, 1e-3),
    "margins along another axis": ("demo", T.SINGULARITY, "axes", slice(None), c.AXIS_DIRECTION, 1e-3),
}
"""Case, topic, table, rows, column, and what is added to its numbers."""


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_in_the_claim_of_an_answer_is_reported(name: str) -> None:
    of, topic, table, rows, column, more = FAULTS[name]
    case, claim = answered(of)
    numbers = getattr(claim, table).copy()
    numbers[rows, column] += more
    bad = claim._replace(**{table: numbers})
    found = state_answer(Handling(case.scene, case.plan), case.claims, bad)
    assert topic in {each.code for each in found}


@pytest.mark.parametrize("table", ["sums", "axes", "distances"])
def test_no_row_of_an_answer_can_be_spared(table: str) -> None:
    case, claim = answered("five-bar")
    # the smallest clearance and the nearest pair need the same row
    for row in range(len(getattr(case.claim, table)), len(getattr(claim, table))):
        less = claim._replace(**{table: np.delete(getattr(claim, table), row, axis=0)})
        others = [getattr(claim, table)[k] for k in range(len(getattr(claim, table))) if k != row]
        if not any(np.array_equal(getattr(claim, table)[row], other) for other in others):
            assert state_answer(Handling(case.scene, case.plan), case.claims, less), (table, row)


WITHOUT: dict[str, tuple[str, Code, set[str]]] = {
    "rates": ("demo", T.PEAK, {
        "the speed of the tool may be larger than is stated",
        "the speed of the tool is not what is stated then",
        "the acceleration of the tool may be larger than is stated",
        "the acceleration of the tool is not what is stated then",
        "the tool may accelerate harder with a part than is stated",
        "the tool never accelerates as hard with a part as is stated",
    }),
    "axes": ("five-bar", T.SINGULARITY, {
        "the arm may come nearer to a singular position (singularity) than is stated",
        "the arm does not come as near to a singular position (singularity) as is stated",
        "the arm may come nearer to a singular position (parallel) than is stated",
        "the arm does not come as near to a singular position (parallel) as is stated",
    }),
}  # fmt: skip
"""Case, topic, and what is reported of it if a table has no rows."""


@pytest.mark.parametrize("table", WITHOUT)
def test_no_peak_and_no_margin_is_shown_without_its_rows(table: str) -> None:
    name, topic, sentences = WITHOUT[table]
    case, claim = answered(name)
    less = claim._replace(**{table: getattr(claim, table)[:0]})
    found = state_answer(Handling(case.scene, case.plan), case.claims, less)
    assert {each.what for each in found if each.code is topic} == sentences


def test_modes_margins_grips_and_supports_that_a_request_asks_for_are_stated() -> None:
    case = case_of("demo, near parts")
    assert differences(case) == []
    for table, topic in (("distances", T.NEAREST), ("axes", T.ELBOW)):
        for row in range(len(getattr(case.claim, table))):
            less = case.claim._replace(**{table: np.delete(getattr(case.claim, table), row, axis=0)})
            assert {each.code for each in differences(case, less)} <= {topic, T.SINGULARITY}
            assert differences(case, less)
