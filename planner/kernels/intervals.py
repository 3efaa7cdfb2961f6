"""What all searches over halved intervals of time share: motion over an interval, a stack of intervals, open pairs.

Where the carriers are, and how fast they can move, is computed once an interval and shared by all pairs that are still
open. The state of a search is in arrays of the caller, so that it can be left off and taken up again: `items` (M, 6),
open pairs of units, a, b, number of the pair, and a normal to try first (0, 0, 0: none); `stack` (S, 4), intervals
still to do, t0, t1, first item, number of items; `state` (STATE_COLUMNS,).
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel
from assur.planner.kernels.carriers import CARRIED, Carried, derivative, place_carriers, sweep_carriers
from assur.planner.kernels.jets import JET_COLUMNS, JETS, Ball
from assur.planner.kernels.links import ANGLE_COUNT, LINKS, POSE_COLUMNS
from assur.planner.kernels.solids import (
    CARRIER,
    CELL,
    CUBE,
    NORMAL,
    NUMBERS,
    OPENED,
    PIECES,
    RADIUS,
    ROW,
    TABLE,
    UNITS,
    Normal,
    Units,
    place,
)
from assur.planner.kernels.spline import SPLINE, Spline, spline_state, sweep_joints

Cell: TypeAlias = tuple[FloatArray, FloatArray, IntArray]
"""`bodies`, `vertices`, `still`."""
MOTION = f"Tuple(({CARRIED}, {SPLINE}))"
Motion: TypeAlias = tuple[Carried, Spline]
"""What moves the carriers, and how the joints move."""

ITEM_FROM, ITEM_TO, ITEM_COLUMNS = 6, 7, 8
"""Columns of an item: the least and the greatest shift, s, and how many there are; its normal is from 3 on."""
TOP, FOUND = 0, 1
"""In `state`: how many intervals are on the stack, and how many rows were written."""
STATE_COLUMNS = 9
DONE, HIT, RESISTED, ROWS_FULL, ITEMS_FULL, WORK_SPENT = range(6)
"""How a search was left."""

RESERVE_M = 1e-6
"""The reserve of a proof, kept above every required distance, m: the checker has bounds of its own and asks for less
(1 nm); rounding of poses and gaps is about 1e-15 m a term in cells of a few metres."""
FINEST_S = 2e-5
"""Intervals are halved no further than this, s: what is not proved by then is not certified."""
KEPT_STILL = 1 << 60
"""Number of the interval for which a unit that stands still was placed: it is placed once."""


ROOM = f"Tuple(({ROW}, {TABLE}, {CUBE}, {TABLE}, {CUBE}))"
Room: TypeAlias = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]
"""Room to work in for one interval after the other: joints `q` (n,) and their jets `joints` (n, JET_COLUMNS), cosines
and sines of the angles (A, 2, JET_COLUMNS); of joints that lag the jets (n, JET_COLUMNS), and of their links (L, JETS,
JET_COLUMNS)."""


@kernel(f"{ROOM}({MOTION})", allocates=True)
def room_for(motion: Motion) -> Room:
    """Room to work in for a motion."""
    (robot, _, _), (_, c, _) = motion
    n, angles, links = c.shape[1], int(robot[ANGLE_COUNT]), int(robot[LINKS])
    joints, lagging = np.zeros((n, JET_COLUMNS)), np.zeros((n, JET_COLUMNS))
    turns, lagged = np.zeros((angles, 2, JET_COLUMNS)), np.zeros((links, JETS, JET_COLUMNS))
    return np.zeros(n), joints, turns, lagging, lagged


@kernel(f"Tuple(({CUBE}, {UNITS}))({CELL}, int64)", allocates=True)
def places_for(cell: Cell, moments: int) -> tuple[FloatArray, Units]:
    """Carriers and units of a cell, still to be placed, at so many instants."""
    bodies, vertices, still = cell
    carriers, placed = np.zeros((moments, len(still), POSE_COLUMNS)), np.zeros((moments, len(bodies), POSE_COLUMNS))
    return carriers, (bodies, vertices, placed)


@kernel(f"void({MOTION}, float64, float64, {ROOM}, {CUBE}, {CUBE})")
def evaluate_motion(motion: Motion, t0: float, t1: float, room: Room, carriers: FloatArray, jets: FloatArray) -> None:
    """Fills `carriers` (3, K, 12) at both ends and in the middle of [t0, t1], and over it `jets` (K, JETS, JET_COLUMNS)
    and those of the joints in `room`."""
    carried, spline = motion
    q, joints, turns, _, _ = room
    for moment in range(3):
        t = t0 if moment == 0 else (0.5 * (t0 + t1) if moment == 1 else t1)
        spline_state(spline, t, q)
        place_carriers(carried, q, t, carriers[moment])
    sweep_joints(spline, t0, t1, joints)
    sweep_carriers(carried, t0, t1, joints, turns, jets)


@kernel(f"void({UNITS}, int64, {CUBE}, {NUMBERS}, int64, {NUMBERS})")
def place_unit(units: Units, i: int, carriers: FloatArray, stamp: IntArray, number: int, still: IntArray) -> None:
    """Places unit i at the instants of `carriers` of interval number `number`, unless it has been."""
    bodies, _, placed = units
    if stamp[i] < number:
        for moment in range(len(carriers)):
            place(bodies, i, carriers[moment], placed, moment)
        stamp[i] = KEPT_STILL if still[int(bodies[i, CARRIER])] else number


@kernel("float64(float64, float64, float64, float64)")
def least_between(g0: float, g1: float, bend: float, h: float) -> float:
    """The least value over an interval of length h, from those at its ends and a bound of its second derivative
    (N3)."""
    return float(min(g0, g1) - max(bend, 0.0) * h * h / 8.0)


@kernel(f"UniTuple(float64, 2)({TABLE}, {CUBE}, {CUBE}, int64, int64, {NORMAL})")
def gap_bend(bodies: FloatArray, jets: FloatArray, ahead: FloatArray, a: int, b: int, normal: Normal) -> Ball:
    """Upper bounds of the second derivative of the gap of units a and b along n, and of what unit b adds to it, from
    the jets of their carriers: those of b's in `ahead`."""
    one, other = derivative(bodies, jets, a, 2, normal), derivative(bodies, ahead, b, 2, normal)
    added = other[0] + other[1]
    return added - one[0] + one[1], added


