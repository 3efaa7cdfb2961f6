"""The coarse score of many candidates at once: rough motions, evaluated at a few times, tell which are worth timing.

Nothing is accepted or refused by it. It orders the candidates; those that are tried are timed by Ruckig and screened.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.proof import Prover
from assur.planner.kernels.candidates import (
    BEGIN,
    END,
    JERK,
    JOINT_COLUMNS,
    OF_JOINT,
    OPTION,
    VELOCITY,
    rough_motions,
    rough_positions,
)
from assur.planner.legs.missed import ArchForm
from assur.planner.model.refusal import Refusal, Separation
from assur.planner.robots.facts import Limits
from assur.planner.search.partial_plan import Option, PartialPlan
from assur.planner.search.tuning import APART_S, DEPTH_M, FINE, GIVEN_UP, INSTANTS, LEAST_RISE_M, REMEMBERED, WAITING

# Rough motions of many candidates at once, about as quick as Ruckig's and without asking it.


class RoughMotions:
    """Times the candidates that continue one partial plan."""

    def __init__(self, limits: Limits, partial: PartialPlan, options: tuple[Option, ...]) -> None:
        self.limits, state = limits.table, partial.state
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
        rough_motions(candidates, self._start, self._time, self.limits, self._options, self._meetings, motions)
        return motions

    def at(self, motions: FloatArray, which: IntArray, t: FloatArray) -> FloatArray:
        """q (W, T, n) of some of the motions (W,) at times t (W, T), the arm standing still before and after."""
        q = np.empty((*t.shape, self._start.shape[1]))
        rough_positions(motions, which, np.ascontiguousarray(t), q)
        return q


_SPREAD = (7 * np.arange(INSTANTS) + INSTANTS - 1) % INSTANTS
"""The instants of a rough motion in an order in which those that follow each other are far apart; the end first."""


_WAITING = (np.arange(WAITING) + 0.5) / WAITING
"""Shares of its wait at which a candidate is evaluated finely,"""
_MOVING = ((5 * np.arange(FINE) + FINE // 2) % FINE + 0.5) / FINE
"""and those of its motion, in an order in which those that follow each other are far apart."""


class CoarseScore:
    """Scores the candidates from one partial plan to its options."""

    def __init__(self, prover: Prover, partial: PartialPlan, options: tuple[Option, ...]) -> None:
        self.prover, self.partial, self.options = prover, partial, options
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
        motions, start, known = self.rough(candidates), self.partial.state.time, len(self.times)
        possible = self._possible(motions)
        # each candidate at other times: what passes between the instants of one is seen at those of its likes
        share, last = rng.random((len(possible), 1)), motions[possible, END, None]
        times = np.empty((len(possible), known + INSTANTS))
        times[:, known:] = start + (last - start) * (_SPREAD + share) / INSTANTS
        if known:
            times[:, :known] = np.where(last > self.times, self.times, start)
        return self._scored(motions, possible, times, self.rough.at(motions, possible, times)), motions[:, END]

    def finely(self, candidates: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The same score and end (N,) of a few candidates, at so many instants that little is between them."""
        motions = self.rough(candidates)
        possible = self._possible(motions)
        begin, end = motions[possible, BEGIN, None], motions[possible, END, None]
        times = self._fine_times(begin, end - begin)
        return self._scored(motions, possible, times, self.rough.at(motions, possible, times)), motions[:, END]

    def _fine_times(self, begin: FloatArray, lasts: FloatArray) -> FloatArray:
        """Times (W, WAITING + FINE) of motions that begin at `begin` (W, 1) and last so long, s."""
        start = self.partial.state.time
        return np.hstack([start + (begin - start) * _WAITING, begin + lasts * _MOVING])

    def arches(self, candidates: FloatArray, forms: Sequence[ArchForm]) -> tuple[FloatArray, FloatArray]:
        """The same for arches (N,). The joints across move as in direct `candidates` (N,), the lift joint by a rough
        motion up and down of its own."""
        motions, lift = self.rough(candidates), self.prover.scene.robot.lift or 0
        possible = self._possible(motions)
        begin, across = motions[possible, BEGIN, None], (motions[possible, END] - motions[possible, BEGIN])[:, None]
        top, rise, fall = (
            np.array([(form.top, form.rise, form.fall) for form in forms]).reshape(-1, 3)[possible].T[:, :, None]
        )
        branches = [self.options[int(candidates[k, OPTION])].branch for k in possible.tolist()]
        low = float(self.partial.state.q[lift])
        goal = np.array([branch.q[0, lift] for branch in branches]).reshape(-1, 1)
        up, down = self._lifting(top - low, lift), self._lifting(top - goal, lift)
        ahead, behind = rise * up, fall * down
        whole = np.maximum(ahead + across + behind, up + down)
        # before a moving end nothing can stand still: the joints across take longer
        still = [[self.partial.state.resting and branch.still] for branch in branches]
        with np.errstate(divide="ignore", invalid="ignore"):  # nothing goes across where the arm goes up and down alone
            slower = np.where(np.reshape(still, (-1, 1)), 1.0, (whole - ahead - behind) / across)
        times = self._fine_times(begin, whole)
        q = self.rough.at(motions, possible, begin + (times - begin - ahead) / slower)
        # shares of the ways up and down by their shares of time: about as a motion with limited jerk goes
        risen, left = ((times - begin) / up).clip(0.0, 1.0), ((begin + whole - times) / down).clip(0.0, 1.0)
        risen, left = risen * risen * (3.0 - 2.0 * risen), left * left * (3.0 - 2.0 * left)
        q[:, :, lift] = np.minimum(low + (top - low) * risen, goal + (top - goal) * left)
        score, end = self._scored(motions, possible, times, q), motions[:, END].copy()
        end[possible] = (begin + whole)[:, 0]
        return score, end

    def _lifting(self, height: FloatArray, lift: int) -> FloatArray:
        """About how long the lift joint takes for a height, m, from rest to rest, s."""
        velocity, acceleration, jerk = self.rough.limits[VELOCITY : JERK + 1, lift].tolist()
        height = np.maximum(height, LEAST_RISE_M)
        ramps = np.where(
            height * acceleration > velocity**2,
            height / velocity + velocity / acceleration,
            2.0 * np.sqrt(height / acceleration),
        )
        lasts: FloatArray = ramps + acceleration / jerk
        return lasts

    def _possible(self, motions: FloatArray) -> IntArray:
        """The numbers of the motions that are possible in time."""
        end = motions[:, END]
        return (np.isfinite(end) & (end <= self.latest)).nonzero()[0]

    def _scored(self, motions: FloatArray, chosen: IntArray, times: FloatArray, q: FloatArray) -> FloatArray:
        """Scores of all motions (N,); evaluated are the `chosen` (W,) at `times` (W, T) with joints `q` (W, T, n)."""
        score = np.ones(len(motions))
        if len(chosen):
            way = self.partial.way(self.prover.scene, float(times.max()))
            score[chosen] = np.minimum(self.prover.depths(way, q, times, DEPTH_M, GIVEN_UP) / INSTANTS, 1.0)
        return score


def score_of(refusal: Refusal | None) -> float:
    """The score of a candidate that was screened: how deep it is in something where it was refused for that."""
    if refusal is None:
        return 0.0
    if not isinstance(refusal.facts, Separation) or refusal.amount is None:
        return 1.0
    return min(1.0, refusal.amount.value / DEPTH_M)
