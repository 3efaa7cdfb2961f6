"""Exact extremes: never below the truth, and not above it by more than said."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import polynomial

from assur.planner.kernels.limits import first_limit_broken, spline_extremes
from assur.planner.trajectory import Trajectory
from tests.planner.trajectory.splines import Floats, bernstein, spline, splines


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
    slack = 1e-12 * np.abs(bernstein(path, derivative)).max((0, 2))
    assert (np.abs(low - true_low) <= slack).all()
    assert (np.abs(high - true_high) <= slack).all()


def test_a_double_root_of_the_derivative_is_no_obstacle() -> None:
    """(s − 1/2)⁵ has a fourfold stationary point and is monotone, −(s − 1/2)⁴ has its top there."""
    for power, sign, top in ((5, 1.0, 0.5**5), (4, -1.0, 0.0)):
        c = sign * polynomial.polypow([-0.5, 1.0], power)
        states = [[polynomial.polyval(s, polynomial.polyder(c, k)) for s in (0.0, 1.0)] for k in range(3)]
        q, qd, qdd = (np.array(row)[:, None] for row in states)
        path = Trajectory(np.array([0.0, 1.0]), q, qd, qdd)
        assert path.extrema(0)[1][0] == pytest.approx(top, abs=2e-15)


@pytest.mark.parametrize("spoilt", [np.nan, np.inf])
def test_numbers_that_are_none_have_no_bound_and_keep_no_limit(spoilt: float) -> None:
    knots = spline(0).knots.copy()
    knots[3, 1 + 3 + 1] = spoilt
    found, wide = np.empty((4, 2, 3)), np.empty((4, 2, 3))
    wide[:, 0], wide[:, 1] = -1e9, 1e9
    spline_extremes(knots, found)
    for derivative in range(4):
        assert found[derivative, 0, 1] == -np.inf
        assert found[derivative, 1, 1] == np.inf
    assert first_limit_broken(knots, wide) == 1


@given(splines)
def test_compiled_extremes_are_those_of_plain_python(path: Trajectory) -> None:
    compiled, plain = np.empty((2, 4, 2, path.n))
    spline_extremes(path.knots, compiled)
    getattr(spline_extremes, "py_func", spline_extremes)(path.knots, plain)
    assert np.array_equal(compiled, plain)
