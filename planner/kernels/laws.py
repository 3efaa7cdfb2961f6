"""Where the frames of a cell are, and bounds of their motion, from the tables of their laws (`columns.laws`).

No kind of law is named here. A frame that is a link of another robot has its trajectory in the side table as one run of
numbers (`trajectory_of`). Equations F0, F6 and F9 of docs/kinematics.md.

Columns of places are those of `links`, jets those of `chain`.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels import law_columns as c
from assur.planner.kernels.dyads import fill_rows
from assur.planner.kernels.jets import (
    ACCELERATION,
    CUBE,
    JET_COLUMNS,
    RATE,
    cosine_and_sine,
    put_yaw,
    sweep_links,
    unknown,
)
from assur.planner.kernels.links import ANGLE_COUNT, JOINTS, LINKS, POSE_COLUMNS, SIZE, place_links, put_upright
from assur.planner.kernels.spline import SPLINE, Spline, spline_state, sweep_joints

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


@kernel("Tuple((int64, float64, float64))(float64[::1], float64[:, ::1], float64)")
def _piece_at(law: FloatArray, pieces: FloatArray, t: float) -> tuple[int, float, float]:
    """The piece at time t, the time since its begin, and the number of whole periods before it."""
    whole = 0.0
    if law[c.PERIOD] > 0.0:
        whole, t = _reduced(t, law[c.START], law[c.PERIOD])
    i = last_begun(pieces, int(law[c.BEGIN]), int(law[c.COUNT]), t)
    return i, t - pieces[i, c.PIECE_BEGIN], whole


@kernel("void(float64[::1], float64[:, ::1], float64[::1], float64[:, :, ::1])")
def frame_motions(law: FloatArray, pieces: FloatArray, times: FloatArray, motions: FloatArray) -> None:
    """Fills motions (T, 4, 4) at times (T,): a row an order, columns x, y, z, yaw. NaN where the law is not known, and
    for NaN. Not of links."""
    powers, first = int(law[c.POWERS]), int(law[c.WAVE])
    for row in range(len(times)):
        t, motion = times[row], motions[row]
        if not law[c.FIRST] <= t <= law[c.LAST]:
            motion[:] = math.nan
            continue
        i, u, whole = _piece_at(law, pieces, t)
        for k in range(4):
            x, motion[1, k], motion[2, k], motion[3, k] = _coordinate(pieces, i, k, powers, u)
            motion[0, k] = x + whole * law[c.STEP + k]
        for wave in range(first, first + int(law[c.WAVES])):
            k, size, w = int(pieces[wave, c.WAVE_COORDINATE]), pieces[wave, c.WAVE_AMPLITUDE], pieces[wave, c.WAVE_RATE]
            theta = w * t + pieces[wave, c.WAVE_PHASE]
            sine, cosine = size * math.sin(theta), size * math.cos(theta)
            for n, value in enumerate((sine, w * cosine, -w * w * sine, -w * w * w * cosine)):
                motion[n, k] += value


@kernel("float64(float64, float64)")
def _crest(theta0: float, theta1: float) -> float:
    """The greatest |cos θ| over [θ0, θ1], never below: 1 if a multiple of π lies within, and else at an end."""
    slack = PHASE_ROUNDING * (1.0 + max(abs(theta0), abs(theta1)))
    if math.floor(theta1 / math.pi) >= math.ceil(theta0 / math.pi):
        return 1.0 + slack
    return max(abs(math.cos(theta0)), abs(math.cos(theta1))) + slack


@kernel("UniTuple(float64, 4)(float64[::1], float64[:, ::1], int64, float64, float64)")
def coordinate_rates(
    law: FloatArray, pieces: FloatArray, k: int, t0: float, t1: float
) -> tuple[float, float, float, float]:
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
                    _, v, a, _ = _coordinate(pieces, i, k, powers, u)
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


@kernel(f"Tuple((float64[::1], {SPLINE}))(float64[::1], float64[:, ::1])", allocates=True)
def trajectory_of(law: FloatArray, pieces: FloatArray) -> tuple[FloatArray, Spline]:
    """The row of the neighbour and its spline, which follow each other in the side table, read as one run of numbers:
    robot row, times of the knots (P + 1), coefficients (P, n, 6), `whole` of `spline_tables` (P + 1, 9 n).
    """
    robot = int(law[c.BEGIN]) * pieces.shape[1]
    count, n = int(law[c.COUNT]), int(pieces[int(law[c.BEGIN]), JOINTS])
    times = robot + int(pieces[int(law[c.BEGIN]), SIZE])
    coefficients = times + count + 1
    whole = coefficients + count * n * 6
    run = pieces.reshape(pieces.size)
    return run[robot:times], (
        run[times:coefficients], run[coefficients:whole].reshape((count, n, 6)),
        run[whole : whole + (count + 1) * 9 * n].reshape((count + 1, 9 * n)),
    )  # fmt: skip


@kernel("void(float64[::1], float64[:, ::1], float64, float64[:, ::1], int64)", allocates=True)
def _place_link(law: FloatArray, pieces: FloatArray, t: float, placed: FloatArray, k: int) -> None:
    """F6: the link where the neighbour's spline has it."""
    row, spline = trajectory_of(law, pieces)
    n, links = spline[1].shape[1], int(row[LINKS])
    scratch = np.empty(n + links * POSE_COLUMNS)
    q, found = scratch[:n], scratch[n:].reshape((links, POSE_COLUMNS))
    spline_state(spline, t, q)
    place_links(row, q, found)
    link = int(law[c.LINK])
    for i in range(POSE_COLUMNS):
        placed[k, i] = found[link, i]


