"""Where the links of an arm are, and bounds of their motion: one branch a family, chosen by an integer.

A robot is a row of numbers: `KIND`, then the lengths that its family has, unused ones being 0. Nothing outside this
module and `inverse` knows the arm.

Carriers are rows, links first: `placed` (L, 12) has a position, m, and a rotation matrix, row by row, in the world;
`bounds` (L, 22) has what bounds the motion of any point that a carrier carries (K43 of docs/kinematics.md). With r the
point's distance from the carrier's z axis, s that from its origin, h = |n_xy|:

    |n·ẋ| ≤ |n·v| + Σ |n_i| b_i + h (v_h + v_r r + v_s s) + v_0 + v_1 s                                     (K43)

and the same for |n·ẍ|, with v a known velocity, b half the width of a box around it, v_h + … a horizontal speed,
v_0 + … a speed in any direction.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.dyads import RRR_COLUMNS, SOLVED, UX, UY, WX, WY, fill_rows, rrr

SCARA, FIVE_BAR, ELBOW, POLAR, FIVE_AXIS = range(5)
"""Kinds of arms."""

KIND = 0
JOINTS = 1
"""Number of joints: a SCARA or a five-bar with three axes has no wrist, a five-bar with two no quill."""
LINKS = 2
BASE_X, BASE_Y, BASE_Z, BASE_YAW, BASE_COS, BASE_SIN = range(3, 9)
"""Pose of the base in the world, m and rad, with the cosine and the sine of its yaw."""
L1, L2, L3, L4 = range(9, 13)
"""Lengths of links, m. Five-bar: left crank, left coupler, right crank, right coupler. Polar arm: none."""
HEIGHT = 13
"""Height of the shoulder above the base, m. Five-bar: the distance of its crank axes."""
RISES = 14
"""SCARA: 1 if its arms rise with the lift, else 0."""
SIGMA = 15
"""Five-bar: assembly mode of its loop, `LEFT` or `RIGHT` of `dyads`."""
PARALLEL_LEAST = 16
"""Five-bar: least parallel margin (no unit)."""
LONGEST = 17
"""The farthest that the flange can be from the shoulder, m."""
ROBOT_COLUMNS = 18

MOST_JOINTS = 5
MOST_LINKS = 7
POSE_COLUMNS = 12

V, V_BOX, V_FLAT, V_REACH, V_FAR, V_ANY, V_ANY_FAR = 0, 3, 6, 7, 8, 9, 10
"""Columns of bounds of speed, as in K43: three of a known velocity, three of the box around it, horizontal speed and
its growth with reach and with distance, speed in any direction and its growth with distance."""
ACCELERATION = 11
"""Where the same columns for acceleration begin."""
BOUND_COLUMNS = 22

BEYOND = 1.0 + 1e-6
"""Share of a polar arm's longest stroke up to which bounds hold: a trajectory may exceed its limits by rounding."""
LOOP_ROUNDING = 1e-12
"""Relative to the square of all lengths: what is added to every bound of |s|², whose terms round to some 1e-15."""


@kernel("void(float64[:, ::1], int64, float64, float64, float64, float64, float64)")
def put_upright(placed: FloatArray, k: int, x: float, y: float, z: float, c: float, s: float) -> None:
    """Carrier k is at (x, y, z), turned about the vertical by the angle with cosine c and sine s."""
    row = placed[k]
    row[0], row[1], row[2] = x, y, z
    row[3], row[4], row[5] = c, -s, 0.0
    row[6], row[7], row[8] = s, c, 0.0
    row[9], row[10], row[11] = 0.0, 0.0, 1.0


