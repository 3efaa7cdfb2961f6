"""Convex hulls of points: never degenerate, never with more corners than a support function can afford.

A hull of ours contains all of its points to `COVER_SLACK_M`; that is checked each time, so neither a flat cluster, nor
rounding in Qhull, nor our own simplification can uncover a surface.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.errors import FaultError
from assur.planner.geometry.shapes import Hull

THICKNESS_M = 1e-4
"""A hull is at least this thick, m: flat clusters of triangles are grown by half of it to both sides."""
COVER_SLACK_M = 1e-10
"""How far a point may be outside its hull by rounding, m: a tenth of the slack that the planner takes off each gap."""
MAX_CORNERS = 256
"""Corners of one hull. Rounder hulls are replaced by a polytope around them."""
MAX_PLANES = (MAX_CORNERS + 4) // 2
"""A simple polytope of F faces has 2F - 4 corners."""
PLANES = (8, 12, 18, 26, 40, 60)
"""Faces of polytopes that are tried around a hull that is to have fewer corners."""


def hull_of(points: FloatArray) -> Hull:
    """A convex polyhedron, outward faces, that contains `points` (k, 3), m, k >= 1."""
    thick = thickened(distinct(points)[0])
    corners, faces, equations = _quick(thick)
    if len(corners) > MAX_CORNERS:
        corners, faces, equations = _quick(_around(corners, equations, MAX_PLANES))
    if not _contains(equations, thick):
        corners, faces, equations = _quick(_box(thick))
        if not _contains(equations, thick):
            raise FaultError("a box does not contain the points that it was drawn around")
    return Hull(corners, faces)


def distinct(points: FloatArray) -> tuple[FloatArray, IntArray]:
    """Points (m, 3), each once, in the order of z, y, x; and which of them each of `points` (k, 3) is, (k,)."""
    order = np.lexsort(points.T)
    ordered = points[order]
    new = np.concatenate([[True], (ordered[1:] != ordered[:-1]).any(1)])
    which = np.empty(len(points), dtype=np.int64)
    which[order] = np.cumsum(new) - 1
    return ordered[new], which


def rough_hull(points: FloatArray) -> Hull:
    """The hull of points, to judge it: thickened, but neither simplified nor checked."""
    corners, faces, _ = _quick(thickened(points))
    return Hull(corners, faces)


def volume_of_hull(points: FloatArray) -> float:
    """Volume of the hull of points (k, 3), m³; 0 where it is flat."""
    if len(points) < 4:
        return 0.0
    try:
        return float(ConvexHull(points).volume)
    except QhullError:
        return 0.0


def thickened(points: FloatArray) -> FloatArray:
    """`points`, grown along each of their principal axes in which they extend by less than `THICKNESS_M`."""
    centred = points - points.mean(0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    for axis in axes.T:
        extent = float(np.ptp(points @ axis))
        if extent < THICKNESS_M:
            shift = axis * (THICKNESS_M / 2)
            points = np.concatenate([points - shift, points + shift])
    return points


def _quick(points: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
    """Corners (m, 3), outward triangles (f, 3), planes (f, 4) with n·x + d <= 0 inside."""
    found = ConvexHull(points)
    used, inverse = np.unique(found.simplices, return_inverse=True)
    corners: FloatArray = points[used]
    faces = inverse.reshape(-1, 3).astype(np.int64)
    normals = np.cross(corners[faces[:, 1]] - corners[faces[:, 0]], corners[faces[:, 2]] - corners[faces[:, 0]])
    inward = np.einsum("fi,fi->f", normals, found.equations[:, :3]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return corners, faces, found.equations


def _contains(equations: FloatArray, points: FloatArray) -> bool:
    highest = max(
        float((points[i : i + 4096] @ equations[:, :3].T + equations[:, 3]).max()) for i in range(0, len(points), 4096)
    )
    return highest <= COVER_SLACK_M


def simpler(hull: Hull, tight_m: float) -> tuple[Hull, float]:
    """A hull with fewer corners that contains this one and reaches out of it by `tight_m` at most, m, and how far it
    does; this one, where that saves nothing."""
    corners, _, equations = _quick(hull.vertices)
    for planes in PLANES:
        if 2 * planes - 4 >= len(corners):
            break
        around = _around(corners, equations, planes)
        out = max(_distance(point, corners) for point in around)
        if out <= tight_m:
            found, faces, equations = _quick(around)
            if _contains(equations, corners):
                return Hull(found, faces), out
    return hull, 0.0


def _distance(point: FloatArray, corners: FloatArray) -> float:
    """How far a point (3,) is from the hull of corners (m, 3), m: the nearest of their convex combinations."""
    from scipy.optimize import nnls  # 0.1 s to load, for imported robots only

    scale = float(np.ptp(corners, axis=0).max())
    moved = (corners - point) / scale
    # a row that is much heavier than the others holds the sum of the shares at 1
    rows = np.concatenate([moved.T, np.full((1, len(corners)), 1e3)])
    shares, _ = nnls(rows, np.array([0.0, 0.0, 0.0, 1e3]))
    return scale * float(np.linalg.norm(moved.T @ (shares / shares.sum())))


def _around(corners: FloatArray, equations: FloatArray, most: int) -> FloatArray:
    """Corners of a polytope with at most so many faces around the hull: supporting planes in spread directions."""
    directions = np.concatenate([np.eye(3), -np.eye(3)])
    candidates = np.unique(np.round(equations[:, :3], 9), axis=0)
    candidates /= np.linalg.norm(candidates, axis=1, keepdims=True)
    closest = (candidates @ directions.T).max(1)
    while len(directions) < most:
        chosen = int(np.argmin(closest))
        directions = np.concatenate([directions, candidates[chosen : chosen + 1]])
        closest = np.maximum(closest, candidates @ candidates[chosen])
    offsets = (corners @ directions.T).max(0)
    planes = np.concatenate([directions, -offsets[:, None]], axis=1)
    polytope: FloatArray = HalfspaceIntersection(planes, corners.mean(0)).intersections
    return polytope


def _box(points: FloatArray) -> FloatArray:
    ends = np.stack([points.min(0) - COVER_SLACK_M, points.max(0) + COVER_SLACK_M])
    return np.array([[x, y, z] for x in ends[:, 0] for y in ends[:, 1] for z in ends[:, 2]])
