"""Pieces of bodies at their places on their carriers: how far they reach along a direction, and how that changes."""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim import tables as tb
from assur.planner.checker.claim.tables import BALL, F1, F3, F4, JET, f8, i8
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


@kernel(f8(tb.GEOMETRY, i8, f8, f8, f8), inline=True)
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


@kernel(f8(tb.GEOMETRY, F4, i8, i8, i8, F1, f8), inline=True)
def solid_reach(
    g: tb.Geometry, jets: FloatArray, slot: int, solid: int, on: int, normal: FloatArray, sign: float
) -> float:
    """The largest m·x of a solid at an instant, m, for a unit vector m = `sign` * `normal` of the world (N2)."""
    at, x, y, z = jets[slot, on], sign * normal[0], sign * normal[1], sign * normal[2]
    u = x * at[3, 0] + y * at[4, 0] + z * at[5, 0]
    v = x * at[6, 0] + y * at[7, 0] + z * at[8, 0]
    w = x * at[9, 0] + y * at[10, 0] + z * at[11, 0]
    return float(x * at[0, 0] + y * at[1, 0] + z * at[2, 0] + extent(g, solid, u, v, w))


@kernel(f8(tb.GEOMETRY, F4, i8, i8, i8, i8, F1, f8), inline=True)
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


@kernel(f8(F1, f8, f8))
def farthest_corner(own: FloatArray, x: float, y: float) -> float:
    """How far the corners of a solid are from the vertical axis of its carrier at most, m, without its disc and ball:
    the points (x, y) with each of its edges added or taken away."""
    most, many = 0.0, int(own[tb.SOLID_EDGES])
    for signs in range(1 << many):
        u, v = x, y
        for e in range(many):
            sign = 1.0 if signs >> e & 1 else -1.0
            u, v = u + sign * own[tb.SOLID_EDGE + 3 * e], v + sign * own[tb.SOLID_EDGE + 3 * e + 1]
        most = max(most, math.sqrt(u**2 + v**2))
    return most


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
    wide, tall, own[tb.SOLID_VERTEX] = math.sqrt(own[0] ** 2 + own[1] ** 2), abs(own[2]), vertex
    for e in range(0, 3 * int(piece[c.PIECE_EDGES]), 3):
        turn_vector(cosine, sine, piece, c.PIECE_EDGE + e, own, tb.SOLID_EDGE + e)
    many = int(piece[c.PIECE_VERTICES])
    far = 0.0 if many > 0 else farthest_corner(own, own[0], own[1])
    for m in range(many):
        to = g.vertices[vertex + m]
        turn_vector(cosine, sine, k.vertices[int(piece[c.PIECE_VERTEX]) + m], 0, to, 0)
        for axis in range(3):
            to[axis] += pose[axis]
        far = max(far, farthest_corner(own, to[0], to[1]))
        wide, tall = max(wide, math.sqrt(to[0] ** 2 + to[1] ** 2)), max(tall, abs(to[2]))
    own[tb.SOLID_REACH] = far + own[tb.SOLID_DISC] + own[tb.SOLID_BALL]
    own[tb.SOLID_SIZE] = wide + tall + 2.0 * (own[tb.SOLID_DISC] + own[tb.SOLID_BALL])
    for e in range(tb.SOLID_EDGE, tb.SOLID_EDGE + 3 * int(own[tb.SOLID_EDGES]), 3):
        own[tb.SOLID_SIZE] += math.sqrt(own[e] ** 2 + own[e + 1] ** 2) + abs(own[e + 2])


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
        box, size = g.solids[at], 0.0
        cosine, sine = math.cos(k.seats[s, c.SEAT_POSE + 3]), math.sin(k.seats[s, c.SEAT_POSE + 3])
        for axis in range(3):
            u, v, w = (cosine, sine, 0.0) if axis == 0 else (-sine, cosine, 0.0) if axis == 1 else (0.0, 0.0, 1.0)
            low, high, e = math.inf, -math.inf, tb.SOLID_EDGE + 3 * axis
            for i in range(first, at):
                low, high = min(low, -extent(g, i, -u, -v, -w)), max(high, extent(g, i, u, v, w))
            middle, half = 0.5 * (low + high), 0.5 * (high - low)
            box[0], box[1], box[2] = box[0] + middle * u, box[1] + middle * v, box[2] + middle * w
            box[e], box[e + 1], box[e + 2] = half * u, half * v, half * w
            size += abs(middle) + half
        for i in range(first, at):  # what it holds turns with its carrier, and not the box
            box[tb.SOLID_REACH] = max(box[tb.SOLID_REACH], g.solids[i, tb.SOLID_REACH])
        box[tb.SOLID_EDGES], box[tb.SOLID_SIZE], at = 3.0, size, at + 1


