"""Compiled: exact extremes of a spline and whether it keeps its limits, at every instant.

A polynomial on [0, 1] never exceeds its largest Bernstein coefficient, and takes the first and the last of them at its
ends (`assur.planner.kernels.limits`). A piece whose largest coefficient does not exceed a value that is certainly
taken, by more than `TIGHTNESS`, can be left; any other is halved (de Casteljau), which shrinks what its hull has over
the curve to a quarter. No root finding has to succeed for the result to be right: the hulls that are left are the
bound.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel

# Compiled: quintic Hermite pieces, the polynomial of degree five with given q, q̇, q̈ at both of its ends.
#
# With h the length of a piece, s = τ/h in [0, 1], q(s) = Σ b_i B_i⁵(s) has the Bernstein coefficients (equation T1)
#
# b0 = q0 b1 = q0 + h q̇0/5 b2 = q0 + 2h q̇0/5 + h² q̈0/20 b5 = q1 b4 = q1 − h q̇1/5 b3 = q1 − 2h q̇1/5 + h² q̈1/20
#
# and the derivatives have (equation T2; δ = (q1 − q0)/h)
#
# velocity q̇0, q̇0 + h q̈0/4, 5δ − 2(q̇0 + q̇1) + h(q̈1 − q̈0)/4, q̇1 − h q̈1/4, q̇1 and from there c'_i = d (c_{i+1} −
# c_i)/h, d the degree.
#
# A polynomial on [0, 1] lies between its smallest and its largest Bernstein coefficient, and takes the first and the
# last of them at its ends. T2 starts at the velocity, where q1 − q0 is an exact difference of doubles for short pieces:
# differences of T1 would carry the rounding of q into the jerk.
#
# Rounding: q is known to u|q|, u = 2⁻⁵³, so jerk is known to 60·2u|q|/h³ at best. That is a property of the knots, not
# of the arithmetic here, and why knots are not set closer than some 10 µs (`assur.planner.kernels.knots`).

TIME, FIRST = 0, 1
"""Columns of a knot: its time, s, and from there n positions, n velocities, n accelerations."""
HULL_COLUMNS = 18
"""Bernstein coefficients of one joint on one piece: six of its position, five of its velocity, four, three."""


@kernel("int64(int64)")
def first_column(derivative: int) -> int:
    """Where the coefficients of a derivative (0 to 3) begin: 0, 6, 11, 15."""
    return derivative * (13 - derivative) // 2


@kernel("void(float64[:, ::1], float64[:, :, ::1])")
def piece_hulls(knots: FloatArray, hulls: FloatArray) -> None:
    """Fills `hulls` (K-1, n, HULL_COLUMNS) from knots (K, 1 + 3n) (equations T1, T2).

    Between two knots at one time the acceleration takes the values of both, and the jerk of a joint whose acceleration
    jumps has no bound.
    """
    n = (knots.shape[1] - 1) // 3
    for p in range(len(knots) - 1):
        h = knots[p + 1, TIME] - knots[p, TIME]
        for i in range(n):
            q, v, a = FIRST + i, FIRST + n + i, FIRST + 2 * n + i
            q0, q1, v0, v1, a0, a1 = (
                knots[p, q],
                knots[p + 1, q],
                knots[p, v],
                knots[p + 1, v],
                knots[p, a],
                knots[p + 1, a],
            )
            row = hulls[p, i]
            if not h > 0:
                row[0:6], row[6:11], row[11:13], row[13:15] = q0, v0, a0, a1
                row[15:18] = math.inf if a0 != a1 else 0.0
                continue
            square = h * h / 20
            row[0], row[1], row[2] = q0, q0 + h * v0 / 5, q0 + 2 * h * v0 / 5 + square * a0
            row[3], row[4], row[5] = q1 - 2 * h * v1 / 5 + square * a1, q1 - h * v1 / 5, q1
            row[6], row[7] = v0, v0 + h * a0 / 4
            row[8] = 5 * (q1 - q0) / h - 2 * (v0 + v1) + h * (a1 - a0) / 4
            row[9], row[10] = v1 - h * a1 / 4, v1
            row[11], row[12], row[13], row[14] = a0, 4 * (row[8] - row[7]) / h, 4 * (row[9] - row[8]) / h, a1
            for k in range(3):
                row[15 + k] = 3 * (row[12 + k] - row[11 + k]) / h


TIGHTNESS = 1e-13
"""How far an extreme may lie above the true one, relative to the largest coefficient of its joint: a few hundred
roundings, ten thousand times below the narrowest tolerance with which limits are checked."""
MOST_CUTS = 2000
"""Halvings of one piece after which its extreme is unknown. Some forty do."""
DEPTH = 64
"""Halvings of a half, likewise: the hull's excess is 4⁻⁶⁴ of the first one then."""

