"""What the solver times, written as knots, keeps the robot's own limits at every instant and repeats the solver."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.timing import TimingRefusal
from assur.planner.timing.solver import RAMP_S
from assur.planner.trajectory import Trajectory
from tests.planner.timing.legs import KINDS, ROBOTS, Question, question, time_joints
from tests.planner.trajectory.splines import keeps_limits

WIDE = 1e3


def timed_or_refused(asked: Question, duration: float | None = None, begin: float = 0.0) -> Trajectory | TimingRefusal:
    return time_joints(*asked.args, duration=duration, begin=begin)


def timed(asked: Question, duration: float | None = None, begin: float = 0.0) -> Trajectory:
    found = timed_or_refused(asked, duration, begin)
    assert isinstance(found, Trajectory), found
    return found


def kept(path: Trajectory, asked: Question) -> bool:
    return keeps_limits(path, np.full(4, -WIDE), np.full(4, WIDE), *asked.limits)


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("kind", KINDS)
def test_hardly_a_leg_breaks_a_limit(robot: str, kind: str) -> None:
    """Moves from 1 µm up. 6 of 24,000 did when this was written: they are refused."""
    rng = np.random.default_rng(7)
    asked = [question(rng, robot, kind) for _ in range(300)]
    assert sum(not kept(timed(one, begin=rng.uniform(0, 5)), one) for one in asked) <= 3


@pytest.mark.parametrize("robot", ROBOTS)
def test_hardly_a_leg_of_a_given_duration_breaks_a_limit(robot: str) -> None:
    rng, blocked, broken = np.random.default_rng(8), 0, 0
    for k in range(300):
        asked = question(rng, robot, KINDS[k % 4])
        wanted = timed(asked).duration * rng.choice([1.0, 1.0 + 1e-6, rng.uniform(1, 2)])
        begin = rng.uniform(0, 5)
        path = timed_or_refused(asked, wanted, begin)
        if isinstance(path, TimingRefusal):
            assert path.reason == "blocked"
            blocked += 1
            continue
        assert path.end == begin + wanted
        broken += not kept(path, asked)
    assert blocked < 30
    assert broken <= 3


@pytest.mark.parametrize("kind", KINDS)
def test_knots_begin_and_end_in_the_states_asked_for_to_the_bit(kind: str) -> None:
    rng = np.random.default_rng(9)
    for _ in range(60):
        asked = question(rng, "sharp", kind)
        path = timed(asked, begin=1.25)
        assert path.start == 1.25
        for k, states in ((0, (asked.q0, asked.v0, asked.a0)), (-1, (asked.q1, asked.v1, asked.a1))):
            assert all(map(np.array_equal, (path.q[k], path.qd[k], path.qdd[k]), states))


def test_a_joint_that_would_reach_its_limits_within_microseconds_moves_as_it_is_timed() -> None:
    """Its acceleration is at its limit after 4 µs of the greatest jerk, or its velocity after 0.1 ms."""
    zero, way = np.zeros(2), np.array([0.03, 0.1])
    for velocity, acceleration in ((0.04, 4e-4), (1e-6, 1.0)):
        rates = np.array([velocity, 0.02]), np.array([acceleration, 0.5]), np.array([100.0, 10.0])
        asked = Question(zero, zero, zero, way * (1.0 if velocity > 1e-3 else 1e-3), zero, zero, *rates)
        profile = asked.solver.raw_profile(*asked.states)
        assert not isinstance(profile, TimingRefusal)
        lengths = profile.phases[0, 0]
        assert lengths[lengths > 0.0].min() >= RAMP_S * (1.0 - 1e-9)
        path = timed(asked)
        assert keeps_limits(path, np.full(2, -WIDE), np.full(2, WIDE), *rates)
        t = np.linspace(0.0, path.end, 200)
        motion = np.array([profile.at(x)[0] for x in t.tolist()])
        assert (np.abs(path.evaluate(t) - motion).max(0) <= 1e-4 * asked.q1).all()


def test_a_solver_that_is_asked_again_answers_like_a_new_one_whatever_it_was_asked_before() -> None:
    """Each question between a refused one, one of a given duration, and other states under the same limits."""
    rng = np.random.default_rng(12)
    for k in range(60):
        one = question(rng, ROBOTS[k % 4], KINDS[k // 4 % 4], n=1 + k % 5)
        states, solver = one.states, one.solver
        far = tuple(row.tolist() for row in (one.q1 + 1.0, 0.3 * one.velocity, 0.1 * one.acceleration))
        for _ in range(2):
            solver.shortest(states[0], (far[0], far[1], far[2]))
            assert isinstance(solver.raw_profile(states[0], (far[0], [9e9] * one.n, far[2])), TimingRefusal)
            solver.raw_profile(*states, 1e-6)
            for duration in (None, 9.0):
                again, new = solver.raw_profile(*states, duration), one.solver.raw_profile(*states, duration)
                assert not isinstance(again, TimingRefusal)
                assert not isinstance(new, TimingRefusal)
                assert again.duration == new.duration
                assert np.array_equal(again.phases, new.phases)


def test_a_raw_profile_keeps_its_motion_when_its_solver_is_asked_again() -> None:
    rng = np.random.default_rng(13)
    for kind in KINDS:
        one = question(rng, "problems", kind, least=0.1)
        solver, (start, goal) = one.solver, one.states
        first = solver.raw_profile(start, goal)
        assert not isinstance(first, TimingRefusal)
        before = first.phases.copy()
        solver.raw_profile(goal, start)
        assert np.array_equal(first.phases, before)
