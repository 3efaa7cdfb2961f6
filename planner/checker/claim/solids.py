"""Pieces of bodies at their places on their carriers: how far they reach along a direction, and how that changes."""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.tables import F1, F4, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types


@kernel(f8(F1, i8, i8))
def length(v: FloatArray, first: int, last: int) -> float:
    """The length of the vector in columns `first` to `last` - 1."""
    total = 0.0
    for i in range(first, last):
        total += v[i] * v[i]
    return math.sqrt(total)


@kernel(f8(tb.GEOMETRY, i8, f8, f8, f8))
def extent(g: tb.Geometry, solid: int, u: float, v: float, w: float) -> float:
    """The largest m·x of a solid, m, for a unit vector m = (u, v, w) in the axes of its carrier (N2)."""
    own, total = g.solids[solid], g.solids[solid, tb.SOLID_BALL]
    for e in range(tb.SOLID_EDGE, tb.SOLID_EDGE + 3 * int(own[tb.SOLID_EDGES]), 3):
        total += abs(u * own[e] + v * own[e + 1] + w * own[e + 2])
    if own[tb.SOLID_DISC] > 0.0:
        p, q, r = own[tb.SOLID_AXIS], own[tb.SOLID_AXIS + 1], own[tb.SOLID_AXIS + 2]
        total += own[tb.SOLID_DISC] * math.sqrt((v * r - w * q) ** 2 + (w * p - u * r) ** 2 + (u * q - v * p) ** 2)
    first, many = int(own[tb.SOLID_VERTEX]), int(own[tb.SOLID_VERTICES])
    if many == 0:
        return float(total + u * own[0] + v * own[1] + w * own[2])
    most = -math.inf
    for i in range(first, first + many):
        most = max(most, u * g.vertices[i, 0] + v * g.vertices[i, 1] + w * g.vertices[i, 2])
    return float(total + most)


@kernel(f8(tb.GEOMETRY, F4, i8, i8, i8, F1, f8))
def support(g: tb.Geometry, jets: FloatArray, slot: int, solid: int, on: int, normal: FloatArray, sign: float) -> float:
    """The largest m·x of a solid at an instant, m, for a unit vector m = `sign` * `normal` of the world (N2)."""
    at, x, y, z = jets[slot, on], sign * normal[0], sign * normal[1], sign * normal[2]
    u = x * at[3, 0] + y * at[4, 0] + z * at[5, 0]
    v = x * at[6, 0] + y * at[7, 0] + z * at[8, 0]
    w = x * at[9, 0] + y * at[10, 0] + z * at[11, 0]
    return float(x * at[0, 0] + y * at[1, 0] + z * at[2, 0] + extent(g, solid, u, v, w))


@kernel(f8(tb.GEOMETRY, F4, i8, i8, i8, i8, F1, f8))
def derivative_bound(
    g: tb.Geometry, jets: FloatArray, slot: int, order: int, solid: int, on: int, normal: FloatArray, sign: float
) -> float:
    """A bound over an interval of the derivative of that order (1 or 2) of m·p, for all points p of a solid and a unit
    vector m = `sign` * `normal`. What keeps its shape adds nothing: balls, and discs about the vertical on upright
    carriers."""
    own, at, k, flat = g.solids[solid], jets[slot, on], 2 * order, g.carriers[on, tb.CARRIER_UPRIGHT] > 0.0
    x, y, z = sign * normal[0], sign * normal[1], sign * normal[2]
    ax, ay, az = abs(x), abs(y), abs(z)
    u, ru = x * at[3, k] + y * at[4, k] + z * at[5, k], ax * at[3, k + 1] + ay * at[4, k + 1] + az * at[5, k + 1]
    v, rv = x * at[6, k] + y * at[7, k] + z * at[8, k], ax * at[6, k + 1] + ay * at[7, k + 1] + az * at[8, k + 1]
    w, rw = x * at[9, k] + y * at[10, k] + z * at[11, k], ax * at[9, k + 1] + ay * at[10, k + 1] + az * at[11, k + 1]
    total = x * at[0, k] + y * at[1, k] + z * at[2, k] + ax * at[0, k + 1] + ay * at[1, k + 1] + az * at[2, k + 1]
    for e in range(tb.SOLID_EDGE, tb.SOLID_EDGE + 3 * int(own[tb.SOLID_EDGES]), 3):
        total += abs(u * own[e] + v * own[e + 1] + w * own[e + 2])
        total += ru * abs(own[e]) + rv * abs(own[e + 1]) + rw * abs(own[e + 2])
    if own[tb.SOLID_DISC] > 0.0 and not (flat and own[tb.SOLID_AXIS] == 0.0 and own[tb.SOLID_AXIS + 1] == 0.0):
        total += own[tb.SOLID_DISC] * math.sqrt((abs(u) + ru) ** 2 + (abs(v) + rv) ** 2 + (abs(w) + rw) ** 2)
    first, many = int(own[tb.SOLID_VERTEX]), int(own[tb.SOLID_VERTICES])
    if many == 0:
        total += u * own[0] + v * own[1] + w * own[2] + ru * abs(own[0]) + rv * abs(own[1]) + rw * abs(own[2])
        return float(total)
    most = -math.inf
    for i in range(first, first + many):
        p, q, r = g.vertices[i, 0], g.vertices[i, 1], g.vertices[i, 2]
        most = max(most, u * p + v * q + w * r + ru * abs(p) + rv * abs(q) + rw * abs(r))
    return float(total + most)


