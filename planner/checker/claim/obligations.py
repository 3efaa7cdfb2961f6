"""Which pairs of bodies must keep apart in each phase, how far, and by how much one may be ahead of the clock."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.chain import chain
from assur.planner.checker.claim.motion import joints_over, rounding
from assur.planner.checker.claim.solids import derivative_bound, length, turned
from assur.planner.checker.claim.tables import BALL, F1, I1, f8, i8
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
    pair of two bodies on frames. Pairs that may touch, or without a claim, are not needed. Returns the first
    pair that must not exist; -1: none."""
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


# How much nearer what is uncertain may bring two bodies (N8): displaced frames, lagging joints, belt corrections.


@kernel(types.UniTuple(f8, 3)(tb.CLAIM, f8, tb.SCRATCH))
def correction_turns(k: Claim, shift: float, s: tb.Scratch) -> tuple[float, float, float]:
    """By how much the two upright links that carry the tool of the robot turn if the tool is shifted by up to `shift`
    (m, N10): the length of the first, m, and the greatest turn of both, rad, for `s.joints` with their lag.
    Infinite: the arm may be stretched or folded, or the tool is not carried by two such links."""
    none, tool, required = (math.inf, math.inf, math.inf), int(k.required[0, c.REQUIRED_TOOL]), k.required[0]
    if tool < 3 or int(k.arms[0, c.ARM_JOINTS]) != 4 or int(k.arms[0, c.ARM_LINKS]) <= tool:
        return none
    first, second, last = k.links[1], k.links[2], k.links[tool]
    plain = first[c.LINK_PARENT] == 0.0 and second[c.LINK_PARENT] == 1.0 and last[c.LINK_PARENT] == 2.0
    for link in (first, second):
        plain = plain and link[c.LINK_PITCH] < 0.0 and link[c.LINK_COUPLER] < 0.0
    one, other = k.angles[int(first[c.LINK_YAW])], k.angles[int(second[c.LINK_YAW])]
    for j in range(c.MOST_JOINTS):
        plain = plain and one[c.ANGLE_SHARE + j] == (1.0 if j < 1 else 0.0)
        plain = plain and other[c.ANGLE_SHARE + j] == (1.0 if j < 2 else 0.0)
    a, b = second[c.LINK_OFFSET], last[c.LINK_OFFSET]
    for link in (second, last):
        plain = plain and link[c.LINK_OFFSET + 1] == 0.0
        plain = plain and (link[c.LINK_SLIDE] < 0.0 or (link[c.LINK_AXIS] == 0.0 and link[c.LINK_AXIS + 1] == 0.0))
    if not (plain and a > 0.0 and b > 0.0):
        return none
    # the angle between both links is the difference of their yaws, whose constants may differ
    constant, lag = other[c.ANGLE_CONSTANT] - one[c.ANGLE_CONSTANT], required[c.REQUIRED_LAG + 1]
    elbow = turned((s.joints[1, 0] + constant, s.joints[1, 1] + lag, 0.0, 0.0, 0.0, 0.0))[0]
    low, high = a * a + b * b + 2.0 * a * b * (elbow[0] - elbow[1]), a * a + b * b + 2.0 * a * b * (elbow[0] + elbow[1])
    near, far, square = (
        math.sqrt(max(low, 0.0)) - shift - tb.SLACK,
        math.sqrt(max(high, 0.0)) + shift + tb.SLACK,
        math.inf,
    )
    if not (near > abs(a - b) and far < a + b):
        return none
    for radius in (near, far):
        cosine = (radius * radius - a * a - b * b) / (2.0 * a * b)
        square = min(square, 1.0 - cosine * cosine)
    if not square > tb.SLACK:
        return none
    sine = math.sqrt(square)
    return a, shift / (a * sine), shift / (b * sine)


