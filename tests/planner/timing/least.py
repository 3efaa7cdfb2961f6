"""Lower bounds of durations between two states, and closed forms, for arrays of any shape: the kernels, one by one."""

from __future__ import annotations

from typing import Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels import meetings as kernels


def rest_to_rest_time(distance: Any, velocity: Any, acceleration: Any, jerk: Any) -> FloatArray:
    """Elementwise, s."""
    found = np.vectorize(kernels.rest_to_rest_time, otypes=[float])(distance, velocity, acceleration, jerk)
    return np.asarray(found, dtype=np.float64)


def least_duration(
    q0: FloatArray,
    v0: FloatArray,
    a0: FloatArray,
    q1: FloatArray,
    v1: FloatArray,
    a1: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray | None,
) -> FloatArray:
    """From one state (n,) to each of the states (..., n), s; `jerk` None: it is not limited."""
    goals = np.stack(np.broadcast_arrays(q1, v1, a1), -2)
    shape, n = goals.shape[:-2], goals.shape[-1]
    rows = np.zeros((int(np.prod(shape)), 1 + 3 * n))
    rows[:, 1:] = goals.reshape(-1, 3 * n)
    wide = np.full(n, np.inf)
    limits = np.array([-wide, wide, velocity, acceleration, np.ones(n) if jerk is None else jerk])
    found = np.empty(len(rows))
    kernels.least_durations(np.array([q0, v0, a0]), rows, limits, jerk is not None, found)
    return found.reshape(shape)
