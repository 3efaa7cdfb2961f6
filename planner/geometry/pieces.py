"""All convex pieces of a cell's bodies as flat arrays: the raw shapes, read once, for whoever computes with many."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.geometry.shapes import Body, Hull, Primitive


@dataclass(frozen=True, eq=False)
class Pieces:
    """Pieces (S,) of bodies (B,), those of body b being `first[b]` and the `count[b] - 1` behind it.

    `position` (S, 3) m and `rotation` (S, 3, 3) in the body's axes; `half` (S, 3), `disc`, `ball` (S,) the terms of
    their support function (S1), zero for a hull, which is number `hull` (S,) of `hulls`; -1: a primitive.
    """

    first: IntArray
    count: IntArray
    position: FloatArray
    rotation: FloatArray
    half: FloatArray
    disc: FloatArray
    ball: FloatArray
    hull: IntArray
    shapes: tuple[Primitive | Hull, ...]
    hulls: tuple[Hull, ...]


NO_CORE = (0.0, 0.0, 0.0, 0.0, 0.0)
NO_POINTS, NO_AXES = np.zeros(0), np.zeros((0, 3))
"""What stands in front, so that there may be no body."""


def pieces(bodies: Sequence[Body]) -> Pieces:
    """The table of some bodies, in order; its arrays are read-only."""
    every = [piece for body in bodies for piece in body.pieces]
    shapes = tuple(piece.shape for piece in every)
    count = np.array([len(body.pieces) for body in bodies], dtype=np.int64)
    hulls = tuple(shape for shape in shapes if isinstance(shape, Hull))
    core = np.array([NO_CORE if isinstance(s, Hull) else (*s.half, s.disc, s.ball) for s in shapes]).reshape(-1, 5)
    hull = np.full(len(shapes), -1)
    if hulls:
        hull[[isinstance(shape, Hull) for shape in shapes]] = np.arange(len(hulls))
    found = Pieces(
        first=np.cumsum(count) - count,
        count=count,
        position=np.concatenate([NO_POINTS, *(piece.position for piece in every)]).reshape(-1, 3),
        rotation=np.concatenate([NO_AXES, *(piece.rotation for piece in every)]).reshape(-1, 3, 3),
        half=core[:, :3].copy(),
        disc=core[:, 3].copy(),
        ball=core[:, 4].copy(),
        hull=hull,
        shapes=shapes,
        hulls=hulls,
    )
    for array in vars(found).values():
        if isinstance(array, np.ndarray):
            array.flags.writeable = False
    return found
