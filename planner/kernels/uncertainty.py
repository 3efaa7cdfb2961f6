"""How much nearer two bodies may be than planned, along a normal: the uncertainty of their places.

A *set* is what two bodies of one pair may be displaced against each other. It is a disc in the horizontal plane, an
interval along the vertical, and segments along given directions (an error of a belt lies along the belt); each is
symmetric, and may grow with time. Its support along n,

    S(n) = |n_xy| disc + |n_z| vertical + Σ |n·e_i| segment_i                                              (N8)

is what a pair must be apart in addition to its clearance. `sets` (N, SET_COLUMNS), one row a set.

Links of the robot are displaced by what the servos lag behind, and by the correction for a belt: both move the joints
by small amounts δ, so a point moves by no more than its rate (K43) where the rates of the joints are δ (N8).

In time, the second unit of a pair may be ahead of the clock: the first is at t, the second at t + s. The robot may
start late by s; then all else is further on by s while it moves. For points x, y of the two the distance along n is
f(t, s) = n·(y(t + s) − x(t)). Over t it bends by both accelerations at most, over s by the second alone, so N3 bounds
it over t at both ends of s, and then over s (N4).
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.carriers import CARRIED, Carried
from assur.planner.kernels.dyads import fill_rows
from assur.planner.kernels.intervals import ROOM, Room, gap_bend
from assur.planner.kernels.jets import ACCELERATION, RATE, sweep_links
from assur.planner.kernels.laws import place_frame, sweep_frame
from assur.planner.kernels.links import KIND, L1, L2, LINKS, SCARA
from assur.planner.kernels.solids import (
    CARRIER,
    CENTRE,
    CUBE,
    NORMAL,
    RADIUS,
    ROW,
    SET,
    TABLE,
    UNITS,
    Normal,
    Units,
    gap,
    place,
)

FLAT, FLAT_GROWTH, UPRIGHT, UPRIGHT_GROWTH = range(4)
"""Columns of a set: radius of the disc, m, by how much it grows, m/s, and the same of the vertical."""
SEGMENTS, SEGMENT = 4, 5
"""Where the segments begin, and columns of each: half its length, m, its growth, m/s, and its direction (3)."""
MOST_SEGMENTS = 4
SET_COLUMNS = SEGMENTS + MOST_SEGMENTS * SEGMENT

SINCE, LATEST, SHIFT, SHIFT_GROWTH = range(4)
"""In `clock`: since when errors grow, s; how late the robot may start at most, s; how far a correction shifts the tool,
m, and by how much that grows, m/s."""
ERRORS = f"Tuple(({TABLE}, {ROW}, {ROW}))"
"""`sets`, `lag` and `clock`: all that is not known of a motion in a cell; `lag` (n,): how far each joint lags."""
Errors = tuple[FloatArray, FloatArray, FloatArray]

OFFSET_TURNS, OFFSET_LEVEL, OFFSET_SHIFT, OFFSET_REACH = 12, 13, 14, 15
"""Columns of how far a link may be displaced, behind how far the coordinates of its origin and of the columns of its
rotation may: the size of the latter together; 1 if it stays upright; how far a correction shifts its axis, m, and by
how much more for each metre from the axis."""
OFFSET_COLUMNS = 16


@kernel(f"float64({ROW}, float64)", entry=True)
def growing_for(clock: FloatArray, t1: float) -> float:
    """For how long errors have grown at t1, s, if the robot started as late as it may."""
    return float(max(t1 + clock[LATEST] - clock[SINCE], 0.0))


@kernel(f"float64({TABLE}, int64, float64, {NORMAL})")
def spread(sets: FloatArray, k: int, lasts: float, normal: Normal) -> float:
    """The support S(n) of set k, m, where errors have grown for `lasts` seconds (N8); 0 for no set (-1)."""
    if k < 0:
        return 0.0
    row, (nx, ny, nz) = sets[k], normal
    found = (row[FLAT] + row[FLAT_GROWTH] * lasts) * math.sqrt(nx * nx + ny * ny)
    found += (row[UPRIGHT] + row[UPRIGHT_GROWTH] * lasts) * abs(nz)
    for i in range(SEGMENTS, SET_COLUMNS, SEGMENT):
        length = row[i] + row[i + 1] * lasts
        if length > 0.0:
            found += length * abs(nx * row[i + 2] + ny * row[i + 3] + nz * row[i + 4])
    return float(found)


@kernel(f"void({TABLE}, int64, float64, {NORMAL}, float64, {TABLE}, int64)")
def add_spread(sets: FloatArray, k: int, lasts: float, normal: Normal, sign: float, points: FloatArray, i: int) -> None:
    """Adds `sign` times the point of set k that is farthest along n to row i of `points`."""
    if k < 0:
        return
    row, (nx, ny, nz) = sets[k], normal
    flat = math.sqrt(nx * nx + ny * ny)
    if flat > 0.0:
        disc = sign * (row[FLAT] + row[FLAT_GROWTH] * lasts) / flat
        points[i, 0] += disc * nx
        points[i, 1] += disc * ny
    upright = sign * (row[UPRIGHT] + row[UPRIGHT_GROWTH] * lasts)
    points[i, 2] += upright if nz >= 0.0 else -upright
    for j in range(SEGMENTS, SET_COLUMNS, SEGMENT):
        length = sign * (row[j] + row[j + 1] * lasts)
        if nx * row[j + 2] + ny * row[j + 3] + nz * row[j + 4] < 0.0:
            length = -length
        for axis in range(3):
            points[i, axis] += length * row[j + 2 + axis]


@kernel("UniTuple(float64, 2)(float64, float64)")
def _cosines(low: float, high: float) -> tuple[float, float]:
    """The least and the greatest cosine over an interval."""
    a, b, turn = math.cos(low), math.cos(high), 2.0 * math.pi
    least, most = min(a, b), max(a, b)
    if math.floor(high / turn) >= math.ceil(low / turn):
        most = 1.0
    if math.floor((high + math.pi) / turn) >= math.ceil((low + math.pi) / turn):
        least = -1.0
    return least, most


@kernel(f"UniTuple(float64, 2)({ROW}, float64, float64, float64)")
def corrected_angles(robot: FloatArray, theta_low: float, theta_high: float, shift: float) -> tuple[float, float]:
    """By how much the links of a SCARA may turn, rad, where its flange is shifted by `shift`, m, in any horizontal
    direction, from anywhere with θ2 in an interval (N10); infinite where it might become singular.

    With |D| = l1 l2 |sin θ2| at least D over all radii that the flange may have, |Δφ1| <= shift l2 / D and
    |Δφ2| <= shift l1 / D (K4). |D| is least at one of the ends of the radii: D² is concave in their square.
    """
    l1, l2 = robot[L1], robot[L2]
    least, most = _cosines(theta_low, theta_high)
    inner = math.sqrt(max(l1 * l1 + l2 * l2 + 2.0 * l1 * l2 * least, 0.0)) - shift
    outer = math.sqrt(max(l1 * l1 + l2 * l2 + 2.0 * l1 * l2 * most, 0.0)) + shift
    if not (inner > 0.0 and outer < l1 + l2):
        return math.inf, math.inf
    square = math.inf
    for radius in (inner, outer):
        k = radius * radius - l1 * l1 - l2 * l2
        square = min(square, 4.0 * l1 * l1 * l2 * l2 - k * k)
    if not square > 0.0:
        return math.inf, math.inf
    cross = 0.5 * math.sqrt(square)
    return shift * l2 / cross, shift * l1 / cross


@kernel(f"boolean({ROW}, {ROOM}, {ERRORS}, float64, {TABLE})")
def displace_links(robot: FloatArray, room: Room, errors: Errors, t1: float, offsets: FloatArray) -> bool:
    """Fills the first rows of `offsets` (K, OFFSET_COLUMNS) with how far links may be from where they are planned while
    joints are as `evaluate_motion` has put them into `room`, and until t1 (N8, N10). False: they cannot be."""
    (_, lag, clock), (_, joints, turns, lagging, jets) = errors, room
    shift = clock[SHIFT] + clock[SHIFT_GROWTH] * growing_for(clock, t1)
    lags = lag.any()
    if not (lags or shift > 0.0):
        return False
    links = int(robot[LINKS])
    fill_rows(offsets, 0, links, 0.0)
    if lags:
        for j in range(len(joints)):
            lagging[j, 0], lagging[j, 1] = joints[j, 0], joints[j, 1] + lag[j]
            lagging[j, RATE], lagging[j, RATE + 1] = 0.0, lag[j]
            lagging[j, ACCELERATION], lagging[j, ACCELERATION + 1] = 0.0, 0.0
        sweep_links(robot, lagging, turns, jets)
        for k in range(links):
            square = 0.0
            for i in range(12):
                offsets[k, i] = abs(jets[k, i, RATE]) + jets[k, i, RATE + 1] if jets[k, 0, 1] < math.inf else math.inf
            offsets[k, OFFSET_LEVEL] = 1.0 if offsets[k, 5] + offsets[k, 8] + offsets[k, 11] == 0.0 else 0.0
            for i in range(3, 5 if offsets[k, OFFSET_LEVEL] > 0.0 else 12):
                square += offsets[k, i] * offsets[k, i]
            offsets[k, OFFSET_TURNS] = math.sqrt(square)
    if shift > 0.0:
        first, second = math.inf, math.inf
        if robot[KIND] == SCARA:
            low, high = joints[1, 0] - joints[1, 1] - lag[1], joints[1, 0] + joints[1, 1] + lag[1]
            first, second = corrected_angles(robot, low, high, shift)
        offsets[1, OFFSET_REACH] = first
        offsets[2, OFFSET_SHIFT], offsets[2, OFFSET_REACH] = robot[L1] * first, second
    return True


@kernel(f"float64({TABLE}, {TABLE}, int64, {NORMAL})")
def displaced(bodies: FloatArray, offsets: FloatArray, i: int, normal: Normal) -> float:
    """By how much points of unit i may be displaced along n, m: 0 for what no link carries.

    The unit counts as the ball around it, and both horizontal coordinates count in full: a checker may bound a
    displacement by the sum of what each joint adds to it, and its bound must not be larger.
    """
    nx, ny, nz = normal
    own, radius, flat = offsets[int(bodies[i, CARRIER])], bodies[i, RADIUS], math.sqrt(nx * nx + ny * ny)
    x, y, z = abs(bodies[i, CENTRE]), abs(bodies[i, CENTRE + 1]), abs(bodies[i, CENTRE + 2])
    level, up = 0.0, own[2] + own[5] * x + own[8] * y + own[11] * z
    for axis in range(2):
        level += own[axis] + own[3 + axis] * x + own[6 + axis] * y + own[9 + axis] * z
    found = flat * level + abs(nz) * up + radius * own[OFFSET_TURNS] * (flat if own[OFFSET_LEVEL] > 0.0 else 1.0)
    if own[OFFSET_REACH] > 0.0:
        found += flat * (own[OFFSET_SHIFT] + own[OFFSET_REACH] * (math.hypot(x, y) + radius))
    return found if found >= 0.0 else math.inf


@kernel(f"float64({TABLE}, {TABLE}, int64, {TABLE}, {TABLE}, float64, boolean, int64, int64, {NORMAL})")
def uncertainty_margin(
    pairs: FloatArray,
    sets: FloatArray,
    p: int,
    bodies: FloatArray,
    offsets: FloatArray,
    lasts: float,
    is_offset: bool,
    a: int,
    b: int,
    normal: Normal,
) -> float:
    """By how much units a and b of pair p may be nearer along n than planned, m."""
    found = spread(sets, int(pairs[p, SET]), lasts, normal)
    if is_offset:
        found += displaced(bodies, offsets, a, normal) + displaced(bodies, offsets, b, normal)
    return found


MOMENTS, MIDDLE = 5, 4
"""Instants at which a shifted pair is placed: t0 and t1 with the first shift, then with the last one; the middle."""
Shifted = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""Carriers (MOMENTS, K, 12) and units (MOMENTS, U, 12), jets of the frames over all of it (K, JETS, JET_COLUMNS), and
what of each carrier is known, (K, 3): number of the interval and both shifts."""
SHIFTED = f"Tuple(({CUBE}, {CUBE}, {CUBE}, {TABLE}))"


