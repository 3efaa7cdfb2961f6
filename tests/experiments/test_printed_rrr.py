"""The mended printed equations of source 000: right by themselves, and the same as the planner's dyad."""

from __future__ import annotations

import numpy as np
import pytest

from assur.experiments import printed_rrr as printed
from assur.experiments.dyad import LEFT, RIGHT, RRR
from assur.experiments.printed_rrr import Point
from assur.planner.arrays import FloatArray
from assur.planner.frames.motion import Motion
from assur.planner.robots.facts import Code, Limits
from assur.planner.robots.scara import Scara

SIGMA = {1: LEFT, 2: RIGHT}


def point(*orders: FloatArray) -> Point:
    """A point from position, velocity and acceleration, each (..., 2 or more)."""
    return Point(*(order[..., axis] for order in orders for axis in (0, 1)))


def vectors_about(x: float, y: float, t: FloatArray) -> Point:
    """A path through (x, y) at t = 0 with velocity (0.7, −0.4) and acceleration (−1.1, 0.9)."""
    return Point(
        x + 0.7 * t - 0.55 * t**2, y - 0.4 * t + 0.45 * t**2, 0.7 - 1.1 * t, -0.4 + 0.9 * t, -1.1 + 0 * t, 0.9 + 0 * t
    )


@pytest.mark.parametrize(
    ("x", "y"),
    [(0.0, 0.8), (0.0, -0.8), (0.6, 0.3), (0.6, -0.3), (-0.6, 0.3), (-0.6, -0.3), (0.6, 0.0), (-0.6, 0.0)],
)
def test_figure_2_as_mended_is_the_derivative_of_the_angle_in_every_case(x: float, y: float) -> None:
    step = 1e-3
    theta, theta_d, theta_dd = printed.vector_angle(vectors_about(x, y, np.array([-step, 0.0, step])))
    theta = np.unwrap(theta)
    assert theta[1] == pytest.approx(np.arctan2(y, x), abs=1e-15) or x < 0
    assert theta_d[1] == pytest.approx((theta[2] - theta[0]) / (2 * step), abs=2e-5)
    assert theta_dd[1] == pytest.approx((theta_d[2] - theta_d[0]) / (2 * step), abs=2e-5)


def test_figure_2_has_no_angle_for_a_null_vector_and_figure_3_no_derivative() -> None:
    null = vectors_about(0.0, 0.0, np.array(0.0))
    assert all(np.isnan(part) for part in printed.vector_angle(null))
    zero = Point(*(np.array(0.0),) * 6)
    length, length_d, length_dd = printed.distance(zero, null)
    assert length == 0
    assert np.isnan(length_d)
    assert np.isnan(length_dd)


@pytest.mark.parametrize("mode", [1, 2])
def test_the_dyad_as_mended_is_the_derivative_of_itself(mode: int) -> None:
    """Equations 2, 3, 7 and 8 by central differences on a dyad whose ends both move."""
    step = 1e-3
    t = np.array([-step, 0.0, step])
    a, b = vectors_about(0.1, 0.2, 1.3 * t), vectors_about(0.6, -0.1, t)
    a = Point(a.x, a.y, 1.3 * a.xd, 1.3 * a.yd, 1.69 * a.xdd, 1.69 * a.ydd)
    got = printed.dyad(a, b, 0.35, 0.45, mode)
    c = got.c
    for below, above in [(c.x, c.xd), (c.y, c.yd), (c.xd, c.xdd), (c.yd, c.ydd), got.phi[:2], got.phi[1:]]:
        assert above[1] == pytest.approx((below[2] - below[0]) / (2 * step), rel=5e-5, abs=5e-5)


def test_a_dyad_that_cannot_be_assembled_is_not_and_an_aligned_one_has_no_rates() -> None:
    zero = np.zeros(3)
    a = Point(*(zero,) * 6)
    b = Point(np.array([0.6, 0.5, 0.05]), zero, zero + 1, zero, zero, zero)
    got = printed.dyad(a, b, 0.25, 0.25, 1)
    assert np.isnan(got.c.x[0])
    assert got.ratio[1] == 1
    assert got.c.x[1] == 0.25
    assert np.isnan(got.c.xd[1])
    assert np.isfinite(got.c.xdd[2])
    with pytest.raises(ValueError, match="assembly mode 3"):
        printed.dyad(a, b, 0.25, 0.25, 3)


