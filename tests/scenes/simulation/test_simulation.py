"""A cell against its streams: every second is proved, what is not seen is a body, and what cannot run is refused."""

from __future__ import annotations

import copy
import math
from dataclasses import replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import assur
from assur.planner.errors import FaultError, InputError
from assur.planner.model.outcome import Plan
from assur.planner.trajectory import Trajectory
from assur.scenes import written_knots
from assur.scenes.reading.cell import Cell
from assur.scenes.scenarios import CELLS
from assur.scenes.session.session import NextMotion
from assur.scenes.simulation.cell import SimulatedCell, simulated
from assur.scenes.simulation.leg_times import of_runs
from assur.scenes.simulation.run import Run
from assur.scenes.simulation.simulate import Simulation, interval
from assur.scenes.simulation.tally import WAITS, Cycle, Tally
from assur.scenes.simulation.unseen import unseen_of
from assur.scenes.simulation.words import WAITS_FOR, bottleneck
from assur.scenes.streams.arrivals import arrivals
from assur.scenes.written_knots import with_rounded_knots
from tests.refused import refused_at

Document = dict[str, Any]
SECONDS, SEED = 24.0, 1


@cache
def _shipped() -> Document:
    return assur.load(CELLS / "shared" / "soap-flow.yaml")


def cell(stream: Document | None = None, **changes: Any) -> Document:
    """The shipped cell with changes of it, and of its stream; None takes a key away."""
    made = {**copy.deepcopy(_shipped()), **changes}
    if stream is not None:
        own = {**made["streams"]["soap"], **stream}
        made["streams"] = {"soap": {key: value for key, value in own.items() if value is not None}}
    return {key: value for key, value in made.items() if value is not None}


class Recorded(Run):
    """A run that keeps what was committed, and when each of these motions was proposed."""

    def __init__(self, made: SimulatedCell, seed: int = SEED, until_s: float = SECONDS) -> None:
        self.proposed: list[tuple[float, NextMotion]] = []
        super().__init__(made, seed, until_s, 20.0)

    def _proposed(self, steps: list[Document]) -> NextMotion:
        now_s = self.session.clock_s
        made = super()._proposed(steps)
        self.proposed.append((now_s, made))
        return made

    @property
    def committed(self) -> list[tuple[float, NextMotion]]:
        return [each for each in self.proposed if each[1].segment is not None]

    def through(self) -> Recorded:
        while not self.over:
            self.step()
        return self


@cache
def run() -> Recorded:
    return Recorded(simulated(cell())).through()


def test_every_motion_is_checked_and_every_second_is_covered() -> None:
    done = run()
    figures = done.tally.figures(SECONDS)
    assert figures["checked"] == len(done.committed)
    assert figures["placed"] >= 8
    assert figures["refusals"].keys() <= {"BODY_COLLISION", "CONTROL_POINT_IN_COLLISION", "NOT_CERTIFIED"}
    covered = [(made.starts_s, made.segment.proved_until_s) for _, made in done.committed if made.segment is not None]
    assert covered[0][0] == 0.02
    assert all(after[0] <= before[1] for before, after in pairwise(covered))
    assert covered[-1][1] >= SECONDS
    assert all(proposed_s + 0.02 <= made.starts_s for proposed_s, made in done.committed)


def test_the_same_seed_gives_the_same_result_to_the_bit_and_another_one_does_not() -> None:
    once = assur.simulate(cell(), minutes=0.2, seed=3)
    assert assur.simulate(assur.Cell(cell()), minutes=0.2, seed=3) == once
    assert once["complete"]
    several = assur.simulate(cell(), minutes=0.2, seed=2, seeds=2)
    assert several["runs"][1] == once["runs"][0]
    assert several["runs"][0] != {**once["runs"][0], "seed": 2}


