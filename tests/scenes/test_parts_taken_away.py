"""A part that is taken away after its place counts until then, and the arm waits if it has to."""

from __future__ import annotations

import base64
import copy
import json
import math
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

import assur
from assur.planner.checked import check
from assur.planner.claim import columns as c
from assur.planner.collision.proof import Prover
from assur.planner.errors import InputError
from assur.planner.feasibility.necessary import points_impossible
from assur.planner.feasibility.witnesses import refusal_proof
from assur.planner.model.outcome import Leg, LegKind
from assur.planner.model.phases import phases
from assur.planner.model.refusal import Reason
from assur.planner.model.scene import Pick, Place, Scene
from assur.planner.report.notes import leg_note
from assur.scenes.exports.documents import export_document
from assur.scenes.requests import cell_of, check_document
from assur.scenes.tasks.joining import joined
from assur.scenes.tasks.next_task import end_state, next_request
from assur.scenes.view.document import view_of
from benchmarks.judge.poses import Document
from benchmarks.judge.product import as_si
from benchmarks.judge.product import planned as answer_of
from benchmarks.judge.promises import broken_promises
from benchmarks.random_requests.kinds import random_cell
from tests.planner.checker.statement.cases import Case, differences, planned, sealed
from tests.refused import refused_at
from tests.scenes.exports.glb_reader import Glb

GRIP: Document = {"approach": {"mm": 20}, "dwell_ms": 60, "depart": {"mm": 20}}
CELL: Document = {
    "schema": "assur-cell/1",
    "robot": {
        "model": "mitsubishi-rh-6frh5520",
        "tool": {"tcp_mm": [0, 0, -100], "bodies": [{"name": "cup", "shape": {"box": {"size_mm": [40, 40, 80]}},
                                                     "at_mm": [0, 0, -55]}]},
    },
    "frames": {"bench": {"fixed": {"at_mm": [0, 0, 40]}}},
    "kinds": {"cube": {"shape": {"box": {"size_mm": [30, 30, 30]}}, "mass_kg": 0.1, "grasp_mm": [0, 0, 15]} | GRIP},
    "bodies": [{"name": "table", "shape": {"box": {"size_mm": [400, 900, 20]}}, "pose": {"at_mm": [400, 0, 30]}}],
    "positions": {"home": {"at_mm": [350, 0, 200]}},
    "slots": {"nest": {"frame": "bench", "at_mm": [350, -200, 15]}},
}  # fmt: skip
BOX: Document = {"box": {"size_mm": [30, 30, 30]}}


def nest(gone_after_ms: object, **changed: Any) -> Document:
    """Two parts come to one nest, each is taken away so long after its place; and the arm goes home."""
    task = {
        "schema": "assur-task/1",
        "start": {"joints": {"j1_deg": 20, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}},
        "parts": [
            {"name": "a", "kind": "cube", "pose": {"at_mm": [350, 150, 55]}},
            {"name": "b", "kind": "cube", "pose": {"at_mm": [300, 250, 55]}},
        ],
        "steps": [
            {"transfer": {"parts": ["a", "b"], "to": "nest", "gone_after_ms": gone_after_ms}},
            {"move": {"to": "home"}},
        ],
        "options": {"seed": 1, "stop": "first", "max_candidates": 300, "budget_s": 60, "report": "full"},
    }
    return joined(copy.deepcopy(CELL), copy.deepcopy(task | changed)).request


@cache
def case(gone_after_ms: int) -> Case:
    found = planned(nest(gone_after_ms))
    assert found is not None
    return found


def later(scene: Scene, more_s: float, step: int = 1) -> Scene:
    """The scene in which the part of a place is taken away by so much later."""
    place = scene.task[step]
    assert isinstance(place, Place)
    assert place.gone_after_s is not None
    other = replace(place, gone_after_s=place.gone_after_s + more_s)
    return replace(scene, task=(*scene.task[:step], other, *scene.task[step + 1 :]))


def wait_of(of: Case) -> Leg:
    """The one leg in which the arm waits."""
    (found,) = [leg for leg in of.plan.legs if leg.kind is LegKind.WAIT]
    return found


# the plan


def test_the_arm_waits_until_the_part_is_gone_and_not_much_longer() -> None:
    of = case(2000)
    gone = of.plan.arrivals[1].until + 2.0
    assert wait_of(of).step == 3
    assert gone <= wait_of(of).t1 <= gone + 0.03


def test_a_wait_names_the_part_and_when_it_is_gone() -> None:
    of = case(2000)
    answer = assur.plan(of.request)
    (wait,) = [leg for leg in answer["legs"] if leg["kind"] == "WAIT"]
    assert wait["note"] == f"waits until a is gone (at {answer['arrivals'][1]['until_s'] + 2.0:.3f} s)"


