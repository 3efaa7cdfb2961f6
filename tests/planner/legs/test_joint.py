"""Joint legs: they meet a branch in its exact state at a time of its grid, within all limits, flying by their vias."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from assur.planner.frames.motion import Pose
from assur.planner.laws import Law, conveyor, indexer, swing, turntable
from assur.planner.legs.control_point import control_point
from assur.planner.legs.joint import JointMotion, Shape, Via
from assur.planner.legs.meeting import meetings
from assur.planner.legs.missed import ArchForm
from assur.planner.legs.state import Branch, Knots, State
from assur.planner.model.attachments import AT_START
from assur.planner.model.outcome import LegKind, Planned
from assur.planner.model.refusal import Reason, Refusal
from assur.planner.model.scene import Scene, Window
from assur.planner.pipeline import plan
from assur.planner.timing import SHORTEST, Solver
from assur.planner.trajectory import Trajectory
from tests.planner.cells import amount_of, cell, frame, go, limits, unit_of
from tests.planner.trajectory.splines import keeps_limits

NONE = np.zeros(4)
LIMITS = limits()
LAWS: dict[str, Law] = {
    "conveyor": conveyor(Pose(-0.2, 0.35, 0.1), 0.2),
    "turntable": turntable(Pose(0.35, 0.1, 0.1), 1.2),
    "swing": swing(Pose(0.3, -0.1, 0.1), 0.7, 1.3),
}


def scene_on(law: Law, **options: Any) -> Scene:
    where = Pose(0.08, 0.0, 0.02, 0.4) if law.kind != "conveyor" else Pose(0.0, 0.0, 0.02, 0.4)
    return cell(
        go(where.x, where.y, where.z, where.yaw, "moving", **options),
        frames=(frame("moving", law),),
    )


def branches(scene: Scene, state: State) -> tuple[Branch, ...]:
    point = control_point(scene, 0, AT_START, 0.0)
    found = meetings(scene, point, state.time, 0.0, (0, 1)).branches
    assert found
    return found


def state(rng: np.random.Generator, moving: float = 0.0) -> State:
    q = rng.uniform(0.6 * LIMITS.lower, 0.6 * LIMITS.upper)
    q[2] = rng.uniform(0.1, 0.2)
    qd = moving * rng.uniform(-1, 1, 4) * LIMITS.velocity
    return State(float(rng.uniform(-1, 2)), q, qd, NONE)


def shape(rng: np.random.Generator, kind: str) -> Shape:
    def via() -> Via:
        q = rng.uniform(0.7 * LIMITS.lower, 0.7 * LIMITS.upper) + np.array([0, 0, 0.12, 0])
        return Via(q.tolist(), float(rng.random()))

    vias = tuple(via() for _ in range({"1 via": 1, "2 vias": 2}.get(kind, 0)))
    form = ArchForm(0.25, float(rng.random()), float(rng.random())) if kind == "arch" else None
    wait = float(rng.random()) if kind == "wait" else 0.0
    late = float(rng.random()) if kind == "late" else 0.0
    return Shape(wait, late, vias, form, effort=float(rng.choice([1.0, 0.7, 0.4])))


KINDS = st.sampled_from(["direct", "1 via", "2 vias", "arch", "wait", "late"])


def check_leg(scene: Scene, begin: State, branch: Branch, found: Trajectory, how: Shape) -> None:
    """All that a joint leg promises."""
    knots = Knots.of(found)
    assert np.array_equal(knots.q[0], begin.q)
    assert np.array_equal(knots.qd[0], begin.qd)
    assert knots.time[0] == begin.time + how.wait
    last = knots.last
    assert last.time == found.end
    row = 0 if branch.still else int(np.abs(branch.time - found.end).argmin())
    assert branch.still or found.end == branch.time[row]
    for have, asked in ((last.q, branch.q), (last.qd, branch.qd), (last.qdd, branch.qdd)):
        assert np.abs(have - asked[row]).max() <= 1e-9
    trajectory, wide = found, np.full(4, 99.0)
    assert keeps_limits(trajectory, -wide, wide, LIMITS.velocity, LIMITS.acceleration, LIMITS.jerk)
    # the flange by forward kinematics, against the law: no inverse kinematics
    p, yaw = scene.robot.forward(trajectory.evaluate(np.array(found.end)))
    target = scene.task[0].target
    assert target is not None
    wanted = scene.frames[target.frame].law.motion(np.array(found.end)).at(target.pose)
    assert np.abs(p - wanted.p).max() <= 1e-9
    assert abs(math.remainder(float(yaw - wanted.yaw), 2 * math.pi)) <= 1e-9


@settings(max_examples=80)
@given(st.integers(0, 10**6), st.sampled_from(sorted(LAWS)), KINDS, st.booleans())
def test_a_leg_to_a_moving_point_meets_its_state_at_a_grid_time_within_all_limits(
    seed: int, law: str, kind: str, moving: bool
) -> None:
    rng = np.random.default_rng(seed)
    begin = state(rng, 0.2 if moving and kind != "wait" else 0.0)
    scene = scene_on(LAWS[law])
    for branch in branches(scene, begin)[:3]:
        how = shape(rng, kind)
        if moving and how.effort < 1:
            how = replace(how, effort=1.0)
        found = JointMotion(scene, 0, begin, how, branch).meet()
        if isinstance(found, Refusal):
            assert found.reason in (Reason.WINDOW_MISSED, Reason.MOTION_LIMIT, Reason.JOINT_LIMIT)
            continue
        check_leg(scene, begin, branch, found, how)


@given(st.integers(0, 10**6), st.sampled_from(sorted(LAWS)))
def test_no_earlier_time_of_the_grid_could_have_been_met_directly(seed: int, law: str) -> None:
    """Rendezvous: the earliest T whose shortest duration is no more than T, to within three steps of the grid."""
    begin = state(np.random.default_rng(seed))
    scene = scene_on(LAWS[law])
    branch = branches(scene, begin)[0]
    found = JointMotion(scene, 0, begin, Shape(), branch).meet()
    # towards a moving end a joint may overshoot its range
    assume(isinstance(found, Trajectory) or found.reason is not Reason.JOINT_LIMIT)
    assert isinstance(found, Trajectory)
    solver = Solver(LIMITS.velocity.tolist(), LIMITS.acceleration.tolist(), LIMITS.jerk.tolist())
    start = begin.q.tolist(), begin.qd.tolist(), begin.qdd.tolist()
    grid = float(np.diff(branch.time).max())
    earlier = np.flatnonzero(branch.time < found.end - 3.5 * grid).tolist()
    for i in earlier[:: max(1, len(earlier) // 40)]:
        least = solver.shortest(start, (branch.q[i].tolist(), branch.qd[i].tolist(), branch.qdd[i].tolist()))
        if isinstance(least, float) and begin.time + least <= branch.time[i]:
            # it was possible to be there sooner only if no motion of exactly that time exists (blocked)
            only = replace(branch, table=branch.table[i : i + 1], numbers=branch.numbers[i : i + 1])
            exact = JointMotion(scene, 0, begin, Shape(), only).meet()
            assert isinstance(exact, Refusal), (branch.time[i], found.end)


def test_vias_are_flown_by_with_a_velocity() -> None:
    begin = State(0.0, np.array([-0.8, 1.0, 0.1, 0.0]), NONE, NONE)
    scene = cell(go(0.35, 0.3, 0.12))
    branch = branches(scene, begin)[0]
    via = Via([0.1, 0.9, 0.22, 0.4], 0.8)
    found = JointMotion(scene, 0, begin, Shape(vias=(via,)), branch).meet()
    assert isinstance(found, Trajectory)
    path = found
    passed = int(np.flatnonzero((path.q == via.q).all(1))[0])
    assert np.abs(path.qd[passed]).max() > 0.3
    stopping = JointMotion(scene, 0, begin, Shape(vias=(Via(via.q, 0.0),)), branch).meet()
    assert isinstance(stopping, Trajectory)
    stopped = int(np.flatnonzero((stopping.q == via.q).all(1))[0])
    assert not stopping.qd[stopped].any()


def test_a_control_point_that_is_a_via_is_passed_towards_what_is_ahead() -> None:
    begin = State(0.0, np.array([-0.8, 1.0, 0.1, 0.0]), NONE, NONE)
    scene = cell(go(0.35, 0.1, 0.12, via=True), go(0.2, 0.4, 0.12, name="next"))
    branch = branches(scene, begin)[0]
    ahead = branch.q[0] + np.array([0.5, 0.1, 0.0, 0.0])
    found = JointMotion(scene, 0, begin, Shape(through=0.7), branch, ahead).meet()
    assert isinstance(found, Trajectory)
    last = Knots.of(found).last
    assert np.abs(last.q - branch.q[0]).max() <= 1e-9
    assert last.qd[0] > 0.1
    standing = JointMotion(scene, 0, begin, Shape(through=0.0), branch, ahead).meet()
    assert isinstance(standing, Trajectory)
    assert Knots.of(standing).last.resting


def test_a_later_meeting_is_later_and_a_wait_is_waited() -> None:
    begin = State(0.5, np.array([-0.8, 1.0, 0.1, 0.0]), NONE, NONE)
    scene = scene_on(LAWS["turntable"])
    branch = branches(scene, begin)[0]
    first, late, waited = (
        JointMotion(scene, 0, begin, how, branch).meet() for how in (Shape(), Shape(late=0.3), Shape(wait=0.4))
    )
    assert isinstance(first, Trajectory)
    assert isinstance(late, Trajectory)
    assert isinstance(waited, Trajectory)
    assert late.end >= first.end + 0.3
    assert waited.start == 0.9
    assert np.array_equal(waited.q[0], begin.q)


def test_steps_to_one_point_of_an_indexer_that_hardly_stands_are_planned() -> None:
    """The arm has the state of the point already when the next leg begins, at rest but for rounding."""
    steps = [go(0.02, 0.0, 0.05, 0.0, "dial", name=name) for name in ("once", "again", "at last")]
    dial = indexer(Pose(0.4, 0.0, 0.05), math.radians(1.0), 0.002, 0.0)
    outcome = plan(cell(*steps, frames=(frame("dial", dial),), max_candidates=20))
    assert isinstance(outcome, Planned)
    moves = [leg for leg in outcome.plan.legs if leg.kind is LegKind.MOVE]
    assert all(leg.t1 - leg.t0 >= SHORTEST for leg in moves)


def test_less_effort_takes_longer_and_uses_less() -> None:
    begin = State(0.0, np.array([-0.8, 1.0, 0.1, 0.0]), NONE, NONE)
    scene = cell(go(0.35, 0.3, 0.12))
    branch = branches(scene, begin)[0]
    legs = [JointMotion(scene, 0, begin, Shape(effort=share), branch).meet() for share in (1.0, 0.25)]
    assert all(isinstance(leg, Trajectory) for leg in legs)
    peak = [leg.extrema(2) for leg in legs]  # type: ignore[union-attr]
    assert legs[1].end >= 1.9 * legs[0].end  # type: ignore[union-attr]
    assert max(np.abs(x / LIMITS.acceleration).max() for x in peak[1]) <= 0.25 + 1e-9


def test_a_window_that_is_too_early_is_missed_with_seconds() -> None:
    begin = State(0.0, np.array([-0.8, 1.0, 0.1, 0.0]), NONE, NONE)
    scene = scene_on(LAWS["turntable"], window=Window(time=(0.0, 0.1)))
    found = JointMotion(scene, 0, begin, Shape(), branches(scene, begin)[0]).meet()
    assert isinstance(found, Refusal)
    assert found.reason is Reason.WINDOW_MISSED
    assert unit_of(found) == "s"
    assert amount_of(found) > 0.01


@pytest.mark.parametrize("pace", [0.0, 0.5, 5.0])
def test_no_via_is_passed_faster_than_the_joints_allow(pace: float) -> None:
    begin = State(0.0, np.array([-2.0, 1.0, 0.1, 0.0]), NONE, NONE)
    scene = cell(go(0.2, 0.45, 0.12))
    branch = branches(scene, begin)[0]
    how = Shape(vias=(Via([-0.3, 0.9, 0.22, 0.4], pace),))
    found = JointMotion(scene, 0, begin, how, branch).meet()
    if isinstance(found, Trajectory):
        check_leg(scene, begin, branch, found, how)
