"""The motions of a claim as polynomials, bounds of their rounding, and the joints over an interval of time.

A *carrier* is a link or a frame: what bodies sit on. Joints are quintics between knots (N5). Frames have accelerations
that are integrated twice (N6). Numbers like (N5) label equations in docs/bundle.md; (R1) to (R6) are labels of
docs/claim-check.md.
"""

from __future__ import annotations

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.jets import Jet, between, polynomial
from assur.planner.checker.claim.tables import F1, F2, JET, f8, i8
from assur.planner.claim import columns as c
from assur.planner.claim.columns import Claim
from assur.planner.compiled import kernel, types

BEYOND_S = 1.0
"""So long before and after the phases, lateness included, frames may be evaluated, s: sums of times are rounded."""
Errors = tuple[float, float, float, float, float]
"""By how much an angle, its rate and its second derivative round, and how large both rates are at most."""


@kernel(types.void(F1, f8, types.UniTuple(f8, 3), f8, f8))
def add_rounding(
    rounds: FloatArray, far: float, errors: tuple[float, float, float], rate: float, second: float
) -> None:
    """Adds the rounding of angles to that of a carrier whose places are up to `far` (m) from what turns (R3).

    `errors`: of the angle, its rate, its second derivative. `rate`, `second`: how large these are at most."""
    e0, e1, e2 = errors
    turns = (e0, e1 + rate * e0, e2 + 2.0 * rate * e1 + (second + rate * rate) * e0)
    for order in range(3):
        rounds[2 * order + tb.ROUND_PLACE] += far * turns[order]
        rounds[2 * order + tb.ROUND_TURN] += turns[order]


@kernel(types.UniTuple(f8, 5)(tb.CLAIM, i8, f8, types.UniTuple(f8, 5)))
def through_loop(k: Claim, loop: int, size: float, given: Errors) -> Errors:
    """What becomes of errors of an angle, its rate and second derivative, and of the sizes of these rates, on the way
    through a loop whose cranks are up to `size` (m) apart (R4)."""
    own = k.loops[loop]
    e0, e1, e2, rate, second = given
    short, long = min(own[c.LOOP_COUPLER], own[c.LOOP_COUPLER + 1]), max(own[c.LOOP_COUPLER], own[c.LOOP_COUPLER + 1])
    least, ratio = own[c.LOOP_LEAST], (size + abs(own[c.LOOP_LENGTH]) + abs(own[c.LOOP_LENGTH + 1])) / short
    slope = 1.0 + 2.0 * ratio / least
    bend, third = slope * slope / least, slope * slope * slope / (least * least)
    e2 = slope * e2 + 2.0 * bend * rate * e1 + (bend * second + third * rate * rate) * e0
    e1 = slope * e1 + bend * rate * e0
    e0 = slope * e0 + 64.0 * tb.ULP * ratio * ratio * (1.0 + long / short) / (least * least)
    return e0, e1, e2, slope * rate, slope * second + bend * rate * rate


@kernel(types.UniTuple(f8, 6)(F1, F1, i8, F1, i8))
def quintic(one: FloatArray, other: FloatArray, j: int, row: FloatArray, at: int) -> tuple[float, ...]:
    """Writes the powers of a joint between two knots to a row (N5). Returns by how much value, rate and second
    derivative round (R1), and how large they are at most."""
    h = other[0] - one[0]
    u, late = h * h, max(abs(one[0]), abs(other[0]))
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
    e0 = tb.ULP * (10.0 * abs(x) + 10.0 * terms + 2.0 * late * rate)
    e1 = tb.ULP * (10.0 * abs(v) + 60.0 * terms / h + 2.0 * late * second)
    e2 = tb.ULP * (10.0 * abs(p) + 250.0 * terms / u + 2.0 * late * jerk)
    return e0, e1, e2, value, rate, second


