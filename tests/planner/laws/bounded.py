"""What the kernels bound of a law's frame over intervals, in the form in which tests compare it with samples."""

from __future__ import annotations

from dataclasses import astuple, dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.kernels.carriers import point_bound
from assur.planner.kernels.laws import bound_frame
from assur.planner.kernels.links import ACCELERATION, BOUND_COLUMNS, V_REACH
from assur.planner.laws import Law, Motion, law_tables


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
    rows, pieces = law_tables([law])
    found, bounds = np.empty((len(t0), 4)), np.empty((1, BOUND_COLUMNS))
    for i in range(len(t0)):
        bound_frame(rows[0], pieces, float(t0[i]), float(t1[i]), bounds, 0)
        # of a point beside the axis: infinite where nothing is known
        known = np.isfinite(point_bound(bounds, 0, 1.0, 1.0, *n[i])).all()
        turns = bounds[0, V_REACH], bounds[0, ACCELERATION + V_REACH]
        found[i] = *point_bound(bounds, 0, 0.0, 0.0, *n[i]), *(turns if known else (np.inf, np.inf))
    return Bounded(*found.T)


def rates(motion: Motion, n: FloatArray) -> FloatArray:
    """(4, T): the truth, in the order of `Bounded`."""
    return np.stack([np.abs(motion.v @ n), np.abs(motion.a @ n), np.abs(motion.yaw_d), turning(motion)])


def turning(motion: Motion) -> FloatArray:
    """√(ω̇² + ω⁴) (...)."""
    return np.asarray(np.hypot(motion.yaw_dd, motion.yaw_d**2))