def test_all_time_is_that_of_a_cycle_or_of_a_wait_with_a_reason() -> None:
    tally = run().tally
    idle = tally._idle(SECONDS)
    cycles = sum(min(each.ends_s, SECONDS) - each.starts_s for each in tally.cycles if each.starts_s < SECONDS)
    assert sum(idle.values()) + cycles == pytest.approx(SECONDS, abs=1e-9)
    figures = tally.figures(SECONDS)
    assert figures["moving"] + sum(figures["waiting_s"].values()) / SECONDS == pytest.approx(1.0)
    assert 0.3 < figures["moving"] < 0.95
    assert all(before.free_s <= after.starts_s for before, after in pairwise(tally.cycles))


def test_the_legs_of_a_run_are_all_of_its_motion_and_the_worst_error_of_a_pick_is_of_its_proofs() -> None:
    figures, segments = run().tally.figures(SECONDS), [made.segment for _, made in run().committed if made.segment]
    legs = {row["leg"]: row for row in figures["legs"]}
    begins = [segment.starts_s for segment in segments]
    ends = [min(segment.motion.end, until_s) for segment, until_s in zip(segments, [*begins[1:], SECONDS], strict=True)]
    moved_s = sum(max(0.0, end - begin) for begin, end in zip(begins, ends, strict=True))
    assert sum(row["count"] * row["mean_s"] for row in legs.values()) == pytest.approx(moved_s)
    assert sum(row["share"] for row in legs.values()) == pytest.approx(moved_s / SECONDS)
    assert legs["depart from the part"]["count"] >= figures["placed"] == legs["depart from the slot"]["count"]
    assert legs["dwell at the part"]["mean_s"] == pytest.approx(0.1)
    assert set(legs["travel to the slot"]["binds"]) <= {f"{rate} of j1" for rate in ("velocity", "acceleration")}
    assert sum(legs["travel to the slot"]["binds"].values()) == legs["travel to the slot"]["count"]
    assert all(row["binds"] == {} for name, row in legs.items() if "travel" not in name)
    assert figures["worst_pick_error"]["position_m"] == pytest.approx(0.001, abs=1e-5)
    assert figures["worst_pick_error"]["yaw_rad"] == pytest.approx(math.radians(1.0), abs=1e-5)
    (soap,) = _shipped()["kinds"].values()
    known = assur.simulate(cell(kinds={"soap": {**soap, "uncertainty": {}}}), minutes=0.2)
    assert known["worst_pick_error"] == {"position_m": 0.0, "yaw_rad": 0.0}


def test_each_reason_of_a_wait_has_its_words() -> None:
    assert set(WAITS_FOR) == set(WAITS)


def test_legs_of_several_runs_are_counted_together() -> None:
    one = {"leg": "travel to the slot", "count": 1, "mean_s": 1.0, "share": 0.1, "binds": {"velocity of j1": 1}}
    other = {"leg": "travel to the slot", "count": 3, "mean_s": 2.0, "share": 0.6, "binds": {"jerk of j4": 2}}
    (row,) = of_runs([{"legs": [one]}, {"legs": [other]}, {"legs": []}], 20.0)
    assert row == {**one, "count": 4, "mean_s": 1.75, "share": 0.35, "binds": {"jerk of j4": 2, "velocity of j1": 1}}
    assert list(row["binds"]) == ["jerk of j4", "velocity of j1"]


TO_PART = {"leg": "travel to the part", "count": 4, "mean_s": 0.5, "share": 0.4, "binds": {"velocity of j1": 3}}
DWELL = {"leg": "dwell at the slot", "count": 4, "mean_s": 0.1, "share": 0.1, "binds": {}}
WAIT = {"leg": "wait on the way to the part", "count": 1, "mean_s": 0.1, "share": 0.9, "binds": {}}


