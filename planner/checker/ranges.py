"""The checker's own bounds of the joint motion over arbitrary intervals: rigorous from above, and tight.

Rigorous: over any part of a piece a polynomial does not exceed the control values of that part (V1). Tight: pieces are
first cut where the control values of a rate stand out above those at the ends, that is near its stationary points,
until none stands out by more than `TIGHT`. A bound over an interval is then the greatest of the control values of the
two parts at its ends and of the whole parts in between. Whether a cut was well chosen matters to tightness only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.checker.spline import Spline, before, begin_of, behind, within
from assur.planner.robots.protocol import Sweep

TIGHT = 1e-12
"""How far control values may stand out above the ends of a part, relative to the greatest of the whole spline: some
thousand roundings. Bounds that are claimed by others are compared with ours to 1e-9 (`rows.BOUND`)."""
ROUNDS = 40
"""Rounds of cuts. Three are usual; after the last one bounds are still bounds."""
NEWTON = 4
"""Steps towards a stationary point in each round."""
_DERIVATIVE = {
    4: np.array([[-4, 4, 0, 0, 0], [12, -24, 12, 0, 0], [-12, 36, -36, 12, 0], [4, -16, 24, -16, 4]], dtype=np.float64),
    3: np.array([[-3, 3, 0, 0], [6, -12, 6, 0], [-3, 9, -9, 3], [0, 0, 0, 0]], dtype=np.float64),
}
"""By degree: from control values to the coefficients of s⁰ to s³ of the derivative."""
CLOSEST = 1e-9
"""Parts shorter than this share of their piece are not cut again: doubles hardly tell their ends apart."""


@dataclass(frozen=True, eq=False)
class _Table:
    """Control values `rows` (6, N, n + 2m) of q, C q̇ and C q̈ of N parts, one column a polynomial.

    q̇ has five and q̈ four of them: they stand first, what is behind them means nothing. So one triangle cuts all.
    """

    rows: FloatArray
    joints: int
    rates: int

    def __getitem__(self, which: IntArray | BoolArray) -> _Table:
        return _Table(self.rows[:, which], self.joints, self.rates)

    def parts(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Views of q (6, N, n), C q̇ (5, N, m) and C q̈ (4, N, m)."""
        n, m = self.joints, self.joints + self.rates
        return self.rows[:, :, :n], self.rows[:5, :, n:m], self.rows[:4, :, m:]

    def cut(self, s0: FloatArray, s1: FloatArray) -> _Table:
        """The parts over [s0, s1] (N,) of each, 0 <= s0 <= s1 <= 1."""
        rows, n, m = self.rows.copy(), self.joints, self.joints + self.rates
        before(rows, s1[:, None])
        # the last control values must stand last while the other side of the triangle is made
        rows[1:, :, n:m], rows[2:, :, m:] = rows[:5, :, n:m].copy(), rows[:4, :, m:].copy()
        behind(rows, begin_of(s0, s1)[:, None])
        rows[:5, :, n:m], rows[:4, :, m:] = rows[1:, :, n:m].copy(), rows[2:, :, m:].copy()
        return _Table(rows, n, self.rates)

    def heights(self) -> FloatArray:
        """Greatest of q, −q, |C q̇|, |C q̈| among control values, (N, 2n + 2m)."""
        q, rate, rate_d = self.parts()
        return np.concatenate([q.max(0), -q.min(0), np.abs(rate).max(0), np.abs(rate_d).max(0)], axis=-1)

    def ends(self) -> FloatArray:
        """Greatest of |C q̇| and |C q̈| at both ends of each part, (N, 2m)."""
        _, rate, rate_d = self.parts()
        return np.concatenate([np.abs(rate[::4]).max(0), np.abs(rate_d[::3]).max(0)], axis=-1)


def _table(line: Spline, combinations: FloatArray) -> _Table:
    """The whole pieces."""
    q, v, a = (np.moveaxis(control, -1, 0) for control in line.control[:3])
    joints, rates = q.shape[-1], len(combinations)
    rows = np.zeros((6, len(line.length), joints + 2 * rates))
    rows[:, :, :joints] = q
    rows[:5, :, joints : joints + rates] = v @ combinations.T
    rows[:4, :, joints + rates :] = a @ combinations.T
    return _Table(rows, joints, rates)


