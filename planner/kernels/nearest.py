"""The smallest clearance over a motion, between a proved lower and an upper value, by branch and bound.

A pair leaves an interval when the bound of its gap over it (equations C2, C3) is not below the smallest distance found
so far less `WITHIN_M`; otherwise the interval is halved. The smallest such bound is below every distance at every
instant; the smallest distance found is one that occurs. The state of the search is in arrays of the caller, as in
`proof`: `items`, `stack`, and `state`, which goes on from one phase to the next.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel
from assur.planner.kernels.carriers import place_carriers
from assur.planner.kernels.gjk import separate
from assur.planner.kernels.links import BOUND_COLUMNS, POSE_COLUMNS
from assur.planner.kernels.proof import (
    DONE,
    FINEST_S,
    ITEMS_FULL,
    TOP,
    WORK_SPENT,
    fetch,
    move_items,
    open_box,
    push,
    survey,
    unit_bound,
)
from assur.planner.kernels.screening import fetch_one
from assur.planner.kernels.solids import (
    CUBE,
    FIRST,
    NORMAL,
    NUMBERS,
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

LOWER, UPPER, NEAREST_T, NEAREST_A, NEAREST_B = 1, 2, 3, 4, 5
"""In `state`, besides TOP: the proved lower value, the smallest distance found, m, when and of which units it is."""
SEARCH_COLUMNS = 6
WITHIN_M = 4e-5
"""How far the lower value may be below the upper one, m: less than the 0.05 mm that is promised."""


@kernel(f"float64({TABLE}, {TABLE}, {CUBE}, {TABLE}, int64, int64, {NORMAL}, float64)")
def least_gap(
    bodies: FloatArray,
    vertices: FloatArray,
    placed: FloatArray,
    bounds: FloatArray,
    a: int,
    b: int,
    nx: float,
    ny: float,
    nz: float,
    h: float,
) -> float:
    """A lower bound of the distance of two units over an interval of length h, along one normal (C2, C3)."""
    g0 = gap(bodies, vertices, placed, 0, a, b, nx, ny, nz)
    g1 = gap(bodies, vertices, placed, 2, a, b, nx, ny, nz)
    speed_a, acceleration_a = unit_bound(bodies, bounds, a, nx, ny, nz)
    speed_b, acceleration_b = unit_bound(bodies, bounds, b, nx, ny, nz)
    by_speed = 0.5 * (g0 + g1 - (speed_a + speed_b) * h)
    by_acceleration = min(g0, g1) - (acceleration_a + acceleration_b) * h * h / 8.0
    return by_speed if by_speed >= by_acceleration else by_acceleration


@kernel(f"boolean({TABLE}, {TABLE}, {CUBE}, {TABLE}, float64, float64, {TABLE}, int64, {TABLE}, {TABLE}, {ROW})")
def bounded(
    bodies: FloatArray,
    vertices: FloatArray,
    placed: FloatArray,
    bounds: FloatArray,
    t0: float,
    t1: float,
    items: FloatArray,
    i: int,
    points: FloatArray,
    work: FloatArray,
    state: FloatArray,
) -> bool:
    """Whether item i can leave the interval [t0, t1]; the state takes what is found, the item its best normal."""
    a, b, h = int(items[i, 0]), int(items[i, 1]), t1 - t0
    nx, ny, nz = items[i, 3], items[i, 4], items[i, 5]
    enough, best = state[UPPER] - WITHIN_M, -math.inf
    for attempt in range(3):
        if attempt == 0:
            if nx == 0.0 and ny == 0.0 and nz == 0.0:
                continue
        elif attempt == 1:
            _, nx, ny, nz = likely(bodies, vertices, placed, 1, a, b, math.inf)
        else:
            _, nx, ny, nz, above = separate(bodies, vertices, placed, 1, a, b, math.inf, points, work)
            if above < state[UPPER] and bodies[a, PIECES] == 0.0 and bodies[b, PIECES] == 0.0:
                state[UPPER], state[NEAREST_T], state[NEAREST_A], state[NEAREST_B] = above, 0.5 * (t0 + t1), a, b
                enough = above - WITHIN_M
        found = least_gap(bodies, vertices, placed, bounds, a, b, nx, ny, nz, h)
        best = max(best, found)
        if best >= enough:
            break
    items[i, 3], items[i, 4], items[i, 5] = nx, ny, nz
    several = bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0
    leaves = best >= enough or not (several or h > FINEST_S)
    if leaves and not best >= state[LOWER]:
        state[LOWER] = best
    return leaves


@kernel(f"void({ROW}, {TABLE}, {TABLE}, {ROW}, {CUBE}, {TABLE}, {TABLE}, {NUMBERS}, {TABLE}, {ROW}, {ROW})")
def sample_distance(
    robot: FloatArray,
    laws: FloatArray,
    side: FloatArray,
    tk: FloatArray,
    c: FloatArray,
    bodies: FloatArray,
    vertices: FloatArray,
    still: IntArray,
    pairs: FloatArray,
    t: FloatArray,
    state: FloatArray,
) -> None:
    """Lowers the smallest distance found, by looking at instants `t` (T,); bodies of several pieces are left out."""
    carriers, placed = np.empty((len(still), POSE_COLUMNS)), np.empty((1, len(bodies), POSE_COLUMNS))
    stamp, q = np.zeros(len(bodies), dtype=np.int64), np.empty(c.shape[1])
    points, work = np.empty((4, 3)), np.empty((3, 4))
    for i in range(len(t)):
        spline_state(tk, c, t[i], q)
        place_carriers(robot, laws, side, q, t[i], carriers)
        for p in range(len(pairs)):
            a, b = int(pairs[p, FIRST]), int(pairs[p, SECOND])
            if pairs[p, REQUIRED] < 0.0 or bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0:
                continue
            fetch_one(bodies, a, carriers, placed, stamp, i + 1, still)
            fetch_one(bodies, b, carriers, placed, stamp, i + 1, still)
            if spheres_apart(bodies, placed, 0, a, b, state[UPPER]):
                continue
            if likely(bodies, vertices, placed, 0, a, b, state[UPPER])[0] > state[UPPER]:
                continue
            _, _, _, _, above = separate(bodies, vertices, placed, 0, a, b, state[UPPER], points, work)
            if above < state[UPPER]:
                state[UPPER], state[NEAREST_T], state[NEAREST_A], state[NEAREST_B] = above, t[i], a, b


@kernel(
    f"int64({ROW}, {TABLE}, {TABLE}, {ROW}, {CUBE}, {TABLE}, {TABLE}, {TABLE}, {TABLE}, {NUMBERS}, {TABLE}, {TABLE},"
    f" {ROW}, int64)"
)
def search_nearest(
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
    items: FloatArray,
    stack: FloatArray,
    state: FloatArray,
    budget: int,
) -> int:
    """Goes on with a search until it is done, or items or work run out; then it can be repeated with more room."""
    n, m = c.shape[1], len(matrix)
    carriers, placed = np.empty((3, len(still), POSE_COLUMNS)), np.empty((3, len(bodies), POSE_COLUMNS))
    bounds, stamp = np.zeros((len(still), BOUND_COLUMNS)), np.zeros(len(bodies), dtype=np.int64)
    q, swept, points, work = np.empty(n), np.empty((4, max(n, m))), np.empty((4, 3)), np.empty((3, 4))
    number = 0
    while state[TOP] > 0.0:
        top = int(state[TOP]) - 1
        if top + 2 > len(stack):
            return ITEMS_FULL
        if budget <= 0:
            return WORK_SPENT
        t0, t1, first, count = stack[top, 0], stack[top, 1], int(stack[top, 2]), int(stack[top, 3])
        state[TOP] = top
        number += 1
        survey(robot, laws, side, tk, c, whole, matrix, t0, t1, q, swept, carriers, bounds)
        end, left, i = first + count, 0, first
        while i < end:
            budget -= 1
            a, b = int(items[i, 0]), int(items[i, 1])
            fetch(bodies, a, carriers, placed, stamp, number, still)
            fetch(bodies, b, carriers, placed, stamp, number, still)
            if not bounded(bodies, vertices, placed, bounds, t0, t1, items, i, points, work, state):
                nx, ny, nz = items[i, 3], items[i, 4], items[i, 5]
                several = bodies[a, PIECES] > 0.0 or bodies[b, PIECES] > 0.0
                if several and not gap(bodies, vertices, placed, 1, a, b, nx, ny, nz) > state[UPPER]:
                    opened = open_box(bodies, items, i, end)
                    if opened < 0:
                        move_items(items, i, first + left, end - i)
                        push(stack, state, t0, t1, first, left + end - i)
                        return ITEMS_FULL
                    end = opened
                else:
                    move_items(items, i, first + left, 1)
                    left += 1
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
