"""The checker's own spline: the same curve as the trajectory's, by other means; its bounds hold and are tight."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.checker import Code
from assur.planner.checker.limits import limits
from assur.planner.checker.spline import COLUMNS, JERK, RATE, curve, cut, joints
from assur.planner.checker.world import World
from assur.planner.robots.facts import Limits
from assur.planner.trajectory import Trajectory, check_limits
from tests.planner.checker.hand_made import crossing_case


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


def over(line: Trajectory, t0: float, t1: float) -> FloatArray:
    """Bounds (4, 6) of q, q̇ and q̈ over [t0, t1]."""
    rows, found = np.zeros((len(line.time), COLUMNS)), np.zeros((8, 6))
    curve(line.knots, line.n, 0, rows)
    joints(rows, 0, len(line.time) - 1, line.n, t0, t1, found)
    return found[: line.n]


seeds = st.integers(0, 2**32 - 1)
sizes = st.sampled_from([2, 3, 12])
shortest_s = st.sampled_from([1e-5, 1e-3, 0.05])


@given(seeds, sizes, shortest_s)
def test_it_is_the_curve_of_the_trajectory(seed: int, knots: int, shortest: float) -> None:
    line = motion(seed, knots, shortest)
    t = np.concatenate([line.time[:-1], np.random.default_rng(seed).uniform(line.start, line.end, 50)])
    h = line.steps[np.minimum(line.edges.searchsorted(t, "right") - 1, knots - 2)][:, None]
    own = np.array([over(line, float(x), float(x)) for x in t])
    for derivative in range(3):
        theirs = line.evaluate(t, derivative)
        for side in range(2):
            off = np.abs(own[:, :, 2 * derivative + side] - theirs)
            # Rounding of a position grows with every derivative by 1/h of its piece.
            assert (off <= 1e-13 * (1 + np.abs(theirs)) * (1 + h**-derivative)).all()


def test_rates_on_short_pieces_are_those_of_the_knots() -> None:
    """Differences of positions would lose 1e-16 m over 10 µs: 1e-11 m/s, and 1e-6 m/s²."""
    time = np.array([0.0, 1e-5, 2e-5])
    q = np.full((3, 4), 3.0) + time[:, None]
    line = Trajectory(time, q, np.ones((3, 4)), np.zeros((3, 4)))
    found = over(line, 0.0, 2e-5)
    assert np.abs(found[:, 2:4] - 1.0).max() <= 1e-9
    assert np.abs(over(line, 1e-5, 1e-5)[:, 2:] - [1.0, 1.0, 0.0, 0.0]).max() == 0.0


@given(seeds, st.floats(0, 1), st.floats(0, 1))
def test_a_part_of_a_polynomial_is_that_polynomial(seed: int, one: float, other: float) -> None:
    s0, s1 = sorted((one, other))
    control = np.random.default_rng(seed).normal(size=6)
    part = control.copy()
    cut(part, 5, s0, s1)
    s = np.linspace(0, 1, 11)

    def value(c: FloatArray, at: FloatArray) -> FloatArray:
        row = np.tile(c, (len(at), 1))
        while row.shape[1] > 1:
            row = row[:, :-1] * (1 - at[:, None]) + row[:, 1:] * at[:, None]
        return np.asarray(row[:, 0])

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
    for a, b in zip(*intervals(line, np.random.default_rng(seed)), strict=True):
        found = over(line, float(a), float(b))
        inner = line.time[(line.time >= a) & (line.time < b)]
        t = np.concatenate([np.linspace(a, b, 60)[:-1], inner, [] if a < b else [a]])
        for derivative in range(3):
            taken = line.evaluate(t, derivative)
            slack = 1e-12 * (1 + np.abs(line.evaluate(line.time, derivative)).max(0)) + 1e-12 * np.abs(taken).max(0)
            assert (found[:, 2 * derivative] <= taken.min(0) + slack).all()
            assert (found[:, 2 * derivative + 1] >= taken.max(0) - slack).all()


@given(seeds, sizes)
def test_bounds_over_short_intervals_are_tight(seed: int, knots: int) -> None:
    line = motion(seed, knots, 0.05)
    for a in np.random.default_rng(seed).uniform(line.start, line.end - 1e-4, 10):
        found = over(line, float(a), float(a) + 1e-4)
        for derivative in range(3):
            taken = line.evaluate(np.linspace(a, a + 1e-4, 50), derivative)
            more = np.abs(line.evaluate(np.linspace(a, a + 1e-4, 50), min(3, derivative + 1))).max(0)
            assert (
                found[:, 2 * derivative + 1] - found[:, 2 * derivative] <= np.ptp(taken, 0) + 2e-4 * more + 1e-9
            ).all()


def test_before_the_start_and_after_the_end_the_arm_stands() -> None:
    line = motion(1, 12, 1e-3)
    for t0, t1, row in ((line.end + 0.5, line.end + 1, -1), (-2.0, -1.0, 0), (line.end + 1, line.end + 1, -1)):
        found = over(line, t0, t1)
        assert (found[:, :2] == line.q[row][:, None]).all()
        assert (found[:, 2:] == 0).all()


def findings(line: Trajectory, given_limits: Limits) -> list[Any]:
    scene, plan = crossing_case()
    robot: Any = scene.robot
    other = replace(scene, robot=replace(robot, limits=given_limits))
    return limits(World(other, replace(plan, trajectory=line)))


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
