"""The beam: explores continuations of proved chains, step by step, until a budget is spent or a first plan found."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import product

import numpy as np

from assur.planner.collision.proof import Prover
from assur.planner.collision.rows import Rows, Unproved
from assur.planner.collision.screening import screen
from assur.planner.feasibility.necessary import points_impossible
from assur.planner.legs.meeting import Meetings
from assur.planner.legs.tilt import tilts
from assur.planner.model.outcome import Plan
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.refusal import Refusal
from assur.planner.model.scene import Scene
from assur.planner.search.candidates import Sampler
from assur.planner.search.census import Counter, refused_proof
from assur.planner.search.completion import completed
from assur.planner.search.extension import carried_gently, is_straight, outline, straight_draft
from assur.planner.search.meeting_options import Option, ahead, options
from assur.planner.search.partial_plan import Chain, Draft, Outline, Sample, initial, prepared
from assur.planner.search.rough_score import CoarseScore

BEAM = 4
"""Chains of one length that are continued in a round."""
KEPT = 12
"""Chains of one length that are remembered: the beam, and those of other modes."""
PROVED_A_BATCH = 3
"""Continuations proved in one batch before the others of the batch are left alone."""
PROOFS_A_BATCH = 6
"""Proofs begun in one batch: what passes fine screening is nearly always proved."""
MOST_WAYS = 12
"""Ways to meet a control point that are kept, the quickest; one a pitch where the pitch is free."""
ANY_YAW = 8
"""Yaws that are tried where a control point leaves the yaw free."""


@dataclass(eq=False)
class Found:
    """What the search came to: the best whole chain, when the first was found, whether the clock ended it."""

    best: Chain | None = None
    plan: Plan | None = None
    first_s: float = float("nan")
    cut_by_clock: bool = False
    deepest: int = 0
    first_ways: tuple[Option, ...] = ()
    never: Refusal | None = None
    """A necessary condition that does not hold, if that is what ended the search."""
    census: Counter = field(default_factory=Counter)


class Search:
    """One run over one scene. `started`: the monotonic time from which the budget counts."""

    def __init__(self, scene: Scene, prover: Prover, started: float, *, adaptive: bool = True) -> None:
        self.scene, self.prover, self.adaptive = scene, prover, adaptive
        self.started, self.deadline = started, started + scene.options.budget_s
        prover.deadline = self.deadline
        self.rng = np.random.default_rng(scene.options.seed)
        self.pool: list[list[Chain]] = [[] for _ in range(len(scene.task) + 1)]
        self.samplers: dict[int, tuple[Chain, Sampler]] = {}
        # the chain is kept beside its sampler: an id is unique only while its owner lives
        self.found = Found()

    def run(self) -> Found:
        """Rounds over all lengths until something ends them."""
        self.pool[0].append(initial(self.scene))
        round_number = 0
        while True:
            explored = False
            for depth in range(len(self.scene.task)):
                for chain in self._beam(depth, 1 + round_number // 2):
                    explored |= self._explore(chain)
                    if self._over():
                        return self.found
            round_number += 1
            if round_number == 1 and self.found.best is None:
                self.found.never = points_impossible(self.scene, self.prover)
                if self.found.never is not None:
                    return self.found
            if not explored:
                return self.found

    def _beam(self, depth: int, width: int) -> list[Chain]:
        """The chains of this length to be continued: the earliest, and the earliest of each other mode."""
        chains = sorted(self.pool[depth], key=lambda chain: chain.state.time)
        seen: set[int] = set()
        first = [chain for chain in chains if not (chain.mode in seen or seen.add(chain.mode))]  # type: ignore[func-returns-value]
        rest = [chain for chain in chains if chain not in first]
        return (first + rest)[: min(width, BEAM)]

    def _over(self) -> bool:
        limit = self.scene.options.max_candidates
        if self.scene.options.stop == "first" and self.found.best is not None:
            return True
        if limit is not None and self.found.census.candidates >= limit:
            return True
        if time.perf_counter() >= self.deadline:
            self.found.cut_by_clock = True
            return True
        return False

    def _sampler(self, chain: Chain) -> Sampler:
        if id(chain) not in self.samplers:
            met: list[tuple[float, Meetings]] = []
            attitudes = tilts(self.scene, self.scene.task[chain.step], chain.state.q)
            for offset, tilt in product(self._yaws(chain), attitudes):
                meeting = prepared(self.scene, chain, offset, tilt, self._modes(chain))
                if isinstance(meeting, Refusal):
                    self.found.census.note(meeting)
                    continue
                for refusal in meeting.refusals:
                    self.found.census.note(refusal)
                met.append((offset, meeting))
            ways = options(self.scene, chain, met, max(MOST_WAYS, len(attitudes)))
            if chain.step == 0:
                self.found.first_ways = ways
            sampler = Sampler(
                self.scene, chain, ways, self.rng, partial(CoarseScore, self.prover, chain, ways), self.adaptive
            )
            high = sampler.too_high()
            if high is not None:
                self.found.census.note(high)
                sampler.options = ()
            self.samplers[id(chain)] = (chain, sampler)
        return self.samplers[id(chain)][1]

    def _yaws(self, chain: Chain) -> tuple[float, ...]:
        found = yaw_offsets(self.scene, self.scene.task[chain.step])
        if found is not None:
            return found
        return tuple(float(x) for x in 2 * np.pi * np.arange(ANY_YAW) / ANY_YAW)

    def _modes(self, chain: Chain) -> tuple[int, ...]:
        robot, elbow = self.scene.robot, self.scene.options.elbow
        if elbow == "auto":
            return tuple(range(len(robot.modes)))
        if elbow == "keep":
            return (chain.mode,)
        return (robot.modes.index(elbow),)

    def _explore(self, chain: Chain) -> bool:
        """One batch of continuations; whether there was anything to try."""
        sampler = self._sampler(chain)
        batch = sampler.batch(self._before())
        limit = self.scene.options.max_candidates
        if limit is not None:
            batch = batch[: max(0, limit - self.found.census.candidates)]
        ways: list[Outline | Draft] = []
        for option, sample in batch:
            if time.perf_counter() >= self.deadline:
                break
            way = self._way(chain, option, sample)
            if isinstance(way, Refusal):
                self.found.census.add(way)
                sampler.learn(sample, 1.0)
            elif self._of_use(way):
                ways.append(way)
        free = []
        for way, screened in zip(ways, screen(self.prover, ways) if ways else [], strict=True):
            at = None if screened.refusal is None or screened.refusal.interval is None else screened.refusal.interval[0]
            sampler.learn(way.sample, screened.bad, at)
            if screened.refusal is not None:
                self.found.census.add(screened.refusal)
                for also in screened.also:
                    self.found.census.note(also)
            else:
                free.append(way)
        for way in self._prove(sorted(free, key=lambda way: way.end)):
            sampler.learn(way.sample, 1.0)
        return bool(batch)

    def _way(self, chain: Chain, option: Option, sample: Sample) -> Outline | Draft | Refusal:
        """A timed way to the control point."""
        self.found.census.candidates += 1
        if is_straight(self.scene, chain):
            return straight_draft(self.scene, chain, option.meeting, sample)
        return outline(self.scene, chain, option.meeting, sample, ahead(self.scene, chain, chain.state.q))

    def _of_use(self, way: Outline | Draft) -> bool:
        """Whether the chain that a way leads to would be continued, or be the best plan."""
        earlier = [chain for chain in self.pool[way.chain.step + 1] if chain.state.time <= way.end]
        of_mode = any(chain.mode == way.sample.branch.mode for chain in earlier)
        return way.end < self._before() and (len(earlier) < BEAM or not of_mode)

    def _before(self) -> float:
        """When the best plan so far ends, s: only what ends earlier is of interest."""
        return math.inf if self.found.best is None else self.found.best.state.time

    def _prove(self, free: list[Outline | Draft]) -> list[Outline | Draft]:
        """Proves ways, the earliest first, and adds the chains that come of them; gives those that are refused."""
        proved, refused = 0, []
        for way in free[:PROOFS_A_BATCH]:
            if proved >= PROVED_A_BATCH or time.perf_counter() >= self.deadline:
                break
            chain = self._proved(way)
            if isinstance(chain, Refusal):
                self.found.census.add(chain)
                refused.append(way)
                continue
            proved += 1
            self._add(chain)
            if self.scene.options.stop == "first":
                break
        return refused

    def _proved(self, way: Outline | Draft) -> Chain | Refusal:
        """The chain that a way leads to, with the proofs of all its phases."""
        candidate = carried_gently(self.scene, way) if isinstance(way, Outline) else way
        if isinstance(candidate, Refusal):
            return candidate
        if isinstance(way, Outline) and len(candidate.phases) > len(way.phases):
            # only the way there has been screened, not what follows at the point
            rest = screen(self.prover, [candidate])[0]
            if rest.refusal is not None:
                for also in rest.also:
                    self.found.census.note(also)
                return rest.refusal
        proofs: list[Rows] = []
        for phase in candidate.phases:
            rows = self.prover.prove(phase, candidate.trajectory)
            if isinstance(rows, Unproved):
                return refused_proof(rows, candidate.chain.step)
            proofs.append(rows)
        return replace(candidate.after, proofs=(*candidate.chain.proofs, *proofs))

    def _add(self, chain: Chain) -> None:
        if time.perf_counter() >= self.deadline:
            # found too late: an answer that a slower machine would not have given
            return
        best = self.found.best
        if chain.step == len(self.scene.task) and (best is None or chain.state.time < best.state.time):
            whole = completed(self.scene, chain)
            if isinstance(whole, Refusal):
                self.found.census.add(whole)
                return
            if best is None:
                self.found.first_s = time.perf_counter() - self.started
            self.found.best, self.found.plan = chain, whole
        pool = self.pool[chain.step]
        pool.append(chain)
        pool.sort(key=lambda each: each.state.time)
        del pool[KEPT:]
        self.found.deepest = max(self.found.deepest, chain.step)
