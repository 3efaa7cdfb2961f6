"""The joint velocities with which vias are flown by: of one via in plain numbers, or of many in arrays."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray

VIA_VELOCITY = 0.9
"""Share of a velocity limit up to which a via is flown by: the rest is left to Ruckig."""
BRIEFEST = 1e-3
"""A way through a via is taken to last this long at least, s."""


def passing_velocity(
    before: list[float],
    at: list[float],
    behind: list[float],
    pace: float,
    velocity: list[float],
    acceleration: list[float],
) -> list[float]:
    """A velocity a joint with which `at` is flown by on the way from `before` to `behind`: `pace` times the mean one.

    A joint that turns round at the via stands still there: else it would go on beyond the via, perhaps beyond a limit.
    """
    duration, way = BRIEFEST, list(zip(before, at, behind, velocity, acceleration, strict=True))
    for a, b, c, v, rate in way:
        length = abs(c - b) + abs(b - a)
        duration = max(duration, length / v + math.sqrt(length / rate))
    found = []
    for a, b, c, v, _ in way:
        limit, mean = VIA_VELOCITY * v, (c - a) / duration
        found.append(min(max(pace * mean, -limit), limit) if (b - a) * (c - b) > 0 else 0.0)
    return found


def passing_velocities(
    before: FloatArray,
    at: FloatArray,
    behind: FloatArray,
    pace: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
) -> FloatArray:
    """`passing_velocity` of many vias: (..., n) at `at` (..., n) with paces (...)."""
    there, on = at - before, behind - at
    length = np.abs(there) + np.abs(on)
    duration = np.max(length / velocity + np.sqrt(length / acceleration), axis=-1, keepdims=True)
    limit = VIA_VELOCITY * velocity
    mean = np.where(there * on > 0, behind - before, 0.0) / np.maximum(duration, BRIEFEST)
    found: FloatArray = np.clip(pace[..., None] * mean, -limit, limit)
    return found
