"""ROS 2's joint_trajectory_controller as far as it decides the motion: a quintic through two points that both have
positions, velocities and accelerations, written with powers of the time as that controller does."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray


def seconds(since: dict[str, int]) -> float:
    """A duration of ROS."""
    return since["sec"] + 1e-9 * since["nanosec"]


def sampled(message: dict[str, Any], t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Positions, velocities and accelerations (T, n) at times t (T,) after the start."""
    points = message["points"]
    times = np.array([seconds(point["time_from_start"]) for point in points])
    found = np.empty((3, len(t), len(message["joint_names"])))
    for row, now in enumerate(t.tolist()):
        k = int(np.clip(np.searchsorted(times, now, side="right") - 1, 0, len(points) - 2))
        found[:, row] = _between(points[k], points[k + 1], times[k + 1] - times[k], now - times[k])
    return found[0], found[1], found[2]


def _between(one: dict[str, Any], other: dict[str, Any], whole: float, tau: float) -> FloatArray:
    p0, v0, a0 = (np.array(one[key]) for key in ("positions", "velocities", "accelerations"))
    p1, v1, a1 = (np.array(other[key]) for key in ("positions", "velocities", "accelerations"))
    power = [whole**k for k in range(6)]
    c = [
        p0,
        v0,
        0.5 * a0,
        (-20.0 * p0 + 20.0 * p1 - 3.0 * a0 * power[2] + a1 * power[2] - 12.0 * v0 * whole - 8.0 * v1 * whole)
        / (2.0 * power[3]),
        (30.0 * p0 - 30.0 * p1 + 3.0 * a0 * power[2] - 2.0 * a1 * power[2] + 16.0 * v0 * whole + 14.0 * v1 * whole)
        / (2.0 * power[4]),
        (-12.0 * p0 + 12.0 * p1 - a0 * power[2] + a1 * power[2] - 6.0 * v0 * whole - 6.0 * v1 * whole)
        / (2.0 * power[5]),
    ]
    return np.array(
        [
            sum(c[i] * tau**i for i in range(6)),
            sum(i * c[i] * tau ** (i - 1) for i in range(1, 6)),
            sum(i * (i - 1) * c[i] * tau ** (i - 2) for i in range(2, 6)),
        ]
    )
