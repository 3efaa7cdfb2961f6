"""The one entry to FCL: do two units touch at one time? A boolean, about true shapes, with a fresh result each time.

What is not used, and why (all reproduced with python-fcl 0.7.0.11): `distance` over-estimates for aligned primitives,
up to tenfold; `continuousCollide` misses most meshes; signed distance aborts the process; planes crash it; a reused
result stays true; managers swallow exceptions. A NaN pose, a negative size or a scaled rotation is silently "free", so
poses are checked here and sizes where shapes are made. FCL decides refusals only: nothing is called free on its word.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import fcl
import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.geometry.shapes import Hull, Primitive

UNIT_AXES = 1e-9
"""Rotations further from orthonormal than this are a fault: FCL would answer "free" to a scaled one."""


_IDENTITY = np.eye(3)


@dataclass(frozen=True, eq=False)
class PlacedShape:
    """A shape at `position` (3,), m, in the world, with its axes as the columns of `axes` (3, 3); `name` for faults."""

    name: str
    shape: Primitive | Hull
    position: FloatArray
    axes: FloatArray


def _geometry(shape: Primitive | Hull) -> fcl.CollisionGeometry:
    if isinstance(shape, Hull):
        faces = np.concatenate([np.full((len(shape.faces), 1), 3, dtype=np.int64), shape.faces], axis=1).ravel()
        return fcl.Convex(np.array(shape.vertices), len(shape.faces), faces)
    x, y, z = shape.half
    if shape.kind == "box":
        return fcl.Box(2 * x, 2 * y, 2 * z)
    if shape.kind == "sphere":
        return fcl.Sphere(shape.ball)
    if shape.kind == "cylinder":
        return fcl.Cylinder(shape.disc, 2 * z)
    if shape.kind == "capsule":
        return fcl.Capsule(shape.ball, 2 * z)
    raise FaultError(f"no FCL geometry for a {shape.kind}")


class Collider:
    """FCL objects for units, made once per shape and side, so that memory does not grow with queries."""

    def __init__(self) -> None:
        self._objects: dict[tuple[int, str], tuple[Primitive | Hull, fcl.CollisionObject]] = {}
        self._request = fcl.CollisionRequest()

    def touch(self, a: PlacedShape, b: PlacedShape) -> bool:
        """Whether two shapes have a point in common. Raises `FaultError` on what is no pose."""
        one, other = self._set(a, "a"), self._set(b, "b")
        return bool(fcl.collide(one, other, self._request, fcl.CollisionResult()) > 0)

    def _set(self, posed: PlacedShape, side: str) -> fcl.CollisionObject:
        key, axes, centre = (id(posed.shape), side), posed.axes, posed.position
        if key not in self._objects:
            # the shape is kept beside its object: an id is unique only while its owner lives
            self._objects[key] = (posed.shape, fcl.CollisionObject(_geometry(posed.shape), fcl.Transform()))
        found, off = self._objects[key][1], np.abs(axes.T @ axes - _IDENTITY)
        if not (math.isfinite(centre @ centre) and np.maximum.reduce(off, axis=None) <= UNIT_AXES):
            raise FaultError(f"pose of {posed.name} is not a pose")
        found.setTransform(fcl.Transform(np.ascontiguousarray(axes), np.ascontiguousarray(centre)))
        return found
