"""Where the frames of a cell are, and bounds of their motion: a law is a row of numbers, chosen by an integer.

What is more than a row stands in a side table, `pieces`: pieces of ramps and keyframes a row each, and a neighbour's
trajectory as one run of numbers (`trajectory_of`). Equations F1 to F6, F8 and F9 of docs/kinematics.md, P1 and P2.

Columns of bounds and of places are those of `links`.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.dyads import fill, fill_rows
from assur.planner.kernels.links import (
    ACCELERATION,
    BOUND_COLUMNS,
    JOINTS,
    LINKS,
    POSE_COLUMNS,
    ROBOT_COLUMNS,
    V_ANY,
    V_BOX,
    V_REACH,
    V,
    bound_links,
    place_links,
    put_upright,
)
from assur.planner.kernels.spline import spline_state, sweep_bounds

FIXED, LINEAR, TRAVEL, TURN, KEYFRAMES, NEIGHBOUR = range(6)
"""Kinds of laws. `TRAVEL` is along a line, `TURN` in place about the frame's z axis; both are driven by one scalar
function of time."""
RAMPS, INDEX, SWING = range(3)
"""Kinds of such functions: pieces of cubics, steps that repeat, a sine."""

KIND = 0
FIRST, LAST = 1, 2
"""Times between which the law is known, s. Nothing is extrapolated."""
X, Y, Z, YAW, COS, SIN = range(3, 9)
"""The law's pose, m and rad, with the cosine and the sine of its yaw."""
AT = 9
"""LINEAR, and a rise: when the frame is at its pose, s. KEYFRAMES that repeat: when a period begins."""
VX, VY, VZ = 10, 11, 12
"""LINEAR: velocity, m/s. TRAVEL: unit vector of its direction. TURN: VZ is the rise, m/s."""
REPEAT_S = 10
"""KEYFRAMES: their period, s; 0: they do not repeat."""
DRIVE = 13
"""TRAVEL and TURN: which function."""
BEGIN, COUNT = 14, 15
"""RAMPS, KEYFRAMES: first row and number of pieces. NEIGHBOUR: first row of its run, number of pieces."""
SLACK = 16
"""RAMPS: added to bounds of speed and acceleration (2). KEYFRAMES: the same, then of yaw rate and acceleration (4)."""
STEP, MOVE_S, PERIOD_S, START = 14, 15, 16, 17
"""INDEX: step in m or rad, how long it lasts, from one to the next, when one begins, s."""
AMPLITUDE, OMEGA, PHASE = 14, 15, 16
"""SWING: amplitude, m or rad; angular frequency, rad/s; phase, rad."""
LINK, RATES = 16, 17
"""NEIGHBOUR: number of the link, number of rows of its robot's rate matrix."""
LAW_COLUMNS = 20

PIECE_COLUMNS = 17
"""A piece of ramps: when it begins (the first: its anchor), c0 to c3. Of keyframes: when it begins (of those that
repeat: in their period), then c0 to c3 of x, then of y, z and yaw; a last row has the end."""

LENGTH_ROUNDING = 1e-15
"""|n·v| is raised by this part of |v|: rounding of a product of three terms, where it almost vanishes."""
PEAK_ROUNDING = 1e-13
"""Bounds of a step are raised by this part of its greatest: the rounding of a polynomial is some 1e-15."""
CYCLE_ROUNDING = 4.0 * 2.0**-52
"""Intervals are widened by this part of the times that they were reduced from, and of the period: the rounding of t
modulo the period."""
PHASE_ROUNDING = 8.0 * 2.0**-52
"""|cos| and |sin| are raised by this part of 1 + their argument: the rounding of the phase."""
EARLY, LATE = 0.5 - 0.5 / math.sqrt(5.0), 0.5 + 0.5 / math.sqrt(5.0)
"""Where in a step |acceleration| is greatest, of its duration (F3)."""


@kernel("int64(float64[:, ::1], int64, int64, float64)")
def last_begun(pieces: FloatArray, begin: int, count: int, t: float) -> int:
    """The last of `count` rows from `begin` on that has begun at `t`; the first one if none has."""
    low, high = begin, begin + count - 1
    while low < high:
        middle = (low + high + 1) // 2
        if pieces[middle, 0] <= t:
            low = middle
        else:
            high = middle - 1
    return low


