"""Attitudes as unit quaternions (x, y, z, w)."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray

SMALL_RAD = 1e-6
"""Below this angle a straight line replaces the arc, whose formula divides by the sine of the angle."""


def of_matrices(r: FloatArray) -> FloatArray:
    """Quaternions (..., 4), of either sign, of rotation matrices (..., 3, 3)."""
    trace = np.trace(r, axis1=-2, axis2=-1)
    diagonal = np.diagonal(r, axis1=-2, axis2=-1)
    # four times the squares of w, x, y, z; the largest is the divisor
    squares = np.stack([1.0 + trace, *(1.0 + 2.0 * diagonal[..., k] - trace for k in range(3))], -1)
    best = np.argmax(squares, -1)
    cross = np.stack([r[..., 2, 1] - r[..., 1, 2], r[..., 0, 2] - r[..., 2, 0], r[..., 1, 0] - r[..., 0, 1]], -1)
    sums = r + np.swapaxes(r, -1, -2)
    forms = np.empty((*r.shape[:-2], 4, 4))
    forms[..., 0, :3], forms[..., 0, 3] = cross, squares[..., 0]
    for k in range(3):
        forms[..., k + 1, :3] = sums[..., k, :]
        forms[..., k + 1, k], forms[..., k + 1, 3] = squares[..., k + 1], cross[..., k]
    chosen = np.take_along_axis(forms, best[..., None, None], -2)[..., 0, :]
    return np.asarray(chosen / np.linalg.norm(chosen, axis=-1, keepdims=True))


def of_yaws(yaw: FloatArray) -> FloatArray:
    """Quaternions (..., 4) of rotations about the vertical by angles (...), rad."""
    zero = np.zeros_like(yaw)
    return np.stack([zero, zero, np.sin(yaw / 2), np.cos(yaw / 2)], -1)


def interpolated(first: FloatArray, last: FloatArray, share: FloatArray) -> FloatArray:
    """Attitudes (T, 4) on the shorter arc from `first` to `last`, both (4,) or (T, 4), at shares (T,) of it."""
    last = np.where(np.sum(first * last, -1, keepdims=True) < 0.0, -last, last)
    angle = 2.0 * np.arcsin(np.minimum(1.0, np.linalg.norm(first - last, axis=-1, keepdims=True) / 2.0))
    share = share[:, None]
    with np.errstate(invalid="ignore"):
        arc = (np.sin((1.0 - share) * angle) * first + np.sin(share * angle) * last) / np.sin(angle)
    turns = np.where(angle < SMALL_RAD, first + share * (last - first), arc)
    return np.asarray(turns / np.linalg.norm(turns, axis=-1, keepdims=True))


def angles_between(one: FloatArray, other: FloatArray) -> FloatArray:
    """Angles (T,), rad, between attitudes (T, 4)."""
    near = np.minimum(np.linalg.norm(one - other, axis=-1), np.linalg.norm(one + other, axis=-1))
    return np.asarray(4.0 * np.arcsin(np.minimum(1.0, near / 2.0)))


def rotated(q: FloatArray, points: FloatArray) -> FloatArray:
    """Points (..., 3) rotated by quaternions (..., 4)."""
    u, w = q[..., :3], q[..., 3:]
    once = np.cross(u, points)
    return np.asarray(points + 2.0 * (w * once + np.cross(u, once)))
