"""The checker's own evaluation of the quintic Hermite spline through the knots, in Bernstein form.

Over a piece of length h, with s from 0 to 1, a derivative of degree d is Σ c_i B_i^d(s) (equation V1): it takes c_0 and
c_d at its ends and nowhere leaves [min c, max c]; the part of it over [s0, s1] has control values of its own, by de
Casteljau's cuts, that lie closer. Control values of rates are made from the knots' own rates: differences of positions
would lose them on short pieces. Two knots at one time are no piece.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.jets import F1, F2
from assur.planner.compiled import kernel

JOINTS = 6
"""Joints for which a row of a curve has room."""
ROOM, JOINT = 6, 24
"""Columns for the control values of one derivative, and of a joint: of q, q̇, q̈ and jerk, one after the other."""
COLUMNS = 1 + JOINTS * JOINT
"""Columns of a curve: when its piece begins, then its joints. The last row stands still at the last knot."""
RATE, JERK = 1e-9, 1e-6
"""Relative (of positions: to half the range): what a limit may be exceeded by. Knots on a limit round to 1e-16 beyond
it, and who looks for excess looks for 1e-6. Jerk is a third difference of the knots' numbers: with pieces of 10 µs they
round it to some 1 rad/s³, 1e-4 of a usual limit, which a planner must leave free."""
SHORTEST = 3e-14
"""Of a piece: the ends of such a part cannot be told apart. What is not decided is refused."""


@kernel(f"void({F2}, int64, int64, {F2})")
def curve(knots: FloatArray, n: int, first: int, found: FloatArray) -> None:
    """Rows first, first + 1 ... of `found` (.., COLUMNS) from knots (K, 1 + 3n): times, q, q̇, q̈ side by side."""
    for i in range(len(knots)):
        found[first + i, 0], last = knots[i, 0], min(i + 1, len(knots) - 1)
        h = knots[last, 0] - knots[i, 0]
        for j in range(n):
            c = found[first + i, 1 + JOINT * j : 1 + JOINT * (j + 1)]
            q0, v0, a0 = knots[i, 1 + j], knots[i, 1 + n + j], knots[i, 1 + 2 * n + j]
            q1, v1, a1 = knots[last, 1 + j], knots[last, 1 + n + j], knots[last, 1 + 2 * n + j]
            if not h > 0.0:
                c[:ROOM] = q0
                continue
            c[0], c[1], c[2] = q0, q0 + h * v0 / 5.0, q0 + 2.0 * h * v0 / 5.0 + h * h * a0 / 20.0
            c[3], c[4], c[5] = q1 - 2.0 * h * v1 / 5.0 + h * h * a1 / 20.0, q1 - h * v1 / 5.0, q1
            c[6], c[7], c[9], c[10] = v0, v0 + h * a0 / 4.0, v1 - h * a1 / 4.0, v1
            # the mean of the control values of a rate is the mean rate
            c[8] = 5.0 * (q1 - q0) / h - 2.0 * (v0 + v1) + h * (a1 - a0) / 4.0
            c[12], c[13], c[14], c[15] = a0, 4.0 * (c[8] - c[7]) / h, 4.0 * (c[9] - c[8]) / h, a1
            for k in range(3):
                c[18 + k] = 3.0 * (c[13 + k] - c[12 + k]) / h


@kernel(f"void({F1}, int64, float64, float64)")
def cut(c: FloatArray, degree: int, s0: float, s1: float) -> None:
    """Control values of a polynomial on [0, 1] become those of its part over [s0, s1], 0 <= s0 <= s1 <= 1."""
    if s1 < 1.0:
        for r in range(1, degree + 1):
            for k in range(degree, r - 1, -1):
                c[k] = c[k - 1] + s1 * (c[k] - c[k - 1])
    if s0 == s1:
        for k in range(degree):
            c[k] = c[degree]
    elif s0 > 0.0:
        s = s0 / s1
        for r in range(1, degree + 1):
            for k in range(degree + 1 - r):
                c[k] += s * (c[k + 1] - c[k])


@kernel(f"void({F1}, int64, {F2}, int64, int64)")
def widen(c: FloatArray, degree: int, jets: FloatArray, j: int, order: int) -> None:
    """Widens the bounds of the order-th derivative in jet number j to control values."""
    low, high = jets[j, 2 * order], jets[j, 2 * order + 1]
    for k in range(degree + 1):
        low, high = min(low, c[k]), max(high, c[k])
    jets[j, 2 * order], jets[j, 2 * order + 1] = low, high


@kernel(f"void({F2}, int64, int64, int64, float64, float64, {F2})", allocates=True)
def joints(rows: FloatArray, first: int, last: int, n: int, t0: float, t1: float, found: FloatArray) -> None:
    """Jets (n, 6) over [t0, t1] of the joints of a trajectory, whose curve is rows first to last.

    The arm stands still before and after. At an instant the motion after it counts, at the end the motion before.
    """
    c = np.zeros(ROOM)
    for j in range(n):
        found[j, 0], found[j, 2], found[j, 4] = np.inf, np.inf, np.inf
        found[j, 1], found[j, 3], found[j, 5] = -np.inf, -np.inf, -np.inf
    start, end = rows[first, 0], rows[last, 0]
    for i, stands in ((first, t0 < start), (last, t1 > end)):
        for j in range(n if stands else 0):
            for order in range(3):
                c[0] = rows[i, 1 + JOINT * j] if order == 0 else 0.0
                widen(c, 0, found, j, order)
    if t0 > end or t1 < start:
        return
    i, high = first, last - 1
    while i < high:
        middle = (i + high + 1) // 2
        if rows[middle, 0] <= t0:
            i = middle
        else:
            high = middle - 1
    while i > first and not rows[i + 1, 0] > rows[i, 0]:
        i -= 1
    while i < last and (rows[i, 0] < t1 or rows[i, 0] <= t0):
        h = rows[i + 1, 0] - rows[i, 0]
        if h > 0.0:
            s0 = min(max((t0 - rows[i, 0]) / h, 0.0), 1.0)
            s1 = min(max((t1 - rows[i, 0]) / h, s0), 1.0)
            for j in range(n):
                for order in range(3):
                    at = 1 + JOINT * j + ROOM * order
                    for k in range(ROOM - order):
                        c[k] = rows[i, at + k]
                    if s0 > 0.0 or s1 < 1.0:
                        cut(c, 5 - order, s0, s1)
                    widen(c, 5 - order, found, j, order)
        i += 1


@kernel(f"boolean({F2}, int64, {F2}, int64, {F2}, {F2})", allocates=True)
def excesses(rows: FloatArray, n: int, limits: FloatArray, kinds: int, worst: FloatArray, when: FloatArray) -> bool:
    """Whether each joint keeps its limits at every instant, and by how much it exceeds them, (4, n), s (4, n).

    `limits` (5, n): middle and half of the range, greatest velocity, acceleration and jerk; of the `kinds` first kinds.
    Control values bound a part, and those at its ends are taken: parts are halved until one of both decides.
    """
    stack, where, kept = np.empty((64, ROOM)), np.empty((64, 2)), True
    for i in range(len(rows) - 1):
        h = rows[i + 1, 0] - rows[i, 0]
        for j in range(n if h > 0.0 else 0):
            for kind in range(kinds):
                degree, middle, at = 5 - kind, limits[0, j] if kind == 0 else 0.0, 1 + JOINT * j + ROOM * kind
                allowed = limits[kind + 1, j] * (1.0 + (JERK if kind == 3 else RATE))
                stack[0], where[0, 0], where[0, 1], top = rows[i, at : at + ROOM], 0.0, 1.0, 1
                while top > 0 and not worst[kind, j] > 0.0:
                    top -= 1
                    bound = -np.inf
                    for k in range(degree + 1):
                        over = abs(stack[top, k] - middle) - allowed
                        if not over <= bound:
                            bound = over
                    if bound <= 0.0:
                        continue
                    s0, s1 = where[top, 0], where[top, 1]
                    left, right = abs(stack[top, 0] - middle) - allowed, abs(stack[top, degree] - middle) - allowed
                    if not max(left, right) <= 0.0 or s1 - s0 <= SHORTEST:
                        kept, worst[kind, j] = False, max(left, right) if max(left, right) > 0.0 else bound
                        when[kind, j] = rows[i, 0] + h * (s0 if left >= right else s1)
                        continue
                    stack[top + 1] = stack[top]
                    cut(stack[top], degree, 0.0, 0.5)
                    cut(stack[top + 1], degree, 0.5, 1.0)
                    where[top + 1, 0], where[top + 1, 1], where[top, 1] = (s0 + s1) / 2.0, s1, (s0 + s1) / 2.0
                    top += 2
    return kept
