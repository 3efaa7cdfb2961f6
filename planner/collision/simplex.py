"""Why two pieces are as near as they are: up to four directions, with weights.

Along each direction both pieces have points that are farthest along it; the sums of these points with the weights are
as near to each other as the pieces. The search is that of `kernels.gjk.separate`, with its balls among the points, and
directions a little turned: along a normal of a flat side no single point is the farthest.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.bodies import Arrangement
from assur.planner.kernels.gjk import add_farthest, nearest_to_origin
from assur.planner.kernels.solids import BALL

TURNS = 1e-5 * np.array([[0.61, -0.37, 0.7], [0.37, 0.7, -0.61], [-0.7, 0.61, 0.37], [0.28, 0.55, 0.79]])
"""One of them is added to unit directions. So a checker chooses the same points for edges of 0.5 mm or more,
whatever it rounds."""
ENOUGH_M = 2e-6
"""The search ends when the distance is known to this, m. If it were known better, a direction might become one in which
two points are equally far."""
MEET_M = 1e-9
"""Points this near have no direction, m."""
ITERATIONS = 200
"""Round bodies converge linearly."""


class Simplex(NamedTuple):
    """`distance_m` of two points; `weights` (4,), and `directions` (4, 3) in the world from the first piece to the
    second, of which the last ones may have no weight."""

    distance_m: float
    weights: FloatArray
    directions: FloatArray


def simplex(arrangement: Arrangement, carriers: FloatArray, a: int, b: int, enough_m: float = ENOUGH_M) -> Simplex:
    """That of units a and b, which are pieces, with their carriers (K, 12) where they are, when the distance is known
    to `enough_m`."""
    rows, vertices = arrangement.rows, arrangement.bodies.vertices
    placed = arrangement.placed(carriers, (a, b))
    axes = np.concatenate([placed[0, unit, 3:12].reshape(3, 3) for unit in (a, b)], axis=1)
    turn = TURNS[np.argmax(np.abs(TURNS @ axes).min(axis=1))]
    balls, work = float(rows[a, BALL] + rows[b, BALL]), np.empty((3, 4))
    points, directions = np.zeros((4, 3)), np.zeros((4, 3))
    weights, count, between = np.zeros(4), 0, placed[0, b, :3] - placed[0, a, :3]
    for _ in range(ITERATIONS):
        length = float(np.linalg.norm(between))
        if count and not length > MEET_M:
            break
        way = (between / length if length > MEET_M else np.zeros(3)) + turn
        way /= np.linalg.norm(way)
        point = np.zeros((1, 3))
        x, y, z = way.tolist()
        add_farthest(rows, vertices, placed, 0, b, -x, -y, -z, 1.0, point, 0)
        add_farthest(rows, vertices, placed, 0, a, x, y, z, -1.0, point, 0)
        point[0] -= balls * way
        # no direction brings the pieces nearer than this, and the point is none that is known
        if count and (length - float(way @ point[0]) <= enough_m or (points[:count] == point[0]).all(axis=1).any()):
            break
        points[count], directions[count] = point[0], way
        count += 1
        if not nearest_to_origin(points, count, work):
            weights = np.linalg.lstsq(np.vstack([points.T, np.ones(4)]), np.array([0.0, 0.0, 0.0, 1.0]), rcond=None)[0]
            weights = np.maximum(weights, 0.0)
            weights /= weights.sum()
            break
        kept = [k for k in range(count) if work[0, k] > 0.0]
        weights = np.zeros(4)
        count, weights[: len(kept)] = len(kept), work[0, kept]
        points[:count], directions[:count] = points[kept], directions[kept]
        between = weights @ points
        if count == 4:
            break
    return Simplex(float(np.linalg.norm(weights @ points)), weights, directions)