@pytest.mark.parametrize(
    ("legs", "waiting", "missed", "sentence"),
    [
        (
            [WAIT, TO_PART, DWELL], {"part": 0.2}, 1,
            "The arm moves 80 % of the time; the travel to the part takes longest (40 %); velocity of j1 binds it.",
        ),
        (
            [{**TO_PART, "binds": {"velocity of j1": 1}}], {}, 1,
            "The arm moves 80 % of the time; the travel to the part takes longest (40 %); mostly no limit binds it: "
            "the arm has time to spare.",
        ),
        (
            [TO_PART, {**DWELL, "share": 0.5}], {"part": 0.2}, 0,
            "The arm moves 80 % of the time; the dwell at the slot takes longest (50 %). No part was missed: it takes "
            "all that come.",
        ),
        (
            [DWELL], {"planning": 0.05, "slot": 0.45}, 1,
            "The arm waits for a free slot 45 % of the time: more carriers a minute, or more slots on each, would "
            "help. The arm moves 80 % of the time; the dwell at the slot takes longest (10 %).",
        ),
        ([WAIT], {}, 1, "The arm was not moved."),
    ],
)  # fmt: skip
def test_what_limits_the_parts_a_minute_is_stated(
    legs: list[Document], waiting: Document, missed: int, sentence: str
) -> None:
    found = {
        "moving": 0.8,
        "legs": legs,
        "waiting": waiting,
        "missed": missed,
        "refusals": {},
        "picked": 4,
        "placed": 4,
    }
    assert bottleneck(found) == sentence
    refused = {**found, "plans": 9, "refusals": {"OUT_OF_REACH": 4, "BODY_COLLISION": 1}}
    words = "5 of 9 motions could not be planned, most often for OUT_OF_REACH. "
    assert bottleneck(refused) == ((words + sentence) if legs != [WAIT] else sentence)
    assert "No part was missed" not in bottleneck({**found, "picked": 0})


def test_a_wait_is_for_what_was_lacking_at_that_time() -> None:
    tally = Tally([("a", 5.0), ("b", 50.0)])
    cycles = [Cycle("a", "box", 0, 3.0, 4.0, 5.0, 6.0, 6.0), Cycle("c", "box", 1, 9.0, 9.5, 10.5, 11.0, 11.0)]
    for cycle in cycles:
        tally.cycles.append(cycle)
    assert (list(tally.cycles), len(tally.cycles)) == (cycles, len(cycles))
    for wait in [(0.0, "part"), (2.0, "refused"), (5.5, "unseen"), (11.5, "part")]:
        tally.waits(*wait)
    assert tally._idle(12.0) == {"part": 2.5, "refused": 1.0, "unseen": 3.0, "planning": 0.5}
    figures = tally.figures(12.0)
    assert (figures["picked"], figures["placed"], figures["missed"]) == (2, 2, 0)
    assert (figures["parts_per_minute"], figures["cycle_s"]) == (10.0, 2.5)
    assert Tally([("a", 5.0)]).figures(12.0)["missed"] == 1


@pytest.mark.parametrize("seed", range(3))
def test_parts_that_are_not_seen_when_a_motion_is_planned_are_within_what_it_is_proved_against(seed: int) -> None:
    made = simulated(cell({"mean_s": 0.6, "seen": {"at_mm": -450, "latency_ms": 200}}))
    stream, unseen = made.streams[0], made.unseen[0]
    length, width, height = unseen.part["shape"]["box"]["size_m"]
    middle = unseen.part["pose"]["at_m"]
    front_m, reached_m = middle[0] + 0.5 * length, -made.leaves_m[0]  # the belt passes the base of the arm
    assert front_m == pytest.approx(unseen.front_m)
    assert reached_m < -0.55 - 0.2
    assert (height, middle[2]) == (pytest.approx(0.03), 0.015)
    later, nearest, behind = arrivals(stream, seed, 90.0), math.inf, 0
    for proposed_s in np.arange(0.0, 30.0, 0.37).tolist():
        for part in [each for each in later if each.known_s > proposed_s]:
            x, radius = part.x_m + stream.speed_m_s * (proposed_s - part.time_s), part.kind.radius_m
            assert x + radius <= front_m + 1e-9
            assert abs(part.y_m - middle[1]) + radius <= 0.5 * width + 1e-9
            nearest = min(nearest, front_m - x - radius)
            if x - radius < middle[0] - 0.5 * length:  # not all of it is covered, and it is not in reach meanwhile
                behind += 1
                assert x + radius + stream.speed_m_s * unseen.proved_s <= reached_m + 1e-9
    assert nearest < 0.06
    assert behind > 100


