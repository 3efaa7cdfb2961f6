"""Compiled: exact extremes of a spline and whether it keeps its limits, at every instant.

A polynomial on [0, 1] never exceeds its largest Bernstein coefficient, and takes the first and the last of them at its
ends (`assur.planner.kernels.hermite`). A piece whose largest coefficient does not exceed a value that is certainly
taken, by more than `TIGHTNESS`, can be left; any other is halved (de Casteljau), which shrinks what its hull has over
the curve to a quarter. No root finding has to succeed for the result to be right: the hulls that are left are the
bound.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.hermite import HULL_COLUMNS, first_column, piece_hulls

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
def first_beyond(knots: FloatArray, bands: FloatArray) -> int:
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
