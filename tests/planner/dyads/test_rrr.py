"""The dyad, where it can be assembled: against joint space, finite differences, circles, itself in other batches."""

from __future__ import annotations

import doctest

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.experiments import dyad
from assur.experiments.dyad import LEFT, RIGHT, RRR, Assembly, Planar
from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError, InputError
from assur.planner.robots.facts import Code

MODES = [LEFT, RIGHT]
COUNT = 10_000
DYADS = 100

Complex = np.ndarray[tuple[int, ...], np.dtype[np.complex128]]


def planar(z: Complex) -> Planar:
    return np.array(z.real), np.array(z.imag)


def joined(pair: Planar) -> Complex:
    return np.asarray(pair[0] + 1j * pair[1])


def arm(length: FloatArray | float, phi: FloatArray, w: FloatArray, dw: FloatArray, ddw: FloatArray) -> list[Complex]:
    """length · e^{iφ} and three derivatives: the second method, complex numbers and the chain rule."""
    z = length * np.exp(1j * phi)
    return [z, 1j * w * z, (1j * dw - w**2) * z, (1j * (ddw - w**3) - 3 * w * dw) * z]


def random_pairs(rng: np.random.Generator, sigma: int, count: int) -> tuple[RRR, list[Complex], FloatArray]:
    """A dyad, d with three derivatives made in joint space, and the absolute rates (3, 2, count) behind them."""
    dyad = RRR(*rng.uniform(0.1, 0.6, 2))
    theta2 = -sigma * np.arcsin(rng.uniform(0.1, 1.0, count))
    theta2 = np.where(rng.random(count) < 0.5, theta2, -sigma * np.pi - theta2)
    phi1 = rng.uniform(-4, 4, count)
    rates = rng.normal(size=(3, 2, count)) * np.array([3.0, 20.0, 200.0])[:, None, None]
    arms = arm(dyad.l1, phi1, *rates[:, 0]), arm(dyad.l2, phi1 + theta2, *rates[:, 1])
    return dyad, [a + b for a, b in zip(*arms, strict=True)], rates


def solve(dyad: RRR, sigma: int, d: list[Complex]) -> Assembly:
    with np.errstate(all="raise"):
        return dyad.solve(sigma, *(planar(z) for z in d))


