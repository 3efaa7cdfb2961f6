"""The planner's RRR dyad over arrays: two links and three parallel revolute joints, K1 to K8 of docs/kinematics.md.

Link 1 runs from A to C, link 2 from C to B; A and B are given with their motion, C is sought. Everything is in one
plane and only differences count: u = C − A, w = B − C, d = B − A = u + w. The equations are in
`assur.planner.kernels.dyads`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.errors import FaultError, InputError
from assur.planner.geometry.shapes import LARGEST_M, SMALLEST_M
from assur.planner.kernels.dyads import LEFT, RATES, RIGHT, ROUNDING, RRR_COLUMNS, rrr_rows

__all__ = ["LEFT", "RIGHT", "ROUNDING", "RRR", "Assembly", "Planar"]

Planar = tuple[FloatArray, FloatArray]
"""x and y of vectors, each (...)."""


@dataclass(frozen=True, slots=True)
class Assembly:
    """The solved dyad over a batch of shape (...): every field is (...).

    `u` and `w` are the vectors A→C and C→B, m; `cross` is u × w = l₁ l₂ sin θ₂, m²; `margin` is |sin θ₂|;
    `rates` holds, for each derivative that was given, the pair for links 1 and 2 of their *absolute* angular velocity
    (rad/s), acceleration (rad/s²), and jerk (rad/s³).
    """

    u: Planar
    w: Planar
    cross: FloatArray
    margin: FloatArray
    rates: tuple[Planar, ...]
    code: IntArray


@dataclass(frozen=True)
class RRR:
    """The dyad with link lengths `l1` (A to C) and `l2` (C to B), m.

    Raises `InputError` unless both are from 10 µm to 50 m.

    B at (0.5, 0) m moves upwards at 1 m/s: |AB| does not change, so the whole triangle turns at 2 rad/s.

    >>> dyad = RRR(0.3, 0.4)
    >>> bent = dyad.solve(RIGHT, (np.array(0.5), np.array(0.0)), (np.array(0.0), np.array(1.0)))
    >>> [round(float(x), 3) for x in (*bent.u, *bent.w, *bent.rates[0], bent.margin)]
    [0.18, -0.24, 0.32, 0.24, 2.0, 2.0, 1.0]
    """

    l1: float
    l2: float

    def __post_init__(self) -> None:
        for name in ("l1", "l2"):
            if not SMALLEST_M <= getattr(self, name) <= LARGEST_M:
                raise InputError(name, getattr(self, name), f"a length from {SMALLEST_M} to {LARGEST_M} m")

    def solve(self, sigma: int, d: Planar, *derivatives: Planar) -> Assembly:
        """The assembly with `sigma` (LEFT or RIGHT) for `d` = B − A (m) and up to three time derivatives of d.

        Only the orders given are solved: with `d` alone it is the position. All arrays have one shape (...). Rows are
        independent, and the same to the bit in any batch.

        Degenerate rows (docs/kinematics.md, table of cases): stretched and folded rows have `u`, `w`, on the line AB,
        and a margin of 0, but NaN rates; out of reach, indeterminate and non-finite rows are NaN throughout.
        No row raises or warns. Raises `FaultError` for a sigma, a number of derivatives or shapes that are wrong.
        Not checked: that the motion came from the same mode before.
        """
        if sigma not in (LEFT, RIGHT) or len(derivatives) > 3:
            raise FaultError(f"RRR: sigma {sigma} with {len(derivatives)} derivatives")
        rows = stacked(d, *derivatives)
        out, code = np.empty((*rows.shape[:-2], RRR_COLUMNS)), np.empty(rows.shape[:-2], dtype=np.int64)
        flat = rows.reshape(-1, *rows.shape[-2:])
        rrr_rows(self.l1, self.l2, sigma, flat, len(derivatives), out.reshape(-1, RRR_COLUMNS), code.reshape(-1))
        pairs = [(out[..., k], out[..., k + 1]) for k in range(0, RATES + 2 * len(derivatives), 2)]
        u, w, (cross, margin), *rates = pairs
        return Assembly(u, w, cross, margin, tuple(rates), code)


def stacked(d: Planar, *derivatives: Planar) -> FloatArray:
    """A planar vector and its derivatives as (..., 4, 2), those not given being 0. Raises `FaultError` for shapes."""
    given = [np.asarray(x, dtype=np.float64) for pair in (d, *derivatives) for x in pair]
    rows = np.zeros((*given[0].shape, 4, 2))
    for k, x in enumerate(given):
        if x.shape != given[0].shape:
            raise FaultError(f"a dyad of shapes {given[0].shape} and {x.shape}")
        rows[..., k // 2, k % 2] = x
    return rows
