"""Samples ways to the next control point: the direct ones and arches first, then those of a population by free vias.

Seeded and adaptive: what was free or nearly free is varied.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.kernels.candidates import END, OPTION, WAIT
from assur.planner.kernels.drawing import FASTEST_THROUGH, NUDGED_TIME, SLOWEST_THROUGH, TIME_NUDGE_S, WAIT_S
from assur.planner.laws import all_stand
from assur.planner.legs.joint import Shape
from assur.planner.legs.meeting import may_stop
from assur.planner.legs.missed import ArchForm, height_of, too_high
from assur.planner.model.refusal import Refusal
from assur.planner.model.scene import Scene, Step
from assur.planner.search import tuning
from assur.planner.search.partial_plan import Candidate, Option, PartialPlan, can_wait
from assur.planner.search.rough_score import CoarseScore
from assur.planner.search.via_batch import Freedom, shape_of

# The candidates by free vias from one partial plan: new ones are drawn, good ones varied, the best are tried.
#
# Drawing and scoring one costs a small share of timing and screening it, so many are scored for each that is tried:
# all at a few instants, and then those that may be free at many.


def at_the_point(chances: Sequence[float], *, may_stop: bool) -> tuple[float, float, bool]:
    """How hard tracking legs go, how gently the arm comes to rest in the end, whether it stops behind the depart, by
    three `chances`, uniform in [0, 1)."""
    effort, pace, stop = chances
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
    ) -> None:
        self.options, self.score, self.rng = options, score, rng
        self.may_stop = may_stop(scene, partial.step)
        self.freedom = Freedom(scene, partial, options)
        self.shares = np.array([tuning.DIRECT if self.freedom.moving else 0.0, tuning.ONE_VIA, tuning.TWO_VIAS])
        self.most = max(tuning.FEWEST, tuning.MOST_ROWS // (tuning.INSTANTS * max(1, score.pairs)))
        self.rounds = 0
        self.rows = self.freedom.direct()
        self.bad, self.end = np.zeros(len(self.rows)), score.rough(self.rows)[:, END]
        self.tried: BoolArray = np.zeros(len(self.rows), dtype=bool)
        self.number: dict[Candidate, int] = {}
        """The row of each candidate that is being tried."""

    def batch(self, before: float) -> list[Candidate]:
        """Scores a round of candidates and gives those that are free as far as their scores say, were not tried yet and
        may end before `before`, s, the quickest first; the best of them, if none is free."""
        count = min(self.most, tuning.EVALUATED[min(self.rounds, len(tuning.EVALUATED) - 1)])
        # where most of what seems free is refused for what the score does not see, scoring more does not help
        self._add(self._new(count if self._promising(before) < tuning.TRIED else tuning.FEWEST))
        rows = np.flatnonzero(~self.tried & (self.end < before))
        rows = rows[: max(1, min(tuning.CHECKED, self._promising(before)))]
        chosen = rows[:0]
        for first in range(0, len(rows), tuning.TRIED):
            chosen = self._free(rows[first : first + tuning.TRIED])
            if len(chosen):
                break
        else:
            chosen = rows[self.bad[rows].argsort()[:1]]
        chosen = chosen[np.argsort(self.end[chosen], kind="stable")].tolist()
        self.tried[chosen] = True
        self.number = dict(zip(self._candidates(self.rows[chosen]), chosen, strict=True))
        return list(self.number)

    def _free(self, rows: IntArray) -> IntArray:
        """Those of the candidates in these rows that are free at many instants, too. The others count as tried."""
        may = rows[self.bad[rows] <= tuning.NEARLY_FREE]
        if len(may):
            self.bad[may] = np.maximum(self.bad[may], self.score.finely(self.rows[may])[0])
        free = self.bad[rows] <= tuning.FREE
        self.tried[rows[~free]] = True
        return rows[free]

    def free_direct(self, candidates: list[Candidate]) -> list[Candidate]:
        """Those direct ways to options that are free as far as their scores say, the quickest first. All count as tried
        from now on."""
        rows = np.array([self.options.index(each.option) for each in candidates])
        free = self._free(np.unique(rows))
        self.tried[rows] = True
        self.number = {each: row for each, row in zip(candidates, rows.tolist(), strict=True) if row in free}
        return sorted(self.number, key=lambda each: float(self.end[self.number[each]]))

    def free_arches(self, candidates: list[Candidate]) -> list[Candidate]:
        """Those arches that are free as far as their scores say, the quickest first."""
        rows = self.freedom.direct()[[self.options.index(each.option) for each in candidates]]
        rows[:, WAIT] = [each.shape.wait for each in candidates]
        forms = [each.shape.form for each in candidates if each.shape.form is not None]
        bad, end = self.score.arches(rows, forms)
        return [candidates[k] for k in end.argsort(kind="stable").tolist() if not bad[k] > tuning.FREE]

    def anyone(self) -> Candidate:
        """A new one, whatever its score: that nothing seems worth a try in one round ends no search."""
        return self._candidates(self.freedom.drawn(self.rng, 1, self.shares))[0]

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
        varied = int(tuning.VARIED * count) if self.rounds else 0
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

    def _candidates(self, rows: FloatArray) -> list[Candidate]:
        chances = self.rng.random((len(rows), 3)).tolist()
        return [
            Candidate(self.options[int(row[OPTION])], shape_of(row), *at_the_point(each, may_stop=self.may_stop))
            for row, each in zip(rows, chances, strict=True)
        ]


@dataclass(eq=False)
class Sampler:
    """Samples for one partial. What it learned stays with it. `score`: makes what scores many candidates at once."""

    scene: Scene
    partial: PartialPlan
    options: tuple[Option, ...]
    rng: np.random.Generator
    score: Callable[[], CoarseScore]
    visits: int = 0
    population: Population | None = None
    elite: list[tuple[float, float, Candidate]] = field(default_factory=list)
    ordered: bool = False
    """Whether the candidates of the last batch that are probably the quickest come first in it."""
    _firsts: Iterator[list[Candidate]] = field(default_factory=lambda: iter(()))

    def __post_init__(self) -> None:
        self.step: Step = self.scene.task[self.partial.step]
        self.may_stop = may_stop(self.scene, self.partial.step)

    def batch(self, before: float = np.inf) -> list[Candidate]:
        """The next batch, of ways that may end before `before`, s; empty only if there is nothing left to try."""
        visit, self.visits, self.ordered = self.visits, self.visits + 1, False
        if not self.options:
            return []
        if self.step.leg == "cartesian":
            if visit == 0:
                return self._direct()
            # a straight leg from a moving frame has nothing to choose: it has been tried
            return [self._wait() for _ in range(tuning.BATCH)] if can_wait(self.scene, self.partial) else []
        if self.step.arch is not None:
            return (self._arches() if visit == 0 else []) or [self._arch() for _ in range(tuning.BATCH)]
        if self.population is None:
            self.population = Population(self.scene, self.partial, self.options, self.score(), self.rng)
            self._firsts = self._simple(self.population)
        self.ordered = True
        simple = next(self._firsts, [])
        if simple:
            return simple
        found = self.population.batch(before)
        arches = max(tuning.FILLED - len(found), int(self.rng.random() < tuning.ARCHES_TOO)) if self._tops() else 0
        if arches:
            found += self.population.free_arches([self._arch() for _ in range(arches)])
        return found or [self.population.anyone()]

    def _simple(self, population: Population) -> Iterator[list[Candidate]]:
        """The direct ways and then the arches, first those that are free as far as their scores say. An empty batch:
        candidates by vias are worth more."""
        later = list[Candidate]()
        for some, free_of in ((self._direct, population.free_direct), (self._arches, population.free_arches)):
            candidates = some()
            free = free_of(candidates) if candidates else []
            if free:
                yield free
            later += [each for each in candidates if each not in free]
        yield from [[]] * tuning.LATER
        self.ordered = False
        yield later

    def learn(self, candidate: Candidate, bad: float, end: float = math.inf, at: float | None = None) -> None:
        """`bad`: how deep a candidate was in something (`score_of`); 0: it was free; 1: it was refused for something
        else. `end`: when it ends, `at`: when something was in its way, s."""
        if self.population is not None:
            self.population.learn(candidate, bad, at)
        if candidate.shape.form is not None:
            self.elite = [each for each in self.elite if each[2] is not candidate] + [(bad, end, candidate)]
            self.elite.sort(key=lambda each: each[:2])
            del self.elite[tuning.ELITE :]

    def _direct(self) -> list[Candidate]:
        """Directly to the option of each mode that is met first."""
        if self.step.arch is not None:
            return []
        paces = tuning.THROUGH_PACES if self.step.via else (0.0,)
        return [
            Candidate(option, Shape(through=pace), stops=stops)
            for option in self._first_of_modes()
            for pace in paces
            for stops in self._stops()
        ]

    def _stops(self) -> tuple[bool, ...]:
        """Whether the first candidates stop behind the depart: those, too, where the arm may have to wait there."""
        return (False, True) if self.may_stop and not all_stand(self.scene.frames.values()) else (False,)

    def _first_of_modes(self) -> list[Option]:
        found: dict[int, Option] = {}
        for option in self.options:
            found.setdefault(option.branch.mode, option)
        return list(found.values())

    def _arches(self) -> list[Candidate]:
        tops = self._tops()
        if not tops or self.step.leg == "cartesian":
            return []
        through = tuning.THROUGH_PACES[0] if self.step.via else 0.0
        found = []
        for option in self._first_of_modes()[: tuning.ARCHED]:
            leaves, enters = not self.partial.state.resting, option.meeting.point.entry is not None
            top = tops[-1] if leaves or enters else tops[0]
            for corner in tuning.ARCH_CORNERS[:1] if self.step.via or (leaves and enters) else tuning.ARCH_CORNERS:
                form = ArchForm(top, 0.0 if leaves else corner, 0.0 if enters else corner)
                found.append(Candidate(option, Shape(form=form, through=through)))
        return found

    def _tops(self) -> list[float]:
        """Heights of the lift joint that an arch may go over, highest first."""
        scene, lift = self.scene, self.scene.robot.lift
        if lift is None:
            return []
        upper = float(scene.robot.limits.upper[lift])
        arch = self.step.arch
        state, ends, stops = self.partial.state, [float(self.partial.state.q[lift])], list[float]()
        if state.qd[lift] > 0:
            stops.append(ends[0] + self.partial.rises)
        for option in self.options[:1]:
            ends.append(float(option.branch.q[0, lift]))
            entry = option.meeting.point.entry
            if entry is not None:
                stops.append(ends[-1] + entry.far - entry.height)
        if arch is not None:
            # an arch that is lower than one of its ends is as high as it has to be anyway
            height = max(height_of(scene, arch, state.q), min(upper, max([max(ends) + tuning.LEAST_RISE_M, *stops])))
            return [height] if height <= upper else []
        tops = [upper, (max(ends) + upper) / 2, *([max(stops)] if stops else [])]
        return [top for top in tops if top > max(ends) + tuning.LEAST_RISE_M]

    def too_high(self) -> Refusal | None:
        """Why the required arch cannot be: the lift ends below it; None: it can, or none is required."""
        return too_high(self.scene, self.partial.step, self.partial.state.q)

    def may_wait(self) -> bool:
        """Whether waiting is possible and changes anything."""
        return can_wait(self.scene, self.partial) and not all_stand(self.scene.frames.values())

    def _any_option(self) -> Option:
        return self.options[min(len(self.options) - 1, int(self.rng.geometric(tuning.ANY_OPTION)) - 1)]

    def _wait(self) -> Candidate:
        """A straight leg after a wait."""
        return self._candidate(self._any_option(), Shape(float(self.rng.exponential(WAIT_S))))

    def _arch(self) -> Candidate:
        """An arch of random height and corners, or a variation of a good one."""
        rng = self.rng
        if self.elite and rng.random() < tuning.VARIED:
            return self._varied()
        option, tops = self._any_option(), self._tops()
        top = float(rng.uniform(min(tops), max(tops))) if rng.random() < 0.5 else max(tops)
        shape = Shape(form=ArchForm(top, float(rng.random()), float(rng.random())))
        if self.step.via:
            shape = replace(shape, through=float(rng.uniform(SLOWEST_THROUGH, FASTEST_THROUGH)))
        if self.may_wait() and rng.random() < tuning.ARCH_WAITS:
            shape = replace(shape, wait=float(rng.exponential(WAIT_S)))
        return self._candidate(option, shape)

    def _varied(self) -> Candidate:
        rng = self.rng
        *_, parent = self.elite[int(rng.integers(len(self.elite)))]
        shape, form = parent.shape, parent.shape.form
        if form is not None:
            corners = np.array([form.rise, form.fall]) + rng.normal(0.0, tuning.CORNER_NUDGE, 2)
            rise, fall = np.clip(corners, 0.0, 1.0)
            shape = replace(shape, form=ArchForm(form.top, float(rise), float(fall)))
        if self.may_wait() and rng.random() < NUDGED_TIME:
            shape = replace(shape, wait=max(0.0, shape.wait + float(rng.normal(0.0, TIME_NUDGE_S))))
        return replace(parent, shape=shape)

    def _candidate(self, option: Option, shape: Shape) -> Candidate:
        there = at_the_point(self.rng.random(3).tolist(), may_stop=self.may_stop)
        return Candidate(option, shape, *there)
