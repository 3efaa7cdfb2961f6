"""The candidates by free vias from one partial plan: new ones are drawn, good ones varied, the best are tried.

Drawing and scoring one costs a small share of timing and screening it, so many are scored for each that is tried.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.kernels.candidates import OPTION
from assur.planner.laws import all_stand
from assur.planner.legs.overlap import may_stop
from assur.planner.model.scene import Scene
from assur.planner.search import tuning
from assur.planner.search.partial_plan import Candidate, Option, PartialPlan, can_wait
from assur.planner.search.rough_score import CoarseScore
from assur.planner.search.via_batch import Freedom, shape_of


def at_the_point(rng: np.random.Generator, *, may_stop: bool) -> tuple[float, float, bool]:
    """How hard tracking legs go, how gently the arm comes to rest in the end, whether it stops behind the depart."""
    effort, pace, stop = rng.random(3).tolist()
    efforts = tuning.TRACKING_EFFORTS
    return efforts[int(effort * len(efforts))], 1.0 + pace, may_stop and stop < tuning.STOPS


class Population:
    """The candidates from one partial plan to its options, a row each, and how good they are known to be."""

    def __init__(
        self,
        scene: Scene,
        partial: PartialPlan,
        options: tuple[Option, ...],
        score: CoarseScore,
        rng: np.random.Generator,
        *,
        adaptive: bool,
    ) -> None:
        self.options, self.score, self.rng, self.adaptive = options, score, rng, adaptive
        self.may_stop = may_stop(scene, partial.step)
        self.freedom = _freedom(scene, partial, options)
        self.shares = np.array([tuning.DIRECT if self.freedom.moving else 0.0, tuning.ONE_VIA, tuning.TWO_VIAS])
        most = tuning.MOST_ROWS // (tuning.INSTANTS * max(1, score.pairs))
        self.sizes = tuple(min(size, max(tuning.FEWEST, most)) for size in tuning.EVALUATED)
        self.rounds = 0
        self.rows = self.freedom.direct()
        self.bad, self.end = score(self.rows, rng)
        self.tried: BoolArray = np.zeros(len(self.rows), dtype=bool)
        self.number: dict[Candidate, int] = {}
        """The row of each candidate that is being tried."""

    def batch(self, before: float) -> list[Candidate]:
        """Scores a round of candidates and gives the best that were not tried yet and may end before `before`, s."""
        least, most = tuning.TRIED
        count = self.sizes[min(self.rounds, len(self.sizes) - 1)]
        # where most of what seems free is refused for what the score does not see, scoring more does not help
        self._add(self._new(count if self._promising(before) < most else tuning.FEWEST))
        left = np.flatnonzero(~self.tried & (self.end < before))
        chosen = left[: max(least, min(most, self._promising(before)))]
        chosen = chosen[np.argsort(self.end[chosen], kind="stable")].tolist()
        self.tried[chosen] = True
        self.number = {self._candidate(self.rows[i]): i for i in chosen}
        return list(self.number)

    def anyone(self) -> Candidate:
        """A new one, whatever its score: that nothing seems worth a try in one round ends no search."""
        return self._candidate(self.freedom.drawn(self.rng, 1, self.shares)[0])

    def learn(self, candidate: Candidate, bad: float, at: float | None) -> None:
        """What came of one that was tried: how deep it was in something (`score_of`), and when."""
        i = self.number.get(candidate)
        if i is None:
            return
        if at is not None and self.bad[i] <= tuning.NEARLY_FREE:
            self.score.remember(at)
        self.bad[i] = max(bad, float(self.bad[i]))

    def _promising(self, before: float) -> int:
        """How many that may be free wait to be tried."""
        return int((~self.tried & (self.end < before) & (self.bad <= tuning.NEARLY_FREE)).sum())

    def _new(self, count: int) -> FloatArray:
        varied = int(tuning.VARIED * count) if self.adaptive and self.rounds else 0
        self.rounds += 1
        drawn = self.freedom.drawn(self.rng, count - varied, self.shares)
        if not varied:
            return drawn
        parents = self.rng.integers(min(tuning.PARENTS, len(self.rows)), size=varied)
        return np.concatenate([drawn, self.freedom.varied(self.rng, self.rows[parents])])

    def _add(self, new: FloatArray) -> None:
        """Keeps the best of all, those that are least in the way first, then the earliest."""
        bad, end = self.score(new, self.rng)
        bad, end = np.concatenate([self.bad, bad]), np.concatenate([self.end, end])
        tried = np.concatenate([self.tried, np.zeros(len(new), dtype=bool)])
        order = np.lexsort((end, bad))[: tuning.KEPT]
        self.rows = np.concatenate([self.rows, new])[order]
        self.bad, self.end, self.tried = bad[order], end[order], tried[order]

    def _candidate(self, row: FloatArray) -> Candidate:
        there = at_the_point(self.rng, may_stop=self.may_stop)
        return Candidate(self.options[int(row[OPTION])], shape_of(row), *there)


def _freedom(scene: Scene, partial: PartialPlan, options: tuple[Option, ...]) -> Freedom:
    step = scene.task[partial.step]
    weights = tuning.TOWARDS * np.power(1 - tuning.TOWARDS, np.arange(len(options)))
    return Freedom(
        robot=scene.robot,
        start=partial.state.q,
        goals=np.array([option.branch.q[0] for option in options]),
        weights=weights / weights.sum(),
        waits=can_wait(scene, partial),
        moving=not all_stand(scene.frames.values()),
        late=np.array([not option.branch.still for option in options]),
        via=step.via,
    )