@kernel("UniTuple(float64, 2)(float64, float64, float64)")
def _reduced(t: float, start: float, period: float) -> tuple[float, float]:
    """Number of whole periods since `start`, and the time since the last of them began."""
    since = t - start
    whole = float(math.floor(since / period))
    return whole, since - whole * period


@kernel("UniTuple(float64, 2)(float64, float64, float64, float64)")
def _cycle(t0: float, t1: float, start: float, period: float) -> tuple[float, float]:
    """[t0, t1] by the times since a period began, never narrower; the end is up to a period behind the begin (F9)."""
    slack = CYCLE_ROUNDING * (max(abs(t0), abs(t1)) + abs(start) + period)
    begin = _reduced(t0, start, period)[1]
    # an interval longer than a period sees all that a whole one shows
    return begin - slack, begin + min(t1 - t0, period) + slack


@kernel("UniTuple(float64, 4)(float64[::1], float64[:, ::1], float64)")
def drive_state(law: FloatArray, pieces: FloatArray, t: float) -> tuple[float, float, float, float]:
    """What drives TRAVEL or TURN, m or rad, and its first three derivatives at time t: F1, F3, F4, P1."""
    kind = law[DRIVE]
    if kind == RAMPS:
        i = last_begun(pieces, int(law[BEGIN]), int(law[COUNT]), t)
        u = t - pieces[i, 0]
        c1, c2, c3 = pieces[i, 2], pieces[i, 3], pieces[i, 4]
        x = pieces[i, 1] + u * (c1 + u * (c2 + u * c3))
        return x, c1 + u * (2.0 * c2 + u * 3.0 * c3), 2.0 * c2 + u * 6.0 * c3, 6.0 * c3
    if kind == INDEX:
        step, move = law[STEP], law[MOVE_S]
        turns, since = _reduced(t, law[START], law[PERIOD_S])
        u = since / move
        if u >= 1.0:
            return (turns + 1.0) * step, 0.0, 0.0, 0.0
        u = max(u, 0.0)
        x = turns * step + step * u**4 * (35.0 + u * (-84.0 + u * (70.0 - u * 20.0)))
        both = u * (1.0 - u)
        xd = step * 140.0 * both**3 / move
        xdd = step * 420.0 * both * both * (1.0 - 2.0 * u) / (move * move)
        return x, xd, xdd, step * 840.0 * both * (1.0 - 5.0 * both) / (move * move * move)
    w = law[OMEGA]
    theta = w * t + law[PHASE]
    sine, cosine = law[AMPLITUDE] * math.sin(theta), law[AMPLITUDE] * math.cos(theta)
    return sine, w * cosine, -w * w * sine, -w * w * w * cosine


@kernel("UniTuple(float64, 2)(float64, float64, float64, float64, float64)")
def _greatest(c1: float, c2: float, c3: float, low: float, high: float) -> tuple[float, float]:
    """The greatest |c1 + 2 c2 τ + 3 c3 τ²| and |2 c2 + 6 c3 τ| over [low, high] (P2): the first has an extremum at
    τ = −c2/(3 c3) as well as at the ends, the second at the ends only."""
    speed = max(abs(c1 + low * (2.0 * c2 + 3.0 * low * c3)), abs(c1 + high * (2.0 * c2 + 3.0 * high * c3)))
    if c3 != 0.0:
        top = min(max(-c2 / (3.0 * c3), low), high)
        speed = max(speed, abs(c1 + top * (2.0 * c2 + 3.0 * top * c3)))
    return speed, max(abs(2.0 * c2 + 6.0 * c3 * low), abs(2.0 * c2 + 6.0 * c3 * high))


@kernel("float64(float64, float64)")
def _crest(theta0: float, theta1: float) -> float:
    """The greatest |cos θ| over [θ0, θ1], never below: 1 if a multiple of π lies within, and else at an end."""
    slack = PHASE_ROUNDING * (1.0 + max(abs(theta0), abs(theta1)))
    if math.floor(theta1 / math.pi) >= math.ceil(theta0 / math.pi):
        return 1.0 + slack
    return max(abs(math.cos(theta0)), abs(math.cos(theta1))) + slack


