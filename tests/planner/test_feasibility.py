"""Necessary conditions: refused are only requests that no time, mode or candidate could meet."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.checked import check
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.necessary import points_impossible, start_impossible
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Piece, box, cylinder, sphere
from assur.planner.laws import Change, Law, conveyor, indexer, keyframes, linear, oscillation, swing, turntable
from assur.planner.model.outcome import NotPlanned, Planned
from assur.planner.model.refusal import BeyondRange, Reason, Refusal
from assur.planner.model.scene import Clearance, Follow, Pick, Place, Scene
from assur.planner.pipeline import plan
from assur.planner.search.beam import Search
from tests.planner.cells import (
    BARE,
    CUP,
    Around,
    Shape,
    amount_of,
    arm,
    at,
    belt_and_dial,
    block,
    cell,
    frame,
    go,
    mesh_box,
    solid,
    stands,
    table_to_table,
)
from tests.planner.robots.five_bars import five_bar


def found(scene: Scene) -> Refusal | None:
    prover = Prover(scene)
    return start_impossible(scene, prover) or points_impossible(scene, prover)


def reason(scene: Scene) -> Reason | None:
    refusal = found(scene)
    return None if refusal is None else refusal.reason


def test_what_is_possible_is_not_refused() -> None:
    for scene in (cell(go(0.35, -0.2)), table_to_table(go(0.3, 0.0, 0.15)), belt_and_dial(), table_to_table(fold=0)):
        assert found(scene) is None


@pytest.mark.parametrize(
    ("joint", "value", "amount"), [(0, 2.5, 2.5 - 2.3038), (2, 0.04, 0.01), (2, 0.27, 0.02), (3, -7.0, 7.0 - 2 * np.pi)]
)
def test_a_start_beyond_a_joints_range_says_by_how_much(joint: int, value: float, amount: float) -> None:
    q = [0.3, 1.2, 0.2, 0.0]
    q[joint] = value
    refusal = found(cell(go(0.35, -0.2), q=tuple(q)))
    assert refusal is not None
    assert refusal.reason is Reason.JOINT_LIMIT
    assert amount_of(refusal) == pytest.approx(amount)
    assert refusal.joint == arm().joints[joint].name
    assert found(cell(go(0.35, -0.2), q=(2.3038, 1.2, 0.25, 0.0))) is None  # at the limit is not beyond it


def test_a_start_that_is_faster_than_a_joint_can_be_is_refused_and_one_at_its_limit_is_not() -> None:
    assert reason(cell(go(0.35, -0.2), qd=(7.9, 0.0, 0.0, 0.0))) is Reason.MOTION_LIMIT
    assert reason(cell(go(0.35, -0.2), qdd=(0.0, -81.0, 0.0, 0.0))) is Reason.MOTION_LIMIT
    assert reason(cell(go(0.35, -0.2), qd=(7.8, 0.0, 0.0, 0.0))) is None


def test_a_law_must_be_known_at_the_start() -> None:
    for valid, start, may in (((0.0, 5.0), 0.0, True), ((0.1, 5.0), 0.0, False), ((0.0, 5.0), 6.0, False)):
        gate = frame("gate", turntable(Pose(-0.3, -0.3), 1.0, valid=valid))
        bar = stands("bar", box(0.1, 0.1, 0.1), frame="gate")
        assert (reason(cell(go(0.35, -0.2), frames=(gate,), bodies=(bar,), time=start)) is None) == may


HERE = np.array([0.3, 1.2, 0.2, 0.0])


def beside_the_quill(gap: float, on: str = "world") -> Around:
    p, _ = arm().forward(HERE)
    return stands("post", cylinder(0.03, 0.2), float(p[0]) + 0.012 + 0.03 + gap, float(p[1]), 0.14, frame=on)


@pytest.mark.parametrize("clearance", [0.0, 0.005])
def test_the_start_must_have_the_clearance_of_travel(clearance: float) -> None:
    for spare, may in ((1e-4, True), (-1e-4, False)):
        bodies = (beside_the_quill(clearance + spare),)
        scene = cell(go(0.35, -0.2), bodies=bodies, clearance=Clearance(clearance, 0.0))
        assert (found(scene) is None) == may
        if not may:
            assert reason(scene) is Reason.START_IN_COLLISION


def test_an_arm_that_touches_itself_at_the_start_is_refused() -> None:
    scene = cell(go(0.35, -0.2), robot=arm(column=0.16), q=(0.3, 2.6, 0.1, 0.0))
    refusal = found(scene)
    assert refusal is not None
    assert refusal.reason is Reason.START_IN_COLLISION
    assert set(refusal.bodies) == {"quill", "column"}


SHAPES: dict[str, Shape] = {
    "box": box(0.1, 0.1, 0.4),
    "sphere": sphere(0.1),
    "cylinder": cylinder(0.05, 0.4),
    "hull": block(0.1, 0.1, 0.4, (0.0, 0.0, 0.0)),
}


@pytest.mark.parametrize("kind", sorted(SHAPES))
@pytest.mark.parametrize("tracking", [False, True])
def test_a_point_in_what_stands_around_it_is_refused(kind: str, tracking: bool) -> None:
    body = stands("thing", SHAPES[kind], 0.35, -0.2, 0.15)
    step = Follow("f", at(0.35, -0.2), 0.1) if tracking else go(0.35, -0.2)
    refusal = found(cell(step, bodies=(body,), tool=CUP))
    assert refusal is not None
    assert refusal.reason is Reason.CONTROL_POINT_IN_COLLISION
    assert "thing" in refusal.bodies
    assert refusal.interval is None


def test_a_point_in_what_moves_with_it_is_refused_and_in_what_moves_past_is_not() -> None:
    dial = frame("dial", turntable(Pose(0.32, 0.12), 0.5))
    belt = frame("belt", conveyor(Pose(0.42, 0.12, 0.1), 0.3))
    peg = solid("peg", cylinder(0.03, 0.4))
    step = go(0.1, 0.0, 0.1, 0.0, "dial")
    along = cell(step, bodies=(Around(peg, "dial", Pose(0.1, 0.0, 0.2)),), frames=(dial, belt))
    past = cell(step, bodies=(Around(peg, "belt"),), frames=(dial, belt))
    assert reason(along) is Reason.CONTROL_POINT_IN_COLLISION
    assert reason(past) is None


@pytest.mark.parametrize("moving", [False, True])
def test_a_point_inside_a_closed_mesh_is_refused_unless_the_mesh_moves_away(moving: bool) -> None:
    away = frame("away", conveyor(Pose(), 0.4))
    mesh = Around(mesh_box("shell", 0.3, 0.3, 0.7), "away" if moving else "world", Pose(0.45, -0.3, 0.2))
    scene = cell(go(0.45, -0.3), bodies=(mesh,), frames=(away,))
    assert reason(scene) is (None if moving else Reason.CONTROL_POINT_IN_COLLISION)


def test_a_part_is_no_obstacle_to_its_own_pick_and_what_it_rests_on_none_to_its_place() -> None:
    assert found(table_to_table(clearance=Clearance(0.02, 0.0005))) is None


def test_a_hollow_part_is_not_inside_itself_and_not_where_it_was_before_it_was_placed() -> None:
    scene = table_to_table(go(0.25, 0.30, 0.075))  # in the end to where the part lay
    hollow = replace(scene.index["part"], body=mesh_box("part", 0.06, 0.04, 0.06))
    raised = replace(hollow, pose=Pose(0.25, 0.30, 0.07, 0.5))
    assert isinstance(scene.task[1], Place)
    put = replace(scene.task[1], to=replace(scene.task[1].to, pose=Pose(0.35, -0.25, 0.07, -0.4)))
    assert isinstance(scene.task[0], Pick)
    pick = replace(scene.task[0], grasp=Pose(z=0.03))
    bodies = tuple(raised if body.name == "part" else body for body in scene.bodies)
    assert found(replace(scene, bodies=bodies, task=(pick, put, scene.task[2]))) is None
    # but a point inside the part where it was put is impossible
    inside = go(0.35, -0.25, 0.075, name="inside")
    refusal = found(replace(scene, bodies=bodies, task=(pick, put, inside)))
    assert refusal is not None
    assert refusal.reason is Reason.CONTROL_POINT_IN_COLLISION
    assert refusal.step == 2


def test_a_nest_that_is_filled_already_is_refused() -> None:
    scene = table_to_table()
    other = stands("other", box(0.06, 0.04, 0.02), 0.35, -0.25, 0.05)
    refusal = found(replace(scene, bodies=(*scene.bodies, other)))
    assert refusal is not None
    assert refusal.reason is Reason.CONTROL_POINT_IN_COLLISION
    assert refusal.step == 1


def test_a_part_beside_a_wall_is_refused_only_if_no_turn_of_the_tool_is_free() -> None:
    """A gripper that is long to one side hits the wall; turned by 180° it does not."""
    finger = solid("finger", box(0.08, 0.01, 0.05), 0.05, 0.0, -0.03)
    for fold, may in ((1, False), (2, True)):
        base = table_to_table(fold=fold, tool=replace(CUP, bodies=(finger,)), q=(-0.6, 1.0, 0.2, 0.0))
        wall = stands("wall", box(0.01, 0.4, 0.3), 0.25 + 0.075, 0.30, 0.2)
        part = replace(base.index["part"], pose=Pose(0.25, 0.30, 0.05, 0.0))
        bodies = (*(part if body.name == "part" else body for body in base.bodies), wall)
        scene = replace(base, bodies=bodies, task=base.task[:1])
        assert (reason(scene) is None) == may


def test_a_point_that_stands_out_of_reach_is_impossible_by_so_many_millimetres() -> None:
    refusal = found(cell(go(0.7, 0.0)))
    assert refusal is not None
    assert refusal.reason is Reason.OUT_OF_REACH
    assert amount_of(refusal) == pytest.approx(0.1, abs=0.002)  # the arm is 0.6 m long


FAR = Pose(0.75, 0.1, 0.0, 0.0)
"""150 mm beyond the reach of an arm of 600 mm."""


def circling(nearest: float) -> Law:
    """Once round in 2 s; at 1.5 s so far from the arm's axis, m, and farther before and after."""
    way = (FAR, Pose(0.9, 0.0, 0.0, 1.0), Pose(nearest, 0.0, 0.0, 5.0), replace(FAR, yaw=2.0 * math.pi))
    return keyframes((0.5, 1.0, 1.5, 2.5), way, "periodic")


