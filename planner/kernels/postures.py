"""Whether an arm stays where it can be all along a spline, over halved intervals: a linkage with a loop in its assembly
mode (K39), a SCARA that a belt correction shifts within its ranges and away from singular positions (N10). And what a
whole motion asks of the tool and leaves of the arm, at sampled instants."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.dyads import RRR_COLUMNS, WORK_ROWS
from assur.planner.kernels.inverse import LOOP, POSTURE_COLUMNS, posture
from assur.planner.kernels.jets import JET_COLUMNS
from assur.planner.kernels.links import LINKS, PARALLEL_LEAST, assembled
from assur.planner.kernels.motion import COORDINATES, ORDERS, link_motion
from assur.planner.kernels.solids import CUBE, ROW, TABLE
from assur.planner.kernels.spline import SPLINE, Spline, piece_at, piece_motion, piece_state, spline_state, sweep_joints
from assur.planner.kernels.uncertainty import (
    ERRORS,
    SHIFT,
    SHIFT_GROWTH,
    Errors,
    corrected_angles,
    growing_for,
)

FINEST_S = 2e-5
"""Intervals are halved no further than this, s; the checker goes further before it refuses."""
STACK = 64
"""Intervals on the stack at a time: one for each halving, and no motion is halved so often."""


@kernel(f"UniTuple(float64, 2)({ROW}, {SPLINE})", allocates=True)
def first_lost(robot: FloatArray, spline: Spline) -> tuple[float, float]:
    """When the robot is first not proved to stay assembled with its least parallel margin, and its margin then, NaN
    where it does not assemble; an infinite time: it stays assembled."""
    tk, n = spline[0], spline[1].shape[1]
    lower, upper, q, joints = np.empty(n), np.empty(n), np.empty(n), np.empty((n, JET_COLUMNS))
    out, work = np.empty(POSTURE_COLUMNS), np.empty((WORK_ROWS, RRR_COLUMNS))
    stack, top = np.empty((STACK, 2)), 1
    stack[0, 0], stack[0, 1] = tk[0], tk[len(tk) - 1]
    while top > 0:
        top -= 1
        t0, t1 = stack[top, 0], stack[top, 1]
        sweep_joints(spline, t0, t1, joints)
        for j in range(n):
            lower[j], upper[j] = joints[j, 0] - joints[j, 1], joints[j, 0] + joints[j, 1]
        if assembled(robot, lower, upper):
            continue
        middle = 0.5 * (t0 + t1)
        spline_state(spline, middle, q)
        posture(robot, q, out, work)
        if not (out[LOOP] >= robot[PARALLEL_LEAST] and t1 - t0 > FINEST_S and top + 2 <= STACK):
            return middle, out[LOOP]
        stack[top, 0], stack[top, 1], stack[top + 1, 0], stack[top + 1, 1] = middle, t1, t0, middle
        top += 2
    return math.inf, math.nan


HALVED = 12
"""How often an interval is halved before it is given up."""
FITS, SINGULAR = -2, -1
"""What is found where no joint goes beyond its range."""


@kernel(f"int64({ROW}, {SPLINE}, {TABLE}, {ERRORS}, float64, float64, {ROW})", allocates=True)
def correction_fits(
    robot: FloatArray, spline: Spline, limits: FloatArray, errors: Errors, t0: float, t1: float, found: FloatArray
) -> int:
    """The joint that a correction may bring beyond its range over [t0, t1], SINGULAR or FITS; `found` (2,) takes when,
    s, and by how much, rad. `limits` (≥ 2, n): the lower and the upper ends of the joints."""
    n, lag, clock = spline[1].shape[1], errors[1], errors[2]
    joints, stack, top = np.empty((n, JET_COLUMNS)), np.empty((HALVED + 2, 3)), 1
    stack[0, 0], stack[0, 1], stack[0, 2] = t0, t1, 0.0
    while top > 0:
        top -= 1
        a, b, depth = stack[top, 0], stack[top, 1], stack[top, 2]
        sweep_joints(spline, a, b, joints)
        shift = clock[SHIFT] + clock[SHIFT_GROWTH] * growing_for(clock, b)
        first, second = corrected_angles(
            robot, joints[1, 0] - joints[1, 1] - lag[1], joints[1, 0] + joints[1, 1] + lag[1], shift
        )
        joint, over = FITS, 0.0
        if not (first < np.inf and second < np.inf):
            joint = SINGULAR
        for j in range(n):
            more = first if j == 0 else (first + second if j == 1 else (second if j == 3 else 0.0))
            beyond = joints[j, 1] + more + max(limits[0, j] - joints[j, 0], joints[j, 0] - limits[1, j])
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


@kernel(f"UniTuple(float64, 2)({ROW}, float64, float64, {TABLE}, {TABLE}, {TABLE})")
def tool_rate(
    robot: FloatArray, x: float, y: float, joints: FloatArray, out: FloatArray, work: FloatArray
) -> tuple[float, float]:
    """Speed, m/s, and acceleration, m/s², of the tool point where the joints are (`joints`, as `piece_motion` has it).

    The tool point is at (x, y), m, across the flange, which turns about the vertical: r̈ = α r⊥ − ω² r. A flange that
    tilts bears the tool point itself. `out` and `work` are room to compute in.
    """
    link_motion(robot, int(robot[LINKS]) - 1, joints, out, work)
    cos, sin = math.cos(out[0, 3]), math.sin(out[0, 3])
    rx, ry = cos * x - sin * y, sin * x + cos * y
    omega, turn = out[1, 3], out[2, 3]
    vx, vy, vz = out[1, 0] - omega * ry, out[1, 1] + omega * rx, out[1, 2]
    square = omega * omega
    ax, ay, az = out[2, 0] - turn * ry - square * rx, out[2, 1] + turn * rx - square * ry, out[2, 2]
    return math.sqrt(vx * vx + vy * vy + vz * vz), math.sqrt(ax * ax + ay * ay + az * az)


@kernel(f"void({ROW}, {ROW}, {CUBE}, float64, float64, {ROW}, {TABLE})", allocates=True)
def tool_rates(
    robot: FloatArray, tk: FloatArray, c: FloatArray, x: float, y: float, times: FloatArray, rates: FloatArray
) -> None:
    """`rates` (2, T) takes speeds and accelerations of the tool point (`tool_rate`) at `times` (T,)."""
    joints, out = np.zeros((ORDERS, c.shape[1])), np.empty((ORDERS, COORDINATES))
    work = np.empty((WORK_ROWS, RRR_COLUMNS))
    for k in range(len(times)):
        piece_motion(tk, c, times[k], joints)
        rates[0, k], rates[1, k] = tool_rate(robot, x, y, joints, out, work)


AROUND = 40
"""Steps in which the surroundings of the largest sample are sampled again."""


@kernel(f"void({ROW}, {ROW}, {CUBE}, float64, float64, float64, float64, float64, int64, {ROW})", allocates=True)
def sample_tool_peaks(
    robot: FloatArray, tk: FloatArray, c: FloatArray, x: float, y: float, t0: float, t1: float, step: float,
    parts: int, found: FloatArray,
) -> None:  # fmt: skip
    """The largest speed and acceleration of the tool point (`tool_rate`) over [t0, t1], and when: `found` (2, 2) flat.
    NaN where one is none.

    Each piece of the spline is sampled from its first to its last state, `step` s apart at most and in `parts` steps at
    least, so both sides of a jump count. What is around the largest sample is sampled again more closely.
    """
    joints, out = np.zeros((ORDERS, c.shape[1])), np.empty((ORDERS, COORDINATES))
    work, around = np.empty((WORK_ROWS, RRR_COLUMNS)), np.zeros(2)
    found[0], found[1], found[2], found[3] = -math.inf, t0, -math.inf, t0
    first, last = piece_at(tk, t0), piece_at(tk, t1)
    if last > first and tk[last] >= t1:
        last -= 1  # that piece follows on t1
    for p in range(first, last + 1):
        begin, end = max(t0, tk[p]), min(t1, tk[p + 1])
        many = max(parts, math.ceil((end - begin) / step))
        for k in range(many + 1):
            t = begin + (end - begin) * k / many
            piece_state(c, p, t - tk[p], joints)
            for which, rate in enumerate(tool_rate(robot, x, y, joints, out, work)):
                if rate != rate:
                    found[2 * which], found[2 * which + 1] = rate, t
                elif rate > found[2 * which]:
                    found[2 * which], found[2 * which + 1] = rate, t
                    around[which] = (end - begin) / many
    for which in range(2):
        begin = max(t0, found[2 * which + 1] - around[which])
        end = min(t1, found[2 * which + 1] + around[which])
        for k in range(AROUND + 1):
            t = begin + (end - begin) * k / AROUND
            p = min(piece_at(tk, t), last)
            piece_state(c, p, t - tk[p], joints)
            rate = tool_rate(robot, x, y, joints, out, work)[which]
            if rate > found[2 * which]:
                found[2 * which], found[2 * which + 1] = rate, t
