"""Times of knots: all switches of a law, and enough in between."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray

MOST_KNOTS = 20_000
"""Knots of one leg, about: a longer or slower one has them further apart. Whether its spline then keeps to the path is
measured, as it always is. A document has room for 50,000 knots."""


def spaced(marks: FloatArray, spacing: float) -> FloatArray:
    """Times (T,) from the first of `marks` (M,), which increase, to the last: all marks, and evenly between two of
    them as many as it takes for steps of `spacing` s at most, or for `MOST_KNOTS` steps in all."""
    length = marks[1:] - marks[:-1]
    spacing = max(spacing, float(marks[-1] - marks[0]) / MOST_KNOTS)
    count = np.maximum(1, np.ceil(length / spacing)).astype(int)
    number = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    return np.append(np.repeat(marks[:-1], count) + number * np.repeat(length / count, count), marks[-1])
