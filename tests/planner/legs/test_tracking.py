"""Tracked blocks: with the frame to a micrometre at all times, down and up along the vertical, within all limits."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st

from assur.planner.checked import check
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import box
from assur.planner.laws import Law, conveyor, indexer, linear, swing, turntable
from assur.planner.legs.control_point import ControlPoint, control_point
from assur.planner.legs.state import State
from assur.planner.legs.tracking import TrackingLegs, lead_time, track
from assur.planner.model.attachments import AT_START
from assur.planner.model.outcome import LegKind, Planned
from assur.planner.model.refusal import MotionLimit, Obstacle, Reason, Refusal
from assur.planner.model.scene import Follow, Pick, Scene, Start, Target, Tool
from assur.planner.pipeline import plan
from assur.planner.robots.facts import Code, Limits
from assur.planner.robots.robot import Robot
from assur.planner.robots.tilting import ElbowArm, PolarArm
from assur.planner.trajectory import Trajectory
from tests.planner.cells import BARE, CRANKED, CUP, amount_of, arm, cell, frame, stands, unit_of
from tests.planner.test_pipeline import flawless
from tests.planner.trajectory.splines import keeps_limits

FOLLOWED_M = 1e-6
"""The promise of `assur.planner.legs.tracking`."""


def law(kind: str, rng: np.random.Generator) -> tuple[Law, Pose]:
    """A law in front of the arm, and a part's pose in it."""
    yaw = float(rng.uniform(-3, 3))
    if kind == "conveyor":
        at = Pose(-0.05, 0.38, 0.06, float(rng.uniform(-0.3, 0.3)))
        return conveyor(at, float(rng.uniform(-0.3, 0.3))), Pose(yaw=yaw)
    if kind == "linear":
        return linear(Pose(0.05, 0.35, 0.06), (0.1, -0.08, 0.01)), Pose(yaw=yaw)
    if kind == "turntable":
        return turntable(Pose(0.32, 0.12, 0.06), float(rng.uniform(-1.5, 1.5))), Pose(0.08, 0.0, 0.0, yaw)
    if kind == "swing":
        return swing(Pose(0.3, 0.2, 0.06), 0.5, float(rng.uniform(1.0, 3.0))), Pose(0.1, 0.02, 0.0, yaw)
    return indexer(Pose(0.3, 0.15, 0.06), math.pi / 3, 0.4, 0.5), Pose(0.1, 0.0, 0.0, yaw)


KINDS = st.sampled_from(["conveyor", "linear", "turntable", "swing"])


def cell_with(where: Law, pose: Pose, tool: Tool, dwell: float = 0.1, **more: Any) -> Scene:
    part = stands("part", box(0.03, 0.03, 0.02), pose.x, pose.y, pose.z, pose.yaw, "moving")
    step = Pick("pick", "part", Pose(z=0.01, yaw=0.2), 0.03, dwell, 0.04)
    options: dict[str, Any] = {"singularity_margin": 0.05, **more}
    return cell(step, frames=(frame("moving", where),), bodies=(part,), robot=arm(j4=12.0), tool=tool, **options)


def begun(scene: Scene, t: float, mode: int) -> tuple[ControlPoint, State] | None:
    """The control point, and the state of the arm above it at t."""
    point = control_point(scene, 0, AT_START, 0.0)
    found = scene.robot.inverse(point.flange(np.array(t), point.approach), mode, 2)
    if found.code != Code.ASSEMBLED or not found.margin > 0.3:
        return None
    return point, State(t, found.q, found.qd, found.qdd)


def whole(block: TrackingLegs) -> Trajectory:
    knots = block.legs[0].knots
    for leg in block.legs[1:]:
        knots = knots.then(leg.knots)
    return Trajectory(knots.time, knots.q, knots.qd, knots.qdd)