@kernel("void(float64[::1], float64[::1], float64[:, ::1])")
def _place_scara(robot: FloatArray, q: FloatArray, placed: FloatArray) -> None:
    """K9."""
    x, y, z = robot[BASE_X], robot[BASE_Y], robot[BASE_Z]
    phi1 = q[0] + robot[BASE_YAW]
    phi2 = phi1 + q[1]
    c1, s1, c2, s2 = math.cos(phi1), math.sin(phi1), math.cos(phi2), math.sin(phi2)
    tip = z + q[2]
    arms = tip if robot[RISES] == 1.0 else z
    elbow_x, elbow_y = x + robot[L1] * c1, y + robot[L1] * s1
    tip_x, tip_y = elbow_x + robot[L2] * c2, elbow_y + robot[L2] * s2
    put_upright(placed, 0, x, y, z, robot[BASE_COS], robot[BASE_SIN])
    put_upright(placed, 1, x, y, arms, c1, s1)
    put_upright(placed, 2, elbow_x, elbow_y, arms, c2, s2)
    put_upright(placed, 3, tip_x, tip_y, tip, 1.0, 0.0)
    if robot[JOINTS] == 4.0:
        phi4 = phi2 + q[3]
        c2, s2 = math.cos(phi4), math.sin(phi4)
    put_upright(placed, 4, tip_x, tip_y, tip, c2, s2)


@kernel("int64(float64[::1], float64, float64, float64[:, ::1])")
def close_loop(robot: FloatArray, theta1: float, theta5: float, work: FloatArray) -> int:
    """The dyad between the elbows of a five-bar (K32), in base axes, for the angles of its cranks; its code.

    Row `SOLVED` of `work` is filled, without rates.
    """
    work[0, 0] = robot[L3] * math.cos(theta5) - robot[L1] * math.cos(theta1)
    work[0, 1] = robot[L3] * math.sin(theta5) - robot[L1] * math.sin(theta1) - robot[HEIGHT]
    return rrr(robot[L2], robot[L4], robot[SIGMA], work, 0, work[SOLVED])


@kernel("void(float64[::1], float64[::1], float64[:, ::1])", allocates=True)
def _place_five_bar(robot: FloatArray, q: FloatArray, placed: FloatArray) -> None:
    """K34; NaN beyond the cranks where the loop does not assemble."""
    work = np.empty((SOLVED + 1, RRR_COLUMNS))
    close_loop(robot, q[0], q[1], work)
    solved = work[SOLVED]
    c, s, z = robot[BASE_COS], robot[BASE_SIN], robot[BASE_Z]
    half = robot[HEIGHT] / 2.0
    x, y = robot[BASE_X], robot[BASE_Y]
    put_upright(placed, 0, x, y, z, c, s)
    # axes of the cranks, in the world
    left_x, left_y, right_x, right_y = x - s * half, y + c * half, x + s * half, y - c * half
    phi1, phi5 = q[0] + robot[BASE_YAW], q[1] + robot[BASE_YAW]
    c1, s1, c5, s5 = math.cos(phi1), math.sin(phi1), math.cos(phi5), math.sin(phi5)
    ux, uy = c * solved[UX] - s * solved[UY], s * solved[UX] + c * solved[UY]
    wx, wy = s * solved[WY] - c * solved[WX], -s * solved[WX] - c * solved[WY]
    elbow_x, elbow_y = left_x + robot[L1] * c1, left_y + robot[L1] * s1
    tip_x, tip_y = elbow_x + ux, elbow_y + uy
    tip = z + q[2] if robot[JOINTS] > 2.0 else z
    c2, s2 = ux / robot[L2], uy / robot[L2]
    put_upright(placed, 1, left_x, left_y, z, c1, s1)
    put_upright(placed, 2, elbow_x, elbow_y, z, c2, s2)
    put_upright(placed, 3, right_x, right_y, z, c5, s5)
    put_upright(placed, 4, right_x + robot[L3] * c5, right_y + robot[L3] * s5, z, wx / robot[L4], wy / robot[L4])
    put_upright(placed, 5, tip_x, tip_y, tip, 1.0, 0.0)
    if robot[JOINTS] == 4.0:
        c4, s4 = math.cos(q[3]), math.sin(q[3])
        c2, s2 = c4 * c2 - s4 * s2, s4 * c2 + c4 * s2
    put_upright(placed, 6, tip_x, tip_y, tip, c2, s2)


