"""The obstacles of a problem, where they are at a time, and when two solids collide: by the shapes and distances of the
simulation (`benchmarks.soak.solids`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.problem_set import Problem
from benchmarks.recheck.spline import Floats
from benchmarks.soak.poses import Poses
from benchmarks.soak.solids import Solid, apart_at_least, gaps, solid_of

SIZES = {"box": ("size",), "cylinder": ("radius", "height"), "capsule": ("radius", "length")}
"""Kinds of obstacles, and what they have, m. A cylinder is upright, a capsule lies along its frame's x axis."""


@dataclass(frozen=True, eq=False)
class PlacedBody:
    """A solid by `name` with its centre (N, 3), m, and yaw (N,) at N times."""

    name: str
    solid: Solid
    centre: Floats
    yaw: Floats


def placed_obstacles(problem: Problem, t: Floats) -> tuple[PlacedBody, ...]:
    """Every obstacle at times `t` (N,). Raises `ValueError` for a kind that the problems do not have."""
    return tuple(_placed(f"obstacle {i}", obstacle, t) for i, obstacle in enumerate(problem["obstacles"]))


def goal_at(problem: Problem, t: float) -> tuple[Floats, float, Floats]:
    """Position (3,), yaw and velocity (3,) of the goal at time `t`; it turns with nothing."""
    goal = problem["goal"]
    velocity = np.array([*goal.get("v", [0.0, 0.0]), 0.0])
    return np.array(goal["pos"], dtype=np.float64) + velocity * t, float(goal["yaw"]), velocity


def _solid(name: str, obstacle: dict[str, Any]) -> Solid:
    kind = obstacle["type"]
    if kind not in SIZES:
        raise ValueError(f"{name}: unknown type {kind!r}")
    sizes = {f"{key}_m": obstacle[key] for key in SIZES[kind]}
    return solid_of({kind: {**sizes, "axis": "x" if kind == "capsule" else "z"}})


def _placed(name: str, obstacle: dict[str, Any], t: Floats) -> PlacedBody:
    solid = _solid(name, obstacle)
    motion = obstacle.get("motion", {"kind": "linear", "v": [0.0, 0.0, 0.0]})
    if motion["kind"] == "linear":
        centre = np.array(obstacle["pos"]) + np.array(motion["v"]) * t[:, None]
        return PlacedBody(name, solid, centre, np.full(len(t), float(obstacle["yaw"])))
    if motion["kind"] == "swing":
        angle = motion["phase"] + motion["omega"] * t
        outwards = np.stack([np.cos(angle), np.sin(angle), np.zeros(len(t))], axis=-1)
        return PlacedBody(name, solid, np.array(motion["pivot"]) + obstacle["length"] / 2 * outwards, angle)
    raise ValueError(f"{name}: unknown motion {motion['kind']!r}")


def collisions(first: PlacedBody, second: PlacedBody) -> NDArray[np.intp]:
    """Indices (M,) of the times at which the two solids overlap. Raises `ValueError` for a pose that is not finite."""
    for placed in (first, second):
        if not (np.isfinite(placed.centre).all() and np.isfinite(placed.yaw).all()):
            raise ValueError(f"{placed.name}: a pose that is not finite")
    one, other = Poses(first.centre, first.yaw), Poses(second.centre, second.yaw)
    near = np.flatnonzero(~(apart_at_least(first.solid, one, second.solid, other) >= 0.0))
    return near[~(gaps(first.solid, one[near], second.solid, other[near], 0.0) >= 0.0)]
