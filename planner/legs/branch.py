"""A branch of a control point: a working mode and a choice of full turns, over the times at which it can be met."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.kernels.meetings import least_durations, velocity_times
from assur.planner.robots.facts import Limits


@dataclass(frozen=True, eq=False)
class Branch:
    """The meetings of one mode with one choice of turns, (R, 1 + 3n) as `assur.planner.kernels.meetings` has them: the
    times, which do not decrease, and the joint states. `numbers` (R,): which times of the grid these are; `still`: the
    point can be met at any time, as in the first row."""

    mode: int
    meetings: FloatArray
    numbers: IntArray
    still: bool

    @property
    def n(self) -> int:
        return int(self.meetings.shape[1] - 1) // 3

    @property
    def time(self) -> FloatArray:
        """(R,) s."""
        return np.asarray(self.meetings[:, 0])

    @property
    def q(self) -> FloatArray:
        """(R, n)."""
        return np.asarray(self.meetings[:, 1 : 1 + self.n])

    @property
    def qd(self) -> FloatArray:
        """(R, n)."""
        return np.asarray(self.meetings[:, 1 + self.n : 1 + 2 * self.n])

    @property
    def qdd(self) -> FloatArray:
        """(R, n)."""
        return np.asarray(self.meetings[:, 1 + 2 * self.n :])

    def velocity_times(self, q: list[float], velocity: list[float]) -> FloatArray:
        """Seconds (R,) that the joints take at least from q to each meeting, by their velocities alone."""
        found = np.empty(len(self.meetings))
        velocity_times(np.array(q), self.meetings, np.array(velocity), found)
        return found

    def least_durations(self, start: FloatArray, limits: Limits, every: int, *, jerk_limited: bool) -> FloatArray:
        """Lower bounds, s, of the durations from the state `start` (3, n) to every so many-th meeting."""
        rows = self.meetings if every == 1 else np.ascontiguousarray(self.meetings[::every])
        found = np.empty(len(rows))
        least_durations(start, rows, limits.table, jerk_limited, found)
        return found