@settings(max_examples=60)
@given(st.integers(0, 10**6), KINDS, st.sampled_from([BARE, CUP, CRANKED]))
def test_a_pick_from_a_frame_that_moves_passes_the_checker(seed: int, kind: str, tool: Tool) -> None:
    """It shows that the tool stays with the part, goes down and up along the vertical, and keeps all limits."""
    rng = np.random.default_rng(seed)
    where, pose = law(kind, rng)
    scene = cell_with(where, pose, tool, float(rng.choice([0.0, 0.08, 0.4])), max_candidates=30)
    outcome = plan(scene)
    assert flawless(outcome)
    event("planned" if isinstance(outcome, Planned) else str(outcome.reason))
    if isinstance(outcome, Planned):
        assert check(scene, outcome.plan).ok
        kinds = [leg.kind for leg in outcome.plan.legs]
        first = kinds.index(LegKind.APPROACH)
        assert kinds[first : first + 3] == [LegKind.APPROACH, LegKind.FOLLOW, LegKind.DEPART]


def test_a_lead_is_the_time_of_the_way_down() -> None:
    scene = cell_with(conveyor(Pose(0.2, 0.3, 0.06), 0.1), Pose(), CUP)
    start = begun(scene, 0.0, 0)
    assert start is not None
    point, state = start
    lead = lead_time(scene, point, 1.0)
    block = track(scene, point, state, 0, 1.0)
    assert isinstance(block, TrackingLegs)
    assert block.begin - state.time == pytest.approx(lead, abs=1e-12)


def test_a_frame_that_is_faster_than_the_arm_is_a_motion_limit() -> None:
    scene = cell_with(turntable(Pose(0.32, 0.12, 0.06), 30.0), Pose(0.08, 0.0), CUP)
    point = control_point(scene, 0, AT_START, 0.0)
    found = scene.robot.inverse(point.flange(np.array(0.0), point.approach), 0, 2)
    block = track(scene, point, State(0.0, found.q, found.qd, found.qdd), 0, 1.0)
    assert isinstance(block, Refusal)
    assert block.reason in (Reason.MOTION_LIMIT, Reason.JOINT_LIMIT)


def test_the_joint_that_is_too_slow_for_a_frame_is_named_with_what_it_lacks() -> None:
    """At the middle of a dial the wrist alone turns; it can 40 rad/s."""
    scene = cell_with(turntable(Pose(0.32, 0.12, 0.06), 45.0), Pose(), CUP)
    start = begun(replace(scene, robot=arm(j4=200.0)), 0.0, 0)
    assert start is not None
    block = track(start[0].scene, start[0], start[1], 0, 1.0)
    assert isinstance(block, Refusal)
    assert (block.reason, block.joint, unit_of(block)) == (Reason.MOTION_LIMIT, "theta4", "rad/s")
    assert amount_of(block) == pytest.approx(5.0, abs=1e-3)
    assert isinstance(block.facts, MotionLimit)
    assert block.facts.value == pytest.approx(45.0)
    assert block.facts.limit == pytest.approx(40.0)
    told = replace(block.facts, value=None, limit=None)
    assert told == MotionLimit(obstacle=Obstacle.FRAME_TOO_FAST, rate="velocity", frame="moving")


def test_a_belt_that_leaves_the_workspace_during_tracking_is_out_of_reach() -> None:
    scene = cell_with(conveyor(Pose(0.3, 0.4, 0.06), 0.25), Pose(), CUP, dwell=2.0)
    start = begun(scene, 0.0, 0)
    assert start is not None
    block = track(scene, start[0], start[1], 0, 1.0)
    assert isinstance(block, Refusal)
    assert block.reason is Reason.OUT_OF_REACH


def test_the_wrist_turns_on_and_on_with_a_dial_until_its_range_ends() -> None:
    scene = cell_with(turntable(Pose(0.32, 0.12, 0.06), 2.0), Pose(0.0, 0.0), CUP, dwell=3.0)
    start = begun(scene, 0.0, 0)
    assert start is not None
    block = track(scene, start[0], start[1], 0, 1.0)
    assert isinstance(block, TrackingLegs)
    path = whole(block)
    assert abs(path.q[-1, 3] - path.q[0, 3]) > 2 * math.pi  # no jump by a turn on the way
    longer = cell_with(turntable(Pose(0.32, 0.12, 0.06), 2.0), Pose(0.0, 0.0), CUP, dwell=12.0)
    again = begun(longer, 0.0, 0)
    assert again is not None
    refused = track(longer, again[0], again[1], 0, 1.0)
    assert isinstance(refused, Refusal)
    assert refused.reason is Reason.JOINT_LIMIT
    assert refused.joint == "theta4"


