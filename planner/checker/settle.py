"""Decides whether quantities stay below zero over an interval, from bounds that get better as intervals get shorter."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from planner.arrays import FloatArray

PARTS = 4
"""Into how many an undecided interval is cut: remainders shrink as h² or faster."""
ROUNDS = 10
"""After ten rounds intervals of 10 ms are 10 ns long. What is not decided by then is refused."""
MOST = 200_000
"""Intervals in a round after which the search ends undecided, which is a refusal too."""

Judge = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]
"""For intervals [a, b] (N,): upper bounds over each (N, C) of C quantities, and values that they take in it (N, C)."""


@dataclass(frozen=True, slots=True)
class Excess:
    """Quantity number `column` exceeds zero by `amount` around `time`, or could not be shown not to."""

    column: int
    amount: float
    time: float
    decided: bool


def settle(edges: FloatArray, coarsest: float, judge: Judge) -> Excess | None:
    """None if every quantity stays at or below zero from first to last of `edges` (E,), s; else the worst excess.

    Intervals do not cross edges, and are no longer than `coarsest` to begin with.
    """
    length = np.diff(edges)
    count = np.maximum(1, np.ceil(length / coarsest)).astype(np.int64)
    part = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    first, step = np.repeat(edges[:-1], count), np.repeat(length / count, count)
    a = first + part * step
    b = np.append(a[1:], edges[-1])
    for _ in range(ROUNDS):
        bound, taken = judge(a, b)
        over = ~(taken <= 0)
        if over.any():
            return _worst(np.where(over, taken, -np.inf), a, decided=True)
        left = ~(bound <= 0).all(1)
        if not left.any():
            return None
        a, b, bound = a[left], b[left], bound[left]
        if len(a) * PARTS > MOST:
            break
        edges = a[:, None] + (b - a)[:, None] * np.linspace(0.0, 1.0, PARTS + 1)
        edges[:, -1] = b
        worst = _worst(bound, a, decided=False)
        a, b = edges[:, :-1].ravel(), edges[:, 1:].ravel()
    return worst


def _worst(amount: FloatArray, a: FloatArray, *, decided: bool) -> Excess:
    """The greatest amount (N, C); NaN counts as the greatest of all."""
    row, column = np.unravel_index(int(np.argmax(np.where(np.isnan(amount), np.inf, amount))), amount.shape)
    return Excess(int(column), float(amount[row, column]), float(a[row]), decided)