@dataclass(frozen=True, eq=False)
class Ranges:
    """Bounds of q, |C q̇| and |C q̈| of a spline: `piece`, `t0`, `t1` (S,) its parts, `top` (S, F) their bounds."""

    spline: Spline
    table: _Table
    piece: IntArray
    t0: FloatArray
    t1: FloatArray
    top: FloatArray

    def sweep(self, t0: FloatArray, t1: FloatArray) -> Sweep:
        """The joint motion over the intervals [t0, t1] (N,), none of which begins before the spline or crosses its end.

        From the last knot on the arm stands still.
        """
        line, joints = self.spline, self.table.joints
        a, b = within(t0, line.start, line.end), within(t1, line.start, line.end)
        last = len(self.t0) - 1
        i = np.minimum(np.maximum(self.t0.searchsorted(a, "right") - 1, 0), last)
        j = np.maximum(np.minimum(self.t1.searchsorted(b, "left"), last), i)
        both = np.concatenate([i, j])
        low = np.concatenate([a, np.maximum(a, self.t0[j])])
        high = np.concatenate([np.minimum(b, self.t1[i]), b])
        ends = self._tops(self.piece[both], low, high)
        top = np.maximum(ends[: len(i)], ends[len(i) :])
        wide = j > i + 1
        if wide.any():
            # Even rows of reduceat are maxima of top[i+1:j].
            stretches = np.stack([i[wide] + 1, j[wide]], -1).ravel()
            top[wide] = np.maximum(top[wide], np.maximum.reduceat(self.top, stretches, axis=0)[::2])
        behind_it = t0 >= line.end
        if behind_it.any() and line.at_rest:
            top = np.where(behind_it[:, None], self._standing(), top)
        n, m = 2 * joints, 2 * joints + self.table.rates
        return Sweep(-top[:, joints:n], top[:, :joints], top[:, n:m], top[:, m:])

    def _standing(self) -> FloatArray:
        last = self.spline.control[0][-1, :, -1]
        return np.concatenate([last, -last, np.zeros(2 * self.table.rates)])

    def _tops(self, piece: IntArray, t0: FloatArray, t1: FloatArray) -> FloatArray:
        """Greatest control values (N, F) of q, −q, |C q̇|, |C q̈| over parts [t0, t1] of the given pieces."""
        begin, length = self.spline.time[piece], self.spline.length[piece]
        s0, s1 = (within((t - begin) / length, 0.0, 1.0) for t in (t0, t1))
        return self.table[piece].cut(s0, s1).heights()


def ranges(line: Spline, combinations: FloatArray) -> Ranges:
    """Bounds of a spline, `combinations` (m, n) being the robot's `rate_matrix`."""
    table = _table(line, combinations)
    piece = np.arange(len(line.length))
    s0, s1 = np.zeros(len(piece)), np.ones(len(piece))
    parts, top = table, table.heights()
    rates = slice(2 * table.joints, None)
    scale = TIGHT * top[:, rates].max(0)
    done: list[tuple[IntArray, FloatArray, FloatArray, FloatArray]] = []
    for attempt in range(ROUNDS):
        out = ~(top[:, rates] <= parts.ends() + scale)
        open_ = out.any(1) & (s1 - s0 > CLOSEST) & (attempt < ROUNDS - 1)
        closed = ~open_
        done.append((piece[closed], s0[closed], s1[closed], top[closed]))
        if not open_.any():
            break
        of, middle = _cuts(parts[open_], out[open_], midpoint=attempt % 4 == 3)
        piece, s0, s1 = _divided(piece[open_], s0[open_], s1[open_], of, middle)
        parts = table[piece].cut(s0, s1)
        top = parts.heights()
    piece, s0, s1, top = (np.concatenate(column) for column in zip(*done, strict=True))
    order = np.lexsort((s0, piece))
    piece, s0, s1, top = piece[order], s0[order], s1[order], top[order]
    t0 = line.time[piece] + s0 * line.length[piece]
    t1 = np.where(s1 == 1.0, line.time[piece + 1], line.time[piece] + s1 * line.length[piece])
    return Ranges(line, table, piece, t0, t1, top)


def _cuts(parts: _Table, out: BoolArray, *, midpoint: bool) -> tuple[IntArray, FloatArray]:
    """Which parts to cut and where, in (0, 1): at the stationary point of every bound that stands `out` (N, 2m)."""
    if midpoint:
        return np.arange(len(out)), np.full(len(out), 0.5)
    _, rate, rate_d = parts.parts()
    (row, which), (row_d, which_d) = np.nonzero(out[:, : parts.rates]), np.nonzero(out[:, parts.rates :])
    slopes, guesses = zip(_slope(rate[:, row, which], 4), _slope(rate_d[:, row_d, which_d], 3), strict=True)
    return np.concatenate([row, row_d]), _peak(np.concatenate(slopes, axis=1), np.concatenate(guesses))


def _slope(control: FloatArray, degree: int) -> tuple[FloatArray, FloatArray]:
    """Of polynomials by their control values (degree + 1, N), each turned so that the greatest of them is positive: the
    coefficients of s⁰ to s³ (4, N) of the derivative, and where the greatest of them stands (N,), in [0, 1]."""
    highest = np.abs(control).argmax(0)
    sign = np.where(control[highest, np.arange(control.shape[1])] < 0, -1.0, 1.0)
    return _DERIVATIVE[degree] @ (control * sign), highest / degree


def _divided(
    piece: IntArray, s0: FloatArray, s1: FloatArray, of: IntArray, middle: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """The parts (N,) of pieces, [s0, s1] each, cut at `middle` of part number `of`."""
    part = np.concatenate([np.arange(len(piece)), of])
    begin = np.concatenate([s0, s0[of] + middle * (s1 - s0)[of]])
    order = np.lexsort((begin, part))
    part, begin = part[order], begin[order]
    last = np.append(part[1:] != part[:-1], True)
    end = np.where(last, s1[part], np.append(begin[1:], 0.0))
    wide = end > begin
    return piece[part[wide]], begin[wide], end[wide]


def _peak(slope: FloatArray, s: FloatArray) -> FloatArray:
    """A guess, in (0, 1), of where polynomials are greatest: by Newton from s (N,), on their derivatives `slope`
    (4, N), by Horner."""
    for _ in range(NEWTON):
        value = slope[3] * s + slope[2]
        curvature = slope[3] * s + value
        value = value * s + slope[1]
        curvature = curvature * s + value
        value = value * s + slope[0]
        falling = curvature < 0
        step = np.divide(value, curvature, out=np.zeros_like(s), where=falling)
        s = within(s - step, 0.0, 1.0)
    return np.where((s > 0) & (s < 1), s, 0.5)
