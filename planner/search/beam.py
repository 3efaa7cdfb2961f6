"""The search: continues proved partial plans, step by step, until a budget is spent or a first plan is found."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial as bound
from itertools import product

import numpy as np

from assur.planner.bound.duration import least_duration
from assur.planner.collision.proof import Prover
from assur.planner.collision.rows import ProofFailure, Rows
from assur.planner.collision.screening import Encounter, ScreeningResult, deepest, screen
from assur.planner.collision.touching import too_far, touching
from assur.planner.feasibility.necessary import points_impossible
from assur.planner.legs.meeting import Meetings
from assur.planner.legs.tilt import tilts
from assur.planner.model.deadline import Deadline, OutOfTimeError, Progress, Watch, out_of_time, raise_if_late
from assur.planner.model.outcome import Plan
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.refusal import Refusal, Separation
from assur.planner.model.scene import Pick, Scene
from assur.planner.search.candidates import Sampler
from assur.planner.search.census import Counter, completed, refused_proof
from assur.planner.search.extension import extended, straight_extension, timed, wrist_travel
from assur.planner.search.meeting_options import ahead, free_yaws, options
from assur.planner.search.partial_plan import (
    Candidate,
    PartialPlan,
    RefusedMotion,
    TimedCandidate,
    TimedMotion,
    initial,
    prepared,
)
from assur.planner.search.pool import Pool
from assur.planner.search.rough_score import CoarseScore, score_of
from assur.planner.search.tuning import (
    BEAM,
    MOST_OPTIONS,
    PROVED_A_BATCH,
    ROUNDING_S,
    SAME_DURATION,
    SAME_TRAVEL,
)


@dataclass(eq=False)
class SearchResult:
    """What the search came to: the best whole plan, when the first was found, whether the clock ended it."""

    best: PartialPlan | None = None
    soonest: float = math.inf
    """When the soonest of all whole plans ends, s: the best may end a little later, with less travel of the wrist."""
    plan: Plan | None = None
    first_s: float = float("nan")
    cut_by_clock: bool = False
    deepest: int = 0
    never: Refusal | None = None
    """A necessary condition that does not hold, if that is what ended the search."""
    census: Counter = field(default_factory=Counter)
    furthest: RefusedMotion | None = None
    """The refused motion that came furthest, while there is no plan."""
    longest: PartialPlan | None = None
    """The partial plan through most steps, the first of them."""

    def refused(self, motion: TimedMotion, encounters: tuple[Encounter, ...]) -> tuple[Encounter, ...]:
        """Remembers a motion that was refused, if none came further; the encounters again."""
        if self.best is None:
            new = RefusedMotion(motion, encounters)
            if self.furthest is None or new.rank > self.furthest.rank:
                self.furthest = new
        return encounters


class Search:
    """One run over one scene. `started`: the reading of `time.perf_counter` from which the budget counts. `checked`:
    whether each plan is checked; else the caller does it."""

    def __init__(
        self, scene: Scene, prover: Prover, started: float, *, watch: Watch | None = None, checked: bool = True
    ) -> None:
        self.scene, self.prover, self.watch, self.checked = scene, prover, watch, checked
        self.started, self.deadline = started, Deadline(started, scene.options.budget_s)
        self.rng = np.random.default_rng(scene.options.seed)
        self.pool = Pool(scene, prover)
        self.samplers: dict[PartialPlan, Sampler] = {}
        self.until_first = scene.options.stop == "first"
        """Whether the first plan ends the search. It says nothing about how that one is found."""
        self.found = SearchResult()
        self.start_is_free = False
        """Whether a candidate from the start was screened that is near nothing there, with all errors."""
        self._bound: list[float | None] = []
        """What no plan beats, once it is required."""

    def run(self) -> SearchResult:
        """Rounds over all lengths until something ends them, or the budget is spent."""
        with self.deadline:
            try:
                return self._rounds()
            except OutOfTimeError:
                self.found.cut_by_clock = True
                return self.found

    def _rounds(self) -> SearchResult:
        self.pool.add(initial(self.scene))
        round_number = 0
        while True:
            explored = False
            for length in range(len(self.scene.task)):
                for partial in self.pool.continued(length, 1 + round_number // 2):
                    explored |= self._explore(partial)
                    over = self._over()
                    if over and round_number == 0:
                        self._evaluate_points()
                    if over:
                        return self.found
            round_number += 1
            if round_number == 1:
                self._evaluate_points()
            if not explored or self.found.never is not None:
                return self.found

    def _evaluate_points(self) -> None:
        """Whether the points can be met at all, where the first round found no plan: also where few candidates are
        allowed a refusal may be proved."""
        if self.found.best is None and not self.found.cut_by_clock:
            self.found.never = points_impossible(self.scene, self.prover, start_is_free=self.start_is_free)

    def _over(self) -> bool:
        if self.watch is not None:
            self.watch(self._progress())
        if (self.until_first and self.found.best is not None) or self._left() <= 0:
            return True
        self.found.cut_by_clock = self._late()
        return self.found.cut_by_clock

    def _progress(self) -> Progress:
        found = self.found
        if not self._bound:
            self._bound.append(least_duration(self.scene) if self.scene.options.report == "full" else None)
        best = None if found.best is None else found.best.state.time - self.scene.start.time
        return Progress(
            stage="search",
            elapsed_s=time.perf_counter() - self.started,
            candidates=found.census.candidates,
            steps=found.deepest,
            duration_s=best,
            lower_bound_s=self._bound[0],
        )

    def _late(self) -> bool:
        return out_of_time()

    def _left(self) -> float:
        """How many candidates may still be tried."""
        limit = self.scene.options.max_candidates
        return math.inf if limit is None else limit - self.found.census.candidates

    def _explore(self, partial: PartialPlan) -> bool:
        """Tries one batch of continuations; whether there was anything to try."""
        if partial not in self.samplers:
            self.samplers[partial] = self._sampler(partial)
        sampler = self.samplers[partial]
        last = partial.step + 1 == len(self.scene.task)
        batch = sampler.batch(self._before() if last else self.found.soonest)
        batch = batch[: int(min(len(batch), self._left()))]
        enough, leaving = self._enough(), set(self.pool.leaving[partial.step])
        for motion in self._in_order(partial, sampler, batch):
            screened, proved = self._tried(motion)
            refusal = screened.refusal
            at = None if refusal is None or refusal.interval is None else refusal.interval[0]
            if refusal is None or isinstance(refusal.facts, Separation):
                # what is near at the start is reported for that instant, before any other
                self.start_is_free |= motion.phases[0].t0 == self.scene.start.time != at
            sampler.learn(motion.candidate, score_of(refusal), motion.end, at)
            if proved is False and refusal is None:
                sampler.learn(motion.candidate, 1.0)
            enough -= proved is True
            if enough <= 0 or self._late() or self.pool.leaving[partial.step] != leaving:
                break
        return bool(batch)

    def _in_order(self, partial: PartialPlan, sampler: Sampler, batch: list[Candidate]) -> Iterator[TimedMotion]:
        """The motions of a batch, the quickest first: each is timed when it is needed, if the batch is in that order,
        and else all are timed at once."""
        made: list[TimedMotion] = []
        for candidate in batch:
            if self._late():
                break
            motion = self._timed(partial, candidate)
            if isinstance(motion, Refusal):
                self.found.census.add(motion)
                sampler.learn(candidate, 1.0)
            elif self._of_use(motion):
                if sampler.ordered:
                    yield motion
                else:
                    made.append(motion)
        yield from sorted(made, key=lambda motion: motion.end)

    def _sampler(self, partial: PartialPlan) -> Sampler:
        """What samples the continuations of a partial plan, with the options in which its next point can be met."""
        scene, attitudes = self.scene, tilts(self.scene, self.scene.task[partial.step], partial.state.q)
        found = options(scene, partial, self._met(partial))[: max(MOST_OPTIONS, len(attitudes))]
        score = bound(CoarseScore, self.prover, partial, found)
        sampler = Sampler(scene, partial, found, self.rng, score)
        high = sampler.too_high()
        if high is not None:
            self.found.census.note(high)
            sampler.options = ()
        return sampler

    def _met(self, partial: PartialPlan) -> list[Meetings]:
        """How the next point can be met, with the turn of the tool about the part's axis; why not is noted."""
        scene, met, modes = self.scene, list[Meetings](), self._modes(partial)
        attitudes = tilts(scene, scene.task[partial.step], partial.state.q)
        offsets = yaw_offsets(scene, scene.task[partial.step])
        if offsets is None:
            offsets = free_yaws(scene, partial, partial.step, modes)
        for offset, tilt in product(self._gripping(partial, offsets), attitudes):
            raise_if_late()
            for meeting in prepared(scene, partial, offset, tilt, modes):
                for refusal in (meeting,) if isinstance(meeting, Refusal) else meeting.refusals:
                    self.found.census.note(refusal)
                if isinstance(meeting, Meetings):
                    met.append(meeting)
        return met

    def _gripping(self, partial: PartialPlan, offsets: tuple[float, ...]) -> list[float]:
        """The turns of the tool in which it is near enough to the part that is picked; any, where that is free."""
        step, kept = self.scene.task[partial.step], list[float]()
        for offset in offsets:
            apart = None
            if isinstance(step, Pick) and math.isfinite(step.grip_within_m):
                apart = too_far(self.prover, partial.step, partial.attached, offset, self.scene.start.time)
            if apart is None:
                kept.append(offset)
            else:
                self.found.census.note(apart)
        return kept

    def _modes(self, partial: PartialPlan) -> tuple[int, ...]:
        robot, elbow = self.scene.robot, self.scene.options.elbow
        if elbow == "auto":
            return tuple(range(len(robot.modes)))
        return (partial.mode if elbow == "keep" else robot.modes.index(elbow),)

    def _timed(self, partial: PartialPlan, candidate: Candidate) -> TimedMotion | Refusal:
        """A candidate, timed."""
        self.found.census.candidates += 1
        if self.scene.task[partial.step].leg == "cartesian":
            return straight_extension(self.scene, partial, candidate)
        return timed(self.scene, partial, candidate, ahead(self.scene, partial, candidate.branch))

    def _of_use(self, motion: TimedMotion) -> bool:
        """Whether the partial plan that a motion leads to would be continued, or be the best plan."""
        earlier = [other for other in self.pool.plans[motion.before.step + 1] if other.state.time <= motion.end]
        kind = motion.candidate.branch.mode, motion.candidate.stops
        of_kind = any((other.mode, other.stops) == kind for other in earlier)
        return self._may_win(motion) and (len(earlier) < BEAM or not of_kind)

    def _may_win(self, motion: TimedMotion) -> bool:
        """Whether a plan through a motion may be better than the best so far: end sooner, or turn the wrist less."""
        best = self.found.best
        if best is None or motion.end < min(best.state.time, self.found.soonest):
            return True
        if motion.before.step + 1 < len(self.scene.task):
            return False  # what comes behind it takes time as well
        ends = np.stack([motion.before.state.q, motion.trajectory.knots[-1, 1 : 1 + motion.trajectory.n]])
        turned = motion.before.wrist + wrist_travel(self.scene.robot, ends)
        return motion.end < self._before() and turned < best.wrist - SAME_TRAVEL

    def _before(self) -> float:
        """What ends later, s, is of no interest: within `SAME_DURATION` a plan may turn the wrist less."""
        best, found = self.found.best, self.found
        if best is None:
            return math.inf
        if best.wrist <= SAME_TRAVEL:
            return found.soonest
        start = self.scene.start.time
        return start + (1 + SAME_DURATION) * (found.soonest - start)

    def _better(self, partial: PartialPlan) -> bool:
        """Whether a whole plan is better than the best so far: of plans that take as long as the soonest, within
        `SAME_DURATION`, the one with less travel of the wrist."""
        best, start = self.found.best, self.scene.start.time
        if best is None:
            return True
        soonest = min(self.found.soonest, partial.state.time)
        latest = start + (1 + SAME_DURATION) * (soonest - start)
        if partial.state.time > latest or best.state.time > latest:
            return partial.state.time < best.state.time
        if abs(partial.wrist - best.wrist) > SAME_TRAVEL:
            return partial.wrist < best.wrist
        return partial.state.time < best.state.time - ROUNDING_S

    def _enough(self) -> int:
        """Candidates of one batch after whose proof the others are left alone."""
        return 1 if self.scene.options.stop == "first" else PROVED_A_BATCH

    def _tried(self, motion: TimedMotion) -> tuple[ScreeningResult, bool | None]:
        """Screens a timed candidate and, if nothing is in its way, proves it and adds the partial plan it leads to.

        Also returns whether it was proved; None: it was not needed any more.
        """
        screened = screen(self.prover, motion)
        if screened.encounters:
            self._refused(motion.before, self.found.refused(motion, screened.encounters))
            return screened, False
        if not self._of_use(motion):
            return screened, None
        partial = self._proved(motion)
        if not isinstance(partial, PartialPlan):
            self._refused(motion.before, partial)
            return screened, False
        self._add(partial)
        return screened, True

    def _refused(self, before: PartialPlan, encounters: tuple[Encounter, ...]) -> None:
        """Counts why a motion was refused, and remembers parts in its way that will be gone."""
        self.found.census.add_all(encounters)
        if self.scene.clears:
            self.pool.note(before, {name for each in encounters for name in each.refusal.bodies})

    def _proved(self, motion: TimedMotion) -> PartialPlan | tuple[Encounter, ...]:
        """The partial plan that a motion leads to, with the proofs of all its phases; or why there is none."""
        made = extended(self.scene, motion) if isinstance(motion, TimedCandidate) else motion
        if isinstance(made, Refusal):
            return self.found.refused(motion, (Encounter(made),))
        met = touching(self.prover, made.before.attached, made.after.arrivals[-1])
        if isinstance(met, Refusal):
            return self.found.refused(made, (Encounter(met),))
        if len(made.phases) > len(motion.phases):
            # only the leg to the point has been screened, not what follows there
            rest = screen(self.prover, made)
            if rest.encounters:
                return self.found.refused(made, rest.encounters)
        proofs: list[Rows] = []
        for phase in made.phases:
            rows = self.prover.prove(phase, made.trajectory)
            if isinstance(rows, ProofFailure):
                rows = deepest(self.prover, phase, made.trajectory, rows)
                why = refused_proof(rows, made.before.step, self.prover.rule(phase, *rows.bodies))
                unfinished = why.amount is None and self._late()
                return (Encounter(why),) if unfinished else self.found.refused(made, (Encounter(why),))
            proofs.append(rows)
        after, arrivals = made.after, (*made.after.arrivals[:-1], met)
        return replace(after, arrivals=arrivals, proofs=(*made.before.proofs, *proofs))

    def _add(self, partial: PartialPlan) -> None:
        if self._late():
            # found too late: an answer that a slower machine would not have given
            return
        best = self.found.best
        if partial.step == len(self.scene.task) and self._better(partial):
            whole = completed(self.scene, partial, checked=self.checked)
            if isinstance(whole, Refusal):
                self.found.census.add(whole)
                return
            if best is None:
                self.found.first_s = time.perf_counter() - self.started
            self.found.best, self.found.plan = partial, whole
            self.found.soonest = min(self.found.soonest, partial.state.time)
        self.pool.add(partial)
        self.found.deepest = max(self.found.deepest, partial.step)
        if self.found.longest is None or partial.step > self.found.longest.step:
            self.found.longest = partial
