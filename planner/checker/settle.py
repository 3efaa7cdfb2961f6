"""Decides whether quantities stay below zero over an interval, from bounds that get better as intervals get shorter."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray

PARTS = 4
"""Into how many an undecided interval is cut: remainders shrink as h² or faster."""
ROUNDS = 10
"""After ten rounds intervals of 10 ms are 10 ns long. What is not decided by then is refused."""
FIRST = 20_000
"""Intervals between two edges to begin with, at most: 100 s of glue; what lasts longer begins with longer ones."""
MOST = 200_000
"""Intervals in a round after which the search ends undecided, which is a refusal too."""

Judge = Callable[[IntArray, FloatArray, FloatArray], tuple[FloatArray, FloatArray]]
"""For intervals [a, b] (N,) of items `of` (N,): upper bounds (N, C) over each of C quantities of the item, and values
(N, C) that they take in it."""


@dataclass(frozen=True, slots=True)
class Excess:
    """Of item `of`, quantity number `column` exceeds zero by `amount` around `time`, or could not be shown not to."""

    of: int
    column: int
    amount: float
    time: float
    decided: bool


def settle(items: Sequence[FloatArray], coarsest: float, judge: Judge) -> list[Excess]:
    """For each item of which a quantity exceeds zero somewhere, the worst that was found; nothing for the others.

    An item is its edges (E,), s: it is looked at from the first to the last. Intervals do not cross edges, and are no
    longer than `coarsest` to begin with (or as long as `FIRST` of them make them).
    """
    found: list[Excess] = []
    cells = [_cells(edges, coarsest) for edges in items]
    of = np.repeat(np.arange(len(cells)), [len(a) for a, _ in cells])
    a, b = (np.concatenate([np.zeros(0), *(cell[k] for cell in cells)]) for k in (0, 1))
    bound = np.zeros((0, 1))
    for _ in range(ROUNDS):
        if not len(of):
            return found
        bound, taken = judge(of, a, b)
        broken = np.unique(of[~(taken <= 0).all(1)])
        found += [_worst(int(i), taken[of == i], a[of == i], decided=True) for i in broken]
        left = ~(bound <= 0).all(1) & ~np.isin(of, broken)
        of, a, b, bound = of[left], a[left], b[left], bound[left]
        if len(of) * PARTS > MOST:
            break
        edges = a[:, None] + (b - a)[:, None] * np.linspace(0.0, 1.0, PARTS + 1)
        edges[:, -1] = b
        of, bound = np.repeat(of, PARTS), np.repeat(bound, PARTS, axis=0)
        a, b = edges[:, :-1].ravel(), edges[:, 1:].ravel()
    return found + [_worst(int(i), bound[of == i], a[of == i], decided=False) for i in np.unique(of)]


def _cells(edges: FloatArray, coarsest: float) -> tuple[FloatArray, FloatArray]:
    length = np.diff(edges)
    count = np.clip(np.ceil(length / coarsest), 1, FIRST).astype(np.int64)
    part = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    a = np.repeat(edges[:-1], count) + part * np.repeat(length / count, count)
    return a, np.append(a[1:], edges[-1])


def _worst(of: int, amount: FloatArray, a: FloatArray, *, decided: bool) -> Excess:
    """The greatest amount (N, C); NaN counts as the greatest of all."""
    row, column = np.unravel_index(int(np.argmax(np.where(np.isnan(amount), np.inf, amount))), amount.shape)
    return Excess(of, int(column), float(amount[row, column]), float(a[row]), decided)
