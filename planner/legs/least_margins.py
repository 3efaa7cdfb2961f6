"""How near a motion comes to singular positions: looked for at instants, more closely around each of the nearest."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.assembly_mode import has_loop
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory

AROUND, ROUNDS = 32, 4
"""Parts of the surroundings of an instant that is near, and how often they are parted: 1 ms to less than 1 ns."""
FINE_S = 0.001
"""Apart as a rule, s, are the instants at which all of a motion is evaluated."""
MOST_FINE = 100_000
"""So many of these times at most: where the arm moves for longer they are further apart. Where it rests there are none
beyond so many."""
Least = tuple[float, float]
"""A least margin, and when, s."""


def least_margins(robot: Robot, trajectory: Trajectory, t: FloatArray) -> tuple[Least, Least | None]:
    """Least singularity margin of a motion, and, of an arm with a loop, least parallel margin (None: it has none), from
    times t (T,) on, which are 1 ms apart as a rule: where the margin is smooth, or falls and rises again at one rate as
    it does where an arm passes through a singular position, it is then known to 1e-4. NaN where one is none."""
    parallel = _least(robot.parallel_margin, trajectory, t) if has_loop(robot) else None
    return _least(robot.margin, trajectory, t), parallel


def instants(trajectory: Trajectory) -> tuple[FloatArray, FloatArray]:
    """Times (T,), and for how long each counts (T,), s: `FINE_S` at most, in a motion that is not long."""
    count = math.ceil(trajectory.duration / FINE_S) + 1
    if count <= MOST_FINE:
        t = np.linspace(trajectory.start, trajectory.end, max(2, count))
        return t, np.full(len(t), t[1] - t[0])
    rates = np.asarray(np.concatenate([trajectory.qd, trajectory.qdd], axis=1).any(axis=1))
    spans = np.stack([trajectory.time[:-1], trajectory.time[1:]], 1)[rates[:-1] | rates[1:]]
    lengths = spans[:, 1] - spans[:, 0]
    apart = max(FINE_S, float(lengths.sum()) / MOST_FINE)
    counts = np.ceil(lengths / apart).astype(np.int64)
    within = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    even = within * np.repeat(lengths / counts, counts) + np.repeat(spans[:, 0], counts)
    return np.append(even, trajectory.time[-1]), np.append(np.repeat(lengths / counts, counts), 0.0)


def _least(margin: Callable[[FloatArray], FloatArray], trajectory: Trajectory, t: FloatArray) -> Least:
    found = margin(trajectory.evaluate(t))
    if not np.isfinite(found).all():
        return float("nan"), float(t[int(np.argmin(np.isfinite(found)))])
    return min(_around(margin, trajectory, t, k) for k in _lows(found))


def _lows(found: FloatArray) -> list[int]:
    """Instants around which the least of all may be: none beside one of them has less, and the least is no farther
    below it than it changes from there to the instants beside."""
    steps = np.diff(found)
    falls = np.append(True, steps < 0.0) & np.append(steps >= 0.0, True)
    sizes = np.abs(steps)
    change = np.maximum(np.append(0.0, sizes), np.append(sizes, 0.0))
    return [int(k) for k in np.flatnonzero(falls & (found - change <= found.min()))]


def _around(margin: Callable[[FloatArray], FloatArray], trajectory: Trajectory, t: FloatArray, k: int) -> Least:
    for _ in range(ROUNDS):
        t = np.linspace(t[max(k - 1, 0)], t[min(k + 1, len(t) - 1)], AROUND + 1)
        found = margin(trajectory.evaluate(t))
        k = int(np.argmin(found))  # of what is no number, the first
    return float(found[k]), float(t[k])