@pytest.mark.parametrize("sigma", MODES)
def test_ten_thousand_random_dyads_give_back_the_joint_motion_they_were_made_of(sigma: int) -> None:
    rng = np.random.default_rng(0)
    for _ in range(DYADS):
        dyad, d, rates = random_pairs(rng, sigma, COUNT // DYADS)
        solved = solve(dyad, sigma, d)
        assert (solved.code == Code.ASSEMBLED).all()
        assert (solved.margin >= 0.0999).all()
        assert (-sigma * solved.cross > 0).all()
        for order in range(3):
            # Each order is divided by sin θ2 once more than the one below.
            scale = np.linalg.norm(rates[: order + 1], axis=(0, 1))
            assert (np.abs(np.stack(solved.rates[order]) - rates[order]) / scale).max() < 1e-9


def paths(rng: np.random.Generator, sigma: int, count: int) -> tuple[RRR, Complex, FloatArray]:
    """Smooth paths of d: a start with |sin θ2| > 0.1 in each row, and three waves (frequency, two amplitudes)."""
    dyad, d, _ = random_pairs(rng, sigma, count)
    waves = np.stack([rng.uniform(0.5, 3.0, (3, count)), *rng.normal(size=(2, 3, count)) * 0.05])
    return dyad, d[0], waves


def along(start: Complex, waves: FloatArray, t: FloatArray | float) -> list[Complex]:
    """d and three derivatives at time t on the paths; at t = 0 d is the start."""
    rate, a, b = waves
    turn = np.exp(1j * rate * t)
    parts = (a + 1j * b) * turn
    return [start + (parts - (a + 1j * b)).sum(0), *(((1j * rate) ** k * parts).sum(0) for k in (1, 2, 3))]


@pytest.mark.parametrize("sigma", MODES)
def test_the_elbow_is_where_two_circles_meet(sigma: int) -> None:
    dyad, d, _ = random_pairs(np.random.default_rng(3), sigma, COUNT)
    solved = solve(dyad, sigma, d[:1])
    # Circle of l1 about A and of l2 about B, by the angle at A and nothing else.
    reach = np.abs(d[0])
    at_a = np.arccos((dyad.l1**2 + reach**2 - dyad.l2**2) / (2 * dyad.l1 * reach))
    elbow = dyad.l1 * d[0] / reach * np.exp(1j * sigma * at_a)
    assert np.abs(joined(solved.u) - elbow).max() < 1e-13
    assert np.abs(joined(solved.u) + joined(solved.w) - d[0]).max() < 1e-15
    assert np.abs(np.abs(joined(solved.w)) - dyad.l2).max() < 1e-14
    sine = (joined(solved.w) / joined(solved.u)).imag * dyad.l1 / dyad.l2
    assert np.abs(solved.margin - np.abs(sine)).max() < 1e-13


def rows(solved: Assembly) -> FloatArray:
    parts = [*solved.u, *solved.w, solved.cross, solved.margin, *(x for pair in solved.rates for x in pair)]
    return np.stack([*parts, solved.code.astype(np.float64)])


@pytest.mark.parametrize("sigma", MODES)
def test_a_target_is_solved_to_the_same_bits_alone_and_in_a_batch_of_several_blocks(sigma: int) -> None:
    rng = np.random.default_rng(5)
    dyad, start, waves = paths(rng, sigma, COUNT)
    d = along(start * rng.uniform(0.5, 1.5, COUNT), waves, 0.3)
    d[0][7], d[2][9], d[0][11] = np.nan, np.inf, dyad.l1 + dyad.l2
    whole = rows(solve(dyad, sigma, d))
    assert set(np.unique(whole[-1])) == {Code.ASSEMBLED, Code.OUT_OF_REACH, Code.STRETCHED}
    for i in [*range(40), COUNT - 1]:
        for shape in ((), (1,), (1, 1)):
            alone = rows(solve(dyad, sigma, [z[i].reshape(shape) for z in d]))
            assert alone.shape == (13, *shape)
            assert np.array_equal(alone.ravel(), whole[:, i], equal_nan=True)
    shuffled = rng.permutation(COUNT)
    assert np.array_equal(rows(solve(dyad, sigma, [z[shuffled] for z in d])), whole[:, shuffled], equal_nan=True)
    table = rows(solve(dyad, sigma, [z.reshape(100, 100) for z in d]))
    assert np.array_equal(table.reshape(13, COUNT), whole, equal_nan=True)


@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_only_the_orders_given_are_solved_and_they_do_not_depend_on_the_others(order: int) -> None:
    dyad, d, _ = random_pairs(np.random.default_rng(6), RIGHT, COUNT)
    full, part = solve(dyad, RIGHT, d), solve(dyad, RIGHT, d[: order + 1])
    assert len(part.rates) == order
    assert np.array_equal(rows(part)[:-1], rows(full)[: 6 + 2 * order])
    single = solve(dyad, RIGHT, [z[:1] for z in d[: order + 1]])
    assert np.array_equal(rows(single)[:, 0], rows(part)[:, 0])


def test_an_empty_batch_has_an_empty_answer() -> None:
    none = np.empty((0, 3))
    solved = RRR(0.3, 0.2).solve(LEFT, (none, none), (none, none))
    assert rows(solved).shape == (9, 0, 3)


grid = st.integers(-12, 12).map(lambda k: k * 0.05)


@given(x=grid, y=grid, lengths=st.sampled_from([(0.2, 0.2), (0.3, 0.25), (0.15, 0.4)]), sigma=st.sampled_from(MODES))
def test_on_a_grid_every_target_is_assembled_or_refused_for_what_it_is(
    x: float, y: float, lengths: tuple[float, float], sigma: int
) -> None:
    dyad = RRR(*lengths)
    solved = solve(dyad, sigma, [np.array(x + 1j * y), np.array(1.0 + 0.5j), np.array(0.5 - 2j), np.array(3j)])
    reach, outer, inner = np.hypot(x, y), sum(lengths), abs(lengths[0] - lengths[1])
    far = min(abs(reach - outer), abs(reach - inner)) > 1e-9
    if far:
        assert solved.code == (Code.ASSEMBLED if inner < reach < outer else Code.OUT_OF_REACH)
    else:
        edge = Code.STRETCHED if abs(reach - outer) < 1e-9 else Code.FOLDED if reach > 1e-9 else Code.INDETERMINATE
        assert solved.code == edge
    if solved.code == Code.ASSEMBLED:
        moves_back(dyad, solved, [x + 1j * y, 1.0 + 0.5j, 0.5 - 2j, 3j])


def moves_back(dyad: RRR, solved: Assembly, d: list[complex], slack: float = 1e-13) -> None:
    """The angles and rates found, put through the chain rule, give d and its derivatives again."""
    none = (np.array(0.0), np.array(0.0))
    rates = [*solved.rates, none, none, none][:3]
    arms = []
    for link, (length, pair) in enumerate(((dyad.l1, solved.u), (dyad.l2, solved.w))):
        w, dw, ddw = (each[link] for each in rates)
        arms.append(arm(length, np.angle(joined(pair)), w, dw, ddw))
    for asked, a, b in zip(d, *arms, strict=False):
        assert abs(a + b - asked) <= slack * (abs(a) + abs(b) + abs(asked))


@given(
    gap=st.floats(2.1, 11.5).map(lambda k: 10.0**-k),
    outer=st.booleans(),
    phi=st.floats(-3.2, 3.2),
    sigma=st.sampled_from(MODES),
    speed=st.floats(-2.0, 2.0),
)
def test_just_inside_the_edge_of_reach_the_rates_still_move_the_end_as_asked(
    gap: float, outer: bool, phi: float, sigma: int, speed: float
) -> None:
    """Ill conditioned, as a nearly stretched arm is, but backward stable: what is found belongs to the d that was asked
    (to the digits that D has there: rounding of 1e-15 over sin² θ2)."""
    dyad = RRR(0.3, 0.2)
    reach = 0.5 - gap if outer else 0.1 + gap
    d = [reach * np.exp(1j * phi), complex(speed, 0.3)]
    solved = solve(dyad, sigma, [np.array(z) for z in d])
    assert solved.code == Code.ASSEMBLED
    assert 0 < solved.margin < 0.4
    moves_back(dyad, solved, d, slack=1e-13 + 1e-15 / float(solved.margin) ** 2)


@pytest.mark.parametrize("lengths", [(0.0, 0.2), (0.2, -0.1), (np.nan, 0.2), (0.2, np.inf), (1e-7, 0.2)])
def test_a_dyad_without_proper_lengths_is_refused(lengths: tuple[float, float]) -> None:
    with pytest.raises(InputError, match="a length from"):
        RRR(*lengths)


def test_what_is_wrong_in_the_call_itself_is_a_fault() -> None:
    dyad, x, y = RRR(0.3, 0.2), np.zeros(3), np.zeros(2)
    with pytest.raises(FaultError, match="sigma 0"):
        dyad.solve(0, (x, x))
    with pytest.raises(FaultError, match="4 derivatives"):
        dyad.solve(LEFT, (x, x), (x, x), (x, x), (x, x), (x, x))
    with pytest.raises(FaultError, match="shapes"):
        dyad.solve(LEFT, (x, x), (x, y))


def test_the_examples_in_the_docstrings_run() -> None:
    result = doctest.testmod(dyad)
    assert result.attempted > 0
    assert result.failed == 0
