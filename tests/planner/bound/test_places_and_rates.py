"""What the lower bound of a duration rests on: all joint positions at a place, states of guided joints, and rates."""

from __future__ import annotations

import math

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.bound.events import LEAST_MARGIN, Unplaced, allowed_modes, climbs, places, rate_bounds
from assur.planner.bound.fastest import STATE
from assur.planner.bound.guided import BOUNDED, DYAD, NOWHERE, UNKNOWN, guided_joints
from assur.planner.frames.motion import Motion, Pose
from assur.planner.laws import (
    Law,
    conveyor,
    fixed,
    indexer,
    keyframes,
    linear,
    oscillation,
    swing,
    turntable,
)
from assur.planner.laws.ramps import Change
from assur.planner.robots.facts import Code
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara
from tests.planner.robots.families import NAMES, flange_of, random_q, robot_named, scara
from tests.planner.robots.five_bars import five_bar

EVERY: list[Robot] = [*(robot_named(name) for name in NAMES), five_bar("even"), five_bar("even", axes=2)]
PLANAR: list[Robot] = [scara(base=Pose(0.1, -0.2, 0.1, 0.7)), scara(3), five_bar("even"), five_bar("even", axes=3)]
DIAL = turntable(Pose(0.1, 0.2, 0.3, 0.4), 0.8, 0.05, (Change(0.5, 2.0, 3.0, 20.0), Change(2.5, -0.4, 5.0, 100.0)))
BELT = conveyor(Pose(0.1, 0.2, 0.3, 0.4), 0.3, (Change(0.5, 0.0, 1.0, 8.0), Change(1.5, 0.4, 2.0, 30.0)))
POINTS = tuple(Pose(0.1 * k, 0.05 * k * k, 0.2 + 0.01 * k, 0.3 * k) for k in range(5))
LAWS: dict[str, Law] = {
    "fixed": fixed(Pose(1.0, 2.0)),
    "linear": linear(Pose(), (0.3, -0.2, 0.1)),
    "belt": BELT,
    "steady belt": conveyor(Pose(), -0.25),
    "dial": DIAL,
    "steady dial": turntable(Pose(), 7.0),
    "swing": swing(Pose(), 0.4, 1.3, 0.2),
    "oscillation": oscillation(Pose(), (1.0, 2.0, 0.5), 0.1, 0.8),
    "indexer": indexer(Pose(), 0.7, 0.4, 0.3),
    "travelling indexer": indexer(Pose(yaw=1.0), 0.1, 0.3, 0.1, kind="travel"),
    "keyframes": keyframes((0.0, 0.5, 1.2, 2.0, 3.0), POINTS),
    "periodic keyframes": keyframes((0.0, 0.5, 1.2, 2.0, 3.0), (*POINTS[:4], POINTS[0]), ends="periodic"),
}


def row(robot: Robot, motion: Motion, k: int) -> tuple[float, ...]:
    tilt = motion.tilt[k].tolist() if motion.tilted else (math.nan, math.nan)
    return (*motion.p[k].tolist(), float(motion.yaw[k]), *tilt)


def in_mode(robot: Robot, mode: int, at: tuple[float, ...]) -> FloatArray:
    """The joint positions of one working mode; none where it has none."""
    try:
        return places(robot, (mode,), *at)
    except Unplaced:
        return np.zeros((0, len(robot.joints)))


