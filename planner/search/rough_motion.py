"""Rough motions of many candidates at once, about as quick as Ruckig's and without asking it."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.kernels.candidates import JOINT_COLUMNS, OF_JOINT, rough_motions, rough_positions
from assur.planner.robots.facts import Limits
from assur.planner.search.partial_plan import Option, PartialPlan


class RoughMotions:
    """Times the candidates that continue one partial plan."""

    def __init__(self, limits: Limits, partial: PartialPlan, options: tuple[Option, ...]) -> None:
        self._limits, state = limits.table, partial.state
        self._start, self._time = np.array([state.q, state.qd]), float(state.time)
        first, rows, meetings = 0, [], []
        for branch in (option.branch for option in options):
            some = branch.meetings[:1] if branch.still else branch.meetings
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
