"""Limits held to exact extremes: what is accepted, what is refused, by which joint, when."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.errors import InputError
from assur.planner.kernels.limits import NONE, first_limit_broken
from assur.planner.legs.limits import rates, used
from assur.planner.model.refusal import Refusal, Stage
from assur.planner.robots.facts import Limits
from assur.planner.trajectory import JERK_TOLERANCE, LIMIT_TOLERANCE, Trajectory
from tests.planner.cells import table_to_table
from tests.planner.trajectory.splines import Floats, keeps_limits, spline, splines


def snug(path: Trajectory) -> list[Floats]:
    """Limits that the trajectory just keeps: lower, upper, velocity, acceleration, jerk."""
    low, high = path.extrema(0)
    rates = [np.maximum(-a, b) for a, b in (path.extrema(d) for d in (1, 2, 3))]
    return [low, high, *rates]


def moving(seed: int) -> Trajectory:
    return spline(seed, pieces=6, n=3)


@pytest.mark.parametrize("seed", range(5))
def test_a_trajectory_at_its_limits_keeps_them_with_ratio_one(seed: int) -> None:
    path = moving(seed)
    found = used(path, Limits(*snug(path)))
    assert found.ok
    assert found.ratios == pytest.approx(np.ones((3, 3)), abs=1e-12)
    assert found.ratio == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("kind", range(4))
@pytest.mark.parametrize("joint", range(3))
def test_a_limit_lowered_by_ten_tolerances_is_broken_by_that_joint_there(kind: int, joint: int) -> None:
    for seed in range(4):
        path = moving(seed)
        limits = [limit.copy() for limit in snug(path)]
        tolerance = JERK_TOLERANCE if kind == 3 else LIMIT_TOLERANCE
        which = 1 if kind == 0 else kind + 1
        width = (limits[1] - limits[0])[joint] / 2 if kind == 0 else limits[which][joint]
        for share, ok in ((0.5, True), (10.0, False)):
            lowered = [limit.copy() for limit in limits]
            lowered[which][joint] -= share * tolerance * width
            found = used(path, Limits(*lowered))
            assert found.ok is ok
            assert keeps_limits(path, *lowered) is ok
            broken = [] if ok else [[kind, joint]]
            assert np.argwhere(~found.kept).tolist() == broken


def test_the_joint_that_is_named_is_the_one_that_keeps_its_limit_least() -> None:
    scene, t = table_to_table(), np.linspace(0, 4, 41)[:, None]
    limits = scene.robot.limits
    middle, half = (limits.lower + limits.upper) / 2, (limits.upper - limits.lower) / 2
    # Joint 0 swings out from 2 s on, joint 1 already at 1 s but less far.
    at, high = np.array([2.5, 1.0, 2.0, 2.0]), half * np.array([1.5, 1.1, 0.0, 0.0])
    swing = high * np.exp(-((t - at) ** 2) * 20)
    path = Trajectory(t[:, 0], middle + swing, -40 * (t - at) * swing, ((40 * (t - at)) ** 2 - 40) * swing)
    found = rates(scene, Stage.LIMITS, 0, path, limits)
    assert isinstance(found, Refusal)
    assert found.joint == scene.robot.joints[0].name
    assert found.amount is not None
    assert found.amount.value == pytest.approx(0.5 * half[0], abs=1e-4 * half[0])
    assert used(path, limits).kept[0].tolist() == [False, False, True, True]


@given(splines, st.floats(0.5, 2.0), st.integers(0, 3))
def test_the_quick_answer_is_the_full_one(path: Trajectory, factor: float, kind: int) -> None:
    limits = snug(path)
    middle, half = (limits[0] + limits[1]) / 2, np.maximum((limits[1] - limits[0]) / 2, 1e-6)
    rates = [np.maximum(rate, 1e-6) for rate in limits[2:]]
    halves = [half, *rates]
    halves[kind] = halves[kind] * factor
    arguments = (middle - halves[0], middle + halves[0], *halves[1:])
    assert keeps_limits(path, *arguments) is used(path, Limits(*arguments)).ok


@pytest.mark.parametrize(
    ("which", "value"),
    [(0, np.nan), (1, np.inf), (2, 0.0), (3, -1.0), (4, np.nan), (0, 5.0)],
)
def test_limits_that_are_none_are_refused(which: int, value: float) -> None:
    limits = snug(moving(0))
    limits[which] = np.array([1e3, 1e3, value]) if which else np.array([-1e3, -1e3, 1e3 * value])
    with pytest.raises(InputError):
        Limits(*limits)
    with pytest.raises(InputError):
        Limits(*(limit[:2] if k == which else limit for k, limit in enumerate(snug(moving(0)))))


def test_no_jerk_is_kept_by_a_trajectory_that_jumps() -> None:
    time = np.array([0.0, 1.0, 1.0, 2.0])
    qd, qdd = np.array([[0.0], [1.0], [1.0], [0.0]]), np.array([[1.0], [1.0], [-1.0], [-1.0]])
    path = Trajectory(time, np.array([[0.0], [0.5], [0.5], [1.0]]), qd, qdd, jumps=True)
    limits = np.array([-1.0]), np.array([2.0]), np.array([2.0]), np.array([2.0])
    found = used(path, Limits(*limits, np.array([1e9])))
    assert found.ok
    assert found.ratios[:, 0].tolist() == [pytest.approx(0.5), pytest.approx(0.5), 0.0]
    assert not keeps_limits(path, *limits, np.array([1e9]))
    assert keeps_limits(path, *limits, None)


@given(splines, st.floats(0.5, 1.5), st.integers(0, 3))
def test_what_is_first_beyond_is_what_its_exact_extremes_say(path: Trajectory, factor: float, kind: int) -> None:
    bands = np.empty((4, 2, path.n))
    for derivative in range(4):
        low, high = path.extrema(derivative)
        spare = 1e-9 + 1e-9 * np.maximum(np.abs(low), np.abs(high))
        bands[derivative] = low - spare, high + spare
    assert first_limit_broken(path.knots, bands) == NONE
    middle, half = bands[kind].mean(0), (bands[kind, 1] - bands[kind, 0]) / 2
    bands[kind] = middle - factor * half, middle + factor * half
    found = first_limit_broken(path.knots, bands)
    tight = [j for j in range(path.n) if factor < 1 and half[j] * (1 - factor) > 1e-8 * (1 + abs(middle[j]))]
    if tight:
        assert found // path.n == kind
        assert found % path.n <= tight[0]
    if factor >= 1:
        assert found == NONE
    bands[kind, 0, 0] = np.nan
    assert first_limit_broken(path.knots, bands) != NONE
