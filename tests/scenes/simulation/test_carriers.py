"""Carriers: slots that come on a conveyor and leave. Each is used once and in its window, what is in them rides with
them, and what cannot be filled is refused."""

from __future__ import annotations

import copy
import math
from collections import Counter
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

import assur
from assur.planner.model.outcome import LegKind
from assur.scenes.scenarios import CELLS
from assur.scenes.session.log import read_log
from assur.scenes.set_values import with_values
from assur.scenes.simulation.cell import simulated
from assur.scenes.simulation.changes import changes_of
from assur.scenes.simulation.filling import Filling
from assur.scenes.simulation.run import Run
from assur.scenes.simulation.simulate import Simulation
from assur.scenes.simulation.table_run import table_rate
from assur.scenes.simulation.tally import Tally
from assur.scenes.streams.arrivals import arrivals
from benchmarks.judge.sessions import broken_sessions
from tests.refused import refused_at
from tests.scenes.simulation.test_simulation import SEED, Recorded
from tests.scenes.simulation.test_simulation import cell as at_rest

Document = dict[str, Any]
SECONDS = 30.0
TRAYS: Document = {"text": "time_s,x_mm,y_mm\n0,-510,0\n8,-510,0\n"}


@cache
def _shipped() -> Document:
    return assur.load(CELLS / "shared" / "tray-flow.yaml")


def cell(**values: Any) -> Document:
    """The shipped cell with values that are set by their paths, in which "__" is in place of a point; None takes a key
    away."""
    made = copy.deepcopy(_shipped())
    for path, value in values.items():
        *above, key = path.split("__")
        of = made
        for each in above:
            of = of[each]
        if value is None:
            of.pop(key)
        else:
            of[key] = value
    return made


@cache
def run() -> Recorded:
    return Recorded(simulated(cell()), until_s=SECONDS).through()


def filled(done: Recorded) -> Iterator[tuple[str, str, tuple[float, ...]]]:
    """The parts that motions put down on carriers, the carriers, and the places on them."""
    for _, made in done.committed:
        for step in made.judged.request["task"]:
            to = step.get("place", {}).get("to", {})
            if "body" in to:
                yield step["place"]["part"], to["body"], tuple(to["at_m"])


def test_each_slot_of_each_tray_is_filled_once_in_their_order() -> None:
    found = list(filled(run()))
    assert len(found) == len(run().tally.cycles) >= 8
    assert max(Counter(each[1:] for each in found).values()) == 1
    assert max(Counter(part for part, _, _ in found).values()) == 1
    trays = [int(tray.removeprefix("tray-")) for _, tray, _ in found]
    assert trays == sorted(trays)
    assert max(Counter(trays).values()) == 4


def test_each_part_is_put_down_once_or_missed_or_still_coming() -> None:
    done = run()
    figures, names = done.tally.figures(SECONDS), [cycle.part for cycle in done.tally.cycles]
    known = {part.name for part in arrivals(done._cell.streams[0], SEED, SECONDS)}
    left = {name for name, left_s in done.tally.missed_s if left_s <= SECONDS and name not in names}
    coming = set(done._candidates) - left
    assert len(names) == len(set(names))
    assert known == {*names} | left | coming
    assert not {*names} & (left | coming)
    assert (figures["known"], figures["missed"]) == (len(known), len(left))
    on_the_way = {cycle.part for cycle in done.tally.cycles if cycle.picked_s > SECONDS}
    assert figures["remaining"] == len(coming | on_the_way) > 0
    assert left


def test_a_tray_and_what_is_on_it_leave_when_they_are_out_of_reach() -> None:
    near: Document = {
        "streams__tray__every_s": 4,
        "frames__out-belt": {"conveyor": {"at_mm": [0, -330, 50], "speed_mm_s": 90}},
    }
    done = Recorded(simulated(cell(**near)), until_s=SECONDS).through()
    stream, leaves_m = done._cell.streams[1], done._cell.leaves_m[1]
    gone = {part.name for part in arrivals(stream, SEED, SECONDS) if part.passes_s(leaves_m, 0.09) <= SECONDS}
    on_gone = {part for part, tray, _ in filled(done) if tray in gone}
    assert len(gone) >= 2
    assert len(on_gone) >= 3
    assert not {*done.session.parts} & (gone | on_gone)
    assert {part for part, tray, _ in filled(done) if tray not in gone} <= {*done.session.parts}