@kernel(f8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, i8, f8, f8))
def lag_displacement(
    k: Claim, g: tb.Geometry, s: tb.Scratch, about: FloatArray, side: int, t0: float, t1: float
) -> float:
    """By how much lagging joints may bring one side of a row nearer along its normal over [t0, t1], m: the sum of lags
    times the rates of its points at a rate of one of that joint alone, for all joint values within their lag. These
    jets are in the slots behind those of instants and intervals. Infinite: they are not known."""
    first, n, total = tb.INSTANTS + tb.INTERVALS, int(k.arms[0, c.ARM_JOINTS]), 0.0
    solid, on, known = int(about[side + tb.SIDE_SOLID]), int(about[side + tb.SIDE_CARRIER]), s.known[first, 0]
    normal = about[tb.OBJECT_NORMAL :]
    if not (known[0] == t0 and known[1] == t1):
        known[0], known[1], known[2] = t0, t1, tb.KNOWN if joints_over(g, 0, n, t0, t1, s) else tb.NOT_GIVEN
        for j in range(n):
            s.joints[j, 1] += k.required[0, c.REQUIRED_LAG + j]
            s.joints[j, 2:] = 0.0
        for j in range(n):
            if known[2] == tb.KNOWN and k.required[0, c.REQUIRED_LAG + j] > 0.0:
                s.joints[j, 2] = 1.0
                known[2] = tb.KNOWN if chain(k, g, 0, s.jets[first + j], s) else tb.TOO_WIDE
                s.joints[j, 2] = 0.0
    for j in range(n):
        lag = k.required[0, c.REQUIRED_LAG + j]
        if lag > 0.0 and known[2] == tb.KNOWN:
            one = derivative_bound(g, s.jets, first + j, 1, solid, on, normal, 1.0)
            other = derivative_bound(g, s.jets, first + j, 1, solid, on, normal, -1.0)
            total += lag * max(one, other, 0.0)
    return float(total) if known[2] == tb.KNOWN else math.inf


@kernel(f8(tb.CLAIM, i8, f8))
def amount_of(k: Claim, i: int, t: float) -> float:
    """How large displacement i may be at t, as the robot may be late, m."""
    lasts = max(t + k.required[0, c.REQUIRED_LATE] - k.required[0, c.REQUIRED_SINCE], 0.0)
    return float(k.displaced[i, c.DISPLACED_AMOUNT] + k.displaced[i, c.DISPLACED_GROWTH] * lasts)


@kernel(BALL(tb.CLAIM, i8, i8))
def share_of(k: Claim, p: int, i: int) -> tuple[float, float]:
    """The least and the greatest share of the tool in displacement i in a phase."""
    f = int(k.displaced[i, c.DISPLACED_FRAME])
    if not k.displaced[i, c.DISPLACED_SHARED] > 0.0:
        return 0.0, 0.0
    return k.shares[p, f], k.shares[p, len(k.frames) + f]


@kernel(f8(tb.CLAIM, i8, f8))
def correction_shift(k: Claim, p: int, t: float) -> float:
    """By how much corrections may shift the tool in a phase until t, m."""
    shift = 0.0
    for i in range(len(k.displaced)):
        least, most = share_of(k, p, i)
        # a direction that is longer than 1 makes the displacement longer
        far = max(1.0, length(k.displaced[i], c.DISPLACED_DIRECTION, c.DISPLACED_DIRECTION + 3))
        shift += max(abs(least), abs(most)) * amount_of(k, i, t) * far
    return shift


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, i8, f8, f8))
def corrected_within(k: Claim, g: tb.Geometry, s: tb.Scratch, p: int, t0: float, t1: float) -> bool:
    """Whether joints keep their ranges over [t0, t1] of a phase while corrections shift the tool (N10): the first three
    that turn, by the turns of both links and by how much the tool turns back."""
    shift = correction_shift(k, p, t1)
    if shift == 0.0:
        return True
    if not joints_over(g, 0, int(k.arms[0, c.ARM_JOINTS]), t0, t1, s):
        return False
    _, first, second = correction_turns(k, shift, s)
    for i in range(len(k.limits)):
        own = k.limits[i]
        if not (own[c.LIMIT_T0] < t1 and t0 < own[c.LIMIT_T1]):
            continue
        for j in range(int(k.arms[0, c.ARM_JOINTS])):
            more = first if j == 0 else first + second if j == 1 else second if j == 3 else 0.0
            low, high = own[c.LIMIT_LOWER + j], own[c.LIMIT_UPPER + j]
            most = 0.5 * (high - low) * (1.0 + own[c.LIMIT_SHARE]) - g.rounds[0, tb.ROUND_TURN]
            if not abs(s.joints[j, 0] - 0.5 * (low + high)) + s.joints[j, 1] + more <= most:
                return False
    return True


