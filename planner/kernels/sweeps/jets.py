"""Jets: a quantity, its rate and its second derivative over an interval of time, each as a middle and a radius.

A jet is six numbers: value, radius, rate, radius, second derivative, radius. The quantity is nowhere farther from a
middle than the radius (K43 of docs/kinematics.md). There are no cases, so that a jet costs a few products.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray
from assur.planner.compiled import kernel

Jet = tuple[float, float, float, float, float, float]
Ball = tuple[float, float]
"""A middle and a radius."""
JET, BALL = "UniTuple(float64, 6)", "UniTuple(float64, 2)"
CUBE = "float64[:, :, ::1]"

VALUE, RATE, ACCELERATION = 0, 2, 4
"""Columns of a jet: the middle of each order; its radius is in the next one."""
JET_COLUMNS = 6


@kernel(f"{JET}(float64[:, ::1], int64)")
def jet_at(rows: FloatArray, i: int) -> Jet:
    """The jet in a row."""
    return rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5]


@kernel(f"void(float64[:, ::1], int64, {JET})")
def put_jet(rows: FloatArray, i: int, jet: Jet) -> None:
    """Writes a jet to a row."""
    rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4], rows[i, 5] = jet


@kernel(f"{JET}({JET}, float64, {JET})")
def add(a: Jet, k: float, b: Jet) -> Jet:
    """a + k b for a number k."""
    r = abs(k)
    return a[0] + k * b[0], a[1] + r * b[1], a[2] + k * b[2], a[3] + r * b[3], a[4] + k * b[4], a[5] + r * b[5]


@kernel(f"{BALL}(float64, float64, float64, float64)")
def product(a: float, r: float, b: float, s: float) -> Ball:
    """All products of a number within r of a and one within s of b."""
    return a * b, abs(a) * s + r * (abs(b) + s)


@kernel(f"{JET}({JET}, {JET})")
def times(a: Jet, b: Jet) -> Jet:
    """a b, by the product rule."""
    value = product(a[0], a[1], b[0], b[1])
    left, right = product(a[2], a[3], b[0], b[1]), product(a[0], a[1], b[2], b[3])
    one, both, other = (
        product(a[4], a[5], b[0], b[1]),
        product(a[2], a[3], b[2], b[3]),
        product(a[0], a[1], b[4], b[5]),
    )
    rate = left[0] + right[0], left[1] + right[1]
    return (*value, *rate, one[0] + 2.0 * both[0] + other[0], one[1] + 2.0 * both[1] + other[1])


@kernel(f"{JET}({JET}, {BALL}, {BALL}, {BALL})")
def through(a: Jet, value: Ball, slope: Ball, bend: Ball) -> Jet:
    """f(a) by the chain rule, from all that f, f' and f'' may be over the range of a."""
    rate = product(slope[0], slope[1], a[2], a[3])
    least, most = max(abs(a[2]) - a[3], 0.0), abs(a[2]) + a[3]
    low, high = least * least, most * most
    square = product(bend[0], bend[1], 0.5 * (low + high), 0.5 * (high - low))
    pull = product(slope[0], slope[1], a[4], a[5])
    return (*value, *rate, square[0] + pull[0], square[1] + pull[1])


@kernel(f"Tuple(({JET}, {JET}))({JET})")
def turned(a: Jet) -> tuple[Jet, Jet]:
    """Cosine and sine of an angle. With d of at most r, cos d is from 1 - r²/2 to 1 and sin d from -r to r."""
    c, s, r = math.cos(a[0]), math.sin(a[0]), a[1]
    if r < 1.0:
        lost = 0.25 * r * r
        cosine = c * (1.0 - lost), abs(c) * lost + abs(s) * r
        sine = s * (1.0 - lost), abs(s) * lost + abs(c) * r
    else:
        cosine, sine = (0.0, 1.0), (0.0, 1.0)
    less_cosine, less_sine = (-cosine[0], cosine[1]), (-sine[0], sine[1])
    return through(a, cosine, less_sine, less_cosine), through(a, sine, cosine, less_sine)


@kernel(f"{BALL}(float64, float64)")
def between(one: float, other: float) -> Ball:
    """All numbers between two, whichever is less."""
    return 0.5 * (one + other), 0.5 * abs(other - one)


@kernel(f"{JET}({JET})")
def inverse(a: Jet) -> Jet:
    """1/a for what is greater than 0."""
    low, high = 1.0 / (a[0] + a[1]), 1.0 / (a[0] - a[1])
    return through(a, between(low, high), between(-low * low, -high * high), between(2.0 * low**3, 2.0 * high**3))


@kernel(f"{JET}({JET})")
def root(a: Jet) -> Jet:
    """The square root of what is greater than 0."""
    low, high = math.sqrt(a[0] - a[1]), math.sqrt(a[0] + a[1])
    return through(a, between(low, high), between(0.5 / low, 0.5 / high), between(-0.25 / low**3, -0.25 / high**3))