def test_what_is_not_seen_of_trays_is_as_high_and_wide_as_a_filled_one() -> None:
    (soap, tray), unseen = simulated(cell()).streams, simulated(cell()).unseen[1].part
    assert soap.kinds[0].to == "on-tray"
    assert tray.brings_carriers
    assert tray.kinds[0].heights_m == pytest.approx((-0.006, 0.036))
    assert unseen["shape"]["box"]["size_m"][2] == pytest.approx(0.042)
    over = simulated(cell(**{"slots__on-tray__step_mm": [-130, 60, 0], "streams__tray__every_s": 8})).streams[1]
    assert over.radius_m == pytest.approx(math.hypot(0.088, 0.03) + math.hypot(0.03, 0.02))


def test_without_a_free_slot_the_arm_waits_for_one() -> None:
    done = Recorded(simulated(cell(streams__tray__every_s=40)), until_s=SECONDS).through()
    figures = done.tally.figures(SECONDS)
    assert figures["placed"] == 4
    assert figures["waiting_s"]["slot"] > 10.0
    assert figures["missed"] > 2
    assert run().tally.figures(SECONDS)["waiting_s"]["slot"] < figures["waiting_s"]["slot"]


def test_an_arm_that_stands_with_a_part_waits_for_its_slot() -> None:
    legs = [SimpleNamespace(kind=LegKind.WAIT, step=k, t0=k, t1=k + 0.5, route=None) for k in range(3)]
    cell_of = SimpleNamespace(scene=SimpleNamespace(task=(1, 2, 3)))
    motion: Any = SimpleNamespace(legs=legs, arrivals=(), of_legs=((), None, None), starts_s=0.0, cell=cell_of)
    tally = Tally([])
    tally.follows(motion)
    assert tally.figures(9.0)["waiting_s"] == {"part": 0.5, "slot": 0.5, "planning": 9.0}


def test_kinds_go_to_their_slots_on_the_same_trays_and_at_rest() -> None:
    kinds = {**_shipped()["kinds"]}
    kinds |= {"bar": kinds["soap"], "chip": {**kinds["soap"], "shape": {"box": {"size_mm": [40, 40, 30]}}}}
    slots = {
        "left": {"kind": "tray", "at_mm": [-42, -30, 21], "step_mm": [0, 60, 0], "count": [1, 2, 1]},
        "right": {"kind": "tray", "at_mm": [42, -30, 21], "step_mm": [0, 60, 0], "count": [1, 2, 1]},
        "bin": {"at_mm": [380, 60, 65]},
    }
    own = {**_shipped()["streams"]["soap"], "kinds": {"soap": 1, "bar": 1, "chip": 1}}
    own["to"] = {"soap": "left", "bar": "right", "chip": "bin"}
    del own["kind"]
    done = Recorded(simulated(cell(kinds=kinds, slots=slots, streams__soap=own)), until_s=SECONDS).through()
    kind_of = {part.name: part.kind.name for part in arrivals(done._cell.streams[0], SEED, SECONDS)}
    assert {cycle.grid for cycle in done.tally.cycles} == {"left", "right", "bin"}
    for cycle in done.tally.cycles:
        assert cycle.grid == {"soap": "left", "bar": "right", "chip": "bin"}[kind_of[cycle.part]]
    for part, _, (x, _, _) in filled(done):
        assert (x > 0.0) == (kind_of[part] == "bar")


