"""Distance of the closest pair at many instants of a motion, with the closest point of each body."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.proof import Prover
from assur.planner.collision.simplex import simplex
from assur.planner.kernels import gjk, nearest
from assur.planner.kernels import solids as c
from assur.planner.kernels.intervals import STATE_COLUMNS
from assur.planner.kernels.links import POSE_COLUMNS
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.tables.bodies import Arrangement
from assur.planner.trajectory import Trajectory
from assur.scenes.view.poses import joints_at

STEP_S = 0.005
"""Time between the instants, s; ..."""
FEWEST, MOST = 48, 400
"""... but at least and at most this many steps for a motion."""
POINTS_M = 1e-8
"""The closest points are known to this, m."""
BATCH = 32
"""Number of pairs of one kernel call. Pairs come in the order of the distance of their bounding spheres, and calls end
where that distance exceeds the smallest one that occurs."""


@dataclass(frozen=True, eq=False)
class ClosestPair:
    """The closest pair at an instant, s: names of the bodies, distance, m, required distance, m, and the closest point
    (3,) of each body, in the world."""

    time: float
    bodies: tuple[str, str]
    gap_m: float
    required_m: float
    points: tuple[FloatArray, FloatArray]


def distances(
    scene: Scene, trajectory: Trajectory, phases: tuple[Phase, ...], extra: tuple[float, ...] = ()
) -> tuple[ClosestPair, ...]:
    """The closest pair at instants of all phases, in order, and at the times `extra`, s. Pairs that may touch do not
    count while they may, nor pairs of two bodies that never move. Without a pair that counts an instant is left out."""
    phases = tuple(phase for phase in phases if phase.robot and phase.t1 >= phase.t0)
    if not phases:
        return ()
    start, end = phases[0].t0, phases[-1].t1
    count = min(MOST, max(FEWEST, math.ceil((end - start) / STEP_S)))
    even = np.linspace(start, end, count + 1)
    prover, closest = Prover(scene), list[ClosestPair]()
    for phase in phases:
        inner = even[(even > phase.t0) & (even < phase.t1)].tolist()
        times = sorted({phase.t0, *inner, *(t for t in extra if phase.t0 <= t <= phase.t1), phase.t1})
        closest += _in_phase(prover, trajectory, phase, times)
    return tuple(closest)


def _in_phase(prover: Prover, trajectory: Trajectory, phase: Phase, times: list[float]) -> list[ClosestPair]:
    arrangement = prover.of(phase)
    pairs = _pairs_of_pieces(arrangement, prover.pairs(arrangement, phase).every, prover.scene)
    if not len(pairs):
        return []
    closest = list[ClosestPair]()
    for t in times:
        q = joints_at(trajectory, np.array([t]))[0]
        carriers = prover.carriers(q, t)
        state = np.zeros(STATE_COLUMNS)
        state[nearest.UPPER] = np.inf
        motion = prover.motion(prover.standing(q, t))
        in_order, apart = _by_spheres(arrangement, carriers, pairs)
        for begin in range(0, len(in_order), BATCH):
            if apart[begin] > state[nearest.UPPER]:
                break
            batch = np.ascontiguousarray(in_order[begin : begin + BATCH])
            nearest.sample_distance(motion, arrangement.cell, batch, t, t, 2, state)
        gap = float(state[nearest.UPPER])
        if math.isfinite(gap):
            a, b = int(state[nearest.NEAREST_A]), int(state[nearest.NEAREST_B])
            first, second = (arrangement.names[arrangement.body[unit]] for unit in (a, b))
            (row,) = pairs[(pairs[:, c.FIRST] == a) & (pairs[:, c.SECOND] == b)]
            points = _closest_points(arrangement, carriers, a, b)
            closest.append(ClosestPair(t, (first, second), gap, float(row[c.REQUIRED]), points))
    return closest


def _pairs_of_pieces(arrangement: Arrangement, pairs: FloatArray, scene: Scene) -> FloatArray:
    """The pairs of which at least one body moves and which may not touch; bodies of several pieces are replaced by
    their pieces."""
    at_rest = arrangement.bodies.still.astype(bool)
    at_rest[scene.robot.links.index("base")] = True
    units = pairs[:, c.FIRST : c.SECOND + 1].astype(np.int64)
    counts = (pairs[:, c.REQUIRED] >= 0.0) & ~at_rest[arrangement.carrier[units]].all(1)
    rows = list[tuple[float, ...]]()
    for row, (one, other) in zip(pairs[counts], arrangement.body[units[counts]].tolist(), strict=True):
        of_other = arrangement.pieces(other)
        rows += [(a, b, *row[c.SECOND + 1 :]) for a in arrangement.pieces(one) for b in of_other]
    return np.array(rows, dtype=np.float64).reshape(-1, c.PAIR_COLUMNS)


def _by_spheres(arrangement: Arrangement, carriers: FloatArray, pairs: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The pairs in the order of the distance of their bounding spheres, and that distance, m (P,). A pair is left out
    where a pose is not known."""
    rows = arrangement.rows
    turn = carriers[:, 3:].reshape(-1, 3, 3)[arrangement.carrier]
    middle = carriers[:, :3][arrangement.carrier] + np.einsum("uij,uj->ui", turn, rows[:, c.CENTRE : c.CENTRE + 3])
    a, b = pairs[:, c.FIRST].astype(np.int64), pairs[:, c.SECOND].astype(np.int64)
    apart = np.linalg.norm(middle[a] - middle[b], axis=1) - rows[a, c.RADIUS] - rows[b, c.RADIUS]
    known = np.isfinite(apart) & (rows[a, c.PIECES] == 0.0) & (rows[b, c.PIECES] == 0.0)
    pairs, apart = pairs[known], apart[known]
    order = np.argsort(apart)
    return pairs[order], apart[order]


def _closest_points(arrangement: Arrangement, carriers: FloatArray, a: int, b: int) -> tuple[FloatArray, FloatArray]:
    """A point of unit a and a point of unit b, each (3,) in the world, whose distance is that of the units; the same
    point for units that overlap."""
    bodies, vertices = arrangement.rows, arrangement.bodies.vertices
    placed, found = np.empty((1, len(bodies), POSE_COLUMNS)), simplex(arrangement, carriers, a, b, POINTS_M)
    ends = np.zeros((2, 3))
    for end, unit, side in zip(ends, (a, b), (1.0, -1.0), strict=True):
        c.place(bodies, unit, carriers, placed, 0)
        for weight, way in zip(found.weights.tolist(), side * found.directions, strict=True):
            if weight > 0.0:
                point = np.zeros((1, 3))
                x, y, z = way.tolist()
                gjk.add_farthest(bodies, vertices, placed, 0, unit, x, y, z, 1.0, point, 0)
                end += weight * point[0]
    apart, balls = ends[1] - ends[0], bodies[[a, b], c.BALL]
    length = float(np.linalg.norm(apart))
    if length <= max(float(balls.sum()), gjk.POINT_M):
        return ends.mean(0), ends.mean(0)
    return ends[0] + balls[0] / length * apart, ends[1] - balls[1] / length * apart