@kernel("float64(float64[::1], float64[:, ::1], int64, float64)")
def _coordinate_at(law: FloatArray, pieces: FloatArray, k: int, t: float) -> float:
    """Coordinate k at time t, which is known."""
    i, u, whole = _piece_at(law, pieces, t)
    value = _coordinate(pieces, i, k, int(law[c.POWERS]), u)[0]
    if k < 3 or not law[c.WHOLE] > 0.0:
        value += whole * law[c.STEP + k]
    first = int(law[c.WAVE])
    for wave in range(first, first + int(law[c.WAVES])):
        if int(pieces[wave, c.WAVE_COORDINATE]) == k:
            theta = pieces[wave, c.WAVE_RATE] * t + pieces[wave, c.WAVE_PHASE]
            value += pieces[wave, c.WAVE_AMPLITUDE] * math.sin(theta)
    return value


@kernel("void(float64[::1], float64[:, ::1], float64, float64[:, ::1], int64)")
def place_frame(law: FloatArray, pieces: FloatArray, t: float, placed: FloatArray, k: int) -> None:
    """Fills row k of `placed` with the frame of a law at time t; NaN where the law is not known, and for NaN."""
    if not law[c.FIRST] <= t <= law[c.LAST]:
        fill_rows(placed, k, k + 1, math.nan)
        return
    if law[c.LINKED] > 0.0:
        _place_link(law, pieces, t, placed, k)
        return
    x, y, z = (
        _coordinate_at(law, pieces, 0, t),
        _coordinate_at(law, pieces, 1, t),
        _coordinate_at(law, pieces, 2, t),
    )
    if law[c.TURNS] > 0.0:
        yaw = _coordinate_at(law, pieces, 3, t)
        put_upright(placed, k, x, y, z, math.cos(yaw), math.sin(yaw))
    else:
        put_upright(placed, k, x, y, z, law[c.COS], law[c.SIN])


@kernel(f"void(float64[::1], float64[:, ::1], float64, float64, {CUBE}, int64)", allocates=True)
def _sweep_link(law: FloatArray, pieces: FloatArray, t0: float, t1: float, jets: FloatArray, k: int) -> None:
    """F6: what is known of the link of that arm holds for the frame, which is the link's."""
    row, spline = trajectory_of(law, pieces)
    joints, turns = np.empty((spline[1].shape[1], JET_COLUMNS)), np.empty((int(row[ANGLE_COUNT]), 2, JET_COLUMNS))
    found = np.zeros((int(row[LINKS]), jets.shape[1], JET_COLUMNS))
    sweep_joints(spline, t0, t1, joints)
    sweep_links(row, joints, turns, found)
    link = int(law[c.LINK])
    for i in range(jets.shape[1]):
        for column in range(JET_COLUMNS):
            jets[k, i, column] = found[link, i, column]


@kernel(f"void(float64[::1], float64[:, ::1], float64, float64, {CUBE}, int64)", entry=True)
def sweep_frame(law: FloatArray, pieces: FloatArray, t0: float, t1: float, jets: FloatArray, k: int) -> None:
    """Fills `jets[k]` with the frame of a law over the closed interval [t0, t1]; of its origin only the rates (K44).

    Nothing is known for an interval that is not wholly known, ends before it begins, or is not a number.
    """
    own = jets[k]
    fill_rows(own, 0, len(own), 0.0)
    if not (law[c.FIRST] <= t0 <= t1 <= law[c.LAST]):
        unknown(own)
        return
    if law[c.LINKED] > 0.0:
        _sweep_link(law, pieces, t0, t1, jets, k)
        return
    for axis in range(3):
        if law[c.MOVES + axis] > 0.0:
            low, high, low_d, high_d = coordinate_rates(law, pieces, axis, t0, t1)
            own[axis, RATE], own[axis, RATE + 1] = 0.5 * (low + high), 0.5 * (high - low) + law[c.SLACK]
            own[axis, ACCELERATION] = 0.5 * (low_d + high_d)
            own[axis, ACCELERATION + 1] = 0.5 * (high_d - low_d) + law[c.SLACK + 1]
    if law[c.TURNS] > 0.0:
        low, high, low_d, high_d = coordinate_rates(law, pieces, 3, t0, t1)
        middle, rate = _coordinate_at(law, pieces, 3, 0.5 * (t0 + t1)), (low + high) / 2.0
        yaw = (
            middle, 0.5 * (t1 - t0) * (max(abs(low), abs(high)) + law[c.SLACK + 2]),
            rate, 0.5 * (high - low) + law[c.SLACK + 2],
            0.5 * (low_d + high_d), 0.5 * (high_d - low_d) + law[c.SLACK + 3],
        )  # fmt: skip
        cosine, sine = cosine_and_sine(yaw)
        put_yaw(own, cosine, sine)
