"""Where the links of an arm are, for any tree of links with at most one loop.

A robot is a row of numbers. Its first columns are what inverse kinematics, singularities and motions of its family
read; then come its links, the angles of these and its loop, as `assur.planner.claim.columns` has them.

Carriers are rows, links first: `placed` (L, 12) has a position, m, and a rotation matrix, row by row, in the world.
"""

from __future__ import annotations

import math

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.claim import columns as c
from assur.planner.compiled import kernel

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
LOOP = 18
"""The column in which its loop begins; 0: it has none."""
ANGLES, ANGLE_COUNT = 19, 20
"""The column in which its first angle begins, and how many there are."""
SIZE = 21
"""How many numbers the row has."""
CHAIN = 22
"""The column in which the first link begins; it has the columns of a claim."""

ANGLE_MOVES, ANGLE_COS, ANGLE_SIN, ANGLE = c.ANGLE, c.ANGLE + 1, c.ANGLE + 2, c.ANGLE + 3
"""An angle has three columns more than in a claim: 1 if a joint changes it, else 0; cosine and sine of its constant."""
APART, LOOP_COLUMNS = c.LOOP, c.LOOP + 2
"""A loop has two more: from the axis of the first crank to that of the second, m, horizontally in the world."""

POSE_COLUMNS = 12

LOOP_ROUNDING = 1e-12
"""Relative to the square of all lengths: what is added to every bound of |s|², whose terms round to some 1e-15."""


@kernel("void(float64[::1], float64, float64)")
def turn_upright(row: FloatArray, c: float, s: float) -> None:
    """Turns the carrier of a row about the vertical, by the angle with cosine c and sine s."""
    row[3], row[4], row[5] = c, -s, 0.0
    row[6], row[7], row[8] = s, c, 0.0
    row[9], row[10], row[11] = 0.0, 0.0, 1.0


@kernel("void(float64[:, ::1], int64, float64, float64, float64, float64, float64)", entry=True)
def put_upright(placed: FloatArray, k: int, x: float, y: float, z: float, c: float, s: float) -> None:
    """Carrier k is at (x, y, z), turned about the vertical by the angle with cosine c and sine s."""
    row = placed[k]
    row[0], row[1], row[2] = x, y, z
    turn_upright(row, c, s)


@kernel("UniTuple(float64, 2)(float64[::1], float64, float64[::1], float64[::1])")
def _angle(robot: FloatArray, number: float, lower: FloatArray, upper: FloatArray) -> tuple[float, float]:
    """Middle and half the width of the range of an angle, for joints in a range; the width is NaN where the range is
    none."""
    at = int(robot[ANGLES]) + ANGLE * int(number)
    middle, half = robot[at + c.ANGLE_CONSTANT], 0.0
    for j in range(len(lower)):
        share = robot[at + c.ANGLE_SHARE + j]
        if share != 0.0:
            middle += share * (0.5 * (lower[j] + upper[j]))
            half += abs(share) * (0.5 * (upper[j] - lower[j])) if lower[j] <= upper[j] else math.nan
    return middle, half


@kernel("UniTuple(float64, 2)(float64[::1], float64, float64[::1])")
def _turned(robot: FloatArray, number: float, q: FloatArray) -> tuple[float, float]:
    """Cosine and sine of an angle."""
    at = int(robot[ANGLES]) + ANGLE * int(number)
    if not robot[at + ANGLE_MOVES] > 0.0:
        return robot[at + ANGLE_COS], robot[at + ANGLE_SIN]
    angle = robot[at + c.ANGLE_CONSTANT]
    for j in range(len(q)):
        share = robot[at + c.ANGLE_SHARE + j]
        if share != 0.0:
            angle += share * q[j]
    return math.cos(angle), math.sin(angle)


@kernel("UniTuple(float64, 2)(float64[::1], float64[:, ::1], int64)")
def _coupler(robot: FloatArray, placed: FloatArray, which: int) -> tuple[float, float]:
    """Cosine and sine of the yaw of a coupler whose cranks are placed: K1, K2; NaN where they do not meet."""
    at = int(robot[LOOP])
    one, other = placed[int(robot[at + c.LOOP_CRANK])], placed[int(robot[at + c.LOOP_CRANK + 1])]
    left, right = robot[at + c.LOOP_LENGTH], robot[at + c.LOOP_LENGTH + 1]
    a, b = robot[at + c.LOOP_COUPLER], robot[at + c.LOOP_COUPLER + 1]
    x, y = (
        robot[at + APART] + right * other[3] - left * one[3],
        robot[at + APART + 1] + right * other[6] - left * one[6],
    )
    square = x * x + y * y
    product = ((a + b) * (a + b) - square) * (square - (a - b) * (a - b))
    if not (square > 0.0 and product >= 0.0):
        return math.nan, math.nan
    along, across = 0.5 + 0.5 * (a * a - b * b) / square, 0.5 * robot[at + c.LOOP_SIDE] * math.sqrt(product) / square
    ux, uy = along * x - across * y, along * y + across * x
    if which == 0:
        return ux / a, uy / a
    return (ux - x) / b, (uy - y) / b


