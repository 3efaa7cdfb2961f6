"""How near the arm comes to anything over a motion: the nearest pair at many instants, and the points of both."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.proof import Prover
from assur.planner.kernels.intervals import STATE_COLUMNS
from assur.planner.kernels.links import POSE_COLUMNS
from assur.planner.kernels.nearest import NEAREST_A, NEAREST_B, UPPER, sample_distance
from assur.planner.kernels.solids import CENTRE, FIRST, PAIR_COLUMNS, PIECES, RADIUS, REQUIRED, SECOND, place
from assur.planner.model.clearance import rule_of
from assur.planner.model.phases import Phase
from assur.planner.tables.bodies import Arrangement
from assur.planner.tracks.nearest_points import nearest_points
from assur.planner.tracks.poses import joints_at
from assur.planner.trajectory import Trajectory

STEP_S = 0.005
"""Time between the instants, s; ..."""
FEWEST, MOST = 48, 400
"""... but so many over a motion at least and at most."""
AT_ONCE = 32
"""Pairs that are looked at before those behind them, whose bounding spheres are further apart, are left out."""


@dataclass(frozen=True, eq=False)
class Nearby:
    """The nearest pair at an instant, s: bodies by name, distance, m, what it must be, m, and the two points, (3,)."""

    time: float
    bodies: tuple[str, str]
    gap_m: float
    required_m: float
    points: tuple[FloatArray, FloatArray]


def distances(
    prover: Prover, trajectory: Trajectory, phases: tuple[Phase, ...], also: tuple[float, ...] = ()
) -> tuple[Nearby, ...]:
    """The nearest pair at instants of all phases, in order, and at those of `also`. Pairs that may touch do not count
    while they may, nor pairs that both stand for ever; where nothing is to be kept apart there is no entry."""
    phases = tuple(phase for phase in phases if phase.robot and phase.t1 >= phase.t0)
    if not phases:
        return ()
    start, end = phases[0].t0, phases[-1].t1
    count = min(MOST, max(FEWEST, math.ceil((end - start) / STEP_S)))
    even = np.linspace(start, end, count + 1)
    found = list[Nearby]()
    for phase in phases:
        inner = even[(even > phase.t0) & (even < phase.t1)].tolist()
        times = sorted({phase.t0, *inner, *(t for t in also if phase.t0 <= t <= phase.t1), phase.t1})
        found += _of_phase(prover, trajectory, phase, times)
    return tuple(found)


def _of_phase(prover: Prover, trajectory: Trajectory, phase: Phase, times: list[float]) -> list[Nearby]:
    arrangement = prover.of(phase)
    pairs = _pieces(arrangement, prover.pairs(arrangement, phase).every, prover.scene.robot.links.index("base"))
    if not len(pairs):
        return []
    found = list[Nearby]()
    for t in times:
        q = joints_at(trajectory, np.array([t]))[0]
        carriers = prover.carriers(q, t)
        state = np.zeros(STATE_COLUMNS)
        state[UPPER] = np.inf
        motion = prover.motion(prover.standing(q, t))
        sorted_pairs, apart = _by_spheres(arrangement, carriers, pairs)
        for begin in range(0, len(sorted_pairs), AT_ONCE):
            if apart[begin] > state[UPPER]:
                break
            some = np.ascontiguousarray(sorted_pairs[begin : begin + AT_ONCE])
            sample_distance(motion, arrangement.cell, some, t, t, 2, state)
        if np.isfinite(state[UPPER]):
            found.append(_nearby(prover, phase, arrangement, carriers, t, state))
    return found


def _nearby(
    prover: Prover, phase: Phase, arrangement: Arrangement, carriers: FloatArray, t: float, state: FloatArray
) -> Nearby:
    a, b = int(state[NEAREST_A]), int(state[NEAREST_B])
    placed = np.empty((1, len(arrangement.rows), POSE_COLUMNS))
    for unit in (a, b):
        place(arrangement.rows, unit, carriers, placed, 0)
    points = nearest_points(arrangement.rows, arrangement.bodies.vertices, placed, a, b)
    first, second = (arrangement.names[arrangement.body[unit]] for unit in (a, b))
    _, required = rule_of(prover.scene, phase, first, second)
    return Nearby(t, (first, second), float(state[UPPER]), required, points)


def _pieces(arrangement: Arrangement, pairs: FloatArray, base: int) -> FloatArray:
    """Pairs that may not touch and of which one at least can move, bodies of several pieces replaced by these. The
    distance of what never moves says nothing of a motion."""
    found = list[tuple[float, ...]]()
    still = arrangement.bodies.still.astype(bool)
    still[base] = True
    stands = still[arrangement.carrier]
    units = pairs[:, FIRST : SECOND + 1].astype(np.int64)
    for row in pairs[(pairs[:, REQUIRED] >= 0.0) & ~stands[units].all(1)]:
        one, other = (arrangement.pieces(int(arrangement.body[int(row[column])])) for column in (FIRST, SECOND))
        found += [(a, b, *row[SECOND + 1 :]) for a in one for b in other]
    return np.array(found, dtype=np.float64).reshape(-1, PAIR_COLUMNS)


def _by_spheres(arrangement: Arrangement, carriers: FloatArray, pairs: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The pairs, those whose bounding spheres are nearest first, and how far these are apart, m (P,); where a pose is
    not known the pair is left out."""
    rows = arrangement.rows
    turn = carriers[:, 3:].reshape(-1, 3, 3)[arrangement.carrier]
    middle = carriers[:, :3][arrangement.carrier] + np.einsum("uij,uj->ui", turn, rows[:, CENTRE : CENTRE + 3])
    a, b = pairs[:, FIRST].astype(np.int64), pairs[:, SECOND].astype(np.int64)
    apart = np.linalg.norm(middle[a] - middle[b], axis=1) - rows[a, RADIUS] - rows[b, RADIUS]
    known = np.isfinite(apart) & (rows[a, PIECES] == 0.0) & (rows[b, PIECES] == 0.0)
    pairs, apart = pairs[known], apart[known]
    order = np.argsort(apart)
    return pairs[order], apart[order]
