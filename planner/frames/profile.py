"""A scalar function of time in polynomial pieces, with its derivatives.

It drives what moves along one axis: a belt's travel, a dial's angle. In piece i, with τ = t − anchor_i (equation P1):

    x(t) = Σ_k c_ik τ^k
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import FloatArray, IntArray, frozen

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

    def evaluate(self, t: FloatArray) -> Derivatives:
        """x and its first three derivatives at times `t` (...), s, each (...)."""
        if not len(self.switches):
            slope, zero = self.coefficients[0, 1], np.zeros(t.shape)
            return self.coefficients[0, 0] + slope * (t - self.first), np.full(t.shape, slope), zero, zero
        piece, tau = self._local(t)
        x, xd, xdd, xddd = (_horner(table[piece], tau) for table in self._tables)
        return x, xd, xdd, xddd

    def _local(self, t: FloatArray) -> tuple[IntArray, FloatArray]:
        piece = np.searchsorted(self.switches, t, side="right")
        return piece, t - self._anchors[piece]


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
