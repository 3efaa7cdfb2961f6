"""Knots rounded so that short pieces keep their jerk.

A knot's time and position are doubles. Near q = 3 rad a position is off by up to 2.2e-16, and a time near 5 s by
4.4e-16 s, which at 5 rad/s is 2.2e-15 rad. Over a piece of length h that is a jerk of 60/h³ times as much: 1e5 rad/s³
at h = 10 µs. Two remedies, both below 1e-9 rad/s:

1. States belong to the rounded time, not to the wanted one (`moved`).
2. A constant jerk obeys (equation T3)   q1 − q0 = h (q̇0 + q̇1)/2 − h² (q̈1 − q̈0)/12.   What rounding leaves over, r, is
   taken up by the velocities at both ends of the piece, u = r/h each (`settled`): the velocity is the only quantity
   whose change is felt as 1/h² and not as 1/h³. A knot between two pieces serves the shorter first: weight h⁻³. The
   first and last knot stay as they are; the knot next to them takes 3r/h in velocity and ∓6r/h² in acceleration, which
   leaves the piece with a jerk off by 6r/h³, constant, and no better is possible.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.trajectory.hermite import rate_hulls


def defect(h: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray) -> FloatArray:
    """What the positions of each piece's ends have over equation T3, (K-1, n)."""
    h = h[:, None]
    return np.asarray((q[1:] - q[:-1]) - h * (qd[1:] + qd[:-1]) / 2 + h * h * (qdd[1:] - qdd[:-1]) / 12)


def settled(h: FloatArray, qd: FloatArray, qdd: FloatArray, left_over: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Velocities and accelerations (K, n) that take up the position defects `left_over` (K-1, n); the ends stay.

    With fewer than three pieces both ends of a piece are given: nothing is changed.
    """
    if len(h) < 3:
        return qd, qdd
    u = left_over / h[:, None]
    u[0] *= 3
    u[-1] *= 3
    weight = (h.min() / h[:, None]) ** 3
    share = weight[:-1] / (weight[:-1] + weight[1:])
    qd, qdd = qd.copy(), qdd.copy()
    qd[1:-1] += u[:-1] * share + u[1:] * (1 - share)
    qdd[1] += share[0] * 2 * u[0] / h[0]
    qdd[-2] -= (1 - share[-1]) * 2 * u[-1] / h[-1]
    return qd, qdd


def relaxed(
    h: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray, jerk: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Velocities and accelerations (K, n) with which every piece comes as near as possible to its `jerk` (K-1, n).

    Least squares over the Bernstein coefficients of the jerk of all pieces at once, linear in the velocities and
    accelerations of the inner knots; positions and both ends stay. For knots so crowded that `settled`, which sees one
    piece at a time, moves the trouble from one to the next. A thousand times slower.
    """
    size = len(h)
    if size < 2:
        return qd, qdd
    # Rows of T2 for a piece: coefficients of the jerk from q̇0, q̈0, q̇1, q̈1, each in units of its own order of h.
    piece = np.array([[-36, -9, -24, 3], [60, 9, 60, -9], [-24, -3, -36, 9]]) / 1.0
    order = np.array([2, 1, 2, 1])
    matrix = np.zeros((size, 3, size + 1, 2))
    scale = np.minimum(np.append(h, np.inf), np.append(np.inf, h))
    for k, length in enumerate(h):
        matrix[k, :, k : k + 2] = (piece / length**order).reshape(3, 2, 2)
    matrix *= np.stack([scale**2, scale], -1)
    gap = jerk[:, None] - np.moveaxis(rate_hulls(h, q, qd, qdd)[2], -1, 1)
    inner = matrix[:, :, 1:-1].reshape(3 * size, 2 * (size - 1))
    change = np.linalg.lstsq(inner, gap.reshape(3 * size, -1), rcond=None)[0].reshape(size - 1, 2, -1)
    qd, qdd = qd.copy(), qdd.copy()
    qd[1:-1] += change[:, 0] * (scale**2)[1:-1, None]
    qdd[1:-1] += change[:, 1] * scale[1:-1, None]
    return qd, qdd


def moved(time: FloatArray, by: float) -> tuple[FloatArray, FloatArray]:
    """`time + by` rounded, and what rounding took off it: time + by = moved + rest exactly (Knuth's two-sum)."""
    total = time + by
    part = total - time
    return total, (time - (total - part)) + (by - part)
