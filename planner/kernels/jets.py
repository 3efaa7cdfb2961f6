"""Jets: a quantity, its rate and its second derivative over an interval of time, each as a middle and a radius.

A jet is six numbers: value, radius, rate, radius, second derivative, radius. The quantity is nowhere farther from a
middle than the radius (K43 of docs/kinematics.md). There are no cases, so that a jet costs a few products.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.claim import columns as c
from assur.planner.compiled import kernel
from assur.planner.kernels.links import (
    ANGLE,
    ANGLE_COS,
    ANGLE_COUNT,
    ANGLE_MOVES,
    ANGLE_SIN,
    ANGLES,
    APART,
    CHAIN,
    LINKS,
    LOOP,
)

Jet = tuple[float, float, float, float, float, float]
Ball = tuple[float, float]
"""A middle and a radius."""
JET, BALL = "UniTuple(float64, 6)", "UniTuple(float64, 2)"
CUBE = "float64[:, :, ::1]"

VALUE, RATE, ACCELERATION = 0, 2, 4
"""Columns of a jet: the middle of each order; its radius is in the next one."""
JET_COLUMNS = 6


@kernel(f"{JET}(float64[:, ::1], int64)")
def jet_at(rows: FloatArray, i: int) -> Jet:
    """The jet in a row."""
    return rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5]


@kernel(f"void(float64[:, ::1], int64, {JET})")
def put_jet(rows: FloatArray, i: int, jet: Jet) -> None:
    """Writes a jet to a row."""
    rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5] = jet


@kernel(f"{JET}({JET}, float64, {JET})")
def axpy(a: Jet, k: float, b: Jet) -> Jet:
    """a + k b for a number k."""
    r = abs(k)
    return a[0] + k * b[0], a[1] + r * b[1], a[2] + k * b[2], a[3] + r * b[3], a[4] + k * b[4], a[5] + r * b[5]


@kernel(f"{BALL}(float64, float64, float64, float64)")
def number_product(a: float, r: float, b: float, s: float) -> Ball:
    """All products of a number within r of a and one within s of b."""
    return a * b, abs(a) * s + r * (abs(b) + s)


@kernel(f"{JET}({JET}, {JET})")
def times(a: Jet, b: Jet) -> Jet:
    """a b, by the product rule."""
    value = number_product(a[0], a[1], b[0], b[1])
    left, right = number_product(a[2], a[3], b[0], b[1]), number_product(a[0], a[1], b[2], b[3])
    one, both, other = (
        number_product(a[4], a[5], b[0], b[1]),
        number_product(a[2], a[3], b[2], b[3]),
        number_product(a[0], a[1], b[4], b[5]),
    )
    rate = left[0] + right[0], left[1] + right[1]
    return (*value, *rate, one[0] + 2.0 * both[0] + other[0], one[1] + 2.0 * both[1] + other[1])


@kernel(f"{JET}({JET}, {BALL}, {BALL}, {BALL})")
def through(a: Jet, value: Ball, slope: Ball, bend: Ball) -> Jet:
    """f(a) by the chain rule, from all that f, f' and f'' may be over the range of a."""
    rate = number_product(slope[0], slope[1], a[2], a[3])
    least, most = max(abs(a[2]) - a[3], 0.0), abs(a[2]) + a[3]
    low, high = least * least, most * most
    square = number_product(bend[0], bend[1], 0.5 * (low + high), 0.5 * (high - low))
    pull = number_product(slope[0], slope[1], a[4], a[5])
    return (*value, *rate, square[0] + pull[0], square[1] + pull[1])


