"""The reduction of a short last axis: what NumPy's own says, in every shape."""

from __future__ import annotations

import numpy as np
import pytest

from assur.planner.arrays import every

SHAPES = [(1,), (4,), (0, 3), (7, 1), (5, 4), (3, 2, 6)]


@pytest.mark.parametrize("shape", SHAPES)
def test_every_is_all_of_the_last_axis(shape: tuple[int, ...]) -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        flags = rng.normal(size=shape) > -1.0
        assert np.array_equal(every(flags), flags.all(-1))
        assert every(flags).shape == shape[:-1]


def test_one_false_anywhere_is_not_every() -> None:
    for column in range(4):
        flags = np.ones((2, 4), dtype=bool)
        flags[1, column] = False
        assert every(flags).tolist() == [True, False]
