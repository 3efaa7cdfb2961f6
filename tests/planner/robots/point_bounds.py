"""What the kernels bound of points on a robot's links, in arrays, for tests."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.kernels.carriers import point_bound
from assur.planner.kernels.links import BOUND_COLUMNS, bound_links
from assur.planner.robots.robot import Robot


@dataclass(frozen=True, slots=True)
class Sweep:
    """What is known of the joint motion over N intervals: joint range `lower, upper` (N, n), and upper bounds of
    |C q̇| and |C q̈| with C = `rate_matrix`: `rate, rate_d` (N, m)."""

    lower: FloatArray
    upper: FloatArray
    rate: FloatArray
    rate_d: FloatArray


def point_bounds(
    robot: Robot, link: IntArray, reach: FloatArray, distance: FloatArray, n: FloatArray, sweep: Sweep
) -> tuple[FloatArray, FloatArray]:
    """Upper bounds (N,) of |n·ẋ| and |n·ẍ| over N intervals, for every point x of link number `link` (N,), along unit
    vectors `n` (N, 3). The points are within horizontal distance `reach` (N,) of the link frame's z axis (an upright
    link looks at this alone) and within `distance` (N,) of its origin (a tilting link looks at this)."""
    found, bounds = np.empty((len(link), 2)), np.empty((len(robot.links), BOUND_COLUMNS))
    for i, k in enumerate(link.tolist()):
        lower, upper, rate, rate_d = (np.array(x[i]) for x in (sweep.lower, sweep.upper, sweep.rate, sweep.rate_d))
        bound_links(robot.row, lower, upper, rate, rate_d, bounds)
        sizes = (0.0, float(distance[i])) if k in robot.tilting else (float(reach[i]), 0.0)
        found[i] = point_bound(bounds, k, *sizes, *n[i].tolist())
    return found[:, 0].copy(), found[:, 1].copy()
