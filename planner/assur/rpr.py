"""The RPR dyad: a slider between two revolute joints, in vector form, from position to jerk.

A and B are given with their motion, d = B − A; angle θ and length l of the line from A to B are sought. e = d/l,
e⊥ a quarter turn to the left. Equations K19 to K22 of docs/kinematics.md:

    l = s |d|        θ = ∠(s d)                                                                      (K19)
    l̇ = e·ḋ          θ̇ = e⊥·ḋ/l                                                                     (K20)
    l̈ = e·d̈ + l θ̇²   θ̈ = (e⊥·d̈ − 2 l̇ θ̇)/l                                                         (K21)
    l⃛ = e·d⃛ + 3 l̇ θ̇² + 3 l θ̇ θ̈    θ⃛ = (e⊥·d⃛ − 3 l̇ θ̈ − 3 l̈ θ̇ + l θ̇³)/l                         (K22)

Source: 000, figures 2 (θ) and 3 (l), without their cases for x = 0 (of which two are printed wrongly) and with one
order more. The same dyad gives base angle and radius of any arm that turns about the vertical.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.assur.codes import Code
from assur.planner.assur.rrr import Planar
from assur.planner.errors import FaultError, InputError

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

    @np.errstate(all="ignore")
    def solve(self, sign: int, d: Planar, *derivatives: Planar) -> Extension:
        """The assembly with `sign` (FORWARD or BACKWARD) for `d` = B − A (m) and up to three time derivatives of d.

        Degenerate rows: with |d| <= `least` the slider may point anywhere, INDETERMINATE; what is not finite, or
        overflows, is OUT_OF_REACH. Both are NaN throughout. No row raises or warns, and none affects another. Raises
        `FaultError` for a sign or a number of derivatives that is wrong. Not checked: the slider's stroke.
        """
        if sign not in (FORWARD, BACKWARD) or len(derivatives) > 3:
            raise FaultError(f"RPR: sign {sign} with {len(derivatives)} derivatives")
        dx, dy = d
        distance = np.hypot(dx, dy)
        length = sign * distance
        ex, ey = dx / length, dy / length
        along = [ex * x + ey * y for x, y in derivatives]
        across = [ex * y - ey * x for x, y in derivatives]
        rates: list[Planar] = []
        if along:
            grows, turns = along[0], across[0] / length  # K20
            rates.append((turns, grows))
        if len(along) > 1:
            grows_2 = along[1] + length * turns * turns  # K21
            turns_2 = (across[1] - 2.0 * grows * turns) / length
            rates.append((turns_2, grows_2))
        if len(along) > 2:
            grows_3 = along[2] + 3.0 * turns * (grows * turns + length * turns_2)  # K22
            turns_3 = (across[2] - 3.0 * (grows * turns_2 + grows_2 * turns) + length * turns**3) / length
            rates.append((turns_3, grows_3))
        given = sum((x * 0.0 for pair in (d, *derivatives) for x in pair), np.zeros(distance.shape))
        finite = np.isfinite(given + distance)
        far = distance > self.least
        for pair in rates:
            finite &= np.isfinite(pair[0] + pair[1]) | ~far
        code = np.where(~finite, Code.OUT_OF_REACH, np.where(far, Code.ASSEMBLED, Code.INDETERMINATE)).astype(np.int64)
        good = code == Code.ASSEMBLED

        def known(x: FloatArray) -> FloatArray:
            return np.where(good, x, np.nan)

        # + 0.0: no negative zero, which would turn the angle of a line along −x into −π
        angle = np.arctan2(sign * dy + 0.0, sign * dx + 0.0)
        unit = (known(ex), known(ey))
        return Extension(
            known(angle), known(length), unit, tuple((known(turn), known(grow)) for turn, grow in rates), code
        )