def test_near_a_singularity_a_block_is_refused_with_the_margin_that_is_missing() -> None:
    where = linear(Pose(0.348, 0.464, 0.06), (0.009, 0.012, 0.0))
    scene = cell_with(where, Pose(), CUP, dwell=0.5, singularity_margin=0.4)
    point = control_point(scene, 0, AT_START, 0.0)
    found = scene.robot.inverse(point.flange(np.array(0.0), point.approach), 0, 2)
    block = track(scene, point, State(0.0, found.q, found.qd, found.qdd), 0, 1.0)
    assert isinstance(block, Refusal)
    assert block.reason is Reason.NEAR_SINGULARITY
    assert 0 < amount_of(block) <= 0.4


POLAR_RANGE = (np.array([-3.0, -1.0, 0.2]), np.array([3.0, 1.5, 0.8]))
WITHOUT_LIFT: list[tuple[Robot, int]] = [
    (
        ElbowArm(
            name="elbow",
            height=0.3,
            l1=0.25,
            l2=0.232,
            limits=Limits(*(np.full(3, x) for x in (-3.0, 3.0, 3.0, 25.0, 1250.0))),
        ),
        0,
    ),
    (
        PolarArm(
            name="polar",
            height=0.4,
            limits=Limits(*POLAR_RANGE, *(np.full(3, x) for x in (3.0, 25.0, 1250.0))),
        ),
        0,
    ),
]


@pytest.mark.parametrize(("robot", "mode"), WITHOUT_LIFT)
def test_an_arm_without_a_lift_goes_straight_down_to_a_moving_point_and_up_again(robot: Robot, mode: int) -> None:
    """What a pick would ask of it: approach, dwell and depart along the vertical, within all limits."""
    belt = frame("belt", conveyor(Pose(0.3, -0.2, 0.1, math.pi / 2), 0.15))
    still = Start(0.0, np.array([0.0, 0.5, 0.5]), np.zeros(3), np.zeros(3))
    step = Follow("f", Target("belt", Pose(0.02, 0.01, 0.05), True), 0.2)
    scene = Scene(robot, Tool(Pose()), still, {"belt": belt}, (), (step,))
    plain = control_point(scene, 0, AT_START, 0.0)
    point = replace(plain, approach=0.05, depart=0.08)
    lead = lead_time(scene, point, 1.0)
    assert isinstance(lead, float)
    begin = 0.5
    found = robot.inverse(point.flange(np.array([begin]), 0.05), mode, 2)
    state = State(begin, found.q[0], found.qd[0], found.qdd[0])
    block = track(scene, point, state, mode, 1.0)
    assert isinstance(block, TrackingLegs), block
    assert [leg.kind for leg in block.legs] == [LegKind.APPROACH, LegKind.FOLLOW, LegKind.DEPART]
    assert block.end - block.begin == pytest.approx(0.2)
    for leg in block.legs:
        knots = leg.knots
        path = Trajectory(knots.time, knots.q, knots.qd, knots.qdd)
        limits = robot.limits
        assert keeps_limits(path, *(getattr(limits, name) for name in LIMIT_NAMES))
        t = np.linspace(path.start, path.end, 301)
        position, _ = robot.forward(path.evaluate(t))
        off = position - point.flange(t).p
        assert np.abs(off[:, :2]).max() < 2 * FOLLOWED_M
        assert off[:, 2].min() > -2 * FOLLOWED_M
        highest = {LegKind.APPROACH: 0.05, LegKind.FOLLOW: 0.0, LegKind.DEPART: 0.08}[leg.kind]
        assert off[:, 2].max() == pytest.approx(highest, abs=2 * FOLLOWED_M)


LIMIT_NAMES = ("lower", "upper", "velocity", "acceleration", "jerk")
