"""Straight legs: on the line between two frames that move, with their velocities at both ends, within all limits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.checked import check
from assur.planner.frames.motion import Motion, Pose
from assur.planner.laws import Law, conveyor, fixed, turntable
from assur.planner.legs.follower import UNIFORM, PathTask
from assur.planner.legs.line import Along, Line
from assur.planner.legs.state import State, TimedLeg
from assur.planner.legs.straight import by_law, constant_law, mode_changes, straight
from assur.planner.model.outcome import Planned
from assur.planner.model.refusal import Reason, Refusal, Singular, Stage
from assur.planner.model.scene import Move, Scene, Target
from assur.planner.pipeline import plan
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory
from assur.scenes.catalogue import arm_named
from tests.planner.cells import amount_of, arm, cell, frame, go, limits, unit_of
from tests.planner.five_axis_cells import five_axis_arm
from tests.planner.test_pipeline import flawless
from tests.planner.trajectory.splines import keeps_limits

LIMITS = limits()


def along(law: Law, pose: Pose) -> Along:
    def motion(t: FloatArray) -> Motion:
        return law.motion(np.asarray(t)).at(pose)

    return motion


def begin(scene: Scene, law: Law, pose: Pose, t: float, mode: int) -> State:
    found = scene.robot.inverse(law.motion(np.array(t)).at(pose), mode, 2)
    return State(t, found.q, found.qd, found.qdd)


def by_the_constant_law(scene: Scene, state: State, mode: int, left: Along, met: Along) -> TimedLeg | Refusal:
    way = PathTask(scene, Stage.STRAIGHT, 0, Line(left, met, scene.tool.tcp), UNIFORM, state.time)
    return by_law(way, state, mode, constant_law(), 0, scene.robot.limits)


def path(leg: TimedLeg) -> Trajectory:
    return Trajectory(leg.knots.time, leg.knots.q, leg.knots.qd, leg.knots.qdd)


@st.composite
def ends(draw: st.DrawFn) -> tuple[Law, Pose, Law, Pose]:
    """A frame to leave and one to meet; on a grid, or anywhere."""
    found: list[Law | Pose] = []
    for side in (-1.0, 1.0):
        kind = draw(st.sampled_from(["fixed", "belt", "dial"]))
        x, y = draw(st.sampled_from([(0.3, 0.2), (0.25, 0.25), (0.35, 0.1)]))
        z, yaw = draw(st.sampled_from([0.08, 0.15, 0.2])), draw(st.sampled_from([0.0, 0.5, -1.0, 2.0]))
        if kind == "fixed":
            found += [fixed(Pose(x, side * y, z)), Pose(yaw=yaw)]
        elif kind == "belt":
            speed = draw(st.floats(-0.15, 0.15))
            heading = draw(st.sampled_from([0.0, math.pi / 2, 1.0]))
            found += [conveyor(Pose(x, side * y, z, heading), speed), Pose(yaw=yaw)]
        else:
            found += [turntable(Pose(x, side * y, z), draw(st.floats(-1.0, 1.0))), Pose(0.05, 0.0, 0.0, yaw)]
    return found[0], found[1], found[2], found[3]  # type: ignore[return-value]


@settings(max_examples=40)
@given(ends())
def test_a_plan_along_a_line_between_two_frames_passes_the_checker(given_ends: tuple[Law, Pose, Law, Pose]) -> None:
    """It shows that the tool keeps to the line, has the velocities of the frames at both ends, and keeps all limits."""
    first, pose, second, goal = given_ends
    frames = frame("one", first), frame("other", second)
    task = Move("there", Target("one", pose)), Move("line", Target("other", goal), leg="cartesian")
    scene = cell(*task, frames=frames, robot=arm(j4=12.0), singularity_margin=0.05, max_candidates=30)
    outcome = plan(scene)
    assert flawless(outcome)
    event("straight" if isinstance(outcome, Planned) else str(outcome.reason))
    if isinstance(outcome, Planned):
        assert check(scene, outcome.plan).ok
        assert all(arrival.matched for arrival in outcome.plan.arrivals)


def still(x: float, y: float, z: float = 0.1) -> tuple[Law, Pose]:
    return fixed(Pose(x, y, z)), Pose()


def between(first: tuple[Law, Pose], second: tuple[Law, Pose], **options: Any) -> TimedLeg | Refusal:
    scene = cell(go(0.3, 0.0), robot=arm(j4=12.0), **options)
    return straight(scene, 0, begin(scene, *first, 0.0, 0), 0, along(*first), along(*second))


def test_a_leg_uses_what_the_joints_allow() -> None:
    leg = between(still(0.3, -0.2), still(0.3, 0.2))
    assert isinstance(leg, TimedLeg)
    found = path(leg)
    peaks = [np.abs(np.array(found.extrema(k))).max(0) for k in (1, 2, 3)]
    used = max(
        float((peak / limit).max())
        for peak, limit in zip(peaks, (LIMITS.velocity, LIMITS.acceleration, LIMITS.jerk), strict=True)
    )
    assert used >= 0.6


def test_a_line_past_the_folded_arm_is_refused_with_the_millimetres() -> None:
    # the arm folded reaches to 50 mm; the line passes the base at 60 mm
    leg = between(still(0.3, 0.06), still(-0.3, 0.06), singularity_margin=0.3)
    assert isinstance(leg, Refusal)
    assert leg.reason is Reason.NEAR_SINGULARITY
    assert isinstance(leg.facts, Singular)
    assert leg.facts.distance_m == pytest.approx(0.01, abs=1e-4)
    theta2 = math.acos((0.06**2 - 0.325**2 - 0.275**2) / (2 * 0.325 * 0.275))
    assert amount_of(leg) == pytest.approx(0.3 - math.sin(theta2), abs=1e-3)


def test_a_line_that_leaves_the_workspace_is_refused() -> None:
    leg = between(still(0.5, -0.28), still(0.5, 0.28), singularity_margin=0.0)
    assert isinstance(leg, TimedLeg)
    gone = between(still(0.4, 0.4), still(0.75, 0.4), singularity_margin=0.0)
    assert isinstance(gone, Refusal)
    assert gone.reason is Reason.OUT_OF_REACH
    inner = between(still(0.3, 0.02), still(-0.3, 0.02), singularity_margin=0.0)
    assert isinstance(inner, Refusal)
    assert inner.reason is Reason.OUT_OF_REACH


def test_a_line_that_a_joint_cannot_follow_names_the_joint() -> None:
    leg = between(still(0.3, 0.2, 0.1), still(0.3, -0.2, 0.3))
    assert isinstance(leg, Refusal)
    assert leg.reason is Reason.JOINT_LIMIT
    assert leg.joint == "z"
    assert amount_of(leg) == pytest.approx(0.05, abs=1e-6)


def test_a_law_that_ends_on_the_way_is_refused() -> None:
    belt = conveyor(Pose(0.3, 0.2, 0.1), 0.1, valid=(-1.0, 0.05))
    leg = between(still(0.3, -0.2), (belt, Pose()))
    assert isinstance(leg, Refusal)
    assert leg.reason is Reason.LAW_ENDS


def test_where_a_straight_leg_cannot_change_the_elbow_it_says_how_near_it_comes() -> None:
    """From left to right through the base's neighbourhood: the modes meet where the arm is stretched or folded."""
    scene = cell(go(0.3, 0.0), robot=arm(j4=12.0))
    first, second = still(0.3, 0.06), still(-0.3, 0.06)
    state = begin(scene, *first, 0.0, 0)
    found = mode_changes(scene, 0, state, (0, 1), along(*first), along(*second))
    assert found.reason is Reason.NEAR_SINGULARITY
    assert unit_of(found) == "m"
    assert amount_of(found) == pytest.approx(0.01, abs=1e-4)


