"""Few samples instead of many: interpolation between them is within an allowed error of all of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from assur.planner.arrays import FloatArray, IntArray

SpanError = Callable[[int, int], FloatArray]
"""Errors of samples i..k, (k - i + 1,), if they are interpolated between sample i and sample k, as fractions of the
allowed error; 0 at both ends."""


def needed(count: int, error: SpanError) -> IntArray:
    """Indices of the samples to keep, out of `count`: the first, the last, and those that the allowed error requires.

    A span is split at its worst sample (Ramer, Douglas and Peucker).
    """
    if count < 3:
        return np.arange(count)
    kept, spans = {0, count - 1}, [(0, count - 1)]
    while spans:
        i, k = spans.pop()
        if k - i < 2:
            continue
        errors = error(i, k)
        worst = int(np.argmax(errors))
        if errors[worst] <= 1.0:
            continue
        # the errors of the ends are rounding, and a span must become shorter
        middle = min(max(i + worst, i + 1), k - 1)
        kept.add(middle)
        spans += [(i, middle), (middle, k)]
    return np.array(sorted(kept))


def needed_of_curves(t: FloatArray, values: FloatArray, allowed: FloatArray) -> IntArray:
    """Indices of the samples to keep of curves (T, C) at times t (T,), for errors of straight lines up to `allowed`
    (C,). A time may occur twice: there a curve jumps."""

    def error(i: int, k: int) -> FloatArray:
        line = values[i] + shares(t, i, k)[:, None] * (values[k] - values[i])
        return np.asarray((np.abs(values[i : k + 1] - line) / allowed).max(-1))

    return needed(len(t), error)


def shares(t: FloatArray, i: int, k: int) -> FloatArray:
    """Times i..k as shares, 0 to 1, of the time from i to k; 0 where both are the same."""
    whole = t[k] - t[i]
    return (t[i : k + 1] - t[i]) / whole if whole > 0.0 else np.zeros(k - i + 1)
