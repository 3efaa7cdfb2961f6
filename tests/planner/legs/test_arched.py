"""Arches: up, over and down, overlapped at the corners, within every limit at every instant."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.legs.line import ScaledLimits
from assur.planner.legs.missed import ArchForm, arch
from assur.planner.timing import RawProfile, TimingRefusal, trajectory_of
from assur.planner.trajectory import Trajectory
from tests.planner.cells import limits
from tests.planner.timing.legs import Floats, numbers, time_joints
from tests.planner.trajectory.splines import keeps_limits

LIFT = 2
LIMITS = limits()
RATES = (LIMITS.velocity, LIMITS.acceleration, LIMITS.jerk)
NONE = np.zeros(4)
JointState = tuple[Floats, Floats, Floats]
"""q, q̇, q̈, each (n,)."""


def state(rng: np.random.Generator, speed: float = 0.0) -> JointState:
    """Low down, at rest or in motion (the lift joint at rest)."""
    q = rng.uniform(LIMITS.lower, LIMITS.upper)
    q[LIFT] = rng.uniform(0.05, 0.12)
    qd = speed * rng.uniform(-1, 1, 4) * LIMITS.velocity
    qdd = speed * rng.uniform(-1, 1, 4) * LIMITS.acceleration
    qd[LIFT] = qdd[LIFT] = 0.0
    return q, qd, qdd


def over(
    start: JointState, goal: JointState, form: ArchForm, duration: float | None = None
) -> RawProfile | TimingRefusal:
    return arch(numbers(start), numbers(goal), form, ScaledLimits(LIMITS, LIFT), duration)


def made(start: JointState, goal: JointState, form: ArchForm, duration: float | None = None) -> RawProfile:
    found = over(start, goal, form, duration)
    assert isinstance(found, RawProfile), found
    return found


def parts(start: JointState, goal: JointState, top: float) -> tuple[float, float, float]:
    """Durations of going up, across and down alone."""
    found = []
    lift, across = [LIFT], [0, 1, 3]
    high = (np.array([top]), np.zeros(1), np.zeros(1))
    for a, b, joints in (
        (tuple(x[lift] for x in start), high, lift),
        (tuple(x[across] for x in start), tuple(x[across] for x in goal), across),
        (high, tuple(x[lift] for x in goal), lift),
    ):
        profile = time_joints(*a, *b, *(rate[joints] for rate in RATES))
        assert isinstance(profile, Trajectory)
        found.append(profile.duration)
    return found[0], found[1], found[2]


def path(arched: RawProfile, begin: float = 0.0) -> Trajectory:
    return trajectory_of([arched], [begin, begin + arched.duration])


def keeps(trajectory: Trajectory) -> bool:
    return keeps_limits(trajectory, np.full(4, -50.0), np.full(4, 50.0), *RATES)


SHARES = st.sampled_from([0.0, 0.2, 0.5, 0.9, 1.0])


@given(st.integers(0, 10**6), SHARES, SHARES)
def test_an_overlapped_arch_takes_no_longer_than_its_parts_and_no_less_than_the_longest(
    seed: int, rise: float, fall: float
) -> None:
    rng = np.random.default_rng(seed)
    start, goal, top = state(rng), state(rng), float(rng.uniform(0.15, 0.25))
    up, across, down = parts(start, goal, top)
    found = made(start, goal, ArchForm(top, rise, fall))
    assert max(up + down, across) - 1e-9 <= found.duration <= up + across + down + 1e-9
    if rise == fall == 1.0:
        assert found.duration == pytest.approx(up + across + down, abs=1e-9)
    assert made(start, goal, ArchForm(top, 0.0, 0.0)).duration == pytest.approx(max(up + down, across), abs=1e-9)


@given(st.integers(0, 10**6), SHARES, SHARES)
def test_an_arch_keeps_every_limit_by_exact_extrema_and_goes_over_its_top(seed: int, rise: float, fall: float) -> None:
    rng = np.random.default_rng(seed)
    start, goal, top = state(rng), state(rng), float(rng.uniform(0.15, 0.25))
    found = made(start, goal, ArchForm(top, rise, fall))
    trajectory = path(found, 3.0)
    assert keeps(trajectory)
    low, high = trajectory.extrema(0)
    assert high[LIFT] == pytest.approx(top, abs=1e-5)
    assert low[LIFT] >= min(start[0][LIFT], goal[0][LIFT]) - 1e-6
    assert trajectory.start == 3.0
    assert trajectory.duration == pytest.approx(found.duration, abs=1e-12)


def corner(arched: RawProfile) -> FloatArray:
    """How high the lift joint is when the others set out, and when they arrive."""
    t = np.linspace(0.0, arched.duration, 4001)
    q = path(arched).evaluate(t)
    moving = (np.abs(q[:, [0, 1, 3]] - q[0, [0, 1, 3]]).max(1) > 1e-6) & (
        np.abs(q[:, [0, 1, 3]] - q[-1, [0, 1, 3]]).max(1) > 1e-6
    )
    rows = np.flatnonzero(moving)
    return np.asarray(q[[rows[0], rows[-1]], LIFT])


def test_without_overlap_the_others_move_only_at_the_top_and_with_it_earlier() -> None:
    start = (np.array([-0.8, 1.0, 0.08, 0.0]), NONE, NONE)
    goal = (np.array([0.8, 1.2, 0.08, 0.5]), NONE, NONE)
    assert corner(made(start, goal, ArchForm(0.2, 1.0, 1.0))) == pytest.approx([0.2, 0.2], abs=1e-3)
    half = corner(made(start, goal, ArchForm(0.2, 0.5, 0.5)))
    assert (half > 0.09).all()
    assert (half < 0.19).all()


@settings(max_examples=80)
@given(st.integers(0, 10**6), SHARES, SHARES, st.sampled_from([0.0, 5e-6, 9e-6, 1.1e-5, 1e-4, 0.003, 0.1]))
def test_an_arch_to_a_moving_end_takes_the_time_it_is_given_within_all_limits(
    seed: int, rise: float, fall: float, more: float
) -> None:
    rng = np.random.default_rng(seed)
    start, goal = state(rng), state(rng, 0.3)
    form = ArchForm(0.22, rise, fall)
    first = over(start, goal, form)
    if isinstance(first, TimingRefusal):
        return
    found = over(start, goal, form, first.duration + more)
    if isinstance(found, TimingRefusal):  # a duration may be blocked; the search then asks for another
        assert found.reason in ("blocked", "too short")
        return
    assert found.duration == pytest.approx(first.duration + more, abs=1e-12)
    assert keeps(path(found))


def test_an_arch_in_less_time_than_it_takes_is_refused_with_the_seconds_that_are_missing() -> None:
    rng = np.random.default_rng(1)
    start, goal = state(rng), state(rng)
    whole = made(start, goal, ArchForm(0.22, 0.5, 0.5)).duration
    found = over(start, goal, ArchForm(0.22, 0.5, 0.5), whole - 0.01)
    assert isinstance(found, TimingRefusal)
    assert found.excess == pytest.approx(0.01, abs=1e-9)


@pytest.mark.parametrize("more", [0.0, 5e-4, 0.02, 1.0, 9_999.0])
def test_an_arch_rests_at_its_top_to_the_bit_however_long(more: float) -> None:
    """The others set out some microseconds before or after a switch of the lift joint, so they share a knot."""
    start = (np.array([-0.8, 1.0, 0.08, 0.0]), NONE, NONE)
    goal = (np.array([0.8, 1.2, 0.09, 0.5]), NONE, NONE)
    for k in range(12):
        top = 0.2 + 1e-4 * k
        up, across, down = parts(start, goal, top)
        form = ArchForm(top, (up - 0.02 + 2e-6 * (k - 6)) / up, 0.5)
        duration = made(start, goal, form).duration + more
        way = path(made(start, goal, form, duration), 2.0)
        low, high = way.extrema(0)
        assert keeps(way)
        assert high[LIFT] <= top + 1e-13
        assert low[LIFT] >= 0.08 - 1e-13
        at_top = 2.0 + up + np.linspace(1e-9, 1.0 - 1e-9, 50) * (duration - up - down)
        assert (way.evaluate(at_top)[:, LIFT] == top).all()
        assert not way.evaluate(at_top, 1)[:, LIFT].any()
        arrived = 2.0 + form.rise * up + across + 1e-9
        assert more < 1.0 or (way.evaluate(np.linspace(arrived, way.end, 50))[:, [0, 1, 3]] == [0.8, 1.2, 0.5]).all()
