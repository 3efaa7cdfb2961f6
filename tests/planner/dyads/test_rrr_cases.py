"""The dyad where it cannot be assembled: every case of Code, and nothing that warns or raises."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from assur.experiments.dyad import LEFT, RIGHT, ROUNDING, RRR, Assembly, Planar
from assur.planner.arrays import FloatArray
from assur.planner.robots.facts import Code

MODES = [LEFT, RIGHT]


def solve(dyad: RRR, sigma: int, x: FloatArray, y: FloatArray, orders: int = 3) -> Assembly:
    """Position (x, y) with `orders` ordinary derivatives; any NumPy warning is an error."""
    one = np.ones_like(x)
    derivatives: list[Planar] = [(one, -2 * one), (3 * one, one), (one, 5 * one)]
    with np.errstate(all="raise"):
        return dyad.solve(sigma, (x, y), *derivatives[:orders])


def everything(solved: Assembly) -> FloatArray:
    return np.stack([*solved.u, *solved.w, solved.cross, solved.margin, *(x for pair in solved.rates for x in pair)])


def aligned(solved: Assembly, dyad: RRR, x: FloatArray, y: FloatArray) -> None:
    """The links lie on the line AB, end at B, have their lengths; no rates, no margin."""
    (ux, uy), (wx, wy) = solved.u, solved.w
    scale = dyad.l1 + dyad.l2
    assert np.abs(np.hypot(ux, uy) - dyad.l1).max() < 1e-15 * scale * 4
    assert np.abs(np.hypot(wx, wy) - dyad.l2).max() < 2 * ROUNDING * scale
    assert np.abs(ux * y - uy * x).max() < 1e-15 * scale**2
    assert np.array_equal(wx, x - ux)
    assert np.array_equal(wy, y - uy)
    assert (solved.margin == 0).all()
    assert (solved.cross == 0).all()
    assert all(np.isnan(rate).all() for pair in solved.rates for rate in pair)


@pytest.mark.parametrize("sigma", MODES)
@pytest.mark.parametrize("origin", [0.0, 30.0])
def test_exactly_stretched_targets_are_stretched_although_a_third_round_to_out_of_reach(
    sigma: int, origin: float
) -> None:
    """`origin`: the target is stored in world coordinates 60 arm lengths from its base, and rounded there."""
    rng = np.random.default_rng(0)
    dyad = RRR(0.325, 0.225)
    phi = rng.uniform(-np.pi, np.pi, 10_000)
    x = (origin + (dyad.l1 + dyad.l2) * np.cos(phi)) - origin
    y = (-origin + (dyad.l1 + dyad.l2) * np.sin(phi)) + origin
    square = x * x + y * y
    h_squared = ((dyad.l1 + dyad.l2) ** 2 - square) * (square - (dyad.l1 - dyad.l2) ** 2) / 4
    assert 0.2 < (h_squared < 0).mean() < 0.6
    solved = solve(dyad, sigma, x, y)
    assert (solved.code == Code.STRETCHED).all()
    aligned(solved, dyad, x, y)
    assert (solved.u[0] * solved.w[0] + solved.u[1] * solved.w[1] > 0).all()


@pytest.mark.parametrize("sigma", MODES)
@pytest.mark.parametrize("lengths", [(0.325, 0.225), (0.2, 0.35), (0.05, 0.08)])
def test_exactly_folded_targets_are_folded_whichever_link_is_longer(sigma: int, lengths: tuple[float, float]) -> None:
    rng = np.random.default_rng(1)
    dyad = RRR(*lengths)
    phi = rng.uniform(-np.pi, np.pi, 10_000)
    reach = abs(dyad.l1 - dyad.l2)
    x, y = reach * np.cos(phi), reach * np.sin(phi)
    solved = solve(dyad, sigma, x, y)
    assert (solved.code == Code.FOLDED).all()
    aligned(solved, dyad, x, y)
    assert (solved.u[0] * solved.w[0] + solved.u[1] * solved.w[1] < 0).all()


@pytest.mark.parametrize("sigma", MODES)
@pytest.mark.parametrize("offset", [0.0, 1e-14, 1e-13])
def test_equal_links_with_both_ends_in_one_place_are_indeterminate(sigma: int, offset: float) -> None:
    dyad = RRR(0.2, 0.2)
    for shape in ((), (3,)):
        solved = solve(dyad, sigma, np.full(shape, offset), np.full(shape, -offset))
        assert (solved.code == Code.INDETERMINATE).all()
        assert np.isnan(everything(solved)).all()


@pytest.mark.parametrize("sigma", MODES)
def test_unequal_links_cannot_bring_their_ends_together(sigma: int) -> None:
    solved = solve(RRR(0.2, 0.3), sigma, np.zeros(2), np.zeros(2))
    assert (solved.code == Code.OUT_OF_REACH).all()
    assert np.isnan(everything(solved)).all()


@given(
    share=st.floats(-13.5, -1.0).map(lambda k: 10.0**k),
    sign=st.sampled_from([-1, 1]),
    edge=st.sampled_from(["outer", "inner"]),
    phi=st.floats(-3.2, 3.2),
    lengths=st.sampled_from([(0.325, 0.225), (0.2, 0.4), (0.3, 0.3)]),
)
def test_the_band_about_an_edge_is_as_wide_as_its_name_says(
    share: float, sign: int, edge: str, phi: float, lengths: tuple[float, float]
) -> None:
    """Outside the band (and a tenth of it for the rounding of this test) the answer is what geometry says."""
    dyad = RRR(*lengths)
    outer, inner = sum(lengths), abs(lengths[0] - lengths[1])
    reach = (outer if edge == "outer" else inner) + sign * share * outer
    x, y = reach * np.cos(phi), reach * np.sin(phi)
    solved = solve(dyad, LEFT, np.array(x), np.array(y))
    distance = abs(reach)
    if share > 1.1 * ROUNDING:
        assert solved.code == (Code.ASSEMBLED if inner < distance < outer else Code.OUT_OF_REACH)
    elif share < 0.9 * ROUNDING:
        at_inner = Code.FOLDED if inner > 0 else Code.INDETERMINATE
        assert solved.code == (Code.STRETCHED if edge == "outer" else at_inner)


def test_the_sign_of_a_singular_cross_product_keeps_the_side_of_the_mode() -> None:
    """atan2 then gives θ2 = −π for a left folded arm and +π for a right one."""
    dyad = RRR(0.4, 0.3)
    theta2 = []
    for sigma in MODES:
        solved = solve(dyad, sigma, np.array(0.1), np.array(0.0))
        dot = solved.u[0] * solved.w[0] + solved.u[1] * solved.w[1]
        theta2.append(float(np.arctan2(solved.cross, dot)))
    assert theta2 == [-np.pi, np.pi]


BAD = [np.nan, np.inf, -np.inf, 1e200, -1e308, 1e308]


@pytest.mark.parametrize("bad", BAD)
@pytest.mark.parametrize("where", range(8))
@pytest.mark.parametrize("reach", [0.4, 0.5, 0.1, 0.9])
@pytest.mark.parametrize("size", [1, 3])
def test_one_number_that_is_not_finite_or_absurd_refuses_its_row_and_no_other(
    bad: float, where: int, reach: float, size: int
) -> None:
    """At an assembled, a stretched, a folded and an unreachable position, in any component of any order."""
    dyad = RRR(0.3, 0.2)
    numbers = [np.full(size, x) for x in (reach, 0.0, 1.0, -2.0, 3.0, 1.0, 1.0, 5.0)]
    good = [x.copy() for x in numbers]
    numbers[where][0] = bad
    pairs, clean = ([(a[i], a[i + 1]) for i in (0, 2, 4, 6)] for a in (numbers, good))
    with np.errstate(all="raise"):
        solved, before = dyad.solve(LEFT, *pairs), dyad.solve(LEFT, *clean)
    if np.isfinite(bad) and where > 1 and reach in (0.5, 0.1):
        # A huge but finite derivative at a singular position: it is singular, and has no rates anyway.
        assert solved.code[0] == before.code[0]
    elif solved.code[0] != Code.OUT_OF_REACH:
        # A huge but finite derivative that only one link feels and that no product overflows.
        assert np.isfinite(bad)
        assert np.isfinite(everything(solved)[:, 0]).all()
    else:
        assert np.isnan(everything(solved)[:, 0]).all()
    if not np.isfinite(bad):
        assert solved.code[0] == Code.OUT_OF_REACH
    assert np.array_equal(everything(solved)[:, 1:], everything(before)[:, 1:], equal_nan=True)
    assert np.array_equal(solved.code[1:], before.code[1:])


anything = st.floats(allow_nan=True, allow_infinity=True)
near = st.sampled_from([0.0, -0.0, 0.1, 0.5, -0.5, 0.3, 5e-324, 1e-160, 1.0])


@given(st.lists(st.one_of(anything, near), min_size=8, max_size=8), st.sampled_from(MODES))
@example([0.5, 0.0, np.inf, 0.0, 0.0, 0.0, 0.0, 0.0], LEFT)
@example([0.3, 0.0, 1e308, 1e308, 1e308, -1e308, 0.0, 0.0], RIGHT)
def test_any_eight_floats_are_answered_and_an_assembled_row_is_finite(x: list[float], sigma: int) -> None:
    dyad = RRR(0.3, 0.2)
    pairs = [(np.array(x[i]), np.array(x[i + 1])) for i in (0, 2, 4, 6)]
    with np.errstate(all="raise"):
        solved = dyad.solve(sigma, *pairs)
    values = everything(solved)
    if solved.code == Code.ASSEMBLED:
        assert np.isfinite(values).all()
        assert np.isfinite(x).all()
    elif solved.code in (Code.STRETCHED, Code.FOLDED):
        assert np.isfinite(values[:6]).all()
        assert np.isfinite(x).all()
        assert np.isnan(values[6:]).all()
    else:
        assert np.isnan(values).all()


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_an_indeterminate_position_with_a_derivative_that_is_not_finite_is_refused_as_any_other(bad: float) -> None:
    zero, odd = np.zeros(2), np.array([bad, 1.0])
    with np.errstate(all="raise"):
        solved = RRR(0.2, 0.2).solve(LEFT, (zero, zero), (odd, zero))
    assert solved.code.tolist() == [Code.OUT_OF_REACH, Code.INDETERMINATE]
