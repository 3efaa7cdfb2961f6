"""The proof that all pairs of a phase stay apart at every instant: depth first over halved intervals.

Where the carriers are, and how fast they can move, is computed once an interval and shared by all pairs that are still
open; a pair leaves as soon as one normal proves it (equations C1 to C5 in docs/guarantees.md). What is not proved goes
on to both halves of its interval, with the best normal so far as the first to try. A bounding box that is too near is
replaced by the pieces in it.

The state of the proof is in arrays of the caller, so that it can be left off and taken up again: `items` (M, 6), open
pairs of units, a, b, number of the pair, and a normal to try first (0, 0, 0: none); `stack` (S, 4), intervals still to
do, t0, t1, first item, number of items; `state` (STATE_COLUMNS,).
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel
from assur.planner.kernels.carriers import carrier_bounds, place_carriers, point_bound
from assur.planner.kernels.gjk import separate
from assur.planner.kernels.links import BOUND_COLUMNS, POSE_COLUMNS
from assur.planner.kernels.solids import (
    CARRIER,
    CUBE,
    DISTANCE,
    GROWTH,
    LATE,
    NORMAL,
    NUMBERS,
    OPENED,
    PIECES,
    RADIUS,
    REACH,
    REQUIRED,
    ROW,
    TABLE,
    gap,
    likely,
    place,
)
from assur.planner.kernels.spline import spline_state, sweep_bounds

ITEM_COLUMNS = 6
TOP, ROWS = 0, 1
"""In `state`: how many intervals are on the stack, and how many rows are written."""
RESISTED_A, RESISTED_B, RESISTED_T, RESISTED_GAP, RESISTED_NEED = 2, 3, 4, 5, 6
"""In `state`, of the pair that resisted: its units, the instant, the largest gap found there and the one needed."""
STATE_COLUMNS = 7
T0, T1, UNIT, OTHER, ALONG = range(5)
"""Columns of a row: interval, s, two units, and a normal (3) from the first to the second."""
ROW_COLUMNS = 7

DONE, RESISTED, ROWS_FULL, ITEMS_FULL, WORK_SPENT = range(5)
"""How the proof was left."""
PROVED, OPEN, HALVE, TOO_NEAR = range(4)
"""What became of one item on one interval."""

RESERVE_M = 1e-6
"""The reserve of a proof, kept above every required distance, m: the checker has bounds of its own and asks for less
(1 nm); rounding of poses and gaps is about 1e-15 m a term in cells of a few metres."""
FINEST_S = 2e-5
"""Intervals are halved no further than this, s: what is not proved by then is not certified."""
KEPT_STILL = 1 << 60
"""Instant number of a unit that stands still: it is placed once."""


@kernel(
    f"void({ROW}, {TABLE}, {TABLE}, {ROW}, {CUBE}, {TABLE}, {TABLE}, float64, float64, {ROW}, {TABLE}, {CUBE}, {TABLE})"
)
def survey(
    robot: FloatArray,
    laws: FloatArray,
    side: FloatArray,
    tk: FloatArray,
    c: FloatArray,
    whole: FloatArray,
    matrix: FloatArray,
    t0: float,
    t1: float,
    q: FloatArray,
    swept: FloatArray,
    carriers: FloatArray,
    bounds: FloatArray,
) -> None:
    """Fills `carriers` (3, K, 12) at both ends and in the middle of [t0, t1], and `bounds` of
    their motion over it (K, BOUND_COLUMNS).

    `q` (n,) and `swept` (4, max(n, m)) are room to work in.
    """
    n, m = c.shape[1], len(matrix)
    for moment in range(3):
        t = t0 if moment == 0 else (0.5 * (t0 + t1) if moment == 1 else t1)
        spline_state(tk, c, t, q)
        place_carriers(robot, laws, side, q, t, carriers[moment])
    lower, upper, rate, rate_d = swept[0, :n], swept[1, :n], swept[2, :m], swept[3, :m]
    sweep_bounds(tk, c, whole, matrix, t0, t1, lower, upper, rate, rate_d)
    carrier_bounds(robot, laws, side, t0, t1, lower, upper, rate, rate_d, bounds)


@kernel(f"void({TABLE}, int64, {CUBE}, {CUBE}, {NUMBERS}, int64, {NUMBERS})")
def fetch(
    bodies: FloatArray,
    i: int,
    carriers: FloatArray,
    placed: FloatArray,
    stamp: IntArray,
    number: int,
    still: IntArray,
) -> None:
    """Places unit i at the three instants of interval number `number`, unless it has been."""
    if stamp[i] < number:
        for moment in range(3):
            place(bodies, i, carriers[moment], placed, moment)
        stamp[i] = KEPT_STILL if still[int(bodies[i, CARRIER])] else number


@kernel(f"UniTuple(float64, 2)({TABLE}, {TABLE}, int64, {NORMAL})")
def unit_bound(bodies: FloatArray, bounds: FloatArray, i: int, nx: float, ny: float, nz: float) -> tuple[float, float]:
    """Bounds of |n·ẋ| and |n·ẍ| over an interval, for all points x of unit i."""
    return point_bound(bounds, int(bodies[i, CARRIER]), bodies[i, REACH], bodies[i, DISTANCE], nx, ny, nz)


@kernel(f"float64({TABLE}, int64, float64, float64)")
def needed(pairs: FloatArray, p: int, since: float, t1: float) -> float:
    """The gap, m, that a row of pair p up to t1 must show, but for what a late start adds (C4, C5)."""
    return float(pairs[p, REQUIRED] + pairs[p, GROWTH] * max(t1 + pairs[p, LATE] - since, 0.0) + RESERVE_M)


@kernel(
    f"boolean({TABLE}, {TABLE}, {CUBE}, {TABLE}, {TABLE}, int64, int64, {NORMAL}, float64, float64, float64, float64,"
    f" {TABLE}, int64)"
)
def shown(
    bodies: FloatArray,
    vertices: FloatArray,
    placed: FloatArray,
    bounds: FloatArray,
    late_bounds: FloatArray,
    a: int,
    b: int,
    nx: float,
    ny: float,
    nz: float,
    t0: float,
    t1: float,
    need: float,
    late: float,
    rows: FloatArray,
    r: int,
) -> bool:
    """Whether the normal n keeps units a and b apart by `need` over all of [t0, t1] (C4); then row r says so."""
    g0 = gap(bodies, vertices, placed, 0, a, b, nx, ny, nz)
    if not g0 > need:
        return False
    g1 = gap(bodies, vertices, placed, 2, a, b, nx, ny, nz)
    if not g1 > need:
        return False
    speed_a, acceleration_a = unit_bound(bodies, bounds, a, nx, ny, nz)
    speed_b, acceleration_b = unit_bound(bodies, bounds, b, nx, ny, nz)
    speed, acceleration, h = speed_a + speed_b, acceleration_a + acceleration_b, t1 - t0
    if late > 0.0:
        need += late * unit_bound(bodies, late_bounds, b, nx, ny, nz)[0]
    by_speed = 0.5 * (g0 + g1 - speed * h)
    by_acceleration = min(g0, g1) - acceleration * h * h / 8.0
    if not (by_speed >= need or by_acceleration >= need):
        return False
    rows[r, T0], rows[r, T1], rows[r, UNIT], rows[r, OTHER] = t0, t1, a, b
    rows[r, ALONG], rows[r, ALONG + 1], rows[r, ALONG + 2] = nx, ny, nz
    return True


@kernel(
    f"int64({TABLE}, {TABLE}, {CUBE}, {TABLE}, {TABLE}, {TABLE}, float64, float64, float64, {TABLE}, int64, {TABLE},"
    f" int64, {TABLE}, {TABLE}, {ROW})"
)
def settle(
    bodies: FloatArray,
    vertices: FloatArray,
    placed: FloatArray,
    bounds: FloatArray,
    late_bounds: FloatArray,
    pairs: FloatArray,
    since: float,
    t0: float,
    t1: float,
    items: FloatArray,
    i: int,
    rows: FloatArray,
    r: int,
    points: FloatArray,
    work: FloatArray,
    found: FloatArray,
) -> int:
    """What becomes of item i on [t0, t1]; a row that proves it is written as row r.

    Normals are tried in this order: that of the longer interval, the vertical, the best of the likely ones, and that of
    GJK. The best in the middle of the interval is kept with the item; `found` (2,) is its gap there and the one needed.
    """
    a, b, p = int(items[i, 0]), int(items[i, 1]), int(items[i, 2])
    late = pairs[p, LATE]
    need = needed(pairs, p, since, t1)
    best, nx, ny, nz = -math.inf, items[i, 3], items[i, 4], items[i, 5]
    if nx != 0.0 or ny != 0.0 or nz != 0.0:
        best = gap(bodies, vertices, placed, 1, a, b, nx, ny, nz)
        if best > need and shown(
            bodies, vertices, placed, bounds, late_bounds, a, b, nx, ny, nz, t0, t1, need, late, rows, r
        ):
            return PROVED
    for attempt in range(3):
        if attempt == 0:
            # the vertical first: heights change slowly, so it does for long intervals
            mx, my, mz = 0.0, 0.0, 1.0 if placed[1, b, 2] >= placed[1, a, 2] else -1.0
            other = gap(bodies, vertices, placed, 1, a, b, mx, my, mz)
        elif attempt == 1:
            other, mx, my, mz = likely(bodies, vertices, placed, 1, a, b, math.inf)
        else:
            other, mx, my, mz, _ = separate(bodies, vertices, placed, 1, a, b, math.inf, points, work)
        if not (other > best or other > need):
            continue
        if other > need and shown(
            bodies, vertices, placed, bounds, late_bounds, a, b, mx, my, mz, t0, t1, need, late, rows, r
        ):
            return PROVED
        if other > best:
            best, nx, ny, nz = other, mx, my, mz
    items[i, 3], items[i, 4], items[i, 5] = nx, ny, nz
    found[0], found[1] = best, need
    if best > need:
        return HALVE
    return OPEN if bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0 else TOO_NEAR


@kernel(f"int64({TABLE}, {TABLE}, int64, int64)")
def open_box(bodies: FloatArray, items: FloatArray, i: int, end: int) -> int:
    """Writes item i, with the larger of its bounding boxes replaced by the pieces in it, behind item `end` - 1.

    Returns the new end, or -1 if there is no room.
    """
    a, b = int(items[i, 0]), int(items[i, 1])
    first = bodies[a, PIECES] > 0.0 and not (bodies[b, PIECES] > 0.0 and bodies[b, RADIUS] > bodies[a, RADIUS])
    opened = a if first else b
    count, piece = int(bodies[opened, PIECES]), int(bodies[opened, OPENED])
    if end + count > len(items):
        return -1
    for k in range(count):
        items[end + k, 0] = piece + k if first else a
        items[end + k, 1] = b if first else piece + k
        for column in range(2, ITEM_COLUMNS):
            items[end + k, column] = items[i, column]
    return end + count


@kernel(f"void({TABLE}, int64, int64, int64)")
def move_items(items: FloatArray, source: int, target: int, count: int) -> None:
    """Copies `count` items to a place that is not behind them, or does not overlap them."""
    if source == target:
        return
    for k in range(count):
        for column in range(ITEM_COLUMNS):
            items[target + k, column] = items[source + k, column]


@kernel(f"void({TABLE}, {ROW}, float64, float64, int64, int64)")
def push(stack: FloatArray, state: FloatArray, t0: float, t1: float, first: int, count: int) -> None:
    """Puts an interval and its items on the stack."""
    top = int(state[TOP])
    stack[top, 0], stack[top, 1], stack[top, 2], stack[top, 3] = t0, t1, first, count
    state[TOP] = top + 1


@kernel(
    f"int64({ROW}, {TABLE}, {TABLE}, {ROW}, {CUBE}, {TABLE}, {TABLE}, {TABLE}, {TABLE}, {NUMBERS}, {TABLE}, float64,"
    f" float64, {TABLE}, {TABLE}, {ROW}, {TABLE}, int64)"
)
def prove(
    robot: FloatArray,
    laws: FloatArray,
    side: FloatArray,
    tk: FloatArray,
    c: FloatArray,
    whole: FloatArray,
    matrix: FloatArray,
    bodies: FloatArray,
    vertices: FloatArray,
    still: IntArray,
    pairs: FloatArray,
    since: float,
    latest: float,
    items: FloatArray,
    stack: FloatArray,
    state: FloatArray,
    rows: FloatArray,
    budget: int,
) -> int:
    """Goes on with a proof until it is done, a pair resists, or rows, items or work run out.

    Motion: `robot`, `laws`, `side` of the carriers, `tk`, `c`, `whole`, `matrix` of the joints. `still` (K,): 1 for
    carriers that stand still throughout. `since`: the time from which a growth counts; `latest`: by how much the robot
    may start late at most, s. `budget`: after how many items no interval is begun. Unless it is done or a pair resists,
    the state is such that the call can be repeated with more room.
    """
    carriers_many, n, m = len(still), c.shape[1], len(matrix)
    carriers, placed = np.empty((3, carriers_many, POSE_COLUMNS)), np.empty((3, len(bodies), POSE_COLUMNS))
    bounds, late_bounds = np.zeros((carriers_many, BOUND_COLUMNS)), np.zeros((carriers_many, BOUND_COLUMNS))
    stamp = np.zeros(len(bodies), dtype=np.int64)
    q, swept, points, work, found = (
        np.empty(n),
        np.empty((4, max(n, m))),
        np.empty((4, 3)),
        np.empty((3, 4)),
        np.empty(2),
    )
    number = 0
    while state[TOP] > 0.0:
        top = int(state[TOP]) - 1
        if top + 2 > len(stack):
            return ITEMS_FULL
        # between intervals only: items that were looked over in one would be looked over again
        if budget <= 0:
            return WORK_SPENT
        t0, t1, first, count = stack[top, 0], stack[top, 1], int(stack[top, 2]), int(stack[top, 3])
        state[TOP] = top
        number += 1
        survey(robot, laws, side, tk, c, whole, matrix, t0, t1, q, swept, carriers, bounds)
        if latest > 0.0:
            lower, upper, rate, rate_d = swept[0, :n], swept[1, :n], swept[2, :m], swept[3, :m]
            carrier_bounds(robot, laws, side, t0, t1 + latest, lower, upper, rate, rate_d, late_bounds)
        end, left, i = first + count, 0, first
        while i < end:
            r = int(state[ROWS])
            status = DONE
            if r >= len(rows):
                status = ROWS_FULL
            else:
                budget -= 1
                fetch(bodies, int(items[i, 0]), carriers, placed, stamp, number, still)
                fetch(bodies, int(items[i, 1]), carriers, placed, stamp, number, still)
                verdict = settle(
                    bodies, vertices, placed, bounds, late_bounds, pairs, since, t0, t1, items, i, rows, r, points,
                    work, found,
                )  # fmt: skip
                if verdict == PROVED:
                    state[ROWS] = r + 1
                elif verdict == OPEN:
                    opened = open_box(bodies, items, i, end)
                    if opened < 0:
                        status = ITEMS_FULL
                    else:
                        end = opened
                elif verdict == TOO_NEAR or not t1 - t0 > FINEST_S:
                    state[RESISTED_A], state[RESISTED_B], state[RESISTED_T] = items[i, 0], items[i, 1], 0.5 * (t0 + t1)
                    state[RESISTED_GAP], state[RESISTED_NEED] = found[0], found[1] - RESERVE_M
                    return RESISTED
                else:
                    move_items(items, i, first + left, 1)
                    left += 1
            if status != DONE:
                move_items(items, i, first + left, end - i)
                push(stack, state, t0, t1, first, left + end - i)
                return status
            i += 1
        if left > 0:
            if first + 2 * left > len(items):
                push(stack, state, t0, t1, first, left)
                return ITEMS_FULL
            middle = 0.5 * (t0 + t1)
            move_items(items, first, first + left, left)
            push(stack, state, middle, t1, first, left)
            push(stack, state, t0, middle, first + left, left)
    return DONE
