"""The comparison of rules: the same streams for each, and figures that say what was run."""

from __future__ import annotations

import numpy as np

from assur.planner.selection import columns as c
from assur.planner.selection.names import RULES
from benchmarks.part_order import compared, ordered
from benchmarks.selection.cells import APART_M, CELLS, LATENCY_S, stream, tables


def test_rules_are_compared_on_the_same_streams() -> None:
    cell = CELLS["two belts, two places"].at_speed(0.1)
    found = compared(cell, 1.15, range(3))
    assert set(found["each_minute"]) == set(RULES)
    assert found["each_minute"][found["best_simple"]] == max(found["each_minute"][rule] for rule in RULES[1:])
    assert found["gain"] > 3.0
    again = compared(cell, 1.15, range(3))
    assert again["each_minute"] == found["each_minute"]


def test_no_rule_is_better_where_there_is_no_choice() -> None:
    found = compared(CELLS["one lane"], 1.15, range(2))
    assert len(set(found["each_minute"].values())) == 1


def test_the_look_ahead_takes_as_many_of_eight_parts_as_the_exact_order() -> None:
    for name in ("upstream nest", "mixed parts"):
        found = ordered(CELLS[name], 10)
        assert 4.0 < found["exact"] <= 8.0
        assert 0.0 <= found["behind"] <= 1.0


def test_parts_of_a_stream_are_apart_and_known_after_the_camera_line() -> None:
    cell = CELLS["mixed parts"]
    found, times = stream(cell, 1.3, 120.0, 7), tables(cell)
    assert len(found.parts) > 60
    assert (np.diff(found.known) >= 0.0).all()
    for lane in range(3):
        passed = found.parts[found.parts[:, c.PART_LANE] == lane, c.PART_PASSED]
        assert (np.diff(passed) >= APART_M / 0.2 - 1e-9).all()
    at_line = found.parts[:, c.PART_PASSED] + (cell.window[0] - cell.camera) / 0.2
    np.testing.assert_allclose(found.known - LATENCY_S, at_line, atol=1e-9)
    rate = len(found.parts) * times.rides[0, c.NOMINAL] / 120.0
    assert 1.0 < rate < 1.6
    shares = np.bincount(found.parts[:, c.PART_PLACE].astype(int), minlength=3) / len(found.parts)
    np.testing.assert_allclose(shares, cell.shares, atol=0.15)
