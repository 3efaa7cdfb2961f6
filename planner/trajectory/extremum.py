"""Largest values of polynomials on [0, 1], rigorous from above and tight.

The idea: a polynomial in Bernstein form never exceeds its largest coefficient, and takes its end coefficients. A row
whose largest coefficient does not exceed a value that is certainly taken, by more than `TIGHTNESS`, can be left; any
other is cut in two (de Casteljau) and asked again. Cut at its stationary point both halves become monotone and their
hulls touch the curve, so two or three rounds do; a midpoint every third round makes the loop end whatever the guess.
No root finding has to succeed for the result to be right: the hulls that are left *are* the bound.
"""

from __future__ import annotations

from math import comb

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.errors import FaultError

TIGHTNESS = 1e-13
"""How far an answer may lie above the true extremum, relative to the largest coefficient of its group: a few hundred
roundings, ten thousand times below the narrowest tolerance with which limits are checked."""
ROUNDS = 90
"""Cuts before giving up. Thirty midpoints shrink a hull's excess by 4⁻³⁰: never reached."""


def _to_powers(degree: int) -> FloatArray:
    """Matrix that turns Bernstein coefficients (row vector) into power coefficients."""
    out = np.zeros((degree + 1, degree + 1))
    for i in range(degree + 1):
        for k in range(i, degree + 1):
            out[i, k] = comb(degree, k) * comb(k, i) * (-1.0) ** (k - i)
    return out


_POWERS = {degree: _to_powers(degree) for degree in range(1, 6)}


def _stationary(rows: FloatArray) -> FloatArray:
    """A guess, in [0, 1], of where each row (m, d+1) is largest: Newton's method from its highest control point."""
    degree = rows.shape[1] - 1
    c = rows @ _POWERS[degree]
    first = c[:, 1:] * np.arange(1, degree + 1)
    second = first[:, 1:] * np.arange(1, degree)
    s: FloatArray = rows.argmax(1) / degree
    for _ in range(5):
        f, g = first[:, -1], np.zeros(len(rows))
        for k in range(degree - 2, -1, -1):
            f = f * s + first[:, k]
        for k in range(degree - 2, -1, -1):
            g = g * s + second[:, k]
        falling = g < 0
        step = np.divide(f, g, out=np.zeros_like(f), where=falling)
        s = np.minimum(np.maximum(s - step, 0.0), 1.0)
    return s


def cut(rows: FloatArray, s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Bernstein coefficients of the parts of each row (m, d+1) left and right of `s` (m,) (de Casteljau)."""
    left, right = np.empty_like(rows), np.empty_like(rows)
    degree, s = rows.shape[1] - 1, s[:, None]
    for k in range(degree + 1):
        left[:, k], right[:, degree - k] = rows[:, 0], rows[:, -1]
        rows = rows[:, :-1] + s * (rows[:, 1:] - rows[:, :-1])
    return left, right


def maxima(rows: FloatArray, group: IntArray, taken: FloatArray, slack: FloatArray) -> FloatArray:
    """Upper bounds (G,) of the largest value in each group, at most `slack` (G,) above it.

    `rows` (m, d+1) Bernstein coefficients, `group` (m,) the group of each row, `taken` (G,) values that each group
    certainly takes (its largest end coefficient, over all its rows). Groups without rows get what is `taken`.
    Raises `FaultError` for coefficients that are not finite.
    """
    if not np.isfinite(rows).all():
        raise FaultError("polynomial pieces with coefficients that are not finite")
    taken = taken.copy()
    bound = taken.copy()
    for attempt in range(ROUNDS):
        top = rows.max(1, initial=-np.inf)
        open_ = ~(top <= taken[group] + slack[group])
        np.maximum.at(bound, group[~open_], top[~open_])
        rows, group = rows[open_], group[open_]
        if not len(rows):
            return np.maximum(bound, taken)
        s = np.full(len(rows), 0.5) if attempt % 3 == 2 else _stationary(rows)
        s = np.where((s > 0) & (s < 1), s, 0.5)
        left, right = cut(rows, s)
        np.maximum.at(taken, group, left[:, -1])
        rows, group = np.concatenate([left, right]), np.concatenate([group, group])
    raise FaultError(f"extrema of {len(rows)} polynomial pieces did not close in {ROUNDS} rounds")


def span(pieces: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Smallest and largest value (n,), (n,) over all pieces (P, n, d+1) given by their Bernstein coefficients."""
    n = pieces.shape[1]
    high, low = pieces.max(-1), pieces.min(-1)
    ends = pieces[..., [0, -1]]
    taken_high, taken_low = ends.max((0, 2)), ends.min((0, 2))
    slack = TIGHTNESS * np.maximum(np.abs(high).max(0), np.abs(low).max(0))
    open_high, open_low = ~(high <= taken_high + slack), ~(low >= taken_low - slack)
    # Pieces that cannot beat what is taken by more than the slack still count with their hull: the bound is rigorous.
    upper = np.maximum(taken_high, np.where(open_high, -np.inf, high).max(0))
    lower = np.minimum(taken_low, np.where(open_low, np.inf, low).min(0))
    if open_high.any() or open_low.any():
        rows = np.concatenate([pieces[open_high], -pieces[open_low]])
        joint = np.broadcast_to(np.arange(n), high.shape)
        group = np.concatenate([joint[open_high], joint[open_low] + n])
        found = maxima(rows, group, np.concatenate([taken_high, -taken_low]), np.concatenate([slack, slack]))
        upper, lower = np.maximum(upper, found[:n]), np.minimum(lower, -found[n:])
    return lower, upper
