"""Motion of link frames for the motion of the joints, up to the third derivative.

A motion is (4, 6): a row an order, columns x, y, z, yaw, pitch, roll in the world, m and rad. Pitch and roll are 0 but
for the flange of a five-axis arm.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.dyads import RATES, RRR_COLUMNS, SOLVED, UX, UY, WORK_ROWS, WX, WY, fill_rows, rrr
from assur.planner.kernels.links import (
    BASE_COS,
    BASE_SIN,
    BASE_X,
    BASE_Y,
    BASE_YAW,
    BASE_Z,
    FIVE_BAR,
    HEIGHT,
    JOINTS,
    KIND,
    L1,
    L2,
    L3,
    L4,
    POLAR,
    RISES,
    SCARA,
    SIGMA,
)

ORDERS, COORDINATES = 4, 6
"""Shape of a motion."""


@kernel("void(float64[:, ::1], float64, float64, float64, float64, float64, float64, float64, float64)")
def add_turned(
    out: FloatArray, l0: float, l1: float, l2: float, l3: float, a0: float, a1: float, a2: float, a3: float
) -> None:
    """Adds l e(a) to columns 0 and 1 of `out`, and its derivatives, from those of both: K12, K20 to K22 backwards."""
    c, s = math.cos(a0), math.sin(a0)
    out[0, 0] += l0 * c
    out[0, 1] += l0 * s
    along, across = l1, l0 * a1
    out[1, 0] += along * c - across * s
    out[1, 1] += along * s + across * c
    along, across = l2 - l0 * a1 * a1, 2.0 * l1 * a1 + l0 * a2
    out[2, 0] += along * c - across * s
    out[2, 1] += along * s + across * c
    along = l3 - 3.0 * a1 * (l1 * a1 + l0 * a2)
    across = 3.0 * (l1 * a2 + l2 * a1) + l0 * (a3 - a1 * a1 * a1)
    out[3, 0] += along * c - across * s
    out[3, 1] += along * s + across * c


@kernel("void(float64[:, ::1], float64, float64[:, ::1], int64)")
def add_arm(out: FloatArray, length: float, angles: FloatArray, column: int) -> None:
    """Adds an arm of constant length at the angle whose orders are a column of `angles` (4, ...) (K12)."""
    a0, a1, a2, a3 = angles[0, column], angles[1, column], angles[2, column], angles[3, column]
    add_turned(out, length, 0.0, 0.0, 0.0, a0, a1, a2, a3)


@kernel("void(float64[::1], int64, float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def _move_scara(robot: FloatArray, link: int, joints: FloatArray, out: FloatArray, angles: FloatArray) -> None:
    """K9, K12; `angles` (4, ...) is room to work in."""
    lifted = 1 if robot[RISES] == 1.0 else 3
    for k in range(ORDERS):
        angles[k, 0] = joints[k, 0] + (robot[BASE_YAW] if k == 0 else 0.0)
        angles[k, 1] = angles[k, 0] + joints[k, 1]
        if link >= lifted:
            out[k, 2] += joints[k, 2]
        out[k, 3] = angles[k, 0] if link == 1 else angles[k, 1]
        if link == 3:
            out[k, 3] = 0.0
        elif link == 4 and robot[JOINTS] == 4.0:
            out[k, 3] += joints[k, 3]
    if link >= 2:
        add_arm(out, robot[L1], angles, 0)
    if link >= 3:
        add_arm(out, robot[L2], angles, 1)


@kernel("int64(float64[::1], float64, float64, float64[:, ::1])")
def close_loop(robot: FloatArray, theta1: float, theta5: float, work: FloatArray) -> int:
    """The dyad between the elbows of a five-bar (K32), in base axes, for the angles of its cranks; its code.

    Row `SOLVED` of `work` is filled, without rates.
    """
    work[0, 0] = robot[L3] * math.cos(theta5) - robot[L1] * math.cos(theta1)
    work[0, 1] = robot[L3] * math.sin(theta5) - robot[L1] * math.sin(theta1) - robot[HEIGHT]
    return rrr(robot[L2], robot[L4], robot[SIGMA], work, 0, work[SOLVED])


@kernel("void(float64[::1], int64, float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def _move_five_bar(robot: FloatArray, link: int, joints: FloatArray, out: FloatArray, work: FloatArray) -> None:
    """K32, K34 with the rates of the dyad between the elbows; `work` (8, 12) is room to work in."""
    right = link == 2 or link == 4
    side = -robot[HEIGHT] / 2.0 if right else robot[HEIGHT] / 2.0
    out[0, 0] -= robot[BASE_SIN] * side
    out[0, 1] += robot[BASE_COS] * side
    crank = 1 if right else 0
    for k in range(ORDERS):
        work[k, 2] = joints[k, crank] + (robot[BASE_YAW] if k == 0 else 0.0)
        out[k, 3] = work[k, 2]
    if link == 1 or link == 2:
        return
    add_arm(out, robot[L3] if right else robot[L1], work, 2)
    fill_rows(work, 0, ORDERS, 0.0)
    add_arm(work, robot[L3], joints, 1)
    add_arm(work, -robot[L1], joints, 0)
    work[0, 1] -= robot[HEIGHT]
    solved = work[SOLVED]
    rrr(robot[L2], robot[L4], robot[SIGMA], work, 3, solved)
    x, y = solved[UX], solved[UY]
    if right:
        x, y = -solved[WX], -solved[WY]
    work[0, 2] = robot[BASE_YAW] + math.atan2(y, x)
    for k in range(1, ORDERS):
        work[k, 2] = solved[RATES + 2 * (k - 1) + crank]
    if link >= 5:
        add_arm(out, robot[L2], work, 2)
    for k in range(ORDERS):
        out[k, 3] = work[k, 2]
        if link >= 5 and robot[JOINTS] > 2.0:
            out[k, 2] += joints[k, 2]
        if link == 5:
            out[k, 3] = 0.0
        elif link == 6 and robot[JOINTS] == 4.0:
            out[k, 3] += joints[k, 3]


@kernel("void(float64[::1], int64, float64[:, ::1], float64[:, ::1])")
def move_in_plane(robot: FloatArray, link: int, joints: FloatArray, plane: FloatArray) -> None:
    """Fills columns 0 and 1 of `plane` (4, ...) with ρ and h of a link's origin (K24, K25, H2)."""
    fill_rows(plane, 0, ORDERS, 0.0)
    if robot[KIND] == POLAR:
        if link >= 3:
            l0, l1, l2, l3 = joints[0, 2], joints[1, 2], joints[2, 2], joints[3, 2]
            add_turned(plane, l0, l1, l2, l3, joints[0, 1], joints[1, 1], joints[2, 1], joints[3, 1])
        return
    p0, p1, p2, p3 = joints[0, 1], joints[1, 1], joints[2, 1], joints[3, 1]
    # the forearm's origin is at the end of the upper arm, the hand's at that of the forearm
    for arm in range(link - 2):
        length = robot[L1] if arm == 0 else (robot[L2] if arm == 1 else robot[L3])
        add_turned(plane, length, 0.0, 0.0, 0.0, p0, p1, p2, p3)
        if arm + 2 < joints.shape[1]:
            p0, p1 = p0 + joints[0, arm + 2], p1 + joints[1, arm + 2]
            p2, p3 = p2 + joints[2, arm + 2], p3 + joints[3, arm + 2]


