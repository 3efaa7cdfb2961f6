"""The two points at which two convex units are nearest, for the line that is drawn between them."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels.gjk import ABSOLUTE_M, ITERATIONS, POINT_M, RELATIVE, add_farthest, nearest_to_origin
from assur.planner.kernels.solids import BALL


def nearest_points(
    bodies: FloatArray, vertices: FloatArray, placed: FloatArray, a: int, b: int
) -> tuple[FloatArray, FloatArray]:
    """A point of unit a and a point of unit b, each (3,) in the world, whose distance is that of the units; one point
    of both where they meet.

    `bodies`, `vertices`, `placed` (1, U, 12) are the tables of `kernels.solids`. It is the search of `kernels.gjk` for
    the least distance, which keeps both points of each corner of its simplex.
    """
    ones, others, points, work = np.zeros((4, 3)), np.zeros((4, 3)), np.zeros((4, 3)), np.zeros((3, 4))
    v = placed[0, b, :3] - placed[0, a, :3]
    count, weights = 0, np.zeros(4)
    for _ in range(ITERATIONS):
        length = float(np.linalg.norm(v))
        if not length > POINT_M:
            break
        n = v / length
        ones[count], others[count] = 0.0, 0.0
        x, y, z = n.tolist()
        add_farthest(bodies, vertices, placed, 0, b, -x, -y, -z, 1.0, others, count)
        add_farthest(bodies, vertices, placed, 0, a, x, y, z, 1.0, ones, count)
        new = others[count] - ones[count]
        if count and length - float(n @ new) <= RELATIVE * length + ABSOLUTE_M:
            break
        if count and (points[:count] == new).all(-1).any():
            break
        points[count] = new
        count += 1
        inside = not nearest_to_origin(points, count, work)
        if inside:
            break
        weights = work[0, :count].copy()
        keep = weights > 0.0
        kept = int(keep.sum())
        for table in (ones, others, points):
            table[:kept] = table[:count][keep]
        weights, count = weights[keep], kept
        v = weights @ points[:count]
        if count == 4:
            break
    count = min(count, len(weights))
    one, other = weights[:count] @ ones[:count], weights[:count] @ others[:count]
    gap = other - one
    length = float(np.linalg.norm(gap))
    balls = float(bodies[a, BALL] + bodies[b, BALL])
    if length <= max(balls, POINT_M):
        middle = (one + other) / 2.0
        return middle, middle
    n = gap / length
    return one + bodies[a, BALL] * n, other - bodies[b, BALL] * n