@kernel(types.UniTuple(f8, 5)(tb.CLAIM, i8, i8, F2))
def angle_errors(k: Claim, i: int, n: int, joints: FloatArray) -> Errors:
    """The rounding and the rates of an angle, from those of its joints."""
    e0, e1, e2, rate, second = tb.ULP * (4.0 + abs(k.angles[i, c.ANGLE_CONSTANT])), 0.0, 0.0, 0.0, 0.0
    for j in range(n):
        share, own = abs(k.angles[i, c.ANGLE_SHARE + j]), joints[j]
        e0, e1, e2 = e0 + share * own[0], e1 + share * own[1], e2 + share * own[2]
        rate, second = rate + share * own[3], second + share * own[4]
    return e0, e1, e2, rate, second


@kernel(types.UniTuple(f8, 5)(types.UniTuple(f8, 5), types.UniTuple(f8, 5)))
def largest(a: Errors, b: Errors) -> Errors:
    """The larger of both, number by number."""
    return max(a[0], b[0]), max(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3]), max(a[4], b[4])


@kernel(types.void(tb.CLAIM, tb.GEOMETRY, i8, F2))
def round_links(k: Claim, g: tb.Geometry, a: int, joints: FloatArray) -> None:
    """Bounds of the rounding of all links of an arm. `joints`: e0, e1, e2, rate, second derivative, value of each."""
    arm, size, turns, errors = k.arms[a], 0.0, 1.0, (0.0, 0.0, 0.0, 0.0, 0.0)
    n, loop = int(arm[c.ARM_JOINTS]), int(arm[c.ARM_LOOP])
    links = range(int(arm[c.ARM_LINK]), int(arm[c.ARM_LINK] + arm[c.ARM_LINKS]))
    for i in range(int(arm[c.ARM_ANGLE]), int(arm[c.ARM_ANGLE] + arm[c.ARM_ANGLES])):
        errors = largest(errors, angle_errors(k, i, n, joints))
    for i in links:
        link = k.links[i]
        size += abs(link[c.LINK_OFFSET]) + abs(link[c.LINK_OFFSET + 1]) + abs(link[c.LINK_OFFSET + 2])
        turns = 3.0 if link[c.LINK_PITCH] >= 0.0 else turns
        if link[c.LINK_SLIDE] >= 0.0:
            own = joints[int(link[c.LINK_SLIDE])]
            along = abs(link[c.LINK_AXIS]) + abs(link[c.LINK_AXIS + 1]) + abs(link[c.LINK_AXIS + 2])
            # what turns may slide at the same time: both rates are in the second derivative
            size += along * (3.0 + own[5])
            errors = largest(errors, (own[0], own[1], own[2], own[3], own[4]))
    e0, e1, e2, rate, second = errors
    e0, e1, e2, rate, second = turns * e0, turns * e1, turns * e2, turns * rate, turns * second
    if loop >= 0:
        one, other = k.links[int(k.loops[loop, c.LOOP_CRANK])], k.links[int(k.loops[loop, c.LOOP_CRANK + 1])]
        apart = 0.0
        for m in range(c.LINK_OFFSET, c.LINK_OFFSET + 3):
            apart += abs(one[m]) + abs(other[m])
        if one[c.LINK_PARENT] != other[c.LINK_PARENT] or max(one[c.LINK_SLIDE], other[c.LINK_SLIDE]) >= 0.0:
            apart = size
        cranks = angle_errors(k, int(one[c.LINK_YAW]), n, joints), angle_errors(k, int(other[c.LINK_YAW]), n, joints)
        added = through_loop(k, loop, apart, largest(cranks[0], cranks[1]))
        e0, e1, e2 = e0 + added[0], e1 + added[1], e2 + added[2]
        rate, second = rate + added[3], second + added[4]
    for i in links:
        add_rounding(g.rounds[i], 1.0 + size, (e0, e1, e2), rate, second)


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY, F2))
def make_curves(k: Claim, g: tb.Geometry, joints: FloatArray) -> bool:
    """The quintics of all arms, and what their links round by. False: times of knots go back, or two knots share a time
    and differ in position or velocity (only an acceleration may jump). `joints`: room for six numbers of each joint."""
    at = 0
    for a in range(len(k.arms)):
        first, n, begin = int(k.arms[a, c.ARM_KNOT]), int(k.arms[a, c.ARM_JOINTS]), at
        joints[:, :] = 0.0
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
                own = joints[j]
                e0, e1, e2, value, rate, second = quintic(one, other, j, curve, tb.CURVE_POWER + tb.POWERS * j)
                own[0], own[1], own[2] = max(own[0], e0), max(own[1], e1), max(own[2], e2)
                own[3], own[4], own[5] = max(own[3], rate), max(own[4], second), max(own[5], value)
        g.spans[a, 0], g.spans[a, 1] = begin, at - begin
        if at == begin:
            return False
        round_links(k, g, a, joints)
    return True