# Jets: bounds of a quantity, of its rate and of its second derivative over a time interval.
#
# A jet is (value, radius, rate, radius, second derivative, radius): each quantity is within its radius of its middle.
# Sums, and products by constants, lose nothing. Over an instant all radii are 0, so a jet is the value with its
# derivatives. Rounding is not directed; docs/claim-check.md bounds it.

Jet = tuple[float, float, float, float, float, float]
Ball = tuple[float, float]
"""Middle and radius."""


@kernel(BALL(f8, f8))
def between(low: float, high: float) -> Ball:
    """The ball of an interval."""
    return 0.5 * (low + high), 0.5 * (high - low)


@kernel(BALL(BALL, BALL))
def product(a: Ball, b: Ball) -> Ball:
    """A ball that holds all products."""
    return a[0] * b[0], abs(a[0]) * b[1] + a[1] * abs(b[0]) + a[1] * b[1]


@kernel(BALL(BALL))
def square(a: Ball) -> Ball:
    """The ball of all squares."""
    least = max(abs(a[0]) - a[1], 0.0)
    return between(least * least, (abs(a[0]) + a[1]) ** 2)


@kernel(JET(f8))
def constant(value: float) -> Jet:
    """A number that does not change."""
    return value, 0.0, 0.0, 0.0, 0.0, 0.0


@kernel(JET(JET, JET))
def plus(a: Jet, b: Jet) -> Jet:
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5]


@kernel(JET(f8, JET))
def scaled(k: float, a: Jet) -> Jet:
    """k a for a number k."""
    r = abs(k)
    return k * a[0], r * a[1], k * a[2], r * a[3], k * a[4], r * a[5]


@kernel(JET(JET, JET))
def minus(a: Jet, b: Jet) -> Jet:
    """a - b."""
    return a[0] - b[0], a[1] + b[1], a[2] - b[2], a[3] + b[3], a[4] - b[4], a[5] + b[5]


@kernel(JET(JET, JET))
def times(a: Jet, b: Jet) -> Jet:
    """a b, with (a b)' = a' b + a b' and (a b)'' = a'' b + 2 a' b' + a b''."""
    v = product((a[0], a[1]), (b[0], b[1]))
    r, s = product((a[2], a[3]), (b[0], b[1])), product((a[0], a[1]), (b[2], b[3]))
    x, y = product((a[4], a[5]), (b[0], b[1])), product((a[2], a[3]), (b[2], b[3]))
    z = product((a[0], a[1]), (b[4], b[5]))
    return v[0], v[1], r[0] + s[0], r[1] + s[1], x[0] + 2.0 * y[0] + z[0], x[1] + 2.0 * y[1] + z[1]


@kernel(JET(JET, f8, f8, f8))
def widened(a: Jet, value: float, rate: float, second: float) -> Jet:
    """The same with larger radii."""
    return a[0], a[1] + value, a[2], a[3] + rate, a[4], a[5] + second


@kernel(JET(JET, JET))
def joined(a: Jet, b: Jet) -> Jet:
    """What holds both."""
    x = between(min(a[0] - a[1], b[0] - b[1]), max(a[0] + a[1], b[0] + b[1]))
    y = between(min(a[2] - a[3], b[2] - b[3]), max(a[2] + a[3], b[2] + b[3]))
    z = between(min(a[4] - a[5], b[4] - b[5]), max(a[4] + a[5], b[4] + b[5]))
    return x[0], x[1], y[0], y[1], z[0], z[1]


@kernel(JET(JET, BALL, BALL, BALL))
def composed(a: Jet, value: Ball, slope: Ball, curvature: Ball) -> Jet:
    """f(a), from balls of f, f' and f'' over the range of a."""
    rate = product(slope, (a[2], a[3]))
    x, y = product(slope, (a[4], a[5])), product(curvature, square((a[2], a[3])))
    return value[0], value[1], rate[0], rate[1], x[0] + y[0], x[1] + y[1]


