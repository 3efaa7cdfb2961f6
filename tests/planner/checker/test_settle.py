"""Intervals are cut until bounds decide, and what is not decided is refused."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker.settle import FIRST, settle


class Wave:
    """Item k is height[k] sin(t) - 1: its bound over an interval is a chord and height h²/8."""

    def __init__(self, *heights: float) -> None:
        self.heights = np.array(heights)
        self.asked = 0

    def __call__(self, of: IntArray, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
        self.asked += len(of)
        height = self.heights[of]
        taken = np.maximum(height * np.sin(a), height * np.sin(b)) - 1
        return (taken + np.abs(height) * (b - a) ** 2 / 8)[:, None], taken[:, None]


@given(st.lists(st.floats(0.0, 1.0 - 1e-7) | st.floats(1.0 + 1e-7, 3.0), min_size=1, max_size=4))
def test_each_item_is_decided_by_itself(heights: list[float]) -> None:
    found = settle([np.array([0.0, 1.0, 3.0])] * len(heights), 0.5, Wave(*heights))
    # those that exceed zero by more are found in earlier rounds
    assert sorted(excess.of for excess in found) == [k for k, height in enumerate(heights) if height > 1]
    for excess in found:
        assert excess.decided
        assert 0 < excess.amount <= heights[excess.of] - 1
        assert 0 <= excess.time <= 3


def test_a_wave_that_touches_zero_is_not_decided_and_so_refused() -> None:
    wave = Wave(1.0)
    (excess,) = settle([np.array([0.0, 3.0])], 0.5, wave)
    assert not excess.decided
    assert excess.time == pytest.approx(np.pi / 2, abs=1e-5)
    assert wave.asked < 2000


def test_nothing_to_ask_and_an_instant() -> None:
    assert settle([], 0.5, Wave()) == []
    assert settle([np.array([1.0, 1.0])], 0.5, Wave(1.0)) == []
    assert len(settle([np.array([1.0, 1.0])], 0.5, Wave(2.0))) == 1


def test_what_is_not_a_number_is_refused() -> None:
    def lost(_of: IntArray, a: FloatArray, _b: FloatArray) -> tuple[FloatArray, FloatArray]:
        return np.full((len(a), 1), np.nan), np.full((len(a), 1), np.nan)

    (excess,) = settle([np.array([0.0, 1.0])], 0.5, lost)
    assert np.isnan(excess.amount)


def test_ages_do_not_take_ages() -> None:
    wave = Wave(0.5)
    assert settle([np.array([0.0, 1e4])], 1e-3, wave) == []
    assert wave.asked < 10 * FIRST
