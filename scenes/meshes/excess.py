"""How far a hull reaches out of the solid whose surface it covers: what decides whether it is cut further.

A judgement of quality, not of safety: the hull covers its triangles whatever the result is. Every part of a hull that
is outside the solid can be seen from a triangle of its own cell (else the whole hull were outside). So rays leave from
the triangles, along their outward normals, until they meet the surface again or leave the hull. Cells are cut across
the axes, and from a thin slab a slanted ray soon leaves through the cut; so rays leave along the axes, too, and what
counts of them is how far they come along the normal.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray

SPOTS = np.array([[1, 1, 1], [4, 1, 1], [1, 4, 1], [1, 1, 4]]) / np.array([[3], [6], [6], [6]])
"""Where on a triangle a ray leaves, in barycentric coordinates."""
PAIRS = 1 << 16
"""Rays times triangles of one judgement: it bounds the time to some ms."""
LEAST_TRIANGLES, MOST_TRIANGLES = 48, 96
"""Triangles from which rays leave: half of them the largest, half spread over the rest."""
LEAST_SLOPE, MOST_SLOPE = 0.1, 0.99
"""A ray leaves along an axis where the cosine between it and the normal is between these."""
MOST_MET = 2_000
"""In cells with more triangles than this, which are cut anyway, rays meet none."""
FLAT_M2 = 1e-16
"""Twice the area below which a triangle neither sends nor meets a ray, m²."""
LEAVING_M = 1e-7
"""A ray that meets a triangle sooner than this is still leaving, m: its own, or the next one."""


@dataclass(frozen=True, slots=True)
class Rays:
    """Rays from `origins` (s, 3), m, along the unit vectors `directions` (s, 3); `shares` (s,) of their length count.
    `met` (s,): what counts of them until they meet a triangle, m; inf if they meet none, or if it was not computed."""

    origins: FloatArray
    directions: FloatArray
    shares: FloatArray
    met: FloatArray

    def of(self, chosen: BoolArray) -> Rays:
        """Some of the rays."""
        return Rays(self.origins[chosen], self.directions[chosen], self.shares[chosen], self.met[chosen])

    def leave(self, planes: FloatArray) -> FloatArray:
        """What counts (s,), m, of rays until they leave a hull with planes (f, 4), n·x + d <= 0 inside, or meet what
        they are known to meet; 0 for one from outside."""
        room = np.maximum(-(self.origins @ planes[:, :3].T + planes[:, 3]), 0.0)
        slope = self.directions @ planes[:, :3].T
        with np.errstate(divide="ignore", invalid="ignore"):
            distance: FloatArray = np.where(slope > 0, room / slope, np.inf).min(1) * self.shares
        return np.minimum(distance, self.met)


def rays_of(triangles: FloatArray) -> Rays | None:
    """Rays from a cell's triangles (k, 3, 3) outwards; None where all of them are flat."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    size = np.sqrt((normals * normals).sum(1))
    solid = np.flatnonzero(size > FLAT_M2)
    if not len(solid):
        return None
    most = int(np.clip(PAIRS // (len(SPOTS) * len(solid)), LEAST_TRIANGLES, MOST_TRIANGLES))
    order = solid[np.argsort(-size[solid], kind="stable")]
    if len(order) > most:
        rest = order[most // 2 :]
        order = np.concatenate([order[: most // 2], rest[np.linspace(0, len(rest) - 1, most // 2).astype(int)]])
    spots = np.einsum("sk,fki->fsi", SPOTS, triangles[order])
    units = normals[order] / size[order, None]
    which, axis = np.nonzero((np.abs(units) > LEAST_SLOPE) & (np.abs(units) < MOST_SLOPE))
    along = np.sign(units[which, axis])[:, None] * np.eye(3)[axis]
    return Rays(
        np.concatenate([spots.reshape(-1, 3), spots[which, 0]]),
        np.concatenate([np.repeat(units, len(SPOTS), axis=0), along]),
        np.concatenate([np.ones(len(units) * len(SPOTS)), np.abs(units[which, axis])]),
        np.full(len(units) * len(SPOTS) + len(which), np.inf),
    )


def excess(planes: FloatArray, rays: Rays | None, triangles: FloatArray, tight: float) -> tuple[float, Rays | None]:
    """What counts of the longest ray, m, from a triangle outwards through the hull with these planes (f, 4); where it
    is at most `tight`, a bound of it that is at most `tight`, too. And the rays, which know now what they meet.

    `triangles` (k, 3, 3): the surface in the hull's cell, outward; `rays` from them.
    """
    if rays is None:
        return 0.0, None
    length = rays.leave(planes)
    far = length > tight
    if far.any() and len(triangles) <= MOST_MET:
        met = np.full(len(length), np.inf)
        met[far] = _meet(rays.of(far), triangles[doubled_area(triangles) > FLAT_M2])
        rays = replace(rays, met=met)
        length = np.minimum(length, met)
    return float(length.max()), rays


def doubled_area(triangles: FloatArray) -> FloatArray:
    """Twice the area of triangles (k, 3, 3), (k,), m²."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area: FloatArray = np.sqrt((normals * normals).sum(1))
    return area


def _meet(rays: Rays, triangles: FloatArray) -> FloatArray:
    """What counts (s,), m, of rays until they meet a triangle (inf: none).

    With s = o − a and N = e1 × e2: t = −s·N / d·N, u = −e2·(s × d) / d·N, v = e1·(s × d) / d·N.
    """
    origins, directions = rays.origins, rays.directions
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
    distance: FloatArray = np.where(met, t, np.inf).min(1) * rays.shares
    return distance


def _triple(edges: FloatArray, a: FloatArray, moved: FloatArray, directions: FloatArray) -> FloatArray:
    """e·((o − a) × d) for rays (S,) and triangles (K,): (S, K); `moved` is d × o."""
    product: FloatArray = -(moved @ edges.T) - directions @ np.cross(edges, a).T
    return product
