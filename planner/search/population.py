"""The ways by free vias that one chain has looked at: new ones are drawn, good ones varied, the best are tried.

Drawing and looking cost a twentieth of timing and screening, so many are looked at for each that is tried.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import BoolArray
from assur.planner.frames import all_stand
from assur.planner.model.scene import Move, Scene
from assur.planner.search.meeting_options import Option
from assur.planner.search.partial_plan import Chain, Sample
from assur.planner.search.rough_score import LOOKS, Glance
from assur.planner.search.via_batch import Freedom, Prospects, together

LOOKED_AT = (64, 96, 128)
"""Ways that are looked at in the first rounds of a chain, and in all later ones: the first reacts sooner."""
MOST_ROWS = 200_000
"""Ways of a round × looks at each × pairs of bodies, about: in large cells fewer ways are looked at ..."""
FEWEST = 16
"""... but never fewer than this."""
KEPT = 64
"""Ways that are remembered."""
PARENTS = 24
"""The best of them are varied."""
VARIED = 0.5
"""Share of a round that are variations, once there is something to vary."""
TRIED = (3, 8)
"""Ways of a round that are tried at least, and at most."""
NEARLY_FREE = 0.06
"""Ways that seem to be in the way of something at this share of the looks or less may be free: motions are rough."""
DIRECT, ONE_VIA, TWO_VIAS = 0.5, 1.6, 1.6
"""Weights of ways without, with one and with two vias. Without one there must be a wait, or a later meeting."""
TOWARDS = 0.45
"""Share of ways that lead to the first option, of the rest that lead to the second, and so on."""
GLUE_EFFORTS = (1.0, 1.0, 0.7, 0.4)
"""Shares of the limits that the glued legs at a point use."""


def glue_effort(rng: np.random.Generator) -> tuple[float, float]:
    """How hard glued legs go, and how gently the arm comes to rest in the end."""
    return float(rng.choice(GLUE_EFFORTS)), float(rng.uniform(1.0, 2.0))


class Population:
    """The ways of one chain to its options, and how good they are known to be."""

    def __init__(
        self,
        scene: Scene,
        chain: Chain,
        options: tuple[Option, ...],
        glance: Glance,
        rng: np.random.Generator,
        *,
        adaptive: bool,
    ) -> None:
        self.options, self.glance, self.rng, self.adaptive = options, glance, rng, adaptive
        self.freedom = _freedom(scene, chain, options)
        self.shares = np.array([DIRECT if self.freedom.moving else 0.0, ONE_VIA, TWO_VIAS])
        most = MOST_ROWS // (LOOKS * max(1, glance.pairs))
        self.sizes = tuple(min(size, max(FEWEST, most)) for size in LOOKED_AT)
        self.rounds = 0
        self.ways = self.freedom.direct()
        self.bad, self.end = glance(self.ways, rng)
        self.tried: BoolArray = np.zeros(len(self.ways), dtype=bool)
        self.number: dict[int, int] = {}
        """Where each sample that is being tried stands, by its id. The samples live until the next batch."""

    def batch(self, before: float) -> list[tuple[Option, Sample]]:
        """Looks at a round of ways and gives the best that were not tried yet and may end before `before`, s."""
        least, most = TRIED
        count = self.sizes[min(self.rounds, len(self.sizes) - 1)]
        # where most of what seems free is refused for what a glance does not see, looking at more does not help
        self._add(self._new(count if self._promising(before) < most else FEWEST))
        left = np.flatnonzero(~self.tried & (self.end < before))
        chosen = left[: max(least, min(most, self._promising(before)))].tolist()
        self.tried[chosen] = True
        found = [(self.options[int(self.ways.option[i])], self._sample(self.ways, i)) for i in chosen]
        self.number = {id(sample): i for i, (_, sample) in zip(chosen, found, strict=True)}
        return found

    def anyone(self) -> tuple[Option, Sample]:
        """A new way, whatever it looks like: that nothing seems worth a try in one round ends no search."""
        way = self.freedom.drawn(self.rng, 1, self.shares)
        return self.options[int(way.option[0])], self._sample(way, 0)

    def learn(self, sample: Sample, bad: float, at: float | None) -> None:
        """What came of a way that was tried: the share of its samples that were in the way of something, and when."""
        i = self.number.get(id(sample))
        if i is None:
            return
        if at is not None and self.bad[i] <= NEARLY_FREE:
            self.glance.remember(at)
        self.bad[i] = max(bad, float(self.bad[i]))

    def _promising(self, before: float) -> int:
        """How many ways that may be free wait to be tried."""
        return int((~self.tried & (self.end < before) & (self.bad <= NEARLY_FREE)).sum())

    def _new(self, count: int) -> Prospects:
        varied = int(VARIED * count) if self.adaptive and self.rounds else 0
        self.rounds += 1
        drawn = self.freedom.drawn(self.rng, count - varied, self.shares)
        if not varied:
            return drawn
        parents = self.rng.integers(min(PARENTS, len(self.ways)), size=varied)
        return together([drawn, self.freedom.varied(self.rng, self.ways.some(parents))])

    def _add(self, new: Prospects) -> None:
        """Keeps the best of all, those that are least in the way first, then the earliest."""
        bad, end = self.glance(new, self.rng)
        bad, end = np.concatenate([self.bad, bad]), np.concatenate([self.end, end])
        tried = np.concatenate([self.tried, np.zeros(len(new), dtype=bool)])
        order = np.lexsort((end, bad))[:KEPT]
        self.ways = together([self.ways, new]).some(order)
        self.bad, self.end, self.tried = bad[order], end[order], tried[order]

    def _sample(self, ways: Prospects, i: int) -> Sample:
        option = self.options[int(ways.option[i])]
        return Sample(option.yaw_offset, option.branch, ways.shape(i), *glue_effort(self.rng))


def _freedom(scene: Scene, chain: Chain, options: tuple[Option, ...]) -> Freedom:
    step = scene.task[chain.step]
    weights = TOWARDS * np.power(1 - TOWARDS, np.arange(len(options)))
    return Freedom(
        robot=scene.robot,
        start=chain.state.q,
        goals=np.array([option.branch.q[int(np.argmax(option.branch.legal))] for option in options]),
        weights=weights / weights.sum(),
        waits=chain.state.resting,
        moving=not all_stand(scene.frames.values()),
        late=np.array([not option.branch.still for option in options]),
        via=isinstance(step, Move) and step.via,
    )
