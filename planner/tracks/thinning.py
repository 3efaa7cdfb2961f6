"""Few samples in place of many, such that what is interpolated between them is near all of the many."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from assur.planner.arrays import FloatArray, IntArray

Off = Callable[[int, int], FloatArray]
"""How far samples i..k, (k - i + 1,), are from what is interpolated between sample i and sample k, in parts of what is
allowed; the first and the last are 0."""


def kept(count: int, off: Off) -> IntArray:
    """Numbers of the samples, out of `count`, that are kept: the first, the last, and as many between them as are
    needed for no other to be off by more than is allowed.

    A span is parted at the sample that is furthest off (Ramer, Douglas and Peucker).
    """
    if count < 3:
        return np.arange(count)
    found, spans = {0, count - 1}, [(0, count - 1)]
    while spans:
        i, k = spans.pop()
        if k - i < 2:
            continue
        amounts = off(i, k)
        worst = int(np.argmax(amounts))
        if amounts[worst] <= 1.0:
            continue
        # the ends are off by rounding at most, and a span must become shorter
        middle = min(max(i + worst, i + 1), k - 1)
        found.add(middle)
        spans += [(i, middle), (middle, k)]
    return np.array(sorted(found))


def shares(t: FloatArray, i: int, k: int) -> FloatArray:
    """Where times i..k are between the first and the last of them, from 0 to 1; 0 where these are one."""
    whole = t[k] - t[i]
    return (t[i : k + 1] - t[i]) / whole if whole > 0.0 else np.zeros(k - i + 1)


def kept_of_curves(t: FloatArray, values: FloatArray, allowed: FloatArray) -> IntArray:
    """Numbers of the samples of curves (T, C) at times t (T,), which may repeat where a curve jumps, that are kept so
    that straight lines between them are off by `allowed` (C,) at most."""

    def off(i: int, k: int) -> FloatArray:
        share = shares(t, i, k)[:, None]
        between = values[i] + share * (values[k] - values[i])
        found: FloatArray = (np.abs(values[i : k + 1] - between) / allowed).max(-1)
        return found

    return kept(len(t), off)
