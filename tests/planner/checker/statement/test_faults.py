"""Faults made on purpose in claims are reported, each under its topic; a claim that states more is accepted."""

from __future__ import annotations

import numpy as np
import pytest

from tests.planner.checker.statement.cases import case_of, differences
from tests.planner.checker.statement.faults import FAULTS, MORE, Change, Fault
from tests.planner.checker.statement.faults_of_arrivals import FAULTS_OF_ARRIVALS

ALL = FAULTS + FAULTS_OF_ARRIVALS


@pytest.mark.parametrize("fault", ALL, ids=[fault.name for fault in ALL])
def test_a_fault_in_a_claim_is_reported(fault: Fault) -> None:
    case = case_of(fault.case)
    assert differences(case) == []
    bad = fault.change(case)
    changed = [
        table for table, one, other in zip(bad._fields, bad, case.claim, strict=True) if not np.array_equal(one, other)
    ]
    assert changed
    reported = differences(case, bad)
    assert fault.code in {each.code for each in reported}


@pytest.mark.parametrize(("name", "change"), [each[1:] for each in MORE], ids=[each[0] for each in MORE])
def test_a_claim_that_states_more_is_accepted(name: str, change: Change) -> None:
    case = case_of(name)
    better = change(case)
    assert any(not np.array_equal(one, other) for one, other in zip(better, case.claim, strict=True))
    assert differences(case, better) == []
