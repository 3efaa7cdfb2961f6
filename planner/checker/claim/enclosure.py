"""What a closed surface encloses belongs to its body: whether no piece of another body is within it (N11).

Rows keep the pieces of two bodies apart, so no piece of one crosses the surface of the other while they hold and both
keep their seats. It is enough that a surface goes round one point of each piece 0 times when such a time begins. The
number of times is whole, so it is 0 if it is less than 1/2, rounding included.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import slot_of
from assur.planner.checker.claim.obligations import pair_of
from assur.planner.checker.claim.tables import F1, F2, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types


def open_body(k: Claim) -> int:
    """The first body whose surface is not closed: an edge, known by the coordinates of its ends, is not run through as
    often one way as the other. -1: none."""
    if not len(k.triangles):
        return -1
    body_of_piece = np.repeat(np.arange(len(k.bodies)), k.bodies[:, c.BODY_PIECES].astype(np.int64))
    body_of_vertex = np.repeat(body_of_piece, k.pieces[:, c.PIECE_VERTICES].astype(np.int64))
    places = np.column_stack((body_of_vertex, k.vertices))
    order = np.lexsort(places.T)
    differs = (places[order[1:]] != places[order[:-1]]).any(1)
    numbers = np.empty(len(places), dtype=np.int64)
    numbers[order] = np.concatenate(([0], np.cumsum(differs)))
    corners = numbers[k.triangles[:, c.TRIANGLE_VERTEX : c.TRIANGLE_PIECE].astype(np.int64)]
    begin, end = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    edges, index = np.unique(np.minimum(begin, end) * len(places) + np.maximum(begin, end), return_inverse=True)
    runs = np.bincount(index, weights=np.sign(end - begin), minlength=len(edges))
    if not runs.any():
        return -1
    body_of_triangle = body_of_piece[k.triangles[:, c.TRIANGLE_PIECE].astype(np.int64)]
    return int(np.repeat(body_of_triangle, 3)[runs[index] != 0.0].min())


@kernel(f8(tb.CLAIM, tb.GEOMETRY, i8, f8, f8, f8, F2))
def times_round(k: Claim, g: tb.Geometry, seat: int, x: float, y: float, z: float, far: FloatArray) -> float:
    """How often at most the surface of a seated body goes round the point (x, y, z) in the axes of its carrier, as a
    number without sign, with its rounding (R6). Infinite: the point is too near to the surface. `far`: room for the
    vertices of the body, seen from the point, and their distances."""
    body, start = k.bodies[int(k.seats[seat, c.SEAT_BODY])], int(g.first[seat, 1])
    begin = int(k.pieces[int(body[c.BODY_PIECE]), c.PIECE_VERTEX])
    final = k.pieces[int(body[c.BODY_PIECE] + body[c.BODY_PIECES]) - 1]
    many = int(final[c.PIECE_VERTEX] + final[c.PIECE_VERTICES]) - begin
    above, below = 0, 0  # along how many axes all vertices are on one side of the point
    for axis in range(3):
        low, high, own = math.inf, -math.inf, x if axis == 0 else y if axis == 1 else z
        for i in range(many):
            far[i, axis] = g.vertices[start + i, axis] - own
            low, high = min(low, far[i, axis]), max(high, far[i, axis])
        above, below = above + int(low > 0.0), below + int(high < 0.0)
    if above + below > 0:
        return 0.0
    for i in range(many):
        far[i, 3] = math.sqrt(far[i, 0] ** 2 + far[i, 1] ** 2 + far[i, 2] ** 2)
    total, off = 0.0, 0.0
    for i in range(int(body[c.BODY_TRIANGLE]), int(body[c.BODY_TRIANGLE] + body[c.BODY_TRIANGLES])):
        row = k.triangles[i]
        a, b = far[int(row[c.TRIANGLE_VERTEX]) - begin], far[int(row[c.TRIANGLE_VERTEX + 1]) - begin]
        e = far[int(row[c.TRIANGLE_VERTEX + 2]) - begin]
        volume = a[0] * (b[1] * e[2] - b[2] * e[1]) + a[1] * (b[2] * e[0] - b[0] * e[2])
        volume += a[2] * (b[0] * e[1] - b[1] * e[0])
        rest = a[3] * (b[0] * e[0] + b[1] * e[1] + b[2] * e[2]) + b[3] * (e[0] * a[0] + e[1] * a[1] + e[2] * a[2])
        rest += e[3] * (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) + a[3] * b[3] * e[3]
        size, wrong = math.sqrt(volume * volume + rest * rest), 32.0 * tb.ULP * a[3] * b[3] * e[3]
        if not size > 4.0 * wrong:
            return math.inf
        total, off = total + math.atan2(volume, rest), off + 2.0 * wrong / size + 8.0 * tb.ULP
    return (abs(total) + off) / (2.0 * math.pi)


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, F2, F1))
def is_outside(k: Claim, g: tb.Geometry, s: tb.Scratch, pair: FloatArray, far: FloatArray, state: FloatArray) -> bool:
    """Whether none of two bodies is within the other as their phase begins."""
    p = int(pair[tb.PAIR_PHASE])
    begin, ahead = k.phases[p, c.PHASE_T0], k.phases[p, c.PHASE_T0] + pair[tb.PAIR_EARLY]
    for side in range(2):
        shell, other = (tb.PAIR_A, tb.PAIR_B) if side == 0 else (tb.PAIR_B, tb.PAIR_A)
        t, u = (begin, ahead) if side == 0 else (ahead, begin)
        body = k.bodies[int(pair[shell])]
        if body[c.BODY_TRIANGLES] == 0.0:
            continue
        one, two = int(k.seated[p, int(pair[shell])]), int(k.seated[p, int(pair[other])])
        here, there = k.seats[one], k.seats[two]
        on = int(here[c.SEAT_LINK] if here[c.SEAT_LINK] >= 0.0 else g.on[int(here[c.SEAT_FRAME]), 0])
        other_on = int(there[c.SEAT_LINK] if there[c.SEAT_LINK] >= 0.0 else g.on[int(there[c.SEAT_FRAME]), 0])
        slot, other_slot = slot_of(k, g, s, on, t, t), slot_of(k, g, s, other_on, u, u)
        if slot < 0 or other_slot < 0:
            return False
        at, other_at, first = s.jets[slot, on], s.jets[other_slot, other_on], int(g.first[two, 0])
        for i in range(int(k.bodies[int(pair[other]), c.BODY_PIECES])):
            solid = g.solids[first + i]
            hull = solid[tb.SOLID_VERTICES] > 0.0
            place = g.vertices[int(solid[tb.SOLID_VERTEX])] if hull else solid[tb.SOLID_CENTRE :]
            x, y, z = 0.0, 0.0, 0.0
            for m in range(3):
                d = other_at[m, 0] - at[m, 0]
                for column in range(3):
                    d += place[column] * other_at[3 + 3 * column + m, 0]
                x, y, z = x + d * at[3 + m, 0], y + d * at[6 + m, 0], z + d * at[9 + m, 0]
            state[tb.WORK] -= 1.0 + body[c.BODY_TRIANGLES] / 10.0
            if not (state[tb.WORK] > 0.0 and times_round(k, g, one, x, y, z, far) < 0.5):
                return False
    return True


@kernel(i8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, tb.PROOF, i8), allocates=True)
def first_within(k: Claim, g: tb.Geometry, s: tb.Scratch, proof: tb.Proof, after: int) -> int:
    """The first pair after row `after` of the pairs of which nothing shows that neither body is within the other; -1:
    none. While a pair keeps apart, and both bodies keep their seats, one is within the other all the time, or never."""
    if len(k.triangles) == 0:
        return -1
    far, pairs = np.empty((len(k.vertices), 4)), proof.pairs
    for d in range(after + 1, int(proof.state[tb.PAIRS])):
        p, a, b = int(pairs[d, tb.PAIR_PHASE]), int(pairs[d, tb.PAIR_A]), int(pairs[d, tb.PAIR_B])
        enclosing = k.bodies[a, c.BODY_TRIANGLES] + k.bodies[b, c.BODY_TRIANGLES] > 0.0
        if not (enclosing and pairs[d, tb.PAIR_DISTANCE] >= 0.0):
            continue
        before = pair_of(proof, p - 1, a, b) if p > 0 else -1
        remains = before >= 0 and int(pairs[before, tb.PAIR_A]) == a and pairs[before, tb.PAIR_DISTANCE] >= 0.0
        remains = remains and k.seated[p - 1, a] == k.seated[p, a] and k.seated[p - 1, b] == k.seated[p, b]
        if not remains and not is_outside(k, g, s, pairs[d], far, proof.state):
            return d
    return -1
