"""The benchmark of kept cells: every answer in a cell is judged, and each request is another one."""

from __future__ import annotations

from benchmarks.kept_cell import EACH, SETS, measured


def test_answers_in_kept_cells_are_measured_and_clean() -> None:
    records = measured(SETS[1], 2)
    assert len(records) == 2 * EACH
    for record in records.values():
        assert (record["status"], record["findings"]) == ("planned", [])