@kernel(f"void({CARRIED}, {UNITS}, int64, int64, int64, float64[::1], {SHIFTED})")
def place_shifted(
    carried: Carried, units: Units, number: int, a: int, b: int, span: FloatArray, shifted: Shifted
) -> None:
    """Places units a and b of one item: the first where `placed` (3, U, 12) has it, the second ahead of the clock.

    `span` (4,): begin and end of interval number `number`, and of the shift, s. The second is carried by a frame.
    """
    carriers, both, jets, known = shifted
    (robot, laws, side), (bodies, _, placed) = carried, units
    links = int(robot[LINKS])
    k, t0, t1, s0, s1 = int(bodies[b, CARRIER]), span[0], span[1], span[2], span[3]
    if not (known[k, 0] == number and known[k, 1] == s0 and known[k, 2] == s1):
        known[k, 0], known[k, 1], known[k, 2] = number, s0, s1
        for m in range(MOMENTS):
            t, s = (t0 if m % 2 == 0 else t1), (s0 if m < 2 else s1)
            if m == MIDDLE:
                t, s = 0.5 * (t0 + t1), 0.5 * (s0 + s1)
            place_frame(laws[k - links], side, t + s, carriers[m], k)
        sweep_frame(laws[k - links], side, t0 + s0, t1 + s1, jets, k)
    for m in range(MOMENTS):
        place(bodies, b, carriers[m], both, m)
        moment = 1 if m == MIDDLE else 2 * (m % 2)
        for i in range(both.shape[2]):
            both[m, a, i] = placed[moment, a, i]


@kernel(f"UniTuple(float64, 3)({UNITS}, {CUBE}, {CUBE}, int64, int64, {NORMAL}, float64, float64)")
def least_shifted(
    both: Units, jets: FloatArray, ahead: FloatArray, a: int, b: int, normal: Normal, h: float, d: float
) -> tuple[float, float, float]:
    """A lower bound of the gap along n over an interval of length h and a shift of length d (N4); and by how much it
    may differ along each of both."""
    bend, added = gap_bend(both[0], jets, ahead, a, b, normal)
    over_time, over_shift = max(bend, 0.0) * h * h / 8.0, max(added, 0.0) * d * d / 8.0
    one, two = gap(both, 0, a, b, normal), gap(both, 1, a, b, normal)
    three, four = gap(both, 2, a, b, normal), gap(both, 3, a, b, normal)
    least = min(one, two, three, four) - over_time - over_shift
    over_time += max(abs(two - one), abs(four - three))
    return least, over_time, over_shift + max(abs(three - one), abs(four - two))
