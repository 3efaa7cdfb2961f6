"""A request, its plan and the claim of the plan: which rows of the claim state what is required.

All that is required of a row is that some of its numbers are within bounds. So one comparison serves all tables.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement.differences import SAME, Interval
from assur.planner.checker.statement.holding import Handling
from assur.planner.claim import columns as c
from assur.planner.model.outcome import Plan
from assur.planner.model.scene import Scene

Bound = tuple[int, Sequence[float], Sequence[float]]
"""The first of some columns, and the least and the greatest number that each of them may have."""
YAWS = {
    "points": [c.POINT_TOOL + 3, c.POINT_TARGET + 3],
    "errors": [c.ERROR_TOOL + 3, c.ERROR_TARGET + 3],
}
"""Columns of yaws, which may differ from what is required by full turns; a bound is required of each."""
ROUNDING = 1e-12
"""A share of a number that was computed in another order of operations."""


def same(column: int, *numbers: float) -> Bound:
    """These numbers, from a column on."""
    return column, [x - SAME for x in numbers], [x + SAME for x in numbers]


def at_least(column: int, *numbers: float) -> Bound:
    """Numbers that are no smaller, from a column on."""
    return column, numbers, [math.inf] * len(numbers)


def at_most(column: int, *numbers: float) -> Bound:
    """Numbers that are no larger, from a column on."""
    return column, [-math.inf] * len(numbers), numbers


def all_of(when: Interval) -> Bound:
    """Rows that hold over all of an interval."""
    return 0, (-math.inf, when[1]), (when[0], math.inf)


def within(when: Interval) -> Bound:
    """Rows that hold over a part of an interval, or at an instant in it."""
    return 0, (when[0] - SAME, -math.inf), (math.inf, when[1] + SAME)


class Statement(Handling):
    """A claim that has to state what a request requires of a plan."""

    def __init__(self, scene: Scene, plan: Plan, claim: c.Claim) -> None:
        super().__init__(scene, plan)
        self.claim = claim
        self._kept: dict[tuple[str, tuple[float, ...]], list[list[float]]] = {}

    def rows(self, table: str, *bounds: Bound) -> FloatArray:
        """The rows of a table whose numbers are within bounds; NaN is not."""
        stated: FloatArray = getattr(self.claim, table)
        low, high = [-math.inf] * stated.shape[1], [math.inf] * stated.shape[1]
        for column, least, most in bounds:
            low[column : column + len(least)], high[column : column + len(most)] = least, most
        numbers, yaws = stated, YAWS.get(table)
        if yaws is not None:
            numbers = stated.copy()
            middle = [(low[yaw] + high[yaw]) / 2.0 for yaw in yaws]
            numbers[:, yaws] -= math.tau * np.round((stated[:, yaws] - middle) / math.tau)
        return np.asarray(stated[((low <= numbers) & (numbers <= high)).all(1)])

    def states(self, table: str, *bounds: Bound) -> bool:
        """Whether a row of a table has numbers within bounds."""
        return len(self.rows(table, *bounds)) > 0

    def chain(self, table: str, when: Interval, *bounds: Bound) -> FloatArray | None:
        """The rows that last for a part of an interval and have numbers within bounds, in order; None: they leave out a
        time of it."""
        rows = self.rows(table, within(when), *bounds)
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        rows = rows[rows[:, 1] > rows[:, 0]]
        times = rows[:, :2]
        whole = len(rows) > 0 and (times[0, 0], times[-1, 1]) == when and (times[1:, 0] == times[:-1, 1]).all()
        return rows if whole else None

    def keeps(
        self, table: str, about: Sequence[float], least: float, most: float, when: Interval, *, once: bool = False
    ) -> bool:
        """Whether rows of `rates`, `axes` or `sums` state that a number is from `least` to `most` over all of an
        interval, or (`once`) for a part of it. `about`: the columns between times and bounds."""
        low, high = least - SAME - ROUNDING * abs(least), most + SAME + ROUNDING * abs(most)
        spans = [
            (t0, t1) for t0, t1, lower, upper in self._bounds(table, tuple(about)) if low <= lower and upper <= high
        ]
        if once:
            return any(when[0] - SAME <= t0 and t1 <= when[1] + SAME for t0, t1 in spans)
        reached = -math.inf
        for t0, t1 in sorted(spans):
            if t0 <= max(reached, when[0]):
                reached = max(reached, t1)
        return reached >= when[1]

    def _bounds(self, table: str, about: tuple[float, ...]) -> list[list[float]]:
        """Times and bounds of the rows about a number."""
        if (table, about) not in self._kept:
            stated: FloatArray = getattr(self.claim, table)
            own = stated[(np.abs(stated[:, 2:-2] - about) <= SAME).all(1)]
            self._kept[table, about] = own[:, [0, 1, -2, -1]].tolist()
        return self._kept[table, about]

    def sum_keeps(
        self, order: int, shares: Iterable[float], least: float, most: float, when: Interval, *, once: bool = False
    ) -> bool:
        """`keeps` for a sum of shares of the joints, or a derivative of it."""
        about = [float(order), *shares]
        about += [0.0] * (1 + c.MOST_JOINTS - len(about))
        return self.keeps("sums", about, least, most, when, once=once)

    def tool_keeps(
        self, frame: float, order: int, least: float, most: float, when: Interval, *, once: bool = False
    ) -> bool:
        """`keeps` for the speed of the tool point as a frame has it (order 1), or its acceleration (order 2)."""
        return self.keeps("rates", (self.flange, *self.tcp[:3], frame, order), least, most, when, once=once)
