"""S-curves behind a lag: the response, its derivatives, and fits of motion whose numbers are known."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.arrays import FloatArray
from assur.scenes.identification.recording import JointRecord
from assur.scenes.identification.scurve import SCurves, refined, searched, triangle
from benchmarks.recorded_motion import Limits, motion

LIMITS = Limits(np.array([4.0]), np.array([40.0]), np.array([1600.0]))


def record(points: list[float], rests: list[float], limits: Limits = LIMITS, step: float = 0.002) -> JointRecord:
    """Exact readings of one joint."""
    made = motion(np.array(points)[:, None], rests, limits)
    time = np.arange(0.0, made.end, step)
    return JointRecord(time, made.at(time)[:, 0])


@pytest.mark.parametrize("rows", [5, 127, 128, 400])
def test_a_triangle_has_the_products_of_the_rows_that_it_stands_for(rows: int) -> None:
    a = np.random.default_rng(0).normal(size=(rows, 5))
    r = triangle(a)
    assert r.shape == (5, 5)
    assert r.T @ r == pytest.approx(a.T @ a)


def derivative(curves: SCurves, moves: FloatArray, jerk: float, lag: float, i: int) -> FloatArray:
    """Of the weighted model by a parameter, the last of which is the logarithm of the jerk."""
    ends = []
    for way in (-1, 1):
        x, there = moves.copy(), jerk
        if i < len(x):
            x[i] += way * 1e-6 * max(abs(x[i]), 1e-3)
        else:
            there *= np.exp(way * 1e-6)
        curves._jerk, curves._lag = there, lag
        curves._residual(x)
        ends.append(-curves._rows[:, -1].copy())
    size = 1e-6 * max(abs(moves[i]), 1e-3) if i < len(moves) else 1e-6
    return (ends[1] - ends[0]) / (2 * size)


@pytest.mark.parametrize("lag", [0.0, 0.004])
def test_the_derivatives_are_those_of_differences(lag: float) -> None:
    (segment,) = record([0.0, 0.8], [0.2]).segments()
    curves = SCurves(segment)
    moves = np.array([0.15, 0.35, 3.9, 6e-4, 5e-4])
    curves._jerk, curves._lag = 1500.0, lag
    curves._residual(moves)
    rows = curves._rows[:, 1:-1].copy()
    for i in range(6):
        wanted = derivative(curves, moves, 1500.0, lag, i)
        assert rows[:, i] == pytest.approx(wanted, abs=1e-5 * np.abs(wanted).max())


def test_a_move_is_found_again_from_afar() -> None:
    (segment,) = record([0.3, 1.5], [0.2]).segments()
    curves = SCurves(segment)
    fit = searched([curves], 0.0)
    assert fit.jerk == pytest.approx(1600, rel=1e-6)
    (one,) = fit.fits
    assert one.moves[0, 2] == pytest.approx(4.0, rel=1e-8)
    assert one.acceleration() == pytest.approx(np.full((1, 2), 40.0), rel=1e-6)
    assert one.held() == pytest.approx(np.full((1, 2), 0.1 - 0.025), rel=1e-4)  # v / A − A / J
    assert np.abs(one.residual / segment.weight).max() < 1e-9


def test_moves_without_a_rest_between_them_are_found_together() -> None:
    (segment,) = record([0.0, 0.8, 0.1, 1.4], [0.0, 0.0, 0.2]).segments()
    assert len(segment.moved) == 3
    fit = searched([SCurves(segment)], 0.0)
    assert fit.jerk == pytest.approx(1600, rel=1e-5)
    assert fit.fits[0].acceleration() == pytest.approx(np.full((3, 2), 40.0), rel=1e-4)


def test_what_is_known_of_a_motion_helps_at_another_jerk_and_lag() -> None:
    (segment,) = record([0.0, 1.2], [0.2]).segments()
    curves = SCurves(segment)
    far = curves.fit(400.0, 0.01)
    assert refined([curves], [far], 0.0).jerk == pytest.approx(1600, rel=1e-6)


def test_pulses_that_overlap_are_told_apart_without_another_motion() -> None:
    """Exchanging the two ramps between the pulses leaves the motion, but not its speed."""
    (segment,) = record([0.0, 0.45], [0.2]).segments()
    curves = SCurves(segment)
    right = searched([curves], 0.0).fits[0]
    x = right.moves[0]
    v, (ma, md) = float(x[2]), x[:2]
    a, b = np.sqrt(v / 1600 + x[3:]), np.sqrt(x[3:])
    between = (md - a[1]) - (ma + b[0])  # from where the first pulse falls to where the next begins
    wide = b + between / 2
    longer = np.array([ma + between / 2, md - between / 2, 1600 * ((a[0] + between / 2) ** 2 - wide[0] ** 2), *wide**2])
    curves._jerk, curves._lag = 1600.0, 0.0
    missed = []
    for moves in (x, longer):
        curves._residual(moves)
        missed.append(curves._rows[:, -1] / segment.weight)
    assert missed[0] == pytest.approx(missed[1], abs=1e-8)
    assert longer[2] > 1.05 * v
    apart = curves._apart(longer)
    assert apart is not None
    assert apart[0] == pytest.approx(x, rel=1e-5)
    assert curves._apart(right.moves.ravel()) is None
