"""The smallest clearance over a motion, between a proved lower and an upper value, by branch and bound.

A pair leaves an interval when the bound of its gap over it (equation N3) is not below the smallest distance found
so far less `WITHIN_M`; otherwise the interval is halved. The smallest such bound is below every distance at every
instant; the smallest distance found is one that occurs. The `state` goes on from one phase to the next.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel
from assur.planner.kernels.carriers import place_carriers
from assur.planner.kernels.gjk import separate
from assur.planner.kernels.intervals import FINEST_S, Cell, Motion, fetch, least_gap
from assur.planner.kernels.links import POSE_COLUMNS
from assur.planner.kernels.proof import HALVE, OPEN, PROVED
from assur.planner.kernels.solids import (
    CELL,
    CUBE,
    FIRST,
    MOTION,
    PIECES,
    REQUIRED,
    ROW,
    SECOND,
    TABLE,
    gap,
    likely,
    spheres_apart,
)
from assur.planner.kernels.spline import spline_state

LOWER, UPPER, NEAREST_T, NEAREST_A, NEAREST_B = 2, 3, 4, 5, 6
"""In `state`, besides TOP: the proved lower value, the smallest distance found, m, when and of which units it is."""
WITHIN_M = 3e-5
"""How far the lower value may be below the upper one, m: less than the 0.05 mm that is promised."""
SHORT = 16.0
"""An interval of no more `FINEST_S` is not halved further for a normal that keeps a pair apart in its middle."""


@kernel(f"int64({TABLE}, {TABLE}, {CUBE}, {CUBE}, float64, float64, {TABLE}, int64, {TABLE}, {TABLE}, {ROW})")
def bounded(
    bodies: FloatArray,
    vertices: FloatArray,
    placed: FloatArray,
    jets: FloatArray,
    t0: float,
    t1: float,
    items: FloatArray,
    i: int,
    points: FloatArray,
    work: FloatArray,
    state: FloatArray,
) -> int:
    """What becomes of item i on [t0, t1]: it leaves (`PROVED`), is halved or opened.

    The state takes what is found, the item its best normal.
    """
    a, b, h = int(items[i, 0]), int(items[i, 1]), t1 - t0
    nx, ny, nz = items[i, 3], items[i, 4], items[i, 5]
    enough, best = state[UPPER] - WITHIN_M, -math.inf
    several = bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0
    for attempt in range(3):
        if attempt == 0:
            if nx == 0.0 and ny == 0.0 and nz == 0.0:
                continue
        elif attempt == 1:
            _, nx, ny, nz = likely(bodies, vertices, placed, 1, a, b, math.inf)
        else:
            # where another normal keeps them apart in the middle it is the interval that is too long; of a short one it
            # may be the normal, which only just does
            long = h > SHORT * FINEST_S
            if not several and long and gap(bodies, vertices, placed, 1, a, b, nx, ny, nz) >= enough:
                break
            _, nx, ny, nz, above = separate(bodies, vertices, placed, 1, a, b, math.inf, points, -1, 0.0, points, work)
            if above < state[UPPER] and bodies[a, PIECES] == 0.0 and bodies[b, PIECES] == 0.0:
                state[UPPER], state[NEAREST_T], state[NEAREST_A], state[NEAREST_B] = above, 0.5 * (t0 + t1), a, b
                enough = above - WITHIN_M
        g0 = gap(bodies, vertices, placed, 0, a, b, nx, ny, nz)
        g1 = gap(bodies, vertices, placed, 2, a, b, nx, ny, nz)
        found = least_gap(bodies, jets, a, b, nx, ny, nz, g0, g1, h)
        best = max(best, found)
        if best >= enough:
            break
    items[i, 3], items[i, 4], items[i, 5] = nx, ny, nz
    if best >= enough or not (several or h > FINEST_S):
        if not best >= state[LOWER]:
            state[LOWER] = best
        return PROVED
    if several and not gap(bodies, vertices, placed, 1, a, b, nx, ny, nz) > state[UPPER]:
        return OPEN
    return HALVE


@kernel(f"void({MOTION}, {CELL}, {TABLE}, float64, float64, int64, {ROW})", allocates=True)
def sample_distance(
    motion: Motion, cell: Cell, pairs: FloatArray, t0: float, t1: float, many: int, state: FloatArray
) -> None:
    """Lowers the smallest distance found, at `many` instants of [t0, t1]; bodies of several pieces are left out."""
    robot, laws, side, tk, c, _ = motion
    bodies, vertices, still = cell
    carriers, placed = np.empty((1, len(still), POSE_COLUMNS)), np.empty((1, len(bodies), POSE_COLUMNS))
    stamp, q = np.zeros(len(bodies), dtype=np.int64), np.empty(c.shape[1])
    points, work = np.empty((4, 3)), np.empty((3, 4))
    for i in range(many):
        t = t0 + (t1 - t0) * i / max(many - 1, 1)
        spline_state(tk, c, t, q)
        place_carriers(robot, laws, side, q, t, carriers[0])
        for p in range(len(pairs)):
            a, b = int(pairs[p, FIRST]), int(pairs[p, SECOND])
            if pairs[p, REQUIRED] < 0.0 or bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0:
                continue
            fetch(bodies, a, carriers, placed, stamp, i + 1, still)
            fetch(bodies, b, carriers, placed, stamp, i + 1, still)
            if spheres_apart(bodies, placed, 0, a, b, state[UPPER]):
                continue
            found = likely(bodies, vertices, placed, 0, a, b, state[UPPER])[0]
            if found > state[UPPER] or not found > -math.inf:
                continue
            _, _, _, _, above = separate(bodies, vertices, placed, 0, a, b, state[UPPER], points, -1, 0.0, points, work)
            if above < state[UPPER]:
                state[UPPER], state[NEAREST_T], state[NEAREST_A], state[NEAREST_B] = above, t, a, b
