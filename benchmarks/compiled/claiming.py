"""Kernels: one round of a proof, from placed units to the best claim of every row, and the halves of the next round."""

from __future__ import annotations

import numpy as np

from benchmarks.compiled.bounding import bound
from benchmarks.compiled.door import kernel
from benchmarks.compiled.separating import faces, gap, least, put, towards
from planner.arrays import FloatArray, IntArray

RATES = 4
"""Rows of the rate matrix of a SCARA."""
PROVED, CLOSER, OPEN = 0, 1, 2
"""Proved by the first normals; by face normals, looked at because the first ones did not part the pair; not proved."""


@kernel
def judge(
    claim: FloatArray,
    arm: FloatArray,
    laws: FloatArray,
    number: IntArray,
    table: FloatArray,
    vertices: FloatArray,
    i: int,
    j: int,
    ones: FloatArray,
    others: FloatArray,
    normals: FloatArray,
    count: int,
    t0: float,
    t1: float,
    rate: FloatArray,
    rate_d: FloatArray,
    required: float,
) -> None:
    """The best of the first `count` normals into claim: normal, gaps, speed, acceleration, least, and what it is worth.

    Placed units at start, middle and end are rows of `ones` and `others` (3, 12)."""
    h = t1 - t0
    claim[9] = -np.inf
    for k in range(count):
        x, y, z = normals[k, 0], normals[k, 1], normals[k, 2]
        gap0 = gap(number, table, vertices, i, ones[0], j, others[0], x, y, z)
        gap_mid = gap(number, table, vertices, i, ones[1], j, others[1], x, y, z)
        gap1 = gap(number, table, vertices, i, ones[2], j, others[2], x, y, z)
        v, m = bound(arm, laws, number[i, 0], table[i, 17], x, y, z, t0, t1, rate, rate_d)
        v_b, m_b = bound(arm, laws, number[j, 0], table[j, 17], x, y, z, t0, t1, rate, rate_d)
        v, m = v + v_b, m + m_b
        first, second = (gap0 + gap1 - v * h) / 2, least(gap0, gap1) - m * h**2 / 8
        worst = first if (first >= second or second != second) else second
        worth = worst - required
        if k == 0 or worth > claim[9]:
            claim[0], claim[1], claim[2] = x, y, z
            claim[3], claim[4], claim[5], claim[6], claim[7], claim[8] = gap0, gap_mid, gap1, v, m, worst
            claim[9] = -np.inf if worth != worth else worth


@kernel
def judged(
    where: tuple[FloatArray, FloatArray],
    bounds: FloatArray,
    arm: FloatArray,
    laws: FloatArray,
    number: IntArray,
    table: FloatArray,
    vertices: FloatArray,
    t0: FloatArray,
    t1: FloatArray,
    row: IntArray,
    a: IntArray,
    b: IntArray,
    seed: FloatArray,
    required: float,
    slack: float,
    vertical: bool,
) -> tuple[FloatArray, IntArray]:
    """Claims (R, 10) and what became of the rows (R,); `vertical`: along the vertical alone."""
    position, rotation = where
    size, count, m = len(t0), len(table), RATES
    at, there = np.empty((3 * size, count, 12)), np.zeros((3 * size, count), dtype=np.bool_)
    claims, stage = np.empty((len(row), 10)), np.empty(len(row), dtype=np.int64)
    ones, others = np.empty((3, 12)), np.empty((3, 12))
    n, second = np.empty((6, 3)), np.empty(10)
    rate, rate_d = np.empty(m), np.empty(m)
    for r in range(len(row)):
        s, i, j = row[r], a[r], b[r]
        for k in range(3):
            t = s + k * size
            for u in (i, j):
                if not there[t, u]:
                    put(position, rotation, t, number, table, u, at[t, u])
                    there[t, u] = True
            ones[k], others[k] = at[t, i], at[t, j]
        rate[:], rate_d[:] = bounds[s, :m], bounds[s, m : 2 * m]
        if vertical:
            n[0, 0] = n[0, 1] = 0.0
            n[0, 2] = 1.0 if others[1, 2] >= ones[1, 2] else -1.0
        else:
            towards(table, i, ones[1], j, others[1], n)
            n[2] = seed[r]
        claim = claims[r]
        judge(
            claim, arm, laws, number, table, vertices, i, j, ones, others,
            n, 1 if vertical else 3, t0[s], t1[s], rate, rate_d, required,
        )  # fmt: skip
        stage[r] = OPEN
        if claim[8] - slack >= required:
            stage[r] = PROVED
        elif not vertical and not claim[4] - slack > required:
            faces(ones[1], others[1], n)
            judge(
                second, arm, laws, number, table, vertices, i, j, ones, others,
                n, 6, t0[s], t1[s], rate, rate_d, required,
            )  # fmt: skip
            if not claim[8] - required >= second[8] - required:
                claim[:] = second
            if claim[8] - slack >= required:
                stage[r] = CLOSER
    return claims, stage


@kernel
def halved(
    t0: FloatArray, t1: FloatArray, row: IntArray, a: IntArray, b: IntArray, normal: FloatArray
) -> tuple[FloatArray, FloatArray, IntArray, IntArray, IntArray, FloatArray]:
    """The next round: every interval that is still asked for in two."""
    place, count = np.full(len(t0), -1), 0
    for s in row:
        place[s] = 0
    for s in range(len(t0)):
        if place[s] == 0:
            place[s] = count
            count += 1
    many = len(row)
    new0, new1 = np.empty(2 * count), np.empty(2 * count)
    rows, firsts, seconds = np.empty(2 * many, np.int64), np.empty(2 * many, np.int64), np.empty(2 * many, np.int64)
    normals = np.empty((2 * many, 3))
    for s in range(len(t0)):
        k = place[s]
        if k >= 0:
            middle = (t0[s] + t1[s]) / 2
            new0[k], new1[k], new0[count + k], new1[count + k] = t0[s], middle, middle, t1[s]
    for r in range(many):
        for half in range(2):
            k = half * many + r
            rows[k], firsts[k], seconds[k] = place[row[r]] + half * count, a[r], b[r]
            normals[k] = normal[r]
    return new0, new1, rows, firsts, seconds, normals
