"""A cell that runs: motions follow each other while the arm moves, each proved, and what is not right is refused."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import assur
from assur.planner import pipeline
from assur.planner.collision.rows import written
from assur.planner.errors import FaultError, InputError
from assur.planner.model.outcome import Plan
from assur.planner.report import margins
from assur.planner.trajectory import Trajectory
from assur.scenes import written_knots
from assur.scenes.reading.cell import Cell
from assur.scenes.reading.plan import motion_of
from assur.scenes.requests import cell_of, scene_of
from assur.scenes.session.committed import MOST_JUMPS
from assur.scenes.tasks.next_task import state_of
from assur.scenes.written_knots import with_rounded_knots
from tests.scenes.robots_of_every_family import ROBOTS
from tests.scenes.tasks.test_next_task import CELL, read

Document = dict[str, Any]
STAY_S, PLANNING_S = 2.0, 0.02
START = {"joints": {"j1_deg": 20, "j2_deg": 60, "j3_mm": 300, "j4_deg": 0}}
PARTS = {"a": -300, "b": -600, "c": -900}
OPTIONS = {"seed": 1, "stop": "first", "max_candidates": 200, "budget_s": 60, "stay_safe_s": STAY_S}


def cell(**changes: Any) -> Document:
    return {**read(CELL), "options": OPTIONS, **changes}


@cache
def kept() -> assur.Cell:
    return assur.Cell(cell())


def transfer(part: str, **more: Any) -> Document:
    return {"transfer": {"parts": [part], "to": "box", **more}}


def running(**parts: float) -> assur.Session:
    """A session in which the parts, at these places along the belt at time 0, are seen."""
    session = assur.Session(kept(), start=START, refuge="home", planning_ms=1e3 * PLANNING_S)
    for name, along_mm in parts.items():
        session.see(name, kind="bracket", pose=at(along_mm))
    return session


def at(along_mm: float, at_s: float = 0.0) -> Document:
    """A pose on the belt, where it is written, at a time."""
    return {"frame": "belt", "at_mm": [along_mm, 0, 10], "at_s": at_s}


def commit(session: assur.Session, *steps: Document, at_s: float | None = None) -> assur.Proposal:
    """The proposal of these steps, which is committed."""
    made = session.propose(list(steps), at_s=at_s)
    assert made.planned, made.answer.sentence
    session.commit(made)
    return made


def place_of(made: assur.Proposal, part: str) -> Document:
    """Where a part is, as the task of a proposal has it."""
    task = made.answer._of[1]  # type: ignore[index]
    return next(each for each in task["parts"] if each["name"] == part)


def test_motions_follow_each_other_while_the_arm_moves_and_all_of_it_is_proved() -> None:
    session = running(**PARTS)
    every = [session.committed[0]]
    for part in PARTS:
        if part == "c":
            session.gone("a")  # somebody took it out of its slot
        commit(session, transfer(part))
        every[-1] = session.committed[-2]
        every.append(session.committed[-1])
        session.advance(every[-1].starts_s + 0.5 * (every[-1].answer["arrivals"][1]["time_s"] - every[-1].starts_s))
        if part == "b":
            session.advance(every[-1].answer["arrivals"][1]["until_s"] + 0.01)
    assert [each.starts_s for each in every] == [0.0, *[each.until_s for each in every[:-1]]]
    assert [each for each in every if not assur.check(each.answer.request or {}, each.answer)["ok"]] == []
    for one, other in pairwise(every):
        assert one.until_s < one.answer.trajectory.end_s  # it is left before it is over
        left, begun = one.answer.trajectory.at(one.until_s), other.answer.trajectory.at(other.starts_s)
        for name, most in zip(("positions", "velocities", "accelerations"), MOST_JUMPS, strict=True):
            assert np.abs(getattr(left, name) - getattr(begun, name)).max() <= most
    assert max(np.abs(each.answer.trajectory.at(each.starts_s).velocities).max() for each in every[1:]) > 0.1


def test_the_whole_motion_keeps_the_limits_and_ends_at_rest_in_the_refuge() -> None:
    session = running(**PARTS)
    every = [session.committed[0]]
    for part in ("a", "b"):
        commit(session, transfer(part))
        every[-1:] = session.committed[-2:]
    limits = scene_of(every[0].answer.request).robot.limits
    for each in every:
        motion = each.answer.trajectory
        states = motion.at(np.linspace(each.starts_s, min(each.until_s, motion.end_s), 500))
        assert (np.abs(states.velocities) <= limits.velocity * (1 + 1e-9)).all()
        assert (np.abs(states.accelerations) <= limits.acceleration * (1 + 1e-9)).all()
    last = every[-1].answer
    assert last.arrivals[-1]["at_m"] == pytest.approx([0.35, 0.0, 0.18], abs=1e-6)
    assert not last.trajectory.at(last.trajectory.end_s).velocities.any()
    assert session.proved_until_s == last.trajectory.end_s + STAY_S == every[-1].until_s


def test_many_motions_leave_no_second_uncovered_and_nothing_is_kept_of_parts_that_are_gone() -> None:
    session, before = running(), None
    chance = np.random.default_rng(3)
    for number in range(12):
        part = f"p{number}"
        session.see(part, kind="bracket", pose=at(chance.uniform(-210, -110), session.clock_s))
        made = session.propose([transfer(part, gone_after_ms=400)])
        if not made.planned:
            session.gone(part)
            made = session.propose([])
        session.commit(made)
        assert assur.check(made.answer.request or {}, made.answer)["ok"]
        if before is not None:
            assert before.starts_s <= made.starts_s <= before.answer.trajectory.end_s + STAY_S
            left = before.answer.trajectory.at(min(made.starts_s, before.answer.trajectory.end_s))
            begun = made.answer.trajectory.at(made.starts_s)
            for name, most in zip(("positions", "velocities", "accelerations"), MOST_JUMPS, strict=True):
                assert np.abs(getattr(left, name) - getattr(begun, name)).max() <= most
        session.advance(max(session.clock_s, (made.base_ends_s or 0.0) - (PLANNING_S if number % 3 else -0.05)))
        before = made
        kept = session._running.committed.segments
        assert len(session.parts) <= 2
        assert len(kept[-1].before.handled) <= 2
        assert [each.until_s for each in kept[:-1]] == [each.starts_s for each in kept[1:]]
        assert min(each.until_s for each in kept) > session.clock_s - 10.0


def test_a_part_that_the_motion_carries_is_in_the_gripper_of_the_next_one() -> None:
    session = running(a=-300)
    commit(session, {"pick": {"part": "a"}})
    session.advance(session.committed[-1].answer.arrivals[0]["until_s"])
    after = commit(session, {"place": {"part": "a", "to": {"slot": {"box": 2}}}})
    request = after.answer.request or {}
    assert request["start"]["holding"]["part"] == "a"
    assert max(map(abs, request["start"]["velocity"].values())) > 0.01
    assert assur.check(request, after.answer)["ok"]
    with pytest.raises(InputError, match="the gripper does not hold"):
        session.see("a", pose=at(-300))
    with pytest.raises(InputError, match="no step of the committed motion handles"):
        session.gone("a")


def test_slots_are_filled_as_the_committed_motion_fills_them() -> None:
    session = running(**PARTS)
    commit(session, transfer("a"))
    second = commit(session, transfer("b"))
    assert place_of(second, "a")["slot"] == {"box": 1}
    with pytest.raises(InputError, match="all 2 are taken, by a, b") as refused:
        session.propose([transfer("c")])
    assert refused.value.field == "steps[0].transfer.to"


def test_a_part_that_is_taken_away_leaves_its_slot_also_in_motions_after_the_next_one() -> None:
    session = running(**PARTS)
    commit(session, transfer("a", gone_after_ms=500))
    put_s = session.committed[-1].answer.arrivals[1]["until_s"]
    second = commit(session, transfer("b"))
    assert second.starts_s < put_s + 0.5
    assert place_of(second, "a")["slot"] == {"box": 1}
    third = commit(session, transfer("c"))
    assert third.starts_s > put_s + 0.5
    assert {each["name"] for each in third.answer._of[1]["parts"]} == {"b", "c"}  # type: ignore[index]
    session.advance(put_s + 0.4)
    assert list(session.parts) == ["a", "b", "c"]
    session.advance(put_s + 0.5)
    assert list(session.parts) == ["b", "c"]


def test_a_later_sighting_counts_unless_the_motion_has_moved_the_part_since() -> None:
    session = running(**PARTS)
    commit(session, transfer("a"))
    session.advance(0.1)
    for name, along_mm in PARTS.items():
        session.see(name, pose=at(along_mm + 15.5, 0.05), uncertainty={"position_mm": 0.5})
    made = commit(session, transfer("b"))
    assert place_of(made, "a")["slot"] == {"box": 1}
    for name in ("b", "c"):
        assert place_of(made, name)["pose"] == at(PARTS[name] + 15.5, 0.05)
        assert place_of(made, name)["uncertainty"] == {"position_mm": 0.5}
    session.advance(made.starts_s)
    table = {"at_mm": [300, -120, 60]}
    session.see("a", pose=table)  # somebody took it out of its slot
    session.see("b", pose=at(-500, 0.06))
    refused(lambda: session.see("b", pose=at(-500, 0.05)), "pose.at_s", "0.06 s or later, when the part was seen last")
    made = session.propose([])
    assert place_of(made, "a")["pose"] == table
    assert place_of(made, "b")["slot"] == {"box": 2}


def test_a_picture_from_before_a_part_was_moved_does_not_count_when_it_comes_late() -> None:
    session = running(**PARTS)
    made = commit(session, transfer("a"))
    picked_s, put_s = (each["until_s"] for each in made.answer.arrivals[:2])
    session.advance(put_s + 0.05)
    session.see("a", pose=at(PARTS["a"] + 150 * (picked_s - 0.1), picked_s - 0.1))
    assert place_of(session.propose([transfer("b")]), "a")["slot"] == {"box": 1}
    session.see("a", pose={"frame": "belt", "at_mm": [-200, 0, 10], "at_s": put_s + 0.01})
    assert place_of(session.propose([transfer("b")]), "a")["pose"]["frame"] == "belt"


def test_a_proposal_begins_where_the_base_ends_if_that_is_ahead_and_else_after_planning() -> None:
    session = running(**PARTS)
    first = commit(session, transfer("a"))
    base_s = first.base_ends_s or 0.0
    assert first.starts_s == first.decide_by_s == PLANNING_S
    assert base_s == first.answer.legs[-1]["from_s"]
    assert session.propose([transfer("b")]).starts_s == base_s
    session.advance(base_s - PLANNING_S / 2)
    assert session.propose([transfer("b")]).starts_s == base_s + PLANNING_S / 2
    end_s = first.answer.trajectory.end_s
    session.advance(end_s + 1.0)
    at_rest = commit(session, transfer("b"))
    assert at_rest.starts_s == end_s + 1.0 + PLANNING_S
    assert "velocity" not in (at_rest.answer.request or {})["start"]


def test_the_same_calls_give_the_same_motions() -> None:
    def run() -> str:
        session = running(**PARTS)
        motions = [commit(session, transfer(part)) for part in ("a", "b")]
        return json.dumps([[each.answer["trajectory"], each.answer.request, each.starts_s] for each in motions])

    assert run() == run()


# ---- refusals ------------------------------------------------------------------------------------------------------


def refused(call: Callable[[], object], field: str, words: str) -> None:
    with pytest.raises(InputError) as error:
        call()
    assert error.value.field == field
    assert words in error.value.allowed


def test_a_proposal_is_committed_once_and_up_to_its_time() -> None:
    session = running(**PARTS)
    first, other = (session.propose([transfer(part)], at_s=0.1) for part in ("a", "b"))
    session.advance(first.decide_by_s)
    session.commit(first.id)
    refused(lambda: session.commit(first), "id", "committed once")
    refused(lambda: session.commit(other), "id", "another one was committed since")
    late = session.propose([transfer("b")])
    session.advance(math.nextafter(late.decide_by_s, math.inf))
    refused(lambda: session.commit(late), "id", "late, so propose again")


@pytest.mark.parametrize("number", [0, -1, 7, True, 1.0, "1", None])
def test_what_is_no_id_of_a_proposal_is_refused(number: Any) -> None:
    session = running(a=-300)
    session.propose([])
    refused(lambda: session.commit(number), "id", "the id of a proposal of this session")


def test_a_proposal_without_a_plan_states_why_and_is_not_committed() -> None:
    session = running(a=-300)
    made = session.propose([{"move": {"to": {"at_mm": [2000, 0, 150]}}}])
    assert (made.planned, made.base_ends_s) == (False, None)
    refused(lambda: session.commit(made), "id", made.answer.sentence)
    assert session.committed[-1].starts_s == 0.0


def test_a_motion_is_not_left_while_the_tool_tracks_a_point_or_before_planning_is_over() -> None:
    session = running(a=-300)
    made = commit(session, transfer("a"))
    grip_s = made.answer.arrivals[0]["until_s"]
    refused(lambda: session.propose([], at_s=grip_s), "at_s", "in between the tool tracks pick-a")
    refused(lambda: session.propose([], at_s=0.9 * PLANNING_S), "at_s", "when planning is over (20 ms)")
    refused(lambda: session.propose([], at_s=session.proved_until_s + 1e-6), "at_s", "until when standing is proved")
    for wrong in (math.nan, math.inf, "1", True, [1]):
        refused(lambda wrong=wrong: session.propose([], at_s=wrong), "at_s", "a finite number")  # type: ignore[misc]


def test_no_second_is_without_a_proof() -> None:
    session = running(a=-300)
    until_s = session.proved_until_s
    refused(lambda: session.advance(until_s + 1e-9), "to_s", "propose and commit the next motion before")
    session.advance(until_s)
    refused(lambda: session.propose([]), "at_s", "until when standing is proved")
    refused(lambda: session.advance(until_s - 1e-3), "to_s", f"{session.clock_s:.6g} to 100000")
    refused(lambda: session.advance(1e9), "to_s", "to 100000")
    refused(lambda: session.propose([], at_s=1e9), "at_s", "to 100000")
    refused(lambda: session.advance(math.nan), "to_s", "a finite number")


@pytest.mark.parametrize(
    ("name", "fields", "field"),
    [
        ("d", {"kind": "brcket", "pose": at(0)}, "kind"),
        ("d", {"pose": at(0)}, "part"),
        ("d", {"kind": "bracket", "pose": at(0), "slot": {"box": 1}}, "slot"),
        ("d", {"kind": "bracket"}, "pose"),
        ("d", {"kind": "bracket", "pose": {"frame": "bel"}}, "pose.frame"),
        ("d", {"kind": "bracket", "pose": {"frame": "belt"}}, "pose.at_s"),
        ("d", {"kind": "bracket", "pose": at(0, 1.0)}, "pose.at_s"),
        ("d", {"kind": "bracket", "pose": at(math.nan)}, "pose.at_mm[0]"),
        ("d", {"kind": "bracket", "slot": {"box": 3}}, "slot.box"),
        ("d", {"kind": "bracket", "pose": at(0), "colour": "red"}, "colour"),
        ("table", {"kind": "bracket", "pose": at(0)}, "name"),
        ("", {"kind": "bracket", "pose": at(0)}, "name"),
        (7, {"kind": "bracket", "pose": at(0)}, "name"),
    ],
)
def test_a_part_that_is_not_right_is_refused_when_it_is_seen(name: Any, fields: Document, field: str) -> None:
    session = running(a=-300)
    with pytest.raises(InputError) as error:
        session.see(name, **fields)
    assert error.value.field == field
    assert session.parts == ("a",)


def test_a_part_that_the_motion_will_handle_stays() -> None:
    session = running(**PARTS)
    commit(session, transfer("a"))
    refused(lambda: session.gone("a"), "name", "no step of the committed motion handles: pick-a does")
    refused(lambda: session.gone("x"), "name", "a part that is known")
    session.gone("b")
    assert session.parts == ("a", "c")
    refused(lambda: session.propose([transfer("b")]), "steps[0].transfer.parts[0]", "")


def test_a_proposal_for_a_part_that_is_gone_is_not_committed() -> None:
    session = running(**PARTS)
    first, other = session.propose([transfer("a")]), session.propose([transfer("b")])
    session.gone("a")
    refused(lambda: session.commit(first), "id", "a is gone")
    session.commit(other)


def test_a_part_does_not_become_another_one() -> None:
    session = running(a=-300)
    ball = {"sphere": {"radius_mm": 20}}
    refused(lambda: session.see("a", shape=ball, pose=at(-300)), "shape", "call gone('a') before")
    refused(lambda: session.see("a", kind="other", pose=at(-300)), "kind", "call gone('a') before")
    session.see("a", kind="bracket", pose=at(-310))
    session.gone("a")
    session.see("a", shape=ball, pose=at(-300))


def test_a_refuge_that_is_not_safe_is_refused_with_numbers() -> None:
    box = {"name": "box-on-home", "shape": {"box": {"size_mm": [60, 60, 400]}}, "pose": {"at_mm": [350, 0, 100]}}
    blocked = cell(bodies=[*read(CELL)["bodies"], box])
    tool = {"tcp_mm": [0, 0, -100], "bodies": [{"name": "cup", "shape": {"sphere": {"radius_mm": 20}}}]}
    blocked["robot"] = {**blocked["robot"], "tool": tool}
    with pytest.raises(InputError, match="box-on-home") as error:
        assur.Session(blocked, start=START, refuge="home")
    assert error.value.field == "refuge"
    refused(lambda: assur.Session(cell(), start=START, refuge="hom"), "refuge", "did you mean home?")
    far = cell(positions={"home": {"at_mm": [2000, 0, 180]}})
    with pytest.raises(InputError, match="mm"):
        assur.Session(far, start=START, refuge="home")


def test_a_session_that_is_not_right_is_refused() -> None:
    request = kept().request(start=START, steps=[{"move": {"to": "home"}}])
    refused(lambda: assur.Session(request, start=START, refuge="home"), "cell", "a cell file")
    for wrong in (-1, math.nan, 1e9, "20", True):
        with pytest.raises(InputError) as error:
            assur.Session(kept(), start=START, refuge="home", planning_ms=wrong)  # type: ignore[arg-type]
        assert error.value.field == "planning_ms"
    moving = cell(options={**OPTIONS, "end": "moving"})
    refused(lambda: assur.Session(moving, start=START, refuge="home"), "options.end", "rest")
    with pytest.raises(InputError) as error:
        assur.Session(kept(), start={"joints": {"j1_deg": 20}}, refuge="home")
    assert error.value.field.startswith("start.joints")


def test_a_motion_that_would_jump_is_a_fault() -> None:
    session = running(a=-300)
    session.propose([transfer("a")])
    made = session._running._open[1].segment
    assert made is not None
    committed = session._running.committed
    for shift_s in (1e-3, 0.1):
        late = replace(made, starts_s=made.starts_s + shift_s, motion=committed.last.motion)
        committed.follow(replace(late, starts_s=late.starts_s))  # the same motion does not jump
        with pytest.raises(FaultError, match="of a joint jumps by"):
            committed.follow(replace(made, starts_s=made.starts_s + shift_s))


def test_a_session_keeps_the_plan_that_its_answer_is_read_as() -> None:
    session = running(a=-300)
    made = commit(session, transfer("a"))
    for each in session._running.committed.segments:
        motion, legs, arrivals = motion_of(each.judged.answer, cell_of(each.judged.request).conventions)
        assert np.array_equal(motion.knots, each.motion.knots)
        assert (legs, arrivals) == (each.legs, each.arrivals)
        for at_s in (None, made.starts_s):
            of_plan = each.motion, each.legs, each.arrivals, each.of_legs, at_s
            kept = vars(state_of(each.cell, *of_plan))
            assert kept == {**vars(state_of(cell_of(each.judged.request), *of_plan)), "cell": each.cell}
        start, written = state_of(each.cell, *of_plan[:4], None).start, each.judged.answer["trajectory"]
        assert [*start["joints"].values()] == written["position"][-1]
        assert start["at_s"] == written["time_s"][-1]


def test_where_joints_have_zeros_a_session_judges_and_executes_the_knots_of_its_answer() -> None:
    robot = {**ROBOTS["scara whose lift is last, with zeros"], "tool": {"tcp_mm": [0, 0, -30]}}
    home, options = {"home": {"at_mm": [250, 100, 90]}}, {**OPTIONS, "stay_safe_s": 0}
    turned = {"schema": "assur-cell/1", "robot": robot, "positions": home, "options": options}
    start = {"tool": {"at_mm": [200, 200, 100], "yaw_deg": 0}, "elbow": "left"}
    session = assur.Session(turned, start=start, refuge="home")
    made = commit(session, {"move": {"to": {"at_mm": [330, -60, 120]}}})
    assert made.check()["ok"]
    assert made._judged.cell.conventions.zeros.any()
    for each in session._running.committed.segments:
        motion, _, _ = motion_of(each.judged.answer, each.cell.conventions)
        assert np.array_equal(motion.knots, each.motion.knots)


def test_the_answer_of_a_proposal_is_that_of_plan_and_its_verdict_that_of_check() -> None:
    session = running(**PARTS)
    for steps in ([transfer("a")], [transfer("b")], [{"move": {"to": {"at_mm": [2000, 0, 100]}}}]):
        made = session.propose(steps)
        request = made.answer.request or {}
        assert timeless(made.answer) == timeless(assur.plan(request))
        assert made.check() == assur.check(request, made.answer)
        assert made.check()["ok"] is True
        if made.planned:
            session.commit(made)


def timeless(answer: assur.Answer) -> Document:
    return {key: value for key, value in answer.items() if key not in ("elapsed_s", "first_s")}


@pytest.mark.parametrize("faults", [1, 2, 100])
def test_what_the_checker_refuses_is_searched_again_and_never_committed(
    faults: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    session, calls = running(a=-300), [0]

    def without_rows(*given: Any) -> Any:
        """A certificate without the rows of the first phase, so often."""
        calls[0] += 1
        *plan, (first, *others) = given
        first = replace(first, table=first.table[:0]) if calls[0] <= faults else first
        return written(plan[0], plan[1], plan[2], plan[3], [first, *others])

    monkeypatch.setattr("assur.planner.search.census.written", without_rows)
    made = session.propose([transfer("a")])
    assert calls[0] >= 2
    assert made.check()["ok"]
    assert made.planned is (faults < 100)
    if not made.planned:
        assert "checker" in made.answer.sentence
        with pytest.raises(InputError, match="a proposal with a plan"):
            session.commit(made)


def test_a_proposal_whose_plan_the_checker_refuses_is_not_committed(monkeypatch: pytest.MonkeyPatch) -> None:
    session = running(a=-300)

    def moved(of: Cell, plan: Plan) -> Plan:
        """A plan with a knot that is elsewhere."""
        plan, knots = with_rounded_knots(of, plan), plan.trajectory
        q = knots.q + 0.01 * (np.arange(len(knots.q)) == 3)[:, None]
        return replace(plan, trajectory=Trajectory(knots.time, q, knots.qd, knots.qdd, jumps=knots.jumps))

    monkeypatch.setattr(written_knots, "with_rounded_knots", moved)
    made = session.propose([transfer("a")])
    assert made.planned
    assert not made.check()["ok"]
    refused(lambda: session.commit(made), "id", "the checker refuses it")
    with pytest.raises(InputError, match="the checker refuses it"):
        running()


def test_what_an_answer_states_in_addition_to_its_plan_is_checked_when_it_is_required(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    session, nearest = running(a=-300), margins.reported

    def farther(*given: Any) -> Any:
        """A smallest clearance that is not so."""
        found = nearest(*given)
        assert found is not None
        assert found.nearest is not None
        return replace(found, nearest=replace(found.nearest, gap_m=1.0))

    monkeypatch.setattr(pipeline, "reported", farther)
    made = session.propose([transfer("a")])
    assert {each["code"] for each in made.check()["findings"]} == {"NEAREST"}
    session.commit(made)  # its plan is right


def test_where_nothing_moves_standing_is_proved_for_ever() -> None:
    still = cell(bodies=read(CELL)["bodies"][:1])
    session = assur.Session(still, start=START, refuge="home")
    assert session.proved_until_s == math.inf
    session.advance(50_000.0)
    assert session.propose([{"move": {"to": {"at_mm": [300, 200, 150]}}}]).planned


# ---- readings ------------------------------------------------------------------------------------------------------

LAG = {"j1_deg": 0.02, "j2_deg": 0.03, "j3_mm": 0.05, "j4_deg": 0.04}
LATE_S = 0.004


@cache
def sloppy() -> assur.Cell:
    """A cell whose joints lag, whose robot may be late, and whose parts may be off."""
    kinds = {"bracket": {**read(CELL)["kinds"]["bracket"], "uncertainty": {"position_mm": 0.4, "yaw_deg": 1}}}
    return assur.Cell(cell(kinds=kinds, execution={"lag": LAG, "start_tolerance_ms": 1e3 * LATE_S}))


def moving_on(file: assur.Cell) -> tuple[assur.Session, assur.Proposal]:
    """A session on its way to part `a`; `b` is known as well, `c` is seen afterwards."""
    session = assur.Session(file, start=START, refuge="home")
    for name in ("a", "b"):
        session.see(name, kind="bracket", pose=at(PARTS[name]))
    made = commit(session, {"pick": {"part": "a", "contact_tolerance_mm": 1}})
    session.see("c", kind="bracket", pose=at(PARTS["c"]))
    session.advance(made.starts_s + 0.15)
    return session, made


def joints(answer: assur.Answer, at_s: float, off: Any = (0.0,) * 4) -> Document:
    motion = answer.trajectory
    values = motion.at(at_s).positions[0] + off
    keys = [f"{name}_{unit}" for name, unit in zip(motion.joint_names, motion.joint_units, strict=True)]
    return dict(zip(keys, values.tolist(), strict=True))


@pytest.mark.parametrize("joint", range(4))
@pytest.mark.parametrize("sign", [-1, 1])
def test_a_joint_may_be_off_by_its_lag_and_no_more(joint: int, sign: int) -> None:
    session = assur.Session(sloppy(), start=START, refuge="home")
    (plan,) = session.committed
    end_s = plan.answer.trajectory.end_s
    session.advance(end_s + 1.0)  # at rest, where to be late changes nothing
    lag = [math.radians(0.02), math.radians(0.03), 0.05e-3, math.radians(0.04)][joint]
    off = np.zeros(4)
    off[joint] = sign * lag
    found = session.holds({"joints": joints(plan.answer, end_s, 0.999 * off)})
    assert (found.holds, found.until_s, found.off_mm, found.reason) == (True, session.proved_until_s, 0.0, "")
    found = session.holds({"joints": joints(plan.answer, end_s, 1.01 * off)})
    assert (found.holds, found.until_s) == (False, None)
    assert f"j{joint + 1} at" in found.reason
    if joint == 2:
        assert found.off_mm == pytest.approx(0.05 * 0.01, rel=1e-6)


def test_a_robot_may_be_late_by_its_tolerance_with_all_of_its_joints() -> None:
    session, made = moving_on(sloppy())
    now_s = session.clock_s
    assert session.holds({"joints": joints(made.answer, now_s), "at_s": now_s}).holds
    assert session.holds({"joints": joints(made.answer, now_s - LATE_S)}).holds
    assert session.holds({"joints": joints(made.answer, now_s - 0.37 * LATE_S)}).holds
    early, late = joints(made.answer, now_s + LATE_S), joints(made.answer, now_s - 2 * LATE_S)
    mixed = {**joints(made.answer, now_s), "j1_rad": joints(made.answer, now_s - LATE_S)["j1_rad"]}
    for wrong in (early, late, mixed):
        found = session.holds({"joints": wrong})
        assert not found.holds
        assert found.off_mm is not None
        assert found.off_mm > 0.05


def test_without_a_lag_a_robot_is_where_its_motion_is() -> None:
    session, made = moving_on(kept())
    for at_s in np.linspace(made.starts_s, session.clock_s, 7).tolist():
        assert session.holds({"joints": joints(made.answer, at_s), "at_s": at_s}).holds
        found = session.holds({"joints": joints(made.answer, at_s, (0.0, 0.0, 1e-6, 0.0)), "at_s": at_s})
        assert not found.holds
        assert found.off_mm == pytest.approx(1e-3, rel=1e-6)


def seen(session: assur.Session, part: str, along_mm: float, across_mm: float = 0.0, up_mm: float = 0.0) -> Document:
    """A part now, so much off its nominal pose along the belt, across it and upwards."""
    now_s = session.clock_s
    return {
        "part": part,
        "pose": {
            "frame": "belt",
            "at_mm": [PARTS[part] + 150 * now_s + along_mm, across_mm, 10 + up_mm],
            "at_s": now_s,
        },
    }


def test_a_part_may_be_off_by_its_uncertainty_and_that_of_its_belt_and_no_more() -> None:
    session, made = moving_on(sloppy())
    own_mm = 0.4 + 2.0 * made.starts_s  # since it was seen, at 0 s
    belt_mm = 2.0 * (session.clock_s - made.starts_s)
    for along, across, most in ((1, 0, own_mm + belt_mm), (-1, 0, own_mm + belt_mm), (0, 1, own_mm), (0, -1, own_mm)):
        inside, outside = ((share * most * along, share * most * across) for share in (0.999, 1.01))
        found = session.holds(seen(session, "b", *inside))
        assert (found.holds, found.until_s, found.off_mm) == (True, session.proved_until_s, 0.0)
        found = session.holds(seen(session, "b", *outside))
        assert (found.holds, found.until_s) == (False, None)
        assert found.off_mm == pytest.approx(0.01 * most, rel=1e-6)
    assert not session.holds(seen(session, "b", 0.9 * (own_mm + belt_mm), 0.9 * own_mm)).holds
    assert session.holds(seen(session, "b", 0.0, 0.0, 1.0)).off_mm == pytest.approx(1.0, rel=1e-9)
    for yaw_deg, holds in ((0.99, True), (-0.99, True), (1.01, False), (-1.01, False), (360.0, True)):
        reading = seen(session, "b", 0.0)
        reading["pose"]["yaw_deg"] = yaw_deg
        assert session.holds(reading).holds == holds
    picked_s = made.answer.arrivals[0]["until_s"]
    assert session.holds(seen(session, "a", 0.0)).until_s == picked_s


def test_a_belt_may_be_off_by_its_uncertainty_and_its_speed_states_until_when() -> None:
    session, made = moving_on(kept())
    now_s, until_s = session.clock_s, session.proved_until_s
    nominal, most = 150 * now_s, 2.0 * (now_s - made.starts_s)

    def holds(off_mm: float, **more: Any) -> Any:
        return session.holds({"frame": "belt", "along_mm": nominal + off_mm, **more})

    for sign in (1, -1):
        found = holds(0.999 * sign * most)
        assert (found.holds, found.until_s, found.off_mm) == (True, until_s, 0.0)
        found = holds(1.01 * sign * most)
        assert (found.holds, found.until_s) == (False, None)
        assert found.off_mm == pytest.approx(0.01 * most, rel=1e-6)
        for inside in (0.0, 1.999 * sign, -1.999 * sign):
            assert holds(0.9 * sign * most, speed_mm_s=150 + inside).until_s == until_s
        # 5 mm/s more than the nominal speed, of which 2 mm/s are allowed, use up what is left at 3 mm/s
        for off in (0.5, 0.0, -0.5):
            found = holds(off * sign * most, speed_mm_s=150 + 5 * sign)
            assert found.holds
            assert found.until_s == pytest.approx(now_s + (1 - off) * most / 3, rel=1e-6)


def test_a_pose_in_another_frame_is_compared_in_the_world() -> None:
    session, _ = moving_on(kept())
    now_s = session.clock_s
    in_world = {"at_mm": [PARTS["b"] + 150 * now_s, 350, 60]}
    assert session.holds({"part": "b", "pose": in_world}).holds
    in_world["at_mm"][1] += 0.5
    assert session.holds({"part": "b", "pose": in_world}).off_mm == pytest.approx(0.5 - 2 * 0.02, abs=1e-6)
    assert session.holds({"part": "b", "pose": {"frame": "belt", "at_mm": [PARTS["b"], 0, 10]}}).holds


def test_a_part_that_the_proof_does_not_know_is_not_covered() -> None:
    session, _ = moving_on(kept())
    for part in ("c", "x"):
        found = session.holds({"part": part, "pose": at(PARTS["c"])})
        assert (found.holds, found.until_s, found.off_mm) == (False, None, None)


def test_a_part_that_was_put_down_is_where_the_motion_put_it() -> None:
    session = running(**PARTS)
    made = commit(session, transfer("a"))
    session.advance(made.answer.arrivals[0]["until_s"] + 0.1)
    refused(lambda: session.holds({"part": "a", "pose": at(0, session.clock_s)}), "part", "the gripper does not hold")
    session.advance(made.base_ends_s or 0.0)
    assert session.holds({"part": "a", "pose": {"frame": "shelf"}}).holds
    assert not session.holds({"part": "a", "pose": {"frame": "shelf", "at_mm": [75, 0, 0]}}).holds


@pytest.mark.parametrize(
    ("reading", "field"),
    [
        ({"frame": "belt", "speed_mm_s": 150}, "reading"),
        ({"frame": "shelf", "along_mm": 0}, "frame"),
        ({"frame": "lane", "along_mm": 0}, "frame"),  # fixed on the belt
        ({"along_mm": 0}, "frame"),
        ({"frame": "belt", "along_mm": math.inf}, "along_mm"),
        ({"frame": "belt", "along_mm": 0, "at_s": 1e4}, "at_s"),
        ({"frame": "belt", "along_mm": 0, "part": "b"}, "part"),
        ({}, "reading"),
        ({"pose": at(0)}, "part"),
        ({"part": "b"}, "reading"),
        ({"joints": {"j1_deg": 20}}, "joints.j2_rad"),
        ({"joints": {"j1_deg": math.nan, "j2_deg": 0, "j3_mm": 0, "j4_deg": 0}}, "joints.j1_deg"),
        ({"joints": START["joints"], "part": "b"}, "part"),
        ({"joints": START["joints"], "at_s": 1e4}, "at_s"),
        ({"joints": START["joints"], "at_s": -1}, "at_s"),
        ({"part": "b", "pose": at(0, 1e4)}, "pose.at_s"),
        ({"part": "b", "pose": {"frame": "bel"}}, "pose.frame"),
        ({"part": "b", "pose": {**at(0), "pitch_deg": 1}}, "pose.pitch_deg"),
        ({"part": "b", "pose": at(0), "colour": 1}, "colour"),
        ([], "reading"),
    ],
)
def test_what_is_no_reading_is_refused(reading: Any, field: str) -> None:
    session, _ = moving_on(kept())
    with pytest.raises(InputError) as error:
        session.holds(reading)
    assert error.value.field == field


def test_a_part_that_has_gone_after_its_place_is_in_no_further_proposal() -> None:
    document = cell()
    document["kinds"] = {"bracket": {**document["kinds"]["bracket"], "uncertainty": {"position_mm": 1, "yaw_deg": 1}}}
    session = assur.Session(document, start=START, refuge="home", planning_ms=1e3 * PLANNING_S)
    for name in ("a", "b"):
        session.see(name, kind="bracket", pose=at(PARTS[name]))
    made = commit(session, transfer("a"))
    assert made.base_ends_s is not None
    session.advance(made.base_ends_s)
    session.gone("a")
    after = commit(session, transfer("b"))
    request = after.answer.request or {}
    assert "b" in [body["name"] for body in request["bodies"]]
    assert "a" not in [body["name"] for body in request["bodies"]]
    assert assur.check(request, after.answer)["ok"]
