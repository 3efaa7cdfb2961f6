"""A timed motion as the solver gave it: positions to some micrometres, for screening; the exact profile on demand.

Most candidates are refused after a look at where they go. Reading the solver's phases and making their ends exact
costs more than timing them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.timing.ends import Cubics
from assur.planner.timing.profile import Profile, finished
from assur.planner.timing.question import Numbers


class Solved(Protocol):
    """What the solver found, read as far as it is asked for."""

    def positions(self, times: list[float]) -> list[list[float]]:
        """q at times within the motion, n numbers each; `FaultError` for a time that is not finite."""
        ...

    def cubics(self) -> list[Cubics]:
        """The phases of every joint."""
        ...


@dataclass(frozen=True, eq=False)
class Sketch:
    """Motion of n joints over [0, `duration`] s from the state `begin` to `goal`, as it was `solved`."""

    duration: float
    begin: Numbers
    goal: Numbers
    solved: Solved

    @cached_property
    def profile(self) -> Profile:
        """The same motion with exact ends."""
        return finished(self.solved.cubics(), [*self.begin, *self.goal], self.duration)

    def positions(self, t: FloatArray) -> FloatArray:
        """q (T, n) at times t (T,), the joints standing still before and after; off by some 1e-6.

        Raises `FaultError` for a time that is not a number.
        """
        times = np.minimum(np.maximum(t, 0.0), self.duration).tolist()
        return np.array(self.solved.positions(times)).reshape(len(times), len(self.begin[0]))


@dataclass(frozen=True, eq=False)
class Settled:
    """A motion whose profile is already there, seen as a sketch."""

    profile: Profile

    @property
    def duration(self) -> float:
        return self.profile.duration

    def positions(self, t: FloatArray) -> FloatArray:
        """q (T, n) at times t (T,), the joints standing still before and after."""
        return self.profile.evaluate(np.minimum(np.maximum(t, 0.0), self.duration))
