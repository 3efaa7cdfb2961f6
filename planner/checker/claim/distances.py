"""Two bodies are no farther apart than is claimed at an instant: points of both are so near to each other."""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import slot_of
from assur.planner.checker.claim.motion import rounding
from assur.planner.checker.claim.rows import place_side
from assur.planner.checker.claim.solids import length
from assur.planner.checker.claim.tables import F1, F2, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types

CHOSEN = 1e-9
"""m, or a sine: what a direction does not choose by more than this is in the middle."""


@kernel(f8(F1, i8, F1))
def along(own: FloatArray, at: int, direction: FloatArray) -> float:
    """The scalar product of the vector in columns `at` to `at` + 2 with a direction."""
    return float(own[at] * direction[0] + own[at + 1] * direction[1] + own[at + 2] * direction[2])


@kernel(types.void(F1, f8, F1, i8))
def add(result: FloatArray, share: float, own: FloatArray, at: int) -> None:
    """Adds a share of the vector in columns `at` to `at` + 2."""
    for m in range(3):
        result[m] += share * own[at + m]


@kernel(types.void(tb.GEOMETRY, F2, i8, f8, F1, F2, F1))
def add_farthest(
    g: tb.Geometry,
    at: FloatArray,
    solid: int,
    weight: float,
    direction: FloatArray,
    room: FloatArray,
    result: FloatArray,
) -> None:
    """Adds a weight of the point of a solid that is farthest along a unit vector of the world. `at`: the jets of its
    carrier. `room`: for three vectors."""
    own, here, local, far = g.solids[solid], room[0], room[1], -math.inf
    first, many = int(own[tb.SOLID_VERTEX]), int(own[tb.SOLID_VERTICES])
    for column in range(3):
        local[column] = 0.0
        for m in range(3):
            local[column] += direction[m] * at[3 + 3 * column + m, 0]
    for i in range(first, first + many):
        far = max(far, along(g.vertices[i], 0, local))
    here[:3] = 0.0
    add(here, 1.0, own, tb.SOLID_CENTRE)
    for i in range(first + many - 1, first - 1, -1):
        if along(g.vertices[i], 0, local) >= far - CHOSEN:
            here[:3] = 0.0
            add(here, 1.0, g.vertices[i], 0)
    for e in range(tb.SOLID_EDGE, tb.SOLID_EDGE + 3 * int(own[tb.SOLID_EDGES]), 3):
        way = along(own, e, local)
        add(here, 1.0 if way > CHOSEN else -1.0 if way < -CHOSEN else 0.0, own, e)
    add(local, -along(own, tb.SOLID_AXIS, local), own, tb.SOLID_AXIS)
    across = length(local, 0, 3)
    add(here, own[tb.SOLID_DISC] / across if across > CHOSEN else 0.0, local, 0)
    for m in range(3):
        place = at[m, 0] + here[0] * at[3 + m, 0] + here[1] * at[6 + m, 0] + here[2] * at[9 + m, 0]
        result[m] += weight * (place + own[tb.SOLID_BALL] * direction[m])


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, F2))
def is_near(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, stack: FloatArray) -> bool:
    """Whether two bodies are no farther apart than is claimed. `stack`: room for what a row is about, and vectors."""
    p, t, total, off = int(own[c.DISTANCE_PHASE]), own[c.DISTANCE_TIME], 0.0, tb.SLACK
    room, points, direction = stack[0], stack[1], stack[2]
    if not k.phases[p, c.PHASE_T0] <= t <= k.phases[p, c.PHASE_T1]:
        return False
    for i in range(4):
        total += own[c.DISTANCE_WEIGHT + i]
    if not abs(total - 1.0) <= 1e-9:
        return False
    points[:3] = 0.0
    for side in range(2):
        at, sign = side * tb.SIDES, 1.0 - 2.0 * side
        place_side(k, g, room, at, p, int(own[c.DISTANCE_BODY + side]), own[c.DISTANCE_PIECE + side])
        solid, on = int(room[at + tb.SIDE_SOLID]), int(room[at + tb.SIDE_CARRIER])
        slot = slot_of(k, g, s, on, t, t)
        if slot < 0:
            return False
        off += rounding(g, on, 0, g.solids[solid, tb.SOLID_SIZE])
        for i in range(4):
            d = c.DISTANCE_DIRECTION + 3 * i
            if own[c.DISTANCE_WEIGHT + i] == 0.0:
                continue
            size = length(own, d, d + 3)
            if not 0.0 < size < math.inf:
                return False
            direction[:3] = 0.0
            add(direction, sign / size, own, d)
            weight = sign * own[c.DISTANCE_WEIGHT + i] / total
            add_farthest(g, s.jets[slot, on], solid, weight, direction, stack[3:], points)
    return bool(length(points, 0, 3) + off <= own[c.DISTANCE_MOST])
