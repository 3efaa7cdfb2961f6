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
from assur.planner.checker.claim.motion import rounding
from assur.planner.checker.claim.obligations import displaced_gap, is_fixed, own_gap, pair_of
from assur.planner.checker.claim.rows import add_link, place_side
from assur.planner.checker.claim.solids import derivative_bound, solid_reach
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
        hollow, other = (tb.PAIR_A, tb.PAIR_B) if side == 0 else (tb.PAIR_B, tb.PAIR_A)
        t, u = (begin, ahead) if side == 0 else (ahead, begin)
        body = k.bodies[int(pair[hollow])]
        if body[c.BODY_TRIANGLES] == 0.0:
            continue
        one, two = int(k.seated[p, int(pair[hollow])]), int(k.seated[p, int(pair[other])])
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
    """The first pair, after row `after` of the pairs, without a proof that neither body is within the other; -1: none.
    While a pair keeps apart, and both bodies keep their seats, one is within the other all the time, or never."""
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


# Rows of one body: a plane that the body stays behind shows its distance from everything that stands beyond the plane.
#
# The plane has no place of its own. Each body that stands still, with what is required of its pair, has a level: how
# far along the normal the moving body may reach. The interval is halved until all levels are shown, or are reached.


@kernel(f8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, f8, f8))
def reach_at_ends(k: Claim, g: tb.Geometry, s: tb.Scratch, about: FloatArray, t0: float, t1: float) -> float:
    """How far the body of a row reaches along its normal at the ends of an interval, m; infinite: it is not known."""
    solid, on, reach = int(about[tb.SIDE_SOLID]), int(about[tb.SIDE_CARRIER]), -math.inf
    for t in (t0, t1):
        slot = slot_of(k, g, s, on, t, t)
        if slot < 0:
            return math.inf
        reach = max(reach, solid_reach(g, s.jets, slot, solid, on, about[tb.OBJECT_NORMAL :], 1.0))
    return reach


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, tb.PROOF, i8, F1))
def write_levels(k: Claim, g: tb.Geometry, s: tb.Scratch, proof: tb.Proof, i: int, levels: FloatArray) -> None:
    """Writes how far the body of row i may reach for each other body, m; -inf: the row cannot show that pair."""
    row, about, p = proof.rows[i], proof.objects[i], int(proof.objects[i, tb.OBJECT_PLANE])
    a, t, at = int(row[c.ROW_BODY]), row[c.ROW_T1], tb.SIDES
    reach = reach_at_ends(k, g, s, about, row[c.ROW_T0], t)
    for b in range(len(k.bodies)):
        number, f = pair_of(proof, p, a, b) if a != b else -1, int(k.seats[int(k.seated[p, b]), c.SEAT_FRAME])
        levels[b] = -math.inf
        if number < 0 or f < 0 or not is_fixed(g, f):
            continue
        pair = proof.pairs[number]
        if pair[tb.PAIR_EARLY] != 0.0 or pair[tb.PAIR_LATE] != 0.0:
            continue
        place_side(k, g, about, at, p, b, -1.0)
        solid, on = int(about[at + tb.SIDE_SOLID]), int(about[at + tb.SIDE_CARRIER])
        level = -solid_reach(g, s.jets, slot_of(k, g, s, on, t, t), solid, on, about[tb.OBJECT_NORMAL :], -1.0)
        off = pair[tb.PAIR_DISTANCE] + tb.SLACK + rounding(g, on, 0, g.solids[solid, tb.SOLID_SIZE])
        if not reach <= level - off:
            continue
        off += own_gap(k, g, s, about, at, p, row[c.ROW_T0], t)
        levels[b] = level - off - displaced_gap(k, about, p, t)


@kernel(f8(F1, f8))
def least_level(levels: FloatArray, least: float) -> float:
    """The least level that is not below a number; infinite: none."""
    result = math.inf
    for level in levels:
        if least <= level < result:
            result = level
    return result


@kernel(f8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, tb.PROOF, i8, F1, F2))
def shown_level(
    k: Claim, g: tb.Geometry, s: tb.Scratch, proof: tb.Proof, i: int, levels: FloatArray, stack: FloatArray
) -> float:
    """The least level that the body of row i is shown not to exceed; infinite: none."""
    row, about, top, level = proof.rows[i], proof.objects[i], 1, least_level(levels, -1e300)
    solid, on, p = int(about[tb.SIDE_SOLID]), int(about[tb.SIDE_CARRIER]), int(about[tb.OBJECT_PLANE])
    size = g.solids[solid, tb.SOLID_SIZE]
    stack[0, 0], stack[0, 1], stack[0, 2] = row[c.ROW_T0], row[c.ROW_T1], 0.0
    while top > 0 and level < math.inf:
        top -= 1
        t0, t1, depth, bow = stack[top, 0], stack[top, 1], stack[top, 2], 0.0
        proof.state[tb.WORK] -= 0.5 + (g.solids[solid, tb.SOLID_VERTICES] + len(k.displaced)) / 50.0
        if not proof.state[tb.WORK] > 0.1 * s.work[tb.TOUCHED]:
            return math.inf
        reach = reach_at_ends(k, g, s, about, t0, t1)
        # what an instant exceeds, no halving can show
        level = level if reach <= level else least_level(levels, reach)
        if t1 > t0 and level < math.inf:
            slot = slot_of(k, g, s, on, t0, t1)
            if slot < 0:
                bow = math.inf
            else:
                bend = derivative_bound(g, s.jets, slot, 2, solid, on, about[tb.OBJECT_NORMAL :], -1.0)
                bow = max(bend + rounding(g, on, 2, size), 0.0) * (t1 - t0) ** 2 / 8.0
        if level < math.inf:
            reach += bow + rounding(g, on, 0, size) + own_gap(k, g, s, about, 0, p, t0, t1)
        if reach <= level:
            continue
        if depth < tb.DEEPEST and t1 > t0:
            for half in range(2):
                stack[top, 0], stack[top, 1] = (0.5 * (t0 + t1), t1) if half == 0 else (t0, 0.5 * (t0 + t1))
                stack[top, 2], top = depth + 1.0, top + 1
        else:
            level = least_level(levels, np.nextafter(level, np.inf))
            stack[top, 0], stack[top, 1], stack[top, 2], top = t0, t1, depth, top + 1
    return level


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, tb.PROOF, F2), allocates=True)
def link_rows(k: Claim, g: tb.Geometry, s: tb.Scratch, proof: tb.Proof, stack: FloatArray) -> None:
    """Links the rows of each pair, in the order of their begins; a row of one body to all pairs that it shows."""
    levels, at = np.empty(len(k.bodies)), 0
    for n in range(len(proof.rows) - 1, -1, -1):
        i = proof.order[n]
        pair, p = int(proof.objects[i, tb.OBJECT_PAIR]), int(proof.objects[i, tb.OBJECT_PLANE])
        if pair >= 0:
            add_link(proof, at, i, pair)
            at += 1
        if p < 0:
            continue
        write_levels(k, g, s, proof, i, levels)
        level = shown_level(k, g, s, proof, i, levels, stack)
        proof.state[tb.ROWS] += 1.0 if level < math.inf else 0.0
        for b in range(len(k.bodies)):
            if levels[b] >= level:
                add_link(proof, at, i, pair_of(proof, p, int(proof.rows[i, c.ROW_BODY]), b))
                at += 1
