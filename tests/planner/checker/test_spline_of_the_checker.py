"""The checker's own spline: the same curve as the trajectory's, by other means; its bounds hold and are tight."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.checker import Code
from assur.planner.checker.limits import JERK, RATE, limits
from assur.planner.checker.ranges import ranges
from assur.planner.checker.spline import Spline, cut, spline
from assur.planner.robots.protocol import Limits
from assur.planner.trajectory import Trajectory, check_limits
from assur.planner.trajectory.sweep import sweep
from tests.planner.checker.hand_made import arm, crossing

C = arm().rate_matrix


def motion(seed: int, knots: int, shortest: float) -> Trajectory:
    """A random motion of four joints, some of which may stand still, from rest to rest."""
    rng = np.random.default_rng(seed)
    time = np.cumsum(np.append(0.0, 10 ** rng.uniform(np.log10(shortest), -1, knots - 1)))
    q = np.cumsum(rng.normal(size=(knots, 4)) * np.append(0.0, np.diff(time))[:, None] * 3, axis=0)
    qd, qdd = rng.normal(size=(knots, 4)) * 2, rng.normal(size=(knots, 4)) * 30
    still = rng.random(4) < 0.2
    q[:, still] = q[0, still]
    qd[:, still] = qdd[:, still] = 0.0
    qd[[0, -1]] = qdd[[0, -1]] = 0.0
    return Trajectory(time, q, qd, qdd)


def of(line: Trajectory) -> Spline:
    return spline(line.time, line.q, line.qd, line.qdd)


seeds = st.integers(0, 2**32 - 1)
sizes = st.sampled_from([2, 3, 12])
shortest_s = st.sampled_from([1e-5, 1e-3, 0.05])


@given(seeds, sizes, shortest_s)
def test_it_is_the_curve_of_the_trajectory(seed: int, knots: int, shortest: float) -> None:
    line = motion(seed, knots, shortest)
    t = np.concatenate([line.time[:-1], np.random.default_rng(seed).uniform(line.start, line.end, 200)])
    h = line.steps[line.piece(t)[0]][:, None]
    for derivative, own in enumerate(of(line).state(t)):
        theirs = line.evaluate(t, derivative)
        # Rounding of a position grows with every derivative by 1/h of its piece.
        assert (np.abs(own - theirs) <= 1e-13 * (1 + np.abs(theirs)) * (1 + h**-derivative)).all()


@given(seeds, st.floats(0, 1), st.floats(0, 1))
def test_a_part_of_a_polynomial_is_that_polynomial(seed: int, one: float, other: float) -> None:
    s0, s1 = sorted((one, other))
    control = np.random.default_rng(seed).normal(size=(1, 6))
    part = cut(control, np.array([s0]), np.array([s1]))
    s = np.linspace(0, 1, 11)

    def value(c: FloatArray, at: FloatArray) -> FloatArray:
        row = np.repeat(c, len(at), axis=0)
        while row.shape[1] > 1:
            row = row[:, :-1] * (1 - at[:, None]) + row[:, 1:] * at[:, None]
        return row[:, 0]

    assert np.allclose(value(part, s), value(control, s0 + s * (s1 - s0)), rtol=0, atol=1e-13)


def intervals(line: Trajectory, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Short, long, empty, beginning or ending at knots, all inside the motion."""
    ends = np.sort(rng.uniform(line.start, line.end, (60, 2)), axis=1)
    short = ends[:20, :1] + np.array([0.0, 1e-7])
    knots = np.sort(rng.choice(line.time, (20, 2)), axis=1)
    every = np.clip(
        np.concatenate([ends, short, knots, ends[:5, [0, 0]], [[line.start, line.end]]]), line.start, line.end
    )
    return every[:, 0].copy(), every[:, 1].copy()


@given(seeds, sizes, shortest_s)
def test_bounds_over_intervals_are_never_below_what_is_taken(seed: int, knots: int, shortest: float) -> None:
    line = motion(seed, knots, shortest)
    a, b = intervals(line, np.random.default_rng(seed))
    own = ranges(of(line), C).sweep(a, b)
    for i in range(len(a)):
        inner = line.time[(line.time >= a[i]) & (line.time <= b[i])]
        t = np.concatenate([np.linspace(a[i], b[i], 60), inner])
        q, qd, qdd, _ = of(line).state(t)
        slack = 1e-12 * (1 + np.abs(line.q).max())
        assert (own.lower[i] <= q.min(0) + slack).all()
        assert (own.upper[i] >= q.max(0) - slack).all()
        for taken, bound in ((qd, own.rate[i]), (qdd, own.rate_d[i])):
            # The last piece's end is not taken by `state` when it stands still afterwards.
            top = np.abs(taken[t < line.end] @ C.T).max(0, initial=0.0)
            assert (bound >= top * (1 - 1e-12) - 1e-12 * (1 + np.abs(taken).max())).all()


