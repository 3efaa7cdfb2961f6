"""Solids as `fcl` knows them, each with a plain outline from above that decides which pairs `fcl` need not see.

The outline is a rectangle grown by a radius, and a range of heights; it holds the whole solid.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import fcl
import numpy as np
from numpy.typing import NDArray

from benchmarks.recheck.spline import Floats

OUTLINE_SLACK_M = 1e-6
"""Outlines count as touching from this far apart: far above rounding, far below what would cost time."""

UPRIGHT = np.eye(3)
LYING = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
"""Turns the z axis, along which fcl lays a capsule, into the x axis."""


@dataclass(frozen=True, eq=False)
class Solid:
    """`geometry` of fcl, laid into a frame by `attitude` (3, 3); its outline: rectangle `half_x`, `half_y`, grown by
    `round_m`, and `half_z` up and down. Metres."""

    name: str
    geometry: Any
    attitude: Floats
    half_x: float
    half_y: float
    half_z: float
    round_m: float


@dataclass(frozen=True, eq=False)
class Placed:
    """A solid with its centre (N, 3) and yaw (N,) at N times."""

    solid: Solid
    centre: Floats
    yaw: Floats


def box(name: str, x: float, y: float, z: float) -> Solid:
    """A box by its edges, m."""
    return Solid(name, fcl.Box(x, y, z), UPRIGHT, x / 2, y / 2, z / 2, 0.0)


def upright_cylinder(name: str, radius: float, height: float) -> Solid:
    """A cylinder about the vertical, m."""
    return Solid(name, fcl.Cylinder(radius, height), UPRIGHT, 0.0, 0.0, height / 2, radius)


def lying_capsule(name: str, radius: float, length: float) -> Solid:
    """A capsule along its frame's x axis, `length` between the centres of its caps, m."""
    return Solid(name, fcl.Capsule(radius, length), LYING, length / 2, 0.0, radius, radius)


def outlines_meet(first: Placed, second: Placed) -> NDArray[np.intp]:
    """Indices (M,) of the times at which the outlines overlap; at all others the solids are apart, for sure.

    The second outline is widened to the circle about its centre, so only its distance from the first rectangle
    counts.
    """
    a, b = first.solid, second.solid
    reach = a.round_m + b.round_m + float(np.hypot(b.half_x, b.half_y)) + OUTLINE_SLACK_M
    delta = second.centre - first.centre
    c, s = np.cos(first.yaw), np.sin(first.yaw)
    along = np.abs(c * delta[:, 0] + s * delta[:, 1]) - a.half_x
    across = np.abs(c * delta[:, 1] - s * delta[:, 0]) - a.half_y
    apart = np.hypot(np.maximum(along, 0.0), np.maximum(across, 0.0)) > reach
    apart |= np.abs(delta[:, 2]) > a.half_z + b.half_z + OUTLINE_SLACK_M
    return np.flatnonzero(~apart)


def collisions(first: Placed, second: Placed) -> Iterator[int]:
    """Indices of the times at which the two solids collide, by `fcl.collide` on their true shapes."""
    for placed in (first, second):
        if not (np.isfinite(placed.centre).all() and np.isfinite(placed.yaw).all()):
            raise ValueError(f"{placed.solid.name}: a pose that is not finite, which fcl would call free")
    a, b = fcl.CollisionObject(first.solid.geometry), fcl.CollisionObject(second.solid.geometry)
    request = fcl.CollisionRequest()
    for i in outlines_meet(first, second):
        a.setTransform(_transform(first, int(i)))
        b.setTransform(_transform(second, int(i)))
        if fcl.collide(a, b, request, fcl.CollisionResult()):  # a used result would stay "colliding"
            yield int(i)


def _transform(placed: Placed, i: int) -> Any:
    c, s = np.cos(placed.yaw[i]), np.sin(placed.yaw[i])
    turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return fcl.Transform(turned @ placed.solid.attitude, placed.centre[i])
