"""The RRR dyad: two links and three parallel revolute joints, in vector form, from position to jerk.

Link 1 runs from A to C, link 2 from C to B; A and B are given with their motion, C is sought. Everything is in one
plane and only differences count: u = C − A, w = B − C, d = B − A = u + w. × is the planar cross product (a scalar),
⊥ a quarter turn to the left. Equations K1 to K6 of docs/kinematics.md:

    k = (|d|² + l₁² − l₂²)/2      h = ½ σ √((l₁+l₂)² − |d|²)(|d|² − (l₁−l₂)²)                          (K1)
    u = (k d + h d⊥)/|d|²         w = d − u                                                            (K2)
    D = u × w = −h = l₁ l₂ sin θ₂                                                                      (K3)
    ω₁ = (ḋ·w)/D                  ω₂ = −(ḋ·u)/D                                                        (K4)
    α₁ = (a·w)/D                  α₂ = −(a·u)/D          a = d̈ + ω₁² u + ω₂² w                         (K5)
    α̇₁ = (b·w)/D                  α̇₂ = −(b·u)/D          b = d⃛ + 3ω₁α₁ u + ω₁³ u⊥ + 3ω₂α₂ w + ω₂³ w⊥  (K6)

Source: 000 of Noriega, García and Muñiz, eq. 1 to 10, of which this is another form with one order more.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray, IntArray
from assur.planner.assur.codes import Code
from assur.planner.errors import FaultError, InputError
from assur.planner.geometry.shapes import LARGEST_M, SMALLEST_M

LEFT = 1
"""σ of assembly mode 1: C to the left of A→B, θ₂ < 0."""
RIGHT = -1
"""σ of assembly mode 2: C to the right of A→B, θ₂ > 0."""

ROUNDING = 1e-12
"""How far |d| may be from l₁ + l₂ or |l₁ − l₂| and still count as equal, as a share of l₁ + l₂ (no unit).

