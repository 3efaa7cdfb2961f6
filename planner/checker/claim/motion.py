"""The motions of a claim as polynomials, bounds of their rounding, and the joints over an interval of time.

A *carrier* is a link or a frame: what bodies sit on. Joints are quintics between knots (N5). Frames have accelerations
that are integrated twice (N6). Numbers like (N5) label equations in docs/bundle.md; (R1) to (R6) are labels of
docs/claim-check.md.
"""

from __future__ import annotations

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.solids import Jet, joined, polynomial
from assur.planner.checker.claim.tables import F1, F2, JET, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types

BEYOND_S = 1.0
"""So long before and after the phases, lateness included, frames may be evaluated, s: sums of times are rounded."""
ERRORS = 5
"""Columns of the errors of an angle, a joint or a coordinate of a frame: by how much value, rate and second derivative
round, and how large both rates are at most."""


@kernel(types.UniTuple(f8, 3)(F1))
def turn_errors(errors: FloatArray) -> tuple[float, float, float]:
    """What errors of an angle do to a vector of length 1 that turns, and to its derivatives (R3)."""
    e0, e1, e2, rate, second = errors[0], errors[1], errors[2], errors[3], errors[4]
    return e0, e1 + rate * e0, e2 + 2.0 * rate * e1 + (second + rate * rate) * e0


@kernel(types.void(tb.CLAIM, i8, f8, F1))
def through_loop(k: Claim, loop: int, size: float, errors: FloatArray) -> None:
    """Makes errors of angles of cranks up to `size` (m) apart those of the couplers of their loop (R4)."""
    own = k.loops[loop]
    e0, e1, e2, rate, second = errors[0], errors[1], errors[2], errors[3], errors[4]
    short, long = min(own[c.LOOP_COUPLER], own[c.LOOP_COUPLER + 1]), max(own[c.LOOP_COUPLER], own[c.LOOP_COUPLER + 1])
    least, ratio = own[c.LOOP_LEAST], (size + abs(own[c.LOOP_LENGTH]) + abs(own[c.LOOP_LENGTH + 1])) / short
    slope = 1.0 + 2.0 * ratio / least
    bend, third = slope * slope / least, 1.5 * slope * slope * slope / (least * least)
    errors[0] = slope * e0 + 64.0 * tb.ULP * ratio * ratio * (1.0 + long / short) / (least * least)
    errors[1] = slope * e1 + bend * rate * e0
    errors[2] = slope * e2 + 2.0 * bend * rate * e1 + (bend * second + third * rate * rate) * e0
    errors[3], errors[4] = slope * rate, slope * second + bend * rate * rate


@kernel(types.void(F1, F1, i8, F1, i8, F1))
def quintic(one: FloatArray, other: FloatArray, j: int, row: FloatArray, at: int, errors: FloatArray) -> None:
    """Writes the powers of a joint between two knots to a row (N5). Makes `errors` no less than by how much value, rate
    and second derivative round (R1), how large both rates are, and the value."""
    h = other[0] - one[0]
    u = h * h
    x, v, p = one[c.KNOT_Q + j], one[c.KNOT_QD + j], one[c.KNOT_QDD + j]
    y, w, q = other[c.KNOT_Q + j], other[c.KNOT_QD + j], other[c.KNOT_QDD + j]
    d = y - x
    row[at], row[at + 1], row[at + 2] = x, v, 0.5 * p
    row[at + 3] = (20.0 * d - (8.0 * w + 12.0 * v) * h - (3.0 * p - q) * u) / (2.0 * h * u)
    row[at + 4] = (-30.0 * d + (14.0 * w + 16.0 * v) * h + (3.0 * p - 2.0 * q) * u) / (2.0 * u * u)
    row[at + 5] = (12.0 * d - 6.0 * (v + w) * h + (q - p) * u) / (2.0 * h * u * u)
    a, b, e = abs(row[at + 3]) * h, abs(row[at + 4]) * u, abs(row[at + 5]) * h * u
    value = abs(x) + abs(v) * h + 0.5 * abs(p) * u + (a + b + e) * u
    rate = abs(v) + abs(p) * h + (3.0 * a + 4.0 * b + 5.0 * e) * h
    second, jerk = abs(p) + 6.0 * a + 12.0 * b + 20.0 * e, (6.0 * a + 24.0 * b + 60.0 * e) / h
    # the terms of the three highest powers, which cancel each other in part
    terms = 31.0 * abs(d) + 19.0 * (abs(v) + abs(w)) * h + 4.0 * (abs(p) + abs(q)) * u
    errors[0] = max(tb.ULP * (10.0 * abs(x) + 10.0 * terms + 2.0 * h * rate), errors[0])
    errors[1] = max(tb.ULP * (10.0 * abs(v) + 60.0 * terms / h + 2.0 * h * second), errors[1])
    errors[2] = max(tb.ULP * (10.0 * abs(p) + 250.0 * terms / u + 2.0 * h * jerk), errors[2])
    errors[3], errors[4], errors[5] = max(rate, errors[3]), max(second, errors[4]), max(value, errors[5])


