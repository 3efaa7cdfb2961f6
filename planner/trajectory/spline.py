"""A trajectory as tables for kernels, and bounds of its joint motion over many intervals of time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.kernels.spline import piece_bounds, sweeps_bounds
from assur.planner.robots.protocol import Sweep
from assur.planner.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Spline:
    """Times `tk` (P + 1,), coefficients `c` (P, n, 6) in the time since each knot, bounds `whole` (P + 1, 4 (m + n)) of
    every piece for the rate matrix `matrix` (m, n)."""

    tk: FloatArray
    c: FloatArray
    whole: FloatArray
    matrix: FloatArray

    def sweep(self, t0: FloatArray, t1: FloatArray) -> Sweep:
        """Joint ranges, and upper bounds of |C q̇| and |C q̈|, over the closed intervals [t0, t1] (N,), s, with C the
        rate matrix (`kernels.spline.sweep_bounds`). Intervals may span pieces, be points, and reach to ±inf.

        Raises `FaultError` unless t0 <= t1 everywhere (NaN is refused), and for shapes that do not fit.
        """
        if t0.ndim != 1 or t0.shape != t1.shape:
            raise FaultError(f"sweep over {t0.shape} to {t1.shape}")
        if not (t0 <= t1).all():
            raise FaultError("sweep over an interval that ends before it begins, or is not a number")
        m, n = self.matrix.shape
        lower, upper = np.empty((2, len(t0), n))
        rate, rate_d = np.empty((2, len(t0), m))
        table = self.tk, self.c, self.whole, self.matrix
        sweeps_bounds(*table, np.array(t0), np.array(t1), lower, upper, rate, rate_d)
        return Sweep(lower, upper, rate, rate_d)


def spline_table(trajectory: Trajectory, rate_matrix: FloatArray) -> Spline:
    """The tables of a trajectory; `rate_matrix` (m, n) says which combinations of joint rates are bounded.

    Raises `FaultError` for a matrix of another number of joints.
    """
    tk, c, matrix = trajectory.edges, trajectory.coefficients, np.array(rate_matrix, order="C")
    if matrix.ndim != 2 or matrix.shape[1] != trajectory.n:
        raise FaultError(f"rates {matrix.shape} of {trajectory.n} joints")
    whole = np.empty((len(tk), 4 * sum(matrix.shape)))
    piece_bounds(tk, c, matrix, trajectory.rest_at_start, trajectory.rest_at_end, whole)
    return Spline(tk, c, whole, matrix)
