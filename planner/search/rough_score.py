"""The coarse score of many candidates at once: rough motions, evaluated at a few times, tell which are worth timing.

Nothing is accepted or refused by it. It orders the candidates; those that are tried are timed by Ruckig and screened.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.proof import Prover
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase
from assur.planner.search.meeting_options import Option
from assur.planner.search.partial_plan import PartialPlan
from assur.planner.search.rough_motion import Rough, RoughMotions
from assur.planner.search.tuning import APART_S, CLOSER, COARSE, DEPTH_M, INSTANTS, REMEMBERED


class CoarseScore:
    """Scores the candidates from one partial plan to its options."""

    def __init__(self, prover: Prover, partial: PartialPlan, options: tuple[Option, ...]) -> None:
        self.prover, self.partial = prover, partial
        self.rough = RoughMotions(prover.scene.robot, partial, options)
        self.pairs = len(prover.pairs(prover.arrangement(partial.attached), self._way(partial.state.time)))
        """How many pairs of bodies must be kept apart on the way."""
        self.times: list[float] = []
        """When candidates that had seemed free were in the way of something, s."""
        latest = prover.scene.options.latest_end_s
        self.latest = np.inf if latest is None else latest

    def remember(self, time: float) -> None:
        """Evaluate this time, s, too: something was in the way of a candidate then that had seemed free."""
        if all(abs(time - other) > APART_S for other in self.times):
            self.times = [*self.times, time][-REMEMBERED:]

    def __call__(self, candidates: FloatArray, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        """For each row of candidates (N,) how much it is in the way of something, 0: free as far as is known; its end.

        All are evaluated at a few times, and the better ones at more; 1: it is not possible, and then it may end at
        infinity.
        """
        rough, start = self.rough(candidates), self.partial.state.time
        end, count = rough.end, len(candidates)
        score = np.where(np.isfinite(end) & (end <= self.latest), 0.0, 1.0)
        possible = np.flatnonzero(score == 0)
        # each candidate at other times: what passes between the instants of one is seen at those of its likes
        share = (np.arange(INSTANTS) + rng.random((count, 1))) / INSTANTS
        times = start + (np.where(score == 0, end, start) - start)[:, None] * share
        coarse = np.arange(INSTANTS) % COARSE == 0
        known = np.broadcast_to(np.array(self.times), (count, len(self.times)))
        first = np.concatenate([times[:, coarse], np.where(known < end[:, None], known, start)], -1)
        score[possible] = self._depth(rough, possible, first[possible]) / INSTANTS
        order = possible[np.lexsort((end[possible], score[possible]))]
        closer, rest = np.split(order, [max(1, count // CLOSER)])
        score[closer] += self._depth(rough, closer, times[closer][:, ~coarse]) / INSTANTS
        score[rest] += 0.5 / INSTANTS  # not known to be free
        return np.minimum(score, 1.0), end

    def _depth(self, rough: Rough, which: IntArray, t: FloatArray) -> FloatArray:
        """How deep (W,) some motions are in something at times t (W, T), in `DEPTH_M`, 1 at most for each time."""
        if not t.size:
            return np.zeros(len(which))
        robot = self.prover.scene.robot
        q, times = rough.at(which, t).reshape(-1, len(robot.joints)), t.reshape(-1)
        depth = np.ones(len(times))
        possible = np.flatnonzero(robot.within(q) & robot.assembled(q, q))
        depth[possible] = self.prover.depth(self._way(float(t.max())), q[possible], times[possible], DEPTH_M)
        return np.asarray(depth.reshape(t.shape).sum(-1))

    def _way(self, until: float) -> Phase:
        """A motion to the next control point that ends at `until`, s."""
        partial = self.partial
        return Phase(partial.state.time, until, LegKind.MOVE, partial.step, partial.attached)