def test_a_wait_for_two_parts_names_both() -> None:
    scene, plan = case(2000).scene, case(2000).plan
    put_down, place = plan.arrivals[1], scene.task[1]
    assert isinstance(place, Place)
    twice = replace(scene, task=(*scene.task[:3], replace(place, part="b"), *scene.task[4:]))
    both = (put_down, replace(put_down, step=3))
    wait = wait_of(case(2000))
    assert leg_note(twice, wait, both).startswith("waits until a and b are gone (at ")
    assert leg_note(twice, replace(wait, t1=wait.t1 + 0.01), both) == "lets bodies pass"


def test_who_need_not_wait_does_not() -> None:
    of = case(0)
    assert all(leg.kind is not LegKind.WAIT for leg in of.plan.legs)
    assert of.plan.trajectory.end < case(2000).plan.trajectory.end - 0.5


@pytest.mark.parametrize("gone_after_ms", [0, 700, 2000])
def test_the_judge_who_derives_it_by_himself_agrees(gone_after_ms: int) -> None:
    of = case(gone_after_ms)
    answer = dict(assur.plan(of.request))
    assert broken_promises(as_si(of.request), answer) == []
    assert check_document(of.request, answer)["ok"]
    stays = as_si(of.request)
    for step in (1, 3):
        stays["task"][step]["place"].pop("gone_after_s")
    assert broken_promises(stays, answer) != []


def test_the_answer_lists_it_as_an_assumption() -> None:
    listed = [each for each in assur.plan(case(700).request)["assumptions"] if "taken it away" in each]
    assert listed == [f"{part}: somebody has taken it away 700 ms after place-{part} put it down" for part in "ab"]


def test_a_robot_that_may_be_late_waits_for_so_much_longer() -> None:
    request = case(2000).request | {"execution": {"start_tolerance_ms": 100}}
    late = planned(request)
    assert late is not None
    assert wait_of(late).t1 >= late.plan.arrivals[1].until + 2.1
    assert broken_promises(as_si(request), dict(assur.plan(request))) == []


def test_an_arm_that_moves_with_a_belt_stops_before_it_waits() -> None:
    request = random_cell("taken away, belt", 4)
    answer, _ = answer_of(request)
    assert answer is not None
    assert answer["status"] == "planned"
    assert [leg["kind"] for leg in answer["legs"] if leg["step"] == 3][:3] == ["MOVE", "WAIT", "MOVE"]
    assert broken_promises(as_si(request), answer) == []


# the checkers


def test_a_plan_is_refused_where_the_part_is_gone_a_little_later_than_it_assumes() -> None:
    of = case(2000)
    assert check(of.scene, of.plan).ok
    assert not check(later(of.scene, 0.03), sealed(later(of.scene, 0.03), of.plan)).ok


def test_a_claim_that_leaves_the_part_out_too_early_is_refused() -> None:
    """The claim is that of the scene in which the part is gone sooner: all of its rows hold, of other seats."""
    of = case(2000)
    for more_s in (0.03, 1.0):
        findings = differences(replace(of, scene=later(of.scene, more_s)))
        assert {finding.what for finding in findings} == {
            "a is fixed to something else, or at another pose",
            "a was put down, and is not kept clear",
        }
    assert differences(of) == []


def test_a_part_that_is_gone_is_nowhere_else_than_far_away() -> None:
    of = case(2000)
    k, row = of.body("a"), len(of.claim.seats)
    near = of.claim.seats[int(of.claim.seated[-1, k])].copy()
    assert near[c.SEAT_POSE + 2] == -100.0
    near[c.SEAT_POSE + 2] = -0.5
    seated = of.claim.seated.copy()
    seated[-1, k] = row
    forged = of.claim._replace(seats=np.vstack([of.claim.seats, near]), seated=seated)
    assert "SEAT" in {finding.code for finding in differences(of, forged)}


def test_in_the_legs_of_its_own_place_the_part_is_there() -> None:
    of = case(0)
    depart = next(p for p in phases(of.scene, of.plan.legs, of.plan.arrivals) if (p.step, p.kind) == (1, "DEPART"))
    assert not depart.attached.has_gone(of.scene, "a")
    assert depart.t0 == of.plan.arrivals[1].until


def test_no_refusal_is_proved_by_a_part_that_may_be_gone() -> None:
    stays = cell_of(case(0).request).scene
    for step in (1, 3):
        place = stays.task[step]
        assert isinstance(place, Place)
        stays = replace(stays, task=(*stays.task[:step], replace(place, gone_after_s=None), *stays.task[step + 1 :]))
    refusal = points_impossible(stays, Prover(stays))
    assert refusal is not None
    assert refusal.reason is Reason.CONTROL_POINT_IN_COLLISION
    assert refusal_proof(stays, Prover(stays), refusal) is not None
    leaves = case(2000).scene
    assert points_impossible(leaves, Prover(leaves)) is None
    assert refusal_proof(leaves, Prover(leaves), refusal) is None


def test_a_part_that_leaves_too_late_is_in_the_way_and_nothing_is_proved() -> None:
    request = nest(50_000)
    request["options"] |= {"latest_end_s": 4, "max_candidates": 60}
    answer = assur.plan(request)
    assert not answer.planned
    assert answer["proved"] is False
    assert check_document(request, dict(answer))["ok"]


