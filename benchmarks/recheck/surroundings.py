"""The obstacles of a problem and where they are at a time."""

from __future__ import annotations

from typing import Any

import numpy as np

from benchmarks.problem_set import Problem
from benchmarks.recheck.solids import Placed, box, lying_capsule, upright_cylinder
from benchmarks.recheck.spline import Floats
from benchmarks.soak.solids import Solid


def placed_obstacles(problem: Problem, t: Floats) -> tuple[Placed, ...]:
    """Every obstacle at times `t` (N,). Raises `ValueError` for a kind that the problems do not have."""
    return tuple(_placed(f"obstacle {i}", obstacle, t) for i, obstacle in enumerate(problem["obstacles"]))


def goal_at(problem: Problem, t: float) -> tuple[Floats, float, Floats]:
    """Position (3,), yaw and velocity (3,) of the goal at time `t`; it turns with nothing."""
    goal = problem["goal"]
    velocity = np.array([*goal.get("v", [0.0, 0.0]), 0.0])
    return np.array(goal["pos"], dtype=np.float64) + velocity * t, float(goal["yaw"]), velocity


def _solid(name: str, obstacle: dict[str, Any]) -> Solid:
    kind = obstacle["type"]
    if kind == "box":
        return box(*obstacle["size"])
    if kind == "cylinder":
        return upright_cylinder(obstacle["radius"], obstacle["height"])
    if kind == "capsule":
        return lying_capsule(obstacle["radius"], obstacle["length"])
    raise ValueError(f"{name}: unknown type {kind!r}")


def _placed(name: str, obstacle: dict[str, Any], t: Floats) -> Placed:
    solid = _solid(name, obstacle)
    motion = obstacle.get("motion", {"kind": "linear", "v": [0.0, 0.0, 0.0]})
    if motion["kind"] == "linear":
        centre = np.array(obstacle["pos"]) + np.array(motion["v"]) * t[:, None]
        return Placed(name, solid, centre, np.full(len(t), float(obstacle["yaw"])))
    if motion["kind"] == "swing":
        angle = motion["phase"] + motion["omega"] * t
        outwards = np.stack([np.cos(angle), np.sin(angle), np.zeros(len(t))], axis=-1)
        return Placed(name, solid, np.array(motion["pivot"]) + obstacle["length"] / 2 * outwards, angle)
    raise ValueError(f"{name}: unknown motion {motion['kind']!r}")
