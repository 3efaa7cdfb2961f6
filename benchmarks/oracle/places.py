"""Rigid transforms, many at a time: of frames that may tilt."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.soak.poses import Floats, Poses


@dataclass(frozen=True, eq=False)
class Places:
    """Rotations `r` (..., 3, 3) and positions `p` (..., 3), m, of frames in an outer one."""

    r: Floats
    p: Floats

    @staticmethod
    def upright(poses: Poses) -> Places:
        """Of frames that are turned about the vertical only."""
        return Places(about(2, poses.yaw), np.asarray(poses.p, dtype=np.float64))

    @staticmethod
    def at(p: Any) -> Places:
        """Shifted, not turned."""
        p = np.asarray(p, dtype=np.float64)
        return Places(np.broadcast_to(np.eye(3), (*p.shape[:-1], 3, 3)), p)

    @staticmethod
    def turned(axis: int, angle: Any) -> Places:
        """Turned about an axis (0, 1 or 2) by angles (...), rad, not shifted."""
        r = about(axis, angle)
        return Places(r, np.zeros(r.shape[:-1]))

    def then(self, inner: Places) -> Places:
        """`inner`, which is given in this frame, in the frame in which this one is given."""
        return Places(self.r @ inner.r, self.p + np.einsum("...ij,...j->...i", self.r, inner.p))

    def inverse(self) -> Places:
        """The outer frame, seen from this one."""
        back = np.swapaxes(self.r, -1, -2)
        return Places(back, -np.einsum("...ij,...j->...i", back, self.p))

    def __getitem__(self, key: Any) -> Places:
        return Places(self.r[key], self.p[key])

    @property
    def yaw(self) -> Floats:
        """The direction of the x axis, seen from above, rad."""
        return np.asarray(np.arctan2(self.r[..., 1, 0], self.r[..., 0, 0]))


def about(axis: int, angle: Any) -> Floats:
    """Rotations (..., 3, 3) about an axis of the frame by angles (...), rad."""
    angle = np.asarray(angle, dtype=np.float64)
    c, s, found = np.cos(angle), np.sin(angle), np.zeros((*angle.shape, 3, 3))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    found[..., axis, axis] = 1.0
    found[..., i, i] = found[..., j, j] = c
    found[..., i, j], found[..., j, i] = -s, s
    return found


def short(angle: Any) -> Floats:
    """The same angle from -pi to pi."""
    return np.asarray((np.asarray(angle) + np.pi) % (2.0 * np.pi) - np.pi)
