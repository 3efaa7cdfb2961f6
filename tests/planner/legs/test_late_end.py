"""An end that is asked for before the start can never be kept, wherever the point is."""

from __future__ import annotations

from assur.planner.model.outcome import NotPlanned, Planned
from assur.planner.model.refusal import Reason
from assur.planner.pipeline import plan
from tests.planner.cells import amount_of, cell, go, unit_of


def test_a_latest_end_before_the_start_is_refused_with_proof_and_with_what_is_missing() -> None:
    refused = plan(cell(go(0.35, -0.2), latest_end_s=-3.0))
    assert isinstance(refused, NotPlanned)
    assert refused.reason is Reason.WINDOW_MISSED
    assert refused.proved
    assert refused.census.candidates == 0
    assert refused.refusal is not None
    assert (amount_of(refused.refusal), unit_of(refused.refusal)) == (3.0, "s")
    assert "latest_end_s is 3 s before the start" in refused.sentence
    assert isinstance(plan(cell(go(0.35, -0.2), latest_end_s=3.0)), Planned)
