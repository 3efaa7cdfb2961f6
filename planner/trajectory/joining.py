"""Knots of two motions that meet, put together."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray

MEETING_ACCELERATION = 1e-6
"""rad/s² or m/s². Motions that differ by more than this where they meet do so by a jump of the acceleration."""


def joined(one: FloatArray, other: FloatArray) -> FloatArray:
    """Knots (K, 1 + 3n) of two motions that meet; at the meeting what ends the first and begins the second, once if
    they agree.

    Where either may jump the meeting may have three or four knots: those in the middle last no time, and go. Time and
    place of the meeting are the first one's.
    """
    n, last, first = (one.shape[1] - 1) // 3, len(one) - 1, 0
    while last > 0 and one[last - 1, 0] == one[last, 0]:
        last -= 1
    while first + 1 < len(other) and other[first + 1, 0] == other[first, 0]:
        first += 1
    begin = np.concatenate([one[last, :-n], other[first, -n:]])
    jumps = (np.abs(begin[-n:] - one[last, -n:]) > MEETING_ACCELERATION).any()
    return np.concatenate([one[: last + 1], *([begin[None]] if jumps else []), other[first + 1 :]])
