"""Knots of two motions that meet, put together."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray

Knots = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Times (K,), q, q̇, q̈ (K, n)."""

MEETING_ACCELERATION = 1e-6
"""rad/s² or m/s². Motions that differ by more than this where they meet do so by a jump of the acceleration."""


def joined(one: Knots, other: Knots) -> Knots:
    """Knots of two motions that meet; at the meeting what ends the first and begins the second, once if they agree.

    Where either may jump the meeting may have three or four knots: those in the middle last no time, and go. Time and
    place of the meeting are the first one's.
    """
    last, first = len(one[0]) - 1, 0
    while last > 0 and one[0][last - 1] == one[0][last]:
        last -= 1
    while first + 1 < len(other[0]) and other[0][first + 1] == other[0][first]:
        first += 1
    parts = [tuple(column[: last + 1] for column in one)]
    if (np.abs(other[3][first] - one[3][last]) > MEETING_ACCELERATION).any():
        parts.append((*(column[last : last + 1] for column in one[:3]), other[3][first : first + 1]))
    parts.append(tuple(column[first + 1 :] for column in other))
    time, q, qd, qdd = (np.concatenate(column) for column in zip(*parts, strict=True))
    return time, q, qd, qdd