LOWEST, HIGHEST = 0, 1
NONE = -1
"""No limit is broken."""


@kernel("float64(float64[:, :, ::1], int64, int64, float64, float64[:, ::1])")
def _largest(hulls: FloatArray, derivative: int, joint: int, sign: float, stack: FloatArray) -> float:
    """The largest value of `sign` times a derivative of a joint, from above by `TIGHTNESS` at most.

    Infinity where a coefficient is not finite, or halving did not close. `stack` (DEPTH, 6) is room to work in.
    """
    first, degree = first_column(derivative), 5 - derivative
    taken, size = -math.inf, 0.0
    for p in range(len(hulls)):
        taken = max(taken, sign * hulls[p, joint, first], sign * hulls[p, joint, first + degree])
        for k in range(degree + 1):
            magnitude = abs(hulls[p, joint, first + k])
            if not magnitude < math.inf:
                return math.inf
            size = max(size, magnitude)
    slack, bound = TIGHTNESS * size, taken
    for p in range(len(hulls)):
        for k in range(degree + 1):
            stack[0, k] = sign * hulls[p, joint, first + k]
        depth, cuts = 1, 0
        while depth > 0:
            depth -= 1
            top = stack[depth, 0]
            for k in range(1, degree + 1):
                top = max(top, stack[depth, k])
            if top <= taken + slack:
                bound = max(bound, top)
                continue
            cuts += 1
            if cuts > MOST_CUTS or depth + 1 >= len(stack):
                return math.inf
            # the right half stays in its row, the left half goes on top of it
            stack[depth + 1, 0] = stack[depth, 0]
            for done in range(1, degree + 1):
                for k in range(degree + 1 - done):
                    stack[depth, k] = (stack[depth, k] + stack[depth, k + 1]) / 2
                stack[depth + 1, done] = stack[depth, 0]
            taken = max(taken, stack[depth, 0])
            depth += 2
    return max(bound, taken)


@kernel("void(float64[:, ::1], float64[:, :, ::1])", allocates=True)
def spline_extremes(knots: FloatArray, found: FloatArray) -> None:
    """Fills `found` (4, 2, n): lowest and highest value of q and its derivatives over the spline of knots (K, 1 + 3n).

    The interval holds every value, and is wider than the true range by `TIGHTNESS` at most, plus the rounding of the
    coefficients. It is from minus infinity to infinity where no bound is known.
    """
    n = found.shape[2]
    hulls, stack = np.empty((len(knots) - 1, n, HULL_COLUMNS)), np.empty((DEPTH, 6))
    piece_hulls(knots, hulls)
    for derivative in range(4):
        for joint in range(n):
            found[derivative, LOWEST, joint] = -_largest(hulls, derivative, joint, -1.0, stack)
            found[derivative, HIGHEST, joint] = _largest(hulls, derivative, joint, 1.0, stack)


@kernel("int64(float64[:, ::1], float64[:, :, ::1])", allocates=True)
def first_limit_broken(knots: FloatArray, bands: FloatArray) -> int:
    """The first limit that the spline of knots (K, 1 + 3n) does not surely keep: `kind` n + joint, or `NONE`.

    `bands` (4, 2, n): lowest and highest value that are accepted of q and its derivatives.
    """
    n: int = bands.shape[2]
    hulls, stack = np.empty((len(knots) - 1, n, HULL_COLUMNS)), np.empty((DEPTH, 6))
    piece_hulls(knots, hulls)
    for kind in range(4):
        first, degree = first_column(kind), 5 - kind
        for joint in range(n):
            low, high = bands[kind, LOWEST, joint], bands[kind, HIGHEST, joint]
            inside = True
            for p in range(len(hulls)):
                for k in range(degree + 1):
                    inside = inside and low <= hulls[p, joint, first + k] <= high
            if inside:
                continue
            if not _largest(hulls, kind, joint, 1.0, stack) <= high:
                return kind * n + joint
            if not _largest(hulls, kind, joint, -1.0, stack) <= -low:
                return kind * n + joint
    return NONE
