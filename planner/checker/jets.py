"""Jets: bounds of a quantity, of its rate and of its acceleration over an interval of time, and how they are combined.

A jet is (low, high, low', high', low'', high''). Every operation gives bounds of the result by interval arithmetic with
the rules of derivatives (product, chain). Over an instant, an interval of no length, the bounds coincide and the jet is
the value with both derivatives. So one formula for a place gives the place, and bounds of the motion.

Rounding is not directed outwards: it is some 1e-15 of the numbers, and what is proved keeps 1e-9 m for it.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.compiled import kernel

Jet = tuple[float, float, float, float, float, float]

JET = "UniTuple(float64, 6)"
RANGE = "UniTuple(float64, 2)"
F1, F2, F3 = "float64[::1]", "float64[:, ::1]", "float64[:, :, ::1]"
TABLES = f"UniTuple({F2}, 6)"
VECTOR = "UniTuple(float64, 3)"
TURN = 2.0 * math.pi


@kernel(f"{RANGE}(float64, float64, float64, float64)")
def product(a0: float, a1: float, b0: float, b1: float) -> tuple[float, float]:
    """Bounds of a b with a in [a0, a1] and b in [b0, b1]."""
    p, q, r, s = a0 * b0, a0 * b1, a1 * b0, a1 * b1
    return min(p, q, r, s), max(p, q, r, s)


@kernel(f"{JET}(float64)")
def constant(value: float) -> Jet:
    """A number that does not change."""
    return value, value, 0.0, 0.0, 0.0, 0.0


@kernel(f"{JET}({JET}, {JET})")
def plus(a: Jet, b: Jet) -> Jet:
    """a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5]


@kernel(f"{JET}(float64, {JET})")
def scaled(k: float, a: Jet) -> Jet:
    """k a for a number k."""
    if k >= 0.0:
        return k * a[0], k * a[1], k * a[2], k * a[3], k * a[4], k * a[5]
    return k * a[1], k * a[0], k * a[3], k * a[2], k * a[5], k * a[4]


@kernel(f"{JET}({JET}, {JET})")
def times(a: Jet, b: Jet) -> Jet:
    """a b, with (a b)' = a' b + a b' and (a b)'' = a'' b + 2 a' b' + a b''."""
    v = product(a[0], a[1], b[0], b[1])
    r, s = product(a[2], a[3], b[0], b[1]), product(a[0], a[1], b[2], b[3])
    x, y, z = product(a[4], a[5], b[0], b[1]), product(a[2], a[3], b[2], b[3]), product(a[0], a[1], b[4], b[5])
    return v[0], v[1], r[0] + s[0], r[1] + s[1], x[0] + 2.0 * y[0] + z[0], x[1] + 2.0 * y[1] + z[1]


@kernel(f"{RANGE}({JET})")
def squared_rate(a: Jet) -> tuple[float, float]:
    """Bounds of a'²."""
    low, high = a[2] * a[2], a[3] * a[3]
    return (0.0 if a[2] <= 0.0 <= a[3] else min(low, high)), max(low, high)


@kernel(f"{JET}({JET}, float64, float64, float64, float64, float64, float64)")
def composed(a: Jet, v0: float, v1: float, d0: float, d1: float, e0: float, e1: float) -> Jet:
    """f(a) for a function with f in [v0, v1], f' in [d0, d1], f'' in [e0, e1] over the range of a."""
    rate = product(d0, d1, a[2], a[3])
    square = squared_rate(a)
    bend, pull = product(e0, e1, square[0], square[1]), product(d0, d1, a[4], a[5])
    return v0, v1, rate[0], rate[1], bend[0] + pull[0], bend[1] + pull[1]


@kernel(f"{RANGE}(float64, float64, float64, float64, float64)")
def wave(low: float, high: float, at_low: float, at_high: float, crest: float) -> tuple[float, float]:
    """Bounds over [low, high] of a wave of period 2π that is 1 at `crest` and has these values at the ends."""
    least, most = min(at_low, at_high), max(at_low, at_high)
    if np.floor((high - crest) / TURN) > np.floor((low - crest) / TURN):
        most = 1.0
    if np.floor((high - crest) / TURN - 0.5) > np.floor((low - crest) / TURN - 0.5):
        least = -1.0
    return least, most


@kernel(f"Tuple(({JET}, {JET}))({JET})")
def turned(a: Jet) -> tuple[Jet, Jet]:
    """cos a and sin a."""
    c = wave(a[0], a[1], math.cos(a[0]), math.cos(a[1]), 0.0)
    s = wave(a[0], a[1], math.sin(a[0]), math.sin(a[1]), 0.25 * TURN)
    return (
        composed(a, c[0], c[1], -s[1], -s[0], -c[1], -c[0]),
        composed(a, s[0], s[1], c[0], c[1], -s[1], -s[0]),
    )


@kernel(f"{JET}({JET})")
def inverse(a: Jet) -> Jet:
    """1/a for a > 0."""
    x, y = 1.0 / a[1], 1.0 / a[0]
    return composed(a, x, y, -y * y, -x * x, 2.0 * x * x * x, 2.0 * y * y * y)


@kernel(f"{JET}({JET})")
def root(a: Jet) -> Jet:
    """√a for a > 0."""
    x, y = math.sqrt(a[0]), math.sqrt(a[1])
    return composed(a, x, y, 0.5 / y, 0.5 / x, -0.25 / (x * x * x), -0.25 / (y * y * y))


@kernel(f"float64({F3}, int64, int64, int64, int64)")
def size(jets: np.ndarray[tuple[int, ...], np.dtype[np.float64]], c: int, first: int, last: int, order: int) -> float:
    """Upper bound of the length of the vector of the jets first to last - 1 of row c: of the order-th derivative."""
    total = 0.0
    for k in range(first, last):
        most = max(abs(jets[c, k, 2 * order]), abs(jets[c, k, 2 * order + 1]))
        total += most * most
    return math.sqrt(total)
