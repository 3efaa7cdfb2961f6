"""Points of convex solids: the farthest along a direction, how deep a point is, and what a closed surface holds."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.geometry.shapes import Body, Hull, Piece, Primitive, corners

BLOCK = 100_000
"""Triangles that are looked at together."""


def farthest(piece: Piece, n: FloatArray) -> FloatArray:
    """The point of a piece that is farthest along n."""
    local, shape = piece.rotation.T @ n, piece.shape
    points = corners(shape)
    found = points[int(np.argmax(points @ local))].copy()
    if isinstance(shape, Primitive):
        flat, size = float(np.hypot(local[0], local[1])), float(np.linalg.norm(local))
        if shape.disc > 0.0 and flat > 0.0:
            found[:2] += shape.disc * local[:2] / flat
        if shape.ball > 0.0 and size > 0.0:
            found += shape.ball * local / size
    return np.asarray(piece.position + piece.rotation @ found)


def depth(piece: Piece, point: FloatArray) -> tuple[float, FloatArray]:
    """How deep a point is in a piece, and in which direction it gets deeper."""
    local, shape = piece.rotation.T @ (point - piece.position), piece.shape
    inward = np.zeros(3)
    if isinstance(shape, Hull):
        a, b, c = (shape.vertices[shape.faces[:, k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        area = np.linalg.norm(normal, axis=1)
        normal = normal[area > 0.0] / area[area > 0.0, None]
        slack = (shape.vertices @ normal.T).max(0) - normal @ local
        k = int(np.argmin(slack))
        deep, inward = float(slack[k]), -normal[k]
    elif shape.ball > 0.0:
        off = local - np.clip(local, -np.array(shape.half), np.array(shape.half))
        size = float(np.linalg.norm(off))
        deep, inward = shape.ball - size, -off / size if size > 0.0 else inward
    else:
        half = np.array(shape.half)
        flat = float(np.hypot(local[0], local[1]))
        slack = half - np.abs(local)
        if shape.disc > 0.0:
            slack[0] = slack[1] = shape.disc - flat
        k = int(np.argmin(slack))
        deep = float(slack[k])
        if shape.disc > 0.0 and k < 2:
            inward[:2] = -local[:2] / flat if flat > 0.0 else 0.0
        else:
            inward[k] = -np.sign(local[k])
    return deep, piece.rotation @ inward


def deepest(body: Body, point: FloatArray) -> float:
    """`depth` in the piece of a body in which the point is deepest."""
    return max(depth(piece, point)[0] for piece in body.pieces)


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
