"""Triangles cut by a plane across an axis: both sides together are the triangles that went in."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray

SAME_M = 1e-7
"""Heights closer than this are one, m: rounding in a file's float32."""


def clip(triangles: FloatArray, axis: int, at: float) -> tuple[FloatArray, FloatArray]:
    """The parts of triangles (k, 3, 3) below and above the plane x[axis] = at, as triangles turned the same way.

    A triangle that touches the plane, or reaches through it by less than SAME_M, goes whole to its own side; one that
    lies in it, to the side where the solid is, behind its outward normal.
    """
    heights = triangles[:, :, axis] - at
    heights = np.where(np.abs(heights) <= SAME_M, 0.0, heights)
    low, high = heights.min(1), heights.max(1)
    within = (low == 0) & (high == 0)
    crossing = (low < 0) & (high > 0)
    up = _upwards(triangles, axis)
    below = triangles[((high <= 0) & ~within) | (within & (up >= 0))]
    above = triangles[((low >= 0) & ~within) | (within & (up < 0))]
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


def _upwards(triangles: FloatArray, axis: int) -> FloatArray:
    """Component along the axis of each triangle's outward normal (k,), twice its area long."""
    i, j = (axis + 1) % 3, (axis + 2) % 3
    e1, e2 = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    component: FloatArray = e1[:, i] * e2[:, j] - e1[:, j] * e2[:, i]
    return component


def _meet(a: FloatArray, b: FloatArray, axis: int, at: float) -> FloatArray:
    """Where the edges from a to b (k, 3) meet the plane: on the edge, between its ends."""
    share = np.clip((at - a[:, axis]) / (b[:, axis] - a[:, axis]), 0.0, 1.0)
    point: FloatArray = a + share[:, None] * (b - a)
    return point
