"""A scalar function of time in polynomial pieces, with its derivatives and its exact extrema over intervals.

It drives what moves along one axis: a belt's travel, a dial's angle. In piece i, with τ = t − anchor_i (equation P1):

    x(t) = Σ_k c_ik τ^k

|ẋ| over a closed interval is greatest at one of its ends, at a switch or where ẍ = 0 (P2); likewise |ẍ| with x⃛.
Switches and zeros are found once; a bound is then two evaluations and a maximum over a stretch of a table.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import FloatArray, IntArray, frozen

ROUNDING = 1e-13
"""Bounds are raised by this part of the profile's largest value, for the rounding of a Horner scheme (some 1e-15)."""
REAL = 1e-6
"""A root counts as real when its imaginary part is at most this part of 1 + its size: rounding makes a double root
complex by some 1e-8. A candidate too many does no harm."""

Derivatives = tuple[FloatArray, FloatArray, FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class Profile:
    """x(t) in K + 1 pieces between `switches` (K,), ascending, s, with `coefficients` (K + 1, D >= 4), as in P1.

    The first piece has its anchor at `first`, the others where they begin; at a switch the later piece is taken. The
    first and the last piece reach to infinity and must be linear in time. That x and ẋ are continuous is the
    concern of who makes it.
    """

    first: float
    switches: FloatArray
    coefficients: FloatArray
    _anchors: FloatArray = field(init=False, repr=False)
    _tables: tuple[FloatArray, ...] = field(init=False, repr=False)
    _peaks: tuple[tuple[FloatArray, FloatArray], ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        switches = frozen(self.switches, (None,), "profile.switches")
        table = frozen(self.coefficients, (len(switches) + 1, None), "profile.coefficients")
        tables = [table]
        for _ in range(3):
            tables.append(tables[-1][:, 1:] * np.arange(1.0, tables[-1].shape[1]))
        object.__setattr__(self, "switches", switches)
        object.__setattr__(self, "coefficients", table)
        object.__setattr__(self, "_anchors", np.array([self.first, *switches]))
        object.__setattr__(self, "_tables", tuple(tables))
        object.__setattr__(self, "_peaks", (self._candidates(1), self._candidates(2)) if len(switches) else ())

    def evaluate(self, t: FloatArray) -> Derivatives:
        """x and its first three derivatives at times `t` (...), s, each (...)."""
        if not len(self.switches):
            slope, zero = self.coefficients[0, 1], np.zeros(t.shape)
            return self.coefficients[0, 0] + slope * (t - self.first), np.full(t.shape, slope), zero, zero
        piece, tau = self._local(t)
        x, xd, xdd, xddd = (_horner(table[piece], tau) for table in self._tables)
        return x, xd, xdd, xddd

    def fastest(self, t0: FloatArray, t1: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The greatest |ẋ| and |ẍ| over the closed intervals [t0, t1] (N,), exact up to `ROUNDING`, never below.

        Where ẍ jumps, the greater of both sides counts.
        """
        if not len(self.switches):
            return np.full(t0.shape, abs(self.coefficients[0, 1])), np.zeros(t0.shape)
        piece, tau = self._local(np.stack([t0, t1]))
        found = []
        for table, (times, sizes) in zip(self._tables[1:3], self._peaks, strict=True):
            at_ends = np.abs(_horner(table[piece], tau)).max(axis=0)
            low, high = np.searchsorted(times, t0, side="left"), np.searchsorted(times, t1, side="right")
            # Even rows of reduceat are the maxima of sizes[low:high], but sizes[low] where that stretch is empty.
            between = np.maximum.reduceat(sizes, np.stack([low, high], axis=-1).ravel())[::2]
            found.append(np.maximum(at_ends, np.where(low < high, between, 0.0)) + ROUNDING * sizes.max())
        return found[0], found[1]

    def _local(self, t: FloatArray) -> tuple[IntArray, FloatArray]:
        piece = np.searchsorted(self.switches, t, side="right")
        return piece, t - self._anchors[piece]

    def _candidates(self, order: int) -> tuple[FloatArray, FloatArray]:
        """Times (M,), ascending, at which |derivative `order`| may be greatest, and its sizes there (M + 1,).

        The last size is a zero that belongs to no time: `reduceat` may be asked for the place behind the last.
        """
        values, slopes = self._tables[order], self._tables[order + 1]
        times = [float(self.switches[0]), float(self.switches[-1])]
        sizes = [float(abs(values[0, 0])), float(abs(values[-1, 0]))]
        for i in range(1, len(self.switches)):
            start, length = float(self.switches[i - 1]), float(self.switches[i] - self.switches[i - 1])
            roots = np.polynomial.polynomial.polyroots(slopes[i]) if slopes[i, 1:].any() else np.zeros(0)
            real = roots.real[np.abs(roots.imag) <= REAL * (1.0 + np.abs(roots))]
            for tau in (0.0, *real[(real > 0.0) & (real < length)].tolist(), length):
                times.append(start + tau)
                sizes.append(float(abs(_horner(values[i], np.array(tau)))))
        rank = np.argsort(times)
        return np.array(times)[rank], np.array([*np.array(sizes)[rank], 0.0])


def _horner(table: FloatArray, tau: FloatArray) -> FloatArray:
    """Σ_k table[..., k] τ^k."""
    value = table[..., -1]
    for k in range(table.shape[-1] - 2, -1, -1):
        value = value * tau + table[..., k]
    return value


def steady(rate: float, at_time: float) -> Profile:
    """x = rate · (t − at_time)."""
    return Profile(at_time, np.zeros(0), np.array([[0.0, rate, 0.0, 0.0]]))


def chained(switches: Sequence[float], slopes: Sequence[Sequence[float]], zero_at: float) -> Profile:
    """K + 1 pieces by the coefficients of τ, τ², ... of each, made continuous in x, with x = 0 at time `zero_at`."""
    width = max(4, *(1 + len(row) for row in slopes))
    table = np.zeros((len(slopes), width))
    for i, row in enumerate(slopes):
        table[i, 1 : 1 + len(row)] = row
        if i > 1:
            table[i, 0] = _horner(table[i - 1], np.array(switches[i - 1] - switches[i - 2]))
    profile = Profile(switches[0], np.array(switches), table)
    table[:, 0] -= profile.evaluate(np.array(zero_at))[0]
    return Profile(switches[0], np.array(switches), table)
