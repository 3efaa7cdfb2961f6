"""The two dyads that every arm here is made of, RRR and RPR, one target at a time, from position to jerk.

The RRR dyad: link 1 runs from A to C, link 2 from C to B; d = B − A is given with its motion, u = C − A and w = B − C
are sought. Everything is in one plane; × is the planar cross product, ⊥ a quarter turn to the left.

    k = (|d|² + l₁² − l₂²)/2      h = ½ σ √((l₁+l₂)² − |d|²)(|d|² − (l₁−l₂)²)                          (K1)
    u = (k d + h d⊥)/|d|²         w = d − u                                                            (K2)
    D = u × w = −h = l₁ l₂ sin θ₂                                                                      (K3)
    ω₁ = (ḋ·w)/D                  ω₂ = −(ḋ·u)/D                                                        (K4)
    α₁ = (a·w)/D                  α₂ = −(a·u)/D          a = d̈ + ω₁² u + ω₂² w                         (K5)
    α̇₁ = (b·w)/D                  α̇₂ = −(b·u)/D          b = d⃛ + 3ω₁α₁ u + ω₁³ u⊥ + 3ω₂α₂ w + ω₂³ w⊥  (K6)

The RPR dyad: a slider between two revolute joints; angle θ and length l of the line from A to B are sought. With
e = d/l and e⊥:

    l = s |d|        θ = ∠(s d)                                                                        (K19)
    l̇ = e·ḋ          θ̇ = e⊥·ḋ/l                                                                       (K20)
    l̈ = e·d̈ + l θ̇²   θ̈ = (e⊥·d̈ − 2 l̇ θ̇)/l                                                           (K21)
    l⃛ = e·d⃛ + 3 l̇ θ̇² + 3 l θ̇ θ̈    θ⃛ = (e⊥·d⃛ − 3 l̇ θ̈ − 3 l̈ θ̇ + l θ̇³)/l                              (K22)

Sources: 000 of Noriega, García and Muñiz; K1 to K6 and K19 to K22 are another form of it with one order more.
"""

from __future__ import annotations

import math

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.compiled import kernel

LEFT = 1
"""σ of assembly mode 1: C to the left of A→B, θ₂ < 0."""
RIGHT = -1
"""σ of assembly mode 2: C to the right of A→B, θ₂ > 0."""

ASSEMBLED, OUT_OF_REACH, STRETCHED, FOLDED, INDETERMINATE, ALIGNED, PARALLEL = range(7)
"""How a solution came out: numbers of `assur.planner.robots.facts.Code`."""

ROUNDING = 1e-12
"""How far |d| may be from l₁ + l₂ or |l₁ − l₂| and still count as equal, as a share of l₁ + l₂ (no unit).

Rounding alone sends a third of exactly stretched targets out of reach. A target that is stored in world coordinates
100 times as large as the arm is wrong by 100 × 2.2e-16; 1e-12 is above that, and is less than a picometre on any arm.
Just outside the band |sin θ₂| is above 2e-6, where D still has three good digits.
"""

UX, UY, WX, WY, CROSS, MARGIN = range(6)
"""Columns of a solved RRR dyad: u, w, m; D = u × w, m²; |sin θ₂|."""
RATES = 6
"""Then, for each derivative that is given, its pair for links 1 and 2 of their absolute angles."""
RRR_COLUMNS = 12
WORK_ROWS = 8
"""Rows of the room (8, 12) that motions work in: the orders of d, then solved dyads."""
SOLVED = 4
"""First row of that room that is for a solved dyad."""
ANGLE, LENGTH = 0, 1
"""Columns of a solved RPR dyad: θ in (−π, π], rad, and l, m; then the pair of each derivative."""
RPR_COLUMNS = 8


@kernel("void(float64[::1], float64)")
def fill(row: FloatArray, value: float) -> None:
    """Sets every number of a row."""
    for i in range(len(row)):
        row[i] = value


@kernel("void(float64[:, ::1], int64, int64, float64)")
def fill_rows(table: FloatArray, begin: int, end: int, value: float) -> None:
    """Sets every number of the rows from `begin` to before `end`."""
    for k in range(begin, end):
        for i in range(table.shape[1]):
            table[k, i] = value


