"""A plan is left for another one at an instant: the same state, and what is held, lies and is known is that of then."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np
import pytest

import assur
from assur.api.python.answer import Answer
from assur.planner.errors import InputError
from assur.scenes.tasks.next_task import end_state, next_fields, state_at
from tests.scenes.tasks.test_next_task import CELL, TASK, fields, read

Document = dict[str, Any]
STAY_S = 2.0
SHARES = (0.0, 0.35, 0.8)


@cache
def planned(**options: Any) -> Answer:
    """The answer to the task of two parts, of which `a` goes into the first slot."""
    task = fields(read(TASK))
    task["options"] = {**task["options"], "stay_safe_s": STAY_S, **options}
    answer = assur.Cell(read(CELL)).plan(**task)
    assert answer.planned, answer.sentence
    return answer


def left(answer: Answer, at_s: float | None) -> Any:
    return state_at(answer.request or {}, answer.document, at_s)


def on_the_way(answer: Answer) -> list[float]:
    """Instants on each way between control points, the first of each among them, and standing at the end."""
    ways = [leg for leg in answer.legs if leg["kind"] == "MOVE"]
    assert len(ways) == 3
    found = [leg["from_s"] + share * (leg["to_s"] - leg["from_s"]) for leg in ways for share in SHARES]
    return [*found, ways[-1]["to_s"], ways[-1]["to_s"] + STAY_S]


@pytest.mark.parametrize("number", range(3 * len(SHARES) + 2))
def test_a_plan_goes_on_from_each_way_in_the_same_state(number: int) -> None:
    before = planned()
    at_s = on_the_way(before)[number]
    state = left(before, at_s)
    place = {"place": {"part": "a", "to": {"slot": {"box": 2}}}}
    steps = [place if state.held == "a" else {"transfer": {"parts": ["b"], "to": "box"}}, {"move": {"to": "home"}}]
    task = fields(read(TASK))
    cell = assur.Cell(read(CELL))
    after = cell.plan(**next_fields(cell.document, {"steps": steps, "parts": []}, state, task))
    assert after.planned, after.sentence
    assert assur.check(after.request or {}, after)["ok"]
    assert after["trajectory"]["time_s"][0] == at_s
    one, other = before.trajectory.at(min(at_s, before.trajectory.end_s)), after.trajectory.at(at_s)
    for name, most in (("positions", 1e-12), ("velocities", 1e-10), ("accelerations", 1e-8)):
        assert np.abs(getattr(one, name) - getattr(other, name)).max() <= most


def test_the_state_at_the_last_instant_is_that_of_the_end() -> None:
    answer = planned()
    there, end = left(answer, answer["trajectory"]["time_s"][-1]), end_state(answer.request or {}, answer.document)
    for name in ("start", "uncertainty", "handled", "gone", "places", "held"):
        assert getattr(there, name) == getattr(end, name)


def test_what_is_held_and_where_parts_lie_is_that_of_the_instant() -> None:
    answer = planned()
    to_part, with_part, home = (on_the_way(answer)[i] for i in (1, 4, 7))
    before, held, placed = (left(answer, at_s) for at_s in (to_part, with_part, home))
    assert (before.held, held.held, placed.held) == (None, "a", None)
    assert (before.handled, held.handled, placed.handled) == (set(), {"a"}, {"a"})
    assert before.places["a"] == held.places["a"]
    assert placed.places["a"] == left(answer, None).places["a"] != before.places["a"]
    assert "holding" not in before.start
    assert "holding" not in placed.start
    assert held.start["holding"]["part"] == "a"


def test_what_lies_on_a_belt_whose_speed_is_uncertain_is_known_less_well_by_the_time_that_has_gone() -> None:
    answer = planned()
    for at_s in on_the_way(answer):
        state = left(answer, at_s)
        assert state.start["at_s"] == at_s
        grown = state.uncertainty["b"]["position_m"] if at_s > answer.start_s else 0.0
        assert grown == pytest.approx(0.002 * (at_s - answer.start_s), abs=1e-15)
    early, late = (left(answer, on_the_way(answer)[i]).uncertainty["a"] for i in (7, 10))
    assert early == late == left(answer, None).uncertainty["a"]  # put down at rest: no time makes it worse


def test_while_the_tool_tracks_a_point_a_plan_is_not_left_up_to_the_last_instant() -> None:
    answer = planned()
    for step in (0, 1):
        legs = [leg for leg in answer.legs if leg["step"] == step and leg["kind"] != "MOVE"]
        first, last = legs[0]["from_s"], legs[-1]["to_s"]
        for at_s in (first, math.nextafter(last, 0.0), *(leg["from_s"] for leg in legs)):
            with pytest.raises(InputError, match=f"before {first:.6g} s, or {last:.6g} s or later"):
                left(answer, at_s)
        left(answer, math.nextafter(first, 0.0))
        left(answer, last)


def test_no_time_of_the_plan_is_refused() -> None:
    answer = planned()
    end_s = answer["trajectory"]["time_s"][-1]
    for at_s in (math.nextafter(answer.start_s, -1.0), math.nan, math.inf, -math.inf, end_s + STAY_S + 1e-9):
        with pytest.raises(InputError) as refused:
            left(answer, at_s)
        assert refused.value.field == "at_s"


def test_where_the_robot_may_not_stand_or_may_be_elsewhere_a_plan_is_not_left() -> None:
    cell = read(CELL)
    moving, corrected = planned(end="moving"), assur.Cell({**cell, "execution": {"belt_correction": True}})
    with pytest.raises(InputError, match="until when standing is proved"):
        left(moving, moving["trajectory"]["time_s"][-1] + 1e-6)
    answer = corrected.plan(**fields(read(TASK)))
    for at_s in on_the_way(answer)[:6]:  # to the belt, and from it
        with pytest.raises(InputError, match="belt_correction"):
            left(answer, at_s)
    for at_s in on_the_way(answer)[6:-1]:
        left(answer, at_s)


def test_a_robot_that_is_late_has_put_its_part_down_before_the_plan_is_left() -> None:
    late_s = 0.04
    cell = {**read(CELL), "execution": {"start_tolerance_s": late_s}}
    cell["slots"]["box"]["depart"] = {"mm": 2}
    answer = assur.Cell(cell).plan(**fields(read(TASK)))
    assert answer.planned, answer.sentence
    last = answer.legs[-1]["from_s"]
    free_s = answer.arrivals[1]["until_s"] + late_s
    assert last < free_s
    with pytest.raises(InputError, match="a robot that is late"):
        left(answer, last)
    left(answer, free_s)


def test_where_nothing_moves_standing_is_proved_for_ever() -> None:
    cell = read(CELL)
    cell["bodies"].pop()  # the mark on the lane, which the belt moves
    task = {"start": fields(read(TASK))["start"], "steps": [{"move": {"to": "home"}}]}
    answer = assur.Cell(cell).plan(**task)
    assert answer.planned, answer.sentence
    left(answer, 1e5)
    on_belt = [{"name": "b", "kind": "bracket", "pose": {"frame": "belt", "at_mm": [-700, 0, 10]}}]
    answer = assur.Cell(cell).plan(**task, parts=on_belt)
    with pytest.raises(InputError, match="until when standing is proved"):
        left(answer, answer["trajectory"]["time_s"][-1] + 1e-6)


def test_on_the_way_of_a_plan_with_blends_the_acceleration_may_jump() -> None:
    cell = read(CELL)
    options = {"timing": "parabolic_blend", "stop": "first", "budget_s": 20}
    answer = assur.Cell(cell).plan(start=fields(read(TASK))["start"], steps=[{"move": {"to": "home"}}], options=options)
    assert answer.planned, answer.sentence
    end_s = answer["trajectory"]["time_s"][-1]
    with pytest.raises(InputError, match="acceleration may jump"):
        left(answer, 0.5 * end_s)
    left(answer, end_s)