@kernel("void(float64[::1], float64[:, ::1], int64, float64, float64, float64, float64, float64)")
def _put_tilted(
    robot: FloatArray, placed: FloatArray, k: int, c: float, s: float, rho: float, h: float, psi: float
) -> None:
    """Carrier k is at ζ = rho + i h of the vertical plane with heading (c, s), its x axis psi above the horizontal."""
    up, ahead = math.sin(psi), math.cos(psi)
    row = placed[k]
    row[0], row[1] = robot[BASE_X] + rho * c, robot[BASE_Y] + rho * s
    row[2] = robot[BASE_Z] + robot[HEIGHT] + h
    row[3], row[4], row[5] = ahead * c, -s, -up * c
    row[6], row[7], row[8] = ahead * s, c, -up * s
    row[9], row[10], row[11] = up, 0.0 * up, ahead


@kernel("void(float64[::1], float64[::1], float64[:, ::1])")
def _place_tilting(robot: FloatArray, q: FloatArray, placed: FloatArray) -> None:
    """K31; the five-axis arm's roll H4."""
    phi = q[0] + robot[BASE_YAW]
    c, s = math.cos(phi), math.sin(phi)
    x, y, z = robot[BASE_X], robot[BASE_Y], robot[BASE_Z]
    put_upright(placed, 0, x, y, z, robot[BASE_COS], robot[BASE_SIN])
    put_upright(placed, 1, x, y, z + robot[HEIGHT], c, s)
    psi = q[1]
    _put_tilted(robot, placed, 2, c, s, 0.0, 0.0, psi)
    if robot[KIND] == POLAR:
        for k in range(3, 5):
            _put_tilted(robot, placed, k, c, s, q[2] * math.cos(psi), q[2] * math.sin(psi), psi)
        return
    rho, h = robot[L1] * math.cos(psi), robot[L1] * math.sin(psi)
    psi += q[2]
    _put_tilted(robot, placed, 3, c, s, rho, h, psi)
    rho, h = rho + robot[L2] * math.cos(psi), h + robot[L2] * math.sin(psi)
    if robot[KIND] == ELBOW:
        _put_tilted(robot, placed, 4, c, s, rho, h, psi)
        return
    psi += q[3]
    _put_tilted(robot, placed, 4, c, s, rho, h, psi)
    _put_tilted(robot, placed, 5, c, s, rho + robot[L3] * math.cos(psi), h + robot[L3] * math.sin(psi), psi)
    c, s = math.cos(q[4]), math.sin(q[4])
    flange = placed[5]
    for row in range(3):
        across, up = flange[4 + 3 * row], flange[5 + 3 * row]
        flange[4 + 3 * row], flange[5 + 3 * row] = c * across + s * up, c * up - s * across


@kernel("void(float64[::1], float64[::1], float64[:, ::1])")
def place_links(robot: FloatArray, q: FloatArray, placed: FloatArray) -> None:
    """Fills the first rows of `placed` with the links for joints `q`; NaN where the arm does not assemble."""
    if robot[KIND] == SCARA:
        _place_scara(robot, q, placed)
    elif robot[KIND] == FIVE_BAR:
        _place_five_bar(robot, q, placed)
    else:
        _place_tilting(robot, q, placed)