@kernel("void(float64[::1], int64, float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def _move_tilting(robot: FloatArray, link: int, joints: FloatArray, out: FloatArray, plane: FloatArray) -> None:
    """K23, H1; `plane` (4, ...) is room to work in."""
    move_in_plane(robot, link, joints, plane)
    heading = joints[0, 0] + robot[BASE_YAW]
    r0, r1, r2, r3 = plane[0, 0], plane[1, 0], plane[2, 0], plane[3, 0]
    add_turned(out, r0, r1, r2, r3, heading, joints[1, 0], joints[2, 0], joints[3, 0])
    out[0, 2] += robot[HEIGHT]
    for k in range(ORDERS):
        out[k, 2] += plane[k, 1]
        out[k, 3] = heading if k == 0 else joints[k, 0]
        if link == 5:
            out[k, 4], out[k, 5] = joints[k, 1] + joints[k, 2] + joints[k, 3], joints[k, 4]


@kernel("void(float64[::1], int64, float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def link_motion(robot: FloatArray, link: int, joints: FloatArray, out: FloatArray, work: FloatArray) -> None:
    """Fills `out` (4, 6) with the motion of link number `link` for the motion `joints` (4, n) of the joints.

    NaN where the arm does not assemble; what depends on an order that is NaN is NaN. `work` (8, 12) is room to work in.
    """
    fill_rows(out, 0, ORDERS, 0.0)
    out[0, 0], out[0, 1], out[0, 2] = robot[BASE_X], robot[BASE_Y], robot[BASE_Z]
    if link == 0:
        out[0, 3] = robot[BASE_YAW]
    elif robot[KIND] == SCARA:
        _move_scara(robot, link, joints, out, work)
    elif robot[KIND] == FIVE_BAR:
        _move_five_bar(robot, link, joints, out, work)
    else:
        _move_tilting(robot, link, joints, out, work)


@kernel("void(float64[::1], int64, float64[:, :, ::1], float64[:, :, ::1])", allocates=True)
def link_motions(robot: FloatArray, link: int, joints: FloatArray, out: FloatArray) -> None:
    """`link_motion` for each row of `joints` (N, 4, n), into `out` (N, 4, 6)."""
    work = np.empty((WORK_ROWS, RRR_COLUMNS))
    for i in range(len(joints)):
        link_motion(robot, link, joints[i], out[i], work)
