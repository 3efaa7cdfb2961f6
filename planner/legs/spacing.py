"""Times of knots: all switches of a law, and enough in between."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray


def spaced(marks: FloatArray, spacing: float) -> FloatArray:
    """Times (T,) from the first of `marks` (M,), which increase, to the last: all marks, and evenly between two of
    them as many as it takes for steps of `spacing` s at most."""
    length = marks[1:] - marks[:-1]
    count = np.maximum(1, np.ceil(length / spacing)).astype(int)
    number = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    return np.append(np.repeat(marks[:-1], count) + number * np.repeat(length / count, count), marks[-1])
