"""The published cells with streams: they have the geometry of the table times, they run, and the rules are compared on
the same parts."""

from __future__ import annotations

import numpy as np
import pytest

import assur
from assur.planner.selection.names import RULES
from benchmarks.flow_simulation import AHEAD, FIRST, SIMPLE, compared
from benchmarks.flows import FLOWS, FOLDER, flow
from benchmarks.selection.cells import BELT_M, CELLS, LATENCY_S, PART_M, TCP_M, Cell


def test_the_files_are_those_that_are_listed() -> None:
    assert {path.stem for path in FOLDER.glob("*.yaml")} == set(FLOWS)


@pytest.mark.parametrize("name", FLOWS[1:])
def test_a_cell_has_the_geometry_of_the_cell_of_table_times(name: str) -> None:
    written = flow(name)
    (cell,) = (cell for key, cell in CELLS.items() if key.replace(",", "").replace(" ", "-") == name)
    assert isinstance(cell, Cell)
    streams = list(written["streams"].values())
    belts = [written["frames"][stream["frame"]]["conveyor"] for stream in streams]
    assert [(each["at_mm"][1], each["speed_mm_s"]) for each in belts] == [
        (pytest.approx(1e3 * belt.y), 1e3 * belt.speed) for belt in cell.belts
    ]
    for belt, stream, there in zip(cell.belts, streams, belts, strict=True):
        np.testing.assert_allclose(stream.get("lanes_mm", [0]), 1e3 * np.array(belt.lanes))
        np.testing.assert_allclose(stream["window_mm"], 1e3 * np.array(cell.window))
        assert stream["seen"]["at_mm"] == pytest.approx(1e3 * (cell.window[0] - cell.camera))
        assert stream["seen"]["latency_ms"] == 1e3 * LATENCY_S
        shares = list(stream.get("kinds", {"part": 1.0}).values())
        np.testing.assert_allclose(shares, cell.shares)
        slots = (
            [written["slots"][to] for to in stream["to"].values()] if len(shares) > 1 else [written["slots"]["nest"]]
        )
        np.testing.assert_allclose([each["at_mm"][:2] for each in slots], 1e3 * np.array(cell.places))
        # the tool's point is as high in a part as it is for the tables, on the belt and in the slots
        for kind in written["kinds"].values():
            at_m = 1e-3 * (there["at_mm"][2] + stream["at_mm"][2] + kind["grasp_mm"][2])
            assert at_m == pytest.approx(BELT_M + PART_M)
            for slot in slots:
                assert 1e-3 * (slot["at_mm"][2] + kind["grasp_mm"][2]) == pytest.approx(BELT_M + PART_M)
    assert written["robot"]["tool"]["tcp_mm"] == [0, 0, 1e3 * TCP_M]
    assert written["robot"]["limits"] == {"acceleration": 0.6, "jerk": 0.8, "j4_deg": [-180, 180]}


@pytest.mark.parametrize("name", FLOWS)
def test_each_cell_runs_and_its_parts_are_put_down(name: str) -> None:
    found = assur.simulate(flow(name), minutes=0.2)
    assert found["complete"]
    assert found["placed"] >= 4
    assert found["refusals"] == {}
    assert found["checked"] == found["plans"]


def test_the_rules_are_compared_on_the_same_parts() -> None:
    found = compared("upstream-nest", 0.2, 2)
    assert set(found["runs"]) == set(found["each_minute"]) == set(RULES)
    rates = {rule: run["parts_per_minute"] for rule, run in found["runs"].items()}
    assert all(len(each) == 2 for each in rates.values())
    assert all(found["each_minute"][rule] == pytest.approx(np.mean(each)) for rule, each in rates.items())
    assert found["each_minute"][found["best_simple"]] == max(found["each_minute"][rule] for rule in SIMPLE)
    best = found["each_minute"][found["best_simple"]]
    assert found["gain"] == pytest.approx(100.0 * (found["each_minute"][AHEAD] / best - 1.0))
    own = assur.simulate({**flow("upstream-nest"), "selection": "spt"}, minutes=0.2, seed=FIRST + 1)
    assert own["parts_per_minute"] == rates["spt"][1]
    assert found["findings"] == []
