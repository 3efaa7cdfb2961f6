"""What writers of rows need of a motion: parts of it in which no acceleration jumps, and where a joint is largest."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.trajectory import Trajectory

LONG_S = 60.0
"""A piece that lasts longer is a part of its own."""
BESIDE = 1e-9
"""Share of a piece of the motion by which instants are within it, where accelerations or jerks jump at its ends."""
SHARES = np.linspace(0.0, 1.0, 17)
"""Instants at which a joint is evaluated, as shares of an interval."""
PIECES, ROUNDS = 4, 5
"""Pieces of the motion that go on to the next round, those in which a joint is largest; and rounds, each between the
neighbours of the instant at which it is."""


def between_jumps(path: Trajectory, t0: float, t1: float) -> list[tuple[float, float]]:
    """[t0, t1] in parts within which no acceleration jumps, and which hold no long piece and others."""
    cut = np.diff(path.edges) > LONG_S  # halving a long piece never reaches the short pieces next to it
    cuts = path.edges if path.jumps else path.edges[np.append(cut, False) | np.append(False, cut)]
    inside = cuts[(cuts > t0) & (cuts < t1)].tolist()
    return list(pairwise([t0, *inside, t1]))


def largest(
    path: Trajectory, order: int, t0: float, t1: float, size: Callable[[FloatArray], FloatArray] = np.abs
) -> tuple[FloatArray, FloatArray]:
    """When (n,), within [t0, t1], a derivative of each joint has the largest `size`, and its value there (n,).

    Instants are within pieces of the motion where that derivative may jump at their ends. Zeros where the interval
    reaches into no piece.
    """
    begins, steps = path.edges[:-1], path.steps
    rim = BESIDE if order > 1 else 0.0
    low, high = (np.clip((t - begins) / steps, rim, 1.0 - rim) * steps for t in (t0, t1))
    own, n = np.flatnonzero(low < high), path.n
    if not len(own):
        return np.full(n, t0), np.zeros(n)
    powers = np.array([math.perm(i, order) for i in range(6)], dtype=float)[order:]
    factors = (path.coefficients[own][:, :, order:] * powers).reshape(-1, len(powers))  # a row: one joint in one piece
    begin, end, first, last = (np.repeat(each[own], n) for each in (begins, path.edges[1:], low, high))
    for _ in range(ROUNDS):
        tau = first[:, None] + (last - first)[:, None] * SHARES
        value = np.zeros_like(tau)
        for factor in factors.T[::-1]:
            value = value * tau + factor[:, None]
        sizes, row = size(value), np.arange(len(tau))
        best = sizes.argmax(1)
        go_on = np.argsort(sizes[row, best].reshape(-1, n), axis=0)[-PIECES:] * n + np.arange(n)
        row, best = (each[go_on.ravel()] for each in (row, best))
        first, last = (tau[row, each] for each in (np.maximum(best - 1, 0), np.minimum(best + 1, len(SHARES) - 1)))
        t, value, begin, end, factors = tau[row, best], value[row, best], begin[row], end[row], factors[row]
    when = begin + t
    if order > 1:  # late on the clock the rim of a short piece is less than rounding
        when = np.minimum(when, np.nextafter(end, -np.inf))
    return np.clip(when[-n:], t0, t1), value[-n:]
