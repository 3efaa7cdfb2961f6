"""Whether a SCARA that is shifted by a belt correction stays within its ranges and away from singular positions
(U3)."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.intervals import Motion
from assur.planner.kernels.solids import MOTION, ROW, TABLE
from assur.planner.kernels.spline import sweep_bounds
from assur.planner.kernels.uncertainty import (
    DOUBT,
    LAG_Q,
    SHIFT,
    SHIFT_GROWTH,
    Doubt,
    corrected_angles,
    growing_for,
)

HALVED = 12
"""How often an interval is halved before it is given up."""
FITS, SINGULAR = -2, -1
"""What is found where no joint goes beyond its range."""


@kernel(f"int64({MOTION}, {TABLE}, {DOUBT}, float64, float64, {ROW})", allocates=True)
def correction_fits(motion: Motion, limits: FloatArray, doubt: Doubt, t0: float, t1: float, found: FloatArray) -> int:
    """The joint that a correction may bring beyond its range over [t0, t1], SINGULAR or FITS; `found` (2,) takes when,
    s, and by how much, rad. `limits` (≥ 2, n): the lower and the upper ends of the joints."""
    robot, _, _, tk, c, whole, matrix = motion
    n, m, lag, clock = c.shape[1], len(matrix), doubt[1], doubt[2]
    swept, stack, top = np.empty((4, max(n, m))), np.empty((HALVED + 2, 3)), 1
    stack[0, 0], stack[0, 1], stack[0, 2] = t0, t1, 0.0
    while top > 0:
        top -= 1
        a, b, depth = stack[top, 0], stack[top, 1], stack[top, 2]
        lower, upper = swept[0, :n], swept[1, :n]
        sweep_bounds(tk, c, whole, matrix, a, b, lower, upper, swept[2, :m], swept[3, :m])
        shift = clock[SHIFT] + clock[SHIFT_GROWTH] * growing_for(clock, b)
        first, second = corrected_angles(robot, lower[1] - lag[LAG_Q, 1], upper[1] + lag[LAG_Q, 1], shift)
        joint, over = FITS, 0.0
        if not (first < np.inf and second < np.inf):
            joint = SINGULAR
        for j in range(n):
            more = first if j == 0 else (first + second if j == 1 else (second if j == 3 else 0.0))
            beyond = max(limits[0, j] - (lower[j] - more), upper[j] + more - limits[1, j])
            if joint != SINGULAR and more > 0.0 and beyond > over:
                joint, over = j, beyond
        if joint == FITS:
            continue
        if depth >= HALVED:
            found[0], found[1] = 0.5 * (a + b), over
            return joint
        middle = 0.5 * (a + b)
        stack[top, 0], stack[top, 1], stack[top, 2] = middle, b, depth + 1.0
        stack[top + 1, 0], stack[top + 1, 1], stack[top + 1, 2] = a, middle, depth + 1.0
        top += 2
    return FITS
