"""The rows of a certificate as a table, and when those of a pair leave a hole.

Times are compared as they are: a row may begin where another ends, and not an ulp later.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker.jets import F2
from assur.planner.checker.solids import I2
from assur.planner.compiled import kernel

T0, T1, NAME, PIECE, OTHER_NAME, OTHER_PIECE, N, S0, S1, COLUMNS = 0, 1, 2, 3, 4, 5, 6, 9, 10, 11
"""Columns of a row of the certificate: its interval; number of the name, and of the piece, of both bodies (-1: none,
and the box of the body); normal; between which times the second is ahead of the clock; how many columns."""


@kernel(f"float64({F2}, int64, {I2}, int64, int64, float64, float64, float64, float64)", allocates=True)
def hole_at(
    rows: FloatArray, first: int, chain: IntArray, one: int, other: int, begin: float, end: float, low: float,
    high: float,
) -> float:  # fmt: skip
    """`hole` for shifts between `low` and `high`, over which no row begins or ends."""
    whole, split, r = begin, False, first
    while r >= 0:
        if rows[r, S0] <= low and high <= rows[r, S1]:
            a, b = rows[r, PIECE + 2 * chain[r, 1]], rows[r, OTHER_PIECE - 2 * chain[r, 1]]
            both = (a < 0.0 or one == 1) and (b < 0.0 or other == 1)
            split = split or not both
            if both and rows[r, T0] <= whole:
                whole = max(whole, rows[r, T1])
        r = chain[r, 0]
    if whole >= end:
        return math.nan
    if not split:
        return whole
    reached, r = np.full((one, other), begin), first
    while r >= 0:
        if rows[r, S0] <= low and high <= rows[r, S1]:
            a, b = int(rows[r, PIECE + 2 * chain[r, 1]]), int(rows[r, OTHER_PIECE - 2 * chain[r, 1]])
            for j in range(0 if a < 0 else a, one if a < 0 else a + 1):
                for k in range(0 if b < 0 else b, other if b < 0 else b + 1):
                    if rows[r, T0] <= reached[j, k]:
                        reached[j, k] = max(reached[j, k], rows[r, T1])
        r = chain[r, 0]
    return math.nan if reached.min() >= end else reached.min()


@kernel(f"float64({F2}, int64, {I2}, int64, int64, float64, float64, float64, float64)", allocates=True)
def hole(
    rows: FloatArray, first: int, chain: IntArray, one: int, other: int, begin: float, end: float, early: float,
    late: float,
) -> float:  # fmt: skip
    """When a pair of bodies of `one` and `other` pieces is first not covered over [begin, end], for all shifts from
    `early` to `late`; NaN: never.

    Its rows are number `first`, then the one that `chain` (.., 2) has for it, and so on up to -1, in the order of their
    begins; the second column is 1 for rows that name the pair the other way round.
    """
    low = early
    while True:
        high, r = late, first
        while r >= 0:
            for edge in (rows[r, S0], rows[r, S1]):
                if low < edge < high:
                    high = edge
            r = chain[r, 0]
        found = hole_at(rows, first, chain, one, other, begin, end, low, high)
        if not math.isnan(found):
            return found
        if high >= late:
            return math.nan
        low = high
