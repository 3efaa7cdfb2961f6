"""Bounds over arbitrary intervals: never below dense samples of the truth, and tight."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from assur.planner.trajectory import Trajectory
from tests.planner.timing.legs import question, time_joints
from tests.planner.trajectory.splines import splines, sweep

Floats = NDArray[np.float64]


def intervals(path: Trajectory, rng: np.random.Generator, size: int) -> tuple[Floats, Floats]:
    """Inside pieces, across them, on knots, points, and all of it."""
    t0 = rng.uniform(path.start, path.end, size)
    t1 = np.minimum(t0 + rng.exponential(path.duration * 10.0 ** -rng.integers(0, 4, size)), path.end)
    knots = rng.choice(path.time, (2, size // 4))
    t0[: size // 4], t1[: size // 4] = knots.min(0), knots.max(0)
    t0[-1], t1[-1] = path.start, path.end
    t1[-2] = t0[-2]
    return t0, t1


def joint_legs(seed: int) -> Trajectory:
    """Three legs of a robot of four joints in one go: fast, and with long cruises."""
    rng = np.random.default_rng(seed)
    whole: Trajectory | None = None
    for kind in ("moving", "rest", "moving"):
        asked = question(rng, "real", kind, least=0.1)
        first = time_joints(asked.q0, 0 * asked.q0, 0 * asked.q0, *asked.args[3:], begin=0.5)
        assert isinstance(first, Trajectory)
        if whole is None:
            whole = first
            continue
        back = time_joints(
            whole.q[-1], whole.qd[-1], whole.qdd[-1], *asked.goal, *_wide(asked.limits, whole), begin=whole.end
        )
        assert isinstance(back, Trajectory)
        both = zip(*((path.time, path.q, path.qd, path.qdd) for path in (whole, back)), strict=True)
        whole = Trajectory(*(np.concatenate([one, other[1:]]) for one, other in both))
    assert whole is not None
    return whole


def _wide(limits: tuple[Floats, Floats, Floats], path: Trajectory) -> tuple[Floats, Floats, Floats]:
    return np.maximum(limits[0], 1.1 * np.abs(path.qd[-1])), limits[1], limits[2]


def truth(path: Trajectory, a: float, b: float) -> tuple[Floats, Floats]:
    """The least and the greatest q, q̇ and q̈ (n, 3), over dense samples and knots of one interval."""
    t = np.concatenate([np.linspace(a, b, 300), path.time[(path.time >= a) & (path.time <= b)]])
    states = np.stack([path.evaluate(t, order) for order in range(3)], -1)
    return states.min(0), states.max(0)


@given(splines, st.integers(0, 1000))
def test_no_bound_is_below_the_truth(path: Trajectory, seed: int) -> None:
    t0, t1 = intervals(path, np.random.default_rng(seed), 24)
    low, high = sweep(path, t0, t1)
    for k in range(len(t0)):
        least, most = truth(path, float(t0[k]), float(t1[k]))
        assert (low[k] <= least).all()
        assert (high[k] >= most).all()


def test_a_point_in_time_is_bounded_by_its_values() -> None:
    path = joint_legs(1)
    t = np.linspace(path.start, path.end, 50)
    states = np.stack([path.evaluate(t, order) for order in range(3)], -1)
    for found in sweep(path, t, t):
        assert found == pytest.approx(states, rel=1e-10, abs=1e-8)
        assert found[..., 0] == pytest.approx(states[..., 0], abs=1e-11)


def at_rest_at_both_ends() -> Trajectory:
    asked = question(np.random.default_rng(5), "real", "rest", least=0.1)
    path = time_joints(*asked.args, begin=1.0)
    assert isinstance(path, Trajectory)
    return path


def test_an_arm_at_rest_stands_still_before_and_after() -> None:
    path = at_rest_at_both_ends()
    before, after = np.array([-np.inf, path.start - 1]), np.array([path.end + 1, np.inf])
    for still in sweep(path, np.array([-np.inf, path.end + 0.5]), np.array([path.start - 0.5, np.inf])):
        assert (np.abs(still[..., 1]) <= 1e-9).all()
        assert (np.abs(still[..., 2]) <= 1e-7).all()
        for k, q in ((0, path.q[0]), (1, path.q[-1])):
            assert still[k, :, 0] == pytest.approx(q, abs=1e-11)
    around, inside = (sweep(path, a, b) for a, b in ((before, after), (np.full(2, path.start), np.full(2, path.end))))
    assert np.array_equal(around, inside)


@pytest.mark.parametrize("end", [0, -1])
@pytest.mark.parametrize("what", ["qd", "qdd"])
def test_an_arm_in_motion_at_an_end_is_not_known_beyond_it(end: int, what: str) -> None:
    path = at_rest_at_both_ends()
    states = {name: getattr(path, name).copy() for name in ("q", "qd", "qdd")}
    states[what][end, 2] = 1e-12
    path = Trajectory(path.time, **states)
    edge = path.start if end == 0 else path.end
    t0, t1 = np.array([edge - 0.1, edge, edge, edge - 0.1]), np.array([edge, edge, edge + 0.1, edge + 0.1])
    low, high = sweep(path, t0, t1)
    known = [False, True, True, False] if end == 0 else [True, True, False, False]
    assert np.isfinite(low).all((1, 2)).tolist() == np.isfinite(high).all((1, 2)).tolist() == known
    for k in np.flatnonzero(~np.array(known)):
        assert (low[k] == -np.inf).all()
        assert (high[k] == np.inf).all()


@pytest.mark.parametrize(("t0", "t1"), [(1.2, 1.1), (np.nan, 1.1), (1.1, np.nan), (np.inf, -np.inf)])
def test_over_an_interval_that_is_none_nothing_is_known(t0: float, t1: float) -> None:
    low, high = sweep(at_rest_at_both_ends(), np.array([t0]), np.array([t1]))
    assert (low == -np.inf).all()
    assert (high == np.inf).all()
