"""The arm's spline as a table: where the joints are, and bounds of their motion over intervals.

A trajectory is `tk` (P + 1,) s, the times of its knots, and `c` (P, n, 6), the coefficients of q(τ) = Σ c_k τ^k on each
piece, τ the time since the knot before it. What does not depend on an interval is computed once, by `piece_bounds`.

On one piece a function f lies within h²/8 max|f''| of the straight line between its values at both ends of an interval
of length h (equation W1). For q that needs the acceleration, for its rate the jerk, for its acceleration the fourth
derivative: each from the hull of the whole piece (Bernstein coefficients), and never more than that hull itself. Where
the acceleration jumps between two pieces, each side is bounded by its own piece.
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


@kernel("void(float64[:, ::1], float64[::1], float64[:, :, ::1], float64[:, ::1])")
def piece_bounds(knots: FloatArray, tk: FloatArray, c: FloatArray, whole: FloatArray) -> None:
    """Fills `whole` (P + 1, 9 n), nine columns for each joint.

    Row p: the least and the greatest value of q, of its rate and of its second derivative on piece p; then, over 8, the
    largest magnitudes of the second derivative of each of the three. The last row: the rounding of each of the three;
    then, of the first joint, whether the arm rests before the first knot and after the last one (1 or 0).
    """
    pieces, n = len(c), c.shape[1]
    for column in range(whole.shape[1]):
        whole[pieces, column] = 0.0
    for p in range(pieces):
        h = tk[p + 1] - tk[p]
        for i in range(n):
            g0, g1, g2, g3, g4, g5 = c[p, i, 0], c[p, i, 1], c[p, i, 2], c[p, i, 3], c[p, i, 4], c[p, i, 5]
            row, at, u = whole[p], 9 * i, h * h
            snap = max(abs(24.0 * g4), abs(24.0 * g4 + 120.0 * g5 * h))
            f0, f1, f2 = 6.0 * g3, 24.0 * g4 * h, 60.0 * g5 * u
            jerk = max(abs(f0), abs(f0 + f1 / 2.0), abs(f0 + f1 + f2))
            e0, e1, e2, e3 = 2.0 * g2, 6.0 * g3 * h, 12.0 * g4 * u, 20.0 * g5 * u * h
            b1, b2, b3 = e0 + e1 / 3.0, e0 + (2.0 * e1 + e2) / 3.0, e0 + e1 + e2 + e3
            low, high = hull(min(e0, b1, b2, b3), max(e0, b1, b2, b3), e0, b3, u * snap / 8.0)
            push = max(abs(low), abs(high))
            row[at + 4], row[at + 5] = low, high
            d1, d2, d3, d4 = 2.0 * g2 * h, 3.0 * g3 * u, 4.0 * g4 * u * h, 5.0 * g5 * u * u
            b1, b2, b3 = g1 + d1 / 4.0, g1 + d1 / 2.0 + d2 / 6.0, g1 + 0.75 * d1 + d2 / 2.0 + d3 / 4.0
            b4 = g1 + d1 + d2 + d3 + d4
            low, high = hull(min(g1, b1, b2, b3, b4), max(g1, b1, b2, b3, b4), g1, b4, u * jerk / 8.0)
            speed = max(abs(low), abs(high))
            row[at + 2], row[at + 3] = low, high
            p1, p2, p3, p4, p5 = g1 * h, g2 * u, g3 * u * h, g4 * u * u, g5 * u * u * h
            b1, b2 = g0 + p1 / 5.0, g0 + 0.4 * p1 + p2 / 10.0
            b3 = g0 + 0.6 * p1 + 0.3 * p2 + p3 / 10.0
            b4 = g0 + 0.8 * p1 + 0.6 * p2 + 0.4 * p3 + p4 / 5.0
            b5 = g0 + p1 + p2 + p3 + p4 + p5
            low, high = hull(min(g0, b1, b2, b3, b4, b5), max(g0, b1, b2, b3, b4, b5), g0, b5, u * push / 8.0)
            row[at], row[at + 1] = low, high
            row[at + 6], row[at + 7], row[at + 8] = push / 8.0, jerk / 8.0, snap / 8.0
            for k, size in enumerate((max(abs(low), abs(high)), speed, push)):
                whole[pieces, at + k] = max(whole[pieces, at + k], ROUNDING * size)
    whole[pieces, 3] = 1.0 if rests(knots, 0) else 0.0
    whole[pieces, 4] = 1.0 if rests(knots, len(knots) - 1) else 0.0


@kernel("UniTuple(float64, 2)(float64[:, ::1], int64, int64, int64, float64, float64, float64)")
def _on_part(
    whole: FloatArray, p: int, at: int, order: int, first: float, last: float, square: float
) -> tuple[float, float]:
    """The least and the greatest value of a derivative of a joint on a part of piece p whose length squared is
    `square`, from its values at both ends of the part (W1)."""
    low, high, bend = min(first, last), max(first, last), square * whole[p, at + 6 + order]
    least, most = min(whole[p, at + 2 * order], low), max(whole[p, at + 2 * order + 1], high)
    return max(low - bend, least), min(high + bend, most)


@kernel("void(float64[::1], float64[:, :, ::1], float64[:, ::1], float64, float64, float64[:, ::1])")
def sweep_joints(tk: FloatArray, c: FloatArray, whole: FloatArray, t0: float, t1: float, joints: FloatArray) -> None:
    """Fills `joints` (n, 6) with the jets of the joints over [t0, t1], from what `piece_bounds` has filled.

    Before its first knot and after its last one the arm stands still, if that knot is exactly at rest, and rates of 0
    count there; if it is not, an interval that reaches there has infinite bounds. So has one that ends before it
    begins, or is not a number.
    """
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
            at, own = 9 * i, joints[i]
            if all_of_it:
                for k in range(0, 6, 2):
                    own[k], own[k + 1] = min(own[k], whole[p, at + k]), max(own[k + 1], whole[p, at + k + 1])
                continue
            g0, g1, g2, g3, g4, g5 = c[p, i, 0], c[p, i, 1], c[p, i, 2], c[p, i, 3], c[p, i, 4], c[p, i, 5]
            low, high = _on_part(
                whole, p, at, 0, g0 + u * (g1 + u * (g2 + u * (g3 + u * (g4 + u * g5)))),
                g0 + v * (g1 + v * (g2 + v * (g3 + v * (g4 + v * g5)))), square,
            )  # fmt: skip
            own[0], own[1] = min(own[0], low), max(own[1], high)
            low, high = _on_part(
                whole, p, at, 1, g1 + u * (2.0 * g2 + u * (3.0 * g3 + u * (4.0 * g4 + u * 5.0 * g5))),
                g1 + v * (2.0 * g2 + v * (3.0 * g3 + v * (4.0 * g4 + v * 5.0 * g5))), square,
            )  # fmt: skip
            own[2], own[3] = min(own[2], low), max(own[3], high)
            low, high = _on_part(
                whole, p, at, 2, 2.0 * g2 + u * (6.0 * g3 + u * (12.0 * g4 + u * 20.0 * g5)),
                2.0 * g2 + v * (6.0 * g3 + v * (12.0 * g4 + v * 20.0 * g5)), square,
            )  # fmt: skip
            own[4], own[5] = min(own[4], low), max(own[5], high)
        p += 1
    for i in range(n):
        for order in range(3):
            low, high = joints[i, 2 * order], joints[i, 2 * order + 1]
            rounds = last[9 * i + order] + ROUNDING * max(abs(low), abs(high))
            joints[i, 2 * order], joints[i, 2 * order + 1] = 0.5 * (low + high), 0.5 * (high - low) + rounds
