"""A trajectory as tables: what `assur.planner.kernels.spline` reads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.kernels.spline import piece_bounds
from assur.planner.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Spline:
    """Times `tk` (P + 1,), coefficients `c` (P, n, 6) in the time since each knot, bounds `whole` (P + 1, 4 (m + n)) of
    every piece for the rate matrix `matrix` (m, n)."""

    tk: FloatArray
    c: FloatArray
    whole: FloatArray
    matrix: FloatArray


def spline_table(trajectory: Trajectory, rate_matrix: FloatArray) -> Spline:
    """The tables of a trajectory; `rate_matrix` (m, n) says which combinations of joint rates are bounded.

    Raises `FaultError` for a matrix of another number of joints.
    """
    tk, c, matrix = trajectory.edges, trajectory.coefficients, np.array(rate_matrix, order="C")
    if matrix.ndim != 2 or matrix.shape[1] != trajectory.n:
        raise FaultError(f"rates {matrix.shape} of {trajectory.n} joints")
    whole = np.empty((len(tk), 4 * sum(matrix.shape)))
    piece_bounds(trajectory.knots, tk, c, matrix, whole)
    return Spline(tk, c, whole, matrix)