def test_each_motion_has_what_is_not_seen_among_its_bodies_and_no_step_handles_it() -> None:
    made = simulated(cell())
    for proposed_s, each in run().committed:
        bodies = {body["name"]: body for body in each.judged.request["bodies"]}
        assert bodies["unseen.soap"]["pose"]["at_s"] == proposed_s
        assert bodies["unseen.soap"]["uncertainty"]["position_m"] >= 0.001
        assert not any("unseen.soap" in str(step) for step in each.judged.request["task"])
        assert each.segment is not None
        assert each.segment.proved_until_s <= proposed_s + made.unseen[0].proved_s


def test_a_part_is_picked_within_its_window_and_from_where_it_was_seen() -> None:
    (stream,) = run()._cell.streams
    coming = {part.name: part for part in arrivals(stream, SEED, SECONDS)}
    for cycle in run().tally.cycles:
        part = coming[cycle.part]
        assert part.known_s <= cycle.starts_s
        assert part.passes_s(stream.window_m[0], stream.speed_m_s) <= cycle.picked_s
        assert cycle.picked_s <= part.passes_s(stream.window_m[1], stream.speed_m_s) + 0.5


def test_a_grid_that_is_full_is_replaced_by_an_empty_one() -> None:
    slots = [cycle.slot for cycle in run().tally.cycles]
    assert len(slots) > 8
    assert slots == [k % 4 for k in range(len(slots))]
    assert all(len(each.judged.request["bodies"]) <= 20 for _, each in run().committed)


def test_missed_parts_are_bodies_while_the_arm_reaches_them_and_then_forgotten() -> None:
    done = Recorded(simulated(cell({"mean_s": 0.55, "window_mm": [-250, -150]})), until_s=20.0).through()
    figures = done.tally.figures(20.0)
    assert figures["missed"] > 10
    assert figures["picked"] + figures["missed"] + figures["remaining"] == figures["known"]
    (stream,), (leaves_m,) = done._cell.streams, done._cell.leaves_m
    assert leaves_m > 0.6
    taken = {cycle.part for cycle in done.tally.cycles}
    there = {
        part.name
        for part in arrivals(stream, SEED, 20.0)
        if part.name not in taken and part.passes_s(leaves_m, stream.speed_m_s) > 20.0
    }
    assert {name for name in done.session.parts if not name.startswith("unseen")} - taken == there
    assert any(part.passes_s(leaves_m, stream.speed_m_s) < 20.0 for part in arrivals(stream, SEED, 20.0))


def test_without_parts_the_arm_stands_and_standing_is_proved() -> None:
    done = Recorded(simulated(cell({"mean_s": None, "every_s": 60}, options={})), until_s=20.0)
    done.through()
    stands = [made for _, made in done.committed if len(made.judged.request["task"]) == 1]
    assert len(stands) >= 5
    figures = done.tally.figures(20.0)
    assert figures["placed"] == 1
    assert figures["waiting_s"]["part"] > 15.0
    assert figures["moving"] < 0.3


def test_a_frame_that_is_written_for_another_time_is_the_same_belt() -> None:
    frames = {"belt": {"conveyor": {"at_mm": [-450, 350, 50], "speed_mm_s": 150, "at_s": -3}}}
    moved = {"at_mm": [-450, 0, 15], "seen": {"at_mm": -150, "latency_ms": 80}, "window_mm": [200, 700]}
    one, other = (
        Simulation(each, 0.3, SEED, 1, 20.0).cell.chooser.times for each in (cell(), cell(moved, frames=frames))
    )
    assert np.allclose(one.there, other.there)
    once, again = (assur.simulate(each, minutes=0.2) for each in (cell(), cell(moved, frames=frames)))
    assert (once["picked"], once["missed"]) == (again["picked"], again["missed"])
    assert once["parts_per_minute"] == pytest.approx(again["parts_per_minute"])


