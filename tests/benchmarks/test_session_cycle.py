"""The benchmark of a session's cycle: every motion is planned and accepted, in the rhythm of the parts."""

from __future__ import annotations

import pytest

from benchmarks.session_cycle import PERIOD_S, measured


def test_cycles_are_measured_planned_and_clean() -> None:
    records = measured(3)
    assert [(record["status"], record["findings"]) for record in records.values()] == 3 * [("planned", [])]
    for record in records.values():
        assert record["simulated_s"] == pytest.approx(PERIOD_S, rel=0.1)
        assert record["wall_s"] >= record["propose_s"] > 0.0
