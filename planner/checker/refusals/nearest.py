"""A point of each of two convex solids, by which it is plain how near they are."""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import itemgetter

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.geometry.shapes import Body, Hull, Piece, Primitive, corners

# Points of convex solids: the farthest along a direction, how deep a point is, and what a closed surface holds.

BLOCK = 100_000
"""Triangles that are evaluated together."""


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


ROUNDS, STEPS = 64, 200
"""How often the nearest points are improved, and how often a common point is moved to where it is deeper."""
SMALLER = 0.95
"""Each of these moves is so many times as long as the one before."""
NEAR_M = 1e-12
"""Points nearer than this are one, m: rounding."""


def points_between(first: Piece, second: Piece) -> tuple[FloatArray, FloatArray]:
    """A point (3,) of each piece, in the frame of both: the nearest ones of pieces that are apart; of pieces that
    overlap the same point of both, about as deep as there is one."""
    x, y = _nearest(first, second)
    if np.linalg.norm(x - y) > NEAR_M:
        return x, y
    middle = _deeper(first, second, (x + y) / 2.0)
    return middle, middle


def distance(ones: Sequence[Piece], others: Sequence[Piece]) -> tuple[float, float]:
    """A lower and an upper value, m, of the distance of two bodies, from their pieces in one frame; 0 where they
    meet."""
    low, high = math.inf, math.inf
    balls = [[(*_ball(piece), piece) for piece in pieces] for pieces in (ones, others)]
    apart = ((float(np.linalg.norm(p - q)) - r - s, a, b) for p, r, a in balls[0] for q, s, b in balls[1])
    for least, one, other in sorted(apart, key=itemgetter(0)):
        if least >= high:
            break
        x, y = _nearest(one, other)
        way, far = y - x, float(np.linalg.norm(y - x))
        high = min(high, far)
        # all of one is behind a plane across the way, and all of the other before another one
        between = float(way @ (farthest(other, -way) - farthest(one, way))) / far if far > NEAR_M else 0.0
        low = min(low, max(between, 0.0))
    return min(low, high), high


def _ball(piece: Piece) -> tuple[FloatArray, float]:
    """Centre (3,) and radius, m, of a ball that holds a piece."""
    points, shape = corners(piece.shape), piece.shape
    middle = (points.min(0) + points.max(0)) / 2.0
    more = 0.0 if isinstance(shape, Hull) else shape.disc + shape.ball
    radius = float(np.linalg.norm(points - middle, axis=1).max()) + more
    return np.asarray(piece.position + piece.rotation @ middle), radius


def _nearest(first: Piece, second: Piece) -> tuple[FloatArray, FloatArray]:
    """The nearest points of two pieces, by Wolfe's way to the point of least norm of their difference."""
    xs, ys = [farthest(first, np.array([1.0, 0.0, 0.0]))], [farthest(second, np.array([-1.0, 0.0, 0.0]))]
    weights = np.ones(1)
    for _ in range(ROUNDS):
        way = weights @ (np.array(ys) - np.array(xs))
        size = float(np.linalg.norm(way))
        if size <= NEAR_M:
            break
        x, y = farthest(first, way), farthest(second, -way)
        if way @ (y - x) >= size * size - 1e-14 - 1e-12 * size * size:
            break
        xs, ys = [*xs, x], [*ys, y]
        xs, ys, weights = _least(xs, ys, np.append(weights, 0.0))
    return weights @ np.array(xs), weights @ np.array(ys)


def _least(
    xs: list[FloatArray], ys: list[FloatArray], weights: FloatArray
) -> tuple[list[FloatArray], list[FloatArray], FloatArray]:
    """The corners, and their weights, of the convex sum of differences y - x that has the least norm."""
    while True:
        points = np.array(ys) - np.array(xs)
        many = len(points)
        system = np.ones((many + 1, many + 1))
        system[:many, :many], system[many, many] = points @ points.T, 0.0
        affine = np.linalg.lstsq(system, np.append(np.zeros(many), 1.0), rcond=None)[0][:many]
        if (affine > 1e-15).all():
            return xs, ys, affine / affine.sum()
        falls = affine < weights
        shares = [w / (w - a) if f and a <= 1e-15 else 1.0 for w, a, f in zip(weights, affine, falls, strict=True)]
        share = min(shares)
        weights = weights + share * (affine - weights)
        drop = int(np.argmin(np.where(affine <= 1e-15, weights, np.inf)))
        if many == 1:
            return xs, ys, np.ones(1)
        xs, ys = [p for k, p in enumerate(xs) if k != drop], [p for k, p in enumerate(ys) if k != drop]
        weights = np.delete(weights, drop)
        weights = np.maximum(weights, 0.0)
        weights = weights / weights.sum() if weights.sum() > 0.0 else np.full(len(weights), 1.0 / len(weights))


def _deeper(first: Piece, second: Piece, point: FloatArray) -> FloatArray:
    """A point of two pieces that overlap where the lesser of both depths is about the largest: it goes into the piece
    in which it is less deep, by less and less."""
    step, found = 0.25 * min(_extent(first), _extent(second)), list[tuple[float, FloatArray]]()
    for _ in range(STEPS):
        deep, inward = min((depth(piece, point) for piece in (first, second)), key=itemgetter(0))
        found.append((deep, point))
        point, step = point + step * inward, SMALLER * step
    return max(found, key=itemgetter(0))[1]


def _extent(piece: Piece) -> float:
    spread = np.ptp(corners(piece.shape), axis=0)
    shape = piece.shape
    more = 0.0 if isinstance(shape, Hull) else 2.0 * (shape.disc + shape.ball)
    return float(spread.max()) + more