# what comes after, and what is shown


def test_the_next_task_has_the_parts_that_are_not_gone_by_then() -> None:
    of = case(2000)
    follows = next_request(
        end_state(of.request, dict(assur.plan(of.request))), [{"move": {"to": {"at_mm": [350, 0, 150]}}}]
    )
    assert [body["name"] for body in follows["bodies"]] == ["table", "b"]
    assert assur.plan(follows).planned


def test_the_view_and_the_model_show_it_no_longer() -> None:
    of = case(2000)
    answer = json.loads(json.dumps(dict(assur.plan(of.request))))
    view = view_of(cell_of(of.request), answer)
    shown = {body["name"]: body for body in view["bodies"]}
    gone_s = shown["a"]["gone_s"]
    assert gone_s == wait_of(of).t1
    assert shown["b"]["gone_s"] is None
    assert max(abs(x) for body in view["bodies"] for seat in body["seats"] for x in seat["at_m"]) < 1.0
    file = Glb.of(base64.b64decode(export_document(of.request, answer, {"format": "glb"})["file"]))
    sizes = [file.placed(node, np.array([gone_s - 0.01, gone_s + 0.01]))[:, 0, 0] for node in file.named("a")]
    assert sorted(np.abs(sizes).sum(0).tolist(), reverse=True) == [pytest.approx(1.0), 0.0]


# what is refused when it is read


@pytest.mark.parametrize("value", [-1, math.nan, math.inf, "soon", 1e12, True])
def test_a_time_that_is_none_is_refused_by_its_name(value: object) -> None:
    request = nest(100)
    request["task"][1]["place"]["gone_after_ms"] = value
    with refused_at("task[1].place.gone_after_ms"):
        cell_of(request)


@pytest.mark.parametrize(
    ("step", "where"),
    [
        ({"pick": {"part": "a", "grasp_mm": [0, 0, 15]} | GRIP}, "task[4].pick.part"),
        ({"move": {"to": {"body": "a", "at_mm": [0, 0, 100]}}}, "task[4].move.to.body"),
    ],
)
def test_no_later_step_names_it(step: Document, where: str) -> None:
    request = nest(100)
    request["task"][4] = step
    with refused_at(where, "taken away (gone_after_s)"):
        cell_of(request)


def test_no_later_part_rests_on_it() -> None:
    request = nest(100)
    request["task"][3]["place"]["contact_with"] = ["table", "a"]
    with refused_at("task[3].place.contact_with[1]", "taken away (gone_after_s)"):
        cell_of(request)


def test_a_scene_that_names_it_is_refused_as_well() -> None:
    scene = case(0).scene
    again = Pick("again", "a", scene.task[0].grasp, 0.02, 0.05, 0.02)  # type: ignore[union-attr]
    with pytest.raises(InputError, match="gone_after_s"):
        replace(scene, task=(*scene.task, again))


def test_a_slot_is_taken_where_the_part_stays() -> None:
    task = {
        "schema": "assur-task/1",
        "start": {"joints": {"j1_deg": 20, "j2_deg": 60, "j3_mm": 250, "j4_deg": 0}},
        "parts": [
            {"name": name, "kind": "cube", "pose": {"at_mm": [350, y, 55]}} for name, y in (("a", 150), ("b", 250))
        ],
        "steps": [{"transfer": {"parts": ["a", "b"], "to": "nest"}}],
    }
    with pytest.raises(InputError, match="all 1 are taken"):
        joined(CELL, task)


# stacks


def stack(gone_after_ms: int | None) -> Document:
    """The second part is put where the first one is, on top of it."""
    request = nest(100)
    for step, height in ((1, 15), (3, 45)):
        request["task"][step]["place"] |= {"to": {"frame": "bench", "at_mm": [350, -200, height], "yaw_deg": 0}}
        del request["task"][step]["place"]["gone_after_ms"]
    if gone_after_ms is not None:
        request["task"][1]["place"]["gone_after_ms"] = gone_after_ms
    return request


def test_a_part_is_put_on_one_that_stays() -> None:
    of = planned(stack(None))
    assert of is not None
    on_top = [phase for phase in phases(of.scene, of.plan.legs, of.plan.arrivals) if phase.step == 4]
    assert {pair for phase in on_top for pair in phase.handled.supports} == {("a", "table"), ("b", "a")}
    assert all(leg.kind is not LegKind.WAIT for leg in of.plan.legs)
    assert differences(of) == []
    assert broken_promises(as_si(of.request), dict(assur.plan(of.request))) == []


def test_no_part_is_put_on_one_that_will_be_taken_away() -> None:
    of = planned(stack(1500))
    assert of is not None
    assert wait_of(of).step == 3
    assert wait_of(of).t1 >= of.plan.arrivals[1].until + 1.5
    assert broken_promises(as_si(of.request), dict(assur.plan(of.request))) == []
