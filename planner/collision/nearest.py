"""Where a plan comes closest to anything: looked for at instants, told as a lower bound of the distance there.

The gap along any unit normal bounds the distance from below (C1), so pairs and instants whose bound is not below the
least distance found so far need not be looked at. Bounds come from circles, then from likely normals, and then from the
normals that GJK shows for the nearest of them: they serve for the instants beside it, where the normal is almost the
same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.collision.arrangement import COVER, Carriers, Solids, carriers, exempted, standing
from assur.planner.collision.gjk import RELATIVE, separate
from assur.planner.collision.proof import Prover
from assur.planner.collision.support_gaps import Placed, gaps, likely_gaps, place, rough_gaps, swept_gaps
from assur.planner.model.leeway import Nearest
from assur.planner.model.phases import Phase
from assur.planner.trajectory import Trajectory

INSTANTS = 64
"""Times at which the smallest clearance is looked for."""
BATCH = 192
"""Pairs and times that are looked at together."""
PAIRS = 64
"""Pairs that are looked at together, those first whose places come nearest to each other at any times."""
FINER = 65
"""Times around the nearest one at which its pair is looked at again: one batch costs little more than one row of it."""


@dataclass(frozen=True, slots=True)
class _Spot:
    """The distance `gap`, m, of asked pair number `pair` at a time."""

    gap: float
    time: float
    pair: int


def nearest(prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...]) -> Nearest | None:
    """The pair and time, of `INSTANTS` and then `FINER` about them, at which the distance is least.

    Of the pairs and times that are likely to be nearest GJK is asked; what is given is a lower bound of the distance
    there, within GJK's tolerance of it. Allowed contacts do not count. None: nothing is asked.
    """
    best: tuple[_Spot, Phase] | None = None
    total = sum(phase.t1 - phase.t0 for phase in phases)
    for phase in phases:
        count = max(2, int(np.ceil(INSTANTS * (phase.t1 - phase.t0) / total))) if total > 0 else 2
        look = _Look(prover, trajectory, phase)
        found = look.at(np.linspace(phase.t0, phase.t1, count))
        if found is not None and (best is None or found.gap < best[0].gap):
            step = (phase.t1 - phase.t0) / (count - 1)
            around = np.linspace(max(phase.t0, found.time - step), min(phase.t1, found.time + step), FINER)
            finer = look.beside(found, around)
            best = (finer if (finer.gap, finer.time) < (found.gap, found.time) else found), phase
    if best is None:
        return None
    spot, phase = best
    solids = prover.solids(phase.carried, phase.rides)
    a, b = prover.asked(solids)
    names = (solids.names[solids.body[a[spot.pair]]], solids.names[solids.body[b[spot.pair]]])
    return Nearest(spot.gap, spot.time, names, phase.kind)


class _Look:
    """The asked pairs of one phase, less those that may touch."""

    def __init__(self, prover: Prover, trajectory: Trajectory, phase: Phase) -> None:
        self.scene, self.trajectory = prover.scene, trajectory
        self.solids = prover.solids(phase.carried, phase.rides)
        self.a, self.b = prover.asked(self.solids)
        self.pairs = np.arange(len(self.a))
        if phase.exempt:
            self.pairs = self.pairs[~exempted(self.solids, phase, self.a, self.b)]

    def at(self, t: FloatArray) -> _Spot | None:
        """The nearest pair at times t (T,); None: there is no pair."""
        if not len(self.pairs):
            return None
        where = carriers(self.scene, standing(self.trajectory, t), t)
        least = swept_gaps(self.solids, where, self.a[self.pairs], self.b[self.pairs])
        order = np.argsort(least, kind="stable")
        best = _Spot(np.inf, float(t[0]), int(self.pairs[0]))
        # the pairs that may be nearest first: the others need not be looked at
        for first in range(0, len(order), PAIRS):
            some = order[first : first + PAIRS]
            if not least[some[0]] < best.gap:
                break
            best = self._among(self.pairs[some], where, t, best)
        return best

    def beside(self, spot: _Spot, t: FloatArray) -> _Spot:
        """The nearest of times t (T,) for the pair of `spot`."""
        where = carriers(self.scene, standing(self.trajectory, t), t)
        batch = _Batch(self.solids, where, t, np.arange(len(t)), np.full(len(t), spot.pair), self.a, self.b)
        return batch.least(_Spot(np.inf, spot.time, spot.pair))

    def _among(self, pairs: IntArray, where: Carriers, t: FloatArray, best: _Spot) -> _Spot:
        """`best`, or what is nearer among the given pairs (P,) at times t (T,)."""
        rough = rough_gaps(self.solids, where, self.a[pairs], self.b[pairs])
        row, column = np.unravel_index(np.argsort(rough, axis=None, kind="stable"), rough.shape)
        # the roughly nearest first: what is roughly further than the nearest found so far need not be looked at
        for first in range(0, len(row), BATCH):
            if not rough[row[first], column[first]] < best.gap:
                break
            part = slice(first, first + BATCH)
            batch = _Batch(self.solids, where, t, row[part], pairs[column[part]], self.a, self.b)
            best = batch.least(best)
        return best


class _Batch:
    """Asked pairs number `pair` (r,) of units a, b at times number `row` (r,) of t, placed."""

    def __init__(
        self, solids: Solids, where: Carriers, t: FloatArray, row: IntArray, pair: IntArray, a: IntArray, b: IntArray
    ) -> None:
        self.solids, self.where, self.t, self.row, self.pair = solids, where, t, row, pair
        self.units = a[pair], b[pair]
        self.one, self.other = (place(solids, where, row, units) for units in self.units)

    def _along(self, n: FloatArray) -> FloatArray:
        """Gaps (r,) along one unit normal (3,); −inf where there is none."""
        found = gaps(self.one, self.other, np.broadcast_to(n, (len(self.row), 1, 3)))[:, 0]
        return np.where(np.isnan(found), -np.inf, found)

    def least(self, best: _Spot) -> _Spot:
        """`best`, or what is nearer here, by more than GJK can tell."""
        bound = likely_gaps(self.one, self.other)
        while True:
            k = int(np.argmin(bound))
            # no distance is below 0
            if not max(0.0, bound[k]) < best.gap * (1 - RELATIVE):
                return best
            gap, normal = self._distance(k)
            gap = max(float(bound[k]), gap)
            if gap < best.gap:
                best = _Spot(gap, float(self.t[self.row[k]]), int(self.pair[k]))
            bound[k] = np.inf
            if normal is not None and (bound < best.gap * (1 - RELATIVE)).any():
                bound = np.maximum(bound, self._along(normal))

    def _distance(self, k: int) -> tuple[float, FloatArray | None]:
        """Distance, m, of the pair in row k, and the normal that shows it, if it is of single pieces."""
        a, b = (int(units[k]) for units in self.units)
        if self.solids.piece[a] == COVER or self.solids.piece[b] == COVER:
            return _between_pieces(self.solids, self.where, int(self.row[k]), a, b), None
        return separate(self.one, self.other, k)


def _between_pieces(solids: Solids, where: Carriers, row: int, first: int, second: int) -> float:
    """Distance, m, of two bodies of several pieces at one time: the nearest pair of pieces, by GJK."""
    ones, others = (np.array(solids.pieces[int(solids.body[unit])]) for unit in (first, second))
    rows = np.full(len(ones) * len(others), row)
    one: Placed = place(solids, where, rows, np.repeat(ones, len(others)))
    other: Placed = place(solids, where, rows, np.tile(others, len(ones)))
    gap, best = likely_gaps(one, other), np.inf
    for k in np.argsort(gap, kind="stable"):
        if not gap[k] < best:
            break
        best = min(best, separate(one, other, int(k))[0])
    return float(best)