def test_a_full_grid_at_rest_is_exchanged_in_the_time_that_is_stated() -> None:
    slots = {"box": {**at_rest()["slots"]["box"], "exchange_s": 4}}
    done = Recorded(simulated(at_rest(slots=slots)), until_s=24.0).through()
    cycles = [*done.tally.cycles]
    assert [cycle.slot for cycle in cycles] == [k % 4 for k in range(len(cycles))]
    assert len(cycles) > 5
    for last, first in ((a, b) for a, b in pairwise(cycles) if b.slot == 0):
        assert first.starts_s >= last.placed_s + 4.0
    full_s = cycles[3].placed_s
    for proposed_s, made in done.committed:  # until then the parts are bodies that nothing may hit
        if full_s < proposed_s < full_s + 4.0:
            assert {cycle.part for cycle in cycles[:4]} <= {body["name"] for body in made.judged.request["bodies"]}
        if proposed_s >= full_s + 4.0:
            assert not {cycle.part for cycle in cycles[:4]} & {body["name"] for body in made.judged.request["bodies"]}
    assert done.tally.figures(24.0)["waiting_s"]["slot"] > 2.0


def logged(document: Document, folder: Path, minutes: float) -> tuple[Document, list[Document]]:
    """The cell and the calls of the log of a run, which a replay gives again."""
    log = folder / "run.mcap"
    once = assur.simulate(document, minutes=minutes, seed=SEED, log=log)
    assert assur.replay(log).same
    assert once["placed"] > 3
    found, events = read_log(log)
    return found, list(events)


def slot_faults(document: Document, events: list[Document]) -> list[str]:
    return [each.about for each in broken_sessions(document, events, runs=4) if each.kind == "slot"]


@pytest.mark.slow
def test_a_run_of_a_minute_is_replayed_and_the_judge_finds_nothing(tmp_path: Path) -> None:
    document, events = logged(cell(), tmp_path, 1.0)
    assert broken_sessions(document, events) == []


def test_the_judge_finds_a_slot_that_is_used_twice_and_one_that_has_left(tmp_path: Path) -> None:
    document, events = logged(cell(), tmp_path, 0.35)
    assert broken_sessions(document, events, runs=4) == []
    twice, first = copy.deepcopy(events), None
    for event in twice:
        for step in event["result"]["request"]["task"] if event["call"] == "commit" else ():
            if "place" in step:
                first = first or step["place"]["to"]
                step["place"]["to"] = {**step["place"]["to"], "at_m": first["at_m"], "body": first["body"]}
    assert any("in that of soap-" in about for about in slot_faults(document, twice))
    early, moved = copy.deepcopy(document), copy.deepcopy(document)
    early["streams"]["tray"]["window_mm"] = [-200, -150]
    assert any("behind the window" in about for about in slot_faults(early, events))
    moved["slots"]["on-tray"]["at_mm"] = [-43, -30, 21]
    assert any("off any" in about for about in slot_faults(moved, events))


def test_a_slot_from_which_the_part_was_taken_away_is_used_no_second_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def forget(self: Filling, slot: Any, part: str, placed_s: float) -> None:
        taken.append(part)

    def emptied(self: Run, to_s: float) -> None:
        events(self, to_s)
        for part in [part for part in taken if part in self.session.parts]:
            if any(cycle.part == part and cycle.placed_s <= self.session.clock_s for cycle in self.tally.cycles):
                self.session.gone(part)

    taken, events = list[str](), Run._events
    monkeypatch.setattr(Filling, "put", forget)
    monkeypatch.setattr(Run, "_events", emptied)
    document, calls = logged(cell(), tmp_path, 0.35)
    assert any("in that of soap-" in about for about in slot_faults(document, calls))


def test_trays_and_what_is_on_them_are_where_they_were_when_places_are_counted_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("assur.scenes.simulation.run.LONGEST_M", 1.6)
    document, events = logged(cell(), tmp_path, 0.45)
    assert sum(event["call"] == "session" for event in events) >= 3
    assert any(event["call"] == "see" and event["arguments"]["name"].startswith("soap-")
               and event["arguments"]["fields"]["pose"]["frame"] == "out-belt" for event in events)  # fmt: skip
    assert broken_sessions(document, events, runs=4) == []


