"""Arithmetic on spans [low, high] of real numbers: what is computed of spans holds for all numbers in them.

Every result is widened by `ROUNDING` of its size, far more than one operation on doubles rounds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

ROUNDING = 1e-14
"""Share of a number, and number, by which each result is widened: fifty times what an operation rounds."""


@dataclass(frozen=True, slots=True)
class Span:
    """All numbers from `low` to `high`."""

    low: float
    high: float

    @property
    def middle(self) -> float:
        return (self.low + self.high) / 2.0

    def __add__(self, other: Span | float) -> Span:
        one, two = (other.low, other.high) if isinstance(other, Span) else (other, other)
        return _wide(self.low + one, self.high + two)

    def __sub__(self, other: Span | float) -> Span:
        return self + -other

    def __neg__(self) -> Span:
        return Span(-self.high, -self.low)

    def __mul__(self, other: Span | float) -> Span:
        one, two = (other.low, other.high) if isinstance(other, Span) else (other, other)
        every = [x * y for x in (self.low, self.high) for y in (one, two)]
        return _wide(min(every), max(every))

    def __truediv__(self, other: Span | float) -> Span:
        """Every number where the divisor may be zero."""
        one, two = (other.low, other.high) if isinstance(other, Span) else (other, other)
        return ANY if one <= 0.0 <= two else self * Span(1.0 / two, 1.0 / one)

    def __abs__(self) -> Span:
        near = 0.0 if self.low <= 0.0 <= self.high else min(abs(self.low), abs(self.high))
        return _wide(near, max(abs(self.low), abs(self.high)))

    def squared(self) -> Span:
        size = abs(self)
        return _wide(size.low * size.low, size.high * size.high)


ANY = Span(-math.inf, math.inf)
"""Every number: nothing is known."""


def around(value: float, by: float) -> Span:
    """The numbers that are off `value` by `by` at most."""
    return _wide(value - by, value + by)


def _wide(low: float, high: float) -> Span:
    if not low <= high:  # NaN: nothing is known
        return ANY
    return Span(low - ROUNDING * (1.0 + abs(low)), high + ROUNDING * (1.0 + abs(high)))


def length(a: Span, b: Span) -> Span:
    """√(a² + b²), not negative."""
    square = a.squared() + b.squared()
    found = _wide(math.sqrt(max(square.low, 0.0)), math.sqrt(max(square.high, 0.0)))
    return Span(max(found.low, 0.0), found.high)


def arc_cosine(a: Span) -> Span:
    """The angle from 0 to π; what is beyond -1 and 1 is no cosine and is left out."""
    return _wide(math.acos(min(max(a.high, -1.0), 1.0)), math.acos(min(max(a.low, -1.0), 1.0)))


def sine(a: Span) -> Span:
    """The sine."""
    if not a.high - a.low < math.tau:
        return Span(-1.0, 1.0)
    ends, quarter = (math.sin(a.low), math.sin(a.high)), math.pi / 2

    def passes(angle: float) -> bool:
        return math.floor((a.high - angle) / math.tau) > math.floor((a.low - angle) / math.tau)

    return _wide(-1.0 if passes(-quarter) else min(ends), 1.0 if passes(quarter) else max(ends))


def pick(of: Callable[[Iterable[float]], float], *spans: Span) -> Span:
    """The least (`min`) or the greatest (`max`) of several."""
    return Span(of(s.low for s in spans), of(s.high for s in spans))


def direction(x: Span, y: Span) -> Span:
    """The angle at which a point of the rectangle x, y is seen from the origin; any where it may be the origin."""
    if x.low <= 0.0 <= x.high and y.low <= 0.0 <= y.high:
        return ANY
    middle = math.atan2(y.middle, x.middle)
    corners = [(a, b) for a in (x.low, x.high) for b in (y.low, y.high)]
    off = [math.remainder(math.atan2(b, a) - middle, math.tau) for a, b in corners]
    return _wide(middle + min(off), middle + max(off))


def span_beyond(a: Span, low: float, high: float, *, turns: bool) -> float:
    """By how much a span is beyond [low, high] at least, with the best full turn where `turns`; 0: it is not."""
    if not math.isfinite(a.low) or not math.isfinite(a.high) or (turns and a.high - a.low >= math.tau):
        return 0.0
    first = math.tau * math.floor((low - a.low) / math.tau)
    shifts = (first - math.tau, first, first + math.tau, first + 2.0 * math.tau) if turns else (0.0,)
    return min(max(low - a.high - k, a.low + k - high, 0.0) for k in shifts)
