"""Joint states for a motion of the flange, and facts about a joint vector: one branch a family.

A motion is (4, 6): a row an order, columns x, y, z, yaw, pitch, roll in the world, m and rad (`motion`).
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel
from assur.planner.kernels.dyads import (
    ALIGNED,
    ANGLE,
    ASSEMBLED,
    CROSS,
    FOLDED,
    INDETERMINATE,
    LEFT,
    LENGTH,
    MARGIN,
    OUT_OF_REACH,
    PARALLEL,
    RATES,
    RIGHT,
    ROUNDING,
    RRR_COLUMNS,
    SOLVED,
    STRETCHED,
    UX,
    UY,
    WORK_ROWS,
    WX,
    WY,
    fill,
    fill_rows,
    rpr,
    rrr,
)
from assur.planner.kernels.links import (
    BASE_COS,
    BASE_SIN,
    BASE_X,
    BASE_Y,
    BASE_YAW,
    BASE_Z,
    FIVE_AXIS,
    FIVE_BAR,
    HEIGHT,
    JOINTS,
    KIND,
    L1,
    L2,
    L3,
    L4,
    LONGEST,
    PARALLEL_LEAST,
    POLAR,
    SCARA,
    SIGMA,
)
from assur.planner.kernels.motion import ORDERS, add_vector, close_five_bar, turn_left

TURN = 2.0 * math.pi
"""A full turn, rad."""
FLAT_M = 1e-9
"""How far from its height, m (and m/s, m/s²), the required flange of an arm without a quill may be: rounding."""

SINGULARITY, DISTANCE, MODE, SERIAL, LOOP = range(5)
"""Columns of a posture: which singularity its margin is measured to, a code of `dyads`; metres that the flange may move
until the arm is there; working mode, −1 where it has none; serial and parallel margin."""
POSTURE_COLUMNS = 5


@kernel("float64(float64)")
def principal(angle: float) -> float:
    """The angle in (−π, π], rad; what is there keeps its bits, but −π and what rounds to it becomes π."""
    return angle - TURN * math.ceil((angle - math.pi) / TURN) if math.isfinite(angle) else math.nan


@kernel("float64(float64[:, ::1], int64, int64)")
def _known(target: FloatArray, order: int, column: int) -> float:
    """0 if a column of a motion is finite up to `order`, else NaN."""
    total = 0.0
    for k in range(order + 1):
        total += 0.0 * target[k, column]
    return total


@kernel("int64(float64[:, ::1], int64)")
def _leave_out(joints: FloatArray, code: int) -> int:
    """Makes NaN what a code does not define: derivatives, and out of reach the position, too. Returns the code."""
    if code != ASSEMBLED:
        nowhere = code in (OUT_OF_REACH, INDETERMINATE)
        fill_rows(joints, 0 if nowhere else 1, ORDERS, math.nan)
    return code


TARGET = "float64[::1], int64, int64, float64[:, ::1], float64[:, ::1], float64[::1], float64[:, ::1]"


@kernel(f"int64({TARGET})")
def _invert_scara(
    robot: FloatArray,
    mode: int,
    order: int,
    target: FloatArray,
    joints: FloatArray,
    margins: FloatArray,
    work: FloatArray,
) -> int:
    """K10."""
    d, solved = work, work[SOLVED]
    for k in range(order + 1):
        d[k, 0], d[k, 1] = target[k, 0], target[k, 1]
    d[0, 0] -= robot[BASE_X]
    d[0, 1] -= robot[BASE_Y]
    code = rrr(robot[L1], robot[L2], LEFT if mode == 0 else RIGHT, d, order, solved)
    wrist = robot[JOINTS] == 4.0
    given = _known(target, order, 2)
    if wrist:
        given += _known(target, order, 3)
    if not math.isfinite(given):
        code = OUT_OF_REACH
    ux, uy, wx, wy = solved[UX], solved[UY], solved[WX], solved[WY]
    joints[0, 0] = principal(math.atan2(uy, ux) - robot[BASE_YAW])
    joints[0, 1] = math.atan2(solved[CROSS], ux * wx + uy * wy)
    joints[0, 2] = target[0, 2] - robot[BASE_Z]
    if wrist:
        joints[0, 3] = principal(target[0, 3] - robot[BASE_YAW] - joints[0, 0] - joints[0, 1])
    for k in range(1, order + 1):
        rate1, rate2 = solved[RATES + 2 * k - 2], solved[RATES + 2 * k - 1]
        joints[k, 0], joints[k, 1], joints[k, 2] = rate1, rate2 - rate1, target[k, 2]
        if wrist:
            joints[k, 3] = target[k, 3] - rate2
    margins[0] = solved[MARGIN]
    return _leave_out(joints, code)


@kernel("int64(int64)")
def _rank(code: int) -> int:
    """Of two codes the one with the higher rank is reported."""
    if code == OUT_OF_REACH:
        return 5
    if code == INDETERMINATE:
        return 4
    return code


@kernel(f"int64({TARGET})")
def _invert_five_bar(
    robot: FloatArray,
    mode: int,
    order: int,
    target: FloatArray,
    joints: FloatArray,
    margins: FloatArray,
    work: FloatArray,
) -> int:
    """K35: a dyad on either side, from the axis of its crank to the tool axis."""
    d, left, right = work, work[SOLVED], work[SOLVED + 1]
    c, s, half = robot[BASE_COS], robot[BASE_SIN], robot[HEIGHT] / 2.0
    for k in range(order + 1):
        x, y = target[k, 0], target[k, 1]
        if k == 0:
            x, y = x - robot[BASE_X], y - robot[BASE_Y]
        d[k, 0], d[k, 1] = c * x + s * y, c * y - s * x
    d[0, 1] -= half
    code_left = rrr(robot[L1], robot[L2], RIGHT if mode // 2 == 1 else LEFT, d, order, left)
    d[0, 1] += robot[HEIGHT]
    code_right = rrr(robot[L3], robot[L4], RIGHT if mode % 2 == 1 else LEFT, d, order, right)
    code = code_left if _rank(code_left) >= _rank(code_right) else code_right
    cross = right[WX] * left[WY] - right[WY] * left[WX]
    parallel = -cross * robot[SIGMA] / (robot[L2] * robot[L4])  # K33
    joints[0, 0] = principal(math.atan2(left[UY], left[UX]))
    joints[0, 1] = principal(math.atan2(right[UY], right[UX]))
    given = _known(target, order, 2)
    axes = robot[JOINTS]
    for k in range(order + 1):
        if k > 0:
            joints[k, 0], joints[k, 1] = left[RATES + 2 * k - 2], right[RATES + 2 * k - 2]
        height = target[k, 2] - (robot[BASE_Z] if k == 0 else 0.0)
        if axes > 2.0:
            joints[k, 2] = height
        elif not abs(height) <= FLAT_M:
            code = OUT_OF_REACH
    if axes == 4.0:
        given += _known(target, order, 3)
        coupler = math.atan2(left[WY], left[WX])
        joints[0, 3] = principal(target[0, 3] - robot[BASE_YAW] - coupler)
        for k in range(1, order + 1):
            joints[k, 3] = target[k, 3] - left[RATES + 2 * k - 1]
    if not math.isfinite(given):
        code = OUT_OF_REACH
    margins[0], margins[1] = min(left[MARGIN], right[MARGIN]), parallel
    _leave_out(joints, code)
    if code != OUT_OF_REACH and code != INDETERMINATE and not parallel >= robot[PARALLEL_LEAST]:
        return PARALLEL
    return code


@kernel(f"int64({TARGET})")
def _invert_tilting(
    robot: FloatArray,
    mode: int,
    order: int,
    target: FloatArray,
    joints: FloatArray,
    margins: FloatArray,
    work: FloatArray,
) -> int:
    """K23 to K25, H2, H3: base angle and radius of the tool point, then the dyad in the plane."""
    longest = robot[LONGEST]
    polar, wrist = robot[KIND] == POLAR, robot[KIND] == FIVE_AXIS
    d, base, solved = work, work[SOLVED + 1], work[SOLVED]
    for k in range(order + 1):
        d[k, 0], d[k, 1] = target[k, 0], target[k, 1]
    d[0, 0] -= robot[BASE_X]
    d[0, 1] -= robot[BASE_Y]
    back = mode == 1 if polar else mode >= 2
    code_base = rpr(ROUNDING * longest, -1.0 if back else 1.0, d, order, base)
    # over the axis the radius has no derivatives, but the posture is that of (0, h)
    aligned = code_base == INDETERMINATE
    for k in range(order + 1):
        d[k, 0], d[k, 1] = 0.0 if aligned else base[LENGTH + 2 * k], target[k, 2]
    d[0, 1] -= robot[BASE_Z] + robot[HEIGHT]
    radius = d[0, 0]
    given = 0.0
    if wrist:
        given = _known(target, order, 4) + _known(target, order, 5)
        # the wrist: the tool point less the hand; orders that are not given stay out
        p1 = target[1, 4] if order > 0 else 0.0
        p2 = target[2, 4] if order > 1 else 0.0
        p3 = target[3, 4] if order > 2 else 0.0
        none = (0.0, 0.0, 0.0, 0.0)
        add_vector(d, turn_left((-robot[L3], 0.0, 0.0, 0.0), none, (target[0, 4], p1, p2, p3)))
    if polar:
        code = rpr(ROUNDING * longest, 1.0, d, order, solved)
        margins[0] = min(solved[LENGTH] / longest, 1.0)
        joints[0, 1], joints[0, 2] = principal(solved[ANGLE]), solved[LENGTH]
    else:
        left = mode == 0 or mode == 3
        code = rrr(robot[L1], robot[L2], LEFT if left else RIGHT, d, order, solved)
        margins[0] = solved[MARGIN]
        ux, uy, wx, wy = solved[UX], solved[UY], solved[WX], solved[WY]
        joints[0, 1] = math.atan2(uy + 0.0, ux)  # + 0.0: an arm that points straight back is at π, not −π
        joints[0, 2] = math.atan2(solved[CROSS], ux * wx + uy * wy)
    joints[0, 0] = principal(base[ANGLE] - robot[BASE_YAW])
    for k in range(1, order + 1):
        joints[k, 0] = base[ANGLE + 2 * k]
        if polar:
            joints[k, 1], joints[k, 2] = solved[2 * k], solved[2 * k + 1]
        else:
            rate1, rate2 = solved[RATES + 2 * k - 2], solved[RATES + 2 * k - 1]
            joints[k, 1], joints[k, 2] = rate1, rate2 - rate1
    margins[0] = min(margins[0], abs(radius) / longest)
    if code_base == OUT_OF_REACH or not math.isfinite(given):
        code = OUT_OF_REACH
    if wrist:
        for k in range(order + 1):
            joints[k, 3], joints[k, 4] = target[k, 4] - joints[k, 1] - joints[k, 2], target[k, 5]
        joints[0, 3], joints[0, 4] = principal(joints[0, 3]), principal(joints[0, 4])
    if aligned and code != OUT_OF_REACH and code != INDETERMINATE:
        code = ALIGNED
    return _leave_out(joints, code)


@kernel(f"int64({TARGET})")
def joint_states(
    robot: FloatArray,
    mode: int,
    order: int,
    target: FloatArray,
    joints: FloatArray,
    margins: FloatArray,
    work: FloatArray,
) -> int:
    """Fills `joints` (4, n) with the motion that gives the flange the motion `target` (4, 6) in a working mode.

    Returns the code. Orders above `order` (0 to 3) are not read and are NaN. `margins` (2,): serial, and parallel (1
    without a loop). A row that is not ASSEMBLED holds NaN in what is not defined: a stretched or folded arm has a
    position but no derivatives, an arm over its base axis (ALIGNED) all but the base angle, one out of reach nothing.
    PARALLEL is in the other assembly mode, or nearer to a type 2 singularity than the robot may be: it has a state, and
    is not to be followed. Revolute joints are in (−π, π]; not checked: joint limits. `work` (8, 12) is room to work in.
    """
    fill_rows(joints, 0, ORDERS, math.nan)
    margins[1] = 1.0
    if robot[KIND] == SCARA:
        code = _invert_scara(robot, mode, order, target, joints, margins, work)
    elif robot[KIND] == FIVE_BAR:
        code = _invert_five_bar(robot, mode, order, target, joints, margins, work)
    else:
        code = _invert_tilting(robot, mode, order, target, joints, margins, work)
    if code in (OUT_OF_REACH, INDETERMINATE):
        margins[0] = math.nan
        if robot[KIND] == FIVE_BAR:
            margins[1] = math.nan
    return code


@kernel(
    "void(float64[::1], int64, int64, float64[:, :, ::1], float64[:, :, ::1], float64[:, ::1], int64[::1])",
    allocates=True,
)
def joint_motions(
    robot: FloatArray,
    mode: int,
    order: int,
    targets: FloatArray,
    joints: FloatArray,
    margins: FloatArray,
    codes: IntArray,
) -> None:
    """`joint_states` for each of `targets` (N, 4, 6), into `joints` (N, 4, n), `margins` (N, 2), `codes` (N,)."""
    work = np.empty((WORK_ROWS, RRR_COLUMNS))
    for i in range(len(targets)):
        codes[i] = joint_states(robot, mode, order, targets[i], joints[i], margins[i], work)


@kernel("void(float64, float64, float64, float64[::1])")
def _dyad_posture(l1: float, l2: float, bend: float, out: FloatArray) -> None:
    """Singularity, distance and margin of an RRR dyad bent by θ (K16)."""
    outer, inner, product = l1 + l2, abs(l1 - l2), 4.0 * l1 * l2
    beyond, within = product * math.sin(bend / 2.0) ** 2, product * math.cos(bend / 2.0) ** 2
    radius = math.sqrt(inner * inner + within)
    out[DISTANCE] = min(beyond / (outer + radius), within / (inner + radius))
    out[SINGULARITY] = STRETCHED if math.cos(bend) >= 0.0 else FOLDED
    out[SERIAL] = abs(math.sin(bend))


@kernel("void(float64[::1], float64[::1], float64[::1], float64[:, ::1])")
def posture(robot: FloatArray, q: FloatArray, out: FloatArray, work: FloatArray) -> None:
    """Fills `out` (5,) for a joint vector; NaN and mode −1 for what is not finite or does not assemble.

    `work` (8, 12) is room to work in.
    """
    fill(out, math.nan)
    out[MODE], out[LOOP] = -1.0, 1.0
    kind = robot[KIND]
    total = 0.0
    for i in range(len(q)):
        total += 0.0 * q[i]
    if not math.isfinite(total):
        out[LOOP] = math.nan if kind == FIVE_BAR else 1.0
        return
    if kind == SCARA:
        _dyad_posture(robot[L1], robot[L2], q[1], out)
        out[MODE] = 1.0 if math.sin(q[1]) > 0.0 else 0.0
        return
    if kind == FIVE_BAR:
        close_five_bar(robot, q[0], q[1], work)
        solved = work[SOLVED]
        out[LOOP] = solved[MARGIN]
        bend_left = math.atan2(solved[UY], solved[UX]) - q[0]
        bend_right = math.atan2(-solved[WY], -solved[WX]) - q[1]
        if not math.isfinite(bend_left + bend_right):
            return
        _dyad_posture(robot[L3], robot[L4], bend_right, out)
        right_code, right_distance, right_margin = out[SINGULARITY], out[DISTANCE], out[SERIAL]
        _dyad_posture(robot[L1], robot[L2], bend_left, out)
        if right_margin < out[SERIAL]:
            out[SINGULARITY], out[SERIAL] = right_code, right_margin
        out[DISTANCE] = min(out[DISTANCE], right_distance)
        out[MODE] = (2.0 if math.sin(bend_left) > 0.0 else 0.0) + (1.0 if math.sin(bend_right) > 0.0 else 0.0)
        return
    if kind == POLAR:
        rho = q[2] * math.cos(q[1])
        out[SINGULARITY], out[DISTANCE], out[SERIAL] = FOLDED, abs(q[2]), min(abs(q[2]) / robot[LONGEST], 1.0)
        out[MODE] = 0.0 if rho >= 0.0 else 1.0
    else:
        rho = robot[L1] * math.cos(q[1]) + robot[L2] * math.cos(q[1] + q[2])
        if kind == FIVE_AXIS:
            rho += robot[L3] * math.cos(q[1] + q[2] + q[3])
        _dyad_posture(robot[L1], robot[L2], q[2], out)
        bent = math.sin(q[2]) > 0.0
        if rho >= 0.0:
            out[MODE] = 1.0 if bent else 0.0
        else:
            out[MODE] = 2.0 if bent else 3.0
    if abs(rho) / robot[LONGEST] < out[SERIAL]:
        out[SINGULARITY], out[SERIAL] = ALIGNED, abs(rho) / robot[LONGEST]
    out[DISTANCE] = min(out[DISTANCE], abs(rho))


@kernel("void(float64[::1], float64[:, ::1], float64[:, ::1])", allocates=True)
def postures(robot: FloatArray, q: FloatArray, out: FloatArray) -> None:
    """`posture` for each row of q (N, n), into `out` (N, 5)."""
    work = np.empty((WORK_ROWS, RRR_COLUMNS))
    for i in range(len(q)):
        posture(robot, q[i], out[i], work)
