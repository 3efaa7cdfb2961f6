"""The RPR dyad: against differences, read backwards, and every case that it refuses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.kernels.dyads import ANGLE, LENGTH, RPR_COLUMNS, rpr
from assur.planner.kernels.motion import add_vector, turn_left
from assur.planner.robots.facts import Code

FORWARD, BACKWARD = 1, -1
"""s of the usual assembly, B ahead of A along the slider, and of the other one."""
BOTH = pytest.mark.parametrize("sign", [FORWARD, BACKWARD])
Planar = tuple[FloatArray, FloatArray]


@dataclass(frozen=True)
class Solved:
    """Of a batch of shape (...): angle, length, and the pair of each derivative that was given."""

    angle: FloatArray
    length: FloatArray
    rates: tuple[Planar, ...]
    code: IntArray


def solve(sign: int, d: Planar, *derivatives: Planar, least: float = 1e-12) -> Solved:
    """The kernel, for each d = B − A and up to three derivatives."""
    shape, order = d[0].shape, len(derivatives)
    rows = np.zeros((d[0].size, 4, 2))
    for k, pair in enumerate((d, *derivatives)):
        rows[:, k, 0], rows[:, k, 1] = (x.ravel() for x in pair)
    out = np.empty((len(rows), RPR_COLUMNS))
    code = np.array([rpr(least, sign, row, order, found) for row, found in zip(rows, out, strict=True)])
    angle, length, *rates = (out[:, k].reshape(shape) for k in (ANGLE, LENGTH, *range(2, 2 + 2 * order)))
    return Solved(angle, length, tuple(zip(rates[::2], rates[1::2], strict=True)), code.reshape(shape))


def moving(size: int, sign: int) -> tuple[list[FloatArray], list[FloatArray]]:
    """Lengths (of the sign) and angles with three derivatives."""
    rng = np.random.default_rng(7)
    length = [sign * rng.uniform(0.05, 2.0, size), *(rng.normal(size=size) * s for s in (1.0, 5.0, 50.0))]
    angle = [rng.uniform(-3.1, 3.1, size), *(rng.normal(size=size) * s for s in (3.0, 20.0, 200.0))]
    return length, angle


@BOTH
def test_what_is_put_together_by_length_and_angle_is_taken_apart_again(sign: int) -> None:
    length, angle = moving(10_000, sign)
    put = np.zeros((len(length[0]), 4, 2))
    for row, orders in zip(put, zip(*length, *angle, strict=True), strict=True):
        add_vector(row, turn_left(orders[:4], (0.0, 0.0, 0.0, 0.0), orders[4:]))
    d, *derivatives = ((put[:, k, 0], put[:, k, 1]) for k in range(4))
    with np.errstate(all="raise"):
        got = solve(sign, d, *derivatives)
    assert (got.code == Code.ASSEMBLED).all()
    assert np.abs(got.length - length[0]).max() < 1e-14
    assert np.abs(got.angle - angle[0]).max() < 1e-13
    size = sum(np.abs(x) for x in (*length[1:], *angle[1:])) ** 3 / np.abs(length[0])
    for k, (turn, grow) in enumerate(got.rates, start=1):
        assert (np.abs(turn - angle[k]) <= 1e-13 * (1 + size / np.abs(length[0]))).all()
        assert (np.abs(grow - length[k]) <= 1e-13 * (1 + size)).all()


@BOTH
@pytest.mark.parametrize("at", [(0.3, 0.4), (0.0, 1.0), (0.0, -1.0), (1.0, 0.0), (-1.0, 0.0)])
def test_its_derivatives_are_differences_of_its_positions_also_on_the_axes(sign: int, at: tuple[float, float]) -> None:
    """On the axes because the printed figures 2 and 3 of source 000 are wrong there."""
    rates = np.array([[0.3, -0.5], [0.7, 0.2], [-0.4, 0.9]])
    h, k = 1e-3, np.arange(-4, 5)
    t = k * h
    path = np.array(at)[:, None] + np.outer(rates[0], t) + np.outer(rates[1], t**2 / 2) + np.outer(rates[2], t**3 / 6)
    seen = solve(sign, (path[0], path[1]))
    centre = solve(sign, (np.array(at[0]), np.array(at[1])), *((np.array(x), np.array(y)) for x, y in rates))
    stencils = {
        1: np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280]) / h,
        2: np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560]) / h**2,
        3: np.array([-7 / 240, 3 / 10, -169 / 120, 61 / 30, 0, -61 / 30, 169 / 120, -3 / 10, 7 / 240]) / h**3,
    }
    for order, tolerance in ((1, 1e-11), (2, 1e-8), (3, 1e-5)):
        turn, grow = centre.rates[order - 1]
        assert stencils[order] @ np.unwrap(seen.angle) == pytest.approx(float(turn), abs=tolerance)
        assert stencils[order] @ seen.length == pytest.approx(float(grow), abs=tolerance)


@BOTH
def test_a_line_along_minus_x_is_at_pi_whatever_the_sign_of_its_zero(sign: int) -> None:
    for zero in (0.0, -0.0):
        assert float(solve(sign, (np.array(-sign * 1.0), np.array(zero))).angle) == np.pi


@BOTH
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 1e200])
def test_what_is_not_finite_is_refused_alone(sign: int, bad: float) -> None:
    one = np.ones(3)
    for place in range(4):
        given_ = [[one.copy(), one.copy()] for _ in range(4)]
        given_[place][1][1] = bad
        if place == 0 and bad == 1e200:
            continue
        with np.errstate(all="raise"):
            got = solve(sign, *((x, y) for x, y in given_))
        expected = Code.ASSEMBLED if bad == 1e200 and place > 1 else Code.OUT_OF_REACH
        assert got.code.tolist() == [Code.ASSEMBLED, expected, Code.ASSEMBLED]
        assert np.isnan([got.angle[1], got.length[1], got.rates[2][0][1]]).all() == (expected != Code.ASSEMBLED)


@given(st.floats(-1, 1), st.floats(-1, 1), st.sampled_from([FORWARD, BACKWARD]))
def test_within_the_least_length_it_may_point_anywhere(x: float, y: float, sign: int) -> None:
    one = (np.array(1.0), np.array(1.0))
    with np.errstate(all="raise"):
        got = solve(sign, (np.array(x), np.array(y)), one, least=0.5)
    assert got.code == (Code.INDETERMINATE if np.hypot(x, y) <= 0.5 else Code.ASSEMBLED)
    assert np.isnan(got.angle) == np.isnan(got.rates[0][0]) == (got.code == Code.INDETERMINATE)
