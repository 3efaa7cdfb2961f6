"""Where the frames of a cell are, and bounds of their motion, from the tables of their laws (`columns.laws`).

No kind of law is named here. A frame that is a link of another robot has its trajectory in the side table as one run of
numbers (`trajectory_of`). Equations F0, F6 and F9 of docs/kinematics.md.

Columns of bounds and of places are those of `links`.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.columns import laws as c
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

LENGTH_ROUNDING = 2e-15
"""|n·v| is raised by this part of |v|: rounding of a product of three terms, where it almost vanishes."""
CYCLE_ROUNDING = 4.0 * 2.0**-52
"""Intervals are widened by this part of the times that they were reduced from, and of the period: the rounding of t
modulo the period."""
PHASE_ROUNDING = 8.0 * 2.0**-52
"""|cos| and |sin| are raised by this part of 1 + their argument: the rounding of the phase."""


@kernel("int64(float64[:, ::1], int64, int64, float64)")
def last_begun(pieces: FloatArray, begin: int, count: int, t: float) -> int:
    """The last of `count` rows from `begin` on that has begun at `t`; the first one if none has."""
    low, high = begin, begin + count - 1
    while low < high:
        middle = (low + high + 1) // 2
        if pieces[middle, c.PIECE_BEGIN] <= t:
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


@kernel("UniTuple(float64, 4)(float64[:, ::1], int64, int64, int64, float64)")
def _coordinate(pieces: FloatArray, i: int, k: int, powers: int, u: float) -> tuple[float, float, float, float]:
    """Coordinate k of piece i and its first three derivatives, u after the piece began (F0)."""
    at = c.POWER + k * c.MOST_POWERS
    x = v = a = j = 0.0
    for n in range(powers - 1, -1, -1):
        power = pieces[i, at + n]
        x, v = x * u + power / ((n + 1.0) * (n + 2.0)), v * u + power / (n + 1.0)
        j = j * u + a
        a = a * u + power
    rate = pieces[i, c.RATE + k]
    return pieces[i, c.POSE + k] + u * (rate + u * x), rate + u * v, a, j


@kernel("UniTuple(float64, 2)(float64[:, ::1], int64, int64, int64, float64)")
def _rates(pieces: FloatArray, i: int, k: int, powers: int, u: float) -> tuple[float, float]:
    """Velocity and acceleration of coordinate k of piece i, u after the piece began."""
    at = c.POWER + k * c.MOST_POWERS
    v = a = 0.0
    for n in range(powers - 1, -1, -1):
        power = pieces[i, at + n]
        v = v * u + power / (n + 1.0)
        a = a * u + power
    return pieces[i, c.RATE + k] + u * v, a


@kernel("Tuple((int64, float64, float64))(float64[::1], float64[:, ::1], float64)")
def _piece_at(law: FloatArray, pieces: FloatArray, t: float) -> tuple[int, float, float]:
    """The piece at time t, the time since its begin, and the number of whole periods before it."""
    whole = 0.0
    if law[c.PERIOD] > 0.0:
        whole, t = _reduced(t, law[c.START], law[c.PERIOD])
    i = last_begun(pieces, int(law[c.BEGIN]), int(law[c.COUNT]), t)
    return i, t - pieces[i, c.PIECE_BEGIN], whole


@kernel("void(float64[::1], float64[:, ::1], float64[::1], float64[:, :, ::1], float64[:, ::1])")
def frame_motions(
    law: FloatArray, pieces: FloatArray, times: FloatArray, vectors: FloatArray, angles: FloatArray
) -> None:
    """Position (T, 3) with three derivatives in `vectors` (4, T, 3), and yaw with as many in `angles` (4, T), at times
    (T,); NaN where the law is not known, and for NaN. Not of links."""
    powers, first = int(law[c.POWERS]), int(law[c.WAVE])
    for row in range(len(times)):
        t = times[row]
        if not law[c.FIRST] <= t <= law[c.LAST]:
            for n in range(4):
                angles[n, row] = vectors[n, row, 0] = vectors[n, row, 1] = vectors[n, row, 2] = math.nan
            continue
        i, u, whole = _piece_at(law, pieces, t)
        for k in range(3):
            x, v, a, j = _coordinate(pieces, i, k, powers, u)
            vectors[0, row, k] = x + whole * law[c.STEP + k]
            vectors[1, row, k], vectors[2, row, k], vectors[3, row, k] = v, a, j
        x, v, a, j = _coordinate(pieces, i, 3, powers, u)
        angles[0, row], angles[1, row], angles[2, row], angles[3, row] = x + whole * law[c.STEP + 3], v, a, j
        for wave in range(first, first + int(law[c.WAVES])):
            k, size, w = int(pieces[wave, c.WAVE_COORDINATE]), pieces[wave, c.WAVE_AMPLITUDE], pieces[wave, c.WAVE_RATE]
            theta = w * t + pieces[wave, c.WAVE_PHASE]
            sine, cosine = size * math.sin(theta), size * math.cos(theta)
            for n, value in enumerate((sine, w * cosine, -w * w * sine, -w * w * w * cosine)):
                if k < 3:
                    vectors[n, row, k] += value
                else:
                    angles[n, row] += value


@kernel("float64(float64, float64)")
def _crest(theta0: float, theta1: float) -> float:
    """The greatest |cos θ| over [θ0, θ1], never below: 1 if a multiple of π lies within, and else at an end."""
    slack = PHASE_ROUNDING * (1.0 + max(abs(theta0), abs(theta1)))
    if math.floor(theta1 / math.pi) >= math.ceil(theta0 / math.pi):
        return 1.0 + slack
    return max(abs(math.cos(theta0)), abs(math.cos(theta1))) + slack


@kernel("UniTuple(float64, 4)(float64[::1], float64[:, ::1], int64, float64, float64)")
def _ranges(law: FloatArray, pieces: FloatArray, k: int, t0: float, t1: float) -> tuple[float, float, float, float]:
    """The ranges of velocity and of acceleration of coordinate k over the closed interval [t0, t1], least and greatest
    of each. Where the acceleration jumps, both sides count."""
    begin, count, powers, period = int(law[c.BEGIN]), int(law[c.COUNT]), int(law[c.POWERS]), law[c.PERIOD]
    low = low_d = math.inf
    high = high_d = -math.inf
    s0, s1, copies = t0, t1, 0
    if period > 0.0:
        s0, s1 = _cycle(t0, t1, law[c.START], period)
        copies = 1
    for copy in range(-copies, copies + 1):
        # what of the interval is in this period
        since, until = s0 - copy * period, s1 - copy * period
        if copies > 0:
            since, until = max(since, 0.0), min(until, period)
        i = last_begun(pieces, begin, count, since) if since <= until else begin + count
        if begin < i < begin + count and pieces[i, c.PIECE_BEGIN] == since:
            i -= 1  # what ends then belongs to the closed interval
        while i < begin + count and (i == begin or pieces[i, c.PIECE_BEGIN] <= until):
            u0 = (since if i == begin else max(since, pieces[i, c.PIECE_BEGIN])) - pieces[i, c.PIECE_BEGIN]
            u1 = (until if i == begin + count - 1 else min(until, pieces[i, c.PIECE_END])) - pieces[i, c.PIECE_BEGIN]
            for corner in range(-2, c.CORNERS if powers > 0 else -1):
                u = u0 if corner == -2 else u1 if corner == -1 else pieces[i, c.CORNER + corner]
                if u0 <= u <= u1:
                    v, a = _rates(pieces, i, k, powers, u)
                    low, high, low_d, high_d = min(low, v), max(high, v), min(low_d, a), max(high_d, a)
            i += 1
    first = int(law[c.WAVE])
    for wave in range(first, first + int(law[c.WAVES])):
        if int(pieces[wave, c.WAVE_COORDINATE]) == k:
            w, phase, turn = pieces[wave, c.WAVE_RATE], pieces[wave, c.WAVE_PHASE], math.pi / 2.0
            theta0, theta1, rate = w * t0 + phase, w * t1 + phase, abs(pieces[wave, c.WAVE_AMPLITUDE]) * w
            speed, acceleration = rate * _crest(theta0, theta1), rate * w * _crest(theta0 - turn, theta1 - turn)
            low, high, low_d, high_d = low - speed, high + speed, low_d - acceleration, high_d + acceleration
    return low, high, low_d, high_d


@kernel("UniTuple(int64, 8)(float64[::1], float64[:, ::1])")
def trajectory_of(law: FloatArray, pieces: FloatArray) -> tuple[int, int, int, int, int, int, int, int]:
    """Where in the side table, read as one run of numbers, the parts of a link begin, and their sizes.

    Robot row, rate matrix (m, n), times of the knots (P + 1), coefficients (P, n, 6), `whole` of `piece_bounds`
    (P + 1, 2k); then P, n, m.
    """
    robot = int(law[c.BEGIN]) * pieces.shape[1]
    count, m, n = int(law[c.COUNT]), int(law[c.RATES]), int(pieces[int(law[c.BEGIN]), JOINTS])
    matrix = robot + ROBOT_COLUMNS
    times = matrix + m * n
    coefficients = times + count + 1
    return robot, matrix, times, coefficients, coefficients + count * n * 6, count, n, m


@kernel("void(float64[::1], float64[:, ::1], float64, float64[:, ::1], int64)", allocates=True)
def _place_link(law: FloatArray, pieces: FloatArray, t: float, placed: FloatArray, k: int) -> None:
    """F6: the link where the neighbour's spline has it."""
    robot, matrix, times, coefficients, whole, count, n, _ = trajectory_of(law, pieces)
    run = pieces.reshape(pieces.size)
    row = run[robot:matrix]
    links = int(row[LINKS])
    scratch = np.empty(n + links * POSE_COLUMNS)
    q, found = scratch[:n], scratch[n:].reshape((links, POSE_COLUMNS))
    spline_state(run[times:coefficients], run[coefficients:whole].reshape((count, n, 6)), t, q)
    place_links(row, q, found)
    link = int(law[c.LINK])
    for i in range(POSE_COLUMNS):
        placed[k, i] = found[link, i]


