"""The benchmark of a long run's memory: parts come, every motion is checked, and the memory is read."""

from __future__ import annotations

from benchmarks.simulation_memory import measured


def test_motions_of_a_run_are_checked_and_its_memory_is_read() -> None:
    records = list(measured(24, readings=3).values())
    assert len(records) == 3
    assert records[-1]["plans"] == records[-1]["checked"] > 5
    assert all(record["resident_mib"] > 10.0 for record in records)
