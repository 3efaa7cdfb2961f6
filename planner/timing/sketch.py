"""A timed motion as the solver gave it: positions to some micrometres, for screening; the exact profile on demand.

Most candidates are refused after a look at where they go. Making their ends exact costs more than timing them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from planner.arrays import FloatArray
from planner.timing.ends import Cubics
from planner.timing.profile import Profile, State, finished


@dataclass(frozen=True, eq=False)
class Sketch:
    """Motion of n joints over [0, `duration`] s between two states; `joints`: the solver's phases."""

    duration: float
    start: State
    end: State
    joints: tuple[Cubics, ...]

    @cached_property
    def profile(self) -> Profile:
        """The same motion with exact ends."""
        return finished(list(self.joints), [row.tolist() for row in (*self.start, *self.end)], self.duration)

    @cached_property
    def _columns(self) -> tuple[FloatArray, FloatArray]:
        """Begins of the phases (n, S), and position, velocity, half the acceleration, a sixth of the jerk there."""
        begins = np.array([joint.t for joint in self.joints])
        rows = np.array([(joint.p, joint.v, joint.a, joint.j) for joint in self.joints])
        return begins, rows * np.array([1.0, 1.0, 0.5, 1 / 6])[:, None]

    def positions(self, t: FloatArray) -> FloatArray:
        """q (T, n) at times t (T,), the joints standing still before and after; off by some 1e-6."""
        begins, rows = self._columns
        t = np.minimum(np.maximum(t, 0.0), self.duration)[:, None]
        phase = (t[:, :, None] >= begins).sum(-1) - 1
        joint = np.arange(len(begins))
        tau = t - begins[joint, phase]
        c = rows[joint, :, phase]
        found: FloatArray = ((c[..., 3] * tau + c[..., 2]) * tau + c[..., 1]) * tau + c[..., 0]
        return found


@dataclass(frozen=True, eq=False)
class Settled:
    """A motion whose profile is already there, seen as a sketch."""

    profile: Profile

    @property
    def duration(self) -> float:
        return self.profile.duration

    @property
    def start(self) -> State:
        return self.profile.start

    @property
    def end(self) -> State:
        return self.profile.end

    def positions(self, t: FloatArray) -> FloatArray:
        """q (T, n) at times t (T,), the joints standing still before and after."""
        return self.profile.evaluate(np.minimum(np.maximum(t, 0.0), self.duration))
