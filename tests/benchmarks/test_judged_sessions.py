"""Logs of simulated cells are judged: nothing is found in a run as it is, and a fault that is made is counted."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import assur
from assur.scenes.scenarios import CELLS
from assur.scenes.session.log import read_log
from assur.scenes.session.session import RunningCell
from assur.scenes.simulation import cell as simulated_cells
from assur.scenes.simulation import run
from assur.scenes.simulation.unseen import Unseen, unseen_of
from assur.scenes.streams.stream import Stream
from benchmarks.figures import Document
from benchmarks.flows import FLOWS
from benchmarks.judge.sessions import broken_sessions
from benchmarks.judged_sessions import SHOWN, figures, judged
from tests.scenes.simulation.test_simulation import cell

MINUTES = 0.15


def test_nothing_is_found_in_a_run_as_it_is() -> None:
    record = judged("mixed-parts", MINUTES, 2)
    assert (record["faults"], record["findings"]) == ({}, [])
    assert record["simulated_s"] == pytest.approx(60.0 * MINUTES)
    assert record["motions"] > record["placed"] > 2
    worst, minutes, motions, placed = figures([record, record])
    assert (worst.values, worst.met(), worst.note) == ((0.0,), "yes", "")
    assert minutes.values[0] == pytest.approx(2.0 * MINUTES)
    assert (motions.values, placed.values) == ((2.0 * record["motions"],), (2.0 * record["placed"],))


def test_parts_that_are_known_too_well_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    parts = RunningCell._parts_at

    def exact(self: RunningCell, *a: Any) -> list[Document]:
        return [{key: value for key, value in part.items() if key != "uncertainty"} for part in parts(self, *a)]

    monkeypatch.setattr(RunningCell, "_parts_at", exact)
    record = judged("one-lane", MINUTES, 1)
    assert record["faults"]["known"] >= record["placed"]
    assert len(record["findings"]) == min(sum(record["faults"].values()), SHOWN)
    worst = figures([record])[0]
    assert (worst.values, worst.met()) == ((float(sum(record["faults"].values())),), "no")
    assert f"known {record['faults']['known']}" in worst.note


def test_a_stretch_that_is_not_seen_and_is_put_too_far_away_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def too_far(*given: Any) -> Unseen:
        made = unseen_of(*given)
        at = made.part["pose"]["at_m"]
        part = {**made.part, "pose": {**made.part["pose"], "at_m": [at[0] - 2.0, *at[1:]]}}
        return Unseen(made.name, part, made.front_m, made.clear_m - 2.0, made.proved_s)

    monkeypatch.setattr(simulated_cells, "unseen_of", too_far)
    records = [judged(name, MINUTES, 1) for name in FLOWS]
    assert sum(record["faults"].get("hit", 0) for record in records) > 0


def _as_near_as_proved(log: Path) -> list[tuple[str, str]]:
    """What the judge finds where the tool goes down to a belt of uncertain speed, as near to what is not seen as is
    proved."""
    document = cell({"seen": {"at_mm": -600, "latency_ms": 4000}, "lane_mm": None, "yaw_deg": None})
    document["frames"]["belt"] = {
        "conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": 100},
        "uncertainty": {"speed_mm_s": 10},
    }
    document["options"]["stay_safe_s"] = 2
    made = simulated_cells.simulated(document)
    (unseen,), proved = made.unseen, list[assur.Proposal]()
    with assur.Session(assur.Cell(made.document), start=made.start, refuge="home", log=log) as session:
        for x_mm in range(-20, -140, -20):
            session.see(unseen.name, **unseen.fields(session.clock_s))
            proposal = session.propose([{"move": {"to": {"at_mm": [x_mm, 350, 70], "yaw_deg": 0}}}])
            if not proposal.planned:
                assert "unseen.soap" in str(proposal.answer.sentence)
                break
            proved.append(proposal)
        session.commit(proved[-1])
        session.advance(proved[-1].starts_s + 1.0)
    assert 2 <= len(proved) < 6
    read, events = read_log(log)
    return [(each.kind, each.about) for each in broken_sessions(read, list(events), runs=2)]


def _at_nominal_speed(stream: Stream, reached_m: float, _: float) -> Unseen:
    return unseen_of(stream, reached_m, 0.0)


@pytest.mark.parametrize(
    ("stretch", "found"),
    [(unseen_of, set()), (_at_nominal_speed, {("hit", "cup, unseen soap on soap")})],
)
def test_a_stretch_that_is_too_short_for_a_belt_of_uncertain_speed_is_found(
    stretch: Callable[..., Unseen], found: set[tuple[str, str]], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A part may be 40 mm further on before it is reported: 10 mm/s for 4 s."""
    monkeypatch.setattr(simulated_cells, "unseen_of", stretch)
    assert {*_as_near_as_proved(tmp_path / "run.mcap")} == found


def test_parts_in_slots_are_where_these_are_when_places_are_counted_anew(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(run, "LONGEST_M", 1.7)
    path = tmp_path / "run.mcap"
    assur.simulate(assur.load(CELLS / "shared" / "soap-flow.yaml"), minutes=0.3, log=path)
    document, read = read_log(path)
    events = list(read)
    assert [each["call"] for each in events].count("session") == 2
    assert any("slot" in each["arguments"].get("fields", {}) for each in events)
    assert broken_sessions(document, events) == []
    document["slots"]["box"]["at_mm"][0] += 5
    assert {"place"} <= {each.kind for each in broken_sessions(document, events)}