@kernel("int64(float64, float64, float64, float64[:, ::1], int64, float64[::1])")
def rrr(l1: float, l2: float, sigma: float, d: FloatArray, order: int, out: FloatArray) -> int:
    """Fills `out` (12,) with the assembly `sigma` for `d` (4, 2) with derivatives up to `order`; returns its code.

    Degenerate targets: stretched and folded ones have u and w, on the line AB, and a margin of 0, but NaN rates (K7,
    K8); out of reach, indeterminate, and targets that are not finite, are NaN throughout. So are rates above `order`.
    """
    fill(out, math.nan)
    dx, dy = d[0, 0], d[0, 1]
    square = dx * dx + dy * dy
    outer, inner = l1 + l2, abs(l1 - l2)
    slack = ROUNDING * outer
    under = max(inner - slack, 0.0)
    # comparisons that NaN and infinity fail
    if not (under * under <= square <= (outer + slack) * (outer + slack)):
        return OUT_OF_REACH
    total = 0.0
    for k in range(order + 1):
        total += 0.0 * (d[k, 0] + d[k, 1])  # NaN for what is not finite
    if not math.isfinite(total):
        return OUT_OF_REACH
    within, beyond = inner + slack, outer - slack
    if not within * within < square < beyond * beyond:
        if square <= slack * slack:
            return INDETERMINATE
        stretched = square >= beyond * beyond
        # K8: link 1 lies along AB, against it when a folded arm has the longer second link
        share = (l1 if stretched or l1 > l2 else -l1) / math.sqrt(square)
        out[UX], out[UY] = share * dx, share * dy
        out[WX], out[WY] = dx - out[UX], dy - out[UY]
        # the sign keeps θ₂ = −π left and +π right when folded
        out[CROSS], out[MARGIN] = -0.0 * sigma, 0.0
        return STRETCHED if stretched else FOLDED
    h = 0.5 * sigma * math.sqrt((outer * outer - square) * (square - inner * inner))  # K1
    if h == 0.0:
        return OUT_OF_REACH
    along, across = 0.5 * (square + (l1 - l2) * outer) / square, h / square
    ux, uy = along * dx - across * dy, along * dy + across * dx  # K2
    wx, wy = dx - ux, dy - uy
    out[UX], out[UY], out[WX], out[WY] = ux, uy, wx, wy
    out[CROSS], out[MARGIN] = -h, abs(h) * (1.0 / (l1 * l2))  # K3
    if order > 0:
        inverse = -1.0 / h
        w1 = (d[1, 0] * wx + d[1, 1] * wy) * inverse  # K4
        w2 = -(d[1, 0] * ux + d[1, 1] * uy) * inverse
        out[RATES], out[RATES + 1] = w1, w2
        if order > 1:
            s1, s2 = w1 * w1, w2 * w2
            ax, ay = d[2, 0] + s1 * ux + s2 * wx, d[2, 1] + s1 * uy + s2 * wy
            a1, a2 = (ax * wx + ay * wy) * inverse, -(ax * ux + ay * uy) * inverse  # K5
            out[RATES + 2], out[RATES + 3] = a1, a2
            if order > 2:
                m1, m2, c1, c2 = 3.0 * w1 * a1, 3.0 * w2 * a2, s1 * w1, s2 * w2
                bx = d[3, 0] + m1 * ux - c1 * uy + m2 * wx - c2 * wy
                by = d[3, 1] + m1 * uy + c1 * ux + m2 * wy + c2 * wx
                out[RATES + 4] = (bx * wx + by * wy) * inverse  # K6
                out[RATES + 5] = -(bx * ux + by * uy) * inverse
    for k in range(RATES + 2 * order):
        total += 0.0 * out[k]
    if not math.isfinite(total):
        # rates that overflow
        fill(out, math.nan)
        return OUT_OF_REACH
    return ASSEMBLED


@kernel("int64(float64, float64, float64[:, ::1], int64, float64[::1])")
def rpr(least: float, sign: float, d: FloatArray, order: int, out: FloatArray) -> int:
    """Fills `out` (8 at least) with the assembly `sign` (1: l > 0, −1: l < 0) for `d` (4, 2) up to derivative `order`.

    Returns its code: INDETERMINATE where |d| <= `least`, m, for then the slider may point anywhere. That, and what is
    not finite or overflows (OUT_OF_REACH), is NaN throughout; so are rates above `order`.
    """
    fill(out, math.nan)
    dx, dy = d[0, 0], d[0, 1]
    total = 0.0
    for k in range(order + 1):
        total += 0.0 * (d[k, 0] + d[k, 1])  # NaN for what is not finite
    distance = math.hypot(dx, dy)
    if not math.isfinite(total + distance):
        return OUT_OF_REACH
    if not distance > least:
        return INDETERMINATE
    length = sign * distance
    ex, ey = dx / length, dy / length
    # + 0.0: no negative zero, which would turn the angle of a line along −x into −π
    angle = math.atan2(sign * dy + 0.0, sign * dx + 0.0)
    out[ANGLE], out[LENGTH] = angle, length
    if order > 0:
        grows, turns = ex * d[1, 0] + ey * d[1, 1], (ex * d[1, 1] - ey * d[1, 0]) / length  # K20
        out[2], out[3] = turns, grows
        if order > 1:
            along, across = ex * d[2, 0] + ey * d[2, 1], ex * d[2, 1] - ey * d[2, 0]
            grows_2, turns_2 = along + length * turns * turns, (across - 2.0 * grows * turns) / length  # K21
            out[4], out[5] = turns_2, grows_2
            if order > 2:
                along, across = ex * d[3, 0] + ey * d[3, 1], ex * d[3, 1] - ey * d[3, 0]
                mixed = 3.0 * (grows * turns_2 + grows_2 * turns)
                out[6] = (across - mixed + length * turns * turns * turns) / length  # K22
                out[7] = along + 3.0 * turns * (grows * turns + length * turns_2)
    for k in range(2 + 2 * order):
        total += 0.0 * out[k]
    if not math.isfinite(total):
        fill(out, math.nan)
        return OUT_OF_REACH
    return ASSEMBLED


@kernel("void(float64, float64, float64, float64[:, :, ::1], int64, float64[:, ::1], int64[::1])")
def rrr_rows(l1: float, l2: float, sigma: float, d: FloatArray, order: int, out: FloatArray, codes: IntArray) -> None:
    """`rrr` for each of `d` (N, 4, 2), into `out` (N, 12) and `codes` (N,)."""
    for i in range(len(d)):
        codes[i] = rrr(l1, l2, sigma, d[i], order, out[i])
