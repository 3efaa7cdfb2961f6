"""The arm's spline as a table: where the joints are, and bounds of their motion over intervals.

A trajectory is `tk` (P + 1,) s, the times of its knots, and `c` (P, n, 6), the coefficients of q(τ) = Σ c_k τ^k on each
piece, τ the time since the knot before it. What does not depend on an interval is computed once, by `piece_bounds`.

On one piece a function f lies within h²/8 max|f''| of the straight line between its values at both ends of an interval
of length h (equation W1). For |C q̇| that needs C q⃛, for |C q̈| the fourth derivative, for q the acceleration: each from
the hull of the whole piece (Bernstein coefficients), and never more than that hull itself. Where the acceleration jumps
between two pieces, each side is bounded by its own piece.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel

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


@kernel("void(float64[::1], float64[:, :, ::1], float64, float64[::1])")
def spline_state(tk: FloatArray, c: FloatArray, t: float, q: FloatArray) -> None:
    """Fills `q` (n,) at time `t`. Before its first and after its last knot the arm stands still."""
    held = min(max(t, tk[0]), tk[len(tk) - 1])
    p = piece_at(tk, held)
    u = held - tk[p]
    for i in range(len(q)):
        q[i] = c[p, i, 0] + u * (c[p, i, 1] + u * (c[p, i, 2] + u * (c[p, i, 3] + u * (c[p, i, 4] + u * c[p, i, 5]))))


@kernel("void(float64[:, :, ::1], int64, float64, float64[:, ::1])")
def piece_state(c: FloatArray, p: int, u: float, state: FloatArray) -> None:
    """Fills `state` (4, n) with q and its first three derivatives `u` s after the begin of piece `p`."""
    for i in range(state.shape[1]):
        c1, c2, c3, c4, c5 = c[p, i, 1], c[p, i, 2], c[p, i, 3], c[p, i, 4], c[p, i, 5]
        state[0, i] = c[p, i, 0] + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * c5))))
        state[1, i] = c1 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)))
        state[2, i] = 2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5))
        state[3, i] = 6.0 * c3 + u * (24.0 * c4 + u * 60.0 * c5)


@kernel("void(float64[::1], float64[:, :, ::1], float64, float64[:, ::1])")
def piece_motion(tk: FloatArray, c: FloatArray, t: float, state: FloatArray) -> None:
    """Fills `state` (4, n) with q and its first three derivatives at time `t`, the later piece's at an inner knot, the
    first or the last state for a time before or after all."""
    held = min(max(t, tk[0]), tk[len(tk) - 1])
    p = piece_at(tk, held)
    piece_state(c, p, held - tk[p], state)


@kernel("void(float64[::1], float64[:, :, ::1], float64, float64[:, ::1])")
def spline_motion(tk: FloatArray, c: FloatArray, t: float, state: FloatArray) -> None:
    """The same for an arm that stands still before the first knot and from the last one on."""
    piece_motion(tk, c, t, state)
    if not tk[0] <= t < tk[len(tk) - 1]:
        for order in range(1, 4):
            for i in range(state.shape[1]):
                state[order, i] = 0.0


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


@kernel("UniTuple(float64, 4)(float64, float64, float64, float64, float64, float64)")
def rate_hulls(g1: float, g2: float, g3: float, g4: float, g5: float, h: float) -> tuple[float, float, float, float]:
    """Bounds over [0, h] of the magnitudes of the first to the fourth derivative of Σ g_k τ^k: hulls, or W1."""
    d1, d2, d3, d4 = 2.0 * g2 * h, 3.0 * g3 * h * h, 4.0 * g4 * h**3, 5.0 * g5 * h**4
    ends = max(abs(g1), abs(g1 + d1 + d2 + d3 + d4))
    inner = max(abs(g1 + d1 / 4.0), abs(g1 + d1 / 2.0 + d2 / 6.0), abs(g1 + 0.75 * d1 + d2 / 2.0 + d3 / 4.0))
    e0, e1, e2, e3 = 2.0 * g2, 6.0 * g3 * h, 12.0 * g4 * h * h, 20.0 * g5 * h**3
    ends_d = max(abs(e0), abs(e0 + e1 + e2 + e3))
    inner_d = max(abs(e0 + e1 / 3.0), abs(e0 + (2.0 * e1 + e2) / 3.0))
    f0, f1, f2 = 6.0 * g3, 24.0 * g4 * h, 60.0 * g5 * h * h
    jerk = max(abs(f0), abs(f0 + f1 / 2.0), abs(f0 + f1 + f2))
    snap = max(abs(24.0 * g4), abs(24.0 * g4 + 120.0 * g5 * h))
    velocity, acceleration = max(ends, inner), max(ends_d, inner_d)
    return min(velocity, ends + h * h * jerk / 8.0), min(acceleration, ends_d + h * h * snap / 8.0), jerk, snap


@kernel("UniTuple(float64, 5)(float64[:, :, ::1], int64, float64[:, ::1], int64)")
def combined(c: FloatArray, p: int, matrix: FloatArray, row: int) -> tuple[float, float, float, float, float]:
    """Coefficients 1 to 5 of row number `row` of C q on piece p."""
    g1 = g2 = g3 = g4 = g5 = 0.0
    for i in range(matrix.shape[1]):
        share = matrix[row, i]
        if share != 0.0:
            g1 += share * c[p, i, 1]
            g2 += share * c[p, i, 2]
            g3 += share * c[p, i, 3]
            g4 += share * c[p, i, 4]
            g5 += share * c[p, i, 5]
    return g1, g2, g3, g4, g5


@kernel("boolean(float64[:, ::1], int64)")
def rests(knots: FloatArray, k: int) -> bool:
    """Whether velocity and acceleration of knot number k are exactly zero."""
    still = True
    for column in range(1 + (knots.shape[1] - 1) // 3, knots.shape[1]):
        still = still and knots[k, column] == 0.0
    return still


@kernel("void(float64[:, ::1], float64[::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1])")
def piece_bounds(knots: FloatArray, tk: FloatArray, c: FloatArray, matrix: FloatArray, whole: FloatArray) -> None:
    """Fills `whole` (P + 1, 2k), k = 2m + 2n columns for C q̇ (m), C q̈ (m), q (n) and −q (n), each bounded from above.

    Row p: the largest value of each column on piece p, and then, over 8, the largest magnitude of its second
    derivative. The last row: the rounding that is added to each column; then whether the arm rests before the first
    knot and after the last one (1 or 0).
    """
    pieces, n, m = len(c), c.shape[1], len(matrix)
    k = 2 * m + 2 * n
    for p in range(pieces + 1):
        for j in range(2 * k):
            whole[p, j] = 0.0
    for p in range(pieces):
        h = tk[p + 1] - tk[p]
        for j in range(m):
            g1, g2, g3, g4, g5 = combined(c, p, matrix, j)
            velocity, acceleration, jerk, snap = rate_hulls(g1, g2, g3, g4, g5, h)
            whole[p, j], whole[p, m + j] = velocity, acceleration
            whole[p, k + j], whole[p, k + m + j] = jerk / 8.0, snap / 8.0
        for i in range(n):
            g0, g1, g2, g3, g4, g5 = c[p, i, 0], c[p, i, 1], c[p, i, 2], c[p, i, 3], c[p, i, 4], c[p, i, 5]
            velocity, acceleration, _, _ = rate_hulls(g1, g2, g3, g4, g5, h)
            p1, p2, p3, p4, p5 = g1 * h, g2 * h * h, g3 * h**3, g4 * h**4, g5 * h**5
            b1, b2 = g0 + p1 / 5.0, g0 + 0.4 * p1 + p2 / 10.0
            b3 = g0 + 0.6 * p1 + 0.3 * p2 + p3 / 10.0
            b4 = g0 + 0.8 * p1 + 0.6 * p2 + 0.4 * p3 + p4 / 5.0
            b5 = g0 + p1 + p2 + p3 + p4 + p5
            high, low = max(g0, b1, b2, b3, b4, b5), min(g0, b1, b2, b3, b4, b5)
            bent = h * h * acceleration / 8.0
            high, low = min(high, max(g0, b5) + bent), max(low, min(g0, b5) - bent)
            whole[p, 2 * m + i], whole[p, 2 * m + n + i] = high, -low
            whole[p, k + 2 * m + i] = whole[p, k + 2 * m + n + i] = acceleration / 8.0
            place = ROUNDING * max(abs(high), abs(low))
            for column in (2 * m + i, 2 * m + n + i):
                whole[pieces, column] = max(whole[pieces, column], place)
            # the largest rate of each joint for a while, where the rounding of its position is
            whole[pieces, k + 2 * m + i] = max(whole[pieces, k + 2 * m + i], velocity)
            whole[pieces, k + 2 * m + n + i] = max(whole[pieces, k + 2 * m + n + i], acceleration)
    for j in range(m):
        for i in range(n):
            share = ROUNDING * abs(matrix[j, i])
            whole[pieces, j] += share * whole[pieces, k + 2 * m + i]
            whole[pieces, m + j] += share * whole[pieces, k + 2 * m + n + i]
    for j in range(k, 2 * k):
        whole[pieces, j] = 0.0
    whole[pieces, k] = 1.0 if rests(knots, 0) else 0.0
    whole[pieces, k + 1] = 1.0 if rests(knots, len(knots) - 1) else 0.0


@kernel("float64(float64[:, ::1], int64, int64, int64, float64, float64)")
def _on_part(whole: FloatArray, p: int, column: int, k: int, ends: float, square: float) -> float:
    """The bound of a column on a part of piece p, `square` being its length squared (W1)."""
    bound: float = min(ends + square * whole[p, k + column], max(whole[p, column], ends))
    return bound


@kernel(
    "void(float64[::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1], float64, float64,"
    " float64[::1], float64[::1], float64[::1], float64[::1])"
)
def sweep_bounds(
    tk: FloatArray,
    c: FloatArray,
    whole: FloatArray,
    matrix: FloatArray,
    t0: float,
    t1: float,
    lower: FloatArray,
    upper: FloatArray,
    rate: FloatArray,
    rate_d: FloatArray,
) -> None:
    """Joint ranges `lower, upper` (n,), and upper bounds `rate, rate_d` (m,) of |C q̇| and |C q̈|, over [t0, t1].

    `whole` is what `piece_bounds` has filled for `matrix` C (m, n). Before its first knot and after its last one the
    arm stands still, if that knot is exactly at rest; if it is not, an interval that reaches there has infinite bounds.
    So has one that ends before it begins, or is not a number.
    """
    pieces, n, m = len(c), c.shape[1], len(matrix)
    k = 2 * m + 2 * n
    start, end = tk[0], tk[pieces]
    known = t0 <= t1 and (t0 >= start or whole[pieces, k] == 1.0) and (t1 <= end or whole[pieces, k + 1] == 1.0)
    if not known:
        for i in range(n):
            lower[i], upper[i] = -math.inf, math.inf
        for j in range(m):
            rate[j] = rate_d[j] = math.inf
        return
    for i in range(n):
        lower[i] = upper[i] = -math.inf
    for j in range(m):
        rate[j] = rate_d[j] = 0.0
    a, b = min(max(t0, start), end), min(max(t1, start), end)
    p = piece_at(tk, a)
    first = True
    while first or (p < pieces and tk[p] < b):
        first = False
        u0, u1 = max(a - tk[p], 0.0), min(b, tk[p + 1]) - tk[p]
        if a <= tk[p] and tk[p + 1] <= b:
            for j in range(m):
                rate[j], rate_d[j] = max(rate[j], whole[p, j]), max(rate_d[j], whole[p, m + j])
            for i in range(n):
                upper[i] = max(upper[i], whole[p, 2 * m + i])
                lower[i] = max(lower[i], whole[p, 2 * m + n + i])
            p += 1
            continue
        square = (u1 - u0) * (u1 - u0)
        for j in range(m):
            g1, g2, g3, g4, g5 = combined(c, p, matrix, j)
            v0 = g1 + u0 * (2.0 * g2 + u0 * (3.0 * g3 + u0 * (4.0 * g4 + u0 * 5.0 * g5)))
            v1 = g1 + u1 * (2.0 * g2 + u1 * (3.0 * g3 + u1 * (4.0 * g4 + u1 * 5.0 * g5)))
            a0 = 2.0 * g2 + u0 * (6.0 * g3 + u0 * (12.0 * g4 + u0 * 20.0 * g5))
            a1 = 2.0 * g2 + u1 * (6.0 * g3 + u1 * (12.0 * g4 + u1 * 20.0 * g5))
            rate[j] = max(rate[j], _on_part(whole, p, j, k, max(abs(v0), abs(v1)), square))
            rate_d[j] = max(rate_d[j], _on_part(whole, p, m + j, k, max(abs(a0), abs(a1)), square))
        for i in range(n):
            g0, g1, g2, g3, g4, g5 = c[p, i, 0], c[p, i, 1], c[p, i, 2], c[p, i, 3], c[p, i, 4], c[p, i, 5]
            q0 = g0 + u0 * (g1 + u0 * (g2 + u0 * (g3 + u0 * (g4 + u0 * g5))))
            q1 = g0 + u1 * (g1 + u1 * (g2 + u1 * (g3 + u1 * (g4 + u1 * g5))))
            upper[i] = max(upper[i], _on_part(whole, p, 2 * m + i, k, max(q0, q1), square))
            lower[i] = max(lower[i], _on_part(whole, p, 2 * m + n + i, k, max(-q0, -q1), square))
        p += 1
    for j in range(m):
        rate[j] += abs(rate[j]) * ROUNDING + whole[pieces, j]
        rate_d[j] += abs(rate_d[j]) * ROUNDING + whole[pieces, m + j]
    for i in range(n):
        upper[i] += abs(upper[i]) * ROUNDING + whole[pieces, 2 * m + i]
        lower[i] = -(lower[i] + abs(lower[i]) * ROUNDING + whole[pieces, 2 * m + n + i])