def test_a_motion_that_the_checker_refuses_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    plans = list[Plan]()

    def moved(of: Cell, plan: Plan) -> Plan:
        plan, knots = with_rounded_knots(of, plan), plan.trajectory
        if len(plan.arrivals) > 1:  # a part is handled; the way to the refuge is right
            q = knots.q + 0.01 * (np.arange(len(knots.q)) == 3)[:, None]
            plan = replace(plan, trajectory=Trajectory(knots.time, q, knots.qd, knots.qdd, jumps=knots.jumps))
            plans.append(plan)
        return plan

    monkeypatch.setattr(written_knots, "with_rounded_knots", moved)
    with pytest.raises(FaultError, match="the checker refuses the motion"):
        Recorded(simulated(cell())).through()
    assert len(plans) == 2  # the search was made once more, with its plans checked


def test_a_motion_that_is_proved_for_longer_than_what_is_not_seen_is_known_ends_the_run() -> None:
    made = simulated(cell())
    short = [type(each)(**{**vars(each), "proved_s": 3.0}) for each in made.unseen]
    with pytest.raises(FaultError, match="what is not seen until"):
        Recorded(SimulatedCell(**{**vars(made), "unseen": tuple(short)})).through()


def test_an_interrupted_simulation_has_what_there_is() -> None:
    simulation, calls = Simulation(cell(), 5.0, SEED, 3, 20.0), list[float]()

    def watch(number: int, now_s: float) -> None:
        calls.append(now_s)
        if now_s > 8.0:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulation.run(watch)
    found = simulation.document
    assert not found["complete"]
    assert 8.0 < found["runs"][0]["simulated_s"] < 30.0
    assert found["placed"] >= 1
    assert calls == sorted(calls)


def test_the_interval_is_that_of_student() -> None:
    assert interval([30.0]) is None
    half = 4.302653 / math.sqrt(3)
    assert interval([29.0, 30.0, 31.0]) == pytest.approx([30 - half, 30 + half])
    assert interval([30.0, 30.0]) == [30.0, 30.0]
    low, high = interval([30.0] * 4, 2.0) or (0.0, 0.0)
    assert (30.0 - low, high - 30.0) == pytest.approx([3.182 * 2.0 / math.sqrt(12.0 * 4)] * 2, rel=1e-3)


def test_notes_say_where_the_camera_is_too_near_and_where_the_order_hardly_matters() -> None:
    far, near = (cell({"gap_mm": 5, "seen": {"at_mm": at_mm}}) for at_mm in (-600, -300))
    one, other = (Simulation(each, 0.2, SEED, 1, 20.0).document["notes"] for each in (far, near))
    assert [note.partition(":")[0] for note in one] == ["parts in one lane for one grid of slots"]
    assert other[0].startswith("soap: the line at which parts are seen is 50 mm before the window")
    assert Simulation(cell({"gap_mm": 5, "lane_mm": [-60, 60]}), 0.2, SEED, 1, 20.0).document["notes"] == []


def test_the_time_until_the_first_part_is_put_down_is_noted_of_a_short_run() -> None:
    made = Simulation(cell(), 0.2, SEED, 1, 20.0)
    made.run()
    first_s = made.runs[0]["first_placed_s"]
    assert 0.05 * made.until_s < first_s < made.until_s
    assert f"its first part is put down after {first_s:.3g} s of 12 s" in " ".join(made._notes(1.0))
    made.until_s = 20.1 * first_s
    assert "empty cell" not in " ".join(made._notes(1.0))


def test_a_stream_whose_parts_may_be_too_near_to_each_other_to_be_picked_is_noted() -> None:
    needed_mm = 1 + 2 * (1 + math.hypot(30, 20) * math.radians(1))
    (note,) = simulated(cell()).room
    assert note.startswith("soap: a part may come 0 mm behind another, and to pick it for certain 4.26 mm are needed")
    assert len(simulated(cell({"gap_mm": needed_mm - 0.01})).room) == 1
    assert simulated(cell({"gap_mm": needed_mm + 0.01})).room == ()
    assert simulated(cell({"mean_s": None, "every_s": 1})).room == ()


