"""Random candidates for the next control point by free vias, drawn many at a time: rows of a table, none is timed yet.

The columns are those of `assur.planner.kernels.candidates`. Candidates are cheap enough to draw many and time few:
their coarse score (`rough_score`) tells which are worth it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.kernels.candidates import (
    EFFORT,
    FIRST_VIA,
    LATE,
    MOST_VIAS,
    OPTION,
    PACES,
    THROUGH,
    VIAS,
    WAIT,
)
from assur.planner.legs.joint import Shape, Via
from assur.planner.robots.robot import Robot
from assur.planner.search import tuning
from assur.planner.search.free_vias import free_vias


def shape_of(row: FloatArray) -> Shape:
    """A candidate as a shape that can be timed."""
    via = row[FIRST_VIA:].reshape(MOST_VIAS, -1)
    vias = tuple(Via(via[k], float(row[PACES + k])) for k in range(int(row[VIAS])))
    wait, late, effort, through = (float(row[column]) for column in (WAIT, LATE, EFFORT, THROUGH))
    return Shape(wait, late, vias, effort=effort, through=through)


@dataclass(frozen=True, eq=False)
class Freedom:
    """What the candidates from one partial plan may differ in. `goals` (M, n): joints about where each option is met;
    `weights` (M,) of the options; whether waiting, being late and passing the control point are possible."""

    robot: Robot
    start: FloatArray
    goals: FloatArray
    weights: FloatArray
    waits: bool
    moving: bool
    late: BoolArray
    via: bool

    def drawn(self, rng: np.random.Generator, count: int, shares: FloatArray) -> FloatArray:
        """`count` new ones; `shares`: weights of direct ones (if they may wait or be late), and of one and two vias."""
        rows = self._rows(count)
        option = rng.choice(len(self.goals), size=count, p=self.weights)
        vias = rng.choice(len(shares), size=count, p=shares / shares.sum())
        rows[:, OPTION], rows[:, VIAS] = option, vias
        wait, waits_too = rng.exponential(tuning.WAIT_S, count), rng.random(count) < tuning.WAIT_TOO
        rows[:, WAIT] = wait * (self.waits & self.moving & ((vias == 0) | waits_too))
        late, late_too = rng.exponential(tuning.LATE_S, count), rng.random(count) < tuning.LATE_TOO
        rows[:, LATE] = late * (self.late[option] & late_too)
        rows[:, EFFORT] = rng.choice(tuning.EFFORTS, count) if self.moving else 1.0
        rows[:, THROUGH] = rng.uniform(*tuning.THROUGH, count) * self.via
        rows[:, FIRST_VIA:] = free_vias(rng, self.robot, self.start, self.goals[option], MOST_VIAS).reshape(count, -1)
        rows[:, PACES:FIRST_VIA] = rng.choice(tuning.VIA_PACES, (count, MOST_VIAS))
        return rows

    def direct(self) -> FloatArray:
        """The direct motion to each option."""
        rows = self._rows(len(self.goals))
        rows[:, OPTION], rows[:, EFFORT], rows[:, THROUGH] = np.arange(len(rows)), 1.0, self.via
        rows[:, FIRST_VIA:] = np.tile(self.start, MOST_VIAS)
        return rows

    def varied(self, rng: np.random.Generator, parents: FloatArray) -> FloatArray:
        """One child of each."""
        limits, count, rows = self.robot.limits, len(parents), parents.copy()
        spread = rng.choice(tuning.NUDGES, count)[:, None, None] * (limits.upper - limits.lower)
        spread[..., 3:] = 0.0
        via = parents[:, FIRST_VIA:].reshape(count, MOST_VIAS, -1)
        via = np.clip(via + rng.normal(0.0, 1.0, via.shape) * spread, limits.lower, limits.upper)
        rows[:, FIRST_VIA:] = via.reshape(count, -1)
        pace = parents[:, PACES:FIRST_VIA]
        rows[:, PACES:FIRST_VIA] = np.maximum(0.0, pace + rng.normal(0.0, tuning.PACE_NUDGE, pace.shape))
        times = [(LATE, self.late[parents[:, OPTION].astype(int)])]
        if self.waits and self.moving:
            times.insert(0, (WAIT, np.ones(count, dtype=bool)))
        for column, possible in times:
            nudged = possible & (rng.random(count) < tuning.NUDGED_TIME)
            other = np.maximum(0.0, rows[:, column] + rng.normal(0.0, tuning.TIME_NUDGE_S, count))
            rows[:, column] = np.where(nudged, other, rows[:, column])
        gains = (parents[:, VIAS] == 0) & (rng.random(count) < tuning.GAINS_A_VIA)
        rows[gains, VIAS] = 1
        return rows

    def _rows(self, count: int) -> FloatArray:
        return np.zeros((count, FIRST_VIA + MOST_VIAS * len(self.start)))
