"""Two knots at one time: only where a trajectory says so, only where the acceleration alone jumps; right everywhere."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from assur.planner.blends.law import ParabolicBlend
from assur.planner.errors import InputError
from assur.planner.legs.limits import used
from assur.planner.robots.facts import Limits
from assur.planner.trajectory import Trajectory
from assur.planner.trajectory.trajectory import joined
from tests.planner.trajectory.splines import keeps_limits, sweep

Floats = NDArray[np.float64]
WIDE = np.full(2, 1e3)


def blended(seed: int = 0, count: int = 4, begin: float = 0.5) -> Trajectory:
    """A motion by parabolic blends of two joints."""
    rng = np.random.default_rng(seed)
    tau = rng.uniform(0.02, 0.2, count)
    law = ParabolicBlend(rng.uniform(-2, 2, (count, 2)), tau[1:] + tau[:-1] + rng.uniform(0.01, 0.2, count - 1), tau)
    return Trajectory.of_knots(law.knots(begin), jumps=True)


PATHS = st.builds(blended, st.integers(0, 10**6), st.integers(2, 6), st.floats(-3, 30))


def changed(path: Trajectory, jumps: bool = True, **columns: Floats) -> Trajectory:
    knots = {name: columns.get(name, getattr(path, name)) for name in ("time", "q", "qd", "qdd")}
    return Trajectory(knots["time"], knots["q"], knots["qd"], knots["qdd"], jumps=jumps)


def test_two_knots_at_one_time_are_refused_where_nothing_is_said() -> None:
    path = blended()
    with pytest.raises(InputError) as caught:
        changed(path, jumps=False)
    assert caught.value.field == "trajectory.time"


@pytest.mark.parametrize("name", ["q", "qd"])
def test_a_place_or_a_velocity_that_jumps_is_refused_by_an_ulp(name: str) -> None:
    path = blended()
    states = getattr(path, name).copy()
    states[3, 1] = np.nextafter(states[3, 1], np.inf)
    with pytest.raises(InputError) as caught:
        changed(path, **{name: states})
    assert (caught.value.field, caught.value.value) == (f"trajectory.{name}", 3)


def test_three_knots_at_one_time_two_that_agree_and_times_that_decrease_are_refused() -> None:
    path = blended()
    again = [np.insert(getattr(path, name), 3, getattr(path, name)[3], axis=0) for name in ("time", "q", "qd", "qdd")]
    again[3][3] += 1.0
    for knots in (again,):
        with pytest.raises(InputError, match="not three"):
            Trajectory(knots[0], knots[1], knots[2], knots[3], jumps=True)
    same = path.qdd.copy()
    same[3] = same[2]
    with pytest.raises(InputError, match="a jump where two knots share a time"):
        changed(path, qdd=same)
    with pytest.raises(InputError, match="do not decrease"):
        changed(path, time=path.time[::-1].copy())
    with pytest.raises(InputError, match="at two times"):
        Trajectory(np.zeros(2), np.zeros((2, 1)), np.zeros((2, 1)), np.array([[0.0], [1.0]]), jumps=True)


@given(PATHS)
def test_values_come_from_the_right_and_are_continuous_but_for_the_acceleration(path: Trajectory) -> None:
    inner = path.edges[1:-1]
    left, right = np.nextafter(inner, -np.inf), inner
    for order, step in ((0, 1e-9), (1, 1e-8)):
        assert np.abs(path.evaluate(left, order) - path.evaluate(right, order)).max() <= step
    second = np.flatnonzero(np.diff(path.time) == 0) + 1
    of_inner = [k for k in second if 1 < k < len(path.time) - 1]
    assert np.abs(path.evaluate(path.time[of_inner], 2) - path.qdd[of_inner]).max() <= 1e-9 * np.abs(path.qdd).max()
    before = path.evaluate(np.nextafter(path.time[of_inner], -np.inf), 2)
    assert np.abs(before - path.qdd[np.array(of_inner) - 1]).max() <= 1e-7 * np.abs(path.qdd).max()
    assert not path.evaluate(path.end, 2).any()


@given(PATHS)
def test_extremes_hold_both_sides_of_a_jump_and_the_jerk_has_none(path: Trajectory) -> None:
    t = np.linspace(path.start, path.end, 2001)
    for order in range(3):
        low, high = path.extrema(order)
        values = path.evaluate(t, order)
        assert (values >= low).all()
        assert (values <= high).all()
    low, high = path.extrema(2)
    assert (low <= path.qdd.min(0)).all()
    assert (high >= path.qdd.max(0)).all()
    assert np.abs(low - path.qdd.min(0)).max() <= 1e-6
    moved = (path.q != path.q[0]).any(0)
    assert (path.extrema(3)[0][moved] == -np.inf).all()
    assert (path.extrema(3)[1][moved] == np.inf).all()


def test_no_jerk_limit_is_kept_and_the_others_are_looked_at_alone() -> None:
    path = blended()
    asked = WIDE, WIDE, 1e12 * np.ones(2)
    assert not keeps_limits(path, -WIDE, WIDE, *asked)
    assert keeps_limits(path, -WIDE, WIDE, WIDE, WIDE, None)
    pull = np.abs(path.qdd).max(0)
    assert keeps_limits(path, -WIDE, WIDE, WIDE, pull * (1 + 1e-8), None)
    assert not keeps_limits(path, -WIDE, WIDE, WIDE, pull * (1 - 1e-6), None)
    rates = used(path, Limits(-WIDE, WIDE, WIDE, pull * (1 - 1e-6), WIDE))
    assert not rates.kept[2].any()
    assert rates.kept[[0, 1, 3]].all()
    assert rates.ratios[1:] == pytest.approx(np.array([[1 + 1e-6] * 2, [0.0] * 2]), abs=1e-9)


@given(PATHS, st.integers(0, 10**6))
def test_no_bound_of_a_sweep_is_below_the_truth_across_jumps(path: Trajectory, seed: int) -> None:
    rng = np.random.default_rng(seed)
    span = np.sort(rng.uniform(path.start - 0.2, path.end + 0.2, (40, 2)), axis=1)
    at = path.edges[rng.integers(0, len(path.edges), 20)]
    # intervals that end, begin, or lie on a jump
    ends = np.concatenate([span, np.stack([at - 0.01, at], 1), np.stack([at, at + 0.01], 1), np.stack([at, at], 1)])
    low, high = sweep(path, ends[:, 0], ends[:, 1])
    for i, (a, b) in enumerate(ends):
        t = np.clip(np.linspace(a, b, 101), path.start, path.end)
        inside = t[(t > a) & (t < b)] if b > a else t[:0]
        for order, at, close in ((0, t, 1e-12), (1, t, 1e-9), (2, inside, 1e-6)):
            values = path.evaluate(at, order)
            assert (values <= high[i, :, order] + close).all()
            assert (values >= low[i, :, order] - close).all()


def test_motions_that_end_and_begin_with_a_jump_meet_in_one_jump() -> None:
    first = blended(1)
    back = Trajectory(
        first.time + first.duration, first.q[::-1].copy(), -first.qd[::-1], first.qdd[::-1].copy(), jumps=True
    )
    both = meeting(first, back)
    at = np.flatnonzero(both.time == first.end)
    assert len(at) in (1, 2)
    assert both.duration == pytest.approx(2 * first.duration)
    assert (both.qdd[at[0]] == first.qdd[-2]).all()
    assert (both.qdd[at[-1]] == back.qdd[1]).all()


def meeting(one: Trajectory, other: Trajectory, jumps: bool = True) -> Trajectory:
    """Both motions, one after the other."""
    table = joined(one.knots, other.knots)
    return Trajectory(table[:, 0], *np.split(table[:, 1:], 3, axis=1), jumps=jumps)


def test_smooth_motions_meet_in_a_jump_where_their_accelerations_differ_and_in_one_knot_where_they_do_not() -> None:
    time, q, qd = np.array([0.0, 1.0]), np.zeros((2, 1)), np.zeros((2, 1))
    one = Trajectory(time, q, qd, np.array([[0.0], [1.0]]))
    other = Trajectory(time + 1, q, qd, np.array([[2.0], [0.0]]))
    assert meeting(one, other).time.tolist() == [0.0, 1.0, 1.0, 2.0]
    with pytest.raises(InputError):
        meeting(one, other, jumps=False)
    other = Trajectory(time + 1, q, qd, np.array([[1.0 + 1e-7], [0.0]]))
    assert meeting(one, other, jumps=False).time.tolist() == [0.0, 1.0, 2.0]
