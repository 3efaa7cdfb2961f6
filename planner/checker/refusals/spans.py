"""Arithmetic on spans [low, high] of real numbers: what is computed of spans holds for all numbers in them.

Every result is widened by `ROUNDING` of its size, far more than one operation on doubles rounds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

ROUNDING = 1e-14
"""Share of a number, and number, by which each result is widened: fifty times what an operation rounds."""


class Span(NamedTuple):
    """All numbers from `low` to `high`."""

    low: float
    high: float

    @property
    def middle(self) -> float:
        return (self.low + self.high) / 2.0


ANY = Span(-math.inf, math.inf)
"""Every number: nothing is known."""


def around(value: float, by: float) -> Span:
    """The numbers that are off `value` by `by` at most."""
    return _wide(value - by, value + by)


def _wide(low: float, high: float) -> Span:
    if not low <= high:  # NaN: nothing is known
        return ANY
    return Span(low - ROUNDING * (1.0 + abs(low)), high + ROUNDING * (1.0 + abs(high)))


def plus(*spans: Span) -> Span:
    """The sum."""
    return _wide(math.fsum(s.low for s in spans), math.fsum(s.high for s in spans))


def scaled(by: float, a: Span) -> Span:
    """A multiple."""
    return _wide(min(by * a.low, by * a.high), max(by * a.low, by * a.high))


def minus(a: Span, b: Span) -> Span:
    """The difference."""
    return _wide(a.low - b.high, a.high - b.low)


def square(a: Span) -> Span:
    """The square."""
    far = max(abs(a.low), abs(a.high))
    near = 0.0 if a.low <= 0.0 <= a.high else min(abs(a.low), abs(a.high))
    return _wide(near * near, far * far)


def times(a: Span, b: Span) -> Span:
    """The product."""
    every = [x * y for x in a for y in b]
    return _wide(min(every), max(every))


def over(a: Span, b: Span) -> Span:
    """The quotient; every number where the divisor may be zero."""
    return ANY if b.low <= 0.0 <= b.high else times(a, Span(1.0 / b.high, 1.0 / b.low))


def root(a: Span) -> Span:
    """The square root of what is not negative."""
    return _wide(math.sqrt(max(a.low, 0.0)), math.sqrt(max(a.high, 0.0)))


def length(a: Span, b: Span) -> Span:
    """√(a² + b²), not negative."""
    found = root(plus(square(a), square(b)))
    return Span(max(found.low, 0.0), found.high)


def arc_cosine(a: Span) -> Span:
    """The angle from 0 to π; what is beyond -1 and 1 is no cosine and is left out."""
    return _wide(math.acos(min(max(a.high, -1.0), 1.0)), math.acos(min(max(a.low, -1.0), 1.0)))


def sine(a: Span) -> Span:
    """The sine."""
    if not a.high - a.low < math.tau:
        return Span(-1.0, 1.0)
    ends = math.sin(a.low), math.sin(a.high)
    low, high = min(ends), max(ends)
    if math.floor((a.high - math.pi / 2) / math.tau) > math.floor((a.low - math.pi / 2) / math.tau):
        high = 1.0
    if math.floor((a.high + math.pi / 2) / math.tau) > math.floor((a.low + math.pi / 2) / math.tau):
        low = -1.0
    return _wide(low, high)


def size(a: Span) -> Span:
    """The number without its sign."""
    near = 0.0 if a.low <= 0.0 <= a.high else min(abs(a.low), abs(a.high))
    return _wide(near, max(abs(a.low), abs(a.high)))


def pick(of: Callable[[Iterable[float]], float], *spans: Span) -> Span:
    """The least (`min`) or the greatest (`max`) of several."""
    return Span(of(s.low for s in spans), of(s.high for s in spans))


def direction(x: Span, y: Span) -> Span:
    """The angle at which a point of the rectangle x, y is seen from the origin; any where it may be the origin."""
    corners = [(a, b) for a in x for b in y]
    if x.low <= 0.0 <= x.high and y.low <= 0.0 <= y.high:
        return ANY
    middle = math.atan2(y.middle, x.middle)
    off = [math.remainder(math.atan2(b, a) - middle, math.tau) for a, b in corners]
    return _wide(middle + min(off), middle + max(off))


def beyond(a: Span, low: float, high: float, *, turns: bool) -> float:
    """By how much a span is beyond [low, high] at least, with the best full turn where `turns`; 0: it is not."""
    if not math.isfinite(a.low) or not math.isfinite(a.high):
        return 0.0
    if not turns:
        return max(low - a.high, a.low - high, 0.0)
    if a.high - a.low >= math.tau:
        return 0.0
    first = math.tau * math.floor((low - a.low) / math.tau)
    shifts = (first - math.tau, first, first + math.tau, first + 2.0 * math.tau)
    return min(max(low - a.high - k, a.low + k - high, 0.0) for k in shifts)
