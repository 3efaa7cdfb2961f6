"""Solids at many times, and when two of them collide: by the distances of the simulation (`benchmarks.soak.solids`)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.recheck.spline import Floats
from benchmarks.soak.poses import Poses
from benchmarks.soak.solids import Solid, apart_at_least, gaps


@dataclass(frozen=True, eq=False)
class Placed:
    """A solid by `name` with its centre (N, 3), m, and yaw (N,) at N times."""

    name: str
    solid: Solid
    centre: Floats
    yaw: Floats


def box(x: float, y: float, z: float) -> Solid:
    """A box by its edges, m."""
    return Solid(x / 2, y / 2, z / 2)


def upright_cylinder(radius: float, height: float) -> Solid:
    """A cylinder about the vertical, m."""
    return Solid(0.0, 0.0, height / 2, round_m=radius)


def lying_capsule(radius: float, length: float) -> Solid:
    """A capsule along its frame's x axis, `length` between the centres of its caps, m."""
    return Solid(length / 2, 0.0, 0.0, ball=radius)


def collisions(first: Placed, second: Placed) -> NDArray[np.intp]:
    """Indices (M,) of the times at which the two solids overlap. Raises `ValueError` for a pose that is not finite."""
    for placed in (first, second):
        if not (np.isfinite(placed.centre).all() and np.isfinite(placed.yaw).all()):
            raise ValueError(f"{placed.name}: a pose that is not finite")
    one, other = Poses(first.centre, first.yaw), Poses(second.centre, second.yaw)
    near = np.flatnonzero(~(apart_at_least(first.solid, one, second.solid, other) >= 0.0))
    return near[~(gaps(first.solid, one[near], second.solid, other[near], 0.0) >= 0.0)]