@given(seeds, sizes, shortest_s)
def test_bounds_are_no_looser_than_those_of_the_planner(seed: int, knots: int, shortest: float) -> None:
    """What an honest maker claims must not be called too small."""
    line = motion(seed, knots, shortest)
    a, b = intervals(line, np.random.default_rng(seed))
    own, theirs = ranges(of(line), C).sweep(a, b), sweep(line, a, b, C)
    assert (own.rate <= theirs.rate * (1 + 1e-10) + 1e-10).all()
    assert (own.rate_d <= theirs.rate_d * (1 + 1e-10) + 1e-8).all()


@given(seeds, sizes, shortest_s)
def test_bounds_over_the_whole_are_the_exact_extrema(seed: int, knots: int, shortest: float) -> None:
    line = motion(seed, knots, shortest)
    whole = ranges(of(line), np.eye(4)).sweep(np.array([line.start]), np.array([line.end]))
    for derivative, bound in ((1, whole.rate[0]), (2, whole.rate_d[0])):
        low, high = line.extrema(derivative)
        exact = np.maximum(np.abs(low), np.abs(high))
        # TIGHT is relative to the whole spline's greatest value, here that of the joint itself.
        assert bound == pytest.approx(exact, rel=1e-10, abs=1e-12)


def test_after_the_end_the_arm_stands() -> None:
    line = motion(1, 12, 1e-3)
    after = ranges(of(line), C).sweep(np.array([line.end, line.end]), np.array([line.end + 1, line.end]))
    assert (after.rate == 0).all()
    assert (after.rate_d == 0).all()
    assert (after.lower == line.q[-1]).all()
    assert (after.upper == line.q[-1]).all()
    q, *rates = of(line).state(np.array([line.end, line.end + 5]))
    assert (q == line.q[-1]).all()
    assert all((rate == 0).all() for rate in rates)


def findings(line: Trajectory, given_limits: Limits) -> list[Any]:
    scene = crossing()
    robot = arm()
    object.__setattr__(robot, "limits", given_limits)
    object.__setattr__(scene, "robot", robot)
    return limits(scene, of(line))


@given(seeds, sizes, st.integers(0, 3), st.integers(0, 3), st.booleans())
def test_a_limit_just_below_the_extremum_is_broken_and_just_above_is_kept(
    seed: int, knots: int, joint: int, kind: int, above: bool
) -> None:
    line = motion(seed, knots, 1e-3)
    low, high = (np.array(x) for x in zip(*(line.extrema(d) for d in range(4)), strict=True))
    tolerance = JERK if kind == 3 else RATE
    rates = np.maximum(np.abs(low), np.abs(high)) * 1.01 + 1e-3
    bounds = {"lower": low[0] - 1.0, "upper": high[0] + 1.0}
    bounds |= {name: rates[k] for k, name in enumerate(("velocity", "acceleration", "jerk"), start=1)}
    sign = 1 if above else -1
    if kind == 0:
        width = (high[0] - low[0] + 1.0)[joint] / 2
        bounds["upper"][joint] = high[0][joint] - tolerance * width * (1 - sign * 1e-2)
    else:
        exact = max(abs(low[kind][joint]), abs(high[kind][joint]))
        if exact < 1e-3:
            return
        bounds[("velocity", "acceleration", "jerk")[kind - 1]][joint] = exact / (1 + tolerance * (1 - sign * 1e-2))
    allowed = Limits(**bounds)
    found = findings(line, allowed)
    assert bool(found) != above
    assert all(finding.code is Code.LIMIT and finding.amount > 0 for finding in found)
    report = check_limits(line, allowed.lower, allowed.upper, allowed.velocity, allowed.acceleration, allowed.jerk)
    assert report.ok == above


def test_a_motion_at_its_limit_is_within_it() -> None:
    """A joint that runs at exactly its velocity limit for most of its way."""
    time = np.array([0.0, 0.1, 0.5, 0.6])
    speed = np.array([0.0, 2.0, 2.0, 0.0])
    way = np.array([0.0, 0.1, 0.9, 1.0])
    line = Trajectory(time, np.tile(way[:, None], 4), np.tile(speed[:, None], 4), np.zeros((4, 4)))
    kept = Limits(np.full(4, -1.0), np.full(4, 1.0), np.full(4, 2.0), np.full(4, 31.0), np.full(4, 1300.0))
    assert findings(line, kept) == []