@kernel(types.boolean(tb.CLAIM, tb.GEOMETRY))
def make_laws(k: Claim, g: tb.Geometry) -> bool:
    """Powers of each piece of a law (N6), and what frames round by: errors of value and rate are carried on from piece
    to piece (R2). False: where a period ends and the next one begins, places or rates differ."""
    begin, end = k.phases[0, c.PHASE_T0], max(k.phases[len(k.phases) - 1, c.PHASE_T1], k.required[0, c.REQUIRED_UNTIL])
    early, late = 0.0, 0.0
    for f in range(len(k.frames)):
        early, late = max(early, k.frames[f, c.FRAME_SHIFT + 1]), max(late, -k.frames[f, c.FRAME_SHIFT])
    begin, end = begin - early - BEYOND_S, end + k.required[0, c.REQUIRED_LATE] + late + BEYOND_S
    g.times[0, 0], g.times[0, 1], latest = begin, end, max(abs(begin), abs(end))
    for f in range(len(k.frames)):
        frame, rounds = k.frames[f], g.rounds[len(k.links) + f]
        first, many, wave = int(frame[c.FRAME_PIECE]), int(frame[c.FRAME_PIECES]), int(frame[c.FRAME_WAVE])
        for axis in range(4):
            x, v, ex, ev = frame[c.FRAME_POSE + axis], frame[c.FRAME_RATE + axis], 0.0, 0.0
            period = frame[c.FRAME_PERIOD]
            e0, e1, e2, rate, second = 32.0 * tb.ULP * abs(x), 0.0, 0.0, 0.0, 0.0
            for i in range(first, first + many):
                law, h = g.laws[i], k.laws[i, c.LAW_END] - k.laws[i, c.LAW_BEGIN]
                law[0], law[1] = k.laws[i, c.LAW_BEGIN], k.laws[i, c.LAW_END]
                if period > 0.0 and i == first + many - 1:
                    h = k.laws[first, c.LAW_BEGIN] + period - law[0]
                # what is behind the last time that counts rounds nothing
                counts = h if period > 0.0 else min(h, max(end - law[0], 0.0))
                at = tb.CURVE_POWER + tb.LAW_POWERS * axis
                law[at], law[at + 1], degree = x, v, 1
                for m in range(c.MOST_POWERS):
                    a = k.laws[i, c.LAW_POWER + c.MOST_POWERS * axis + m]
                    law[at + m + 2] = a / ((m + 1.0) * (m + 2.0))
                    if a != 0.0:
                        degree = m + 2
                law[tb.CURVE_DEGREE] = max(law[tb.CURVE_DEGREE], float(degree))
                x, v, size, speed, bend, jerk = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
                for m in range(degree, -1, -1):
                    x, size = x * h + law[at + m], size * counts + abs(law[at + m])
                    if m > 0:
                        v, speed = v * h + m * law[at + m], speed * counts + m * abs(law[at + m])
                    if m > 1:
                        bend = bend * counts + m * (m - 1.0) * abs(law[at + m])
                    if m > 2:
                        jerk = jerk * counts + m * (m - 1.0) * (m - 2.0) * abs(law[at + m])
                if counts > 0.0:
                    parts, late = (8.0 + 2.0 * degree) * tb.ULP, 4.0 * tb.ULP * max(abs(law[0]), latest)
                    e0 = max(e0, ex + ev * counts + parts * size + late * speed)
                    e1 = max(e1, ev + parts * speed + late * bend)
                    e2, rate, second = max(e2, parts * bend + late * jerk), max(rate, speed), max(second, bend)
                    ex, ev = ex + ev * counts + parts * size, ev + parts * speed
            if period > 0.0:
                jump, kink = (
                    abs(x - frame[c.FRAME_POSE + axis] - frame[c.FRAME_STEP + axis]),
                    abs(v - frame[c.FRAME_RATE + axis]),
                )
                if not (jump <= tb.SLACK and kink <= tb.SLACK):
                    return False
                e0 += (
                    jump
                    + kink * period
                    + 4.0 * tb.ULP * abs(frame[c.FRAME_STEP + axis]) * (1.0 + (latest + abs(g.laws[first, 0])) / period)
                )
                e1 += kink
            for i in range(wave, wave + int(frame[c.FRAME_WAVES])):
                if int(k.waves[i, c.WAVE_COORDINATE]) == axis:
                    w, a = abs(k.waves[i, c.WAVE_RATE]), abs(k.waves[i, c.WAVE_AMPLITUDE])
                    e = 4.0 * tb.ULP * a * (1.0 + w * latest + abs(k.waves[i, c.WAVE_PHASE]))
                    e0, e1, e2, rate, second = e0 + e, e1 + e * w, e2 + e * w * w, rate + a * w, second + a * w * w
            if axis < 3:
                rounds[tb.ROUND_PLACE] += e0
                rounds[2 + tb.ROUND_PLACE] += e1
                rounds[4 + tb.ROUND_PLACE] += e2
            else:
                add_rounding(rounds, 0.0, (e0 + 4.0 * tb.ULP, e1, e2), rate, second)
    return True


