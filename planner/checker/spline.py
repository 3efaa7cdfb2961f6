"""The checker's own evaluation of the quintic Hermite spline through the knots, in Bernstein form.

Over a piece of length h, with s from 0 to 1, a derivative of degree d is Σ c_i B_i^d(s) (equation V1): it takes c_0 and
c_d at its ends and nowhere leaves [min c, max c]; the part of it over [s0, s1] has control values of its own, by de
Casteljau's cuts, that lie closer. Control values of rates are made from the knots' own rates: differences of positions
would lose them on short pieces. Two knots at one time (parabolic blends) are no piece.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.jets import F1, F2
from assur.planner.compiled import kernel

JOINTS = 6
"""Joints for which a row of the table of knots has room: time, and JOINTS each of q, q̇ and q̈."""
Q, QD, QDD = 1, 1 + JOINTS, 1 + 2 * JOINTS
COLUMNS = 1 + 3 * JOINTS
RATE, JERK = 1e-9, 1e-6
"""Relative (of positions: to half the range): what a limit may be exceeded by. Knots on a limit round to 1e-16 beyond
it, and who looks for excess looks for 1e-6. Jerk is a third difference of the knots' numbers: with pieces of 10 µs they
round it to some 1 rad/s³, 1e-4 of a usual limit, which a planner must leave free."""
SHORTEST = 3e-14
"""Of a piece: the ends of such a part cannot be told apart. What is not decided is refused."""


def table(time: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray) -> FloatArray:
    """Knots (K, COLUMNS) of a trajectory of n joints; the columns of joints that it has not are 0."""
    found, n = np.zeros((len(time), COLUMNS)), q.shape[1]
    found[:, 0], found[:, Q : Q + n], found[:, QD : QD + n], found[:, QDD : QDD + n] = time, q, qd, qdd
    return found


@kernel(f"void({F2}, int64, int64, {F2})")
def controls(knots: FloatArray, i: int, j: int, c: FloatArray) -> None:
    """Control values of q, q̇, q̈ and jerk of joint j between knots i and i + 1 into the rows of c (4, 6)."""
    h = knots[i + 1, 0] - knots[i, 0]
    q0, v0, a0 = knots[i, Q + j], knots[i, QD + j], knots[i, QDD + j]
    q1, v1, a1 = knots[i + 1, Q + j], knots[i + 1, QD + j], knots[i + 1, QDD + j]
    c[0, 0], c[0, 1], c[0, 2] = q0, q0 + h * v0 / 5.0, q0 + 2.0 * h * v0 / 5.0 + h * h * a0 / 20.0
    c[0, 3], c[0, 4], c[0, 5] = q1 - 2.0 * h * v1 / 5.0 + h * h * a1 / 20.0, q1 - h * v1 / 5.0, q1
    c[1, 0], c[1, 1], c[1, 3], c[1, 4] = v0, v0 + h * a0 / 4.0, v1 - h * a1 / 4.0, v1
    # the mean of the control values of a rate is the mean rate
    c[1, 2] = 5.0 * (q1 - q0) / h - 2.0 * (v0 + v1) + h * (a1 - a0) / 4.0
    c[2, 0], c[2, 3] = a0, a1
    for k in range(1, 3):
        c[2, k] = 4.0 * (c[1, k + 1] - c[1, k]) / h
    for k in range(3):
        c[3, k] = 3.0 * (c[2, k + 1] - c[2, k]) / h


@kernel(f"void({F1}, int64, float64, float64)")
def cut(c: FloatArray, degree: int, s0: float, s1: float) -> None:
    """Control values of a polynomial on [0, 1] become those of its part over [s0, s1], 0 <= s0 <= s1 <= 1."""
    if s1 < 1.0:
        for r in range(1, degree + 1):
            for k in range(degree, r - 1, -1):
                c[k] = c[k - 1] + s1 * (c[k] - c[k - 1])
    if s0 > 0.0:
        s = s0 / s1
        for r in range(1, degree + 1):
            for k in range(degree + 1 - r):
                c[k] += s * (c[k + 1] - c[k])


@kernel(f"void({F1}, int64, {F1}, int64)")
def widen(c: FloatArray, degree: int, jet: FloatArray, order: int) -> None:
    """Widens the bounds of the order-th derivative in a jet to control values."""
    for k in range(degree + 1):
        jet[2 * order] = min(jet[2 * order], c[k])
        jet[2 * order + 1] = max(jet[2 * order + 1], c[k])


@kernel(f"void({F2}, int64, int64, int64, float64, float64, {F2}, {F2})")
def joints(
    knots: FloatArray, first: int, last: int, n: int, t0: float, t1: float, c: FloatArray, found: FloatArray
) -> None:
    """Jets (n, 6) over [t0, t1] of the joints of a trajectory, its knots being rows first to last; c (4, 6): work.

    The arm stands still before and after. At an instant the motion after it counts, at the end the motion before.
    """
    for j in range(n):
        found[j, 0], found[j, 2], found[j, 4] = np.inf, np.inf, np.inf
        found[j, 1], found[j, 3], found[j, 5] = -np.inf, -np.inf, -np.inf
    start, end = knots[first, 0], knots[last, 0]
    for i, stands in ((first, t0 < start), (last, t1 > end)):
        if stands:
            for j in range(n):
                found[j, 0], found[j, 1] = min(found[j, 0], knots[i, Q + j]), max(found[j, 1], knots[i, Q + j])
                found[j, 2], found[j, 3] = min(found[j, 2], 0.0), max(found[j, 3], 0.0)
                found[j, 4], found[j, 5] = min(found[j, 4], 0.0), max(found[j, 5], 0.0)
    if t0 > end or t1 < start:
        return
    i = first + int(np.searchsorted(knots[first : last + 1, 0], t0, side="right")) - 1
    i = min(max(first, i), last - 1)
    while i > first and not knots[i + 1, 0] > knots[i, 0]:
        i -= 1
    while i < last and (knots[i, 0] < t1 or knots[i, 0] <= t0):
        h = knots[i + 1, 0] - knots[i, 0]
        if h > 0.0:
            s0 = min(max((t0 - knots[i, 0]) / h, 0.0), 1.0)
            s1 = min(max((t1 - knots[i, 0]) / h, s0), 1.0)
            for j in range(n):
                controls(knots, i, j, c)
                for order in range(3):
                    cut(c[order], 5 - order, s0, s1)
                    widen(c[order], 5 - order, found[j], order)
        i += 1


@kernel(f"void({F2}, int64, {F2}, int64, {F2}, {F2})")
def excesses(knots: FloatArray, n: int, limits: FloatArray, kinds: int, worst: FloatArray, when: FloatArray) -> None:
    """By how much each joint exceeds its limits, (4, n), s (4, n); 0 or less where it keeps them at every instant.

    `limits` (5, n): middle and half of the range, greatest velocity, acceleration and jerk; of the `kinds` first kinds.
    Control values bound a part, and those at its ends are taken: parts are halved until one of both decides.
    """
    c, stack, where = np.empty((4, 6)), np.empty((64, 6)), np.empty((64, 2))
    for i in range(len(knots) - 1):
        h = knots[i + 1, 0] - knots[i, 0]
        for j in range(n if h > 0.0 else 0):
            controls(knots, i, j, c)
            for kind in range(kinds):
                degree, middle = 5 - kind, limits[0, j] if kind == 0 else 0.0
                allowed = limits[kind + 1, j] * (1.0 + (JERK if kind == 3 else RATE))
                stack[0], where[0, 0], where[0, 1], top = c[kind], 0.0, 1.0, 1
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
                        worst[kind, j] = max(left, right) if max(left, right) > 0.0 else bound
                        when[kind, j] = knots[i, 0] + h * (s0 if left >= right else s1)
                        continue
                    stack[top + 1] = stack[top]
                    cut(stack[top], degree, 0.0, 0.5)
                    cut(stack[top + 1], degree, 0.5, 1.0)
                    where[top + 1, 0], where[top + 1, 1], where[top, 1] = (s0 + s1) / 2.0, s1, (s0 + s1) / 2.0
                    top += 2
