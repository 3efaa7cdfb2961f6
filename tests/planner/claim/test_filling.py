"""The tables of a claim are those of a scene and a plan; what cannot be stated is refused."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.claim.filling import claim_of, with_plan
from assur.planner.claim.frames import arms_of, knots_at_rest, knots_of, law_of
from assur.planner.claim.obligations import distances_of, solids_in, solids_of
from assur.planner.errors import InputError
from assur.planner.geometry.shapes import Body, pieces, sphere
from assur.planner.laws import Change, Pose, conveyor, indexer, keyframes
from assur.planner.model.phases import phases
from assur.planner.model.scene import ClearanceException, bodies_in
from assur.planner.trajectory import Trajectory
from tests.planner.cells import CUP, Around, arm, block, cell, go, mesh_box, solid
from tests.prover.bundles import planned

NAME = "standard-cycle"


def claim() -> Claim:
    scene, plan = planned(NAME)
    return with_plan(claim_of(scene), plan)


def test_plans_share_the_tables_of_their_scene_and_none_is_written_to() -> None:
    scene, plan = planned(NAME)
    base = claim_of(scene)
    before = {name: table.copy() for name, table in base.cell.tables.items()}
    first, second = with_plan(base, plan), with_plan(base, plan, phases(scene, plan.legs, plan.arrivals))
    for name, one, other in zip(Claim._fields, first, second, strict=True):
        assert np.array_equal(one, other), name
        assert one.dtype == np.float64, name
        assert one.flags.c_contiguous, name
    assert first.links is second.links
    assert first.pieces is second.pieces
    for name, table in base.cell.tables.items():
        assert np.array_equal(table, before[name]), name
    # a second scene with the same cell needs the cell's tables only once
    assert claim_of(replace(scene, start=replace(scene.start, time=0.5)), base.cell).cell is base.cell


@pytest.mark.parametrize("first", [0, 1, 2, 3])
def test_solids_behind_those_of_a_kept_cell_are_as_if_all_were_new(first: int) -> None:
    post, wedge = solid("post", sphere(0.02)), solid("wedge", block(0.1, 0.05, 0.05, (0.05, 0.0, 0.0)))
    around = [
        Around(mesh_box("bin", 0.2, 0.2, 0.1)),
        Around(post),
        Around(wedge),
        Around(mesh_box("tray", 0.1, 0.1, 0.1)),
    ]
    of_cell = cell(go(0.3, 0.0), bodies=tuple(around[:first]), robot=arm(column=0.05), tool=CUP)
    scene = replace(of_cell, bodies=(*of_cell.bodies, *around[first:]))
    assert scene.kept.before is of_cell.kept
    found, whole = solids_in(scene), solids_of(bodies_in(scene), scene.pieces)
    for name, table in whole.items():
        assert np.array_equal(found[name], table), name
        assert found[name].dtype == table.dtype


def test_the_same_solids_elsewhere_and_under_other_names_are_not_made_again() -> None:
    post, tray = Around(solid("post", sphere(0.02))), Around(mesh_box("tray", 0.1, 0.1, 0.1))
    of_cell = cell(go(0.3, 0.0), bodies=(Around(mesh_box("bin", 0.2, 0.2, 0.1)),), robot=arm(column=0.05), tool=CUP)
    scene = replace(of_cell, bodies=(*of_cell.bodies, post, tray))
    renamed = replace(post, body=Body("pole", post.body.pieces), pose=Pose(1.0, 0.0, 0.0))
    same = replace(of_cell, bodies=(*of_cell.bodies, renamed, replace(tray, pose=Pose(0.0, 1.0, 0.0))))
    assert same.pieces is scene.pieces
    assert solids_in(same) is solids_in(scene)
    smaller = Around(solid("post", sphere(0.01)))
    for others in ((smaller, tray), (tray, post), (post,), (post, tray, replace(tray, body=renamed.body))):
        other = replace(of_cell, bodies=(*of_cell.bodies, *others))
        whole = pieces(bodies_in(other))
        assert np.array_equal(other.pieces.table, whole.table)
        for name, table in solids_of(bodies_in(other), whole).items():
            assert np.array_equal(solids_in(other)[name], table), name


@pytest.mark.parametrize("name", ["bin", "post", "link1"])
def test_a_further_body_has_a_name_that_no_other_body_has(name: str) -> None:
    own = [item.body.name for item in arm(column=0.05).bodies]
    of_cell = cell(go(0.3, 0.0), bodies=(Around(mesh_box("bin", 0.2, 0.2, 0.1)),), robot=arm(column=0.05), tool=CUP)
    post, twin = Around(solid("post", sphere(0.02))), Around(solid(own[0] if name == "link1" else name, sphere(0.01)))
    with pytest.raises(InputError, match="names that are unique") as refused:
        replace(of_cell, bodies=(*of_cell.bodies, post, twin))
    assert refused.value.value == twin.body.name


def test_an_arm_has_no_more_joints_than_the_tables_have_columns_for() -> None:
    arm: Any = SimpleNamespace(joints=range(c.MOST_JOINTS + 1))
    with pytest.raises(InputError, match="an arm with 9 joints"):
        arms_of([arm])


def test_an_arm_stands_before_and_after_its_trajectory() -> None:
    q = np.array([[0.1, 0.2], [0.3, 0.4]])
    path = Trajectory(np.array([1.0, 2.0]), q, np.zeros((2, 2)), np.zeros((2, 2)))
    assert knots_of(path, 1.0, 2.0)[:, c.KNOT_TIME].tolist() == [1.0, 2.0]
    knots = knots_of(path, 0.5, 2.5)
    assert knots[:, c.KNOT_TIME].tolist() == [0.5, 1.0, 2.0, 2.5]
    assert knots[:, c.KNOT_Q : c.KNOT_Q + 2].tolist() == [*q[[0, 0]].tolist(), *q[[1, 1]].tolist()]
    assert not knots[:, c.KNOT_Q + 2 : c.KNOT_QD].any()
    assert not knots[:, c.KNOT_QD :].any()


@pytest.mark.parametrize(("end", "message"), [(0, "begins, and is needed before"), (-1, "ends, and is needed after")])
@pytest.mark.parametrize("rate", ["qd", "qdd"])
def test_a_motion_that_is_needed_beyond_its_end_rests_there(end: int, message: str, rate: str) -> None:
    rates = {"qd": np.zeros((2, 2)), "qdd": np.zeros((2, 2))}
    rates[rate][end, 1] = 1e-12
    path = Trajectory(np.array([1.0, 2.0]), np.zeros((2, 2)), rates["qd"], rates["qdd"])
    assert len(knots_of(path, 1.0, 2.0)) == 2
    with pytest.raises(InputError, match=message):
        knots_of(path, 0.5, 2.5)


@pytest.mark.parametrize("rate", ["qd", "qdd"])
def test_another_arm_is_stated_for_all_times_at_whose_end_it_rests(rate: str) -> None:
    rates = {"qd": np.zeros((2, 2)), "qdd": np.zeros((2, 2))}
    path = Trajectory(np.array([1.0, 2.0]), np.zeros((2, 2)), rates["qd"], rates["qdd"])
    assert knots_at_rest(path)[:, c.KNOT_TIME].tolist() == [-c.LATEST_S, 1.0, 2.0, c.LATEST_S]
    rates[rate][0, 1] = 1e-12
    path = Trajectory(np.array([1.0, 2.0]), np.zeros((2, 2)), rates["qd"], rates["qdd"])
    assert knots_at_rest(path)[:, c.KNOT_TIME].tolist() == [1.0, 2.0, c.LATEST_S]


POSES = (Pose(), Pose(0.1), Pose(0.2))


def test_a_law_that_begins_beyond_all_times_of_claims_is_refused() -> None:
    stop = Change(3e5, 0.0, 1.0, 1.0)
    assert len(law_of(conveyor(Pose(), 0.1, (stop,)), 0.0).pieces) == 1
    for times in ((-2e5, 0.5, 3.0), (2e5, 2e5 + 1.0, 3e5)):
        with pytest.raises(InputError, match="whose motion begins before -100000 s or after 100000 s"):
            law_of(keyframes(times, POSES), 0.0)


def test_a_law_is_stated_to_its_end_from_the_piece_on_that_lasts_when_a_plan_may_begin() -> None:
    law = law_of(keyframes((0.0, 1.0, 3.0), POSES, valid=(1.5, 9.0)), 0.5)
    assert [piece[: c.LAW_POWER] for piece in law.pieces] == [[0.0, 1.0], [1.0, 3.0]]
    assert law.waves == []
    later = law_of(keyframes((0.0, 1.0, 3.0), POSES), 1.5)
    assert [piece[: c.LAW_POWER] for piece in later.pieces] == [[1.0, 3.0]]
    assert later.at[0] == pytest.approx(0.1)
    for early, stated, begin in ((-3.0, 5.0, -3.0), (0.0, -2.0, -2.0), (4.1, 9.0, 4.0), (-1e9, 0.0, -c.LATEST_S)):
        at, pieces, _, period = law_of(conveyor(Pose(1.0), 0.5, (Change(4.0, 0.0, 1.0, 1.0),), stated), early)
        assert pieces[0][c.LAW_BEGIN] == begin
        assert pieces[-1][c.LAW_END] == c.LATEST_S
        assert at[0] == pytest.approx(1.0 + 0.5 * (begin - min(stated, 4.0)) - 0.25 * (stated > 4.0), abs=0.26)
        assert not any(period)


@pytest.mark.parametrize("start", [0.25, 2e5, -3e5])
def test_a_law_with_a_period_is_stated_for_one_period_wherever_it_begins(start: float) -> None:
    law = indexer(Pose(yaw=0.5), 0.3, 0.6, 0.4, start=start)
    at, pieces, _, (period, *step) = law_of(law, 0.0)
    begin = pieces[0][c.LAW_BEGIN]
    assert (-c.LATEST_S if start < -c.LATEST_S else -0.75) <= begin <= 0.0
    assert (period, step) == (1.0, [0.0, 0.0, 0.0, 0.3])
    assert [piece[c.LAW_END] for piece in pieces] == [begin + 0.6, begin + 1.0]
    assert at[3] == pytest.approx(float(law.motion(np.array(begin)).yaw), abs=1e-6)


def test_a_rule_about_bodies_that_the_cell_has_not_is_a_rule_about_none() -> None:
    scene, _ = planned(NAME)
    names = [body.name for body in claim_of(scene).cell.bodies]
    for first, second, count in (
        (frozenset(), frozenset({names[1]}), 1),
        (frozenset({names[0]}), frozenset({"nobody"}), 0),
    ):
        rule = ClearanceException(first, second, 0.01, 0.02)
        options = replace(scene.options, clearance=replace(scene.options.clearance, exceptions=(rule,)))
        changed = replace(scene, options=options)
        rules = distances_of(changed)["rules"]
        assert len(rules) == count
        if count:
            sides = rules[0, c.RULE_SIDE :].reshape(2, -1)
            assert rules[0, : c.RULE_SIDE].tolist() == [0.01, 0.02]
            assert sides[0].all()
            assert np.flatnonzero(sides[1]).tolist() == [1]
