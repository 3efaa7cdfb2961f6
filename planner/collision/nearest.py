"""Where a plan comes closest to anything: a proved lower bound, within 0.05 mm of a distance that occurs."""

from __future__ import annotations

from typing import Literal

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.proof import Prover, Search
from assur.planner.kernels.intervals import DONE, STATE_COLUMNS
from assur.planner.kernels.nearest import LOWER, NEAREST_A, NEAREST_B, NEAREST_T, UPPER, sample_distance
from assur.planner.kernels.planes import SIDES
from assur.planner.kernels.solids import EARLY, FIRST, LATE, REQUIRED, SECOND, SET
from assur.planner.kernels.walk import NEAREST
from assur.planner.model.deadline import out_of_time
from assur.planner.model.outcome import Nearest
from assur.planner.model.phases import Phase, pair
from assur.planner.tables.bodies import Arrangement
from assur.planner.trajectory import Trajectory

Kind = Literal["all", "arm", "placed"]
"""Which pairs count: all; those of the arm, its tool and what it holds; or those of which the arm bears none, a part
that was put down and what moves against it."""
INSTANTS = 16
"""Instants of a phase at which a first distance is looked for: the nearer to the smallest, the shorter the search."""
NEARBY_M = 0.05
"""In a cell of many bodies those within this distance, m, of what the arm sweeps come first; if that is less than the
smallest clearance, those within several times as much."""
MOST_CALLS = 50
"""Calls of the kernel for one phase: a search that is not over by then, or when the deadline in force passes, has no
lower value but 0."""


def nearest_pairs(prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...], most: int) -> tuple[Nearest, ...]:
    """The smallest clearance of each of the `most` pairs of the arm, its tool and what it holds that come nearest in
    these phases, nearest first: each is the smallest of all pairs but those before it."""
    found: list[Nearest] = []
    while len(found) < most:
        after = nearest(prover, trajectory, phases, frozenset(pair(*each.bodies) for each in found), of="arm")
        if after is None:
            break
        found.append(after)
    return tuple(found)


def nearest(
    prover: Prover,
    trajectory: Trajectory,
    phases: tuple[Phase, ...],
    without: frozenset[tuple[str, str]] = frozenset(),
    of: Kind = "all",
) -> Nearest | None:
    """The pair and time at which the distance is least over all of a motion. Allowed contacts do not count, nor pairs
    of names (in the order of `pair`) in `without`, nor those of another kind than `of`.

    None: there is nothing to keep apart.
    """
    state = np.zeros(STATE_COLUMNS)
    state[LOWER] = state[UPPER] = np.inf
    where: Phase | None = None
    for phase in phases:
        before = float(state[UPPER])
        _search(prover, trajectory, phase, state, without, of)
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


def _others(arrangement: Arrangement, pairs: FloatArray, without: frozenset[tuple[str, str]], of: Kind) -> FloatArray:
    """The rows of pairs of a kind whose bodies are not in `without`."""
    if of != "all":
        carriers = arrangement.carrier[pairs[:, [FIRST, SECOND]].astype(np.int64)]
        placed = (carriers >= arrangement.links).all(axis=1)
        pairs = np.ascontiguousarray(pairs[placed if of == "placed" else ~placed])
    if not without:
        return pairs
    names, body = arrangement.names, arrangement.body
    units = pairs[:, [FIRST, SECOND]].astype(np.int64).tolist()
    kept = [pair(names[body[a]], names[body[b]]) not in without for a, b in units]
    return np.ascontiguousarray(pairs[np.array(kept, dtype=bool)])


def _search(
    prover: Prover,
    trajectory: Trajectory,
    phase: Phase,
    state: FloatArray,
    without: frozenset[tuple[str, str]],
    of: Kind,
) -> None:
    """Goes on with the search over one phase."""
    arrangement, spline = prover.of(phase), prover.spline(trajectory)
    motion, asked = prover.motion(spline), prover.pairs(arrangement, phase)
    within, pairs, many = NEARBY_M, asked.every, asked.many
    if not len(_others(arrangement, pairs, without, of)):
        return
    least = prover.behind(phase, spline, asked) if many else np.zeros((0, SIDES))
    while many:
        # what planes keep further apart than `within` cannot be nearest, if anything is found that is nearer
        within = min(within, float(state[UPPER]))
        others = asked.others.copy()
        others[:, REQUIRED - 1], others[:, SET - 1] = within, -1.0
        close = prover.not_behind(phase, asked, others, least)
        pairs = _others(arrangement, close, without, of)
        sample_distance(motion, arrangement.cell, pairs, phase.t0, phase.t1, INSTANTS, state)
        if state[UPPER] <= within or len(close) == len(asked):
            break
        within *= 2
    if not many:
        pairs = _others(arrangement, pairs, without, of)
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
        if out_of_time():
            search.state[LOWER] = 0.0
            break
    else:
        search.state[LOWER] = 0.0
    state[1:] = search.state[1:]