def test_a_task_cannot_name_a_slot_on_a_kind() -> None:
    parts = [{"name": "a", "kind": "soap", "pose": {"frame": "belt", "at_mm": [-300, 0, 15]}}]
    steps = [{"transfer": {"parts": ["a"], "to": "on-tray"}}]
    start = {"tool": {"at_mm": [350, 0, 200], "yaw_deg": 0}, "elbow": "left"}
    own = {key: value for key, value in cell().items() if key not in ("streams", "refuge")}
    with refused_at("steps[0].transfer.to", "slots in a frame or relative to a body"):
        assur.Cell(own).plan(start=start, parts=parts, steps=steps)


def test_a_part_that_lies_where_a_slot_is_on_a_kind_has_no_slot_in_the_next_task() -> None:
    own = {key: value for key, value in cell().items() if key not in ("streams", "refuge")}
    own["options"] = {**own["options"], "stop": "first", "budget_s": 60}
    parts = [{"name": "a", "kind": "soap", "pose": {"at_mm": [300, -100, 80], "yaw_deg": 0}}]
    steps, start = [{"move": {"to": "home"}}], {"tool": {"at_mm": [350, 0, 200], "yaw_deg": 0}, "elbow": "left"}

    def following(grid: Document) -> Document:
        kept = assur.Cell({**own, "slots": {"on-tray": {**grid, "at_mm": [300, -100, 80]}}})
        part: Document = kept.plan(start=start, parts=parts, steps=steps).next_task(steps)["parts"][0]
        return part

    assert following({"kind": "tray"})["pose"] == parts[0]["pose"]
    assert following({})["slot"] == {"on-tray": 1}


def test_a_session_knows_the_kinds_that_have_slots() -> None:
    own = {key: value for key, value in cell(**{"slots__on-tray__kind": "trey"}).items() if key != "streams"}
    with refused_at("slots.on-tray.kind", "did you mean tray"):
        assur.Session(own, start={"tool": {"at_mm": [350, 0, 200], "yaw_deg": 0}, "elbow": "left"}, refuge="home")


def test_changes_of_a_cell_with_trays_move_no_slots_and_the_trays_are_no_parts() -> None:
    found = Simulation(cell(), 0.2, SEED, 1, 20.0)
    changes = {change.what for change in changes_of(found.cell, found.given)}
    assert {"out-belt is slower, with as many parts a minute", "tray is seen 200 mm further upstream"} <= changes
    assert not any("other side" in what for what in changes)
    assert not any(note.startswith("tray") for note in found.document["notes"])


@pytest.mark.parametrize(
    "document",
    [cell(streams__tray__every_s=15), at_rest(slots={"box": {**at_rest()["slots"]["box"], "exchange_s": 4}})],
)
def test_a_run_without_plans_waits_for_slots_too(document: Document) -> None:
    simulation = Simulation(document, 0.75, SEED, 1, 20.0)
    simulation.run()
    (run,) = simulation.runs
    assert run["waiting_s"]["slot"] > 5.0
    rate = table_rate(simulation.cell, SEED, 45.0, 20.0)
    assert abs(rate - run["parts_per_minute"]) * 0.75 <= 2.0
    free = Simulation(cell() if "tray" in document["streams"] else at_rest(), 0.75, SEED, 1, 20.0).cell
    assert table_rate(free, SEED, 45.0, 20.0) >= rate + 4.0


