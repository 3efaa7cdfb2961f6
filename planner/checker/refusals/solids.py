"""How deep a point is in a convex solid, and whether it is inside a closed surface."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.geometry.shapes import Body, Hull, Piece, Primitive

BLOCK = 100_000
"""Triangles that are looked at together."""


def depth(piece: Piece, point: FloatArray) -> float:
    """How far, m, a point (3,) of the body's frame is from the surface of a piece that it is inside of; below 0: it is
    outside, by so much at least. A ball of this radius about the point is inside the piece."""
    local = piece.rotation.T @ (point - piece.position)
    return _of_hull(piece.shape, local) if isinstance(piece.shape, Hull) else _of_primitive(piece.shape, local)


def _of_primitive(shape: Primitive, local: FloatArray) -> float:
    half, x = np.array(shape.half), np.abs(local)
    if shape.ball > 0.0:  # a ball along a line
        return shape.ball - float(np.linalg.norm(local - np.clip(local, -half, half)))
    if shape.disc > 0.0:
        return min(shape.disc - float(np.hypot(x[0], x[1])), float(half[2] - x[2]))
    return float((half - x).min())


def _of_hull(hull: Hull, local: FloatArray) -> float:
    """By the planes of its faces; one that has no area is no plane."""
    a, b, c = (hull.vertices[hull.faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    flat = area > 0.0
    normal = normal[flat] / area[flat, None]
    # all vertices are behind the plane that counts, whatever a face says
    behind = (hull.vertices @ normal.T).max(0)
    return float((behind - normal @ local).min())


def deepest(body: Body, point: FloatArray) -> float:
    """`depth` in the piece of a body in which the point is deepest."""
    return max(depth(piece, point) for piece in body.pieces)


def is_within(surface: tuple[FloatArray, IntArray], point: FloatArray, by: float) -> bool:
    """Whether a point is inside a closed surface, and no triangle of it is nearer than `by`, m: the solid angles at
    which all triangles are seen sum up to 4π."""
    vertices, faces = surface
    total = 0.0
    for first in range(0, len(faces), BLOCK):
        a, b, c = (vertices[faces[first : first + BLOCK, k]] - point for k in range(3))
        low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
        if not (np.linalg.norm(np.maximum(np.maximum(low, -high), 0.0), axis=1) > by).all() and not _far(a, b, c, by):
            return False
        la, lb, lc = (np.linalg.norm(each, axis=1) for each in (a, b, c))
        volume = (a * np.cross(b, c)).sum(1)
        rest = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
        total += float(np.arctan2(volume, rest).sum()) / (2.0 * np.pi)
    return total > 0.5


def _far(a: FloatArray, b: FloatArray, c: FloatArray, by: float) -> bool:
    """Whether the origin is farther than `by` from every triangle: it is off the triangle's plane, or beyond one of the
    planes through an edge of it and along its normal."""
    normal = np.cross(b - a, c - a)
    size = np.linalg.norm(normal, axis=1)
    flat = size > 0.0
    off = np.zeros(len(a))
    off[flat] = np.abs((normal[flat] * a[flat]).sum(1)) / size[flat]
    for one, other in ((a, b), (b, c), (c, a)):
        out = np.cross(other - one, normal)
        length = np.linalg.norm(out, axis=1)
        use = length > 0.0
        off[use] = np.maximum(off[use], -(out[use] * one[use]).sum(1) / length[use])
    return bool((off > by).all())
