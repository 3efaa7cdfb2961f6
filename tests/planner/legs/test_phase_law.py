"""The phase law of straight legs: its state is its jerk's integral, it keeps what it promises, and it is short."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion
from assur.planner.legs.line import LineRates
from assur.planner.legs.phase_law import PIECES, SHORTEST_S, TABLE, law_of_jerks, quickest
from assur.planner.robots.facts import Limits
from assur.planner.robots.scara import Scara
from assur.planner.trajectory import Trajectory
from tests.planner.cells import arm, limits

Table = tuple[FloatArray, FloatArray, FloatArray]
BETWEEN = 0.03
"""Share by which the rates between the looks of a law may exceed those at them."""


def along(robot: Scara, a: FloatArray, b: FloatArray, points: int = TABLE) -> Table:
    """q', q'', q''' by s on the line from a to b."""
    s, none = np.linspace(0, 1, points), np.zeros(points)
    p = a + s[:, None] * (b - a)
    still = np.zeros_like(p)
    found = robot.inverse(Motion.of(p, still + (b - a), still, still, none, none, none, none), 0, 3)
    return found.qd, found.qdd, found.qddd


def lines(count: int, seed: int = 1) -> list[tuple[FloatArray, FloatArray]]:
    """Ends as the benchmark draws them, m."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(count):
        r, angle, z = rng.uniform(0.25, 0.52, 2), rng.uniform(-1.5, 1.5, 2), rng.uniform(0.06, 0.20, 2)
        ends = np.stack([r * np.cos(angle), r * np.sin(angle), z], -1)
        found.append((ends[0], ends[1]))
    return found


def law_of(a: FloatArray, b: FloatArray) -> Trajectory:
    found = quickest(along(arm(), a, b), limits())
    assert found is not None
    return found


def test_the_slopes_of_the_times_are_those_of_differences() -> None:
    """Those by s to the interpolation of the table, from point to point."""
    s = np.linspace(0, 1, TABLE)[:, None]
    c = np.array([[0.7, -0.4, 0.3, 1.1], [0.2, 0.5, -0.6, 0.1], [0.3, -0.2, 0.4, -0.5]])
    rates = LineRates.of((c[0] + c[1] * s + c[2] * s**2 / 2, c[1] + c[2] * s, c[2] + 0 * s), limits())
    shape = np.random.default_rng(3).uniform([0.1, 0.5, -3, -20], [0.9, 2.0, 3, 20], (40, 4))
    seen = rates.seen(shape)
    times, slopes = seen.times, rates.slopes(seen)
    assert (times == rates.times(shape)).all()
    for k, step in enumerate((1 / (TABLE - 1), 1e-6, 1e-6, 1e-5)):
        by = np.zeros(4)
        by[k] = step
        differences = (rates.times(shape + by) - rates.times(shape - by)) / (2 * step)
        # where a rate passes zero the root of its size has no slope
        smooth = times > 0.3 * np.median(times, (0, 1))
        assert smooth.mean() > 0.5
        off = np.abs(differences - slopes[..., k])[smooth].max()
        assert off <= (2e-2 if k == 0 else 1e-7) * np.abs(differences[smooth]).max()


def test_a_law_takes_at_least_the_time_that_its_rates_between_the_looks_need_all_but() -> None:
    shares = []
    for a, b in lines(30):
        law = law_of(a, b)
        fine = 8001
        t = np.linspace(0, law.duration, fine)
        shape = np.concatenate([law.evaluate(t, order) * law.duration**order for order in range(4)], 1)
        truth = float(LineRates.of(along(arm(), a, b, fine), limits()).times(shape).max())
        shares.append(truth / law.duration - 1)
    assert max(shares) <= BETWEEN
    assert min(shares) >= -1e-3


def test_a_joint_that_stands_has_no_part_in_the_law() -> None:
    """On a level line the quill stands, and its limits may be anything."""
    a, b = np.array([0.3, -0.2, 0.1]), np.array([0.4, 0.2, 0.1])
    table, given = along(arm(), a, b), limits()
    assert not table[0][:, 2].any()
    slow = np.array([1.0, 1.0, 1e-3, 1.0])
    weak = Limits(given.lower, given.upper, given.velocity * slow, given.acceleration * slow, given.jerk * slow)
    one, other = quickest(table, given), quickest(table, weak)
    assert one is not None
    assert other is not None
    assert one.knots.tobytes() == other.knots.tobytes()


def test_where_there_is_nothing_to_find_there_is_no_law() -> None:
    a, b = np.array([0.3, -0.2, 0.1]), np.array([0.4, 0.2, 0.1])
    good = along(arm(), a, b)
    assert quickest(good, limits()) is not None
    for order in range(3):
        hole = tuple(part.copy() for part in good)
        hole[order][200, 1] = np.nan
        assert quickest((hole[0], hole[1], hole[2]), limits()) is None
    none = np.zeros_like(good[0])
    assert quickest((none, none, none), limits()) is None
    beyond = along(arm(), a, np.array([0.7, 0.2, 0.1]))
    assert quickest(beyond, limits()) is None


def test_a_way_too_short_for_its_knots_has_no_law() -> None:
    a, b = np.array([0.3, -0.2, 0.1]), np.array([0.4, 0.2, 0.1])
    for length, there in ((1e-6, True), (1e-12, False)):
        law = quickest(along(arm(), a, a + length * (b - a)), limits())
        assert (law is not None) == there
        assert law is None or law.duration >= SHORTEST_S


def test_a_law_has_the_jerks_that_it_is_made_of() -> None:
    # symmetric about the middle, with a velocity whose integral is 1
    jerks = np.repeat([1.0, -1.0, -1.0, 1.0], PIECES // 4) * 32.0
    law = law_of_jerks(0.7, jerks)
    middles = (law.time[1:] + law.time[:-1]) / 2
    assert law.evaluate(middles, 3)[:, 0] * 0.7**3 == pytest.approx(jerks, rel=1e-9)
    assert law.evaluate(0.35) == pytest.approx(0.5)
