"""How far a hull reaches out of the solid whose surface it covers: what decides whether it is cut further.

A judgement of quality, not of safety: the hull covers its triangles whatever is found here. Every part of a hull that
is outside the solid is looked at by a triangle of its own cell (else the whole hull were outside), so rays leave from
the triangles, along their outward normals, until they meet the surface again or leave the hull.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.geometry.shapes import Hull

SPOTS = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4]]) / np.array([[3], [6], [6], [6]])
"""Where on a triangle a ray leaves, in barycentric coordinates."""
RAYS = 1 << 17
"""Rays times triangles of one judgement: it bounds the time to some 10 ms."""
LEAST_TRIANGLES, MOST_TRIANGLES = 16, 96
"""Triangles from which rays leave: half of them the largest, half spread over the rest."""
FLAT_M2 = 1e-16
"""Twice the area below which a triangle neither sends nor meets a ray, m²."""
LEAVING_M = 1e-7
"""A ray that meets a triangle sooner than this is still leaving, m: its own, or the next one."""


def excess(hull: Hull, triangles: FloatArray) -> float:
    """The longest ray, m, from a triangle outwards through the hull.

    `triangles` (k, 3, 3): the surface in the hull's cell, outward.
    """
    size = doubled_area(triangles)
    solid = triangles[size > FLAT_M2]
    if not len(solid):
        return 0.0
    most = int(np.clip(RAYS // (len(SPOTS) * len(solid)), LEAST_TRIANGLES, MOST_TRIANGLES))
    order = np.argsort(-doubled_area(solid), kind="stable")
    if len(order) > most:
        rest = order[most // 2 :]
        order = np.concatenate([order[: most // 2], rest[np.linspace(0, len(rest) - 1, most // 2).astype(int)]])
    chosen = solid[order]
    normals = np.cross(chosen[:, 1] - chosen[:, 0], chosen[:, 2] - chosen[:, 0])
    normals /= np.sqrt((normals * normals).sum(1))[:, None]
    spots = np.einsum("sk,fki->fsi", SPOTS, chosen).reshape(-1, 3)
    directions = np.repeat(normals, len(SPOTS), axis=0)
    return float(np.minimum(_leave(spots, directions, hull), _meet(spots, directions, solid)).max())


def doubled_area(triangles: FloatArray) -> FloatArray:
    """Twice the area of triangles (k, 3, 3), (k,), m²."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area: FloatArray = np.sqrt((normals * normals).sum(1))
    return area


def _leave(origins: FloatArray, directions: FloatArray, hull: Hull) -> FloatArray:
    """Distance (S,) at which rays from inside a hull leave it."""
    corners = hull.vertices[hull.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    room = np.maximum((corners[:, 0] * normals).sum(1) - origins @ normals.T, 0.0)
    slope = directions @ normals.T
    with np.errstate(divide="ignore", invalid="ignore"):
        distance: FloatArray = np.where(slope > 0, room / slope, np.inf).min(1)
    return distance


def _meet(origins: FloatArray, directions: FloatArray, triangles: FloatArray) -> FloatArray:
    """Distance (S,) to the first triangle that each ray meets (inf: none).

    With s = o − a and N = e1 × e2: t = −s·N / d·N, u = −e2·(s × d) / d·N, v = e1·(s × d) / d·N.
    """
    a = triangles[:, 0]
    e1, e2 = triangles[:, 1] - a, triangles[:, 2] - a
    normals = np.cross(e1, e2)
    slope = directions @ normals.T
    height = origins @ normals.T - (a * normals).sum(1)
    moved = np.cross(directions, origins)
    with np.errstate(divide="ignore", invalid="ignore"):
        t = -height / slope
        u = -_triple(e2, a, moved, directions) / slope
        v = _triple(e1, a, moved, directions) / slope
        met = (t > LEAVING_M) & (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9)
    distance: FloatArray = np.where(met, t, np.inf).min(1)
    return distance


def _triple(edges: FloatArray, a: FloatArray, moved: FloatArray, directions: FloatArray) -> FloatArray:
    """e·((o − a) × d) for rays (S,) and triangles (K,): (S, K); `moved` is d × o."""
    product: FloatArray = -(moved @ edges.T) - directions @ np.cross(edges, a).T
    return product