@pytest.mark.parametrize("robot", EVERY, ids=lambda robot: f"{robot.name}-{len(robot.joints)}")
def test_every_joint_position_at_a_place_is_among_those_that_are_found(robot: Robot) -> None:
    """Where it came from is one of them, and so is every other one of the planner's inverse."""
    rng = np.random.default_rng(3)
    q = random_q(robot, rng, 100)
    none = np.zeros_like(q)
    motion = robot.link_motion(flange_of(robot), q, none, none, none)
    turning = np.array([joint.kind == "revolute" for joint in robot.joints])
    others = [robot.inverse(motion, mode, 0) for mode in range(len(robot.modes))]
    for k in range(len(q)):
        found = np.concatenate([in_mode(robot, mode, row(robot, motion, k)) for mode in range(len(robot.modes))])
        wanted = [q[k], *(other.q[k] for other in others if other.code[k] == Code.ASSEMBLED)]
        for one in wanted:
            if not robot.within(one):
                continue
            off = np.abs(found - one)
            turned = np.where(turning, np.abs((off + math.pi) % math.tau - math.pi), off)
            same = np.where(np.isnan(found), 0.0, turned).max(axis=1).min()
            assert same < 1e-6
        # and each that is found is at the place
        back = robot.forward(np.nan_to_num(found))[0]
        exact = ~np.isnan(found).any(axis=1)
        if isinstance(robot, FiveBar):
            continue  # both assembly modes are among them, and this arm is in one
        np.testing.assert_allclose(back[exact], np.broadcast_to(motion.p[k], back[exact].shape), atol=1e-9)


def test_whole_turns_within_the_range_are_all_found_and_no_others() -> None:
    robot = robot_named(NAMES[0])
    q = random_q(robot, np.random.default_rng(1), 1)
    none = np.zeros_like(q)
    motion = robot.link_motion(flange_of(robot), q, none, none, none)
    found = places(robot, tuple(range(len(robot.modes))), *row(robot, motion, 0))
    assert (found >= robot.limits.lower - 1e-6).all()
    assert (found <= robot.limits.upper + 1e-6).all()
    wide = scara(base=Pose())
    reach = places(wide, (0, 1), 0.3, 0.2, 0.2, 0.1, math.nan, math.nan)
    low, high = wide.limits.lower, wide.limits.upper
    wrists = {round(x, 9) for x in reach[:, 3].tolist()}
    expected = {
        round(first + turn * math.tau, 9)
        for first in reach[:, 3].tolist()
        for turn in range(-4, 5)
        if low[3] <= first + turn * math.tau <= high[3]
    }
    assert wrists == expected


def test_what_is_not_known_near_a_singularity_is_not_claimed_and_out_of_reach_is_no_place() -> None:
    robot = scara(base=Pose())
    far = robot.l1 + robot.l2
    with pytest.raises(Unplaced):
        places(robot, (0, 1), far + 1e-6, 0.0, 0.2, 0.0, math.nan, math.nan)
    near = places(robot, (0, 1), far * (1.0 - LEAST_MARGIN**2 / 10.0), 0.0, 0.2, 0.0, math.nan, math.nan)
    assert np.isnan(near[:, [0, 1, 3]]).all()
    assert not np.isnan(near[:, 2]).any()


def test_the_working_modes_that_are_asked_for() -> None:
    robot = scara(base=Pose())
    left, right = np.array([0.3, -1.0, 0.2, 0.0]), np.array([0.3, 1.0, 0.2, 0.0])
    assert allowed_modes(robot, "keep", left) == (0,)
    assert allowed_modes(robot, "keep", right) == (1,)
    assert allowed_modes(robot, "left", right) == (0,)
    assert allowed_modes(robot, "auto", right) == (0, 1)


