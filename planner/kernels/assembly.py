"""Whether a linkage with a loop stays in its assembly mode all along a spline, over halved intervals (K39)."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.dyads import RRR_COLUMNS, WORK_ROWS
from assur.planner.kernels.inverse import LOOP, POSTURE_COLUMNS, posture
from assur.planner.kernels.links import PARALLEL_LEAST, assembled
from assur.planner.kernels.spline import spline_state, sweep_bounds

FINEST_S = 2e-5
"""Intervals are halved no further than this, s; the checker goes further before it refuses."""
STACK = 64
"""Intervals on the stack at a time: one for each halving, and no motion is halved so often."""


@kernel(
    "UniTuple(float64, 2)(float64[::1], float64[::1], float64[:, :, ::1], float64[:, ::1], float64[:, ::1])",
    allocates=True,
)
def first_lost(
    robot: FloatArray, tk: FloatArray, c: FloatArray, whole: FloatArray, matrix: FloatArray
) -> tuple[float, float]:
    """When the robot is first not proved to stay assembled with its least parallel margin, and its margin then, NaN
    where it does not assemble; an infinite time: it stays assembled."""
    n, m = c.shape[1], len(matrix)
    lower, upper, rate, rate_d, q = np.empty(n), np.empty(n), np.empty(m), np.empty(m), np.empty(n)
    out, work = np.empty(POSTURE_COLUMNS), np.empty((WORK_ROWS, RRR_COLUMNS))
    stack, top = np.empty((STACK, 2)), 1
    stack[0, 0], stack[0, 1] = tk[0], tk[len(tk) - 1]
    while top > 0:
        top -= 1
        t0, t1 = stack[top, 0], stack[top, 1]
        sweep_bounds(tk, c, whole, matrix, t0, t1, lower, upper, rate, rate_d)
        if assembled(robot, lower, upper):
            continue
        middle = 0.5 * (t0 + t1)
        spline_state(tk, c, middle, q)
        posture(robot, q, out, work)
        if not (out[LOOP] >= robot[PARALLEL_LEAST] and t1 - t0 > FINEST_S and top + 2 <= STACK):
            return middle, out[LOOP]
        stack[top, 0], stack[top, 1], stack[top + 1, 0], stack[top + 1, 1] = middle, t1, t0, middle
        top += 2
    return math.inf, math.nan