@kernel("UniTuple(float64, 2)(float64[::1], float64[:, ::1], float64, float64)")
def drive_bounds(law: FloatArray, pieces: FloatArray, t0: float, t1: float) -> tuple[float, float]:
    """The greatest |ẋ| and |ẍ| over the closed interval [t0, t1] of what drives TRAVEL or TURN, never below.

    Where ẍ jumps, the greater of both sides counts.
    """
    kind = law[DRIVE]
    speed = acceleration = 0.0
    if kind == RAMPS:
        begin, count = int(law[BEGIN]), int(law[COUNT])
        i = last_begun(pieces, begin, count, t0)
        if i > begin and pieces[i, 0] == t0:
            i -= 1  # what ends at t0 belongs to the closed interval
        while i < begin + count and (i == begin or pieces[i, 0] <= t1):
            # the first piece has begun long ago; the others follow each other
            low = t0 if i == begin else max(t0, pieces[i, 0])
            high = t1 if i == begin + count - 1 else min(t1, pieces[i + 1, 0])
            found = _greatest(pieces[i, 2], pieces[i, 3], pieces[i, 4], low - pieces[i, 0], high - pieces[i, 0])
            speed, acceleration = max(speed, found[0]), max(acceleration, found[1])
            i += 1
        return speed + law[SLACK], acceleration + law[SLACK + 1]
    if kind == INDEX:
        move, period = law[MOVE_S], law[PERIOD_S]
        begin_s, end_s = _cycle(t0, t1, law[START], period)
        for k in range(2):
            low, high = max(begin_s - k * period, 0.0) / move, min(end_s - k * period, move) / move
            if low <= high:
                middle = min(max(0.5, low), high)
                speed = max(speed, (middle * (1.0 - middle)) ** 3)
                for corner in (low, high, min(max(EARLY, low), high), min(max(LATE, low), high)):
                    both = corner * (1.0 - corner)
                    acceleration = max(acceleration, both * both * abs(1.0 - 2.0 * corner))
        size, size_d = abs(law[STEP]) * 140.0 / move, abs(law[STEP]) * 420.0 / (move * move)
        return size * (speed + PEAK_ROUNDING / 64.0), size_d * (acceleration + PEAK_ROUNDING / 50.0)
    w = law[OMEGA]
    theta0, theta1 = w * t0 + law[PHASE], w * t1 + law[PHASE]
    rate, turn = abs(law[AMPLITUDE]) * w, math.pi / 2.0
    return rate * _crest(theta0, theta1), rate * w * _crest(theta0 - turn, theta1 - turn)


@kernel("UniTuple(int64, 8)(float64[::1], float64[:, ::1])")
def trajectory_of(law: FloatArray, pieces: FloatArray) -> tuple[int, int, int, int, int, int, int, int]:
    """Where in the side table, read as one run of numbers, the parts of a NEIGHBOUR begin, and their sizes.

    Robot row, rate matrix (m, n), times of the knots (P + 1), coefficients (P, n, 6), `whole` of `piece_bounds`
    (P + 1, 2k); then P, n, m.
    """
    robot = int(law[BEGIN]) * pieces.shape[1]
    count, m, n = int(law[COUNT]), int(law[RATES]), int(pieces[int(law[BEGIN]), JOINTS])
    matrix = robot + ROBOT_COLUMNS
    times = matrix + m * n
    coefficients = times + count + 1
    return robot, matrix, times, coefficients, coefficients + count * n * 6, count, n, m


@kernel("void(float64[::1], float64[:, ::1], float64, float64[:, ::1], int64)", allocates=True)
def _place_neighbour(law: FloatArray, pieces: FloatArray, t: float, placed: FloatArray, k: int) -> None:
    """F6: the link where the neighbour's spline has it."""
    robot, matrix, times, coefficients, whole, count, n, _ = trajectory_of(law, pieces)
    run = pieces.reshape(pieces.size)
    row = run[robot:matrix]
    links = int(row[LINKS])
    scratch = np.empty(n + links * POSE_COLUMNS)
    q, found = scratch[:n], scratch[n:].reshape((links, POSE_COLUMNS))
    spline_state(run[times:coefficients], run[coefficients:whole].reshape((count, n, 6)), t, q)
    place_links(row, q, found)
    link = int(law[LINK])
    for i in range(POSE_COLUMNS):
        placed[k, i] = found[link, i]


