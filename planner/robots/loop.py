"""The closed chain of a five-bar: two cranks, two couplers that meet, and what can be proved of them over a range.

In base axes, x to the front, the cranks turn about A_L = (0, d/2) and A_R = (0, −d/2):

    P1 = A_L + a_L e(θ1)        P2 = A_R + a_R e(θ5)        s = P2 − P1 = u + w                         (K32)

u (from P1 to the tool axis P) and w (from P to P2), of lengths b_L and b_R, are an RRR dyad on d = s. Its cross
product D = u × w vanishes where the couplers are in line: type 2 singularities. Front assembly is LEFT, D < 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.assur.rrr import LEFT, RIGHT, RRR, Assembly, Planar
from assur.planner.geometry.shapes import SMALLEST_M

ASSEMBLIES = ("front", "back")
"""On which side of the line of the elbows the tool axis is: with both cranks sideways, in front or behind."""
ROUNDING = 1e-12
"""Relative to the square of all lengths: what is added to every bound of |s|², whose terms round to some 1e-15."""


@dataclass(frozen=True, slots=True)
class Passive:
    """Upper bounds (N,) over ranges of joints: |φ̇|, |φ̈| of the left and the right coupler, absolute (K40, K41)."""

    left: FloatArray
    left_d: FloatArray
    right: FloatArray
    right_d: FloatArray


@dataclass(frozen=True)
class Loop:
    """The chain: `separation` d of the crank axes, `cranks` (a_L, a_R), `couplers` (b_L, b_R), m, and `sigma` of its
    assembly mode. Raises `InputError` for couplers that are no lengths (`RRR`)."""

    separation: float
    cranks: tuple[float, float]
    couplers: tuple[float, float]
    sigma: int
    dyad: RRR = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "dyad", RRR(*self.couplers))

    def span(self, left: tuple[FloatArray, ...], right: tuple[FloatArray, ...]) -> tuple[Planar, ...]:
        """s and as many derivatives (K32) as of the crank angles `left` and `right` are given, base axes."""
        parts = [_turning(self.cranks[k], angle) for k, angle in enumerate((left, right))]
        found = [(r[0] - q[0], r[1] - q[1]) for q, r in zip(*parts, strict=True)]
        found[0] = (found[0][0], found[0][1] - self.separation)
        return tuple(found)

    def assembled(self, left: tuple[FloatArray, ...], right: tuple[FloatArray, ...]) -> Assembly:
        """u, w, D and the couplers' rates from the cranks' angles and rates, in this assembly mode."""
        s, *rates = self.span(left, right)
        return self.dyad.solve(self.sigma, s, *rates)

    def signed(self, cross: FloatArray) -> FloatArray:
        """The parallel margin of u × w: |D|/(b_L b_R), negative in the other assembly mode (K33)."""
        found: FloatArray = cross * (-self.sigma / (self.couplers[0] * self.couplers[1]))
        return found

    def least(self, lower: FloatArray, upper: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Lower bound of |D| (K39) and upper bound of |u·w| over lower <= (θ1, θ5) <= upper (N, 2), both (N,), m².

        NaN where it is not proved that the chain assembles throughout, or something given is not finite.

        |s|² = d² + a_L² + a_R² + 2 a_L d sin θ1 − 2 a_R d sin θ5 − 2 a_L a_R cos(θ5 − θ1)                 (K37)

        is taken at the middle of the range, with its gradient g there and a bound H of its second derivatives. With
        half widths r of the range (K38):

            ||s|² − |s|²(middle)| ≤ |g|·r + r·H r/2,     H = |2 a_L d + 2 a_L a_R        2 a_L a_R       |
                                                             |      2 a_L a_R      2 a_R d + 2 a_L a_R |
        """
        d, (al, ar), (bl, br) = self.separation, self.cranks, self.couplers
        r = (upper - lower) / 2
        q = lower + r
        theta1, theta5, r1, r5 = q[:, 0], q[:, 1], r[:, 0], r[:, 1]
        sine, cosine = np.sin(theta5 - theta1), np.cos(theta5 - theta1)
        square = d * d + al * al + ar * ar + 2 * d * (al * np.sin(theta1) - ar * np.sin(theta5)) - 2 * al * ar * cosine
        g1 = np.abs(2 * al * d * np.cos(theta1) - 2 * al * ar * sine)
        g5 = np.abs(2 * ar * d * np.cos(theta5) - 2 * al * ar * sine)
        off = g1 * r1 + g5 * r5 + d * (al * r1 * r1 + ar * r5 * r5) + al * ar * (r1 + r5) ** 2
        off += ROUNDING * (d + al + ar + bl + br) ** 2
        low, high = square - off, square + off
        outer, inner = (bl + br) ** 2, (bl - br) ** 2
        proved = (r1 >= 0) & (r5 >= 0) & (low > inner) & (high < outer)
        # (outer − x)(x − inner) is concave in x: it is least at an end of its range.
        product = np.minimum((outer - low) * (low - inner), (outer - high) * (high - inner))
        cross = 0.5 * np.sqrt(np.where(proved, product, np.nan)) * (1 - ROUNDING)
        middle = bl * bl + br * br
        along = 0.5 * np.maximum(np.abs(low - middle), np.abs(high - middle))
        return cross, np.where(proved, along, np.nan)

    def keeps(self, lower: FloatArray, upper: FloatArray, margin: float) -> BoolArray:
        """Whether (N,) the parallel margin is proved to be `margin` at least over the ranges (N, 2)."""
        return np.asarray(self.least(lower, upper)[0] >= margin * self.couplers[0] * self.couplers[1])

    def passive(self, lower: FloatArray, upper: FloatArray, rate: FloatArray, rate_d: FloatArray) -> Passive:
        """Bounds of the couplers' motion over ranges (N, 2) where |θ̇1|, |θ̇5| <= `rate`, |θ̈1|, |θ̈5| <= `rate_d` (N, 2).

        Infinite where `least` proves nothing.

            |φ̇_L| ≤ b_R V/|D|        |φ̇_R| ≤ b_L V/|D|        V = Σ a |θ̇|                                (K40)
            |φ̈_L| ≤ (b_R A + c φ̇_L² + b_R² φ̇_R²)/|D|    |φ̈_R| ≤ (b_L A + b_L² φ̇_L² + c φ̇_R²)/|D|       (K41)

        with c ≥ |u·w| and A = Σ a √(θ̈² + θ̇⁴): K4 and K5 term by term, the right coupler being −w.
        """
        cross, along = self.least(lower, upper)
        bl, br = self.couplers
        speed = rate @ np.array(self.cranks)
        push = np.hypot(rate_d, rate * rate) @ np.array(self.cranks)
        left, right = br * speed / cross, bl * speed / cross
        left_d = (br * push + along * left**2 + br * br * right**2) / cross
        right_d = (bl * push + bl * bl * left**2 + along * right**2) / cross
        return Passive(*(np.where(x >= 0, x, np.inf) for x in (left, left_d, right, right_d)))

    def type_2_curves(self, many: int) -> tuple[FloatArray, ...]:
        """Where the tool axis can be at type 2: curves (many, 2), m, base axes, NaN where there is no such point.

        Couplers in one line are one link of length b_L + b_R or |b_L − b_R| between the cranks: a four-bar, whose
        tool axis is followed over a turn of the left crank, on both of its branches.
        """
        (al, ar), (bl, br) = self.cranks, self.couplers
        theta = np.linspace(-math.pi, math.pi, many)
        x, y = al * np.cos(theta), self.separation / 2 + al * np.sin(theta)
        found = []
        for bar, share in ((bl + br, bl), (abs(bl - br), math.copysign(bl, bl - br))):
            if bar >= SMALLEST_M:
                for branch in (LEFT, RIGHT):
                    ux, uy = RRR(bar, ar).solve(branch, (-x, -self.separation / 2 - y)).u
                    found.append(np.stack([x + share / bar * ux, y + share / bar * uy], -1))
            else:
                # Equal couplers fold where the elbows meet; the tool axis is then anywhere around them.
                meet = RRR(al, ar).solve(LEFT, (np.zeros(1), np.full(1, -self.separation)))
                for side in (1.0, -1.0):
                    centre = np.array([side * meet.u[0][0], self.separation / 2 + meet.u[1][0]])
                    found.append(centre + bl * np.stack([np.cos(theta), np.sin(theta)], -1))
        return tuple(found)


def _turning(length: float, angle: tuple[FloatArray, ...]) -> list[Planar]:
    """An arm at an angle with up to three derivatives, and as many derivatives of it (K12)."""
    x, y = length * np.cos(angle[0]), length * np.sin(angle[0])
    found: list[Planar] = [(x, y)]
    if len(angle) > 1:
        w = angle[1]
        found.append((-w * y, w * x))
    if len(angle) > 2:
        dw, square = angle[2], w * w
        found.append((-dw * y - square * x, dw * x - square * y))
    if len(angle) > 3:
        jerk, mixed = angle[3] - w * square, 3.0 * w * dw
        found.append((-jerk * y - mixed * x, jerk * x - mixed * y))
    return found