@kernel(f"Tuple(({JET}, {JET}))({JET})")
def cosine_and_sine(a: Jet) -> tuple[Jet, Jet]:
    """Cosine and sine of an angle. With d of at most r, cos d is from 1 - r²/2 to 1 and sin d from -r to r."""
    c, s, r = math.cos(a[0]), math.sin(a[0]), a[1]
    if r < 1.0:
        lost = 0.25 * r * r
        cosine = c * (1.0 - lost), abs(c) * lost + abs(s) * r
        sine = s * (1.0 - lost), abs(s) * lost + abs(c) * r
    else:
        cosine, sine = (0.0, 1.0), (0.0, 1.0)
    less_cosine, less_sine = (-cosine[0], cosine[1]), (-sine[0], sine[1])
    return through(a, cosine, less_sine, less_cosine), through(a, sine, cosine, less_sine)


@kernel(f"{BALL}(float64, float64)")
def between(one: float, other: float) -> Ball:
    """All numbers between two, whichever is less."""
    return 0.5 * (one + other), 0.5 * abs(other - one)


@kernel(f"{JET}({JET})")
def inverse(a: Jet) -> Jet:
    """1/a for what is greater than 0."""
    low, high = 1.0 / (a[0] + a[1]), 1.0 / (a[0] - a[1])
    return through(a, between(low, high), between(-low * low, -high * high), between(2.0 * low**3, 2.0 * high**3))


@kernel(f"{JET}({JET})")
def root(a: Jet) -> Jet:
    """The square root of what is greater than 0."""
    low, high = math.sqrt(a[0] - a[1]), math.sqrt(a[0] + a[1])
    return through(a, between(low, high), between(0.5 / low, 0.5 / high), between(-0.25 / low**3, -0.25 / high**3))


# How the links of an arm move over an interval: jets of any tree of links, with one loop at most.
#
# A carrier has 12 jets: the coordinates of its origin in the world, then the columns of its rotation. Angles are sums
# of joints in the world, so no rotation is multiplied by another (K43 of docs/kinematics.md).

JETS = 12
"""Jets of a carrier."""
FREER = 0.25
"""The square of the sine between the couplers of a loop is at least this part of the square of what is required, where
bounds are computed; else the interval is too long."""
LEAST_SQUARE = 1e-9
"""m²: the ends of both cranks of a loop are farther apart than the root of this."""


@kernel("void(float64[:, ::1])")
def unknown(own: FloatArray) -> None:
    """Nothing is known of a carrier with these jets."""
    own[0, 1] = math.inf


@kernel(f"void(float64[:, ::1], int64, {JET}, {JET}, {JET})")
def put_column(own: FloatArray, column: int, x: Jet, y: Jet, z: Jet) -> None:
    """Writes a column of the rotation of a carrier."""
    put_jet(own, 3 + 3 * column, x)
    put_jet(own, 4 + 3 * column, y)
    put_jet(own, 5 + 3 * column, z)


@kernel(f"void(float64[:, ::1], {JET}, {JET})")
def put_yaw(own: FloatArray, cosine: Jet, sine: Jet) -> None:
    """Writes the rotation of a carrier that is turned about the vertical."""
    none = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    put_column(own, 0, cosine, sine, none)
    put_column(own, 1, axpy(none, -1.0, sine), cosine, none)
    put_column(own, 2, none, none, (1.0, 0.0, 0.0, 0.0, 0.0, 0.0))


@kernel(f"void(float64[::1], float64[:, ::1], {CUBE})")
def _turn_angles(robot: FloatArray, joints: FloatArray, turns: FloatArray) -> None:
    """Cosine and sine of all angles of an arm, into `turns` (A, 2, JET_COLUMNS)."""
    for number in range(int(robot[ANGLE_COUNT])):
        at = int(robot[ANGLES]) + ANGLE * number
        if not robot[at + ANGLE_MOVES] > 0.0:
            put_jet(turns[number], 0, (robot[at + ANGLE_COS], 0.0, 0.0, 0.0, 0.0, 0.0))
            put_jet(turns[number], 1, (robot[at + ANGLE_SIN], 0.0, 0.0, 0.0, 0.0, 0.0))
            continue
        angle = (robot[at + c.ANGLE_CONSTANT], 0.0, 0.0, 0.0, 0.0, 0.0)
        for j in range(len(joints)):
            share = robot[at + c.ANGLE_SHARE + j]
            if share != 0.0:
                angle = axpy(angle, share, jet_at(joints, j))
        cosine, sine = cosine_and_sine(angle)
        put_jet(turns[number], 0, cosine)
        put_jet(turns[number], 1, sine)


