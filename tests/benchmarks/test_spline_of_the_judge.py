"""The spline of the judge: through its knots, and with extremes that no sample passes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from benchmarks.judge.spline import Spline, zeros

SEEDS = st.integers(0, 2**32 - 1)


def _random(seed: int, shortest: float = 0.01) -> Spline:
    rng = np.random.default_rng(seed)
    time = np.concatenate([[0.0], np.cumsum(rng.uniform(shortest, 0.3, 5))])
    return Spline.through(time, *(scale * rng.normal(size=(6, 4)) for scale in (1.0, 5.0, 50.0)))


@given(SEEDS)
def test_the_spline_goes_through_every_knot_with_both_derivatives(seed: int) -> None:
    rng = np.random.default_rng(seed)
    time = np.cumsum(rng.uniform(1e-3, 0.3, 6))
    knots = [scale * rng.normal(size=(6, 4)) for scale in (1.0, 5.0, 50.0)]
    spline = Spline.through(time, *knots)
    before = np.nextafter(time[1:], 0.0)
    for derivative, values in enumerate(knots):
        assert np.allclose(spline.evaluate(time, derivative), values, rtol=1e-9, atol=1e-9 * 10.0**derivative)
        assert np.allclose(spline.evaluate(before, derivative), values[1:], rtol=1e-6, atol=1e-5 * 10.0**derivative)


@given(SEEDS, st.integers(0, 3))
def test_no_dense_sample_lies_beyond_the_extremes_and_some_sample_comes_near_them(seed: int, derivative: int) -> None:
    spline = _random(seed)
    t = np.linspace(spline.time[0], spline.time[-1], 200_001)
    samples = spline.evaluate(t, derivative)
    low, high = spline.extremes(derivative)
    size = np.abs(samples).max(axis=0)
    assert np.all(samples.min(axis=0) >= low - 1e-12 * size)
    assert np.all(samples.max(axis=0) <= high + 1e-12 * size)
    assert np.all(samples.min(axis=0) <= low + 1e-3 * size)
    assert np.all(samples.max(axis=0) >= high - 1e-3 * size)


def test_the_derivatives_are_those_of_finite_differences() -> None:
    spline = _random(7, shortest=0.1)
    t = np.linspace(spline.time[1] + 1e-3, spline.time[2] - 1e-3, 50)
    for derivative in range(3):
        step = 1e-5
        slope = (spline.evaluate(t + step, derivative) - spline.evaluate(t - step, derivative)) / (2 * step)
        assert np.allclose(slope, spline.evaluate(t, derivative + 1), rtol=1e-6, atol=1e-4)


@pytest.mark.parametrize(
    "roots", [(0.5,), (0.25, 0.75), (0.1, 0.1000001), (0.0, 0.5, 1.0), (0.2, 0.4, 0.6, 0.8), (0.3, 0.3 + 1e-9, 0.9)]
)
def test_every_change_of_sign_is_among_the_zeros(roots: tuple[float, ...]) -> None:
    found = zeros(np.array(Polynomial.fromroots(roots).coef))
    for root in roots:
        assert np.abs(found - root).min() <= 1e-7


def test_a_peak_between_two_knots_that_look_harmless_is_found() -> None:
    knots = np.array([[0.0, 0.0, 0.1, 0.0], [1.0, 0.0, 0.1, 0.0]])
    spline = Spline.through(np.array([0.0, 1.0]), knots, 0 * knots, 0 * knots)
    for derivative, peak in ((0, 1.0), (1, 1.875), (2, 10 / np.sqrt(3)), (3, 60.0)):
        assert spline.extremes(derivative)[1][0] == pytest.approx(peak, rel=1e-12)