@kernel("void(float64[::1], float64[:, ::1], float64, float64[:, ::1], int64)")
def place_frame(law: FloatArray, pieces: FloatArray, t: float, placed: FloatArray, k: int) -> None:
    """Fills row k of `placed` with the frame of a law at time t; NaN where the law is not known, and for NaN."""
    if not law[c.FIRST] <= t <= law[c.LAST]:
        fill_rows(placed, k, k + 1, math.nan)
        return
    if law[c.LINKED] > 0.0:
        _place_link(law, pieces, t, placed, k)
        return
    i, u, whole = _piece_at(law, pieces, t)
    powers, first = int(law[c.POWERS]), int(law[c.WAVE])
    x = _coordinate(pieces, i, 0, powers, u)[0] + whole * law[c.STEP]
    y = _coordinate(pieces, i, 1, powers, u)[0] + whole * law[c.STEP + 1]
    z = _coordinate(pieces, i, 2, powers, u)[0] + whole * law[c.STEP + 2]
    yaw = 0.0
    if law[c.TURNS] > 0.0:
        yaw = _coordinate(pieces, i, 3, powers, u)[0]
        if not law[c.WHOLE] > 0.0:
            yaw += whole * law[c.STEP + 3]
    for wave in range(first, first + int(law[c.WAVES])):
        theta = pieces[wave, c.WAVE_RATE] * t + pieces[wave, c.WAVE_PHASE]
        value, coordinate = pieces[wave, c.WAVE_AMPLITUDE] * math.sin(theta), int(pieces[wave, c.WAVE_COORDINATE])
        if coordinate == 0:
            x += value
        elif coordinate == 1:
            y += value
        elif coordinate == 2:
            z += value
        else:
            yaw += value
    if law[c.TURNS] > 0.0:
        put_upright(placed, k, x, y, z, math.cos(yaw), math.sin(yaw))
    else:
        put_upright(placed, k, x, y, z, law[c.COS], law[c.SIN])


