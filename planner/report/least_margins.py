"""How near a motion comes to singular positions: looked for at instants, more closely around each of the nearest."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.assembly_mode import has_loop
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory

AROUND, ROUNDS = 32, 4
"""Parts of the surroundings of an instant that is near, and how often they are parted: 1 ms to less than 1 ns."""


def least_margins(robot: Robot, trajectory: Trajectory, t: FloatArray) -> tuple[float, float | None]:
    """Least singularity margin of a motion, and, of an arm with a loop, least parallel margin (None: it has none), from
    times t (T,) on, which are 1 ms apart as a rule: where the margin is smooth, or falls and rises again at one rate as
    it does where an arm passes through a singular position, it is then known to 1e-4. NaN where one is none."""
    parallel = _least(robot.parallel_margin, trajectory, t) if has_loop(robot) else None
    return _least(robot.margin, trajectory, t), parallel


def _least(margin: Callable[[FloatArray], FloatArray], trajectory: Trajectory, t: FloatArray) -> float:
    found = margin(trajectory.evaluate(t))
    if not np.isfinite(found).all():
        return float("nan")
    return min(_around(margin, trajectory, t, k) for k in _lows(found))


def _lows(found: FloatArray) -> list[int]:
    """Instants around which the least of all may be: none beside one of them has less, and the least is no farther
    below it than it changes from there to the instants beside."""
    steps = np.diff(found)
    falls = np.append(True, steps < 0.0) & np.append(steps >= 0.0, True)
    sizes = np.abs(steps)
    change = np.maximum(np.append(0.0, sizes), np.append(sizes, 0.0))
    return [int(k) for k in np.flatnonzero(falls & (found - change <= found.min()))]


def _around(margin: Callable[[FloatArray], FloatArray], trajectory: Trajectory, t: FloatArray, k: int) -> float:
    for _ in range(ROUNDS):
        t = np.linspace(t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)], AROUND + 1)
        found = margin(trajectory.evaluate(t))
        k = int(np.argmin(found))  # of what is no number, the first
    return float(found[k])