@kernel(types.void(tb.CLAIM, i8, i8, F2, F1))
def angle_errors(k: Claim, i: int, n: int, joints: FloatArray, errors: FloatArray) -> None:
    """Makes `errors` no less than those of an angle, from those of its joints."""
    for m in range(ERRORS):
        total = tb.ULP * (4.0 + abs(k.angles[i, c.ANGLE_CONSTANT])) if m == 0 else 0.0
        for j in range(n):
            total += abs(k.angles[i, c.ANGLE_SHARE + j]) * joints[j, m]
        errors[m] = max(total, errors[m])


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, i8, tb.SCRATCH))
def round_links(k: Claim, g: tb.Geometry, a: int, s: tb.Scratch) -> None:
    """Bounds of the rounding of all links of an arm. `s.joints`: the errors of each joint, and its greatest value."""
    arm, size, turns, joints, errors, cranks = k.arms[a], 0.0, 1.0, s.joints, s.four[0, 0], s.four[0, 1]
    n, loop = int(arm[c.ARM_JOINTS]), int(arm[c.ARM_LOOP])
    links = range(int(arm[c.ARM_LINK]), int(arm[c.ARM_LINK] + arm[c.ARM_LINKS]))
    errors[:], cranks[:] = 0.0, 0.0
    for i in range(int(arm[c.ARM_ANGLE]), int(arm[c.ARM_ANGLE] + arm[c.ARM_ANGLES])):
        angle_errors(k, i, n, joints, errors)
    for i in links:
        link, parent = k.links[i], int(k.links[i, c.LINK_PARENT])
        far = abs(link[c.LINK_OFFSET]) + abs(link[c.LINK_OFFSET + 1]) + abs(link[c.LINK_OFFSET + 2])
        turns = 3.0 if link[c.LINK_PITCH] >= 0.0 else turns
        if link[c.LINK_SLIDE] >= 0.0:
            own, upright = joints[int(link[c.LINK_SLIDE])], parent < 0 or g.carriers[parent, tb.CARRIER_UPRIGHT] > 0.0
            far += abs(link[c.LINK_AXIS + 2]) * (1.0 if upright else 3.0 + own[ERRORS])
            # what turns may slide at the same time: both rates are in the second derivative
            far += (abs(link[c.LINK_AXIS]) + abs(link[c.LINK_AXIS + 1])) * (3.0 + own[ERRORS])
            for m in range(ERRORS):
                errors[m] = max(own[m], errors[m])
        size += far
        g.rounds[i, tb.ROUND_PLACE] = far + (g.rounds[parent, tb.ROUND_PLACE] if parent >= 0 else 1.0)
    if loop >= 0:
        one, other = k.links[int(k.loops[loop, c.LOOP_CRANK])], k.links[int(k.loops[loop, c.LOOP_CRANK + 1])]
        apart = 0.0
        for m in range(c.LINK_OFFSET, c.LINK_OFFSET + 3):
            apart += abs(one[m]) + abs(other[m])
        if one[c.LINK_PARENT] != other[c.LINK_PARENT] or max(one[c.LINK_SLIDE], other[c.LINK_SLIDE]) >= 0.0:
            apart = size
        angle_errors(k, int(one[c.LINK_YAW]), n, joints, cranks)
        angle_errors(k, int(other[c.LINK_YAW]), n, joints, cranks)
        through_loop(k, loop, apart, cranks)
    for m in range(ERRORS):
        errors[m] = turns * errors[m] + cranks[m]
    off = turn_errors(errors)
    for i in links:
        far = g.rounds[i, tb.ROUND_PLACE]
        for order in range(3):
            g.rounds[i, 2 * order + tb.ROUND_PLACE] = far * off[order]
            g.rounds[i, 2 * order + tb.ROUND_TURN] = off[order]


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH))
def make_curves(k: Claim, g: tb.Geometry, s: tb.Scratch) -> bool:
    """The quintics of all arms, and what their links round by. False: times of knots go back, or two knots share a time
    and differ in position or velocity (only an acceleration may jump)."""
    at = 0
    for a in range(len(k.arms)):
        first, n, begin = int(k.arms[a, c.ARM_KNOT]), int(k.arms[a, c.ARM_JOINTS]), at
        s.joints[:, :] = 0.0
        for i in range(first, first + int(k.arms[a, c.ARM_KNOTS]) - 1):
            one, other = k.knots[i], k.knots[i + 1]
            if other[0] == one[0]:
                for j in range(n):
                    if one[c.KNOT_Q + j] != other[c.KNOT_Q + j] or one[c.KNOT_QD + j] != other[c.KNOT_QD + j]:
                        return False
                continue
            if not other[0] > one[0]:
                return False
            curve, at = g.curves[at], at + 1
            curve[0], curve[1], curve[tb.CURVE_DEGREE] = one[0], other[0], tb.POWERS - 1
            for j in range(n):
                quintic(one, other, j, curve, tb.CURVE_POWER + tb.POWERS * j, s.joints[j])
        g.spans[a, 0], g.spans[a, 1] = begin, at - begin
        if at == begin:
            return False
        round_links(k, g, a, s)
    return True


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH, i8, i8, f8, f8, f8))
def integrate_piece(
    k: Claim, g: tb.Geometry, s: tb.Scratch, i: int, axis: int, h: float, counts: float, late: float
) -> None:
    """Writes the powers of a coordinate of piece i of a law (N6), and the errors of `counts` seconds of it (R2).

    `s.four[0, 0]` has value and rate as the piece begins, with what both round by; afterwards as it ends, h later.
    `late`: by how much times round, s. Rates are bounded on parts: the terms of high powers cancel each other."""
    state, law, at = s.four[0, 0], g.laws[i], tb.CURVE_POWER + tb.LAW_POWERS * axis
    law[at], law[at + 1], degree, size, speed, bend, jerk = state[0], state[1], 1, 0.0, 0.0, 0.0, 0.0
    for m in range(c.MOST_POWERS):
        a = k.laws[i, c.LAW_POWER + c.MOST_POWERS * axis + m]
        law[at + m + 2] = a / ((m + 1.0) * (m + 2.0))
        degree = m + 2 if a != 0.0 else degree
    law[tb.CURVE_DEGREE] = max(law[tb.CURVE_DEGREE], float(degree))
    ends = polynomial(law, at, degree, h, h, s.work)
    state[0], state[1], errors = ends[0], ends[2], law[tb.LAW_ERROR :]
    errors[:] = 0.0
    if not counts > 0.0:
        return
    for m in range(degree, -1, -1):
        a = abs(law[at + m])
        size = size * counts + a
        speed = speed * counts + m * a if m > 0 else speed
        bend = bend * counts + m * (m - 1.0) * a if m > 1 else bend
        jerk = jerk * counts + m * (m - 1.0) * (m - 2.0) * a if m > 2 else jerk
    share, parts = (8.0 + 2.0 * degree) * tb.ULP, max(degree - 3, 1)
    fast, sharp = 0.0, 0.0
    for part in range(parts):
        own = polynomial(law, at, degree, counts * part / parts, counts * (part + 1) / parts, s.work)
        fast, sharp = max(abs(own[2]) + own[3], fast), max(abs(own[4]) + own[5], sharp)
    fast, sharp = fast + share * speed, sharp + share * bend
    state[2], state[3] = state[2] + state[3] * counts + share * size, state[3] + share * speed
    errors[0], errors[1], errors[2] = state[2] + late * fast, state[3] + late * sharp, share * bend + late * jerk
    errors[3], errors[4] = fast, sharp


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, tb.SCRATCH))
def make_laws(k: Claim, g: tb.Geometry, s: tb.Scratch) -> bool:
    """Powers of each piece of a law, and what frames round by: errors of value and rate are carried on from piece to
    piece. Of the pieces the largest errors count. False: where a period ends and the next one begins, places or rates
    differ."""
    begin, end = k.phases[0, c.PHASE_T0], max(k.phases[len(k.phases) - 1, c.PHASE_T1], k.required[0, c.REQUIRED_UNTIL])
    early, late, state, errors, own, most = 0.0, 0.0, s.four[0, 0], s.four[0, 1], s.four[1, 0], s.four[1, 1]
    for f in range(len(k.frames)):
        early, late = max(early, k.frames[f, c.FRAME_SHIFT + 1]), max(late, -k.frames[f, c.FRAME_SHIFT])
    begin, end = begin - early - BEYOND_S, end + k.required[0, c.REQUIRED_LATE] + late + BEYOND_S
    g.times[0, 0], g.times[0, 1], latest = begin, end, max(abs(begin), abs(end))
    for f in range(len(k.frames)):
        frame, rounds, period = k.frames[f], g.rounds[len(k.links) + f], k.frames[f, c.FRAME_PERIOD]
        first, many, wave = int(frame[c.FRAME_PIECE]), int(frame[c.FRAME_PIECES]), int(frame[c.FRAME_WAVE])
        for axis in range(4):
            state[:], errors[:] = 0.0, 0.0
            state[0], state[1] = frame[c.FRAME_POSE + axis], frame[c.FRAME_RATE + axis]
            errors[0] = 32.0 * tb.ULP * abs(state[0])
            for i in range(first, first + many):
                law, h = g.laws[i], k.laws[i, c.LAW_END] - k.laws[i, c.LAW_BEGIN]
                law[0], law[1] = k.laws[i, c.LAW_BEGIN], k.laws[i, c.LAW_END]
                if period > 0.0 and i == first + many - 1:
                    h = k.laws[first, c.LAW_BEGIN] + period - law[0]
                # what is behind the last time that counts rounds nothing
                counts = h if period > 0.0 else min(h, max(end - law[0], 0.0))
                rounded = max(abs(law[0]), latest) if period > 0.0 else counts
                integrate_piece(k, g, s, i, axis, h, counts, 2.0 * tb.ULP * rounded)
            if period > 0.0:
                step, kink = frame[c.FRAME_STEP + axis], abs(state[1] - frame[c.FRAME_RATE + axis])
                jump = abs(state[0] - frame[c.FRAME_POSE + axis] - step)
                if not (jump <= tb.SLACK and kink <= tb.SLACK):
                    return False
                errors[0] += jump + kink * period
                errors[0] += 4.0 * tb.ULP * abs(step) * (1.0 + (latest + abs(g.laws[first, 0])) / period)
                errors[1] += kink
            for i in range(wave, wave + int(frame[c.FRAME_WAVES])):
                if int(k.waves[i, c.WAVE_COORDINATE]) == axis:
                    w, a = abs(k.waves[i, c.WAVE_RATE]), abs(k.waves[i, c.WAVE_AMPLITUDE])
                    e = 4.0 * tb.ULP * a * (1.0 + w * latest + abs(k.waves[i, c.WAVE_PHASE]))
                    for order in range(3):
                        errors[order] += e * w**order
                    errors[3], errors[4] = errors[3] + a * w, errors[4] + a * w * w
            errors[0] += 4.0 * tb.ULP if axis == 3 else 0.0
            most[:] = 0.0
            for i in range(first, first + max(many, 1)):
                for m in range(ERRORS):
                    own[m] = errors[m] + (g.laws[i, tb.LAW_ERROR + m] if many > 0 else 0.0)
                off = turn_errors(own) if axis == 3 else (own[0], own[1], own[2])
                for order in range(3):
                    most[order] = max(off[order], most[order])
            for order in range(3):
                rounds[2 * order + (tb.ROUND_TURN if axis == 3 else tb.ROUND_PLACE)] += most[order]
    return True


