"""A request, its plan and the claim of the plan: which rows of the claim state what is required.

All that is required of a row is that some of its numbers are within bounds. So one comparison serves all tables.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from functools import cached_property
from itertools import chain, count, repeat

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement.differences import SAME, Interval
from assur.planner.checker.statement.holding import Handling
from assur.planner.claim import columns as c

Bound = list[tuple[int, float, float]]
"""Columns, each with the least and the greatest number that it may have."""
YAWS = {
    "points": [c.POINT_TOOL + 3, c.POINT_TARGET + 3],
    "errors": [c.ERROR_TOOL + 3, c.ERROR_TARGET + 3],
}
"""Columns of yaws, which may differ from what is required by full turns; a bound is required of each."""
JOINT = tuple(map(tuple, np.eye(c.MOST_JOINTS).tolist()))
"""The shares in a sum that is one joint, of each."""
NOTHING = (0.0,) * c.MOST_JOINTS
ROUNDING = 1e-12
"""A share of a number that was computed in another order of operations."""


def same(column: int, *numbers: float) -> Bound:
    """These numbers, from a column on."""
    return [(k, x - SAME, x + SAME) for k, x in enumerate(numbers, column)]


def at_least(column: int, *numbers: float) -> Bound:
    """Numbers that are no smaller, from a column on."""
    return list(zip(count(column), numbers, repeat(math.inf), strict=False))


def at_most(column: int, *numbers: float) -> Bound:
    """Numbers that are no larger, from a column on."""
    return list(zip(count(column), repeat(-math.inf), numbers, strict=False))


def all_of(when: Interval) -> Bound:
    """Rows that hold over all of an interval."""
    return [(0, -math.inf, when[0]), (1, when[1], math.inf)]


def within(when: Interval) -> Bound:
    """Rows that hold over a part of an interval, or at an instant in it."""
    return [(0, when[0] - SAME, math.inf), (1, -math.inf, when[1] + SAME)]


class Statement(Handling):
    """A claim that has to state what a request requires of a plan."""

    def __init__(self, handling: Handling, claim: c.Claim) -> None:
        """`handling`: of the plan whose claim it is; what was derived of it is not derived again."""
        vars(self).update(vars(handling), findings=[])
        self.claim = claim
        self._lists: dict[str, list[list[float]]] = {}
        self._numbers: dict[str, dict[tuple[float, ...], list[tuple[float, ...]]]] = {}

    @cached_property
    def seats(self) -> FloatArray:
        """The seat that the claim has of each body in each phase, (P, B, c.SEAT)."""
        return np.asarray(self.claim.seats[self.claim.seated.astype(int)])

    def listed(self, table: str, *bounds: Bound) -> list[list[float]]:
        """The rows of a table whose numbers are within bounds, NaN is not; yaws may differ by full turns."""
        if table not in self._lists:
            self._lists[table] = getattr(self.claim, table).tolist()
        box, yaws, found = list(chain(*bounds)), YAWS.get(table, ()), list[list[float]]()
        for row in self._lists[table]:
            for column, low, high in box:
                x = row[column]
                if not low <= x <= high and column in yaws:
                    middle = (low + high) / 2.0
                    x = middle + math.remainder(x - middle, math.tau)
                if not low <= x <= high:
                    break
            else:
                found.append(row)
        return found

    def states(self, table: str, *bounds: Bound) -> bool:
        """Whether a row of a table has numbers within bounds."""
        return len(self.listed(table, *bounds)) > 0

    def keeps(
        self, table: str, about: tuple[float, ...], least: float, most: float, when: Interval, *, once: bool = False
    ) -> bool:
        """Whether rows of `rates`, `axes` or `sums` state that a number is from `least` to `most` over all of an
        interval, or (`once`) for a part of it."""
        low, high = least - SAME - ROUNDING * abs(least), most + SAME + ROUNDING * abs(most)
        reached, (begin, end) = -math.inf, when
        for t0, t1, lower, upper in self.bounds(table, about):
            if not (low <= lower and upper <= high):
                continue
            if once and begin - SAME <= t0 and t1 <= end + SAME:
                return True
            if t0 <= max(reached, begin):
                reached = max(reached, t1)
        return reached >= end and not once

    def bounds(self, table: str, about: tuple[float, ...]) -> list[tuple[float, ...]]:
        """Times and bounds of the rows of `rates`, `axes` or `sums` about a number (the columns between both), in the
        order of their begins."""
        if table not in self._numbers:
            self._numbers[table] = {}
            for t0, t1, *numbers, low, high in sorted(getattr(self.claim, table).tolist()):
                self._numbers[table].setdefault(tuple(numbers), []).append((t0, t1, low, high))
        known = self._numbers[table]
        if about in known:
            return known[about]
        near = [key for key in known if all(abs(x - y) <= SAME for x, y in zip(key, about, strict=True))]
        return sorted(row for key in near for row in known[key])

    def sum_keeps(
        self, order: int, shares: Iterable[float], least: float, most: float, when: Interval, *, once: bool = False
    ) -> bool:
        """`keeps` for a sum of shares of the joints, or a derivative of it."""
        about = (float(order), *shares, *NOTHING)[: 1 + c.MOST_JOINTS]
        return self.keeps("sums", about, least, most, when, once=once)

    def tool_keeps(
        self, frame: float, order: int, least: float, most: float, when: Interval, *, once: bool = False
    ) -> bool:
        """`keeps` for the speed of the tool point as a frame has it (order 1), or its acceleration (order 2)."""
        return self.keeps("rates", (self.flange, *self.tcp[:3], frame, order), least, most, when, once=once)