@kernel("void(float64[::1], float64[::1], float64[:, ::1])")
def place_links(robot: FloatArray, q: FloatArray, placed: FloatArray) -> None:
    """Fills the first rows of `placed` with the links for joints `q`; NaN where the arm does not assemble."""
    cosine, sine, known = 1.0, 0.0, -1.0
    for k in range(int(robot[LINKS])):
        at, row = CHAIN + k * c.LINK, placed[k]
        parent, slide = int(robot[at + c.LINK_PARENT]), int(robot[at + c.LINK_SLIDE])
        x, y, z = robot[at + c.LINK_OFFSET], robot[at + c.LINK_OFFSET + 1], robot[at + c.LINK_OFFSET + 2]
        if slide >= 0:
            x += q[slide] * robot[at + c.LINK_AXIS]
            y += q[slide] * robot[at + c.LINK_AXIS + 1]
            z += q[slide] * robot[at + c.LINK_AXIS + 2]
        if parent < 0:
            row[0], row[1], row[2] = x, y, z
        else:
            on = placed[parent]
            for i in range(3):
                row[i] = on[i] + on[3 + 3 * i] * x + on[4 + 3 * i] * y + on[5 + 3 * i] * z
        if robot[at + c.LINK_YAW] != known:
            known = robot[at + c.LINK_YAW]
            cosine, sine = _turned(robot, known, q)
        cy, sy = cosine, sine
        coupler = int(robot[at + c.LINK_COUPLER])
        if coupler >= 0:
            u, v = _coupler(robot, placed, coupler)
            cy, sy = cy * u - sy * v, sy * u + cy * v
        if robot[at + c.LINK_PITCH] < 0.0:
            turn_upright(row, cy, sy)
            continue
        cp, sp = _turned(robot, robot[at + c.LINK_PITCH], q)
        cr, sr = _turned(robot, robot[at + c.LINK_ROLL], q)
        row[3], row[4], row[5] = cp * cy, -cr * sy - sr * sp * cy, sr * sy - cr * sp * cy
        row[6], row[7], row[8] = cp * sy, cr * cy - sr * sp * sy, -sr * cy - cr * sp * sy
        row[9], row[10], row[11] = sp, sr * cp, cr * cp


@kernel("float64(float64[::1], float64[::1], float64[::1])")
def loop_least(robot: FloatArray, lower: FloatArray, upper: FloatArray) -> float:
    """Lower bound of |D| (K39) of an arm's loop, m², for joints in a range (K37, K38).

    NaN where it is not proved that the loop assembles throughout, or something given is not finite.
    """
    at = int(robot[LOOP])
    one, other = CHAIN + c.LINK * int(robot[at + c.LOOP_CRANK]), CHAIN + c.LINK * int(robot[at + c.LOOP_CRANK + 1])
    phi, r = _angle(robot, robot[one + c.LINK_YAW], lower, upper)
    psi, t = _angle(robot, robot[other + c.LINK_YAW], lower, upper)
    if not (math.isfinite(phi + psi) and math.isfinite(r + t)):
        return math.nan
    al, ar = robot[at + c.LOOP_LENGTH], robot[at + c.LOOP_LENGTH + 1]
    bl, br = robot[at + c.LOOP_COUPLER], robot[at + c.LOOP_COUPLER + 1]
    x, y = robot[at + APART], robot[at + APART + 1]
    d, sine = math.hypot(x, y), al * ar * math.sin(psi - phi)
    square = d * d + al * al + ar * ar - 2.0 * al * ar * math.cos(psi - phi)
    square += 2.0 * ar * (x * math.cos(psi) + y * math.sin(psi)) - 2.0 * al * (x * math.cos(phi) + y * math.sin(phi))
    slope = 2.0 * abs(al * (x * math.sin(phi) - y * math.cos(phi)) - sine)
    bend = 2.0 * abs(ar * (y * math.cos(psi) - x * math.sin(psi)) + sine)
    off = slope * r + bend * t + d * (al * r * r + ar * t * t) + al * ar * (r + t) * (r + t)
    total = d + al + ar + bl + br
    off += LOOP_ROUNDING * total * total
    low, high = square - off, square + off
    outer, inner = (bl + br) * (bl + br), (bl - br) * (bl - br)
    if not (low > inner and high < outer):
        return math.nan
    # (outer − x)(x − inner) is concave in x: it is least at an end of its range
    product = min((outer - low) * (low - inner), (outer - high) * (high - inner))
    return 0.5 * math.sqrt(product) * (1.0 - LOOP_ROUNDING)


@kernel("boolean(float64[::1], float64[::1], float64[::1])")
def assembled(robot: FloatArray, lower: FloatArray, upper: FloatArray) -> bool:
    """Whether the arm is proved to assemble for lower <= q <= upper, with its least parallel margin; True without a
    loop. A trajectory that keeps this never changes its assembly mode."""
    at = int(robot[LOOP])
    if at == 0:
        return True
    least: float = robot[at + c.LOOP_LEAST] * robot[at + c.LOOP_COUPLER] * robot[at + c.LOOP_COUPLER + 1]
    return loop_least(robot, lower, upper) >= least


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
