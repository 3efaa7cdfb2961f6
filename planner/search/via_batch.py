"""Random ways to the next control point by free vias, drawn many at a time: all are arrays, none is timed yet.

They are cheap enough to draw many and time few: `glance` tells from rough motions which of them are worth it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.legs.joint import Shape, Via
from assur.planner.robots.protocol import Robot
from assur.planner.search.free_vias import free_vias

MOST_VIAS = 2
"""Free vias of one way."""
PACES = (0.0, 0.4, 0.8, 1.2)
"""Paces at which a via is flown by."""
EFFORTS = (1.0, 1.0, 0.7, 0.4)
"""Shares of the limits of acceleration that are used."""
WAIT_S, LATE_S = 0.5, 0.3
"""Means of waits and of delays behind the earliest meeting, s."""
NUDGES = (0.03, 0.08)
"""Spread of a varied via, in ranges of the joints."""


@dataclass(frozen=True, eq=False)
class Prospects:
    """N ways. `option` (N,): number of the branch they lead to; `wait`, `late`, `effort`, `through` (N,) as in `Shape`;
    `count` (N,): number of vias, whose joints (N, 2, n) and paces (N, 2) come first in `via` and `pace`."""

    option: IntArray
    wait: FloatArray
    late: FloatArray
    effort: FloatArray
    through: FloatArray
    count: IntArray
    via: FloatArray
    pace: FloatArray

    def __len__(self) -> int:
        return len(self.option)

    def some(self, key: IntArray | BoolArray | slice) -> Prospects:
        """Some of them."""
        return Prospects(*(getattr(self, field.name)[key] for field in fields(self)))

    def shape(self, i: int) -> Shape:
        """Way number `i` as a shape that can be timed."""
        vias = tuple(Via(self.via[i, k], float(self.pace[i, k])) for k in range(int(self.count[i])))
        effort, through = float(self.effort[i]), float(self.through[i])
        return Shape(float(self.wait[i]), float(self.late[i]), vias, effort=effort, through=through)


def together(parts: Sequence[Prospects]) -> Prospects:
    """All of them, in order."""
    return Prospects(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Prospects)))


@dataclass(frozen=True, eq=False)
class Freedom:
    """What the ways of one chain may differ in. `goals` (M, n): joints about where each option is met; `weights` (M,)
    of the options; whether waiting, being late and flying by the control point are possible."""

    robot: Robot
    start: FloatArray
    goals: FloatArray
    weights: FloatArray
    waits: bool
    moving: bool
    late: BoolArray
    via: bool

    def drawn(self, rng: np.random.Generator, count: int, shares: FloatArray) -> Prospects:
        """`count` new ways; `shares`: weights of direct ways (if they may wait or be late), and of one and two vias."""
        option = rng.choice(len(self.goals), size=count, p=self.weights)
        vias = rng.choice(len(shares), size=count, p=shares / shares.sum())
        direct = vias == 0
        wait = rng.exponential(WAIT_S, count) * (self.waits & self.moving & (direct | (rng.random(count) < 0.3)))
        late = rng.exponential(LATE_S, count) * (self.late[option] & (rng.random(count) < 0.3))
        effort = rng.choice(EFFORTS, count) if self.moving else np.ones(count)
        through = rng.uniform(0.2, 1.0, count) * self.via
        via = free_vias(rng, self.robot, self.start, self.goals[option], MOST_VIAS)
        return Prospects(option, wait, late, effort, through, vias, via, rng.choice(PACES, (count, MOST_VIAS)))

    def direct(self) -> Prospects:
        """The direct way to each option."""
        count = len(self.goals)
        none, full, no_vias = np.zeros(count), np.ones(count), np.zeros(count, dtype=np.int64)
        via = np.broadcast_to(self.start, (count, MOST_VIAS, len(self.start)))
        return Prospects(np.arange(count), none, none, full, full * self.via, no_vias, via, via[..., 0] * 0.0)

    def varied(self, rng: np.random.Generator, parents: Prospects) -> Prospects:
        """One child of each."""
        limits, count = self.robot.limits, len(parents)
        spread = rng.choice(NUDGES, count)[:, None, None] * (limits.upper - limits.lower)
        spread[..., 3:] = 0.0
        via = parents.via + rng.normal(0.0, 1.0, parents.via.shape) * spread
        pace = np.maximum(0.0, parents.pace + rng.normal(0.0, 0.2, parents.pace.shape))
        wait, late = parents.wait, parents.late
        if self.waits and self.moving:
            wait = np.where(rng.random(count) < 0.5, np.maximum(0.0, wait + rng.normal(0.0, 0.1, count)), wait)
        nudged = self.late[parents.option] & (rng.random(count) < 0.5)
        late = np.where(nudged, np.maximum(0.0, late + rng.normal(0.0, 0.1, count)), late)
        # a direct way that nearly got through may need a via
        vias = np.where((parents.count == 0) & (rng.random(count) < 0.6), 1, parents.count)
        via = np.clip(via, limits.lower, limits.upper)
        return Prospects(parents.option, wait, late, parents.effort, parents.through, vias, via, pace)
