"""Upright poses, many at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Document = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Poses:
    """Positions `p` (..., 3), m, and yaws (...), rad, of frames that are turned about the vertical only."""

    p: Floats
    yaw: Floats

    @staticmethod
    def of(at: Any = (0.0, 0.0, 0.0), yaw: Any = 0.0) -> Poses:
        """One pose, or many."""
        return Poses(np.asarray(at, dtype=np.float64), np.asarray(yaw, dtype=np.float64))

    def then(self, inner: Poses) -> Poses:
        """`inner`, which is given in this frame, in the frame in which this one is given."""
        return Poses(self.p + turned(self.yaw, inner.p), self.yaw + inner.yaw)

    def inverse(self) -> Poses:
        """The outer frame, seen from this one."""
        return Poses(-turned(-self.yaw, self.p), -self.yaw)

    def still(self, shape: tuple[int, ...]) -> Poses:
        """This one pose, in an array of this shape."""
        return Poses(np.broadcast_to(self.p, (*shape, 3)), np.broadcast_to(self.yaw, shape))

    def __getitem__(self, key: Any) -> Poses:
        return Poses(self.p[key], self.yaw[key])

    def moved(self, by: Floats, turn: Floats | float = 0.0) -> Poses:
        """Shifted by vectors (..., 3) of the outer frame and turned about the own vertical."""
        return Poses(self.p + by, self.yaw + turn)


def turned(yaw: Floats, vector: Floats) -> Floats:
    """Vectors (..., 3) turned about the vertical by `yaw` (...)."""
    c, s = np.cos(yaw), np.sin(yaw)
    x, y, z = vector[..., 0], vector[..., 1], vector[..., 2]
    return np.stack(np.broadcast_arrays(c * x - s * y, s * x + c * y, z), axis=-1)


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
