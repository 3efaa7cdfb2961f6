"""Causes and worst realisations of errors are computed again, and others are reported."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest

from assur.planner.checker.verdict import Code
from assur.planner.legs.accuracy import other_causes
from assur.planner.model.arrival_error import ArrivalError
from assur.planner.model.outcome import Plan
from assur.scenes.reading.claims import untrue_causes
from tests.planner.checker.statement.cases import case_of

FLOW = "dense-flow, more uncertain"
Change = Callable[[ArrivalError], ArrivalError | None]


@pytest.mark.parametrize("name", [FLOW, "demo, more uncertain", "rv-m1", "bead-on-belt", "standard-cycle"])
def test_the_causes_of_a_plan_are_computed_again(name: str) -> None:
    case = case_of(name)
    assert other_causes(case.scene, case.plan) == ()


def changed(plan: Plan, which: int, change: Change) -> Plan:
    """A plan with another error of an arrival."""
    arrivals = list(plan.arrivals)
    error = arrivals[which].error
    assert error is not None
    arrivals[which] = replace(arrivals[which], error=change(error))
    return replace(plan, arrivals=tuple(arrivals))


CHANGES: tuple[tuple[str, Change], ...] = (
    ("no error", lambda _: None),
    ("a cause less", lambda error: replace(error, shares=error.shares[:-1])),
    ("a cause twice", lambda error: replace(error, shares=(*error.shares, error.shares[-1]))),
    ("causes in another order", lambda error: replace(error, shares=error.shares[::-1])),
    (
        "a cause that adds more",
        lambda error: replace(error, shares=(replace(error.shares[0], position_m=0.1), *error.shares[1:])),
    ),
    ("another realisation", lambda error: replace(error, worst=((error.worst[0][0], 0.5), *error.worst[1:]))),
    ("a realisation with another name", lambda error: replace(error, worst=(("late", 1.0), *error.worst[1:]))),
)


@pytest.mark.parametrize("change", [each[1] for each in CHANGES], ids=[each[0] for each in CHANGES])
def test_other_causes_are_reported(change: Change) -> None:
    case = case_of(FLOW)
    # errors of later arrivals follow from that of a pick
    assert other_causes(case.scene, changed(case.plan, 0, change))[0] == 0


def test_a_reader_of_answers_reports_them_as_findings() -> None:
    case = case_of(FLOW)
    assert case.plan.arrivals[1].error is not None
    (found,) = untrue_causes(case.scene, changed(case.plan, 1, CHANGES[1][1]))
    assert (found.code, found.where) == (Code.ERROR, "arrivals[1].error")