@pytest.mark.parametrize(("bottom_mm", "wider"), [(-130, True), (-120, True), (-110, False)])
def test_a_tool_that_goes_down_beside_its_part_needs_more_room(bottom_mm: float, wider: bool) -> None:
    """A plate of 100 mm, whose lower side is beside the tops of other parts, or above them."""
    robot = copy.deepcopy(_shipped()["robot"])
    plate = {"shape": {"cylinder": {"radius_mm": 50, "height_mm": 5}}, "at_mm": [0, 0, bottom_mm + 2.5]}
    robot["tool"]["bodies"].append({"name": "plate", **plate})
    found = simulated(cell({"gap_mm": 10}, robot=robot)).room
    assert found == tuple(note for note in found if "13.9 mm by which the tool is wider" in note)
    assert len(found) == wider


@pytest.mark.parametrize("rule", ["fifo", "edd", "nearest", "spt"])
def test_each_rule_runs(rule: str) -> None:
    assert Recorded(simulated(cell(selection=rule)), until_s=8.0).through().tally.cycles


def test_kinds_go_to_their_slots_and_an_elbow_that_is_free_is_used() -> None:
    kinds = {
        **_shipped()["kinds"],
        "disc": {"shape": {"cylinder": {"radius_mm": 20, "height_mm": 30}}, "grasp_mm": [0, 0, 15]},
    }
    slots = {**_shipped()["slots"], "tray": {"at_mm": [100, -300, 60], "step_mm": [50, 0, 0], "count": [2, 1, 1]}}
    stream = {"kind": None, "kinds": {"soap": 1, "disc": 1}, "to": {"soap": "box", "disc": "tray"}}
    options = {**_shipped()["options"], "elbow": "auto"}
    made = simulated(cell(stream, kinds=kinds, slots=slots, options=options))
    assert made.chooser.modes == (0, 1)
    done = Recorded(made).through()
    coming = {part.name: part for part in arrivals(made.streams[0], SEED, SECONDS)}
    assert {cycle.grid for cycle in done.tally.cycles} == {"box", "tray"}
    for cycle in done.tally.cycles:
        assert cycle.grid == coming[cycle.part].kind.to


BALL: Document = {"shape": {"sphere": {"radius_mm": 5}}, "pose": {"at_mm": [0, -600, 50]}}
FRAMES: Document = {"turn": {"turntable": {"rate_deg_s": 10}}, **copy.deepcopy(_shipped()["frames"])}