Couplers = tuple[Jet, Jet, Jet, Jet]
"""Cosine and sine of the yaw of the first coupler of a loop, then of the second one."""


@kernel(f"Tuple((boolean, UniTuple({JET}, 4)))(float64[::1], {CUBE}, {CUBE})")
def _couplers(robot: FloatArray, turns: FloatArray, jets: FloatArray) -> tuple[bool, Couplers]:
    """The couplers of a loop (K39), and whether it is shown to stay closed.

    Of |s|² each crank occurs as seldom as possible: with d between both axes, u and v along the cranks and their
    lengths l and r, it is |d|² + l² + r² + 2 d·(r v − l u) − 2 l r cos(angle between the cranks).
    """
    own = robot[int(robot[LOOP]) :]
    one, other = jets[int(own[c.LOOP_CRANK])], jets[int(own[c.LOOP_CRANK + 1])]
    left, right, a, b = own[c.LOOP_LENGTH], own[c.LOOP_LENGTH + 1], own[c.LOOP_COUPLER], own[c.LOOP_COUPLER + 1]
    x, y, none = own[APART], own[APART + 1], (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    sx = axpy(axpy((x, 0.0, 0.0, 0.0, 0.0, 0.0), right, jet_at(other, 3)), -left, jet_at(one, 3))
    sy = axpy(axpy((y, 0.0, 0.0, 0.0, 0.0, 0.0), right, jet_at(other, 4)), -left, jet_at(one, 4))
    square = (left * left + right * right - x * x - y * y, 0.0, 0.0, 0.0, 0.0, 0.0)
    square = axpy(axpy(square, 2.0 * x, sx), 2.0 * y, sy)
    square = axpy(square, -2.0 * left * right, jet_at(turns[int(own[c.LOOP_BETWEEN])], 0))
    fold = axpy((-0.5 * (a * a + b * b) / (a * b), 0.0, 0.0, 0.0, 0.0, 0.0), 0.5 / (a * b), square)
    margin = axpy((1.0, 0.0, 0.0, 0.0, 0.0, 0.0), -1.0, times(fold, fold))
    least = own[c.LOOP_LEAST]
    if not (margin[0] - margin[1] >= FREER * least * least and square[0] - square[1] > LEAST_SQUARE):
        return False, (none, none, none, none)
    ratio = inverse(square)
    along = axpy((0.5, 0.0, 0.0, 0.0, 0.0, 0.0), 0.5 * (a * a - b * b), ratio)
    across = axpy(none, own[c.LOOP_SIDE] * a * b, times(root(margin), ratio))
    ux, uy = axpy(times(along, sx), -1.0, times(across, sy)), axpy(times(along, sy), 1.0, times(across, sx))
    wx, wy = axpy(ux, -1.0, sx), axpy(uy, -1.0, sy)
    return True, (axpy(none, 1.0 / a, ux), axpy(none, 1.0 / a, uy), axpy(none, 1.0 / b, wx), axpy(none, 1.0 / b, wy))


@kernel(f"void(float64[::1], int64, float64[:, ::1], {CUBE})")
def _put_origin(robot: FloatArray, k: int, joints: FloatArray, jets: FloatArray) -> None:
    """The origin of link k, a point of its parent that may slide along an axis of the parent."""
    at, own = CHAIN + k * c.LINK, jets[k]
    parent, slide = int(robot[at + c.LINK_PARENT]), int(robot[at + c.LINK_SLIDE])
    for axis in range(3):
        place = robot[at + c.LINK_OFFSET + axis], 0.0, 0.0, 0.0, 0.0, 0.0
        if parent >= 0:
            place = jet_at(jets[parent], axis)
            for column in range(3):
                offset = robot[at + c.LINK_OFFSET + column]
                if offset != 0.0:
                    place = axpy(place, offset, jet_at(jets[parent], 3 + 3 * column + axis))
        put_jet(own, axis, place)
    if slide < 0:
        return
    for column in range(3):
        share = robot[at + c.LINK_AXIS + column]
        if share == 0.0:
            continue
        level = parent < 0 or (column == 2 and robot[CHAIN + parent * c.LINK + c.LINK_PITCH] < 0.0)
        for axis in range(3):
            if not level:
                way = times(jet_at(joints, slide), jet_at(jets[parent], 3 + 3 * column + axis))
                put_jet(own, axis, axpy(jet_at(own, axis), share, way))
            elif axis == column:
                put_jet(own, axis, axpy(jet_at(own, axis), share, jet_at(joints, slide)))


@kernel(f"void(float64[::1], float64[:, ::1], {CUBE}, {CUBE})", entry=True)
def sweep_links(robot: FloatArray, joints: FloatArray, turns: FloatArray, jets: FloatArray) -> None:
    """Fills the first rows of `jets` (K, JETS, JET_COLUMNS) with the links, from the jets of the joints (n,
    JET_COLUMNS). Nothing is known of them if a joint is not bounded, or a loop is not shown to stay closed.

    `turns` (A, 2, JET_COLUMNS) is room to work in.
    """
    links, known = int(robot[LINKS]), True
    for j in range(len(joints)):
        for i in range(JET_COLUMNS):
            known = known and math.isfinite(joints[j, i])
    if known:
        _turn_angles(robot, joints, turns)
    closed, none = False, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    loop = (none, none, none, none)
    for k in range(links):
        at, own = CHAIN + k * c.LINK, jets[k]
        if not known:
            unknown(own)
            continue
        _put_origin(robot, k, joints, jets)
        yaw, coupler = turns[int(robot[at + c.LINK_YAW])], int(robot[at + c.LINK_COUPLER])
        cosine, sine = jet_at(yaw, 0), jet_at(yaw, 1)
        if coupler >= 0:
            if not closed:
                closed, loop = _couplers(robot, turns, jets)
                if not closed:
                    for i in range(links):
                        unknown(jets[i])
                    return
            u, v = (loop[0], loop[1]) if coupler == 0 else (loop[2], loop[3])
            turning = axpy(times(cosine, u), -1.0, times(sine, v))
            sine = axpy(times(sine, u), 1.0, times(cosine, v))
            cosine = turning
        if robot[at + c.LINK_PITCH] < 0.0:
            put_yaw(own, cosine, sine)
            continue
        pitch, roll = turns[int(robot[at + c.LINK_PITCH])], turns[int(robot[at + c.LINK_ROLL])]
        level, up = jet_at(pitch, 0), jet_at(pitch, 1)
        put_column(own, 0, times(level, cosine), times(level, sine), up)
        # without roll: to the left, and up
        left_x, left_y = axpy(none, -1.0, sine), cosine
        high_x, high_y = axpy(none, -1.0, times(up, cosine)), axpy(none, -1.0, times(up, sine))
        c_roll, s_roll = jet_at(roll, 0), jet_at(roll, 1)
        if robot[int(robot[ANGLES]) + ANGLE * int(robot[at + c.LINK_ROLL]) + ANGLE_MOVES] > 0.0:
            put_column(
                own, 1, axpy(times(c_roll, left_x), 1.0, times(s_roll, high_x)),
                axpy(times(c_roll, left_y), 1.0, times(s_roll, high_y)), times(s_roll, level),
            )  # fmt: skip
            put_column(
                own, 2, axpy(times(c_roll, high_x), -1.0, times(s_roll, left_x)),
                axpy(times(c_roll, high_y), -1.0, times(s_roll, left_y)), times(c_roll, level),
            )  # fmt: skip
        else:
            put_column(own, 1, left_x, left_y, none)
            put_column(own, 2, high_x, high_y, level)