@kernel("UniTuple(float64, 2)(float64[::1], float64[::1], float64[::1])")
def loop_least(robot: FloatArray, lower: FloatArray, upper: FloatArray) -> tuple[float, float]:
    """Lower bound of |D| (K39) and upper bound of |u·w| of a five-bar, m², while its cranks are in a range (K37, K38).

    NaN where it is not proved that the loop assembles throughout, or something given is not finite.
    """
    d, al, bl, ar, br = robot[HEIGHT], robot[L1], robot[L2], robot[L3], robot[L4]
    for i in range(2):
        if not (math.isfinite(lower[i]) and math.isfinite(upper[i]) and lower[i] <= upper[i]):
            return math.nan, math.nan
    r1, r5 = (upper[0] - lower[0]) / 2.0, (upper[1] - lower[1]) / 2.0
    theta1, theta5 = lower[0] + r1, lower[1] + r5
    sine, cosine = math.sin(theta5 - theta1), math.cos(theta5 - theta1)
    square = d * d + al * al + ar * ar - 2.0 * al * ar * cosine
    square += 2.0 * d * (al * math.sin(theta1) - ar * math.sin(theta5))
    g1 = abs(2.0 * al * d * math.cos(theta1) - 2.0 * al * ar * sine)
    g5 = abs(2.0 * ar * d * math.cos(theta5) - 2.0 * al * ar * sine)
    off = g1 * r1 + g5 * r5 + d * (al * r1 * r1 + ar * r5 * r5) + al * ar * (r1 + r5) * (r1 + r5)
    total = d + al + ar + bl + br
    off += LOOP_ROUNDING * total * total
    low, high = square - off, square + off
    outer, inner = (bl + br) * (bl + br), (bl - br) * (bl - br)
    if not (low > inner and high < outer):
        return math.nan, math.nan
    # (outer − x)(x − inner) is concave in x: it is least at an end of its range
    product = min((outer - low) * (low - inner), (outer - high) * (high - inner))
    middle = bl * bl + br * br
    cross = 0.5 * math.sqrt(product) * (1.0 - LOOP_ROUNDING)
    return cross, 0.5 * max(abs(low - middle), abs(high - middle))


@kernel("boolean(float64[::1], float64[::1], float64[::1])")
def assembled(robot: FloatArray, lower: FloatArray, upper: FloatArray) -> bool:
    """Whether the arm is proved to assemble for lower <= q <= upper, with its least parallel margin; True without a
    loop. A trajectory that keeps this never changes its assembly mode."""
    if robot[KIND] != FIVE_BAR:
        return True
    least: float = robot[PARALLEL_LEAST] * robot[L2] * robot[L4]
    return loop_least(robot, lower, upper)[0] >= least


@kernel("UniTuple(float64, 4)(float64[::1], float64[::1], float64[::1], float64[::1], float64[::1])")
def _passive(
    robot: FloatArray, lower: FloatArray, upper: FloatArray, rate: FloatArray, rate_d: FloatArray
) -> tuple[float, float, float, float]:
    """Upper bounds of |φ̇| and |φ̈| of the left, then of the right coupler of a five-bar (K40, K41); inf if the loop is
    not proved to assemble."""
    cross, along = loop_least(robot, lower, upper)
    if not cross > 0.0:
        return math.inf, math.inf, math.inf, math.inf
    al, bl, ar, br = robot[L1], robot[L2], robot[L3], robot[L4]
    speed = al * rate[0] + ar * rate[1]
    push = al * math.hypot(rate_d[0], rate[0] * rate[0]) + ar * math.hypot(rate_d[1], rate[1] * rate[1])
    left, right = br * speed / cross, bl * speed / cross
    left_d = (br * push + along * left * left + br * br * right * right) / cross
    right_d = (bl * push + bl * bl * left * left + along * right * right) / cross
    return left, left_d, right, right_d


@kernel("void(float64[:, ::1], int64, float64, float64, float64, float64)")
def _turns(bounds: FloatArray, k: int, flat: float, flat_d: float, turn: float, turn_d: float) -> None:
    """Carrier k is upright, its origin moves horizontally by `flat` and `flat_d` at most, and it turns (K13, K14)."""
    bounds[k, V_FLAT], bounds[k, ACCELERATION + V_FLAT] = flat, flat_d
    bounds[k, V_REACH], bounds[k, ACCELERATION + V_REACH] = turn, turn_d


@kernel("void(float64[:, ::1], int64, float64[::1], float64[::1])")
def _lifts(bounds: FloatArray, k: int, rate: FloatArray, rate_d: FloatArray) -> None:
    """Carrier k moves with the lift, number 2 of the rates."""
    bounds[k, V_BOX + 2], bounds[k, ACCELERATION + V_BOX + 2] = rate[2], rate_d[2]


