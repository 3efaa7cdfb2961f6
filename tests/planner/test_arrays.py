"""Reductions of a short last axis: what NumPy's own say, in every shape."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.arrays import every, largest

SHAPES = [(1,), (4,), (0, 3), (7, 1), (5, 4), (3, 2, 6)]


@pytest.mark.parametrize("shape", SHAPES)
def test_every_and_largest_are_all_and_max_of_the_last_axis(shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        values = rng.normal(size=shape)
        flags = values > -1.0
        assert np.array_equal(every(flags), flags.all(-1))
        assert every(flags).shape == shape[:-1]
        assert np.array_equal(largest(values), values.max(-1))
        assert largest(values).shape == shape[:-1]


def test_one_false_anywhere_is_not_every_and_not_a_number_is_the_largest() -> None:
    for column in range(4):
        flags, values = np.ones((2, 4), dtype=bool), np.zeros((2, 4))
        flags[1, column], values[1, column] = False, np.nan
        assert every(flags).tolist() == [True, False]
        assert largest(values)[0] == 0
        assert np.isnan(largest(values)[1])
