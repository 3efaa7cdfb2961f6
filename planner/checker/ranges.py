"""The checker's own bounds of the joint motion over arbitrary intervals: rigorous from above, and tight.

Rigorous: over any part of a piece a polynomial does not exceed the control values of that part (V1). Tight: pieces are
first cut where the control values of a rate stand out above those at the ends, that is near its stationary points,
until none stands out by more than `TIGHT`. A bound over an interval is then the greatest of the control values of the
two parts at its ends and of the whole parts in between. Whether a cut was well chosen matters to tightness only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from planner.arrays import BoolArray, FloatArray, IntArray
from planner.checker.spline import Spline, cut
from planner.robots.protocol import Sweep

TIGHT = 1e-12
"""How far control values may stand out above the ends of a part, relative to the greatest of the whole spline: some
thousand roundings. Bounds that are claimed by others are compared with ours to 1e-9 (`rows.BOUND`)."""
ROUNDS = 40
"""Rounds of cuts. Three are usual; after the last one bounds are still bounds."""
NEWTON = 4
"""Steps towards a stationary point in each round."""
CLOSEST = 1e-9
"""Parts shorter than this share of their piece are not cut again: doubles hardly tell their ends apart."""


@dataclass(frozen=True, eq=False)
class Ranges:
    """Bounds of q, |C q̇| and |C q̈| of a spline: `piece`, `t0`, `t1` (S,) its parts, `top` (S, F) their bounds."""

    spline: Spline
    combinations: FloatArray
    controls: tuple[FloatArray, ...]
    piece: IntArray
    t0: FloatArray
    t1: FloatArray
    top: FloatArray

    def sweep(self, t0: FloatArray, t1: FloatArray) -> Sweep:
        """The joint motion over the intervals [t0, t1] (N,), none of which begins before the spline or crosses its end.

        From the last knot on the arm stands still.
        """
        line, joints = self.spline, self.spline.control[0].shape[1]
        a, b = np.clip(t0, line.start, line.end), np.clip(t1, line.start, line.end)
        i = np.clip(np.searchsorted(self.t0, a, side="right") - 1, 0, len(self.t0) - 1)
        j = np.maximum(np.clip(np.searchsorted(self.t1, b, side="left"), 0, len(self.t1) - 1), i)
        both = np.concatenate([i, j])
        low = np.concatenate([a, np.maximum(a, self.t0[j])])
        high = np.concatenate([np.minimum(b, self.t1[i]), b])
        ends = self._tops(self.piece[both], low, high)
        top = np.maximum(ends[: len(i)], ends[len(i) :])
        # Even rows of reduceat are maxima of top[i+1:j]; where that stretch is empty they are something else.
        padded = np.concatenate([self.top, np.full((1, self.top.shape[1]), -np.inf)])
        between = np.maximum.reduceat(padded, np.stack([i + 1, np.maximum(j, i + 1)], -1).ravel(), axis=0)[::2]
        top = np.where((j > i + 1)[:, None], np.maximum(top, between), top)
        if line.at_rest:
            top = np.where((t0 >= line.end)[:, None], self._standing(), top)
        rates = len(self.combinations)
        n, m = 2 * joints, 2 * joints + rates
        return Sweep(-top[:, joints:n], top[:, :joints], top[:, n:m], top[:, m:])

    def _standing(self) -> FloatArray:
        last = self.spline.control[0][-1, :, -1]
        return np.concatenate([last, -last, np.zeros(2 * len(self.combinations))])

    def _tops(self, piece: IntArray, t0: FloatArray, t1: FloatArray) -> FloatArray:
        """Greatest control values (N, F) of q, −q, |C q̇|, |C q̈| over parts [t0, t1] of the given pieces."""
        begin, length = self.spline.time[piece], self.spline.length[piece]
        s0, s1 = (np.clip((t - begin) / length, 0.0, 1.0) for t in (t0, t1))
        parts = [cut(control[piece], s0, s1) for control in self.controls]
        return _heights(parts)


def ranges(line: Spline, combinations: FloatArray) -> Ranges:
    """Bounds of a spline, `combinations` (m, n) being the robot's `rate_matrix`."""
    controls = (line.control[0], combinations @ line.control[1], combinations @ line.control[2])
    piece = np.arange(len(line.length))
    s0, s1 = np.zeros(len(piece)), np.ones(len(piece))
    parts: Sequence[FloatArray] = controls
    rates = slice(2 * controls[0].shape[1], None)
    scale = TIGHT * _heights(controls)[:, rates].max(0)
    done: list[tuple[IntArray, FloatArray, FloatArray, FloatArray]] = []
    for attempt in range(ROUNDS):
        top = _heights(parts)
        out = ~(top[:, rates] <= _heights([part[..., [0, -1]] for part in parts])[:, rates] + scale)
        open_ = out.any(1) & (s1 - s0 > CLOSEST) & (attempt < ROUNDS - 1)
        done.append((piece[~open_], s0[~open_], s1[~open_], top[~open_]))
        if not open_.any():
            break
        of, middle = _cuts(parts[1][open_], parts[2][open_], out[open_], midpoint=attempt % 4 == 3)
        piece, s0, s1 = _divided(piece[open_], s0[open_], s1[open_], of, middle)
        parts = [cut(control[piece], s0, s1) for control in controls]
    piece, s0, s1, top = (np.concatenate(column) for column in zip(*done, strict=True))
    order = np.lexsort((s0, piece))
    piece, s0, s1, top = piece[order], s0[order], s1[order], top[order]
    t0 = line.time[piece] + s0 * line.length[piece]
    t1 = np.where(s1 == 1.0, line.time[piece + 1], line.time[piece] + s1 * line.length[piece])
    return Ranges(line, combinations, controls, piece, t0, t1, top)


