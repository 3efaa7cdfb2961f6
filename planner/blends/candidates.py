"""Samples ways by parabolic blends through a run of stations: the direct ones; round what blocks them, by free vias.

Seeded and adaptive: what was nearly free is mutated. Free poses are there to go round bodies: they are tried only on
ways that were timed and then refused.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.blends.timed import BlendShape, Station
from assur.planner.laws import all_stand
from assur.planner.model.scene import Scene
from assur.planner.search.meeting_options import preference
from assur.planner.search.partial_plan import PartialPlan
from assur.planner.search.via_batch import free_vias

DIRECT = 12
"""Choices of branches, a branch a station, that are tried directly, those with the shortest ways first ..."""
RAISED = 2
"""... and over the top."""
BATCH = 16
"""Random samples in a batch."""
MUTATED = 0.25
"""Share of random samples that are mutations of the best drafts so far, once there are any."""
ELITE = 6
"""Best drafts that are kept for mutation."""
COUNTS = (0, 1, 2)
"""Free vias on the way to one station ..."""
WEIGHTS = (0.3, 0.5, 0.2)
"""... and how often each number of them."""


@dataclass(eq=False)
class BlendSampler:
    """Samples for one partial; `choices`: for each step of the run the stations that it may be, none of them empty."""

    scene: Scene
    partial: PartialPlan
    choices: tuple[tuple[Station, ...], ...]
    rng: np.random.Generator
    adaptive: bool = True
    visits: int = 0
    ways: tuple[tuple[Station, ...], ...] = ()
    elite: list[tuple[float, BlendShape]] = field(default_factory=list)
    blocked: list[tuple[Station, ...]] = field(default_factory=list)
    """Ways that were timed directly, and then refused: only they are led round by free poses."""

    def __post_init__(self) -> None:
        self.ways = self._shortest()

    def batch(self) -> list[BlendShape]:
        """The next batch; empty only if a control point of the run can never be met."""
        visit, self.visits = self.visits, self.visits + 1
        if not self.ways:
            return []
        if visit == 0:
            return [BlendShape(way, ((),) * len(way)) for way in self.ways]
        raised = [shape for way in self.blocked[:RAISED] for shape in self._raised(way)] if visit == 1 else []
        return raised + [self._random() for _ in range(BATCH)]

    def block(self, shape: BlendShape) -> None:
        """A way was timed, and refused by what is in its way."""
        if not any(shape.frees) and shape.stations not in self.blocked:
            self.blocked.append(shape.stations)

    def learn(self, shape: BlendShape, bad: float) -> None:
        """`bad`: how deep a draft was in something (`score_of`); 0: it was free."""
        if self.adaptive:
            self.elite.append((bad, shape))
            self.elite.sort(key=lambda pair: pair[0])
            del self.elite[ELITE:]

    def _shortest(self) -> tuple[tuple[Station, ...], ...]:
        """Choices of a station each, those with the least time at full speed first, the wrist turned least, by beam."""
        velocity = self.scene.robot.limits.velocity
        beam: list[tuple[float, tuple[Station, ...], FloatArray]] = [(0.0, (), self.partial.state.q)]
        for stations in self.choices:
            longer = []
            for cost, way, q in beam:
                for station in stations:
                    at = _typical(station)
                    least = float(np.max(np.abs(at - q) / velocity))
                    longer.append((cost + least * preference(self.scene.robot, q, at), (*way, station), at))
            beam = sorted(longer, key=lambda item: item[0])[:DIRECT]
        return tuple(way for _, way, _ in beam if way)

    def _poses(self, way: tuple[Station, ...]) -> list[FloatArray]:
        return [self.partial.state.q, *map(_typical, way)]

    def _raised(self, way: tuple[Station, ...]) -> list[BlendShape]:
        """Up, over and down on the way to each station, as high as the lift goes, and half as high."""
        lift = self.scene.robot.lift
        if lift is None:
            return []
        upper = float(self.scene.robot.limits.upper[lift])
        poses = self._poses(way)
        highest = max(float(q[lift]) for q in poses)
        made = []
        for top in (upper, (highest + upper) / 2):
            if top > highest + 1e-3:
                frees = []
                for one, other in pairwise(poses):
                    pair = one.copy(), other.copy()
                    pair[0][lift] = pair[1][lift] = top
                    frees.append(pair)
                made.append(BlendShape(way, tuple(frees)))
        return made

    def _random(self) -> BlendShape:
        rng = self.rng
        if self.adaptive and self.elite and rng.random() < MUTATED:
            return self._mutated()
        ways = self.blocked or self.ways
        way = ways[min(len(ways), int(rng.geometric(0.45))) - 1]
        poses = self._poses(way)
        frees = []
        for one, other in pairwise(poses):
            count = int(rng.choice(COUNTS, p=WEIGHTS)) if self.blocked else 0
            frees.append(free_vias(rng, self.scene.robot, one, other, count))
        wait = float(rng.exponential(0.35)) if self.moving() and rng.random() < 0.4 else 0.0
        return BlendShape(way, tuple(frees), wait, float(rng.choice([1.0, 1.0, 0.7, 0.4])))

    def _mutated(self) -> BlendShape:
        rng, limits = self.rng, self.scene.robot.limits
        _, parent = self.elite[int(rng.integers(len(self.elite)))]
        spread = float(rng.choice([0.03, 0.08])) * (limits.upper - limits.lower)
        spread[3:] = 0.0
        frees = tuple(
            tuple(np.clip(q + rng.normal(0.0, 1.0, len(q)) * spread, limits.lower, limits.upper) for q in free)
            for free in parent.frees
        )
        wait = parent.wait
        if self.moving() and rng.random() < 0.5:
            wait = max(0.0, wait + float(rng.normal(0.0, 0.1)))
        if not any(frees) and parent.stations in self.blocked:
            # a way that was nearly free is led around at one place
            poses = self._poses(parent.stations)
            k = int(rng.integers(len(frees)))
            via = free_vias(rng, self.scene.robot, poses[k], poses[k + 1], 1)
            frees = (*frees[:k], via, *frees[k + 1 :])
        return replace(parent, frees=frees, wait=wait)

    def moving(self) -> bool:
        """Whether anything moves, so that waiting may change what is in the way."""
        return not all_stand(self.scene.frames.values())


def _typical(station: Station) -> FloatArray:
    """Joints (n,) at the first time at which the station may be met."""
    return np.asarray(station.branch.q[0])
