"""Triangles cut by a plane across an axis: both sides together are the triangles that went in."""

from __future__ import annotations

import numpy as np

from planner.arrays import FloatArray


def clip(triangles: FloatArray, axis: int, at: float) -> tuple[FloatArray, FloatArray]:
    """The parts of triangles (k, 3, 3) below and above the plane x[axis] = at, as triangles turned the same way.

    What lies in the plane goes to both sides; a triangle that only touches it goes to its own side.
    """
    heights = triangles[:, :, axis] - at
    low, high = heights.min(1), heights.max(1)
    crossing = (low < 0) & (high > 0)
    below, above = triangles[high <= 0], triangles[(low >= 0)]
    if not crossing.any():
        return below, above
    cut, over = triangles[crossing], heights[crossing] > 0
    lone_is_over = over.sum(1) == 1
    lone = np.where(lone_is_over, np.argmax(over, axis=1), np.argmin(over, axis=1))
    rows = np.arange(len(cut))
    a, b, c = (cut[rows, (lone + k) % 3] for k in range(3))
    ab, ac = _meet(a, b, axis, at), _meet(a, c, axis, at)
    tip = np.stack([a, ab, ac], 1)
    rest = np.concatenate([np.stack([ab, b, c], 1), np.stack([ab, c, ac], 1)])
    twice = np.concatenate([lone_is_over, lone_is_over])
    return (
        np.concatenate([below, tip[~lone_is_over], rest[twice]]),
        np.concatenate([above, tip[lone_is_over], rest[~twice]]),
    )


def _meet(a: FloatArray, b: FloatArray, axis: int, at: float) -> FloatArray:
    """Where the edges from a to b (k, 3) meet the plane; a is strictly off it or b is."""
    share = (at - a[:, axis]) / (b[:, axis] - a[:, axis])
    point: FloatArray = a + share[:, None] * (b - a)
    point[:, axis] = at
    return point