@pytest.mark.parametrize(
    ("stream", "changes", "field", "allowed"),
    [
        ({}, {"streams": None}, "streams", "at least one stream"),
        ({}, {"refuge": None}, "refuge", "the name of a position"),
        ({}, {"refuge": "hom"}, "refuge", "did you mean home"),
        ({}, {"positions": {"home": {"at_mm": [900, 0, 200]}}}, "refuge", "reaches"),
        (
            {}, {"frames": FRAMES, "positions": {"home": {"frame": "turn", "at_mm": [350, 0, 100]}}},
            "positions.home.frame", "at rest",
        ),
        ({}, {"slots": {"box": {"at_mm": [900, -235, 65]}}}, "slots.box.at_mm", "number 1 of box is out of its reach"),
        (
            {}, {"slots": {"box": {"at_mm": [255, -235, 65], "step_mm": [400, 0, 0], "count": [3, 1, 1]}}},
            "slots.box.at_mm", "number 2 of box is out of its reach",
        ),
        ({}, {"frames": FRAMES, "slots": {"box": {"frame": "turn"}}}, "slots.box.frame", "at rest"),
        ({"window_mm": [800, 900]}, {}, "streams.soap.window_mm", "that the arm reaches"),
        ({}, {"options": {"stay_safe_s": 0.1}}, "options.stay_safe_s", "0.5 to 10 s"),
        ({}, {"options": {"elbow": "up"}}, "options.elbow", ""),
        ({}, {"options": {"seed": math.nan}}, "options.seed", ""),
        ({"every_s": 2}, {}, "streams.soap.mean_s", "exactly one"),
        ({"kind": "brick"}, {}, "streams.soap.kind", "one of the kinds"),
        ({}, {"colour": "red"}, "colour", ""),
        ({}, {"bodies": [{"name": "soap-12", **BALL}]}, "bodies[0].name", "parts of the stream soap"),
        ({}, {"bodies": [{"name": "soap-bar", **BALL}, {"name": "unseen.soap", **BALL}]}, "bodies[1].name", "stream"),
        ({}, {"bodies": [{"name": "pallet", **BALL, "pose": {"frame": "belt"}}]}, "bodies[0].pose", "does not ride"),
        ({}, {"schema": "assur/1"}, "schema", ""),
    ],
)  # fmt: skip
def test_a_cell_that_cannot_run_is_refused(stream: Document, changes: Document, field: str, allowed: str) -> None:
    given = {**changes, "streams": None} if changes.get("streams", 0) is None else changes
    with refused_at(field, allowed):
        simulated(cell(stream, **given) if given.get("streams", 0) is not None else cell(**given))


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"minutes": math.nan}, "minutes"),
        ({"minutes": 0}, "minutes"),
        ({"minutes": 1e9}, "minutes"),
        ({"minutes": "ten"}, "minutes"),
        ({"seed": -1}, "seed"),
        ({"seed": 1.5}, "seed"),
        ({"seed": True}, "seed"),
        ({"seeds": 0}, "seeds"),
        ({"seeds": 10**9}, "seeds"),
        ({"planning_ms": -1}, "planning_ms"),
        ({"planning_ms": math.inf}, "planning_ms"),
        ({"planning_ms": 500}, "planning_ms"),
        ({"minutes": 0.05}, "minutes"),
    ],
)
def test_arguments_that_are_not_right_are_refused(arguments: Document, field: str) -> None:
    with refused_at(field):
        assur.simulate(cell(), **{"minutes": 0.2, **arguments})


def test_what_is_no_cell_is_refused() -> None:
    with refused_at("cell"):
        assur.simulate(3)


def test_a_refuge_that_the_arm_does_not_reach_is_named_where_it_is_written() -> None:
    high = {"home": {"at_mm": [350, 0, 600], "yaw_deg": 0}}
    with refused_at("positions.home.at_mm", "beyond its range"):
        assur.simulate(cell(positions=high), minutes=0.2)
    inside = [*_shipped()["bodies"], {"name": "post", **BALL, "pose": {"at_mm": [350, 0, 200]}}]
    with refused_at("refuge", "the arm collides at the start"):
        assur.simulate(cell(bodies=inside), minutes=0.2)


def test_a_belt_that_has_gone_far_is_counted_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("assur.scenes.simulation.run.LONGEST_M", 1.2)
    done = Recorded(simulated(cell())).through()
    figures = done.tally.figures(SECONDS)
    assert figures["placed"] >= 7
    assert done._since_s > 16.0
    covered = [(made.starts_s, made.segment.proved_until_s) for _, made in done.committed if made.segment is not None]
    assert all(after[0] <= before[1] for before, after in pairwise(covered))
    for before, after in pairwise(made.segment for _, made in done.committed if made.segment is not None):
        at_s = after.motion.start
        assert np.abs(before.state(at_s)[0] - after.state(at_s)[0]).max() <= 1e-9
    frames = [made.judged.request["frames"]["belt"]["conveyor"].get("at_s", 0.0) for _, made in done.committed]
    assert len(set(frames)) >= 3
    slots = [cycle.slot for cycle in done.tally.cycles]
    assert slots == [k % 4 for k in range(len(slots))]


def test_a_part_is_taken_after_a_way_of_more_than_100_m() -> None:
    text = "time_s,x_mm,y_mm\n1,-1000,0\n260,-1000,0\n"
    stream = {"mean_s": None, "lane_mm": None, "yaw_deg": None, "csv": {"text": text}, "seen": {"at_mm": -900}}
    frames = {"belt": {"conveyor": {"at_mm": [0, 350, 50], "speed_mm_s": 400}}}
    found = assur.simulate(cell(stream, frames=frames), minutes=265 / 60)
    assert (found["placed"], found["missed"], found["complete"]) == (2, 0, True)


