"""Motion of link frames for the motion of the joints, up to the third derivative, for any chain of `links`.

A motion is (4, 6): a row an order, columns x, y, z, yaw, pitch, roll in the world, m and rad. A *series* is a number
with its first three derivatives. The origin of a link is the sum of the offsets of the links on the way to it, each
turned by the angles of its parent; these are sums of joints (K12, K20 to K25 backwards, K32, K34, H1, H2).
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.compiled import kernel
from assur.planner.kernels.dyads import RATES, RRR_COLUMNS, SOLVED, UX, UY, WORK_ROWS, WX, WY, fill_rows, rrr
from assur.planner.kernels.links import (
    ANGLE,
    ANGLES,
    APART,
    BASE_COS,
    BASE_SIN,
    BASE_YAW,
    CHAIN,
    HEIGHT,
    L1,
    L2,
    L3,
    L4,
    LOOP,
    SIGMA,
)

ORDERS, COORDINATES = 4, 6
"""Shape of a motion."""
Series = tuple[float, float, float, float]
Vectors = tuple[complex, complex, complex, complex]
"""A vector of a plane with its first three derivatives: its coordinates are real and imaginary part."""
SERIES, VECTORS = "UniTuple(float64, 4)", "UniTuple(complex128, 4)"


@kernel(f"{VECTORS}({SERIES}, {SERIES}, {SERIES})")
def turn_left(x: Series, y: Series, a: Series) -> Vectors:
    """The vector (x, y), turned by the angle a to the left."""
    e, e1 = complex(math.cos(a[0]), math.sin(a[0])), complex(0.0, a[1])
    e2, e3 = complex(-a[1] * a[1], a[2]), complex(-3.0 * a[1] * a[2], a[3] - a[1] * a[1] * a[1])
    v, v1, v2, v3 = complex(x[0], y[0]), complex(x[1], y[1]), complex(x[2], y[2]), complex(x[3], y[3])
    return (
        e * v,
        e * (v1 + e1 * v),
        e * (v2 + 2.0 * (e1 * v1) + e2 * v),
        e * (v3 + 3.0 * (e1 * v2 + e2 * v1) + e3 * v),
    )


@kernel(f"void(float64[:, ::1], {VECTORS})")
def add_vector(out: FloatArray, vector: Vectors) -> None:
    """Adds a vector to columns 0 and 1 of `out` (4, ...)."""
    for k in range(ORDERS):
        out[k, 0] += vector[k].real
        out[k, 1] += vector[k].imag


@kernel(f"{SERIES}(float64[::1], float64, float64[:, ::1])")
def angle_of(robot: FloatArray, number: float, joints: FloatArray) -> Series:
    """An angle of the chain, for the motion `joints` (4, n) of the joints."""
    at = int(robot[ANGLES]) + ANGLE * int(number)
    x0, x1, x2, x3 = robot[at + c.ANGLE_CONSTANT], 0.0, 0.0, 0.0
    for j in range(joints.shape[1]):
        share = robot[at + c.ANGLE_SHARE + j]
        if share != 0.0:
            x0, x1 = x0 + share * joints[0, j], x1 + share * joints[1, j]
            x2, x3 = x2 + share * joints[2, j], x3 + share * joints[3, j]
    return x0, x1, x2, x3


@kernel("int64(float64[::1], float64, float64, float64[:, ::1])")
def close_five_bar(robot: FloatArray, theta1: float, theta5: float, work: FloatArray) -> int:
    """The dyad between the elbows of a five-bar (K32), in base axes, for the angles of its cranks; its code.

    Row `SOLVED` of `work` is filled, without rates.
    """
    work[0, 0] = robot[L3] * math.cos(theta5) - robot[L1] * math.cos(theta1)
    work[0, 1] = robot[L3] * math.sin(theta5) - robot[L1] * math.sin(theta1) - robot[HEIGHT]
    return rrr(robot[L2], robot[L4], robot[SIGMA], work, 0, work[SOLVED])


@kernel(f"{SERIES}(float64[::1], int64, float64[:, ::1], float64[:, ::1])")
def yaw_of(robot: FloatArray, k: int, joints: FloatArray, work: FloatArray) -> Series:
    """The yaw of link k, that of its coupler counted from the base's; `work` (8, 12) is room to work in."""
    at, loop = CHAIN + k * c.LINK, int(robot[LOOP])
    yaw, coupler = angle_of(robot, robot[at + c.LINK_YAW], joints), int(robot[at + c.LINK_COUPLER])
    if coupler < 0:
        return yaw
    fill_rows(work, 0, ORDERS, 0.0)
    work[0, 0], work[0, 1] = robot[loop + APART], robot[loop + APART + 1]
    for side in range(2):
        length, crank = robot[loop + c.LOOP_LENGTH + side], int(robot[loop + c.LOOP_CRANK + side])
        crank_yaw = angle_of(robot, robot[CHAIN + crank * c.LINK + c.LINK_YAW], joints)
        arm = (length if side == 1 else -length, 0.0, 0.0, 0.0)
        add_vector(work, turn_left(arm, (0.0, 0.0, 0.0, 0.0), crank_yaw))
    a, b, solved = robot[loop + c.LOOP_COUPLER], robot[loop + c.LOOP_COUPLER + 1], work[SOLVED]
    rrr(a, b, robot[loop + c.LOOP_SIDE], work, ORDERS - 1, solved)
    x, y = (solved[UX], solved[UY]) if coupler == 0 else (-solved[WX], -solved[WY])
    along, across = robot[BASE_COS] * x + robot[BASE_SIN] * y, robot[BASE_COS] * y - robot[BASE_SIN] * x
    first = RATES + coupler
    return (
        yaw[0] + robot[BASE_YAW] + math.atan2(across, along),
        yaw[1] + solved[first],
        yaw[2] + solved[first + 2],
        yaw[3] + solved[first + 4],
    )


