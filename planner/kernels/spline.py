"""The arm's spline as a table: where the joints are, and bounds of their motion over intervals.

A trajectory is `tk` (P + 1,) s, the times of its knots, and `c` (P, n, 6), the coefficients of q(τ) = Σ c_k τ^k on each
piece, τ the time since the knot before it. What does not depend on an interval is computed once, by `spline_tables`.

On one piece a function f lies within h²/8 max|f''| of the straight line between its values at both ends of an interval
of length h (equation W1). For q that needs the acceleration, for its rate the jerk, for its acceleration the fourth
derivative: each from the hull of the whole piece (Bernstein coefficients), and never more than that hull itself. Where
the acceleration jumps between two pieces, each side is bounded by its own piece.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.limits import FIRST, HULL_COLUMNS, TIME, first_column, piece_hulls

SPLINE = "Tuple((float64[::1], float64[:, :, ::1], float64[:, ::1]))"
"""Type of `tk`, `c` and `whole`, what `spline_tables` makes, in the signatures of kernels."""
Spline = tuple[FloatArray, FloatArray, FloatArray]
"""The same in Python."""
ROUNDING = 1e-12
"""Relative, of each bound and of the largest value on the whole trajectory: added to every bound. Horner's scheme and
the hulls round by some 1e-15 of that."""


@kernel("int64(float64[::1], float64)")
def piece_at(tk: FloatArray, t: float) -> int:
    """The piece that holds time `t`, the later one at an inner knot; the first or the last one outside."""
    low, high = 0, len(tk) - 2
    while low < high:
        middle = (low + high + 1) // 2
        if tk[middle] <= t:
            low = middle
        else:
            high = middle - 1
    return low


@kernel(f"void({SPLINE}, float64, float64[::1])", entry=True)
def spline_state(spline: Spline, t: float, q: FloatArray) -> None:
    """Fills `q` (n,) at time `t`. Before its first and after its last knot the arm stands still."""
    tk, c, _ = spline
    held = min(max(t, tk[0]), tk[len(tk) - 1])
    p = piece_at(tk, held)
    u = held - tk[p]
    for i in range(len(q)):
        q[i] = c[p, i, 0] + u * (c[p, i, 1] + u * (c[p, i, 2] + u * (c[p, i, 3] + u * (c[p, i, 4] + u * c[p, i, 5]))))


@kernel("UniTuple(float64, 4)(float64[:, :, ::1], int64, int64, float64)")
def piece_values(c: FloatArray, p: int, i: int, u: float) -> tuple[float, float, float, float]:
    """q and its first three derivatives of joint i, `u` s after the begin of piece `p`."""
    c1, c2, c3, c4, c5 = c[p, i, 1], c[p, i, 2], c[p, i, 3], c[p, i, 4], c[p, i, 5]
    return (
        c[p, i, 0] + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
        c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5))),
        2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5)),
        6.0 * c3 + u * (24.0 * c4 + u * 60.0 * c5),
    )


@kernel("void(float64[:, :, ::1], int64, float64, float64[:, ::1])")
def piece_state(c: FloatArray, p: int, u: float, state: FloatArray) -> None:
    """Fills `state` (4, n) with q and its first three derivatives `u` s after the begin of piece `p`."""
    for i in range(state.shape[1]):
        state[0, i], state[1, i], state[2, i], state[3, i] = piece_values(c, p, i, u)


@kernel("void(float64[::1], float64[:, :, ::1], float64, float64[:, ::1])")
def piece_motion(tk: FloatArray, c: FloatArray, t: float, state: FloatArray) -> None:
    """Fills `state` (4, n) with q and its first three derivatives at time `t`, the later piece's at an inner knot, the
    first or the last state for a time before or after all."""
    held = min(max(t, tk[0]), tk[len(tk) - 1])
    p = piece_at(tk, held)
    piece_state(c, p, held - tk[p], state)


@kernel("void(float64[:, ::1], float64[::1], float64[:, :, ::1], float64[::1], float64[:, :, ::1])")
def spline_states(knots: FloatArray, tk: FloatArray, c: FloatArray, t: FloatArray, found: FloatArray) -> None:
    """Fills `found` (T, 4, n) with q and its first three derivatives at times `t` (T,); NaN for those outside.

    At a knot the numbers of `knots` (K, 1 + 3n) come back.
    """
    n: int = c.shape[1]
    end = tk[len(tk) - 1]
    for k in range(len(t)):
        if not tk[0] <= t[k] <= end:
            found[k] = math.nan
            continue
        piece_motion(tk, c, t[k], found[k])
        if t[k] == end:
            for order in range(3):
                for i in range(n):
                    found[k, order, i] = knots[len(knots) - 1, 1 + order * n + i]


@kernel("boolean(float64[:, ::1], int64)")
def rests(knots: FloatArray, k: int) -> bool:
    """Whether velocity and acceleration of knot number k are exactly zero."""
    still = True
    for column in range(1 + (knots.shape[1] - 1) // 3, knots.shape[1]):
        still = still and knots[k, column] == 0.0
    return still


@kernel("UniTuple(float64, 2)(float64, float64, float64, float64, float64)")
def hull(low: float, high: float, first: float, last: float, bend: float) -> tuple[float, float]:
    """The least and the greatest value of what is within a hull, and within `bend` of the line between both ends."""
    return max(low, min(first, last) - bend), min(high, max(first, last) + bend)


@kernel("int64(float64[:, ::1], boolean)")
def first_bad_knot(knots: FloatArray, jumps: bool) -> int:
    """The first of knots (K, 1 + 3n) that is not finite or not later than the one before; -1: none is bad. Where the
    acceleration `jumps`, two may share a time."""
    for k in range(len(knots)):
        for column in range(knots.shape[1]):
            if not abs(knots[k, column]) < math.inf:
                return k
        if k > 0 and not (knots[k - 1, TIME] < knots[k, TIME] or (jumps and knots[k - 1, TIME] == knots[k, TIME])):
            return k
    return -1


@kernel(f"Tuple((int64, {SPLINE}))(float64[:, ::1], boolean)", allocates=True)
def spline_tables(knots: FloatArray, jumps: bool) -> tuple[int, Spline]:
    """The tables of a spline through knots (K, 1 + 3n), and the first bad knot (`first_bad_knot`) or -1: tables of bad
    knots are not filled. Two knots at one time have no piece between them.

    `tk` (P + 1,): begins of the pieces and the end of the last. `c` (P, n, 6): c0..c5 of q(τ) = Σ c_i τ^i on every
    piece; c3, c4, c5 come from the Bernstein coefficients of the jerk: q⃛ = j0 + 2(j1 − j0)s + (j0 − 2 j1 + j2)s².
    `whole` (P + 1, 9 n), nine columns for each joint. Row p: the least and the greatest value of q, of its rate and of
    its second derivative on piece p; then, over 8, the largest magnitudes of the second derivative of each of the
    three. The last row: the rounding of each of the three; then, of the first joint, whether the arm rests before the
    first knot and after the last one (1 or 0).
    """
    n, bad = (knots.shape[1] - 1) // 3, first_bad_knot(knots, jumps)
    most = len(knots) - 1 if bad < 0 else 0
    tk, c, whole = np.empty(most + 1), np.empty((most, n, 6)), np.empty((most + 1, 9 * n))
    if bad >= 0:
        return bad, (tk, c, whole)
    hulls, piece = np.empty((most, n, HULL_COLUMNS)), 0
    piece_hulls(knots, hulls)
    rounding = np.zeros(9 * n)
    for p in range(most):
        h = knots[p + 1, TIME] - knots[p, TIME]
        if not h > 0:
            continue
        tk[piece] = knots[p, TIME]
        for i in range(n):
            own, at = hulls[p, i], 9 * i
            c[piece, i, 0], c[piece, i, 1] = knots[p, FIRST + i], own[6]
            c[piece, i, 2], c[piece, i, 3] = own[11] / 2, own[15] / 6
            c[piece, i, 4] = (own[16] - own[15]) / (12 * h)
            c[piece, i, 5] = (own[15] - 2 * own[16] + own[17]) / (60 * h * h)
            row = whole[piece]
            row[at + 7] = max(abs(own[15]), abs(own[16]), abs(own[17])) / 8.0
            row[at + 8] = 2.0 * max(abs(own[16] - own[15]), abs(own[17] - own[16])) / h / 8.0
            for order in range(2, -1, -1):
                first = first_column(order)
                last = first + 5 - order
                low, high = own[first], own[first]
                for k in range(first + 1, last + 1):
                    low, high = min(low, own[k]), max(high, own[k])
                low, high = hull(low, high, own[first], own[last], h * h * row[at + 6 + order])
                size = max(abs(low), abs(high))
                if order == 2:
                    row[at + 6] = size / 8.0
                row[at + 2 * order], row[at + 2 * order + 1] = low, high
                rounding[at + order] = max(rounding[at + order], ROUNDING * size)
        piece += 1
    tk[piece] = knots[most, TIME]
    rounding[3] = 1.0 if rests(knots, 0) else 0.0
    rounding[4] = 1.0 if rests(knots, most) else 0.0
    whole[piece] = rounding
    return bad, (tk[: piece + 1], c[:piece], whole[: piece + 1])


@kernel(f"void({SPLINE}, float64, float64, float64[:, ::1])", entry=True)
def sweep_joints(spline: Spline, t0: float, t1: float, joints: FloatArray) -> None:
    """Fills `joints` (n, 6) with the jets of the joints over [t0, t1], from what `spline_tables` has made.

    Before its first knot and after its last one the arm stands still, if that knot is exactly at rest, and rates of 0
    count there; if it is not, an interval that reaches there has infinite bounds. So has one that ends before it
    begins, or is not a number.
    """
    tk, c, whole = spline
    pieces, n = len(c), c.shape[1]
    start, end, last = tk[0], tk[pieces], whole[pieces]
    known = t0 <= t1 and (t0 >= start or last[3] == 1.0) and (t1 <= end or last[4] == 1.0)
    still = t0 < start or t1 > end
    for i in range(n):
        for order in range(3):
            low, high = (0.0, 0.0) if still and order > 0 else (math.inf, -math.inf)
            joints[i, 2 * order], joints[i, 2 * order + 1] = (low, high) if known else (0.0, math.inf)
    if not known:
        return
    a, b = min(max(t0, start), end), min(max(t1, start), end)
    p = piece_at(tk, a)
    first = True
    while first or (p < pieces and tk[p] < b):
        first = False
        u, v = max(a - tk[p], 0.0), min(b, tk[p + 1]) - tk[p]
        all_of_it, square = a <= tk[p] and tk[p + 1] <= b, (v - u) * (v - u)
        for i in range(n):
            at, own, one, other = 9 * i, joints[i], piece_values(c, p, i, u), piece_values(c, p, i, v)
            for order in range(3):
                k, low, high = 2 * order, whole[p, at + 2 * order], whole[p, at + 2 * order + 1]
                if not all_of_it:  # from the values at both ends of the part (W1)
                    low, high = min(low, one[order], other[order]), max(high, one[order], other[order])
                    low, high = hull(low, high, one[order], other[order], square * whole[p, at + 6 + order])
                own[k], own[k + 1] = min(own[k], low), max(own[k + 1], high)
        p += 1
    for i in range(n):
        for order in range(3):
            low, high = joints[i, 2 * order], joints[i, 2 * order + 1]
            rounds = last[9 * i + order] + ROUNDING * max(abs(low), abs(high))
            joints[i, 2 * order], joints[i, 2 * order + 1] = 0.5 * (low + high), 0.5 * (high - low) + rounds