@kernel(f8(tb.GEOMETRY, i8, i8, f8))
def rounding(g: tb.Geometry, on: int, order: int, reach: float) -> float:
    """By how much the derivative of that order of a point rounds, `reach` (m) from the origin of its carrier."""
    return float(g.rounds[on, 2 * order + tb.ROUND_PLACE] + g.rounds[on, 2 * order + tb.ROUND_TURN] * reach)


@kernel(i8(F2, i8, i8, f8))
def piece_at(rows: FloatArray, low: int, high: int, t: float) -> int:
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
    a, b, d, e, p, q = polynomial(own, at, int(own[tb.CURVE_DEGREE]), t0 - own[0], min(t1, own[1]) - own[0], work)
    while rows[i, 1] < t1:
        i += 1
        own = rows[i]
        work[tb.TOUCHED] += 1.0
        x = polynomial(own, at, int(own[tb.CURVE_DEGREE]), 0.0, min(t1, own[1]) - own[0], work)
        a, b, d, e, p, q = min(a, x[0]), max(b, x[1]), min(d, x[2]), max(e, x[3]), min(p, x[4]), max(q, x[5])
    value, rate, second = between(a, b), between(d, e), between(p, q)
    return value[0], value[1], rate[0], rate[1], second[0], second[1]


@kernel(types.boolean(tb.GEOMETRY, i8, i8, f8, f8, tb.SCRATCH))
def joints_over(g: tb.Geometry, arm: int, n: int, t0: float, t1: float, s: tb.Scratch) -> bool:
    """Jets of the n joints of an arm over [t0, t1], in `s.joints`. False: its motion is not given there."""
    first, rows = int(g.spans[arm, 0]), g.curves
    last = first + int(g.spans[arm, 1]) - 1
    if not (rows[first, 0] <= t0 <= t1 <= rows[last, 1]):
        return False
    i = piece_at(rows, first, last, t0)
    for j in range(n):
        own = s.joints[j]
        own[0], own[1], own[2], own[3], own[4], own[5] = over(rows, i, tb.CURVE_POWER + tb.POWERS * j, t0, t1, s.work)
    return True