@kernel(f"{SERIES}(float64[::1], int64, int64, float64[:, ::1])")
def _offset(robot: FloatArray, at: int, axis: int, joints: FloatArray) -> Series:
    """A coordinate of the origin of the link whose columns begin at `at`, in its parent."""
    slide, share = int(robot[at + c.LINK_SLIDE]), robot[at + c.LINK_AXIS + axis]
    x = robot[at + c.LINK_OFFSET + axis]
    if slide < 0 or share == 0.0:
        return x, 0.0, 0.0, 0.0
    return x + share * joints[0, slide], share * joints[1, slide], share * joints[2, slide], share * joints[3, slide]


@kernel("void(float64[::1], int64, float64[:, ::1], float64[:, ::1], float64[:, ::1])")
def link_motion(robot: FloatArray, link: int, joints: FloatArray, out: FloatArray, work: FloatArray) -> None:
    """Fills `out` (4, 6) with the motion of link number `link` for the motion `joints` (4, n) of the joints.

    NaN where the arm does not assemble; what depends on an order that is NaN is NaN. No link is on one that rolls.
    `work` (8, 12) is room to work in.
    """
    fill_rows(out, 0, ORDERS, 0.0)
    k = link
    while k >= 0:
        at = CHAIN + k * c.LINK
        x, y, z = _offset(robot, at, 0, joints), _offset(robot, at, 1, joints), _offset(robot, at, 2, joints)
        k = int(robot[at + c.LINK_PARENT])
        yaw = (0.0, 0.0, 0.0, 0.0)
        if k >= 0:
            yaw, pitch = yaw_of(robot, k, joints, work), robot[CHAIN + k * c.LINK + c.LINK_PITCH]
            if pitch >= 0.0:
                tilted = turn_left(x, z, angle_of(robot, pitch, joints))
                x = (tilted[0].real, tilted[1].real, tilted[2].real, tilted[3].real)
                z = (tilted[0].imag, tilted[1].imag, tilted[2].imag, tilted[3].imag)
        add_vector(out, turn_left(x, y, yaw))
        for order in range(ORDERS):
            out[order, 2] += z[order]
    at, yaw = CHAIN + link * c.LINK, yaw_of(robot, link, joints, work)
    for order in range(ORDERS):
        out[order, 3] = yaw[order]
    for column, number in ((4, robot[at + c.LINK_PITCH]), (5, robot[at + c.LINK_ROLL])):
        if number >= 0.0:
            angle = angle_of(robot, number, joints)
            for order in range(ORDERS):
                out[order, column] = angle[order]


@kernel("void(float64[::1], int64, float64[:, :, ::1], float64[:, :, ::1])", allocates=True)
def link_motions(robot: FloatArray, link: int, joints: FloatArray, out: FloatArray) -> None:
    """`link_motion` for each row of `joints` (N, 4, n), into `out` (N, 4, 6)."""
    work = np.empty((WORK_ROWS, RRR_COLUMNS))
    for i in range(len(joints)):
        link_motion(robot, link, joints[i], out[i], work)


@kernel("void(float64[:, :, ::1], float64, float64)")
def move_aside(motions: FloatArray, x: float, y: float) -> None:
    """Moves motions (T, 4, C), a row an order, columns x, y, z, yaw and others, to a point that is fixed in their frame
    at (x, y), m. With r = R(yaw) (x, y) and r⊥ = ẑ × r:  ṙ = ω r⊥,  r̈ = α r⊥ − ω² r,  r⃛ = (α̇ − ω³) r⊥ − 3 ω α r."""
    for row in range(len(motions)):
        motion = motions[row]
        cosine, sine = math.cos(motion[0, 3]), math.sin(motion[0, 3])
        rx, ry = cosine * x - sine * y, sine * x + cosine * y
        w, dw, ddw = motion[1, 3], motion[2, 3], motion[3, 3]
        motion[0, 0] += rx
        motion[0, 1] += ry
        motion[1, 0] -= w * ry
        motion[1, 1] += w * rx
        motion[2, 0] += -dw * ry - w * w * rx
        motion[2, 1] += dw * rx - w * w * ry
        motion[3, 0] += -(ddw - w * w * w) * ry - 3.0 * w * dw * rx
        motion[3, 1] += (ddw - w * w * w) * rx - 3.0 * w * dw * ry
