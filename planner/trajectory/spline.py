"""A trajectory as tables: what `assur.planner.kernels.spline` reads."""

from __future__ import annotations

import numpy as np

from assur.planner.kernels.spline import Spline, piece_bounds
from assur.planner.trajectory import Trajectory


def spline_table(trajectory: Trajectory) -> Spline:
    """The tables of a trajectory: times `tk` (P + 1,), coefficients `c` (P, n, 6) in the time since each knot, bounds
    `whole` (P + 1, 9 n) of every piece."""
    tk, c = trajectory.edges, trajectory.coefficients
    whole = np.empty((len(tk), 9 * trajectory.n))
    piece_bounds(trajectory.knots, whole)
    return tk, c, whole
