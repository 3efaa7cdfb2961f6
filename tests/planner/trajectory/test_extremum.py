"""Exact extremes: never below the truth, and not above it by more than said."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import polynomial

from assur.planner.errors import FaultError
from assur.planner.trajectory import Trajectory, extremum
from assur.planner.trajectory.extremum import TIGHTNESS, cut, maxima
from tests.planner.trajectory.splines import Floats, spline, splines


def truth(path: Trajectory, derivative: int) -> tuple[Floats, Floats]:
    """Extremes by another method: roots of the derivative of every polynomial, and dense samples around them."""
    lows, highs = [], []
    for k, h in enumerate(path.steps):
        for joint in range(path.n):
            c = polynomial.polyder(path.coefficients[k, joint] * h ** np.arange(6), derivative) / h**derivative
            d = polynomial.polyder(c)
            d = d[: np.flatnonzero(np.abs(d) > 1e-9 * np.abs(d).max())[-1] + 1] if d.any() else d[:1]
            roots = polynomial.polyroots(d).real if len(d) > 1 else np.zeros(0)
            s = np.concatenate([np.linspace(0, 1, 101), np.clip(roots, 0, 1)])
            values = polynomial.polyval(s, c)
            lows.append(values.min())
            highs.append(values.max())
    return np.array(lows).reshape(-1, path.n).min(0), np.array(highs).reshape(-1, path.n).max(0)


@given(splines, st.integers(0, 3))
def test_extremes_are_those_of_the_roots_of_the_derivative(path: Trajectory, derivative: int) -> None:
    low, high = path.extrema(derivative)
    true_low, true_high = truth(path, derivative)
    # The test's own power coefficients round by some 1e-15 of the hull.
    slack = 1e-12 * np.abs(path.bernstein(derivative)).max((0, 2))
    assert (np.abs(low - true_low) <= slack).all()
    assert (np.abs(high - true_high) <= slack).all()


@given(splines, st.integers(0, 3))
def test_no_sample_is_outside_the_extremes(path: Trajectory, derivative: int) -> None:
    t = np.concatenate([np.linspace(path.start, path.end, 4001), path.time])
    low, high = path.extrema(derivative)
    values = path.evaluate(t, derivative)
    slack = 1e-13 * np.abs(path.bernstein(derivative)).max((0, 2))
    assert (values >= low - slack).all()
    assert (values <= high + slack).all()


@pytest.mark.parametrize("degree", range(1, 6))
def test_the_bound_is_not_below_the_largest_value_nor_above_it_by_more_than_its_slack(degree: int) -> None:
    rng = np.random.default_rng(degree)
    rows = rng.normal(size=(3000, degree + 1)) * 10.0 ** rng.integers(-3, 4, (3000, 1))
    rows[:500] = np.round(rows[:500])  # flat tops, double roots, equal coefficients
    group = np.arange(3000, dtype=np.int64)
    slack = TIGHTNESS * np.abs(rows).max(1)
    bound = maxima(rows, group, np.maximum(rows[:, 0], rows[:, -1]), slack)
    sampled = np.full(3000, -np.inf)
    for s in np.linspace(0, 1, 401):
        sampled = np.maximum(sampled, cut(rows, np.full(3000, s))[0][:, -1])
    assert (bound >= sampled - slack).all()
    # 401 samples miss a parabola's top by its curvature over 8·400².
    bend = np.abs(np.diff(rows, 2, axis=1)).max(1, initial=0.0) * degree * (degree - 1)
    assert (bound <= sampled + slack + bend / (8 * 400**2) + slack).all()


def test_a_double_root_of_the_derivative_is_no_obstacle() -> None:
    # (s − 1/2)^5 has a fourfold stationary point and is monotone; −(s − 1/2)^4 has its top there.
    for power, top in ((5, 0.5**5), (4, 0.0)):
        c = polynomial.polypow([-0.5, 1.0], power) * (1 if power == 5 else -1)
        c = np.append(c, np.zeros(6 - len(c)))
        rows = c[None] @ np.linalg.inv(extremum._POWERS[5])
        bound = maxima(rows, np.zeros(1, dtype=np.int64), np.array([max(rows[0, 0], rows[0, -1])]), np.array([1e-15]))
        assert bound[0] == pytest.approx(top, abs=2e-15)


@given(splines)
def test_extremes_of_the_mirrored_motion_are_mirrored(path: Trajectory) -> None:
    mirrored = Trajectory(path.time, -path.q, -path.qd, -path.qdd)
    for derivative in range(4):
        low, high = path.extrema(derivative)
        other = mirrored.extrema(derivative)
        slack = 1e-12 * np.abs(path.bernstein(derivative)).max()
        assert np.abs(other[0] + high).max() <= slack
        assert np.abs(other[1] + low).max() <= slack


def test_groups_are_independent_and_a_group_without_rows_keeps_what_it_takes() -> None:
    rows = np.array([[0.0, 2.0, 0.0], [0.0, -2.0, 0.0], [0.0, 4.0, 0.0]])
    bound = maxima(rows, np.array([0, 1, 0]), np.array([0.0, 0.0, 7.0]), np.full(3, 1e-13))
    assert bound == pytest.approx([2.0, 0.0, 7.0], abs=1e-12)


def test_a_search_that_does_not_close_is_a_fault_and_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(extremum, "ROUNDS", 1)
    with pytest.raises(FaultError, match="did not close"):
        spline(0).extrema(0)


def test_coefficients_that_are_not_numbers_never_pass_for_a_bound() -> None:
    with pytest.raises(FaultError), np.errstate(invalid="ignore"):
        maxima(np.array([[0.0, np.nan, 0.0]]), np.zeros(1, dtype=np.int64), np.zeros(1), np.full(1, 1e-13))
