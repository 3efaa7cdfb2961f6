"""The RPR dyad in arrays: a slider between two revolute joints, equations K19 to K22 of docs/kinematics.md.

A and B are given with their motion, d = B − A; angle θ and length l of the line from A to B are sought. e = d/l,
e⊥ a quarter turn to the left. The equations stand in `assur.planner.kernels.dyads`. The same dyad gives base angle and
radius of any arm that turns about the vertical.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.assur.rrr import Planar, stacked
from assur.planner.errors import FaultError, InputError
from assur.planner.kernels.dyads import ANGLE, LENGTH, RPR_COLUMNS, rpr_rows

FORWARD = 1
"""s of the usual assembly: B ahead of A along the slider, l > 0."""
BACKWARD = -1
"""s of the other one: the slider points away from B, l < 0."""


@dataclass(frozen=True, slots=True)
class Extension:
    """The solved dyad over a batch of shape (...): every field is (...).

    `angle` θ in (−π, π], rad; `length` l, m; `unit` e; `rates` holds, for each derivative that was given, the pair of
    that derivative of θ (rad/s, ...) and of l (m/s, ...).
    """

    angle: FloatArray
    length: FloatArray
    unit: Planar
    rates: tuple[Planar, ...]
    code: IntArray


@dataclass(frozen=True)
class RPR:
    """The dyad whose direction is not determined where |d| <= `least`, m. Raises `InputError` unless it is positive.

    B, 2 m from A along x, moves upwards at 1 m/s: the line turns at 0.5 rad/s and does not grow, but begins to.

    >>> still = (np.array(0.0), np.array(0.0))
    >>> seen = RPR(1e-9).solve(FORWARD, (np.array(2.0), np.array(0.0)), (np.array(0.0), np.array(1.0)), still)
    >>> [round(float(x), 3) for x in (seen.length, seen.angle, *seen.rates[0], *seen.rates[1])]
    [2.0, 0.0, 0.5, 0.0, -0.0, 0.5]
    """

    least: float

    def __post_init__(self) -> None:
        if not (0.0 < self.least < np.inf):
            raise InputError("least", self.least, "a positive length in m")

    def solve(self, sign: int, d: Planar, *derivatives: Planar) -> Extension:
        """The assembly with `sign` (FORWARD or BACKWARD) for `d` = B − A (m) and up to three time derivatives of d.

        Degenerate rows: with |d| <= `least` the slider may point anywhere, INDETERMINATE; what is not finite, or
        overflows, is OUT_OF_REACH. Both are NaN throughout. No row raises or warns, and none affects another. Raises
        `FaultError` for a sign or a number of derivatives that is wrong. Not checked: the slider's stroke.
        """
        if sign not in (FORWARD, BACKWARD) or len(derivatives) > 3:
            raise FaultError(f"RPR: sign {sign} with {len(derivatives)} derivatives")
        rows = stacked(d, *derivatives)
        out, code = np.empty((*rows.shape[:-2], RPR_COLUMNS)), np.empty(rows.shape[:-2], dtype=np.int64)
        flat = rows.reshape(-1, *rows.shape[-2:])
        rpr_rows(self.least, sign, flat, len(derivatives), out.reshape(-1, RPR_COLUMNS), code.reshape(-1))
        angle, length = out[..., ANGLE], out[..., LENGTH]
        unit = (sign * np.cos(angle), sign * np.sin(angle))
        rates = tuple((out[..., 2 * k], out[..., 2 * k + 1]) for k in range(1, len(derivatives) + 1))
        return Extension(angle, length, unit, rates, code)