@pytest.mark.parametrize(
    ("law", "offset", "short"),
    [
        (oscillation(Pose(0.8, 0.0), (1.0, 0.0, 0.0), 0.1, 1.5), 0.0, 0.1),
        (oscillation(Pose(0.8, 0.0), (0.0, 0.0, 1.0), 0.1, 1.5), 0.0, 0.2),
        (swing(Pose(0.9, 0.0, 0.0, 0.0), 3.2, 0.8), 0.2, 0.1),
        (turntable(Pose(0.9, 0.0), -0.4), 0.2, 0.1),
        (circling(0.72), 0.0, None),
    ],
    ids=lambda value: type(value).__name__,
)
def test_a_point_that_repeats_its_way_out_of_reach_is_never_met(law: Law, offset: float, short: float | None) -> None:
    scene = cell(go(offset, 0.0, frame="it"), frames=(frame("it", law),))
    refusal = found(scene)
    assert refusal is not None
    assert refusal.reason is Reason.OUT_OF_REACH
    t = np.linspace(0.0, 50.0, 200_001)
    where = law.motion(t).at(Pose(offset))
    truth = float(np.hypot(*where.p[:, :2].T).min()) - 0.6
    assert short is None or truth == pytest.approx(short, abs=1e-6)
    assert truth - 0.01 < amount_of(refusal) <= truth + 1e-9
    outcome = plan(scene)
    assert isinstance(outcome, NotPlanned)
    assert outcome.proved