Rounding alone sends a third of exactly stretched targets out of reach. A target that is stored in world coordinates
100 times as large as the arm is wrong by 100 × 2.2e-16; 1e-12 is above that, and is less than a picometre on any arm.
Just outside the band |sin θ₂| is above 2e-6, where D still has three good digits.
"""

BLOCK = 4096
"""Points solved at once: some 30 arrays of 32 kB are alive in a block, which stays in an L2 cache of 1 MB."""

Planar = tuple[FloatArray, FloatArray]
"""x and y of vectors, each (...)."""

N = TypeVar("N", float, FloatArray)


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
    _bounds: tuple[float, float, float, float] = field(init=False, repr=False, compare=False)
    """Squares of |d|: out of reach below the first; assembled strictly between second and third; out above the last."""

    def __post_init__(self) -> None:
        for name in ("l1", "l2"):
            if not SMALLEST_M <= getattr(self, name) <= LARGEST_M:
                raise InputError(name, getattr(self, name), f"a length from {SMALLEST_M} to {LARGEST_M} m")
            # A NumPy scalar would make a single target slow, and would warn where a float does not.
            object.__setattr__(self, name, float(getattr(self, name)))
        outer, inner = self.l1 + self.l2, abs(self.l1 - self.l2)
        slack = ROUNDING * outer
        edges = (max(inner - slack, 0.0), inner + slack, outer - slack, outer + slack)
        object.__setattr__(self, "_bounds", tuple(edge * edge for edge in edges))

    def solve(self, sigma: int, d: Planar, *derivatives: Planar) -> Assembly:
        """The assembly with `sigma` (LEFT or RIGHT) for `d` = B − A (m) and up to three time derivatives of d.

        Only the orders given are solved: with `d` alone it is the position. All arrays have one shape (...), a single
        target being of any shape with one element. Rows are independent, and the same to the bit in any batch.

        Degenerate rows (docs/kinematics.md, table of cases): stretched and folded rows have `u`, `w`, on the line AB,
        and a margin of 0, but NaN rates; out of reach, indeterminate and non-finite rows are NaN throughout.
        No row raises or warns. Raises `FaultError` for a sigma, a number of derivatives or shapes that are wrong.
        Not checked: that the motion came from the same mode before.
        """
        if sigma not in (LEFT, RIGHT) or len(derivatives) > 3:
            raise FaultError(f"RRR: sigma {sigma} with {len(derivatives)} derivatives")
        given = [np.asarray(x, dtype=np.float64) for pair in (d, *derivatives) for x in pair]
        shape = given[0].shape
        for x in given:
            if x.shape != shape:
                raise FaultError(f"RRR: shapes {shape} and {x.shape}")
        rows = 6 + 2 * len(derivatives)
        if given[0].size == 1:
            single = self._single(sigma, [x.item() for x in given])
            if single is not None:
                values, kind = single
                return _assembly(np.array(values).reshape(rows, *shape), np.full(shape, int(kind)))
        size = given[0].size
        out, code = np.empty((rows, size)), np.empty(size, np.int64)
        flat = [x.reshape(size) for x in given]
        with np.errstate(all="ignore"):
            # Rows that are not finite overflow here and are refused below, by value and not by flag.
            for i in range(0, size, BLOCK):
                block = slice(i, i + BLOCK)
                self._block(sigma, [x[block] for x in flat], out[:, block], code[block])
        return _assembly(out.reshape(rows, *shape), code.reshape(shape))

    def _single(self, sigma: int, given: list[float]) -> tuple[list[float], Code] | None:
        """One target in plain floats, ten times faster than in arrays of one; None: at an edge, ask `_block`."""
        dx, dy = given[0], given[1]
        square = dx * dx + dy * dy
        under, low, high, over = self._bounds
        if low < square < high:
            rows = self._rows(sigma, given, square, math.sqrt)
            return (rows, Code.ASSEMBLED) if math.isfinite(sum(rows[5:])) else None
        if under <= square <= over:
            return None
        return [math.nan] * (4 + len(given)), Code.OUT_OF_REACH

    def _block(self, sigma: int, given: list[FloatArray], out: FloatArray, code: IntArray) -> None:
        """Solve one block into `out` (rows, size) and `code` (size)."""
        dx, dy = given[0], given[1]
        square = dx * dx + dy * dy
        assembled = (self._bounds[1] < square) & (square < self._bounds[2])
        if not assembled.all():
            square = np.where(assembled, square, np.nan)
        rows = self._rows(sigma, given, square, np.sqrt)
        for target, row in zip(out, rows, strict=True):
            target[:] = row
        total = rows[5]
        for row in rows[6:]:
            total = total + row
        # NaN and infinity survive any sum, so one test covers all rates.
        assembled = np.isfinite(total)
        code[:] = Code.ASSEMBLED
        if not assembled.all():
            bad = ~assembled
            out[:, bad], code[bad] = self._degenerate(sigma, [x[bad] for x in given])

    def _rows(self, sigma: int, given: list[N], square: N, root: Callable[[N], N]) -> list[N]:
        """K1 to K6 for floats or arrays alike: u, w, D, margin, then the rates, order by order."""
        l1, l2 = self.l1, self.l2
        dx, dy = given[0], given[1]
        h = 0.5 * sigma * root(((l1 + l2) * (l1 + l2) - square) * (square - (l1 - l2) * (l1 - l2)))  # K1
        along = 0.5 * (square + (l1 - l2) * (l1 + l2)) / square
        across = h / square
        ux, uy = along * dx - across * dy, along * dy + across * dx  # K2
        wx, wy = dx - ux, dy - uy
        rows = [ux, uy, wx, wy, -h, abs(h) * (1.0 / (l1 * l2))]  # K3
        if len(given) > 2:
            inverse = -1.0 / h
            w1, w2 = _across(given[2], given[3], ux, uy, wx, wy, inverse)  # K4
            rows += [w1, w2]
        if len(given) > 4:
            s1, s2 = w1 * w1, w2 * w2
            a1, a2 = _across(given[4] + s1 * ux + s2 * wx, given[5] + s1 * uy + s2 * wy, ux, uy, wx, wy, inverse)  # K5
            rows += [a1, a2]
        if len(given) > 6:
            m1, m2, c1, c2 = 3.0 * w1 * a1, 3.0 * w2 * a2, s1 * w1, s2 * w2
            bx = given[6] + m1 * ux - c1 * uy + m2 * wx - c2 * wy
            by = given[7] + m1 * uy + c1 * ux + m2 * wy + c2 * wx
            rows += _across(bx, by, ux, uy, wx, wy, inverse)  # K6
        return rows

    def _degenerate(self, sigma: int, given: list[FloatArray]) -> tuple[FloatArray, IntArray]:
        """Rows and codes of what is not assembled: the table of cases, K7."""
        dx, dy = given[0], given[1]
        under, low, high, over = self._bounds
        square = dx * dx + dy * dy
        near = (under <= square) & (square <= over)
        if not near.any():
            return np.full((4 + len(given), dx.size), np.nan), np.full(dx.shape, int(Code.OUT_OF_REACH))
        finite = np.isfinite(np.stack(given)).all(0)
        stretched = finite & (high <= square) & (square <= over)
        small = square <= (ROUNDING * (self.l1 + self.l2)) ** 2
        folded = finite & (under <= square) & (square <= low) & ~small
        loose = finite & small & (under <= square)
        code = np.full(dx.shape, int(Code.OUT_OF_REACH))
        code[stretched], code[folded], code[loose] = Code.STRETCHED, Code.FOLDED, Code.INDETERMINATE
        out = np.full((4 + len(given), dx.size), np.nan)
        line: BoolArray = stretched | folded
        # K8: link 1 lies along AB, against it when a folded arm has the longer second link.
        unit = np.where(stretched | (self.l1 > self.l2), self.l1, -self.l1)[line] / np.sqrt(square[line])
        out[0, line], out[1, line] = unit * dx[line], unit * dy[line]
        out[2, line], out[3, line] = dx[line] - out[0, line], dy[line] - out[1, line]
        out[4, line], out[5, line] = -0.0 * sigma, 0.0  # the sign keeps θ₂ = −π left and +π right when folded
        return out, code


def _across(vx: N, vy: N, ux: N, uy: N, wx: N, wy: N, inverse: N) -> tuple[N, N]:
    """(v·w)/D and −(v·u)/D with `inverse` = 1/D: the two rates that move C's neighbours by v."""
    return (vx * wx + vy * wy) * inverse, -(vx * ux + vy * uy) * inverse


def _assembly(rows: FloatArray, code: IntArray) -> Assembly:
    ux, uy, wx, wy, cross, margin, *rates = (rows[i, ...] for i in range(len(rows)))
    return Assembly((ux, uy), (wx, wy), cross, margin, tuple(zip(rates[::2], rates[1::2], strict=True)), code)