def test_each_reason_of_a_refusal_has_its_first_sentence() -> None:
    found = assur.simulate(cell({"mean_s": 0.55}, options={"clearance_mm": {"travel": 20, "near": 8}}), minutes=0.3)
    assert found["refusals"].keys() == found["examples"].keys()
    assert found["refusals"]["BODY_COLLISION"] > 0
    assert " s: " in found["examples"]["BODY_COLLISION"]
    assert "would come too close to" in found["examples"]["BODY_COLLISION"]


def test_a_refuge_beside_which_what_is_not_seen_passes_is_refused_before_the_run() -> None:
    """Parts that come as high as the arm stands, above the belt."""
    high = {**_shipped()["streams"]["soap"], "at_mm": [-700, 0, 100]}
    options = {**_shipped()["options"], "stay_safe_s": 4}
    home = {"home": {"at_mm": [-250, 350, 150]}}
    made = simulated(cell(streams={"soap": high}, positions=home, options=options))
    with refused_at("refuge", "a position in which the arm can stand beside what is not seen yet", value="home"):
        Run(made, 1, 20.0, 20.0)


@pytest.mark.parametrize(("key", "value"), [("stay_safe_s", 18), ("stay_safe_ms", 18_000), ("stay_safe_s", 0.1)])
def test_a_standstill_that_is_too_long_or_short_is_refused(key: str, value: float) -> None:
    with pytest.raises(InputError, match=rf"options.{key}: got {value}; allowed: 0.5 to 10 s, or 0 for 2 s"):
        simulated(cell(options={**_shipped()["options"], key: value}))


def test_budgets_of_the_clock_are_left_out() -> None:
    options = {**_shipped()["options"], "explain_budget_s": 1, "budget_s": 1}
    made = simulated(cell(options=options)).document["options"]
    assert (made["budget_s"], "explain_budget_s" in made) == (60.0, False)


def test_a_body_of_the_tool_has_no_name_of_a_part() -> None:
    robot = copy.deepcopy(_shipped()["robot"])
    robot["tool"]["bodies"][0]["name"] = "soap-12"
    with pytest.raises(InputError, match=r"robot.tool.bodies\[0\].name: got 'soap-12'; allowed: a name that is none"):
        simulated(cell(robot=robot))


def test_all_seeds_bring_parts_before_the_first_run_begins() -> None:
    made = Simulation(cell(), 0.08, 1, 40, 20.0)
    with refused_at("minutes", "so long that a part of each stream is known"):
        made.run()
    assert made.runs == []


def test_what_is_not_seen_is_as_far_as_a_belt_that_is_faster_takes_it() -> None:
    stream = replace(simulated(cell()).streams[0], latency_s=1.0)
    slow, fast = unseen_of(stream, -1.0, 0.0), unseen_of(stream, -1.0, 0.02)
    assert fast.front_m - slow.front_m == pytest.approx(0.02)
    assert fast.clear_m - slow.clear_m == pytest.approx(0.02)


def test_parts_are_known_when_they_are_seen() -> None:
    done = Run(simulated(cell()), SEED, 600.0, 20.0)
    while done.session.clock_s < 12.0:
        done.step()
    now_s = done.session.clock_s
    seen = sum(part.known_s <= now_s for part in arrivals(done._cell.streams[0], SEED, 600.0))
    assert done.tally.figures(now_s)["known"] == seen > 3


def test_streams_in_one_lane_are_noted() -> None:
    one = _shipped()["streams"]["soap"]
    made = Simulation(cell(streams={"soap": one, "more": one}), 0.1, 1, 1, 20.0)
    assert "soap and more come in the same lane of belt: neither knows the other" in " ".join(made._notes(1.0))
    apart = Simulation(cell(), 0.1, 1, 1, 20.0)
    assert "same lane" not in " ".join(apart._notes(1.0))
