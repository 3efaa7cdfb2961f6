"""How far a hull reaches out of the solid whose surface it covers: what decides whether it is cut further.

A judgement of quality, not of safety: the hull covers its triangles whatever is found here. The hull of the surface
inside a convex cell lies in that cell, so the triangles of the cell are all that a ray inside the hull can meet.
"""

from __future__ import annotations

import numpy as np

from planner.arrays import BoolArray, FloatArray
from planner.shapes import Hull

SPOTS = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4]]) / np.array([[3], [6], [6], [6]])
"""Where on a facet of the hull is looked, in barycentric coordinates."""
FACETS_OF_A_PLANE = 4
"""Facets of one flat side of the hull on which is looked, the largest first."""
RAYS = 1 << 18
"""Rays times triangles of one judgement: it bounds the time to some 10 ms."""
LEAST_SPOTS, MOST_SPOTS = 24, 256
"""Spots of one judgement."""
AIMS = 3
"""Rays from each spot: along the facet's inward normal, and at triangles elsewhere."""
FLAT_M2 = 1e-16
"""Twice the area below which a triangle meets no ray, m²."""


def excess(hull: Hull, triangles: FloatArray) -> float:
    """The largest distance, m, from a spot on the hull that is outside the solid to the surface that a ray meets.

    `triangles` (k, 3, 3): the surface in the hull's cell, outward.
    """
    solid = triangles[doubled_area(triangles) > FLAT_M2]
    if not len(solid):
        return 0.0
    most = int(np.clip(RAYS // (AIMS * len(solid)), LEAST_SPOTS, MOST_SPOTS))
    spots, inward = _spots(hull, most)
    centroids = solid.mean(1)
    outside = np.zeros(len(spots), dtype=bool)
    distance = np.full(len(spots), np.inf)
    for aim in range(AIMS):
        direction = inward
        if aim > 0:
            target = centroids[(np.arange(len(spots)) * 7919 + aim * 104729) % len(centroids)]
            way = target - spots
            length = np.linalg.norm(way, axis=1, keepdims=True)
            direction = np.where(length > 1e-12, way / np.maximum(length, 1e-12), inward)
        reach, from_outside = _first_hit(spots, direction, solid)
        outside |= from_outside
        distance = np.minimum(distance, reach)
    return float(distance[outside].max(initial=0.0))


def doubled_area(triangles: FloatArray) -> FloatArray:
    """Twice the area of triangles (k, 3, 3), (k,), m²."""
    edges = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area: FloatArray = np.sqrt((edges * edges).sum(1))
    return area


def _spots(hull: Hull, most: int) -> tuple[FloatArray, FloatArray]:
    """Spots (S, 3) on the hull, on its largest flat sides first, and inward normals (S, 3)."""
    corners = hull.vertices[hull.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.sqrt((normals * normals).sum(1))
    normals /= np.maximum(size, 1e-300)[:, None]
    _, plane = np.unique(np.round(normals, 6), axis=0, return_inverse=True)
    whole = np.bincount(plane, weights=size)[plane]
    order = np.lexsort((-size, plane, -whole))
    index = np.arange(len(order))
    begins = np.concatenate([[True], np.diff(plane[order]) != 0])
    place = index - np.maximum.accumulate(np.where(begins, index, 0))
    chosen = order[place < FACETS_OF_A_PLANE][: max(1, most // len(SPOTS))]
    spots = np.einsum("sk,fki->fsi", SPOTS, corners[chosen]).reshape(-1, 3)
    return spots, np.repeat(-normals[chosen], len(SPOTS), axis=0)


def _first_hit(origins: FloatArray, directions: FloatArray, triangles: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Distance (S,) to the first triangle that each ray meets (inf: none), and whether it is met from outside.

    With s = o − a and N = e1 × e2: t = −s·N / d·N, u = −e2·(s × d) / d·N, v = e1·(s × d) / d·N.
    """
    a = triangles[:, 0]
    e1, e2 = triangles[:, 1] - a, triangles[:, 2] - a
    normals = np.cross(e1, e2)
    slope = directions @ normals.T
    height = origins @ normals.T - (a * normals).sum(1)
    moved = np.cross(directions, origins)
    u = -_triple(e2, a, moved, directions)
    v = _triple(e1, a, moved, directions)
    with np.errstate(divide="ignore", invalid="ignore"):
        t, u, v = -height / slope, u / slope, v / slope
        met = (t >= -1e-12) & (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9)
    t = np.where(met, t, np.inf)
    first = np.argmin(t, axis=1)
    rows = np.arange(len(origins))
    nearest: FloatArray = np.maximum(t[rows, first], 0.0)
    return nearest, np.isfinite(nearest) & (slope[rows, first] < 0)


def _triple(edges: FloatArray, a: FloatArray, moved: FloatArray, directions: FloatArray) -> FloatArray:
    """e·((o − a) × d) for rays (S,) and triangles (K,): (S, K); `moved` is d × o."""
    product: FloatArray = -(moved @ edges.T) - directions @ np.cross(edges, a).T
    return product