@kernel("void(float64[::1], float64[::1], float64[::1], float64[:, ::1])")
def _bound_scara(robot: FloatArray, rate: FloatArray, rate_d: FloatArray, bounds: FloatArray) -> None:
    """K13, K14: a point is l1 e(φ1) + l2 e(φ2) + r e(φ4 + const) + z ẑ, as far as its link is beyond the arms."""
    l1, l2 = robot[L1], robot[L2]
    m1 = math.hypot(rate_d[0], rate[0] * rate[0])
    m2 = math.hypot(rate_d[1], rate[1] * rate[1])
    m4 = math.hypot(rate_d[3], rate[3] * rate[3])
    tip, tip_d = l1 * rate[0] + l2 * rate[1], l1 * m1 + l2 * m2
    _turns(bounds, 1, 0.0, 0.0, rate[0], m1)
    _turns(bounds, 2, l1 * rate[0], l1 * m1, rate[1], m2)
    _turns(bounds, 3, tip, tip_d, 0.0, 0.0)
    _turns(bounds, 4, tip, tip_d, rate[3], m4)
    for k in range(1 if robot[RISES] == 1.0 else 3, 5):
        _lifts(bounds, k, rate, rate_d)


@kernel("void(float64[::1], float64[::1], float64[::1], float64[::1], float64[::1], float64[:, ::1])")
def _bound_five_bar(
    robot: FloatArray, lower: FloatArray, upper: FloatArray, rate: FloatArray, rate_d: FloatArray, bounds: FloatArray
) -> None:
    """K42: the tool axis is reached over the left and over the right elbow; the lesser bound of the two holds."""
    left, left_d, right, right_d = _passive(robot, lower, upper, rate, rate_d)
    m1 = math.hypot(rate_d[0], rate[0] * rate[0])
    m5 = math.hypot(rate_d[1], rate[1] * rate[1])
    m2, m3 = math.hypot(left_d, left * left), math.hypot(right_d, right * right)
    wrist = left + rate[3]
    wrist_d = math.hypot(left_d + rate_d[3], wrist * wrist)
    over_left, over_left_d = robot[L1] * rate[0], robot[L1] * m1
    over_right, over_right_d = robot[L3] * rate[1], robot[L3] * m5
    tip = min(over_left + robot[L2] * left, over_right + robot[L4] * right)
    tip_d = min(over_left_d + robot[L2] * m2, over_right_d + robot[L4] * m3)
    _turns(bounds, 1, 0.0, 0.0, rate[0], m1)
    _turns(bounds, 2, over_left, over_left_d, left, m2)
    _turns(bounds, 3, 0.0, 0.0, rate[1], m5)
    _turns(bounds, 4, over_right, over_right_d, right, m3)
    _turns(bounds, 5, tip, tip_d, 0.0, 0.0)
    _turns(bounds, 6, tip, tip_d, wrist, wrist_d)
    for k in range(5, 7):
        _lifts(bounds, k, rate, rate_d)


@kernel("void(float64[:, ::1], int64, float64, float64, UniTuple(float64, 6))")
def _swings(
    bounds: FloatArray, k: int, w: float, dw: float, plane: tuple[float, float, float, float, float, float]
) -> None:
    """Carrier k moves in a vertical plane that turns by w and dw about the base axis (K28, K29).

    `plane`: bounds of the speed of its points in the plane, of their acceleration, and of their distance from the base
    axis, each as a pair: at the carrier's origin, and how it grows with the distance from there.
    """
    v0, v1, a0, a1, far0, far1 = plane
    m = math.hypot(dw, w * w)
    bounds[k, V_ANY], bounds[k, V_ANY_FAR] = v0, v1
    bounds[k, V_FLAT], bounds[k, V_FAR] = far0 * w, far1 * w
    bounds[k, ACCELERATION + V_ANY], bounds[k, ACCELERATION + V_ANY_FAR] = a0, a1
    bounds[k, ACCELERATION + V_FLAT] = far0 * m + 2.0 * v0 * w
    bounds[k, ACCELERATION + V_FAR] = far1 * m + 2.0 * v1 * w


