"""How far points that a link or a frame carries move at most over an interval, from its jets."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Sweep:
    """The jets (12, 6) of a carrier over an interval (`assur.planner.kernels.sweeps.chain`)."""

    jets: FloatArray

    def point(self, order: int, x: float, y: float, z: float) -> FloatArray:
        """Upper bounds (3,) of the magnitudes of the coordinates, in the world, of the derivative of that order (1 or
        2) of the point (x, y, z) that is carried; infinite where nothing is known (K43)."""
        if not np.isfinite(self.jets).all():
            return np.full(3, np.inf)
        place = np.array([1.0, x, y, z])
        middle = place @ self.jets[:, 2 * order].reshape(4, 3)
        radius = np.abs(place) @ self.jets[:, 2 * order + 1].reshape(4, 3)
        return np.asarray(np.abs(middle) + radius)

    def turning(self, order: int) -> float:
        """An upper bound of the magnitude of that derivative of the horizontal direction of a carrier's x axis, if it
        stays upright: of the order 1 its rate of turning, rad/s."""
        if not np.isfinite(self.jets).all():
            return float(np.inf)
        return float(np.hypot(*(abs(self.jets[k, 2 * order]) + self.jets[k, 2 * order + 1] for k in (3, 4))))
