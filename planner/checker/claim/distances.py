"""Two bodies are no farther apart than is claimed at an instant: points of both are so near to each other."""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import slot_of
from assur.planner.checker.claim.motion import rounding
from assur.planner.checker.claim.rows import place_side
from assur.planner.checker.claim.solids import length
from assur.planner.checker.claim.tables import F1, F4, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types

CHOSEN = 1e-9
"""m, or a sine: what a direction does not choose by more than this is in the middle."""


@kernel(types.void(tb.GEOMETRY, F4, i8, i8, i8, f8, f8, f8, f8, F1))
def add_farthest(
    g: tb.Geometry,
    jets: FloatArray,
    slot: int,
    solid: int,
    on: int,
    weight: float,
    x: float,
    y: float,
    z: float,
    result: FloatArray,
) -> None:
    """Adds a weight of the point of a solid that is farthest along a unit vector (x, y, z) of the world."""
    own, at = g.solids[solid], jets[slot, on]
    u = x * at[3, 0] + y * at[4, 0] + z * at[5, 0]
    v = x * at[6, 0] + y * at[7, 0] + z * at[8, 0]
    w = x * at[9, 0] + y * at[10, 0] + z * at[11, 0]
    p, q, r = own[tb.SOLID_CENTRE], own[tb.SOLID_CENTRE + 1], own[tb.SOLID_CENTRE + 2]
    first, many, most = int(own[tb.SOLID_VERTEX]), int(own[tb.SOLID_VERTICES]), -math.inf
    for i in range(first, first + many):
        most = max(most, u * g.vertices[i, 0] + v * g.vertices[i, 1] + w * g.vertices[i, 2])
    for i in range(first + many - 1, first - 1, -1):
        if u * g.vertices[i, 0] + v * g.vertices[i, 1] + w * g.vertices[i, 2] >= most - CHOSEN:
            p, q, r = g.vertices[i, 0], g.vertices[i, 1], g.vertices[i, 2]
    for e in range(tb.SOLID_EDGE, tb.SOLID_EDGE + 3 * int(own[tb.SOLID_EDGES]), 3):
        along = u * own[e] + v * own[e + 1] + w * own[e + 2]
        sign = 1.0 if along > CHOSEN else -1.0 if along < -CHOSEN else 0.0
        p, q, r = p + sign * own[e], q + sign * own[e + 1], r + sign * own[e + 2]
    along = u * own[tb.SOLID_AXIS] + v * own[tb.SOLID_AXIS + 1] + w * own[tb.SOLID_AXIS + 2]
    a, b, d = (
        u - along * own[tb.SOLID_AXIS],
        v - along * own[tb.SOLID_AXIS + 1],
        w - along * own[tb.SOLID_AXIS + 2],
    )
    across = math.sqrt(a * a + b * b + d * d)
    disc = own[tb.SOLID_DISC] / across if across > CHOSEN else 0.0
    p, q, r = p + disc * a, q + disc * b, r + disc * d
    for m in range(3):
        ball = own[tb.SOLID_BALL] * (x if m == 0 else y if m == 1 else z)
        result[m] += weight * (at[m, 0] + p * at[3 + m, 0] + q * at[6 + m, 0] + r * at[9 + m, 0] + ball)


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, F1))
def is_near(k: Claim, g: tb.Geometry, s: tb.Scratch, own: FloatArray, room: FloatArray) -> bool:
    """Whether two bodies are no farther apart than is claimed. `room`: for what a row is about, and for two points."""
    p, t, total, off = int(own[c.DISTANCE_PHASE]), own[c.DISTANCE_TIME], 0.0, tb.SLACK
    if not k.phases[p, c.PHASE_T0] <= t <= k.phases[p, c.PHASE_T1]:
        return False
    for i in range(4):
        total += own[c.DISTANCE_WEIGHT + i]
    if not abs(total - 1.0) <= 1e-9:
        return False
    points = room[tb.OBJECT :]
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
            x, y, z = sign * own[d] / size, sign * own[d + 1] / size, sign * own[d + 2] / size
            weight = sign * own[c.DISTANCE_WEIGHT + i] / total
            add_farthest(g, s.jets, slot, solid, on, weight, x, y, z, points)
    return bool(length(points, 0, 3) + off <= own[c.DISTANCE_MOST])
