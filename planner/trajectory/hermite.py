"""Quintic Hermite pieces: the polynomial of degree five with given q, q̇, q̈ at both of its ends.

With h the length of a piece, s = τ/h in [0, 1], q(s) = Σ b_i B_i⁵(s) has the Bernstein coefficients (equation T1)

    b0 = q0    b1 = q0 + h q̇0/5    b2 = q0 + 2h q̇0/5 + h² q̈0/20
    b5 = q1    b4 = q1 − h q̇1/5    b3 = q1 − 2h q̇1/5 + h² q̈1/20

and the derivatives have (equation T2; δ = (q1 − q0)/h)

    velocity        q̇0,  q̇0 + h q̈0/4,  5δ − 2(q̇0 + q̇1) + h(q̈1 − q̈0)/4,  q̇1 − h q̈1/4,  q̇1
    and from there  c'_i = d (c_{i+1} − c_i)/h,  d the degree.

A polynomial on [0, 1] lies between its smallest and its largest Bernstein coefficient, and takes the first and the
last of them at its ends. T2 starts at the velocity, where q1 − q0 is an exact difference of doubles for short pieces:
differences of T1 would carry the rounding of q into the jerk.

Rounding: q is known to u|q|, u = 2⁻⁵³, so jerk is known to 60·2u|q|/h³ at best. That is a property of the knots, not
of the arithmetic here, and why knots are not set closer than some 10 µs (`assur.planner.kernels.knots`).
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray


def hulls(h: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray) -> tuple[FloatArray, ...]:
    """Bernstein coefficients of position, velocity, acceleration and jerk of every piece, (K-1, n, 6 - derivative).

    `h` (K-1,) lengths of the pieces in s; `q, qd, qdd` (K, n) states at the knots.
    """
    q0, q1 = q[:-1], q[1:]
    length = h[:, None]
    early, late = length * qd[:-1], length * qd[1:]
    square = length * length / 20
    position = np.empty((*q0.shape, 6))
    position[..., 0] = q0
    position[..., 1] = q0 + early / 5
    position[..., 2] = q0 + 2 * early / 5 + square * qdd[:-1]
    position[..., 3] = q1 - 2 * late / 5 + square * qdd[1:]
    position[..., 4] = q1 - late / 5
    position[..., 5] = q1
    return position, *rate_hulls(h, q, qd, qdd)


def rate_hulls(
    h: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Those of velocity, acceleration and jerk."""
    h = h[:, None]
    v0, v1, a0, a1 = qd[:-1], qd[1:], qdd[:-1], qdd[1:]
    velocity, acceleration = np.empty((*v0.shape, 5)), np.empty((*v0.shape, 4))
    velocity[..., 0] = v0
    velocity[..., 1] = v0 + h * a0 / 4
    velocity[..., 2] = 5 * (q[1:] - q[:-1]) / h - 2 * (v0 + v1) + h * (a1 - a0) / 4
    velocity[..., 3] = v1 - h * a1 / 4
    velocity[..., 4] = v1
    acceleration[..., 0], acceleration[..., 3] = a0, a1
    acceleration[..., 1:3] = 4 * (velocity[..., 2:4] - velocity[..., 1:3]) / h[..., None]
    jerk = 3 * (acceleration[..., 1:] - acceleration[..., :-1]) / h[..., None]
    return velocity, acceleration, jerk


def powers(h: FloatArray, q: FloatArray, qd: FloatArray, hull: tuple[FloatArray, ...]) -> FloatArray:
    """Coefficients c0..c5 of q(τ) = Σ c_i τ^i on every piece, (K-1, n, 6), from the knots and their `hulls`.

    c3, c4, c5 come from the Bernstein coefficients of the jerk: q⃛ = j0 + 2(j1 − j0)s + (j0 − 2 j1 + j2)s².
    """
    h = h[:, None]
    acceleration, jerk = hull[2], hull[3]
    j0, j1, j2 = jerk[..., 0], jerk[..., 1], jerk[..., 2]
    c = np.empty((*j0.shape, 6))
    c[..., 0], c[..., 1] = q[:-1], qd[:-1]
    c[..., 2], c[..., 3] = acceleration[..., 0] / 2, j0 / 6
    c[..., 4], c[..., 5] = (j1 - j0) / (12 * h), (j0 - 2 * j1 + j2) / (60 * h * h)
    return c
