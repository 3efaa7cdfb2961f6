"""An end that is asked for before the start can never be kept, wherever the point is."""

from __future__ import annotations

from assur.planner.model.outcome import NotPlanned, Planned, Reason
from assur.planner.pipeline import plan
from tests.planner.cells import cell, go


def test_a_latest_end_before_the_start_is_refused_with_proof_and_with_what_is_missing() -> None:
    refused = plan(cell(go(0.35, -0.2), latest_end_s=-3.0))
    assert isinstance(refused, NotPlanned)
    assert refused.reason is Reason.WINDOW_MISSED
    assert refused.proved
    assert refused.census.candidates == 0
    assert refused.refusal is not None
    assert (refused.refusal.amount, refused.refusal.unit) == (3.0, "s")
    assert "latest_end_s is before the start" in refused.sentence
    assert isinstance(plan(cell(go(0.35, -0.2), latest_end_s=3.0)), Planned)