@kernel(f8(tb.CLAIM, F1, i8, f8), inline=True)
def displaced_gap(k: Claim, about: FloatArray, p: int, t: float) -> float:
    """By how much displacements of frames may bring both bodies of a row nearer along its normal until t, m."""
    first, total, normal = k.required[0, c.REQUIRED_TOOL], 0.0, about[tb.OBJECT_NORMAL :]
    one, other = k.seats[int(about[tb.SIDE_SEAT])], k.seats[int(about[tb.SIDES + tb.SIDE_SEAT])]
    tool, other_tool = one[c.SEAT_LINK] >= first, other[c.SEAT_LINK] >= first
    for i in range(len(k.displaced) if not (tool and other_tool) else 0):
        own, f, (low, high) = k.displaced[i], k.displaced[i, c.DISPLACED_FRAME], share_of(k, p, i)
        least, most = (1.0, 1.0) if one[c.SEAT_FRAME] == f else (low, high) if tool else (0.0, 0.0)
        other_least, other_most = (1.0, 1.0) if other[c.SEAT_FRAME] == f else (low, high) if other_tool else (0.0, 0.0)
        share, d = max(abs(most - other_least), abs(other_most - least)), c.DISPLACED_DIRECTION
        if share > 0.0:
            along = abs(normal[0] * own[d] + normal[1] * own[d + 1] + normal[2] * own[d + 2])
            along = length(normal, 0, 2) if own[c.DISPLACED_LEVEL] > 0.0 else along
            total += share * amount_of(k, i, t) * along
    return float(total)


@kernel(f8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, i8, i8, f8, f8), inline=True)
def own_gap(
    k: Claim, g: tb.Geometry, s: tb.Scratch, about: FloatArray, side: int, p: int, t0: float, t1: float
) -> float:
    """How far one side of a row may be off along its normal over [t0, t1], m, but for displacements that it may share
    with the other side: where it is on its seat, turns of its frame, lag, corrections. Infinite: it is not known."""
    seat, n = k.seats[int(about[side + tb.SIDE_SEAT])], int(k.arms[0, c.ARM_JOINTS])
    body, f, link = int(seat[c.SEAT_BODY]), int(seat[c.SEAT_FRAME]), int(seat[c.SEAT_LINK])
    flat = length(about, tb.OBJECT_NORMAL, tb.OBJECT_NORMAL + 2)
    reach = g.solids[int(about[side + tb.SIDE_SOLID]), tb.SOLID_REACH]
    total = k.off[p, body] * flat + k.off[p, len(k.bodies) + body] * abs(about[tb.OBJECT_NORMAL + 2])
    if f >= 0:
        return float(total + k.frames[f, c.FRAME_YAW] * reach * flat)
    if len(s.jets) > tb.INSTANTS + tb.INTERVALS:  # joints lag
        total += lag_displacement(k, g, s, about, side, t0, t1)
    if 0 < link < int(k.required[0, c.REQUIRED_TOOL]):
        shift = correction_shift(k, p, t1)
        if shift > 0.0:
            if link > 2 or not joints_over(g, 0, n, t0, t1, s):
                return math.inf
            inner, first, second = correction_turns(k, shift, s)
            total += flat * (reach * first if link == 1 else inner * first + reach * second)
    return float(total)


@kernel(f8(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, F1, F1, f8, f8), inline=True)
def required_gap(
    k: Claim, g: tb.Geometry, s: tb.Scratch, about: FloatArray, pair: FloatArray, t0: float, t1: float
) -> float:
    """The gap along a unit normal that is required over [t0, t1], m, with what is uncertain of both bodies (N8) and
    what their places round by. Infinite: it is not known."""
    total, p = pair[tb.PAIR_DISTANCE], int(pair[tb.PAIR_PHASE])
    for side in (0, tb.SIDES):
        size = g.solids[int(about[side + tb.SIDE_SOLID]), tb.SOLID_SIZE]
        total += rounding(g, int(about[side + tb.SIDE_CARRIER]), 0, size)
        if not pair[tb.PAIR_CERTAIN] > 0.0:
            total += own_gap(k, g, s, about, side, p, t0, t1)
    if not pair[tb.PAIR_CERTAIN] > 0.0:
        total += displaced_gap(k, about, p, t1)
    return float(total)
