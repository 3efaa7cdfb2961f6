"""Times of knots between the switches of a law."""

from __future__ import annotations

import itertools

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from assur.planner.legs.follower import spaced


@given(st.integers(0, 10**6), st.sampled_from([1e-3, 0.02, 0.3, 5.0]))
def test_all_marks_are_there_and_what_is_between_is_even_and_close_enough(seed: int, spacing: float) -> None:
    rng = np.random.default_rng(seed)
    marks = np.cumsum(10 ** rng.uniform(-4, 0, rng.integers(2, 20))) + rng.uniform(-2, 2)
    t = spaced(marks, spacing)
    assert np.isin(marks, t).all()
    assert (np.diff(t) > 0).all()
    assert np.diff(t).max() <= spacing * (1 + 1e-9)
    parts = [
        np.linspace(a, b, max(1, int(np.ceil((b - a) / spacing))), endpoint=False) for a, b in itertools.pairwise(marks)
    ]
    assert np.array_equal(t, np.concatenate([*parts, marks[-1:]]))