@pytest.mark.parametrize("robot", PLANAR, ids=lambda robot: f"{robot.name}-{len(robot.joints)}")
@pytest.mark.parametrize("before", [0.0, 1e-3, 0.05, 0.3])
def test_guided_joints_are_those_of_the_inverse_and_keep_to_their_bounds(robot: Scara | FiveBar, before: float) -> None:
    rng, n = np.random.default_rng(5), len(robot.joints)
    arm, work, seen = robot.row, np.zeros(2 * DYAD), {BOUNDED: 0, UNKNOWN: 0, NOWHERE: 0}
    for _ in range(60):
        (x, y), (u, v) = rng.uniform(-0.5, 0.5, 2).tolist(), rng.uniform(-0.4, 0.4, 2).tolist()
        law, pose = (
            turntable(Pose(x + robot.base.x, y + robot.base.y, 0.2), float(rng.uniform(-3.0, 3.0))),
            Pose(u, v, 0.0, 0.3),
        )
        t = np.linspace(0.0, before, 41)
        motion = law.motion(t).at(pose)
        bounds_of_point = rate_bounds(law, math.hypot(pose.x, pose.y), t[:1], t[-1:])[0]
        point = np.array([[*each[-1], yaw[-1]] for each, yaw in zip(*_orders(motion), strict=True)])
        for mode in range(len(robot.modes)):
            state, bounds = np.zeros((STATE, n)), np.zeros((3, n))
            code = guided_joints(arm, mode, point, bounds_of_point, before, state, bounds, work)
            seen[code] += 1
            inverse = robot.inverse(motion, mode)
            if code == NOWHERE:
                assert np.isnan(inverse.q).any(axis=1).all()
                continue
            if code == UNKNOWN or (isinstance(robot, FiveBar) and not (inverse.code == Code.ASSEMBLED).all()):
                continue
            off = state[0] - inverse.q[-1]
            turning = np.array([joint.kind == "revolute" for joint in robot.joints])
            off = np.where(turning, (off + math.pi) % math.tau - math.pi, off)
            np.testing.assert_allclose(off, 0.0, atol=1e-8)
            np.testing.assert_allclose(state[1], inverse.qd[-1], atol=1e-8)
            np.testing.assert_allclose(state[2], inverse.qdd[-1], atol=1e-6, rtol=1e-8)
            for order, reached in enumerate((inverse.qd, inverse.qdd, inverse.qddd)):
                assert (np.abs(reached).max(axis=0) <= bounds[order] * (1.0 + 1e-9) + 1e-9).all()
    assert seen[BOUNDED] > 10


def _orders(motion: Motion) -> tuple[tuple[np.ndarray, ...], tuple[np.ndarray, ...]]:
    return (motion.p, motion.v, motion.a, motion.j), (motion.yaw, motion.yaw_d, motion.yaw_dd, motion.yaw_ddd)


@pytest.mark.parametrize("name", sorted(LAWS))
def test_no_point_of_a_frame_is_faster_than_the_bounds_of_its_law(name: str) -> None:
    law, rng = LAWS[name], np.random.default_rng(7)
    most = np.zeros(9)
    for _ in range(40):
        begin = float(rng.uniform(max(law.valid[0], 0.0), 2.5))
        end = min(begin + float(rng.choice([1e-3, 0.05, 0.5])), law.valid[1])
        offset = Pose(*rng.uniform(-0.5, 0.5, 2).tolist())
        found = rate_bounds(law, math.hypot(offset.x, offset.y), np.array([begin]), np.array([end]))[0]
        motion = law.motion(np.linspace(begin, end, 200)).at(offset)
        reached = [np.linalg.norm(each[:, :2], axis=1).max() for each in (motion.v, motion.a, motion.j)]
        reached += [np.abs(each[:, 2]).max() for each in (motion.v, motion.a, motion.j)]
        reached += [np.abs(each).max() for each in (motion.yaw_d, motion.yaw_dd, motion.yaw_ddd)]
        assert (np.array(reached) <= found * (1.0 + 1e-9) + 1e-12).all()
        most = np.maximum(most, found)
        assert climbs(law) or reached[3] == 0.0
    assert (most[0] > 0.0) == (name != "fixed")


def test_a_jump_of_the_acceleration_has_no_bound_of_the_jerk_while_it_may_happen() -> None:
    law = conveyor(Pose(), 0.2, (Change(1.0, 0.0, 2.0, math.inf),))
    begin, end = np.array([0.0, 0.95, 1.05, 2.0]), np.array([0.5, 1.02, 1.15, 2.5])
    assert np.isinf(rate_bounds(law, 0.0, begin, end)[:, 2]).tolist() == [False, True, True, False]