@kernel("void(float64[::1], float64[:, ::1], float64, float64[:, ::1], int64)")
def place_frame(law: FloatArray, pieces: FloatArray, t: float, placed: FloatArray, k: int) -> None:
    """Fills row k of `placed` with the frame of a law at time t; NaN where the law is not known, and for NaN."""
    if not law[FIRST] <= t <= law[LAST]:
        fill_rows(placed, k, k + 1, math.nan)
        return
    kind = law[KIND]
    x, y, z, c, s = law[X], law[Y], law[Z], law[COS], law[SIN]
    if kind == LINEAR:
        since = t - law[AT]
        x, y, z = x + since * law[VX], y + since * law[VY], z + since * law[VZ]
    elif kind == TRAVEL:
        way = drive_state(law, pieces, t)[0]
        x, y, z = x + way * law[VX], y + way * law[VY], z + way * law[VZ]
    elif kind == TURN:
        yaw = law[YAW] + drive_state(law, pieces, t)[0]
        z, c, s = z + law[VZ] * (t - law[AT]), math.cos(yaw), math.sin(yaw)
    elif kind == KEYFRAMES:
        if law[REPEAT_S] > 0.0:
            t = _reduced(t, law[AT], law[REPEAT_S])[1]  # the yaw goes on by whole turns, which place nothing
        i = last_begun(pieces, int(law[BEGIN]), int(law[COUNT]), t)
        u, row = t - pieces[i, 0], pieces[i]
        x = row[1] + u * (row[2] + u * (row[3] + u * row[4]))
        y = row[5] + u * (row[6] + u * (row[7] + u * row[8]))
        z = row[9] + u * (row[10] + u * (row[11] + u * row[12]))
        yaw = row[13] + u * (row[14] + u * (row[15] + u * row[16]))
        c, s = math.cos(yaw), math.sin(yaw)
    elif kind == NEIGHBOUR:
        _place_neighbour(law, pieces, t, placed, k)
        return
    put_upright(placed, k, x, y, z, c, s)


@kernel("void(float64[::1], float64[:, ::1], float64, float64, float64[:, ::1], int64)")
def _bound_keyframes(law: FloatArray, pieces: FloatArray, t0: float, t1: float, bounds: FloatArray, k: int) -> None:
    """F5, F9: the ranges of each coordinate's velocity and acceleration, exact, as a box around a middle (K44)."""
    begin, count, period = int(law[BEGIN]), int(law[COUNT]), law[REPEAT_S]
    first_s, last_s, before, after = pieces[begin, 0], pieces[begin + count, 0], 0, 0
    if period > 0.0:
        t0, t1 = _cycle(t0, t1, law[AT], period)
        before, after = -1, 1
    for axis in range(4):
        low = low_d = math.inf
        high = high_d = -math.inf
        for copy in range(before, after + 1):
            # what of the interval is in this period
            s0, s1 = max(t0 - copy * period, first_s), min(t1 - copy * period, last_s)
            i = last_begun(pieces, begin, count, s0) if s0 <= s1 else begin + count
            while i < begin + count and (pieces[i, 0] < s1 or pieces[i, 0] <= s0):
                c1, c2, c3 = pieces[i, 2 + 4 * axis], pieces[i, 3 + 4 * axis], pieces[i, 4 + 4 * axis]
                u0, u1 = max(s0, pieces[i, 0]) - pieces[i, 0], min(s1, pieces[i + 1, 0]) - pieces[i, 0]
                top = u0
                if c3 != 0.0:
                    top = min(max(-c2 / (3.0 * c3), u0), u1)
                for u in (u0, u1, top):
                    v, a = c1 + u * (2.0 * c2 + 3.0 * u * c3), 2.0 * c2 + 6.0 * c3 * u
                    low, high = min(low, v), max(high, v)
                    low_d, high_d = min(low_d, a), max(high_d, a)
                i += 1
        if axis < 3:
            bounds[k, V + axis], bounds[k, V_BOX + axis] = (low + high) / 2.0, (high - low) / 2.0
            bounds[k, ACCELERATION + V + axis] = (low_d + high_d) / 2.0
            bounds[k, ACCELERATION + V_BOX + axis] = (high_d - low_d) / 2.0
        else:
            w, dw = max(abs(low), abs(high)) + law[SLACK + 2], max(abs(low_d), abs(high_d)) + law[SLACK + 3]
            bounds[k, V_REACH], bounds[k, ACCELERATION + V_REACH] = w, math.hypot(dw, w * w)
    bounds[k, V_ANY], bounds[k, ACCELERATION + V_ANY] = law[SLACK], law[SLACK + 1]