@kernel("void(float64[::1], float64[:, ::1], float64, float64, float64[:, ::1], int64)", allocates=True)
def _bound_link(law: FloatArray, pieces: FloatArray, t0: float, t1: float, bounds: FloatArray, k: int) -> None:
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
    link = int(law[c.LINK])
    for i in range(BOUND_COLUMNS):
        bounds[k, i] = found[link, i]


@kernel("void(float64[::1], float64[:, ::1], float64, float64, float64[:, ::1], int64)")
def bound_frame(law: FloatArray, pieces: FloatArray, t0: float, t1: float, bounds: FloatArray, k: int) -> None:
    """Fills row k of `bounds` with the frame of a law over the closed interval [t0, t1]: its velocity and acceleration
    along its line, or else the ranges of each coordinate as a box around their middles (K44).

    Infinite in every direction for an interval that is not wholly known, ends before it begins, or is not a number.
    """
    row = bounds[k]
    fill(row, 0.0)
    if not (law[c.FIRST] <= t0 <= t1 <= law[c.LAST]):
        row[V_ANY] = row[ACCELERATION + V_ANY] = math.inf
        return
    if law[c.LINKED] > 0.0:
        _bound_link(law, pieces, t0, t1, bounds, k)
        return
    axis = int(law[c.AXIS])
    if law[c.LINE + axis] != 0.0:
        low, high, low_d, high_d = _ranges(law, pieces, axis, t0, t1)
        speed = max(abs(low), abs(high)) / abs(law[c.LINE + axis]) + law[c.SLACK]
        acceleration = max(abs(low_d), abs(high_d)) / abs(law[c.LINE + axis]) + law[c.SLACK + 1]
        for i in range(3):
            row[V + i], row[ACCELERATION + V + i] = speed * law[c.LINE + i], acceleration * law[c.LINE + i]
        row[V_ANY], row[ACCELERATION + V_ANY] = LENGTH_ROUNDING * speed, LENGTH_ROUNDING * acceleration
    else:
        for i in range(3):
            if law[c.MOVES + i] > 0.0:
                low, high, low_d, high_d = _ranges(law, pieces, i, t0, t1)
                row[V + i], row[V_BOX + i] = (low + high) / 2.0, (high - low) / 2.0
                row[ACCELERATION + V + i] = (low_d + high_d) / 2.0
                row[ACCELERATION + V_BOX + i] = (high_d - low_d) / 2.0
        row[V_ANY], row[ACCELERATION + V_ANY] = law[c.SLACK], law[c.SLACK + 1]
    if law[c.TURNS] > 0.0:
        low, high, low_d, high_d = _ranges(law, pieces, 3, t0, t1)
        w, dw = max(abs(low), abs(high)) + law[c.SLACK + 2], max(abs(low_d), abs(high_d)) + law[c.SLACK + 3]
        row[V_REACH], row[ACCELERATION + V_REACH] = w, math.hypot(dw, w * w)