def robots() -> dict[str, Robot]:
    found: dict[str, Robot] = {"scara": arm(), "five-axis": five_axis_arm()}
    for model in ("elbow-arm", "polar-arm", "mitsubishi-rp-5ah"):
        entry = arm_named(model)
        found[model] = entry.robot(Pose(), entry.limits)
    return found


def drawn(rng: np.random.Generator, robot: Robot, mode: int, moving: bool) -> Along | None:
    """A frame that stands, or a belt or a dial, somewhere in reach in the mode; or nothing."""
    q = rng.uniform(np.maximum(robot.limits.lower, -3), np.minimum(robot.limits.upper, 3))
    none = np.zeros_like(q)
    if not robot.within(q) or robot.mode_of(q) != mode:
        return None
    place = robot.link_motion(robot.links.index("flange"), q, none, none, none)
    x, y, z = place.p.tolist()
    law: Law = fixed(Pose(x, y, z, float(place.yaw)))
    kind = int(rng.integers(3)) if moving else 0
    if kind == 1:
        law = conveyor(Pose(x, y, z, float(rng.uniform(-3, 3))), float(rng.uniform(-0.2, 0.2)))
    elif kind == 2:
        law = turntable(Pose(x, y, z), float(rng.uniform(-1, 1)))

    def motion(t: FloatArray) -> Motion:
        found = law.motion(np.asarray(t)).at(Pose())
        return found.with_tilt(place.tilt) if place.tilted else found

    return motion


