"""Distance of the closest pair at many instants of a motion, with the closest point of each body."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.bodies import Arrangement
from assur.planner.collision.nearest import MEET_M, chosen_point, nearest_at, pairs_of_pieces, simplex
from assur.planner.collision.proof import Prover
from assur.planner.kernels import solids as c
from assur.planner.model.phases import Phase
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory
from assur.scenes.view.poses import joints_at

STEP_S = 0.005
"""Time between the instants, s; ..."""
FEWEST, MOST = 48, 400
"""... but at least and at most this many steps for a motion."""
POINTS_M = 5e-7
"""To which the distance of the points that are drawn is known, m."""


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
    pairs = pairs_of_pieces(arrangement, _pairs_that_move(arrangement, prover.pairs(arrangement, phase).rows, prover))
    closest = list[ClosestPair]()
    for t in times:
        q = joints_at(trajectory, np.array([t]))[0]
        gap, units = nearest_at(prover, arrangement, q, t, pairs)
        if math.isfinite(gap):
            first, second = (arrangement.names[arrangement.body[unit]] for unit in units)
            _, required = prover.rule(phase, first, second)
            points = _closest_points(arrangement, prover.carriers(q, t), *units)
            closest.append(ClosestPair(t, (first, second), gap, required, points))
    return closest


def _pairs_that_move(arrangement: Arrangement, pairs: FloatArray, prover: Prover) -> list[tuple[int, int]]:
    """The pairs of bodies that may not touch and are not both at rest."""
    at_rest = arrangement.bodies.still.astype(bool)
    at_rest[prover.scene.robot.links.index("base")] = True
    units = pairs[:, c.FIRST : c.SECOND + 1].astype(np.int64)
    counts = (pairs[:, c.REQUIRED] >= 0.0) & ~at_rest[arrangement.carrier[units]].all(1)
    return [(one, other) for one, other in arrangement.body[units[counts]].tolist()]


def _closest_points(arrangement: Arrangement, carriers: FloatArray, a: int, b: int) -> tuple[FloatArray, FloatArray]:
    """A point of unit a and a point of unit b, each (3,) in the world, whose distance is that of the units; the same
    point for units that overlap."""
    shown = simplex(arrangement, carriers, a, b, POINTS_M)
    placed, points = arrangement.placed(carriers, (a, b))[2][0], np.zeros((2, 3))
    for weight, way in zip(shown.weights.tolist(), shown.directions, strict=True):
        for k, (unit, along) in enumerate(((a, way), (b, -way))):
            points[k] += weight * chosen_point(arrangement, placed[unit], unit, along)
    if shown.distance_m <= MEET_M:
        points[:] = points.mean(0)
    return points[0], points[1]
