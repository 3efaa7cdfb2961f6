"""Rows of the proof: what each is about, whether it holds on its interval, and whether rows cover all that is required.

Along a unit normal n two pieces have the gap -support_A(n) - support_B(-n); their distance is no smaller. Over an
interval h long, with B ahead of the clock by s from s0 to s1,

    gap(t, s) >= least of the corners - max(M_A + M_B, 0) h²/8 - max(M_B, 0) (s1 - s0)²/8                     (N4)

where M bounds the second derivative of n·p for all points p of a piece. What (N4) does not decide is halved.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import slot_of
from assur.planner.checker.claim.motion import rounding
from assur.planner.checker.claim.obligations import pair_of, required_gap
from assur.planner.checker.claim.solids import derivative_bound, solid_reach
from assur.planner.checker.claim.tables import F1, F2, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types

SHOWN, WRONG, HALVE_TIME, HALVE_AHEAD = range(4)
"""What (N4) says of a row on an interval: it holds; it is wrong; or which interval must be halved."""


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, F1, i8, i8, i8, f8))
def place_side(k: Claim, g: tb.Geometry, about: FloatArray, at: int, p: int, body: int, piece: float) -> None:
    """Writes one side of what a row is about: a body in a phase, and its piece (-1: the box that holds all)."""
    s = int(k.seated[p, body])
    link, f = int(k.seats[s, c.SEAT_LINK]), int(k.seats[s, c.SEAT_FRAME])
    about[at + tb.SIDE_SOLID] = g.first[s, 0] + (piece if piece >= 0.0 else k.bodies[body, c.BODY_PIECES])
    about[at + tb.SIDE_CARRIER] = link if link >= 0 else g.on[f, 0]
    about[at + tb.SIDE_SEAT] = s


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, tb.PROOF))
def resolve(k: Claim, g: tb.Geometry, proof: tb.Proof) -> None:
    """Writes what each row is about. A row that no pair needs, or that is not within one phase, gets no pair."""
    for i in range(len(proof.rows)):
        row, about, p, number = proof.rows[i], proof.objects[i], -1, -1
        about[tb.OBJECT_PAIR] = about[tb.OBJECT_PLANE] = -1.0
        for q in range(len(k.phases)):
            if k.phases[q, c.PHASE_T0] <= row[c.ROW_T0]:
                p = q
        if p < 0 or not row[c.ROW_T1] <= k.phases[p, c.PHASE_T1]:
            continue
        a, b = int(row[c.ROW_BODY]), int(row[c.ROW_BODY + 1])
        if b >= 0:
            number = pair_of(proof, p, a, b) if a != b else -1
            if number < 0 or not proof.pairs[number, tb.PAIR_NEEDED] > 0.0:
                continue
            own = proof.pairs[number]
            # who is ahead of whom counts: such a row has its bodies in the order of the pair
            if (own[tb.PAIR_EARLY] != 0.0 or own[tb.PAIR_LATE] != 0.0) and int(own[tb.PAIR_A]) != a:
                continue
        x, y, z = row[c.ROW_NORMAL], row[c.ROW_NORMAL + 1], row[c.ROW_NORMAL + 2]
        largest = max(abs(x), abs(y), abs(z))
        if not largest > 0.0:
            continue
        x, y, z = x / largest, y / largest, z / largest
        size, n = math.sqrt(x * x + y * y + z * z), tb.OBJECT_NORMAL
        about[n], about[n + 1], about[n + 2] = x / size, y / size, z / size
        place_side(k, g, about, 0, p, a, row[c.ROW_PIECE])
        if b < 0:
            about[tb.OBJECT_PLANE] = p
            continue
        place_side(k, g, about, tb.SIDES, p, b, row[c.ROW_PIECE + 1])
        about[tb.OBJECT_PAIR] = number
        proof.state[tb.ROWS] += 1.0


@kernel(i8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, F1, f8, f8, f8, f8), inline=True)
def row_on(
    k: Claim,
    g: tb.Geometry,
    s: tb.Scratch,
    about: FloatArray,
    pair: FloatArray,
    t0: float,
    t1: float,
    s0: float,
    s1: float,
) -> int:
    """What (N4) says of a row on [t0, t1], with the second body ahead of the clock by s0 to s1."""
    normal, one, on = about[tb.OBJECT_NORMAL :], int(about[tb.SIDE_SOLID]), int(about[tb.SIDE_CARRIER])
    other, other_on = int(about[tb.SIDES + tb.SIDE_SOLID]), int(about[tb.SIDES + tb.SIDE_CARRIER])
    if int(k.seats[int(about[tb.SIDES + tb.SIDE_SEAT]), c.SEAT_LINK]) >= 0:
        s0, s1 = 0.0, 0.0
    gap, wide = math.inf, HALVE_AHEAD if s1 - s0 > t1 - t0 else HALVE_TIME
    for end in range(2 if t1 > t0 else 1):
        t = t0 if end == 0 else t1
        slot = slot_of(k, g, s, on, t, t)
        if slot < 0:
            return WRONG if slot == -1 - tb.NOT_GIVEN else wide
        reach = solid_reach(g, s.jets, slot, one, on, normal, 1.0)
        for edge in range(2 if s1 > s0 else 1):
            ahead = t + (s0 if edge == 0 else s1)
            slot = slot_of(k, g, s, other_on, ahead, ahead)
            if slot < 0:
                return WRONG if slot == -1 - tb.NOT_GIVEN else wide
            gap = min(gap, -reach - solid_reach(g, s.jets, slot, other, other_on, normal, -1.0))
    gap -= required_gap(k, g, s, about, pair, t0, t1) + tb.SLACK
    if not gap >= 0.0:
        return HALVE_TIME if pair[tb.PAIR_VARIES] > 0.0 else WRONG
    # sums of times are rounded: the interval is longer by an ulp on either side
    low = t0 + s0 if s0 == 0.0 else np.nextafter(t0 + s0, -np.inf)
    high = t1 + s1 if s1 == 0.0 else np.nextafter(t1 + s1, np.inf)
    if not high > low:
        return SHOWN
    bend, other_bend = 0.0, 0.0
    if t1 > t0:
        slot = slot_of(k, g, s, on, t0, t1)
        if slot < 0:
            return WRONG if slot == -1 - tb.NOT_GIVEN else wide
        bend = derivative_bound(g, s.jets, slot, 2, one, on, normal, -1.0)
        bend += rounding(g, on, 2, g.solids[one, tb.SOLID_SIZE])
    slot = slot_of(k, g, s, other_on, low, high)
    if slot < 0:
        return WRONG if slot == -1 - tb.NOT_GIVEN else wide
    if not g.carriers[other_on, tb.CARRIER_FIXED] > 0.0:
        other_bend = derivative_bound(g, s.jets, slot, 2, other, other_on, normal, 1.0)
        other_bend += rounding(g, other_on, 2, g.solids[other, tb.SOLID_SIZE])
    less_t = max(bend + other_bend, 0.0) * (t1 - t0) ** 2 / 8.0
    less_s = max(other_bend, 0.0) * (s1 - s0) ** 2 / 8.0
    if gap - less_t - less_s >= 0.0:
        return SHOWN
    return HALVE_AHEAD if s1 > s0 and (t0 == t1 or not less_t >= less_s) else HALVE_TIME


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, tb.PROOF, F2, F2))
def rows_hold(k: Claim, g: tb.Geometry, s: tb.Scratch, proof: tb.Proof, items: FloatArray, stack: FloatArray) -> bool:
    """Whether all rows of one interval hold. `items` begin with their numbers, with s0 and s1. The interval is on the
    stack: from, to, first item, last, depth. Rows that are open are halved together, so that carriers are computed once
    for all of them."""
    top, state = 1, proof.state
    while top > 0:
        top -= 1
        t0, t1, depth = stack[top, 0], stack[top, 1], int(stack[top, 4])
        first, end = int(stack[top, 2]), int(stack[top, 3])
        left, middle = end, 0.5 * (t0 + t1)
        for i in range(first, end):
            row, s0, s1 = int(items[i, 0]), items[i, 1], items[i, 2]
            about = proof.objects[row]
            for side in (0, tb.SIDES):
                corners = g.solids[int(about[side + tb.SIDE_SOLID]), tb.SOLID_VERTICES]
                state[tb.WORK] -= 0.5 + (corners + len(k.displaced)) / 50.0
            if not state[tb.WORK] > 0.1 * s.work[tb.TOUCHED]:
                state[tb.FAILED] = row
                return False
            answer = row_on(k, g, s, about, proof.pairs[int(about[tb.OBJECT_PAIR])], t0, t1, s0, s1)
            if answer == SHOWN:
                continue
            if answer == WRONG or depth >= tb.DEEPEST or left + 2 > len(items) or (t0 == t1 and answer == HALVE_TIME):
                state[tb.FAILED] = row
                return False
            state[tb.HALVINGS], state[tb.DEPTH] = state[tb.HALVINGS] + 1.0, max(state[tb.DEPTH], depth + 1.0)
            half = 0.5 * (s0 + s1)
            items[left, 0], items[left, 1], items[left, 2] = row, s0, half if answer == HALVE_AHEAD else s1
            left += 1
            if answer == HALVE_AHEAD:
                items[left, 0], items[left, 1], items[left, 2] = row, half, s1
                left += 1
        for part in range((2 if t1 > t0 else 1) if left > end else 0):
            stack[top, 0], stack[top, 1] = (t0, middle) if part == 1 else (middle, t1)
            stack[top, 2], stack[top, 3], stack[top, 4] = end, left, depth + 1
            top += 1
    return True


@kernel(i8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, tb.PROOF), allocates=True)
def first_wrong_row(k: Claim, g: tb.Geometry, s: tb.Scratch, proof: tb.Proof) -> int:
    """The first row that does not hold, in the order of begins and ends; -1: all hold. Rows of the same interval are
    evaluated together."""
    rows, longest, many = len(proof.rows), 1, 0
    for n in range(rows):
        one, other = proof.rows[proof.order[n]], proof.rows[proof.order[max(n - 1, 0)]]
        many = many + 1 if one[c.ROW_T0] == other[c.ROW_T0] and one[c.ROW_T1] == other[c.ROW_T1] else 1
        longest = max(longest, many)
    items, stack, many = np.empty((8 * longest + 256, 3)), np.empty((2 * tb.DEEPEST + 8, 5)), 0
    for n in range(rows):
        i = proof.order[n]
        row, beyond = proof.rows[i], proof.rows[proof.order[min(n + 1, rows - 1)]]
        if proof.objects[i, tb.OBJECT_PAIR] >= 0.0:
            items[many, 0], items[many, 1], items[many, 2] = i, row[c.ROW_S0], row[c.ROW_S1]
            many += 1
        last = n + 1 == rows or beyond[c.ROW_T0] != row[c.ROW_T0] or beyond[c.ROW_T1] != row[c.ROW_T1]
        if last and many > 0:
            stack[0, 0], stack[0, 1], stack[0, 2], stack[0, 3], stack[0, 4] = row[c.ROW_T0], row[c.ROW_T1], 0, many, 0
            if not rows_hold(k, g, s, proof, items, stack):
                return int(proof.state[tb.FAILED])
            many = 0
    return -1


@kernel(types.boolean(tb.CLAIM, tb.PROOF, i8, F2), inline=True)
def covers_phase(k: Claim, proof: tb.Proof, d: int, reached: FloatArray) -> bool:
    """Whether the rows of pair d cover all of its phase, for all times by which one body may be ahead. Times are
    compared as they are. `reached`: room for (pieces, pieces) of both bodies."""
    pair, rows, links, state = proof.pairs[d], proof.rows, proof.links, proof.state
    p, a, low = int(pair[tb.PAIR_PHASE]), int(pair[tb.PAIR_A]), pair[tb.PAIR_EARLY]
    begin, end, one = k.phases[p, c.PHASE_T0], k.phases[p, c.PHASE_T1], int(k.bodies[a, c.BODY_PIECES])
    other = int(k.bodies[int(pair[tb.PAIR_B]), c.BODY_PIECES])
    while True:
        high, i, whole = pair[tb.PAIR_LATE], proof.heads[d], begin
        while i >= 0:
            for edge in (rows[links[i, 0], c.ROW_S0], rows[links[i, 0], c.ROW_S1]):
                if low < edge < high:
                    high = edge
            state[tb.WORK] -= 0.1
            i = links[i, 1]
        # rows of all pieces first; those of single pieces only where these do not reach
        for single in range(2):
            if single == 1 and whole >= end:
                break
            reached[:one, :other] = begin
            state[tb.WORK] -= 0.01 * one * other
            if not state[tb.WORK] > 0.0:
                return False
            i = proof.heads[d]
            while i >= 0:
                row = rows[links[i, 0]]
                side = 0 if int(row[c.ROW_BODY]) == a else 1
                j, m = int(row[c.ROW_PIECE + side]), int(row[c.ROW_PIECE + 1 - side])
                if row[c.ROW_S0] <= low and high <= row[c.ROW_S1]:
                    if (j < 0 or one == 1) and (m < 0 or other == 1) and row[c.ROW_T0] <= whole:
                        whole = max(whole, row[c.ROW_T1])
                    for u in range((0 if j < 0 else j) if single == 1 else one, one if j < 0 else j + 1):
                        state[tb.WORK] -= 0.01 * other
                        for v in range(0 if m < 0 else m, other if m < 0 else m + 1):
                            if row[c.ROW_T0] <= reached[u, v]:
                                reached[u, v] = max(reached[u, v], row[c.ROW_T1])
                i = links[i, 1]
        for u in range(one if not whole >= end else 0):
            for v in range(other):
                if not reached[u, v] >= end:
                    return False
        if not high < pair[tb.PAIR_LATE]:
            return True
        low = high


@kernel(types.void(tb.PROOF, i8, i8, i8))
def add_link(proof: tb.Proof, at: int, row: int, pair: int) -> None:
    """Puts a row before the other rows of a pair, in link `at`."""
    proof.links[at, 0], proof.links[at, 1], proof.heads[pair] = row, proof.heads[pair], at


@kernel(i8(tb.CLAIM, tb.PROOF, i8), allocates=True)
def first_uncovered(k: Claim, proof: tb.Proof, after: int) -> int:
    """The first pair after row `after` of the pairs whose phase is not covered by its rows; -1: none."""
    most = 1
    for b in range(len(k.bodies)):
        most = max(most, int(k.bodies[b, c.BODY_PIECES]))
    reached = np.empty((most, most))
    for d in range(after + 1, int(proof.state[tb.PAIRS])):
        p = int(proof.pairs[d, tb.PAIR_PHASE])
        counts = proof.pairs[d, tb.PAIR_NEEDED] > 0.0 and k.phases[p, c.PHASE_T1] > k.phases[p, c.PHASE_T0]
        if counts and not covers_phase(k, proof, d, reached):
            return d
    return -1
