"""The coarse score of many candidates at once: rough motions, evaluated at a few times, tell which are worth timing.

Nothing is accepted or refused by it. It orders the candidates; those that are tried are timed by Ruckig and screened.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.proof import Prover
from assur.planner.kernels.candidates import BEGIN, END, JOINT_COLUMNS, OF_JOINT, rough_motions, rough_positions
from assur.planner.model.refusal import Refusal, Separation
from assur.planner.robots.facts import Limits
from assur.planner.search.partial_plan import Option, PartialPlan
from assur.planner.search.tuning import APART_S, DEPTH_M, GIVEN_UP, INSTANTS, REMEMBERED

# Rough motions of many candidates at once, about as quick as Ruckig's and without asking it.


class RoughMotions:
    """Times the candidates that continue one partial plan."""

    def __init__(self, limits: Limits, partial: PartialPlan, options: tuple[Option, ...]) -> None:
        self._limits, state = limits.table, partial.state
        self._start, self._time = np.array([state.q, state.qd]), float(state.time)
        first, rows, meetings = 0, [], []
        for option in options:
            branch = option.branch
            some = branch.table[:1] if branch.still else branch.table
            rows.append((first, len(some), branch.still))
            first += len(some)
            meetings.append(some)
        self._options, self._meetings = np.array(rows, dtype=np.float64), np.concatenate(meetings)

    def __call__(self, candidates: FloatArray) -> FloatArray:
        """One motion for each row of candidates, as rows of `assur.planner.kernels.candidates`: when it begins to move
        (BEGIN) and reaches its control point (END), s; infinity for a motion that is not possible."""
        motions = np.empty((len(candidates), OF_JOINT + self._start.shape[1] * JOINT_COLUMNS))
        rough_motions(candidates, self._start, self._time, self._limits, self._options, self._meetings, motions)
        return motions

    def at(self, motions: FloatArray, which: IntArray, t: FloatArray) -> FloatArray:
        """q (W, T, n) of some of the motions (W,) at times t (W, T), the arm standing still before and after."""
        q = np.empty((*t.shape, self._start.shape[1]))
        rough_positions(motions, which, np.ascontiguousarray(t), q)
        return q


_SPREAD = (7 * np.arange(INSTANTS) + INSTANTS - 1) % INSTANTS
"""The instants of a rough motion in an order in which those that follow each other are far apart; the end first."""


_MIDDLE = np.linspace(0.3, 0.7, INSTANTS // 3)
"""Shares of the duration of an arch at which it is evaluated."""


class CoarseScore:
    """Scores the candidates from one partial plan to its options."""

    def __init__(self, prover: Prover, partial: PartialPlan, options: tuple[Option, ...]) -> None:
        self.prover, self.partial = prover, partial
        self.rough = RoughMotions(partial.attached.limits(prover.scene), partial, options)
        way = partial.way(prover.scene, partial.state.time)
        self.pairs = len(prover.pairs_of(way))
        """How many pairs of bodies must be kept apart on the way."""
        self.times: list[float] = []
        """When candidates that had seemed free were in the way of something, s."""
        latest = prover.scene.options.latest_end_s
        self.latest = np.inf if latest is None else latest

    def remember(self, time: float) -> None:
        """Evaluate this time, s, too: something was in the way of a candidate then that had seemed free."""
        for other in self.times:
            if not abs(time - other) > APART_S:
                return
        self.times = [*self.times, time][-REMEMBERED:]

    def __call__(self, candidates: FloatArray, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        """For each row of candidates (N,) how much it is in the way of something, 0: free as far as is known; its end.

        1: it is not possible, and then it may end at infinity. What is much in the way is not evaluated to its end.
        """
        motions, start = self.rough(candidates), self.partial.state.time
        end, score = motions[:, END], np.ones(len(candidates))
        possible = (np.isfinite(end) & (end <= self.latest)).nonzero()[0]
        if not len(possible):
            return score, end
        # each candidate at other times: what passes between the instants of one is seen at those of its likes
        share, last, known = rng.random((len(possible), 1)), end[possible, None], len(self.times)
        times = np.empty((len(possible), known + INSTANTS))
        times[:, known:] = start + (last - start) * (_SPREAD + share) / INSTANTS
        if known:
            times[:, :known] = np.where(last > self.times, self.times, start)
        score[possible] = self._depths(times, self.rough.at(motions, possible, times))
        return score, end

    def across(self, candidates: FloatArray, tops: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The same score and end (N,) of arches over `tops` (N,), values of the lift joint, m.

        The joints across move as in direct candidates (N,). Evaluated is the middle of the way alone, where the lift is
        at the top.
        """
        motions = self.rough(candidates)
        begin, end, score = motions[:, BEGIN], motions[:, END], np.ones(len(candidates))
        possible = (np.isfinite(end) & (end <= self.latest)).nonzero()[0]
        if len(possible):
            times = begin[possible, None] + (end - begin)[possible, None] * _MIDDLE
            q = self.rough.at(motions, possible, times)
            q[:, :, self.prover.scene.robot.lift] = tops[possible, None]
            score[possible] = self._depths(times, q)
        return score, end

    def _depths(self, times: FloatArray, q: FloatArray) -> FloatArray:
        """The scores (W,) of motions through q (W, T, n) at times (W, T)."""
        way = self.partial.way(self.prover.scene, float(times.max()))
        return np.minimum(self.prover.depths(way, q, times, DEPTH_M, GIVEN_UP) / INSTANTS, 1.0)


def score_of(refusal: Refusal | None) -> float:
    """The score of a candidate that was screened: how deep it is in something where it was refused for that."""
    if refusal is None:
        return 0.0
    if not isinstance(refusal.facts, Separation) or refusal.amount is None:
        return 1.0
    return min(1.0, refusal.amount.value / DEPTH_M)