@pytest.mark.parametrize("mode", [1, 2])
def test_on_the_spiral_of_the_source_the_dyad_is_the_printed_one(mode: int) -> None:
    path = printed.spiral(np.linspace(0.0, 8.0, 4001))
    dyad = RRR(printed.L_AB, printed.L_BC)
    solved = dyad.solve(SIGMA[mode], *((x[..., 0], x[..., 1]) for x in path[:3]))
    theta1, theta2 = printed.scara(point(*path[:3]), printed.L_AB, printed.L_BC, mode)
    assert (solved.code == Code.ASSEMBLED).all()
    pairs = [(np.arctan2(solved.u[1], solved.u[0]), np.arctan2(solved.w[1], solved.w[0])), *solved.rates]
    for (first, second), one, two in zip(pairs, theta1, theta2, strict=True):
        assert np.abs(np.exp(1j * first) - np.exp(1j * one)).max() < 1e-9 or np.abs(first - one).max() < 1e-9
        # Equation 15 has the sign of θ2 turned.
        assert np.abs(np.sin((second - first + two) / 2)).max() < 1e-9 or np.abs(second - first + two).max() < 1e-9


@pytest.mark.parametrize("mode", [1, 2])
def test_on_the_spiral_of_the_source_the_scara_moves_as_printed(mode: int) -> None:
    """The rates exactly as numbers (not as angles), and θ2 with Denavit-Hartenberg's sign."""
    wide = np.full(3, 4.0)
    robot = Scara(
        name="printed", l1=printed.L_AB, l2=printed.L_BC, axes=3, limits=Limits(-wide, wide, wide, wide, wide)
    )
    path = printed.spiral(np.linspace(0.0, 8.0, 4001))
    none = np.zeros(4001)
    got = robot.inverse(Motion.of(*path, none, none, none, none), {1: 0, 2: 1}[mode])
    theta1, theta2 = printed.scara(point(*path[:3]), printed.L_AB, printed.L_BC, mode)
    assert (got.code == Code.ASSEMBLED).all()
    assert (got.q[:, 1] < 0).all() if mode == 1 else (got.q[:, 1] > 0).all()
    for joints, one, two, z in zip((got.q, got.qd, got.qdd), theta1, theta2, path[:3], strict=True):
        assert np.abs(joints[:, 0] - one).max() < 1e-9 * max(1.0, np.abs(one).max())
        assert np.abs(joints[:, 1] + two).max() < 1e-9 * max(1.0, np.abs(two).max())
        assert np.array_equal(joints[:, 2], z[:, 2])


@pytest.mark.parametrize("mode", [1, 2])
def test_on_random_dyads_whose_ends_both_move_c_moves_as_printed(mode: int) -> None:
    rng = np.random.default_rng(7)
    a_state, b_state = rng.normal(size=(2, 3, 10_000, 2)) * 0.2
    a, b = point(*a_state), point(*b_state)
    old, dyad = printed.dyad(a, b, 0.3, 0.25, mode), RRR(0.3, 0.25)
    difference = b_state - a_state
    new = dyad.solve(SIGMA[mode], *((x[:, 0], x[:, 1]) for x in difference))
    assembled = new.code == Code.ASSEMBLED
    assert np.array_equal(assembled, np.abs(old.ratio) < 1)
    far = assembled & (new.margin > 0.1)
    assert far.sum() > 3000
    w, dw = new.rates[0][0][far], new.rates[1][0][far]
    ux, uy = new.u[0][far], new.u[1][far]
    expected = [
        (a.x[far] + ux, old.c.x[far]),
        (a.y[far] + uy, old.c.y[far]),
        (a.xd[far] - w * uy, old.c.xd[far]),
        (a.yd[far] + w * ux, old.c.yd[far]),
        (a.xdd[far] - dw * uy - w * w * ux, old.c.xdd[far]),
        (a.ydd[far] + dw * ux - w * w * uy, old.c.ydd[far]),
    ]
    for ours, theirs in expected:
        assert (np.abs(ours - theirs) / (1 + np.abs(theirs))).max() < 1e-9


def test_the_spiral_is_the_one_of_equation_16_and_its_derivatives() -> None:
    position, *_ = printed.spiral(np.array([0.0, 1.0, 8.0]))
    assert np.allclose(position, [[0.1, -0.02, 0.05], [0.12, 0.0, 0.06], [0.1, -0.02, 0.13]], atol=1e-15)
    t, step = np.linspace(0.1, 7.9, 50), 1e-4
    before, after, here = printed.spiral(t - step), printed.spiral(t + step), printed.spiral(t)
    for order in range(3):
        difference = (after[order] - before[order]) / (2 * step)
        assert np.abs(difference - here[order + 1]).max() < 1e-8
