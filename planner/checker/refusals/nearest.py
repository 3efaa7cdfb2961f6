"""A point of each of two convex solids, by which it is plain how near they are."""

from __future__ import annotations

import math
from collections.abc import Sequence
from operator import itemgetter

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.solids import depth, farthest
from assur.planner.geometry.shapes import Hull, Piece, corners

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