@kernel(types.Tuple((JET, JET))(JET))
def turned(a: Jet) -> tuple[Jet, Jet]:
    """Cosine and sine of an angle. For |d| <= r: cos d is from 1 - r²/2 to 1, and |sin d| <= r. So one formula holds
    for all quadrants."""
    c, s, r, u = math.cos(a[0]), math.sin(a[0]), a[1], 0.25 * a[1] * a[1]
    cosine, sine = (c * (1.0 - u), abs(c) * u + abs(s) * r), (s * (1.0 - u), abs(s) * u + abs(c) * r)
    if not r < 1.0:
        cosine, sine = (0.0, 1.0), (0.0, 1.0)
    minus_cosine, minus_sine = (-cosine[0], cosine[1]), (-sine[0], sine[1])
    return composed(a, cosine, minus_sine, minus_cosine), composed(a, sine, cosine, minus_sine)


@kernel(JET(JET))
def inverse(a: Jet) -> Jet:
    """1/a for a > 0."""
    x, y = 1.0 / (a[0] + a[1]), 1.0 / (a[0] - a[1])
    return composed(a, between(x, y), between(-y * y, -x * x), between(2.0 * x * x * x, 2.0 * y * y * y))


@kernel(JET(JET))
def root(a: Jet) -> Jet:
    """√a for a > 0."""
    x, y = math.sqrt(a[0] - a[1]), math.sqrt(a[0] + a[1])
    return composed(a, between(x, y), between(0.5 / y, 0.5 / x), between(-0.25 / (x * x * x), -0.25 / (y * y * y)))


@kernel(JET(F1, i8, i8, f8, f8, F1))
def polynomial(row: FloatArray, at: int, degree: int, a: float, b: float, work: FloatArray) -> Jet:
    """The jet over [a, b] of the polynomial whose coefficients are in a row from column `at` on. It is developed about
    the middle of [a, b]: odd powers reach as far either way, even powers reach one way. `work`: room for its
    coefficients, degree + 1 and at least 3."""
    middle, r = 0.5 * (a + b), 0.5 * (b - a)
    for k in range(degree + 1):
        work[k] = row[at + k]
    for k in range(degree + 1, 3):
        work[k] = 0.0
    for i in range(degree if r > 0.0 else min(degree, 3)):
        for k in range(degree - 1, i - 1, -1):
            work[k] += middle * work[k + 1]
    if not r > 0.0:
        return work[0], 0.0, work[1], 0.0, 2.0 * work[2], 0.0
    low0, high0, low1, high1, low2, high2 = work[0], work[0], work[1], work[1], 2.0 * work[2], 2.0 * work[2]
    p = r
    for k in range(1, degree + 1):
        x = work[k] * p
        y = (k + 1) * work[k + 1] * p if k < degree else 0.0
        z = (k + 1) * (k + 2) * work[k + 2] * p if k + 1 < degree else 0.0
        if k % 2 == 1:
            low0, high0, low1, high1 = low0 - abs(x), high0 + abs(x), low1 - abs(y), high1 + abs(y)
            low2, high2 = low2 - abs(z), high2 + abs(z)
        else:
            low0, high0, low1, high1 = low0 + min(x, 0.0), high0 + max(x, 0.0), low1 + min(y, 0.0), high1 + max(y, 0.0)
            low2, high2 = low2 + min(z, 0.0), high2 + max(z, 0.0)
        p *= r
    value, rate, second = between(low0, high0), between(low1, high1), between(low2, high2)
    return value[0], value[1], rate[0], rate[1], second[0], second[1]


@kernel(JET(F3, i8, i8))
def jet(jets: FloatArray, i: int, k: int) -> Jet:
    """The jet in row (i, k)."""
    row = jets[i, k]
    return row[0], row[1], row[2], row[3], row[4], row[5]


@kernel(types.void(F3, i8, i8, JET))
def put(jets: FloatArray, i: int, k: int, value: Jet) -> None:
    """Writes a jet into row (i, k)."""
    row = jets[i, k]
    row[0], row[1], row[2], row[3], row[4], row[5] = value