@kernel(f8(tb.GEOMETRY, i8, i8, f8))
def rounding(g: tb.Geometry, on: int, order: int, reach: float) -> float:
    """By how much the derivative of that order of a point rounds, `reach` (m) from the origin of its carrier."""
    return float(g.rounds[on, 2 * order + tb.ROUND_PLACE] + g.rounds[on, 2 * order + tb.ROUND_TURN] * reach)


@kernel(i8(F2, i8, i8, f8))
def piece_begun_at(rows: FloatArray, low: int, high: int, t: float) -> int:
    """Of the pieces `low` to `high` of a motion the last that begins at t or before."""
    while low < high:
        middle = (low + high + 1) // 2
        if rows[middle, 0] <= t:
            low = middle
        else:
            high = middle - 1
    return low


@kernel(JET(F2, i8, i8, f8, f8, F1))
def over(rows: FloatArray, i: int, at: int, t0: float, t1: float, work: FloatArray) -> Jet:
    """The jet over [t0, t1] of the coordinate whose powers begin in column `at`, from piece i and those that follow."""
    own = rows[i]
    work[tb.TOUCHED] += 1.0
    total = polynomial(own, at, int(own[tb.CURVE_DEGREE]), t0 - own[0], min(t1, own[1]) - own[0], work)
    while rows[i, 1] < t1:
        i += 1
        own = rows[i]
        work[tb.TOUCHED] += 1.0
        more = polynomial(own, at, int(own[tb.CURVE_DEGREE]), 0.0, min(t1, own[1]) - own[0], work)
        total = joined(total, more)
    return total


@kernel(types.boolean(tb.GEOMETRY, i8, i8, f8, f8, tb.SCRATCH))
def joints_over(g: tb.Geometry, arm: int, n: int, t0: float, t1: float, s: tb.Scratch) -> bool:
    """Jets of the n joints of an arm over [t0, t1], in `s.joints`. False: its motion is not given there."""
    first, rows = int(g.spans[arm, 0]), g.curves
    last = first + int(g.spans[arm, 1]) - 1
    if not (rows[first, 0] <= t0 <= t1 <= rows[last, 1]):
        return False
    i = piece_begun_at(rows, first, last, t0)
    for j in range(n):
        own = s.joints[j]
        own[0], own[1], own[2], own[3], own[4], own[5] = over(rows, i, tb.CURVE_POWER + tb.POWERS * j, t0, t1, s.work)
    return True
