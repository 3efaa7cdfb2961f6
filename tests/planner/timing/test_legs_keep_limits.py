"""What the solver times, written as knots, keeps the robot's own limits at every instant and repeats the solver."""

from __future__ import annotations

import numpy as np
import pytest
import ruckig

from assur.planner.timing import TimingRefusal
from assur.planner.timing.solver import JERK_RESERVE, RAMP_S, RATE_RESERVE, RobotLimits, lowered_limits
from assur.planner.trajectory import Trajectory
from tests.planner.timing.legs import KINDS, ROBOTS, Question, numbers, question, time_joints
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


@pytest.mark.parametrize("kind", KINDS)
def test_the_spline_repeats_the_solvers_cubics(kind: str) -> None:
    """To rounding where no switches share a knot, and to 50 µrad where they do."""
    rng, worst = np.random.default_rng(10), []
    for _ in range(120):
        asked = question(rng, "problems", kind, least=1e-2)
        profile = timed(asked)
        solver, given, found = ruckig.Ruckig(4), ruckig.InputParameter(4), ruckig.Trajectory(4)
        for name, value in zip(("position", "velocity", "acceleration"), asked.start, strict=True):
            setattr(given, f"current_{name}", value.tolist())
        for name, value in zip(("position", "velocity", "acceleration"), asked.goal, strict=True):
            setattr(given, f"target_{name}", value.tolist())
        limits = lowered_limits(*asked.states, RobotLimits(*numbers(asked.limits)))
        assert not isinstance(limits, TimingRefusal)
        given.max_velocity, given.min_velocity = limits.velocity, limits.backward
        given.max_acceleration, given.min_acceleration = limits.acceleration, limits.braking
        given.max_jerk = limits.jerk
        solver.calculate(given, found)
        if abs(found.duration - profile.duration) > 1e-12 or profile.duration < 0.05:
            continue
        path = profile
        t = np.linspace(0, path.end, 200)
        cubics = np.array([found.at_time(x)[0] for x in t.tolist()])
        worst.append(np.abs(path.evaluate(t) - cubics).max())
    assert len(worst) >= 60
    assert np.median(worst) <= 1e-12
    assert max(worst) <= 5e-5


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


def test_the_jerk_of_a_robot_that_needs_longer_is_what_it_was() -> None:
    usual = RobotLimits([1.0], [2.0], [2.0 / RAMP_S]).lowered.jerk
    assert usual == [2.0 / RAMP_S * (1.0 - JERK_RESERVE)]
    assert RobotLimits([1.0], [2.0], [9.0 / RAMP_S]).lowered.jerk == [2.0 * (1.0 - RATE_RESERVE) / RAMP_S]
    assert RobotLimits([1e-6], [2.0], [2.0]).lowered.jerk == [1e-6 * (1.0 - RATE_RESERVE) / RAMP_S**2]


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


def test_the_same_question_gets_the_same_bytes_whatever_was_asked_before() -> None:
    rng = np.random.default_rng(11)
    asked = [question(rng, ROBOTS[k % 4], KINDS[k // 4 % 4], n=1 + k % 5) for k in range(60)]
    first = [timed(one, begin=0.3) for one in asked]
    order = rng.permutation(60)
    for k in order:
        # A refused question in between, one with a duration, one that fails its check.
        timed_or_refused(asked[k - 1], 1e-6)
        timed_or_refused(asked[k - 2], 9.0)
        again = timed(asked[k], begin=0.3)
        for name in ("time", "q", "qd", "qdd"):
            assert np.array_equal(getattr(first[k], name), getattr(again, name))
