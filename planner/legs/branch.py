"""A branch of a control point: a working mode and a choice of full turns, over the times at which it may be met."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, reduce

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Branch:
    """Joint states (G, n) at meeting times (G,) in one mode with one choice of turns; `legal` (G,): may be met then."""

    mode: int
    time: FloatArray
    q: FloatArray
    qd: FloatArray
    qdd: FloatArray
    legal: BoolArray
    still: bool

    @cached_property
    def rows(self) -> IntArray:
        """Numbers (R,) of the meeting times that are legal."""
        return np.flatnonzero(self.legal)

    @cached_property
    def times(self) -> FloatArray:
        """Those times (R,), s; they do not decrease."""
        found: FloatArray = self.time[self.rows]
        return found

    @cached_property
    def _joint_by_joint(self) -> FloatArray:
        """q (n, R) at those times: over long rows NumPy is ten times as fast."""
        return np.ascontiguousarray(self.q[self.rows].T)

    def least(self, q: Sequence[float], velocity: Sequence[float]) -> FloatArray:
        """Seconds (R,) that the joints take at least from q to each legal meeting, by their velocities alone."""
        rows = zip(self._joint_by_joint, q, velocity, strict=True)
        return reduce(np.maximum, (np.abs(row - x) / v for row, x, v in rows))
