"""What a whole motion asks of the tool and leaves of the arm, at sampled instants."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.dyads import RRR_COLUMNS, WORK_ROWS
from assur.planner.kernels.inverse import LOOP, POSTURE_COLUMNS, SERIAL, posture
from assur.planner.kernels.links import LINKS
from assur.planner.kernels.motion import COORDINATES, ORDERS, link_motion
from assur.planner.kernels.spline import piece_motion


@kernel(
    "UniTuple(float64, 2)(float64[::1], float64[::1], float64[:, :, ::1], float64, float64, float64, float64, int64)",
    allocates=True,
)
def tool_peak(
    robot: FloatArray, tk: FloatArray, c: FloatArray, x: float, y: float, t0: float, t1: float, many: int
) -> tuple[float, float]:
    """Largest acceleration, m/s², of the tool point at `many` > 1 instants of [t0, t1], and when; NaN if any is.

    The tool point is at (x, y), m, across the flange, which turns about the vertical: r̈ = α r⊥ − ω² r.
    """
    joints, out = np.zeros((ORDERS, c.shape[1])), np.empty((ORDERS, COORDINATES))
    work = np.empty((WORK_ROWS, RRR_COLUMNS))
    flange, best, at = int(robot[LINKS]) - 1, -math.inf, t0
    for k in range(many):
        t = t0 + (t1 - t0) * k / (many - 1)
        piece_motion(tk, c, t, joints)
        link_motion(robot, flange, joints, out, work)
        cos, sin = math.cos(out[0, 3]), math.sin(out[0, 3])
        rx, ry = cos * x - sin * y, sin * x + cos * y
        turn, square = out[2, 3], out[1, 3] * out[1, 3]
        ax, ay, az = out[2, 0] - turn * ry - square * rx, out[2, 1] + turn * rx - square * ry, out[2, 2]
        pull = math.sqrt(ax * ax + ay * ay + az * az)
        if not pull <= best:
            best, at = pull, t
            if math.isnan(pull):
                break
    return best, at


@kernel("UniTuple(float64, 2)(float64[::1], float64[::1], float64[:, :, ::1], int64)", allocates=True)
def least_margins(robot: FloatArray, tk: FloatArray, c: FloatArray, many: int) -> tuple[float, float]:
    """Least margin to a singularity, and to a type 2 singularity, at `many` > 1 instants of a spline; NaN if any is."""
    out, work = np.empty(POSTURE_COLUMNS), np.empty((WORK_ROWS, RRR_COLUMNS))
    joints, t0, t1 = np.empty((ORDERS, c.shape[1])), tk[0], tk[len(tk) - 1]
    serial, parallel = math.inf, math.inf
    for k in range(many):
        piece_motion(tk, c, t0 + (t1 - t0) * k / (many - 1), joints)
        posture(robot, joints[0], out, work)
        # what is not a number stays
        serial = serial if serial != serial or serial <= out[SERIAL] else out[SERIAL]
        parallel = parallel if parallel != parallel or parallel <= out[LOOP] else out[LOOP]
    return serial, parallel
