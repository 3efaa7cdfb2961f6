"""Jets: bounds of a quantity, of its rate and of its second derivative over a time interval.

A jet is (value, radius, rate, radius, second derivative, radius): each quantity is within its radius of its middle.
Sums, and products by constants, lose nothing. Over an instant all radii are 0, so a jet is the value with its
derivatives. Rounding is not directed; docs/claim-check.md bounds it.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.checker.claim.tables import BALL, F1, F3, JET, f8, i8
from assur.planner.compiled import kernel, types

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
