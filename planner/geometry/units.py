"""What stands for a body in computations: its only piece, or all of its pieces and the bounding box of them all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.geometry.pieces import Pieces, pieces
from assur.planner.geometry.shapes import Body, Hull, Piece, Primitive, box

COVER = -1
"""Piece number of the bounding box of a whole body."""
GROWN_M = 2e-9
"""By so much a bounding box is longer than what it holds, m: a nanometre at each end, far above rounding."""


def bounding_box(body: Body) -> Piece:
    """The box in the body's own axes that holds all of its pieces, a nanometre larger than they are."""
    low, high = _boxes(pieces([body]))
    return _box(low[0], high[0])


def _box(low: FloatArray, high: FloatArray) -> Piece:
    x, y, z = (high - low + GROWN_M).tolist()
    return Piece(box(x, y, z), (high + low) / 2)


def _boxes(table: Pieces) -> tuple[FloatArray, FloatArray]:
    """Lowest and highest coordinates (B, 3), m, of the bodies of a table in their own axes (S1)."""
    across = np.hypot(table.rotation[..., 0], table.rotation[..., 1])
    size = (np.abs(table.rotation) @ table.half[..., None])[..., 0] + table.disc[:, None] * across + table.ball[:, None]
    low, high = table.position - size, table.position + size
    for k in np.flatnonzero(table.hull >= 0):
        points = table.position[k] + table.hulls[table.hull[k]].vertices @ table.rotation[k].T
        low[k], high[k] = points.min(0), points.max(0)
    return np.minimum.reduceat(low, table.first), np.maximum.reduceat(high, table.first)


@dataclass(frozen=True, eq=False)
class Units:
    """The units (U,) of all bodies (B,) of a scene, in the bodies' axes: `first[b]` and the `count[b] - 1` behind it.

    A body is its only piece, if that is a primitive; else its bounding box, and all of its pieces behind that.
    """

    first: IntArray
    count: IntArray
    piece: IntArray
    position: FloatArray
    rotation: FloatArray
    half: FloatArray
    disc: FloatArray
    ball: FloatArray
    shapes: tuple[Primitive | Hull, ...]


def units(table: Pieces) -> Units:
    """The units of all bodies of a table."""
    boxed = ((table.count > 1) | (table.hull[table.first] >= 0)).astype(np.int64)
    count = table.count + boxed
    first = np.cumsum(count) - count
    body = np.repeat(np.arange(len(count)), count)
    piece = np.arange(len(body)) - first[body] - boxed[body]
    of = table.first[body] + np.maximum(piece, 0)
    position, rotation, half = table.position[of], table.rotation[of], table.half[of]
    disc, ball, shapes = table.disc[of], table.ball[of], [table.shapes[k] for k in of]
    if boxed.any():
        low, high = _boxes(table)
        for b in np.flatnonzero(boxed):
            k, cover = first[b], _box(low[b], high[b])
            shapes[k], position[k], rotation[k] = cover.shape, cover.position, cover.rotation
            half[k], disc[k], ball[k] = (high[b] - low[b] + GROWN_M) / 2, 0.0, 0.0
    return Units(first, count, piece, position, rotation, half, disc, ball, tuple(shapes))
