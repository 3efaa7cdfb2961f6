"""Which pairs of bodies must keep apart in each phase, how far, and by how much one may be ahead of the clock."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import IntArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.tables import I1, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types


@kernel(f8(f8, f8))
def sum_down(a: float, b: float) -> float:
    """A double that is no more than the exact sum: the rounding of a sum is a double itself."""
    s = a + b
    x = s - a
    return np.nextafter(s, -np.inf) if (a - (s - x)) + (b - x) < 0.0 else s


@kernel(i8(tb.CLAIM, I1))
def number_bodies(k: Claim, numbers: IntArray) -> int:
    """Numbers the bodies that are on a link or put down in some phase; the others keep -1. Returns how many."""
    many = 0
    for p in range(len(k.phases)):
        for b in range(len(k.bodies)):
            if numbers[b] < 0 and k.seats[int(k.seated[p, b]), c.SEAT_LINK] >= 0.0:
                numbers[b], many = many, many + 1
    for i in range(len(k.put_down)):
        b = int(k.put_down[i, c.PUT_BODY])
        if numbers[b] < 0:
            numbers[b], many = many, many + 1
    return many


@kernel(i8(tb.PROOF, i8, i8, i8))
def pair_of(proof: tb.Proof, p: int, a: int, b: int) -> int:
    """The row in `pairs` of two bodies in a phase; -1: they need not keep apart."""
    one, other = proof.numbers[a], proof.numbers[b]
    if one >= 0:
        return int(proof.table[p, one, b])
    return int(proof.table[p, other, a]) if other >= 0 else -1


@kernel(types.void(tb.CLAIM, tb.PROOF, i8, i8, i8, i8, f8, f8))
def add_pair(k: Claim, proof: tb.Proof, p: int, a: int, b: int, near: int, early: float, late: float) -> None:
    """Adds a pair of bodies, unless the phase has it. Of the rules that name it the last counts."""
    if pair_of(proof, p, a, b) >= 0:
        return
    least, n = k.required[0, c.REQUIRED_NEAR if near > 0 else c.REQUIRED_TRAVEL], len(k.bodies)
    for i in range(len(k.rules)):
        rule, one, other = k.rules[i], c.RULE_SIDE, c.RULE_SIDE + n
        if (rule[one + a] > 0.0 and rule[other + b] > 0.0) or (rule[one + b] > 0.0 and rule[other + a] > 0.0):
            least = rule[c.RULE_NEAR if near > 0 else c.RULE_TRAVEL]
    count = int(proof.state[tb.PAIRS])
    pair = proof.pairs[count]
    pair[tb.PAIR_PHASE], pair[tb.PAIR_A], pair[tb.PAIR_B], pair[tb.PAIR_DISTANCE] = p, a, b, least
    pair[tb.PAIR_EARLY], pair[tb.PAIR_LATE], pair[tb.PAIR_VARIES] = early, late, proof.state[tb.VARIES]
    pair[tb.PAIR_TOUCHES], pair[tb.PAIR_CERTAIN], pair[tb.PAIR_NEEDED] = 0.0, 0.0, 1.0
    if proof.numbers[a] >= 0:
        proof.table[p, proof.numbers[a], b] = count
    if proof.numbers[b] >= 0:
        proof.table[p, proof.numbers[b], a] = count
    proof.state[tb.PAIRS] += 1.0


@kernel(types.boolean(tb.GEOMETRY, i8))
def is_fixed(g: tb.Geometry, f: int) -> bool:
    """Whether a frame never moves."""
    return bool(g.carriers[int(g.on[f, 0]), tb.CARRIER_FIXED] > 0.0)


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, tb.PROOF, i8))
def add_robot_pairs(k: Claim, g: tb.Geometry, proof: tb.Proof, p: int) -> None:
    """Adds the pairs of a phase that hold a body on a link: with each body on a frame, and with bodies on those links
    that must keep apart from its own."""
    near, bodies = int(k.phases[p, c.PHASE_NEAR]), len(k.bodies)
    for a in range(bodies):
        one = int(k.seats[int(k.seated[p, a]), c.SEAT_LINK])
        for b in range(bodies if one >= 0 else 0):
            seat = k.seats[int(k.seated[p, b])]
            other, f = int(seat[c.SEAT_LINK]), int(seat[c.SEAT_FRAME])
            if other < 0:
                early, late = 0.0, 0.0
                if not is_fixed(g, f):
                    early = -k.frames[f, c.FRAME_SHIFT + 1]
                    late = -sum_down(k.frames[f, c.FRAME_SHIFT], -k.required[0, c.REQUIRED_LATE])
                add_pair(k, proof, p, a, b, near, early, late)
            elif a < b and one != other and k.self_pairs[one, other] > 0.0:
                add_pair(k, proof, p, a, b, near, 0.0, 0.0)


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, tb.PROOF, i8))
def add_put_down(k: Claim, g: tb.Geometry, proof: tb.Proof, i: int) -> None:
    """Adds the pairs of row i of the parts that were put down: with each body on another frame, if one of both frames
    moves and the body is no support of the part."""
    p, a, bodies = int(k.put_down[i, c.PUT_PHASE]), int(k.put_down[i, c.PUT_BODY]), len(k.bodies)
    here = int(k.seats[int(k.seated[p, a]), c.SEAT_FRAME])
    for b in range(bodies if here >= 0 else 0):
        there = int(k.seats[int(k.seated[p, b]), c.SEAT_FRAME])
        if there < 0 or there == here or k.supports[i, b] > 0.0 or (is_fixed(g, here) and is_fixed(g, there)):
            continue
        early, late = 0.0, 0.0
        if not is_fixed(g, there):
            moves = 0.0 if is_fixed(g, here) else 1.0
            early = sum_down(-k.frames[there, c.FRAME_SHIFT + 1], moves * k.frames[here, c.FRAME_SHIFT])
            late = -sum_down(k.frames[there, c.FRAME_SHIFT], -moves * k.frames[here, c.FRAME_SHIFT + 1])
        add_pair(k, proof, p, a, b, 1, early, late)


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, tb.PROOF))
def make_pairs(k: Claim, g: tb.Geometry, proof: tb.Proof) -> None:
    """Writes the pairs of all phases to `proof`, whose `table` holds -1."""
    for j in range(c.REQUIRED_LAG, c.REQUIRED_LAG + c.MOST_JOINTS):
        proof.state[tb.VARIES] = max(proof.state[tb.VARIES], k.required[0, j])
    for row in k.displaced:
        proof.state[tb.VARIES] = max(proof.state[tb.VARIES], row[c.DISPLACED_GROWTH], row[c.DISPLACED_SHARED])
    for p in range(len(k.phases)):
        if k.phases[p, c.PHASE_ROBOT] > 0.0:
            add_robot_pairs(k, g, proof, p)
        for i in range(len(k.put_down)):
            if int(k.put_down[i, c.PUT_PHASE]) == p:
                add_put_down(k, g, proof, i)
    for i in range(len(k.contacts)):
        contact = k.contacts[i]
        a, b = int(contact[c.CONTACT_BODY]), int(contact[c.CONTACT_BODY + 1])
        pair = pair_of(proof, int(contact[c.CONTACT_PHASE]), a, b)
        if pair >= 0:
            proof.pairs[pair, tb.PAIR_DISTANCE], proof.pairs[pair, tb.PAIR_TOUCHES] = -contact[c.CONTACT_DEPTH], 1.0


@kernel(i8(tb.CLAIM, tb.PROOF))
def require_second(k: Claim, proof: tb.Proof) -> int:
    """Makes the distance of each pair the second one, with nothing uncertain: of a pair with a body on a link, and of a
    pair of two bodies on frames. Pairs that may touch, or of which nothing is claimed, are not needed. Returns the
    first pair that must not exist; -1: none."""
    for d in range(int(proof.state[tb.PAIRS])):
        pair = proof.pairs[d]
        p, a, b = int(pair[tb.PAIR_PHASE]), int(pair[tb.PAIR_A]), int(pair[tb.PAIR_B])
        link = max(k.seats[int(k.seated[p, a]), c.SEAT_LINK], k.seats[int(k.seated[p, b]), c.SEAT_LINK])
        least = k.required[0, c.REQUIRED_NEAREST if link >= 0.0 else c.REQUIRED_PLACED]
        pair[tb.PAIR_DISTANCE], pair[tb.PAIR_EARLY], pair[tb.PAIR_LATE], pair[tb.PAIR_VARIES] = least, 0.0, 0.0, 0.0
        pair[tb.PAIR_CERTAIN], pair[tb.PAIR_NEEDED] = 1.0, 0.0 if pair[tb.PAIR_TOUCHES] > 0.0 or least < 0.0 else 1.0
        if pair[tb.PAIR_NEEDED] > 0.0 and least >= c.LIMITLESS:
            return d
    return -1
