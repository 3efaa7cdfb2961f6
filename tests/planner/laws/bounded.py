"""What the kernels bound of a law's frame over intervals, in the form in which tests compare it with samples."""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels import law_columns as c
from assur.planner.kernels.laws import coordinate_rates
from assur.planner.laws import Law, Motion


@dataclass(frozen=True)
class Bounded:
    """Upper bounds (N,): |n · ṗ| and |n · p̈| of the frame's origin, |ω|, and √(ω̇² + ω⁴), the acceleration of a point at
    a distance of 1 m from the axis."""

    speed: FloatArray
    acceleration: FloatArray
    yaw_rate: FloatArray
    turning: FloatArray

    @property
    def table(self) -> FloatArray:
        """(4, N)."""
        return np.stack(astuple(self))


def bounded(law: Law, t0: FloatArray, t1: FloatArray, n: FloatArray) -> Bounded:
    """Over the intervals [t0, t1] (N,) along unit vectors `n` (N, 3)."""
    found = np.full((len(t0), 4), np.inf)
    for i in range(len(t0)):
        swept = law.sweep(float(t0[i]), float(t1[i]))
        if not np.isfinite(swept.jets).all():
            continue
        for order in (1, 2):
            middle, off = swept.jets[:3, 2 * order], swept.jets[:3, 2 * order + 1]
            found[i, order - 1] = abs(middle @ n[i]) + off @ np.abs(n[i])
            found[i, 1 + order] = swept.turning(order)
        if law.link is None:
            # the axes bound them over a short interval only
            low, high, low_d, high_d = coordinate_rates(law.row, law.side, 3, float(t0[i]), float(t1[i]))
            rate = max(abs(low), abs(high)) + law.row[c.SLACK + 2]
            found[i, 2:] = rate, math.hypot(max(abs(low_d), abs(high_d)) + law.row[c.SLACK + 3], rate**2)
    return Bounded(*found.T)


def rates(motion: Motion, n: FloatArray) -> FloatArray:
    """(4, T): the truth, in the order of `Bounded`."""
    return np.stack([np.abs(motion.v @ n), np.abs(motion.a @ n), np.abs(motion.yaw_d), turning(motion)])


def turning(motion: Motion) -> FloatArray:
    """√(ω̇² + ω⁴) (...)."""
    return np.asarray(np.hypot(motion.yaw_dd, motion.yaw_d**2))