@kernel("void(float64[::1], float64[::1], float64[::1], float64[:, ::1])")
def _bound_tilting(robot: FloatArray, rate: FloatArray, rate_d: FloatArray, bounds: FloatArray) -> None:
    """K28, K29, with the motion in the plane of the elbow, the polar (K20, K21) or the five-axis arm (H6, H7)."""
    w, dw, w2 = rate[0], rate_d[0], rate[1]
    m2 = math.hypot(rate_d[1], w2 * w2)
    _turns(bounds, 1, 0.0, 0.0, w, math.hypot(dw, w * w))
    _swings(bounds, 2, w, dw, (0.0, w2, 0.0, m2, 0.0, 1.0))
    if robot[KIND] == POLAR:
        far = BEYOND * robot[LONGEST]
        v0, a0 = far * w2 + rate[2], far * m2 + rate_d[2] + 2.0 * rate[2] * w2
        for k in range(3, 5):
            _swings(bounds, k, w, dw, (v0, w2, a0, m2, far, 1.0))
        return
    w3 = rate[2]
    m3 = math.hypot(rate_d[2], w3 * w3)
    far, v0, a0 = robot[L1], robot[L1] * w2, robot[L1] * m2
    _swings(bounds, 3, w, dw, (v0, w3, a0, m3, far, 1.0))
    far, v0, a0 = far + robot[L2], v0 + robot[L2] * w3, a0 + robot[L2] * m3
    if robot[KIND] == ELBOW:
        _swings(bounds, 4, w, dw, (v0, w3, a0, m3, far, 1.0))
        return
    w4, w5 = rate[3], rate[4]
    m4, m5 = math.hypot(rate_d[3], w4 * w4), math.hypot(rate_d[4], w5 * w5)
    _swings(bounds, 4, w, dw, (v0, w4, a0, m4, far, 1.0))
    far, v0, a0 = far + robot[L3], v0 + robot[L3] * w4, a0 + robot[L3] * m4
    _swings(bounds, 5, w, dw, (v0, math.hypot(w4, w5), a0, m4 + m5 + 2.0 * w4 * w5, far, 1.0))


@kernel("void(float64[::1], float64[::1], float64[::1], float64[::1], float64[::1], float64[:, ::1])")
def bound_links(
    robot: FloatArray, lower: FloatArray, upper: FloatArray, rate: FloatArray, rate_d: FloatArray, bounds: FloatArray
) -> None:
    """Fills the first rows of `bounds` with the links while joints are in `lower, upper` (n,), and |C q̇|, |C q̈| are
    at most `rate, rate_d` (m,), C being the robot's rate matrix. Infinite, in every direction, for what is not finite.
    """
    links = int(robot[LINKS])
    total = 0.0
    for j in range(len(rate)):
        total += rate[j] + rate_d[j]
    fill_rows(bounds, 0, links, 0.0)
    if not math.isfinite(total):
        for k in range(links):
            bounds[k, V_ANY] = bounds[k, ACCELERATION + V_ANY] = math.inf
    elif robot[KIND] == SCARA:
        _bound_scara(robot, rate, rate_d, bounds)
    elif robot[KIND] == FIVE_BAR:
        _bound_five_bar(robot, lower, upper, rate, rate_d, bounds)
    else:
        _bound_tilting(robot, rate, rate_d, bounds)


@kernel("void(float64[::1], float64[:, ::1], float64[:, :, ::1])")
def places_of_links(robot: FloatArray, q: FloatArray, placed: FloatArray) -> None:
    """`place_links` for each row of q (N, n), into `placed` (N, L, 12)."""
    for i in range(len(q)):
        place_links(robot, q[i], placed[i])


@kernel("void(float64[::1], float64[:, ::1], float64[:, ::1], boolean[::1])")
def ranges_assembled(robot: FloatArray, lower: FloatArray, upper: FloatArray, proved: BoolArray) -> None:
    """`assembled` for each of the ranges `lower, upper` (N, n), into `proved` (N,)."""
    for i in range(len(lower)):
        proved[i] = assembled(robot, lower[i], upper[i])
