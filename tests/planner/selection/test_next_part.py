"""Rules rank the parts that are known, and the look-ahead finds the best order of a few."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.laws.kinds import conveyor, fixed
from assur.planner.selection import columns as c
from assur.planner.selection.columns import Times
from assur.planner.selection.cycles import cycle
from assur.planner.selection.names import RULES
from assur.planner.selection.next_part import FreeArm, KnownPart, next_part, scored
from assur.planner.selection.rules import FREE, LEAVES, MEETS, SCORE
from assur.planner.selection.times import CycleTerms, Lane, Place, times_of
from benchmarks.selection.cells import CELLS, arm, stream, tables
from benchmarks.selection.running import run

TWO = CELLS["two belts, two places"]


def freed(times: Times, now: float = 0.0) -> FloatArray:
    """An arm that is free at the first place."""
    row = np.zeros(c.ARM_SLOT + len(times.places))
    row[c.ARM_TIME], row[c.ARM_WAY] = now, times.places[0, c.PLACE_BEGIN]
    return row


def best_order(times: Times, begin: FloatArray, parts: FloatArray) -> tuple[int, float]:
    """The most parts that any order takes, and when the last of them is done at the earliest, by trying all orders, and
    all working modes in each cycle."""
    most, soonest, modes = 0, 0.0, times.there.shape[2]
    for many in range(1, len(parts) + 1):
        for order in itertools.permutations(range(len(parts)), many):
            arms = [begin]
            for i in order:
                ends, tried = np.empty((modes, len(begin))), np.empty(len(begin))
                later = []
                for each in arms:
                    cycle(times, each, parts[i], ends, tried)
                    later += [row.copy() for row in ends if np.isfinite(row[c.ARM_TIME])]
                arms = later
            if arms:
                end = min(float(row[c.ARM_TIME]) for row in arms)
                if many > most or end < soonest:
                    most, soonest = many, end
    return most, soonest


@pytest.mark.parametrize("name", ["two belts, two places", "carton", "upstream nest"])
def test_the_look_ahead_begins_the_best_of_all_orders(name: str) -> None:
    cell = CELLS[name].at_speed(0.2)
    times, taken = tables(cell), 0
    for seed in range(6):
        parts = stream(cell, 2.5, 20.0, seed).parts[:4]
        begin = freed(times, float(parts[:, c.PART_PASSED].min() + times.lanes[:, c.LANE_ENTERS].min()))
        found = scored(times, begin, parts, "look-ahead", 6, 0.8)
        first = int(np.argmin(found[:, SCORE]))
        ends, tried = np.empty((1, len(begin))), np.empty(len(begin))
        cycle(times, begin, parts[first], ends, tried)
        rest = best_order(times, ends[0].copy(), np.delete(parts, first, 0))
        most, soonest = best_order(times, begin, parts)
        assert rest[0] + 1 == most
        assert (rest[1] if rest[0] else ends[0, c.ARM_TIME]) == pytest.approx(soonest, abs=1e-9)
        taken += most
    assert taken > 12


def test_each_rule_takes_the_part_that_it_names() -> None:
    times = tables(CELLS["upstream nest"].at_speed(0.1))
    coming = stream(CELLS["upstream nest"].at_speed(0.1), 1.3, 40.0, 3)
    now, parts = float(coming.known[11]) + 6.0, coming.parts[:12]
    begin = freed(times, now)
    found = {rule: scored(times, begin, parts, rule, 6, 0.8) for rule in RULES}
    can = np.flatnonzero(np.isfinite(found["fifo"][:, FREE]))
    assert 2 < len(can) < 12
    best = {rule: int(np.argmin(table[:, SCORE])) for rule, table in found.items()}
    assert best["fifo"] == can[0]
    assert best["spt"] == can[np.argmin(found["spt"][can, FREE])]
    assert best["edd"] == can[np.argmin(found["edd"][can, LEAVES])]
    assert all(np.isinf(table[np.isinf(table[:, FREE]), SCORE]).all() for table in found.values())
    s = now - parts[:, c.PART_PASSED]
    where = np.column_stack(
        (0.1 * s, 0.33 + np.array([-0.12, -0.06, 0.0, 0.06, 0.12])[parts[:, c.PART_LANE].astype(int)])
    )
    away = np.hypot(*(where - (-0.40, -0.05)).T) + np.where(
        s < times.lanes[parts[:, c.PART_LANE].astype(int), c.LANE_ENTERS], 10.0, 0.0
    )
    np.testing.assert_allclose(found["nearest"][can, SCORE], away[can], atol=1e-9)


def test_at_most_three_parts_are_ranked_and_none_that_has_left() -> None:
    times = tables(TWO)
    known = [KnownPart(f"part {k}", k % 6, 10.0 - 0.3 * k, k % 2) for k in range(5)]
    gone = KnownPart("gone", 0, 0.0, 0)
    free = FreeArm(0, 0.0, 0, (0, 0))
    for rule in RULES:
        ranked = next_part(10.0, free, [gone, *known], times, rule)
        assert len({each.part for each in ranked}) == len(ranked) == 3
        assert "gone" not in {each.part for each in ranked}
        assert ranked == next_part(10.0, free, [gone, *known], times, rule)
        for each in ranked:
            part = next(x for x in known if x.name == each.part)
            own = times.lanes[part.lane]
            assert own[c.LANE_ENTERS] <= each.meets_s - part.passed_s <= own[c.LANE_LEAVES] + 1e-6
            assert 10.0 <= each.waits_until_s <= each.meets_s
            assert each.place == part.place
    assert next_part(10.0, free, [gone], times) == ()
    assert next_part(10.0, free, [], times) == ()
    with pytest.raises(InputError, match="selection"):
        next_part(10.0, free, known, times, "random")


@pytest.mark.parametrize(
    ("field", "arguments"),
    [
        ("known.a.lane", {"known": [KnownPart("a", 6, 10.0, 0)]}),
        ("known.a.place", {"known": [KnownPart("a", 0, 10.0, -1)]}),
        ("known.a.passed_s", {"known": [KnownPart("a", 0, math.nan, 0)]}),
        ("now", {"now": math.inf}),
        ("arm.mode", {"arm": FreeArm(0, 0.0, 1, (0, 0))}),
        ("arm.place", {"arm": FreeArm(2, 0.0, 0, (0, 0))}),
        ("arm.way", {"arm": FreeArm(0, math.nan, 0, (0, 0))}),
        ("arm.slots", {"arm": FreeArm(0, 0.0, 0, (0,))}),
        ("selection.price", {"price": math.nan}),
        ("selection.depth", {"depth": 0}),
        ("selection.rule", {"rule": "lookahead"}),
    ],
)
def test_what_the_tables_do_not_have_is_refused(field: str, arguments: dict[str, Any]) -> None:
    right: dict[str, Any] = {
        "now": 10.0,
        "arm": FreeArm(0, 0.0, 0, (0, 0)),
        "known": [KnownPart("a", 0, 10.0, 0)],
        "times": tables(TWO),
    }
    assert len(next_part(**right)) == 1
    with pytest.raises(InputError) as caught:
        next_part(**{**right, **arguments})
    assert caught.value.field == field


def test_a_part_that_has_not_come_yet_is_waited_for() -> None:
    times = tables(CELLS["one lane"])
    (only,) = next_part(0.0, FreeArm(0, 0.0, 0, (0,)), [KnownPart("late", 0, 30.0, 0)], times)
    assert only.meets_s == pytest.approx(30.0 + times.lanes[0, c.LANE_ENTERS])
    travel = times.there[0, 0, 0, 0, 0, 0]
    assert only.waits_until_s == pytest.approx(only.meets_s - travel)


def test_slots_that_pass_are_filled_in_their_order_and_those_that_rest_one_after_the_other() -> None:
    cell = CELLS["carton"]
    parts, times = stream(cell, 1.0, 60.0, 1), tables(cell)
    row, ends, tried = freed(times, 0.0), np.empty((1, c.ARM_SLOT + 1)), np.empty(c.ARM_SLOT + 1)
    period, before = times.places[0, c.PLACE_PERIOD], -1.0
    for part in parts.parts[:20]:
        cycle(times, row, part, ends, tried)
        if not np.isfinite(ends[0, c.ARM_TIME]):
            continue
        slot = ends[0, c.ARM_SLOT] - 1
        assert slot > before
        # the way is how long ago the slot passed its mark, when the tool is up again
        assert ends[0, c.ARM_WAY] == pytest.approx(ends[0, c.ARM_TIME] - slot * period, abs=2e-5)
        assert ends[0, c.ARM_WAY] <= times.places[0, c.PLACE_LEAVES]
        before, row = slot, ends[0].copy()
    assert before > 5
    box = Place(fixed(Pose(0.3, -0.23, 0.05)), (Pose(0.0, 0.0, 0.0), Pose(0.06, 0.0, 0.0), Pose(0.0, -0.06, 0.0)))
    lane = Lane(conveyor(Pose(0.0, 0.35, 0.05), 0.2), Pose(0.0, 0.0, 0.01), (-1.25, 1.25))
    times = times_of(arm(), (0,), [lane], [box], CycleTerms(Pose(0.0, 0.0, -0.1), 0.03, 0.2, 0.2))
    row, ways = freed(times), list[float]()
    for k in range(5):
        cycle(times, row, np.array([0.0, 3.0 * k, 0.0]), ends, tried)
        row = ends[0].copy()
        ways.append(float(row[c.ARM_WAY]))
    assert ways == [0.0, 1.0, 2.0, 0.0, 1.0]
    np.testing.assert_allclose(times.place_points[0].T, [[0.3, -0.23], [0.36, -0.23], [0.3, -0.29]])


def test_a_lane_out_of_reach_is_refused() -> None:
    lane = Lane(conveyor(Pose(0.0, 3.0, 0.05), 0.2), Pose(0.0, 0.0, 0.01), (-1.0, 1.0))
    place = Place(fixed(Pose(0.3, -0.23, 0.05)), (Pose(0.0, 0.0, 0.0),))
    handling = CycleTerms(Pose(0.0, 0.0, -0.1), 0.03, 0.2, 0.2)
    with pytest.raises(InputError, match="two points"):
        times_of(arm(), (0,), [lane], [place], handling)


def test_a_meeting_is_where_the_tables_have_it() -> None:
    """The arm that is met by the rule's cycle has travelled as long as the table says."""
    times = tables(TWO)
    part = np.array([[2.0, 10.0, 1.0]])
    found = scored(times, freed(times, 9.0), part, "spt", 6, 0.8)[0]
    s = found[MEETS] - 10.0
    own = times.lanes[2]
    travel = np.interp(
        s, own[c.LANE_BEGIN] + own[c.LANE_STEP] * np.arange(times.there.shape[-1]), times.there[0, 0, 0, 2, 0]
    )
    assert found[MEETS] == pytest.approx(9.0 + travel, abs=2e-5)
    picked = found[MEETS] + times.rides[0, c.RIDE_PICK] - 10.0
    back = np.interp(
        picked, own[c.LANE_BEGIN] + own[c.LANE_STEP] * np.arange(times.there.shape[-1]), times.back[2, 0, :, 1, 0, 0]
    )
    assert found[FREE] == pytest.approx(picked + 10.0 + back + times.rides[0, c.RIDE_PLACE], abs=1e-9)


def test_the_look_ahead_is_never_much_worse_than_a_simple_rule() -> None:
    cell = replace(CELLS["upstream nest"]).at_speed(0.1)
    parts = stream(cell, 1.3, 120.0, 5)
    done = {rule: run(tables(cell), parts, rule, 120.0).each_minute(120.0) for rule in RULES}
    # in lasting overload the rule that counts parts only loses here: the price of time is what helps
    assert done["look-ahead"] >= max(done.values()) - 0.5
    assert done["fifo"] < done["spt"]
    free = run(tables(cell), parts, "look-ahead", 120.0, price=1e-9).each_minute(120.0)
    assert free < done["look-ahead"]
