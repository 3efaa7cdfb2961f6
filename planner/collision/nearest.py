"""Where a plan comes closest to anything: a proved lower bound, within 0.05 mm of a distance that occurs."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.proof import Prover, Search
from assur.planner.kernels.intervals import DONE, STATE_COLUMNS
from assur.planner.kernels.nearest import LOWER, NEAREST_A, NEAREST_B, NEAREST_T, UPPER, sample_distance
from assur.planner.kernels.planes import SIDES
from assur.planner.kernels.solids import EARLY, LATE, REQUIRED, SET
from assur.planner.kernels.walk import NEAREST
from assur.planner.model.outcome import Nearest
from assur.planner.model.phases import Phase
from assur.planner.trajectory import Trajectory

INSTANTS = 16
"""Instants of a phase at which a first distance is looked for: the nearer to the smallest, the shorter the search."""
NEARBY_M = 0.05
"""In a cell of many bodies those within this distance, m, of what the arm sweeps come first; if that is less than the
smallest clearance, those within several times as much."""
MOST_CALLS = 50
"""Calls of the kernel for one phase: a search that is not over by then has no lower value but 0."""


def nearest(prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...]) -> Nearest | None:
    """The pair and time at which the distance is least over all of a motion. Allowed contacts do not count.

    None: there is nothing to keep apart.
    """
    state = np.zeros(STATE_COLUMNS)
    state[LOWER] = state[UPPER] = np.inf
    where: Phase | None = None
    for phase in phases:
        before = float(state[UPPER])
        _search(prover, trajectory, phase, state)
        if state[UPPER] < before:
            where = phase
    if where is None:
        return None
    arrangement = prover.of(where)
    first, second = (arrangement.names[arrangement.body[int(state[k])]] for k in (NEAREST_A, NEAREST_B))
    upper = float(state[UPPER])
    lower = max(0.0, min(float(state[LOWER]), upper))
    time = min(max(float(state[NEAREST_T]), where.t0), where.t1)  # instants are sums, which round
    return Nearest(lower, time, (first, second), where.kind, upper)


def _search(prover: Prover, trajectory: Trajectory, phase: Phase, state: FloatArray) -> None:
    """Goes on with the search over one phase."""
    arrangement, spline = prover.of(phase), prover.spline(trajectory)
    motion, asked = prover.motion(spline), prover.pairs(arrangement, phase)
    within, pairs, many = NEARBY_M, asked.every, asked.many
    least = prover.behind(phase, spline, asked) if many else np.zeros((0, SIDES))
    while many:
        # what planes keep further apart than `within` cannot be nearest, if anything is found that is nearer
        within = min(within, float(state[UPPER]))
        others = asked.others.copy()
        others[:, REQUIRED - 1], others[:, SET - 1] = within, -1.0
        pairs = prover.not_behind(phase, asked, others, least)
        sample_distance(motion, arrangement.cell, pairs, phase.t0, phase.t1, INSTANTS, state)
        if state[UPPER] <= within or len(pairs) == len(asked):
            break
        within *= 2
    if not many:
        sample_distance(motion, arrangement.cell, pairs, phase.t0, phase.t1, INSTANTS, state)
    pairs = pairs[pairs[:, REQUIRED] >= 0.0]
    if not len(pairs):
        return
    # where all is where it is planned
    pairs[:, SET], pairs[:, EARLY : LATE + 1] = -1.0, 0.0
    search = Search(prover, phase, spline, pairs, prover.exact)
    search.state[1:] = state[1:]
    for _ in range(MOST_CALLS):
        if search.go_on(NEAREST) == DONE:
            break
    else:
        search.state[LOWER] = 0.0
    state[1:] = search.state[1:]
