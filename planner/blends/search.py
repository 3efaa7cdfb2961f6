"""The search by parabolic blends: its continuations are whole runs of steps, from rest through vias to rest.

How a via is blended past depends on the pose behind it, so nothing is proved of a run before all of it is timed. Runs
are sampled, seeded and adaptive: the direct ones first. Free poses are there to go round bodies: they are tried only on
ways that were timed and then refused.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial as bound
from itertools import count, pairwise
from typing import cast

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.blends.run import Run, extended_by_run
from assur.planner.kernels.drawing import EFFORTS, NUDGED, NUDGED_TIME, NUDGES, TIME_NUDGE_S
from assur.planner.legs.joint import Shape
from assur.planner.model.refusal import AccelerationTime, Reason, Refusal
from assur.planner.search.beam import Search
from assur.planner.search.candidates import Sampler
from assur.planner.search.meeting_options import preference
from assur.planner.search.partial_plan import Candidate, Extension, Option, PartialPlan, TimedMotion
from assur.planner.search.rough_score import CoarseScore
from assur.planner.search.tuning import ANY_OPTION, ARCHED, ELITE, LEAST_RISE_M, MOST_OPTIONS
from assur.planner.search.via_batch import free_vias

BATCH = 16
"""Random samples in a batch."""
VARIED = 0.25
"""Share of them that are variations of the best runs so far, once there are any."""
COUNTS, WEIGHTS = (0, 1, 2), (0.3, 0.5, 0.2)
"""Free poses on the way to one station, and how often each number of them."""
WAITS, WAIT_S = 0.4, 0.35
"""How often a run waits first, where anything moves, and how long on average."""

Way = tuple[Option, ...]
"""A branch for each station."""


@dataclass(eq=False)
class RunSampler(Sampler):
    """Samples for one partial; `choices`: for each step of the run the branches that it may be met in."""

    choices: tuple[Way, ...] = ()
    ways: tuple[Way, ...] = ()
    best: list[tuple[float, Run]] = field(default_factory=list)
    blocked: list[Way] = field(default_factory=list)
    """Ways that were timed directly, and then refused: only they are led round by free poses."""

    def __post_init__(self) -> None:
        """Choices of a branch each, those with the least time at full speed first, the wrist turned least, by beam."""
        super().__post_init__()
        robot = self.scene.robot
        beam: list[tuple[float, Way, FloatArray]] = [(0.0, (), self.partial.state.q)]
        for options in self.choices:
            longer = []
            for cost, way, q in beam:
                for option in options:
                    at = option.branch.q[0]
                    least = float(np.max(np.abs(at - q) / robot.limits.velocity))
                    longer.append((cost + least * float(preference(robot, q, at)), (*way, option), at))
            beam = sorted(longer, key=lambda item: item[0])[:MOST_OPTIONS]
        self.ways = tuple(way for _, way, _ in beam)

    def batch(self, _before: float = np.inf) -> list[Candidate]:
        """The next batch; empty only if there is nothing left to try."""
        visit, self.visits = self.visits, self.visits + 1
        if not self.options:
            return []
        if visit == 0:
            return [_run(way, ((),) * len(way), Shape()) for way in self.ways]
        raised = [run for way in self.blocked[:ARCHED] for run in self._raised(way)] if visit == 1 else []
        return [*raised, *(self._random() for _ in range(BATCH))]

    def learn(self, candidate: Candidate, bad: float, end: float = math.inf, _at: float | None = None) -> None:
        """As `Sampler.learn`; a direct way that was refused is blocked."""
        run = cast("Run", candidate)
        if bad > 0 and not any(run.frees) and run.stations not in self.blocked:
            self.blocked.append(run.stations)
        if end < math.inf:
            self.best = sorted([*self.best, (bad, run)], key=lambda pair: pair[0])[:ELITE]

    def _legs(self, way: Way) -> list[tuple[FloatArray, FloatArray]]:
        """Joints (n,) at both ends of the way to each station, at the first time at which it may be met."""
        return list(pairwise([self.partial.state.q, *(option.branch.q[0] for option in way)]))

    def _raised(self, way: Way) -> list[Run]:
        """Up, over and down on the way to each station, as high as the lift goes, and half as high."""
        lift, frees, made = self.scene.robot.lift, np.array(self._legs(way)), list[Run]()
        if lift is None:
            return made
        highest, upper = float(frees[:, :, lift].max()), float(self.scene.robot.limits.upper[lift])
        for top in (upper, (highest + upper) / 2):
            if top > highest + LEAST_RISE_M:
                frees[:, :, lift] = top
                made.append(_run(way, tuple((one, other) for one, other in frees.copy()), Shape()))
        return made

    def _random(self) -> Run:
        rng = self.rng
        if self.best and rng.random() < VARIED:
            return self._varied_run()
        ways, frees = self.blocked or self.ways, []
        way = ways[min(len(ways), int(rng.geometric(ANY_OPTION))) - 1]
        for one, other in self._legs(way):
            many = int(rng.choice(COUNTS, p=WEIGHTS)) if self.blocked else 0
            frees.append(free_vias(rng, self.scene.robot, one, other, many))
        wait = float(rng.exponential(WAIT_S)) if self.may_wait() and rng.random() < WAITS else 0.0
        return _run(way, tuple(frees), Shape(wait, effort=float(rng.choice(EFFORTS))))

    def _varied_run(self) -> Run:
        rng, limits = self.rng, self.scene.robot.limits
        _, parent = self.best[int(rng.integers(len(self.best)))]
        spread = float(rng.choice(NUDGES)) * (limits.upper - limits.lower)
        spread[NUDGED:] = 0.0
        frees = tuple(
            tuple(np.clip(q + rng.normal(0.0, 1.0, len(q)) * spread, limits.lower, limits.upper) for q in free)
            for free in parent.frees
        )
        wait = parent.shape.wait
        if self.may_wait() and rng.random() < NUDGED_TIME:
            wait = max(0.0, wait + float(rng.normal(0.0, TIME_NUDGE_S)))
        if not any(frees) and parent.stations in self.blocked:
            # a way that was nearly free is led around at one place
            k = int(rng.integers(len(frees)))
            via = free_vias(rng, self.scene.robot, *self._legs(parent.stations)[k], 1)
            frees = (*frees[:k], via, *frees[k + 1 :])
        return _run(parent.stations, frees, replace(parent.shape, wait=wait))


def _run(way: Way, frees: tuple[tuple[FloatArray, ...], ...], shape: Shape) -> Run:
    return Run(way[-1], shape, stations=way, frees=frees)


class BlendSearch(Search):
    """One run over one scene with `timing: parabolic_blend`."""

    def _sampler(self, partial: PartialPlan) -> Sampler:
        """Samples runs to the next stop, which meet each step in every turn, mode and yaw that is allowed."""
        choices = list[Way]()
        for step in count(partial.step):
            met = self._met(replace(partial, step=step))
            choices.append(tuple(Option(each, branch) for each in met for branch in each.branches))
            if not choices[-1]:
                self.found.deepest = max(self.found.deepest, step)
            if not choices[-1] or not self.scene.task[step].via:
                break
        score = bound(CoarseScore, self.prover, partial, choices[-1])
        return RunSampler(self.scene, partial, choices[-1], self.rng, score, choices=tuple(choices))

    def _in_order(self, partial: PartialPlan, sampler: Sampler, batch: list[Candidate]) -> Iterator[TimedMotion]:
        """The motions of a batch, the quickest first."""
        made, refusals = list[Extension](), list[Refusal]()
        for run in batch:
            if self._late():
                break
            self.found.census.candidates += 1
            motion = extended_by_run(self.scene, partial, cast("Run", run))
            if isinstance(motion, Extension):
                made.append(motion)
                continue
            refusals.append(motion)
            if motion.reason is Reason.NEAR_PARALLEL_SINGULARITY:
                sampler.learn(run, 1.0)  # it was timed; another way may stay clear of type 2
        untimed, reasons = sampler.visits == 1 and not made, {refusal.reason for refusal in refusals}
        short = [each.facts for each in refusals if isinstance(each.facts, AccelerationTime)]
        # the least time that does for any of the direct ways, so that it is the least there is
        least = min((each.enough_s for each in short if untimed and each.enough_s is not None), default=None)
        for each in refusals:
            facts = replace(each.facts, enough_s=least) if isinstance(each.facts, AccelerationTime) else each.facts
            self.found.census.add(replace(each, facts=facts))
        slow = self.scene.options.acceleration_time_s is not None and reasons <= {Reason.MOTION_LIMIT}
        round_bodies = Reason.NEAR_PARALLEL_SINGULARITY in reasons or sampler.may_wait()
        if untimed and (slow or not round_bodies):
            # no direct way keeps the acceleration time, or comes in time: free poses are there to go round bodies
            sampler.options = ()
        yield from sorted((motion for motion in made if motion.end < self._before()), key=lambda motion: motion.end)