@kernel(types.void(f8, f8, F1, i8, F1, i8))
def turn_vector(cosine: float, sine: float, given: FloatArray, at: int, result: FloatArray, to: int) -> None:
    """Turns the vector in columns `at` to `at` + 2 of `given` about the vertical, into columns of `result`."""
    x, y = given[at], given[at + 1]
    result[to], result[to + 1], result[to + 2] = cosine * x - sine * y, sine * x + cosine * y, given[at + 2]


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, i8, i8, i8, i8))
def place_piece(k: Claim, g: tb.Geometry, seat: int, i: int, at: int, vertex: int) -> None:
    """Writes piece i of a seated body to row `at` of the solids, its vertices from row `vertex` on."""
    pose, piece, own = k.seats[seat, c.SEAT_POSE :], k.pieces[i], g.solids[at]
    cosine, sine, size = math.cos(pose[3]), math.sin(pose[3]), length(piece, c.PIECE_AXIS, c.PIECE_DISC)
    for m in range(tb.SOLID_DISC, tb.SOLID_EDGE):
        own[m] = piece[c.PIECE_DISC + m - tb.SOLID_DISC]
    turn_vector(cosine, sine, piece, c.PIECE_CENTRE, own, tb.SOLID_CENTRE)
    turn_vector(cosine, sine, piece, c.PIECE_AXIS, own, tb.SOLID_AXIS)
    for m in range(3):
        own[tb.SOLID_CENTRE + m] += pose[m]
        own[tb.SOLID_AXIS + m] /= max(size, 1e-6)
    far, tall, own[tb.SOLID_VERTEX] = math.sqrt(own[0] ** 2 + own[1] ** 2), abs(own[2]), vertex
    for m in range(int(piece[c.PIECE_VERTICES])):
        to = g.vertices[vertex + m]
        turn_vector(cosine, sine, k.vertices[int(piece[c.PIECE_VERTEX]) + m], 0, to, 0)
        for axis in range(3):
            to[axis] += pose[axis]
        far, tall = max(far, math.sqrt(to[0] ** 2 + to[1] ** 2)), max(tall, abs(to[2]))
    for e in range(0, 3 * int(piece[c.PIECE_EDGES]), 3):
        turn_vector(cosine, sine, piece, c.PIECE_EDGE + e, own, tb.SOLID_EDGE + e)
        far += math.sqrt(own[tb.SOLID_EDGE + e] ** 2 + own[tb.SOLID_EDGE + e + 1] ** 2)
        tall += abs(own[tb.SOLID_EDGE + e + 2])
    own[tb.SOLID_REACH] = far + own[tb.SOLID_DISC] + own[tb.SOLID_BALL]
    own[tb.SOLID_SIZE] = own[tb.SOLID_REACH] + tall + own[tb.SOLID_DISC] + own[tb.SOLID_BALL]


@kernel(types.void(tb.CLAIM, tb.GEOMETRY))
def place_solids(k: Claim, g: tb.Geometry) -> None:
    """Every piece of every seated body in the axes of its carrier; behind the pieces of a body the box in its own axes
    that holds all of them."""
    at, vertex = 0, 0
    for s in range(len(k.seats)):
        body, first = k.bodies[int(k.seats[s, c.SEAT_BODY])], at
        g.first[s, 0], g.first[s, 1] = at, vertex
        for i in range(int(body[c.BODY_PIECE]), int(body[c.BODY_PIECE] + body[c.BODY_PIECES])):
            place_piece(k, g, s, i, at, vertex)
            at, vertex = at + 1, vertex + int(k.pieces[i, c.PIECE_VERTICES])
        box, wide, tall = g.solids[at], 0.0, 0.0
        cosine, sine = math.cos(k.seats[s, c.SEAT_POSE + 3]), math.sin(k.seats[s, c.SEAT_POSE + 3])
        for axis in range(3):
            u, v, w = (cosine, sine, 0.0) if axis == 0 else (-sine, cosine, 0.0) if axis == 1 else (0.0, 0.0, 1.0)
            low, high, e = math.inf, -math.inf, tb.SOLID_EDGE + 3 * axis
            for i in range(first, at):
                low, high = min(low, -extent(g, i, -u, -v, -w)), max(high, extent(g, i, u, v, w))
            middle, half = 0.5 * (low + high), 0.5 * (high - low)
            box[0], box[1], box[2] = box[0] + middle * u, box[1] + middle * v, box[2] + middle * w
            box[e], box[e + 1], box[e + 2] = half * u, half * v, half * w
            wide, tall = wide + (half if axis < 2 else 0.0), abs(middle) + half
        box[tb.SOLID_EDGES], box[tb.SOLID_REACH], at = 3.0, math.sqrt(box[0] ** 2 + box[1] ** 2) + wide, at + 1
        box[tb.SOLID_SIZE] = box[tb.SOLID_REACH] + tall