@kernel("void(float64[::1], float64[:, ::1], float64, float64, float64[:, ::1], int64)", allocates=True)
def _bound_neighbour(law: FloatArray, pieces: FloatArray, t0: float, t1: float, bounds: FloatArray, k: int) -> None:
    """F6: what is known of the link of that arm holds for the frame, which is the link's."""
    robot, matrix, times, coefficients, whole, count, n, m = trajectory_of(law, pieces)
    run = pieces.reshape(pieces.size)
    row = run[robot:matrix]
    links = int(row[LINKS])
    scratch = np.empty(2 * n + 2 * m + links * BOUND_COLUMNS)
    lower, upper, rate = scratch[:n], scratch[n : 2 * n], scratch[2 * n : 2 * n + m]
    rate_d = scratch[2 * n + m : 2 * n + 2 * m]
    found = scratch[2 * n + 2 * m :].reshape((links, BOUND_COLUMNS))
    sweep_bounds(
        run[times:coefficients],
        run[coefficients:whole].reshape((count, n, 6)),
        run[whole : whole + (count + 1) * 4 * (m + n)].reshape((count + 1, 4 * (m + n))),
        run[matrix:times].reshape((m, n)),
        t0,
        t1,
        lower,
        upper,
        rate,
        rate_d,
    )
    bound_links(row, lower, upper, rate, rate_d, found)
    link = int(law[LINK])
    for i in range(BOUND_COLUMNS):
        bounds[k, i] = found[link, i]


@kernel("void(float64[::1], float64[:, ::1], float64, float64, float64[:, ::1], int64)")
def bound_frame(law: FloatArray, pieces: FloatArray, t0: float, t1: float, bounds: FloatArray, k: int) -> None:
    """Fills row k of `bounds` with the frame of a law over the closed interval [t0, t1].

    Infinite in every direction for an interval that is not wholly known, ends before it begins, or is not a number.
    """
    row = bounds[k]
    fill(row, 0.0)
    if not (law[FIRST] <= t0 <= t1 <= law[LAST]):
        row[V_ANY] = row[ACCELERATION + V_ANY] = math.inf
        return
    kind = law[KIND]
    if kind == LINEAR:
        row[V], row[V + 1], row[V + 2] = law[VX], law[VY], law[VZ]
        row[V_ANY] = LENGTH_ROUNDING * math.sqrt(law[VX] * law[VX] + law[VY] * law[VY] + law[VZ] * law[VZ])
    elif kind == TRAVEL:
        speed, acceleration = drive_bounds(law, pieces, t0, t1)
        for i in range(3):
            row[V + i], row[ACCELERATION + V + i] = speed * law[VX + i], acceleration * law[VX + i]
        row[V_ANY], row[ACCELERATION + V_ANY] = LENGTH_ROUNDING * speed, LENGTH_ROUNDING * acceleration
    elif kind == TURN:
        speed, acceleration = drive_bounds(law, pieces, t0, t1)
        row[V_REACH], row[ACCELERATION + V_REACH] = speed, math.hypot(acceleration, speed * speed)
        row[V_BOX + 2] = abs(law[VZ])
    elif kind == KEYFRAMES:
        _bound_keyframes(law, pieces, t0, t1, bounds, k)
    elif kind == NEIGHBOUR:
        _bound_neighbour(law, pieces, t0, t1, bounds, k)