def test_a_point_that_repeats_its_way_out_of_reach_of_both_limbs_of_a_five_bar_is_never_met() -> None:
    """Its limbs are 0.46 m long, from 0.0425 m beside the axis; along x the point is 0.6 m away at the nearest."""
    law, robot = oscillation(Pose(0.7, 0.0), (1.0, 0.0, 0.0), 0.1, 1.5), five_bar("even")
    scene = cell(go(0.0, 0.0, 0.2, frame="it"), robot=robot, q=(0.9, -0.9, 0.2, 0.0), frames=(frame("it", law),))
    outcome = plan(scene)
    assert isinstance(outcome, NotPlanned)
    assert (outcome.reason, outcome.proved) == (Reason.OUT_OF_REACH, True)
    assert outcome.refusal is not None
    truth = math.hypot(0.6, 0.0425) - 0.46
    assert truth - 0.01 < amount_of(outcome.refusal) <= truth + 1e-9


@pytest.mark.parametrize(
    "law",
    [
        circling(0.599),
        oscillation(Pose(0.8, 0.0), (1.0, 0.0, 0.0), 0.201, 1.5),
        turntable(Pose(0.9, 0.0), 0.4, changes=(Change(1e4, 0.0, 1.0, 10.0),)),
        oscillation(Pose(0.8, 0.0), (1.0, 0.0, 0.0), 0.1, 1.5, valid=(0.0, 1.4)),
        indexer(Pose(0.9, 0.0), 0.1, 0.5, 0.5),
    ],
    ids=lambda value: type(value).__name__,
)
def test_nothing_is_said_of_a_point_that_comes_within_reach_or_whose_way_is_not_known_to_repeat(law: Law) -> None:
    assert found(cell(go(0.0, 0.0, frame="it"), frames=(frame("it", law),))) is None


