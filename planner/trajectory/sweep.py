"""Bounds of the joint motion over arbitrary intervals of time, never below the truth, tight enough to prove with.

On one piece a function f lies within h²/8 max|f''| of the straight line between its values at both ends of an
interval of length h (equation W1). For |C q̇| that needs C q⃛, for |C q̈| the fourth derivative, which is all but zero
on a joint leg, for q the acceleration: each from the hull of the whole piece (Bernstein coefficients), and never more
than that hull itself. An interval that spans pieces is a part of its first, whole pieces, and a part of its last; over
the whole ones the largest hull is read from a table of running maxima over 1, 2, 4, … pieces. Nothing is asked of
what happens between two pieces: where the acceleration jumps each side is bounded by its own piece.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.errors import FaultError
from assur.planner.robots.protocol import Sweep
from assur.planner.trajectory import Trajectory

ROUNDING = 1e-12
"""Relative, of each bound and of the largest value on the whole trajectory: added to every bound. Horner's scheme and
the hulls round by some 1e-15 of that."""


@dataclass(frozen=True, eq=False)
class _Tables:
    """What does not depend on the interval. Columns: C q̇ (m), C q̈ (m), q (n), −q (n); each is bounded from above."""

    rate_matrix: FloatArray
    whole: FloatArray
    """Largest of each column on every piece, (K-1, c)."""
    curvature: FloatArray
    """Largest magnitude of the second derivative of each column on every piece, over 8, (K-1, c)."""
    slack: FloatArray
    """Rounding that is added to each column, (c,)."""

    @cached_property
    def running(self) -> FloatArray:
        """(levels, K-1, c): on level k the largest of each column over the 2^k pieces from each piece on, as far as
        there are so many."""
        levels = [self.whole]
        while 2 ** len(levels) <= len(self.whole):
            half, level = 2 ** (len(levels) - 1), levels[-1].copy()
            level[:-half] = np.maximum(level[:-half], level[half:])
            levels.append(level)
        return np.stack(levels)

    def part(self, trajectory: Trajectory, piece: IntArray, a: FloatArray, b: FloatArray) -> FloatArray:
        """Bounds (N, c) over [a, b] (N,), each within one piece."""
        pieces, tau = np.stack([piece, piece]), np.stack([a, b]) - trajectory.edges[piece]
        q, qd, qdd = trajectory.states_on_piece(pieces, tau)
        rates = [np.abs(x @ self.rate_matrix.T).max(0) for x in (qd, qdd)]
        ends = np.concatenate([*rates, q.max(0), -q.min(0)], -1)
        bent = ends + ((b - a) ** 2)[:, None] * self.curvature[piece]
        return np.asarray(np.minimum(bent, np.maximum(self.whole[piece], ends)))

    def span(self, first: IntArray, last: IntArray) -> FloatArray:
        """Bounds (N, c) over whole pieces from `first` to `last`, both included."""
        level = np.frexp(last - first + 1)[1] - 1
        return np.asarray(np.maximum(self.running[level, first], self.running[level, last + 1 - 2**level]))


_known: WeakKeyDictionary[Trajectory, _Tables] = WeakKeyDictionary()
"""Tables of trajectories that are still in use, derived from them alone; a certificate asks for hundreds of rounds."""


def _tables(trajectory: Trajectory, rate_matrix: FloatArray) -> _Tables:
    known = _known.get(trajectory)
    if known is None or not np.array_equal(known.rate_matrix, rate_matrix):
        known = _known[trajectory] = _derive(trajectory, rate_matrix.copy())
    return known


def _derive(trajectory: Trajectory, rate_matrix: FloatArray) -> _Tables:
    position, velocity, acceleration, jerk = (trajectory.bernstein(d) for d in range(4))
    snap = 2 * (jerk[..., 1:] - jerk[..., :-1]) / trajectory.steps[:, None, None]
    # Combinations of joints: hulls of C f from hulls of f, (K-1, coefficients, n) @ (n, m).
    rate, rate_d, rate_dd, rate_ddd = (
        np.abs(hull.swapaxes(1, 2) @ rate_matrix.T).max(1) for hull in (velocity, acceleration, jerk, snap)
    )
    bend = np.abs(acceleration).max(-1)
    combined = [np.abs(rate_matrix) @ np.abs(hull).max((0, 2)) for hull in (velocity, acceleration)]
    place = np.abs(position).max((0, 2))
    return _Tables(
        rate_matrix,
        np.concatenate([rate, rate_d, position.max(-1), -position.min(-1)], -1),
        np.concatenate([rate_dd, rate_ddd, bend, bend], -1) / 8,
        ROUNDING * np.concatenate([*combined, place, place]),
    )


def sweep(trajectory: Trajectory, t0: FloatArray, t1: FloatArray, rate_matrix: FloatArray) -> Sweep:
    """Joint ranges, and upper bounds of |C q̇| and |C q̈|, over the closed intervals [t0, t1] (N,), s.

    `rate_matrix` C is (m, n). Before its first knot and after its last the arm stands still, if that knot is exactly
    at rest; if it is not, an interval that reaches there has infinite bounds. Intervals may span pieces, be points,
    and reach to ±inf.

    Raises `FaultError` unless t0 <= t1 everywhere (NaN is refused), and for shapes that do not fit.
    """
    if t0.ndim != 1 or t0.shape != t1.shape or rate_matrix.ndim != 2 or rate_matrix.shape[1] != trajectory.n:
        raise FaultError(f"sweep over {t0.shape} to {t1.shape} with rates {rate_matrix.shape} of {trajectory.n} joints")
    if not (t0 <= t1).all():
        raise FaultError("sweep over an interval that ends before it begins, or is not a number")
    tables = _tables(trajectory, rate_matrix)
    a = np.minimum(np.maximum(t0, trajectory.start), trajectory.end)
    b = np.minimum(np.maximum(t1, trajectory.start), trajectory.end)
    first = trajectory.piece(a)[0]
    last = np.maximum(np.minimum(trajectory.edges.searchsorted(b, "left") - 1, len(trajectory.steps) - 1), first)
    more = np.flatnonzero(last > first)
    tail, head = last[more], np.minimum(b, trajectory.edges[first + 1])
    ends = np.concatenate([a, trajectory.edges[tail]]), np.concatenate([head, b[more]])
    parts = tables.part(trajectory, np.concatenate([first, tail]), *ends)
    bound = parts[: len(a)]
    if len(more):
        bound[more] = np.maximum(bound[more], parts[len(a) :])
        between = more[last[more] > first[more] + 1]
        if len(between):
            bound[between] = np.maximum(bound[between], tables.span(first[between] + 1, last[between] - 1))
    bound += np.abs(bound) * ROUNDING + tables.slack
    unknown = np.zeros(len(a), dtype=bool)
    if not trajectory.rest_at_start:
        unknown |= t0 < trajectory.start
    if not trajectory.rest_at_end:
        unknown |= t1 > trajectory.end
    bound[unknown] = np.inf
    m, n = rate_matrix.shape
    return Sweep(-bound[:, 2 * m + n :], bound[:, 2 * m : 2 * m + n], bound[:, :m], bound[:, m : 2 * m])
