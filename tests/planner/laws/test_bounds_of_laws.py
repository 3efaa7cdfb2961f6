"""Bounds are never below the truth, and hardly above it."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray
from assur.planner.kernels import law_columns as c
from assur.planner.laws import (
    Change,
    Law,
    Pose,
    conveyor,
    indexer,
    keyframes,
    oscillation,
    swing,
)
from assur.planner.laws.law import Ends
from tests.planner.laws.bounded import bounded, rates
from tests.planner.laws.laws import cases, directions, intervals, samples, valid_kinds


def bound(law: Law, start: float, end: float, n: FloatArray) -> FloatArray:
    """(4,)"""
    return bounded(law, np.array([start]), np.array([end]), n[None]).table[:, 0]


@pytest.mark.parametrize("kind", valid_kinds)
@given(data=st.data())
def test_a_bound_is_at_least_every_sample_and_hardly_more_than_the_greatest(kind: str, data: st.DataObject) -> None:
    case = data.draw(cases((kind,)))
    n = data.draw(directions())
    start, end = data.draw(intervals(case))
    found = bound(case.law, start, end, n)
    within = rates(case.law.motion(samples(case, start, end)), n).max(axis=1)
    assert (found >= within * (1 - 1e-14) - 1e-15).all()

    # At a jump of the acceleration the value just before belongs to the closed interval too, on either end.
    before = np.maximum(np.nextafter([start, *(s for s in case.switches if start <= s <= end)], -9), case.window[0])
    truth = np.maximum(within, rates(case.law.motion(before), n).max(axis=1))
    moved = case.law.motion(np.append(samples(case, start, end), before))
    truth[3] = math.hypot(np.abs(moved.yaw_dd).max(), np.abs(moved.yaw_d).max() ** 2)
    if np.abs(n).max() < 1.0:
        return  # the box of its coordinates (K44) is exact along an axis only
    # what a bound is rounded up by is of the law, whatever the direction
    moved = case.law.motion(samples(case, *case.window))
    largest = np.max([rates(moved, axis).max(axis=1) for axis in np.eye(3)], axis=0)
    # samples of 4 s are 2.7 ms apart, and miss the peak of an index of 0.2 s by less than 7e-4 of it
    missed = 1e-3 if case.law.kind == "indexer" else 1e-4
    assert (found <= truth * (1 + missed) + 1e-9 * (1 + largest)).all()


@given(st.data())
def test_the_bound_of_an_interval_is_the_greatest_of_its_parts(data: st.DataObject) -> None:
    case = data.draw(cases())
    n = data.draw(directions())
    start, end = data.draw(intervals(case))
    cuts = np.linspace(start, end, 6)
    whole = bound(case.law, start, end, n)
    parts = bounded(case.law, cuts[:-1], cuts[1:], np.tile(n, (5, 1))).table.max(axis=1)
    assert (parts <= whole * (1 + 1e-9) + 1e-9).all()
    # of what turns the greatest rate and the greatest acceleration need not be in one part, nor of a box (K44)
    exact = [True, True, True, False]
    if np.abs(n).max() == 1.0:
        np.testing.assert_allclose(parts[exact], whole[exact], rtol=1e-9, atol=1e-9)


@given(st.floats(-9e5, 9e5))
@example(123456.789)
def test_the_bound_of_an_index_holds_in_exact_arithmetic_far_from_time_zero(time: float) -> None:
    dial, up = indexer(Pose(), 0.8, 0.37, 0.0, start=0.3), np.array([0.0, 0.0, 1.0])
    u = ((Fraction(time) - Fraction(0.3)) % Fraction(0.37)) / Fraction(0.37)
    rate = 140 * u**3 * (1 - u) ** 3 * Fraction(0.8) / Fraction(0.37)
    rate_d = 420 * u**2 * (1 - u) ** 2 * (1 - 2 * u) * Fraction(0.8) / Fraction(0.37) ** 2
    found = bound(dial, time, time, up)
    assert Fraction(float(found[2])) >= rate
    assert Fraction(float(found[3])) ** 2 >= rate_d**2 + rate**4


ROUND = (Pose(), Pose(0.3, 0.1, 0.2, 2.0), Pose(-0.2, 0.4, 0.1, -1.0), Pose(yaw=-2.0 * math.pi))
"""Once round, back at the first pose."""
FAR: dict[str, Law] = {
    "turn": indexer(Pose(), 0.8, 0.37, 0.11, start=0.3),
    "swing": swing(Pose(), 0.5, 0.7),
    "oscillation": oscillation(Pose(), (0.0, 0.0, 1.0), 0.5, 0.7),
    "repeated": keyframes((0.3, 0.4, 0.65, 0.71), ROUND, "periodic"),
}


@pytest.mark.parametrize("kind", FAR)
@given(st.floats(-9e5, 9e5), st.floats(0.0, 0.9))
def test_a_bound_holds_far_from_time_zero_where_phases_round(kind: str, start: float, length: float) -> None:
    law, up = FAR[kind], np.array([0.0, 0.0, 1.0])
    t = np.linspace(start, start + length, 9)[:-1]
    assert (bound(law, start, start + length, up) * (1 + 1e-14) >= rates(law.motion(t), up).max(axis=1)).all()


@pytest.mark.parametrize("ends", ["periodic", "clamped"])
@given(
    st.integers(-(10**6), 10**6),
    st.integers(0, 3),
    st.one_of(st.sampled_from([-1e-10, 0.0, 1e-10]), st.floats(-0.05, 0.05)),
)
def test_the_bound_of_a_spline_holds_in_exact_arithmetic_also_far_from_time_zero(
    ends: Ends, rounds: int, knot: int, beside: float
) -> None:
    law, up = keyframes((0.3, 0.4, 0.65, 0.71), ROUND, ends), np.array([0.0, 0.0, 1.0])
    start, period = Fraction(law.row[c.START]), Fraction(law.row[c.PERIOD])
    begins, end = law.side[:, c.PIECE_BEGIN].tolist(), float(law.side[-1, c.PIECE_END])
    time = float(start + rounds * period + Fraction([*begins, end][knot]) + Fraction(beside))
    time = min(max(time, law.valid[0]), law.valid[1])
    within = (Fraction(time) - start) % (period or 1)
    piece = max(i for i in range(3) if Fraction(begins[i]) <= within)
    u, rates_, powers = within - Fraction(begins[piece]), law.side[piece, c.RATE :], law.side[piece, c.POWER :]
    pull = [[Fraction(x) for x in powers[i * c.MOST_POWERS :][:2].tolist()] for i in (2, 3)]
    rate = [Fraction(float(rates_[i])) + u * (a + u * j / 2) for i, (a, j) in zip((2, 3), pull, strict=True)]
    rate_d = [a + u * j for a, j in pull]
    found = [Fraction(float(value)) for value in bound(law, time, time, up)]
    assert found[0] >= abs(rate[0])
    assert found[1] >= abs(rate_d[0])
    assert found[2] >= abs(rate[1])
    assert found[3] ** 2 >= rate_d[1] ** 2 + rate[1] ** 4


def test_a_jump_of_the_acceleration_counts_on_both_of_its_sides() -> None:
    belt = conveyor(Pose(), 0.0, (Change(1.0, 1.0, 2.0, math.inf),))
    along = np.array([1.0, 0.0, 0.0])
    assert belt.motion(np.array([1.0, 1.5])).a[:, 0].tolist() == [2.0, 0.0]
    for start, end, greatest in ((0.5, 1.0, 2.0), (1.0, 1.0, 2.0), (1.5, 1.5, 2.0), (1.5, 9.0, 2.0), (1.6, 9.0, 0.0)):
        np.testing.assert_allclose(bound(belt, start, end, along)[1], greatest, atol=1e-9)
