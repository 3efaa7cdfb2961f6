"""What the solver times, written as knots, keeps the robot's own limits at every instant and repeats the solver."""

from __future__ import annotations

import numpy as np
import pytest
import ruckig

from assur.planner.timing import Profile, Settled, Sketch, TimingRefusal, time_joints, to_trajectory
from assur.planner.timing.question import Allowed, lowered_limits
from assur.planner.trajectory import check_limits, keeps_limits
from tests.planner.timing.legs import MANNERS, ROBOTS, Question, numbers, question

WIDE = 1e3


def timed_or_refused(asked: Question, duration: float | None = None) -> Profile | TimingRefusal:
    return time_joints(*asked.args, duration=duration)


def timed(asked: Question, duration: float | None = None) -> Profile:
    found = timed_or_refused(asked, duration)
    assert isinstance(found, Profile), found
    return found


@pytest.mark.parametrize("robot", ROBOTS)
@pytest.mark.parametrize("manner", MANNERS)
def test_no_leg_breaks_a_limit(robot: str, manner: str) -> None:
    """No failure in 300 motions of each kind, moves from 1 µm up; none in 1,500 of each when this was written."""
    rng = np.random.default_rng(7)
    for _ in range(300):
        asked = question(rng, robot, manner)
        profile = timed(asked)
        path = to_trajectory(profile, start_time=rng.uniform(0, 5))
        limits = (np.full(4, -WIDE), np.full(4, WIDE), *asked.limits)
        assert keeps_limits(path, *limits), (asked, check_limits(path, *limits))


@pytest.mark.parametrize("robot", ROBOTS)
def test_no_leg_of_a_given_duration_breaks_a_limit(robot: str) -> None:
    rng, blocked = np.random.default_rng(8), 0
    for k in range(300):
        asked = question(rng, robot, MANNERS[k % 4])
        wanted = timed(asked).duration * rng.choice([1.0, 1.0 + 1e-6, rng.uniform(1, 2)])
        profile = time_joints(*asked.args, duration=wanted)
        if isinstance(profile, TimingRefusal):
            assert profile.reason == "blocked"
            blocked += 1
            continue
        assert profile.duration == wanted
        path = to_trajectory(profile, start_time=rng.uniform(0, 5))
        limits = (np.full(4, -WIDE), np.full(4, WIDE), *asked.limits)
        assert keeps_limits(path, *limits), (asked, check_limits(path, *limits))
    assert blocked < 30


@pytest.mark.parametrize("manner", MANNERS)
def test_knots_begin_and_end_in_the_states_asked_for_to_the_bit(manner: str) -> None:
    rng = np.random.default_rng(9)
    for _ in range(60):
        asked = question(rng, "sharp", manner)
        time, q, qd, qdd = timed(asked).knots(1.25)
        assert time[0] == 1.25
        for k, states in ((0, (asked.q0, asked.v0, asked.a0)), (-1, (asked.q1, asked.v1, asked.a1))):
            assert all(map(np.array_equal, (q[k], qd[k], qdd[k]), states))


@pytest.mark.parametrize("manner", MANNERS)
def test_the_spline_repeats_the_solvers_cubics(manner: str) -> None:
    """To 1e-9 rad where the solver itself ends that well; its own error at the end otherwise."""
    rng, worst = np.random.default_rng(10), []
    for _ in range(120):
        asked = question(rng, "problems", manner, least=1e-2)
        profile = timed(asked)
        solver, given, found = ruckig.Ruckig(4), ruckig.InputParameter(4), ruckig.Trajectory(4)
        for name, value in zip(("position", "velocity", "acceleration"), asked.start, strict=True):
            setattr(given, f"current_{name}", value.tolist())
        for name, value in zip(("position", "velocity", "acceleration"), asked.goal, strict=True):
            setattr(given, f"target_{name}", value.tolist())
        limits = lowered_limits(*asked.states, Allowed(*numbers(asked.limits)))
        assert not isinstance(limits, TimingRefusal)
        given.max_velocity, given.min_velocity = limits.velocity, limits.backward
        given.max_acceleration, given.min_acceleration = limits.acceleration, limits.braking
        given.max_jerk = limits.jerk
        solver.calculate(given, found)
        if abs(found.duration - profile.duration) > 1e-12 or profile.duration < 0.05:
            continue
        path = to_trajectory(profile)
        t = np.linspace(0, path.end, 200)
        cubics = np.array([found.at_time(x)[0] for x in t.tolist()])
        missed = np.abs(np.array(found.at_time(found.duration)[0]) - asked.q1).max()
        worst.append(np.abs(path.evaluate(t) - cubics).max() - missed)
        assert np.abs(profile.evaluate(t) - path.evaluate(t)).max() <= 1e-9
    assert len(worst) >= 60
    assert max(worst) <= 1e-9


def test_a_solver_that_is_asked_again_answers_like_a_new_one_whatever_it_was_asked_before() -> None:
    """Each question between a refused one, one of a given duration, and other states under the same limits."""
    rng, settled = np.random.default_rng(12), 0
    for k in range(60):
        one = question(rng, ROBOTS[k % 4], MANNERS[k // 4 % 4], n=1 + k % 5)
        states, solver = one.states, one.solver
        far = tuple(row.tolist() for row in (one.q1 + 1.0, 0.3 * one.velocity, 0.1 * one.acceleration))
        for _ in range(2):
            solver.shortest(states[0], (far[0], far[1], far[2]))
            assert isinstance(solver.sketch(states[0], (far[0], [9e9] * one.n, far[2])), TimingRefusal)
            solver.sketch(*states, 1e-6)
            for duration in (None, 9.0):
                again, new = solver.sketch(*states, duration), one.solver.sketch(*states, duration)
                assert not isinstance(again, TimingRefusal)
                assert not isinstance(new, TimingRefusal)
                t = np.linspace(0, new.duration, 50)
                assert np.array_equal(again.positions(t), new.positions(t))
                assert all(map(np.array_equal, again.profile.knots(0.3), new.profile.knots(0.3)))
                settled += isinstance(new, Settled)
    assert settled > 0


def test_a_sketch_keeps_its_motion_when_its_solver_is_asked_again() -> None:
    rng = np.random.default_rng(13)
    for manner in MANNERS:
        one = question(rng, "problems", manner, least=0.1)
        solver, (start, goal) = one.solver, one.states
        first = solver.sketch(start, goal)
        assert isinstance(first, Sketch)
        t = np.linspace(0, first.duration, 50)
        before = first.positions(t)
        solver.sketch(goal, start)
        assert np.array_equal(first.positions(t), before)
        assert np.abs(first.profile.evaluate(t) - before).max() <= 1e-5


def test_the_same_question_gets_the_same_bytes_whatever_was_asked_before() -> None:
    rng = np.random.default_rng(11)
    asked = [question(rng, ROBOTS[k % 4], MANNERS[k // 4 % 4], n=1 + k % 5) for k in range(60)]
    first = [timed(one).knots(0.3) for one in asked]
    order = rng.permutation(60)
    for k in order:
        # A refused question in between, one with a duration, one that fails its check.
        timed_or_refused(asked[k - 1], 1e-6)
        timed_or_refused(asked[k - 2], 9.0)
        again = timed(asked[k]).knots(0.3)
        assert all(map(np.array_equal, first[k], again))