@kernel(f"float64({TABLE}, {CUBE}, int64, int64, {NORMAL}, float64, float64, float64)")
def least_gap(
    bodies: FloatArray, jets: FloatArray, a: int, b: int, normal: Normal, g0: float, g1: float, h: float
) -> float:
    """A lower bound of the gap of units a and b along n over an interval of length h, from those at its ends."""
    return float(least_between(g0, g1, gap_bend(bodies, jets, jets, a, b, normal)[0], h))


@kernel(f"{NORMAL}({TABLE}, int64)")
def normal_of(items: FloatArray, i: int) -> Normal:
    """The normal of item i."""
    return items[i, 3], items[i, 4], items[i, 5]


@kernel(f"void({TABLE}, int64, {NORMAL})")
def keep_normal(items: FloatArray, i: int, normal: Normal) -> None:
    """Writes the normal of item i."""
    items[i, 3], items[i, 4], items[i, 5] = normal


@kernel(f"boolean({TABLE}, int64, int64)")
def halve_shift(items: FloatArray, i: int, end: int) -> bool:
    """Writes item i with the later half of its shift behind item `end` - 1, and leaves the earlier half in its place;
    False: there is no room."""
    if end >= len(items):
        return False
    middle = 0.5 * (items[i, ITEM_FROM] + items[i, ITEM_TO])
    for column in range(ITEM_COLUMNS):
        items[end, column] = items[i, column]
    items[end, ITEM_FROM] = items[i, ITEM_TO] = middle
    return True


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
