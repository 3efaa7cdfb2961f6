"""Where the arm is, and how it moves, at one time; and knots of a stretch of motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.outcome import LegKind, Route
from assur.planner.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class State:
    """Joint state at `time`: q, q̇, q̈ (n,)."""

    time: float
    q: FloatArray
    qd: FloatArray
    qdd: FloatArray

    @property
    def resting(self) -> bool:
        return not (self.qd.any() or self.qdd.any())


@dataclass(frozen=True, eq=False)
class Knots:
    """Knots of a stretch of motion: time (K,), q, q̇, q̈ (K, n)."""

    time: FloatArray
    q: FloatArray
    qd: FloatArray
    qdd: FloatArray

    @property
    def last(self) -> State:
        return State(float(self.time[-1]), self.q[-1], self.qd[-1], self.qdd[-1])

    def then(self, other: Knots) -> Knots:
        """This stretch and one that begins where it ends; the common knot is kept once."""
        return Knots(
            np.concatenate([self.time, other.time[1:]]),
            np.concatenate([self.q, other.q[1:]]),
            np.concatenate([self.qd, other.qd[1:]]),
            np.concatenate([self.qdd, other.qdd[1:]]),
        )

    @staticmethod
    def of(trajectory: Trajectory) -> Knots:
        """Those of a trajectory."""
        return Knots(trajectory.time, trajectory.q, trajectory.qd, trajectory.qdd)

    @staticmethod
    def standing(state: State, until: float) -> Knots:
        """The arm at rest from the state's time to `until`."""
        zero = np.zeros((2, len(state.q)))
        return Knots(np.array([state.time, until]), np.stack([state.q, state.q]), zero, zero)


@dataclass(frozen=True, eq=False)
class Stretch:
    """Knots with the kind of leg that they are and its route."""

    kind: LegKind
    knots: Knots
    route: Route | None = None
