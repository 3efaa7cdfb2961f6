"""Where the arm is, and how it moves, at one time; and knots of a part of a motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.kernels.meetings import velocity_times
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
class States:
    """States of the joints in rows: a table (K, 1 + 3n) of time, q, q̇, q̈."""

    table: FloatArray

    @property
    def n(self) -> int:
        return int(self.table.shape[1] - 1) // 3

    @property
    def time(self) -> FloatArray:
        """(K,) s."""
        return np.asarray(self.table[:, 0])

    @property
    def q(self) -> FloatArray:
        """(K, n)."""
        return np.asarray(self.table[:, 1 : 1 + self.n])

    @property
    def qd(self) -> FloatArray:
        """(K, n)."""
        return np.asarray(self.table[:, 1 + self.n : 1 + 2 * self.n])

    @property
    def qdd(self) -> FloatArray:
        """(K, n)."""
        return np.asarray(self.table[:, 1 + 2 * self.n :])


@dataclass(frozen=True, eq=False)
class Knots(States):
    """Knots of a part of a motion."""

    @property
    def begin(self) -> float:
        return float(self.table[0, 0])

    @property
    def end(self) -> float:
        return float(self.table[-1, 0])

    @property
    def last(self) -> State:
        row, n = self.table[-1], self.n
        return State(float(row[0]), row[1 : 1 + n], row[1 + n : 1 + 2 * n], row[1 + 2 * n :])

    def then(self, other: Knots) -> Knots:
        """These and those that begin where they end; the common knot is kept once."""
        return Knots(np.concatenate([self.table, other.table[1:]]))

    @staticmethod
    def of(trajectory: Trajectory) -> Knots:
        """Those of a trajectory."""
        return Knots(trajectory.knots)

    @staticmethod
    def made(time: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray) -> Knots:
        """Of times (K,) and states (K, n)."""
        return Knots(np.concatenate([time[:, None], q, qd, qdd], 1))

    @staticmethod
    def standing(state: State, until: float) -> Knots:
        """The arm at rest from the state's time to `until`."""
        table = np.zeros((2, 1 + 3 * len(state.q)))
        table[:, 0], table[:, 1 : 1 + len(state.q)] = (state.time, until), state.q
        return Knots(table)


@dataclass(frozen=True, eq=False)
class TimedLeg:
    """Knots with the kind of leg that they are and its route."""

    kind: LegKind
    knots: Knots
    route: Route | None = None

    @property
    def duration(self) -> float:
        """s."""
        return self.knots.end - self.knots.begin


# A branch of a control point: a working mode and a choice of full turns, over the times at which it can be met.


@dataclass(frozen=True, eq=False)
class Branch(States):
    """The meetings of one mode with one choice of turns, a row each, at times that do not decrease. `numbers` (R,):
    which times of the grid these are; `still`: the point can be met at any time, as in the first row."""

    mode: int
    numbers: IntArray
    still: bool

    def velocity_times(self, q: list[float], velocity: list[float]) -> FloatArray:
        """Seconds (R,) that the joints take at least from q to each meeting, by their velocities alone."""
        found = np.empty(len(self.table))
        velocity_times(np.array(q), self.table, np.array(velocity), found)
        return found