@pytest.mark.parametrize("moving", [False, True])
@pytest.mark.parametrize("name", list(robots()))
def test_no_leg_is_slower_than_by_the_constant_law_and_what_that_refuses_is_refused_alike(
    name: str, moving: bool
) -> None:
    robot, rng = robots()[name], np.random.default_rng(5)
    given = robot.limits
    middle = tuple(((given.lower + given.upper) / 2).tolist())
    scene = cell(go(0.3, 0.0), robot=robot, q=middle, singularity_margin=0.05)
    ratios: list[float] = []
    refused = 0
    while len(ratios) < 12:
        mode = int(rng.integers(len(robot.modes)))
        left, met = drawn(rng, robot, mode, moving), drawn(rng, robot, mode, moving)
        if left is None or met is None:
            continue
        at = robot.inverse(left(np.array(0.2)), mode, 2)
        if not np.isfinite(at.qdd).all():
            continue
        state = State(0.2, at.q, at.qd, at.qdd)
        before = by_the_constant_law(scene, state, mode, left, met)
        leg = straight(scene, 0, state, mode, left, met)
        if isinstance(before, Refusal) or isinstance(leg, Refusal):
            assert repr(leg) == repr(before)
            refused += 1
            continue
        found = path(leg)
        assert keeps_limits(found, given.lower, given.upper, given.velocity, given.acceleration, given.jerk)
        ratios.append(found.duration / path(before).duration)
    assert refused > 0
    assert max(ratios) <= 1.01


def test_a_leg_of_no_length_is_refused_and_one_that_only_turns_is_not() -> None:
    for x in (0.3, 0.3 + 1e-12):
        nowhere = between(still(0.3, 0.2), still(x, 0.2))
        assert isinstance(nowhere, Refusal)
        assert nowhere.reason is Reason.MOTION_LIMIT
    turned = between(still(0.3, 0.2), (fixed(Pose(0.3, 0.2, 0.1)), Pose(yaw=1.0)))
    assert isinstance(turned, TimedLeg)
    assert np.abs(np.diff(turned.knots.q[:, :3], axis=0)).max() <= 1e-12


def test_a_frame_that_stands_at_first_and_then_moves_is_followed() -> None:
    """Whether frames stand is asked over all of the leg, not where it begins."""

    def met(t: FloatArray) -> Motion:
        still_one = Motion.still(Pose(0.3, 0.2, 0.1), np.shape(t))
        u = np.maximum(np.asarray(t) - 0.05, 0.0)
        p, v, a = still_one.p.copy(), still_one.v.copy(), still_one.a.copy()
        p[..., 0] += 0.2 * u**3
        v[..., 0] += 0.6 * u**2
        a[..., 0] += 1.2 * u
        return Motion.of(p, v, a, still_one.j, *(getattr(still_one, k) for k in ("yaw", "yaw_d", "yaw_dd", "yaw_ddd")))

    scene = cell(go(0.3, 0.0), robot=arm(j4=12.0))
    state, left = begin(scene, *still(0.3, -0.2), 0.0, 0), along(*still(0.3, -0.2))
    leg, before = (
        straight(scene, 0, state, 0, left, met),
        by_the_constant_law(scene, state, 0, left, met),
    )
    assert isinstance(leg, TimedLeg)
    assert isinstance(before, TimedLeg)
    assert path(leg).duration <= path(before).duration
    end = np.array([path(leg).end])
    wanted, q, qd = met(end), path(leg).evaluate(end), path(leg).evaluate(end, 1)
    reached = scene.robot.link_motion(scene.robot.links.index("flange"), q, qd, 0 * q, 0 * q)
    assert np.abs(reached.p - wanted.p).max() <= 1e-9
    assert np.abs(reached.v - wanted.v).max() <= 1e-8
    assert np.abs(wanted.v).max() > 1e-3


def test_where_the_line_was_not_told_rightly_the_faster_leg_is_still_taken() -> None:
    """Past a singular position of this arm the rates peak between the points of the table: by it both laws would take
    far longer than they do, and the one made for the line is not the faster one."""
    robot, none = five_axis_arm(), np.zeros(5)
    q = np.array([2.3885014066, 0.842975315, 0.4918525939, 0.2750692844, 0.6484080749])
    first = robot.link_motion(robot.links.index("flange"), q, none, none, none)
    goal = Pose(0.0586589005, 0.4100303915, 0.440375948, 1.428700591)

    def left(t: FloatArray) -> Motion:
        x, y, z = first.p.tolist()
        assert first.tilted
        return Motion.still(Pose(x, y, z, float(first.yaw)), np.shape(t)).with_tilt(first.tilt)

    def met(t: FloatArray) -> Motion:
        return Motion.still(goal, np.shape(t)).with_tilt(np.array([-0.7751324364, 0.0762509788]))

    scene, state = cell(go(0.3, 0.0), robot=robot, q=tuple(q.tolist())), State(0.0, q, none, none)
    before = by_the_constant_law(scene, state, 1, left, met)
    leg = straight(scene, 0, state, 1, left, met)
    assert isinstance(before, TimedLeg)
    assert isinstance(leg, TimedLeg)
    assert path(leg).duration <= path(before).duration
