"""Random candidates for the next control point by free vias, drawn many at a time: rows of a table, none is timed yet.

The columns are those of `assur.planner.kernels.candidates`. Candidates are cheap enough to draw many and time few:
their coarse score (`rough_score`) tells which are worth it.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
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
from assur.planner.kernels.drawing import (
    CHANCES,
    CLEARS,
    EARLIEST,
    LATEST,
    LIFTS,
    NUDGED,
    TURNS,
    VARIED_CHANCES,
    VARIED_NORMALS,
    VIA_CHANCES,
    draw,
    free_via,
    vary,
)
from assur.planner.laws import all_stand
from assur.planner.legs.joint import Shape, Via
from assur.planner.model.scene import Scene
from assur.planner.robots.robot import Robot
from assur.planner.search.partial_plan import Option, PartialPlan, can_wait
from assur.planner.search.tuning import TOWARDS


def roles(robot: Robot) -> IntArray:
    """What each joint (n,) does in a free via: the wrist only turns with the way, the lift has a rule of its own."""
    found = np.full(len(robot.joints), TURNS)
    found[:NUDGED] = CLEARS
    if robot.lift is not None:
        found[robot.lift] = LIFTS
    return found


def free_vias(
    rng: np.random.Generator, robot: Robot, start: FloatArray, goal: FloatArray, count: int
) -> tuple[FloatArray, ...]:
    """`count` joint positions (n,), within limits, on a way from `start` (n,) to `goal` (n,)."""
    n, found = len(start), np.empty((count, len(start)))
    shares = np.sort(rng.uniform(EARLIEST, LATEST, count))
    chances, normals = rng.random((count, VIA_CHANCES + n)), rng.standard_normal((count, n))
    begin, end = np.array(start), np.array(goal)
    for k in range(count):
        free_via(robot.limits.table, roles(robot), begin, end, shares[k], chances[k], normals[k], found[k])
    return tuple(found)


def shape_of(row: FloatArray) -> Shape:
    """A candidate as a shape that can be timed."""
    numbers, n = row.tolist(), (len(row) - FIRST_VIA) // MOST_VIAS
    vias, first = list[Via](), FIRST_VIA
    for k in range(int(numbers[VIAS])):
        vias.append(Via(numbers[first : first + n], numbers[PACES + k]))
        first += n
    return Shape(numbers[WAIT], numbers[LATE], tuple(vias), effort=numbers[EFFORT], through=numbers[THROUGH])


class Freedom:
    """What the candidates from one partial plan to its options may differ in: the option, the vias, and where that is
    possible the wait, how late they are, and how they pass the control point."""

    def __init__(self, scene: Scene, partial: PartialPlan, options: tuple[Option, ...]) -> None:
        weights = TOWARDS * (1 - TOWARDS) ** np.arange(len(options))
        limits, start = scene.robot.limits.table, np.array(partial.state.q)
        self.goals = np.array([option.branch.table[0, 1 : 1 + len(start)] for option in options])
        late = np.array([0.0 if option.branch.still else 1.0 for option in options])
        self.start, self.via = start, scene.task[partial.step].via
        self.waits, self.moving = can_wait(scene, partial), not all_stand(scene.frames.values())
        shares = weights.cumsum() / weights.sum()
        self._tables = limits, roles(scene.robot), start, self.goals, late, shares
        """What `draw` takes, from limits to options."""

    def drawn(self, rng: np.random.Generator, count: int, shares: FloatArray) -> FloatArray:
        """`count` new ones; `shares`: weights of direct ones (if they may wait or be late), and of one and two vias."""
        rows, n = self._rows(count), len(self.start)
        chances = rng.random((count, CHANCES + MOST_VIAS * (VIA_CHANCES + n)))
        normals = rng.standard_normal((count, MOST_VIAS * n))
        of_vias = shares.cumsum() / shares.sum()
        draw(*self._tables, of_vias, self.waits, self.moving, self.via, chances, normals, rows)
        return rows

    def direct(self) -> FloatArray:
        """The direct motion to each option."""
        rows = self._rows(len(self.goals))
        rows[:, OPTION], rows[:, EFFORT], rows[:, THROUGH] = np.arange(len(rows)), 1.0, self.via
        rows[:, FIRST_VIA:].reshape(len(rows), MOST_VIAS, -1)[:] = self.start
        return rows

    def varied(self, rng: np.random.Generator, parents: FloatArray) -> FloatArray:
        """One child of each."""
        count, rows = len(parents), np.empty_like(parents)
        chances = rng.random((count, VARIED_CHANCES))
        normals = rng.standard_normal((count, VARIED_NORMALS + MOST_VIAS * len(self.start)))
        limits, late = self._tables[0], self._tables[4]
        vary(limits, late, self.waits and self.moving, parents, chances, normals, rows)
        return rows

    def _rows(self, count: int) -> FloatArray:
        return np.zeros((count, FIRST_VIA + MOST_VIAS * len(self.start)))
