"""What the checker accepts is free, measured by distances from points to solids; and honest plans are accepted.

The ball's centre has a closed-form distance from each of the arm's solids. It knows nothing of normals, supports, rows
or bounds.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.checked import check
from assur.planner.checker import Code
from assur.planner.errors import FaultError
from assur.planner.geometry.shapes import Primitive, sphere
from assur.planner.laws import Law, Pose, linear, swing, turntable
from assur.planner.laws.law import Uncertainty
from assur.planner.legs.accuracy import arrival_error
from assur.planner.model.attachments import AT_START
from assur.planner.model.outcome import (
    Plan,
)
from assur.planner.model.phases import GraspUncertainty
from assur.planner.model.scene import Execution, Move, Options, Scene, Target, WorldBody
from tests.planner.checker.hand_made import (
    TOOL,
    WORLD,
    Hand,
    above,
    arm,
    belt_to_dial,
    carried_over,
    crossing,
    frame,
    proved,
    sealed,
    solid,
    start_at,
)

RADIUS = 0.03


def distance(shape: Primitive, x: FloatArray) -> FloatArray:
    """From points (N, 3) in its own axes to a solid; negative inside (then only a bound of how deep)."""
    outside = np.abs(x) - np.array(shape.half)
    if shape.disc == 0.0:
        return np.asarray(np.sqrt((np.maximum(outside, 0) ** 2).sum(1)) + np.minimum(outside.max(1), 0) - shape.ball)
    radial = np.hypot(x[:, 0], x[:, 1]) - shape.disc
    flat = np.stack([radial, outside[:, 2]], 1)
    return np.asarray(np.sqrt((np.maximum(flat, 0) ** 2).sum(1)) + np.minimum(flat.max(1), 0) - shape.ball)


def least_distance(scene: Scene, plan: Plan, ball: str = "ball") -> float:
    """The smallest distance of the ball from the arm at 2000 times, m."""
    t = np.linspace(plan.trajectory.start, plan.trajectory.end + scene.options.stay_safe_s, 2000)
    q = plan.trajectory.evaluate(np.minimum(t, plan.trajectory.end))
    p, rotation = scene.robot.placements(q)
    item = scene.index[ball]
    centre = scene.frames[item.frame].law.motion(t).at(item.pose).p
    solids = [(b.link, b.body) for b in scene.robot.bodies]
    solids += [(scene.robot.links.index("flange"), body) for body in scene.tool.bodies]
    found = math.inf
    for link, body in solids:
        local = ((centre - p[:, link])[:, None] @ rotation[:, link])[:, 0]
        for piece in body.pieces:
            assert isinstance(piece.shape, Primitive)
            inside = (local - piece.position) @ piece.rotation
            found = min(found, float(distance(piece.shape, inside).min()) - RADIUS)
    return found


LAWS = ("linear", "swing", "dial")


def law_of(kind: str, x: float, y: float, z: float, w: float) -> Law:
    """Towards the arm, about it, or about a place beside it."""
    if kind == "linear":
        return linear(Pose(x, y, z), (-x * w / 2, -y * w / 2, 0.0))
    if kind == "swing":
        return swing(Pose(0.0, 0.0, z), w, 1.0)
    return turntable(Pose(x, y, z), 2 * w)


def passing(law: str, x: float, y: float, z: float, w: float, clearance: float) -> tuple[Scene, Hand]:
    """A quarter turn of the arm, and a ball on a frame that moves."""
    robot = arm()
    moving = frame("moving", law_of(law, x, y, z, w))
    at = Pose(x, y) if law == "swing" else Pose(0.05, 0.0)
    bodies = (WorldBody(solid("ball", sphere(RADIUS)), "moving", at),)
    task = (Move("there", Target("world", Pose(0.1, 0.3, 0.15))),)
    start = start_at(robot, TOOL.tcp, Pose(0.33, -0.05, 0.15))
    options = Options(stay_safe_s=0.1)
    options = replace(options, clearance=replace(options.clearance, travel_m=clearance))
    scene = Scene(robot, TOOL, start, {"world": WORLD, "moving": moving}, bodies, task, options)
    hand = Hand(scene)
    hand.go(0, above(scene, "world", Pose(0.1, 0.3, 0.15)), 0.5)
    hand.arrive(0, 0.5, 0.5)
    return scene, hand


@given(
    st.sampled_from(LAWS),
    st.floats(-0.4, 0.4),
    st.floats(-0.4, 0.4),
    st.floats(0.0, 0.6),
    st.floats(-1.0, 1.0),
    st.sampled_from([0.0, 0.005]),
)
@example("linear", 0.3, 0.2, 0.15, 1.0, 0.0)
@example("dial", 0.2, 0.2, 0.2, 0.0, 0.0)
def test_a_proof_that_is_accepted_is_true_and_one_that_is_possible_is_accepted(
    law: str, x: float, y: float, z: float, w: float, clearance: float
) -> None:
    scene, hand = passing(law, x, y, z, w, clearance)
    try:
        plan = hand.plan()
    except FaultError:
        # Too near for the plain prover; where the arm is really free there is no telling.
        assert least_distance(scene, _bare(scene, hand)) < clearance + 0.02
        return
    assert check(scene, plan).findings == ()
    assert least_distance(scene, plan) >= clearance
    # The same rows, true of a ball that came nearer by itself: accepted only if it is still free.
    for shift in (0.01, 0.05):
        nearer = replace(
            scene, frames={**scene.frames, "moving": frame("moving", law_of(law, x - shift, y, z, w * 1.2))}
        )
        if check(nearer, sealed(nearer, plan)).ok:
            assert least_distance(nearer, plan) >= clearance


def _bare(scene: Scene, hand: Hand) -> Plan:
    """The plan without its proof."""
    return proved(replace(scene, bodies=()), hand.trajectory(), tuple(hand.legs), tuple(hand.arrivals))


@pytest.mark.parametrize("turn", [0.0, np.pi])
def test_a_part_may_be_taken_either_way_round_if_it_looks_the_same(turn: float) -> None:
    scene = belt_to_dial()
    assert check(scene, carried_over(scene, turn)).findings == ()


@pytest.mark.parametrize(
    "execution",
    [Execution((1e-3,) * 4), Execution(start_tolerance_s=0.02), Execution((5e-4,) * 4, start_tolerance_s=0.01)],
)
def test_an_honest_plan_for_an_uncertain_cell_is_accepted(execution: Execution) -> None:
    scene = crossing(execution=execution)
    ball = scene.frames["ball"]
    scene = replace(scene, frames={**scene.frames, "ball": replace(ball, uncertainty=Uncertainty(1e-3, 5e-3))})
    hand = Hand(scene)
    hand.wait(0, 0.1)
    for number, (pose, t) in enumerate(((Pose(0.3, -0.1, 0.15), 0.4), (Pose(0.2, 0.25, 0.2, 0.4), 1.0))):
        hand.go(number, above(scene, "world", pose), t)
        hand.arrive(number, t, t)
    plan = hand.plan()
    states = [(arrival, plan.trajectory.evaluate(arrival.until)) for arrival in plan.arrivals]
    errors = [arrival_error(scene, each.step, AT_START, GraspUncertainty(), q, each.until) for each, q in states]
    arrivals = tuple(replace(arrival, error=error) for (arrival, _), error in zip(states, errors, strict=True))
    assert check(scene, sealed(scene, replace(plan, arrivals=arrivals))).findings == ()
    assert {finding.code for finding in check(scene, plan).findings} == {Code.ARRIVAL}


def test_a_last_leg_may_come_to_rest() -> None:
    """After a meeting in motion at the end of the task; no step but the last has such a leg."""
    scene = belt_to_dial()
    point = Pose(0.05, 0.0, 0.2)
    scene = replace(scene, task=(Move("touch", Target("belt", point)),))
    hand = Hand(scene)
    hand.go(0, above(scene, "belt", point), 0.6)
    stop = above(scene, "world", Pose(0.16, 0.28, 0.2))
    hand.go(0, stop, 1.0)
    hand.arrive(0, 0.6, 0.6)
    plan = hand.plan()
    assert check(scene, plan).findings == ()
    twice = replace(scene, task=(*scene.task, Move("again", Target("world", Pose(0.16, 0.28, 0.2)))))
    assert Code.LEGS in {finding.code for finding in check(twice, plan).findings}
