"""The joint velocities with which a via is flown by."""

from __future__ import annotations

import numpy as np

from planner.arrays import FloatArray

VIA_VELOCITY = 0.9
"""Share of a velocity limit up to which a via is flown by: the rest is left to Ruckig."""
BRIEFEST = 1e-3
"""A way through a via is taken to last this long at least, s."""


def passing_velocity(
    before: FloatArray,
    at: FloatArray,
    behind: FloatArray,
    pace: FloatArray | float,
    velocity: FloatArray,
    acceleration: FloatArray,
) -> FloatArray:
    """Velocities (..., n) at `at` on the way from `before` to `behind` (..., n): `pace` (...) times the mean ones.

    A joint that turns round at the via stands still there: else it would go on beyond the via, perhaps beyond a limit.
    """
    there, on = at - before, behind - at
    length = np.abs(there) + np.abs(on)
    duration = np.max(length / velocity + np.sqrt(length / acceleration), axis=-1, keepdims=True)
    limit = VIA_VELOCITY * velocity
    mean = np.where(there * on > 0, behind - before, 0.0) / np.maximum(duration, BRIEFEST)
    found: FloatArray = np.clip(np.asarray(pace)[..., None] * mean, -limit, limit)
    return found
