"""Where a plan comes closest to anything: a proved lower bound, within 0.05 mm of a distance that occurs."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from typing import Literal

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.collision.bodies import Arrangement
from assur.planner.collision.pairs import Pairs, certain
from assur.planner.collision.proof import Prover, Search
from assur.planner.kernels.intervals import DONE, STATE_COLUMNS
from assur.planner.kernels.nearest import LOWER, NEAREST_A, NEAREST_B, NEAREST_T, UPPER, sample_distance
from assur.planner.kernels.planes import SIDES
from assur.planner.kernels.solids import FIRST, PAIR_COLUMNS, REQUIRED, SECOND, SET
from assur.planner.kernels.walk import NEAREST
from assur.planner.model.deadline import out_of_time
from assur.planner.model.outcome import Nearest
from assur.planner.model.phases import Phase, pair
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


def pairs_of_pieces(arrangement: Arrangement, bodies: Iterable[tuple[int, int]]) -> FloatArray:
    """The pairs (P, PAIR_COLUMNS) of all pieces of pairs of bodies, of which a gap of 0 is required."""
    units = [two for one, other in bodies for two in product(arrangement.pieces(one), arrangement.pieces(other))]
    found = np.zeros((len(units), PAIR_COLUMNS))
    found[:, FIRST : SECOND + 1], found[:, SET] = np.array(units).reshape(-1, 2), -1.0
    return found


def nearest_at(
    prover: Prover, arrangement: Arrangement, q: FloatArray, t: float, pairs: FloatArray
) -> tuple[float, tuple[int, int]]:
    """The smallest distance, m, of pairs of pieces (P, PAIR_COLUMNS) at time t with joints q (n,), and the two units
    that have it; infinite: the place of none is known."""
    state = np.zeros(STATE_COLUMNS)
    state[UPPER] = np.inf
    sample_distance(prover.motion(prover.standing(q, t)), arrangement.cell, pairs, t, t, 1, state)
    return float(state[UPPER]), (int(state[NEAREST_A]), int(state[NEAREST_B]))


def _counted(
    arrangement: Arrangement, asked: Pairs, without: frozenset[tuple[str, str]], of: Kind
) -> FloatArray:  # fmt: skip
    """The rows of pairs of a kind that may not touch and whose bodies are not in `without`, where all is where it is
    planned."""
    pairs = certain(asked.rows[asked.rows[:, REQUIRED] >= 0.0])
    units = pairs[:, FIRST : SECOND + 1].astype(np.int64)
    counted: BoolArray = np.ones(len(pairs), dtype=np.bool_)
    if of != "all":
        counted = (arrangement.carrier[units] >= arrangement.links).all(axis=1) == (of == "placed")
    if without:
        names = [[arrangement.names[body] for body in two] for two in arrangement.body[units].tolist()]
        counted &= np.array([pair(*two) not in without for two in names], dtype=np.bool_)
    return pairs[counted]


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
    motion, asked, within = prover.motion(spline), prover.pairs(arrangement, phase), NEARBY_M
    pairs = counted = _counted(arrangement, asked, without, of)
    if not len(counted):
        return
    least = prover.behind(phase, spline, asked) if asked.many else np.zeros((0, SIDES))
    while True:
        # what planes keep further apart than `within` cannot be nearest, if anything is found that is nearer
        within = min(within, float(state[UPPER]))
        if asked.many:
            counted[:, REQUIRED] = within
            pairs = prover.not_behind(phase, asked, counted, least)
        sample_distance(motion, arrangement.cell, pairs, phase.t0, phase.t1, INSTANTS, state)
        if len(pairs) == len(counted) or state[UPPER] <= within:
            break
        within *= 2
    if not len(pairs):
        return
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
