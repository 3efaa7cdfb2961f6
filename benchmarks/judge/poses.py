"""Rigid transforms, many at a time, and the quantities of documents in SI."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Document = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Poses:
    """Rotations `r` (..., 3, 3) and positions `p` (..., 3), m, of frames in an outer one."""

    r: Floats
    p: Floats

    @staticmethod
    def of(at: Any = (0.0, 0.0, 0.0), yaw: Any = 0.0) -> Poses:
        """One pose or many, shifted and turned about the vertical."""
        at, r = np.asarray(at, dtype=np.float64), about(2, yaw)
        shape = np.broadcast_shapes(at.shape[:-1], r.shape[:-2])
        return Poses(np.broadcast_to(r, (*shape, 3, 3)), np.broadcast_to(at, (*shape, 3)))

    @staticmethod
    def turned(axis: int, angle: Any) -> Poses:
        """Turned about an axis (0, 1 or 2) by angles (...), rad, not shifted."""
        r = about(axis, angle)
        return Poses(r, np.zeros(r.shape[:-1]))

    def then(self, inner: Poses) -> Poses:
        """`inner`, which is given in this frame, in the frame in which this one is given."""
        return Poses(self.r @ inner.r, self.points(inner.p))

    def points(self, p: Any) -> Floats:
        """Points (..., 3), which are given in this frame, in the frame in which this one is given."""
        return np.asarray(self.p + np.einsum("...ij,...j->...i", self.r, p))

    def inverse(self) -> Poses:
        """The outer frame, seen from this one."""
        back = np.swapaxes(self.r, -1, -2)
        return Poses(back, -np.einsum("...ij,...j->...i", back, self.p))

    def still(self, shape: tuple[int, ...]) -> Poses:
        """This one pose, in an array of this shape."""
        return Poses(np.broadcast_to(self.r, (*shape, 3, 3)), np.broadcast_to(self.p, (*shape, 3)))

    def moved(self, by: Any, turn: Any = 0.0) -> Poses:
        """Shifted by vectors (..., 3) of the outer frame and turned about the own vertical."""
        p, r = self.p + by, self.r @ about(2, turn)
        shape = np.broadcast_shapes(p.shape[:-1], r.shape[:-2])
        return Poses(np.broadcast_to(r, (*shape, 3, 3)), np.broadcast_to(p, (*shape, 3)))

    def __getitem__(self, key: Any) -> Poses:
        return Poses(self.r[key], self.p[key])

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


PER_SI = {"m": 1.0, "mm": 1e-3, "rad": 1.0, "deg": np.pi / 180.0, "s": 1.0, "ms": 1e-3}


def si(document: Document, name: str, default: Any = None) -> Any:
    """What `document` says of `name` with its unit in the key, in SI; a value with a status loses it.

    Raises `KeyError` if the request states nothing and there is no default.
    """
    for unit, factor in PER_SI.items():
        key = f"{name}_{unit}"
        if key in document:
            found = document[key]
            found = found["value"] if isinstance(found, dict) else found
            return (np.asarray(found, dtype=np.float64) * factor)[()]
    if default is None:
        raise KeyError(name)
    return np.asarray(default, dtype=np.float64)[()]


def pose_in(document: Document) -> Poses:
    """The pose that a document gives by `at_m` and `yaw_rad` (or their twins)."""
    return Poses.of(si(document, "at", (0.0, 0.0, 0.0)), si(document, "yaw", 0.0))
