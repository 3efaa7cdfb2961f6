"""Where a plan comes closest to anything: a proved lower bound, within 0.05 mm of a distance that occurs."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.proof import BUDGET, MANY, ROOM, STACK, Prover
from assur.planner.kernels.nearest import (
    LOWER,
    NEAREST_A,
    NEAREST_B,
    NEAREST_T,
    SEARCH_COLUMNS,
    UPPER,
    sample_distance,
    search_nearest,
)
from assur.planner.kernels.planes import SIDES
from assur.planner.kernels.proof import DONE, ITEM_COLUMNS, ITEMS_FULL, TOP
from assur.planner.kernels.solids import FIRST, GROWTH, REQUIRED, SECOND
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
    state = np.zeros(SEARCH_COLUMNS)
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
    return Nearest(lower, float(state[NEAREST_T]), (first, second), where.kind, upper)


def _search(prover: Prover, trajectory: Trajectory, phase: Phase, state: FloatArray) -> None:
    """Goes on with the search over one phase."""
    arrangement, spline = prover.of(phase), prover.spline(trajectory)
    asked = prover.pairs(arrangement, phase)
    edges = np.linspace(phase.t0, phase.t1, INSTANTS)
    edges[-1] = phase.t1
    within, pairs = NEARBY_M, asked.every
    many = len(asked.mine) * len(asked.others) > MANY
    least = prover.behind(phase, spline, asked) if many else np.zeros((0, SIDES))
    while many:
        # what planes keep further apart than `within` cannot be nearest, if anything is found that is nearer
        within = min(within, float(state[UPPER]))
        others = asked.others.copy()
        others[:, REQUIRED - 1], others[:, GROWTH - 1 :] = within, 0.0
        pairs = prover.not_behind(phase, asked, others, least)
        _sample(prover, phase, trajectory, pairs, edges, state)
        if state[UPPER] <= within or len(pairs) == len(asked):
            break
        within *= 4
    _sample(prover, phase, trajectory, pairs, edges, state)
    pairs = pairs[pairs[:, REQUIRED] >= 0.0]
    if not len(pairs):
        return
    items, stack = np.zeros((ROOM + 2 * len(pairs), ITEM_COLUMNS)), np.zeros((STACK, 4))
    items[: len(pairs), 0], items[: len(pairs), 1] = pairs[:, FIRST], pairs[:, SECOND]
    stack[0], state[TOP] = (phase.t0, phase.t1, 0, len(pairs)), 1
    for _ in range(MOST_CALLS):
        status = search_nearest(
            prover.robot, prover.laws, prover.side, spline.tk, spline.c, spline.whole, spline.matrix,
            arrangement.rows, arrangement.vertices, arrangement.still, items, stack, state, BUDGET,
        )  # fmt: skip
        if status == DONE:
            return
        if status == ITEMS_FULL:
            items, stack = (np.concatenate([table, np.zeros_like(table)]) for table in (items, stack))
    state[LOWER] = 0.0


def _sample(
    prover: Prover, phase: Phase, trajectory: Trajectory, pairs: FloatArray, t: FloatArray, state: FloatArray
) -> None:
    """Lowers the smallest distance found by a look at instants t (T,)."""
    arrangement, spline = prover.of(phase), prover.spline(trajectory)
    sample_distance(
        prover.robot, prover.laws, prover.side, spline.tk, spline.c, arrangement.rows, arrangement.vertices,
        arrangement.still, pairs, t, state,
    )  # fmt: skip
