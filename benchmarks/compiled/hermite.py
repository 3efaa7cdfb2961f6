"""Kernels: Bernstein and power coefficients of quintic Hermite pieces (T1, T2), and values of a trajectory."""

from __future__ import annotations

import numpy as np

from benchmarks.compiled.curves import derivative, piece
from benchmarks.compiled.door import kernel
from planner.arrays import FloatArray


@kernel
def hulls(
    h: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """`trajectory.hermite.hulls`."""
    many, n = len(h), q.shape[1]
    b0, b1 = np.empty((many, n, 6)), np.empty((many, n, 5))
    b2, b3 = np.empty((many, n, 4)), np.empty((many, n, 3))
    for p in range(many):
        s = h[p]
        for j in range(n):
            q0, q1, v0, v1 = q[p, j], q[p + 1, j], qd[p, j], qd[p + 1, j]
            a0, a1, sq = qdd[p, j], qdd[p + 1, j], s * s / 20
            b0[p, j, 0], b0[p, j, 1], b0[p, j, 2] = q0, q0 + s * v0 / 5, q0 + 2 * s * v0 / 5 + sq * a0
            b0[p, j, 3], b0[p, j, 4], b0[p, j, 5] = q1 - 2 * s * v1 / 5 + sq * a1, q1 - s * v1 / 5, q1
            b1[p, j, 0], b1[p, j, 1], b1[p, j, 3], b1[p, j, 4] = v0, v0 + s * a0 / 4, v1 - s * a1 / 4, v1
            b1[p, j, 2] = 5 * (q1 - q0) / s - 2 * (v0 + v1) + s * (a1 - a0) / 4
            b2[p, j, 0], b2[p, j, 3] = a0, a1
            b2[p, j, 1] = 4 * (b1[p, j, 2] - b1[p, j, 1]) / s
            b2[p, j, 2] = 4 * (b1[p, j, 3] - b1[p, j, 2]) / s
            for i in range(3):
                b3[p, j, i] = 3 * (b2[p, j, i + 1] - b2[p, j, i]) / s
    return b0, b1, b2, b3


@kernel
def powers(h: FloatArray, q: FloatArray, qd: FloatArray, acceleration: FloatArray, jerk: FloatArray) -> FloatArray:
    """`trajectory.hermite.powers`."""
    c = np.empty((len(h), q.shape[1], 6))
    for p in range(len(h)):
        s = h[p]
        for j in range(q.shape[1]):
            j0, j1, j2 = jerk[p, j, 0], jerk[p, j, 1], jerk[p, j, 2]
            c[p, j, 0], c[p, j, 1], c[p, j, 2] = q[p, j], qd[p, j], acceleration[p, j, 0] / 2
            c[p, j, 3], c[p, j, 4], c[p, j, 5] = j0 / 6, (j1 - j0) / (12 * s), (j0 - 2 * j1 + j2) / (60 * s * s)
    return c


@kernel
def values(edges: FloatArray, c: FloatArray, ends: FloatArray, t: FloatArray, order: int) -> FloatArray:
    """`Trajectory.evaluate` at times t (T,); `ends` (3, n): q, q̇, q̈ of the last knot."""
    out = np.empty((len(t), c.shape[1]))
    for i in range(len(t)):
        if not edges[0] <= t[i] <= edges[-1]:
            out[i] = np.nan
        elif t[i] == edges[-1] and order < 3:
            out[i] = ends[order]
        else:
            k = piece(edges, t[i])
            for j in range(c.shape[1]):
                out[i, j] = derivative(c, k, j, order, t[i] - edges[k])
    return out