def test_more_carriers_and_no_exchange_are_tried_where_the_arm_waits_for_slots() -> None:
    seldom = cell(streams__tray__every_s=12)
    boxes = at_rest(slots={"box": {**at_rest()["slots"]["box"], "exchange_ms": 4000}})
    for document, what, values in (
        (seldom, "tray comes more often, 4 in place of 3", {"streams.tray.every_s": 9}),
        (boxes, "a full box is replaced at once", {"slots.box.exchange_ms": 0}),
    ):
        base = Simulation(document, 0.75, SEED, 1, 20.0)
        found = {change.what: change.values for change in changes_of(base.cell, document)}
        assert found[what] == values
        changed = base.with_cell(with_values(document, values))
        before, after = (table_rate(each.cell, SEED, base.until_s, 20.0) for each in (base, changed))
        assert after > 1.1 * before
    for document in (at_rest(), cell(streams__tray__every_s=None, streams__tray__csv=TRAYS)):
        changes = changes_of(simulated(document), document)
        assert not {each.what for each in changes if "often" in each.what or "at once" in each.what}


@pytest.mark.parametrize(
    ("values", "field", "allowed"),
    [
        ({"streams__soap__to": "on-tra"}, "streams.soap.to", "did you mean on-tray"),
        ({"streams__soap__to": None}, "streams.soap.to", "slots for soap"),
        ({"streams__tray__to": "on-tray"}, "streams.tray.to", "tray has slots (on-tray), so it is filled"),
        ({"slots__on-tray": {"kind": "soap"}}, "streams.soap.to", "soap has slots (on-tray), so it is filled"),
        ({"slots__on-tray__kind": "trey"}, "slots.on-tray.kind", "did you mean tray"),
        ({"slots__on-tray__frame": "out-belt"}, "slots.on-tray.kind", "at most one"),
        ({"slots__on-tray__exchange_s": 1}, "slots.on-tray.exchange_s", "at most one"),
        ({"slots__on-tray__contact_with": []}, "slots.on-tray.contact_with", "at most one"),
        ({"slots__on-tray__count": [2, 2, 2]}, "slots.on-tray.count", "1 along z"),
        ({"slots__on-tray__count": [200, 200, 1]}, "slots.on-tray.count", "at most 10,000 slots"),
        ({"slots__on-tray__step_mm": [-84, 100, 0]}, "slots.on-tray.step_mm", "70 mm from its origin, and it ends 65"),
        (
            {"slots__on-tray": {"kind": "tray", "at_mm": [-95, 0, 21]}},
            "slots.on-tray.at_mm", "95 mm from its origin, and it ends 90 mm",
        ),
        ({"streams__tray": None}, "streams.soap.to", "on-tray is on tray, and no stream brings tray"),
        ({"streams__tray__window_mm": [600, 700]}, "streams.tray.window_mm", "number 1 of on-tray is out of its reach"),
        ({"streams__soap": None}, "streams", "at least one stream of parts"),
        ({"streams__tray__window_mm": [200, -200]}, "streams.tray.window_mm", "the least x first"),
        (
            {"frames__out-belt__uncertainty": {"speed_mm_s": 1}},
            "streams.tray.frame", "a conveyor whose speed is certain",
        ),
        ({"bodies": [{"name": "tray-3", "shape": {"sphere": {"radius_mm": 5}}, "pose": {"at_mm": [0, 0, 900]}}]},
            "bodies[0].name", "none of the parts of the stream tray"),
    ],
)  # fmt: skip
def test_a_cell_whose_slots_cannot_be_filled_is_refused(values: Document, field: str, allowed: str) -> None:
    with refused_at(field, allowed):
        simulated(cell(**values))


def test_two_streams_of_the_same_trays_are_refused_and_so_are_kinds_that_go_onto_each_other() -> None:
    streams = {**_shipped()["streams"], "more": {**_shipped()["streams"]["tray"], "seen": {"at_mm": -400}}}
    with refused_at("streams.soap.to", "tray comes with tray, more"):
        simulated(cell(streams=streams))
    slots = {**_shipped()["slots"], "on-soap": {"kind": "soap", "at_mm": [0, 0, 21]}}
    streams = {**_shipped()["streams"], "tray": {**_shipped()["streams"]["tray"], "to": "on-soap"}}
    with refused_at("streams.soap.to", "soap has slots (on-soap)"):
        simulated(cell(streams=streams, slots=slots))