def _heights(parts: Sequence[FloatArray]) -> FloatArray:
    """Greatest of q, −q, |C q̇|, |C q̈| among control values, (N, 2n + 2m)."""
    q, rate, rate_d = parts
    return np.concatenate([q.max(-1), -q.min(-1), np.abs(rate).max(-1), np.abs(rate_d).max(-1)], axis=-1)


def _cuts(rate: FloatArray, rate_d: FloatArray, out: BoolArray, *, midpoint: bool) -> tuple[IntArray, FloatArray]:
    """Which parts to cut and where, in (0, 1): at the stationary point of every bound that stands `out` (N, 2m)."""
    if midpoint:
        return np.arange(len(out)), np.full(len(out), 0.5)
    m, rows, where = rate.shape[1], [], []
    for control, side in ((rate, out[:, :m]), (rate_d, out[:, m:])):
        row, which = np.nonzero(side)
        rows.append(row)
        where.append(_peak(control[row, which]))
    return np.concatenate(rows), np.concatenate(where)


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


def _peak(control: FloatArray) -> FloatArray:
    """A guess, in (0, 1), of where polynomials (N, d+1) are greatest in size: by Newton from the greatest value."""
    degree, highest = control.shape[1] - 1, np.abs(control).argmax(1)
    control = control * np.where(control[np.arange(len(control)), highest] < 0, -1.0, 1.0)[:, None]
    s = highest / degree
    for _ in range(NEWTON):
        level = control
        while level.shape[1] > 3:
            level = level[:, :-1] + s[:, None] * np.diff(level, axis=1)
        curvature = level[:, 2] - 2 * level[:, 1] + level[:, 0]
        level = level[:, :-1] + s[:, None] * np.diff(level, axis=1)
        slope = (level[:, 1] - level[:, 0]) / max(1, degree - 1)
        s = np.clip(np.where(curvature < 0, s - slope / np.where(curvature < 0, curvature, 1.0), s), 0.0, 1.0)
    return np.where((s > 0) & (s < 1), s, 0.5)