def test_a_point_within_reach_is_not_out_of_range() -> None:
    assert found(cell(go(0.59, 0.0))) is None


def test_a_height_that_the_lift_joint_does_not_come_to_is_named_with_what_is_missing() -> None:
    refusal = found(cell(go(0.4, 0.0, 0.27)))
    assert refusal is not None
    assert (refusal.reason, refusal.joint) == (Reason.JOINT_LIMIT, "z")
    assert amount_of(refusal) == pytest.approx(0.02, abs=1e-9)


@pytest.mark.parametrize(("z", "missing", "above"), [(-0.03, 0.08, 0.0), (0.26, 0.04, 0.03)])
def test_of_a_point_and_its_approach_the_one_that_misses_more_is_told(z: float, missing: float, above: float) -> None:
    base = table_to_table()
    assert isinstance(base.task[0], Pick)
    part = replace(base.index["part"], pose=Pose(0.25, 0.30, z, 0.5))
    pick = replace(base.task[0], grasp=Pose(), approach_m=0.03, depart_m=0.0)
    refusal = found(replace(base, bodies=(part,), task=(pick,), tool=BARE))
    assert refusal is not None
    assert (refusal.reason, refusal.joint) == (Reason.JOINT_LIMIT, "z")
    assert amount_of(refusal) == pytest.approx(missing)
    assert isinstance(refusal.facts, BeyondRange)
    assert refusal.facts.above_m == above


@settings(max_examples=40)
@given(st.integers(0, 10**6))
def test_nothing_that_is_planned_was_called_impossible(seed: int) -> None:
    """Random clutter near the point: where the search finds a plan without asking first, nothing is refused."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(0.2, 0.4), rng.uniform(-0.3, 0.3)
    kinds = list(SHAPES.values())
    around = []
    for i in range(3):
        p = np.array([x, y, 0.15]) + rng.normal(size=3) * 0.12
        shape = kinds[int(rng.integers(4))]
        around.append(Around(Body(f"b{i}", (Piece(shape),)), "world", Pose(float(p[0]), float(p[1]), float(p[2]))))
    scene = cell(go(float(x), float(y), 0.1), bodies=tuple(around), tool=CUP, max_candidates=30)
    refusal = found(scene)
    searched = Search(scene, Prover(scene), 1e12).run()
    if searched.best is not None:
        assert refusal is None
    if refusal is None and isinstance(plan(scene), Planned):
        assert searched.best is not None


def test_a_point_exactly_at_the_end_of_a_range_is_within_it_and_one_ten_micrometres_further_is_not() -> None:
    """In whole millimetres some such points are beyond the end, by the rounding of a sum."""
    tool, rounded = replace(BARE, tcp=Pose(z=-0.06)), 0
    for k in range(280, 300):
        upper = arm().limits.upper.copy()
        upper[2] = k / 1000
        robot = replace(arm(), limits=replace(arm().limits, upper=upper))
        z = (k - 60) / 1000
        rounded += z + 0.06 > k / 1000
        scene = cell(go(0.35, -0.2, z), robot=robot, tool=tool, max_candidates=20)
        outcome = plan(scene)
        assert isinstance(outcome, Planned), outcome.sentence
        assert check(scene, outcome.plan).ok
        refusal = found(cell(go(0.35, -0.2, z + 1e-5), robot=robot, tool=tool))
        assert refusal is not None
        assert (refusal.reason, refusal.joint) == (Reason.JOINT_LIMIT, "z")
    assert rounded > 3


def test_only_a_frame_that_bears_a_body_must_be_known_at_the_start() -> None:
    over = frame("old", linear(Pose(5.0, 5.0, 0.0), (0.1, 0.0, 0.0), valid=(-20.0, -10.0)))
    empty = cell(go(0.35, -0.2), frames=(over,), max_candidates=20)
    outcome = plan(empty)
    assert isinstance(outcome, Planned)
    assert check(empty, outcome.plan).ok
    refusal = found(cell(go(0.35, -0.2), frames=(over,), bodies=(stands("cart", box(0.1, 0.1, 0.1), frame="old"),)))
    assert refusal is not None
    assert (refusal.reason, refusal.frame) == (Reason.LAW_ENDS, "old")
