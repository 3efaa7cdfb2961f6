"""Kernels: polynomials of a trajectory and of a sketch, and their extremes.

A curve is `edges` (P+1,), `c` (P, n, 6) its coefficients c0..c5 on each piece, and `last` (n,) its last position.
"""

from __future__ import annotations

from math import comb

import numpy as np

from benchmarks.compiled.door import kernel
from benchmarks.compiled.separating import least, most
from planner.arrays import FloatArray

POWERS = np.zeros((6, 6, 6))
"""By degree: from Bernstein coefficients (row vector) to power coefficients."""
for _d in range(1, 6):
    for _i in range(_d + 1):
        for _k in range(_i, _d + 1):
            POWERS[_d, _i, _k] = comb(_d, _k) * comb(_k, _i) * (-1.0) ** (_k - _i)


@kernel
def piece(edges: FloatArray, t: float) -> int:
    """The piece that holds t, the right one at an inner knot."""
    return min(max(int(np.searchsorted(edges, t, side="right")) - 1, 0), len(edges) - 2)


@kernel
def position(edges: FloatArray, c: FloatArray, last: FloatArray, t: float, out: FloatArray) -> None:
    """q (n,) at t, standing before and after."""
    held = least(most(t, edges[0]), edges[-1])
    if held == edges[-1]:
        out[:] = last
        return
    k = piece(edges, held)
    tau = held - edges[k]
    for j in range(c.shape[1]):
        value = c[k, j, 5]
        for i in range(4, -1, -1):
            value = value * tau + c[k, j, i]
        out[j] = value


@kernel
def positions(edges: FloatArray, c: FloatArray, last: FloatArray, t: FloatArray) -> FloatArray:
    """q (T, n) at times t."""
    out = np.empty((len(t), c.shape[1]))
    for i in range(len(t)):
        position(edges, c, last, t[i], out[i])
    return out


@kernel
def derivative(c: FloatArray, k: int, j: int, order: int, tau: float) -> float:
    """A derivative (0 to 3) of joint j on piece k."""
    value = 0.0
    for i in range(5, order - 1, -1):
        factor = 1.0
        for m in range(order):
            factor *= i - m
        value = value * tau + factor * c[k, j, i]
    return value


@kernel
def states(c: FloatArray, k: int, j: int, tau: float) -> tuple[float, float, float]:
    """q, q̇, q̈ of joint j on piece k, in the order of operations of `Trajectory.states_on_piece`."""
    q, v = c[k, j, 5] * tau + c[k, j, 4], c[k, j, 5]
    a = v
    for i in (3, 2, 1, 0):
        if i < 3:
            a = a * tau + v
        v = v * tau + q
        q = q * tau + c[k, j, i]
    return q, v, 2 * a


@kernel
def sketched(begins: FloatArray, rows: FloatArray, duration: float, t: FloatArray) -> FloatArray:
    """`Sketch.positions`: q (T, n) from begins (n, S) and rows (n, 4, S)."""
    out = np.empty((len(t), len(begins)))
    for j in range(len(begins)):
        for i in range(len(t)):
            held = least(most(t[i], 0.0), duration)
            k = -1
            for m in range(begins.shape[1]):
                k += held >= begins[j, m]
            tau = held - begins[j, k]
            out[i, j] = ((rows[j, 3, k] * tau + rows[j, 2, k]) * tau + rows[j, 1, k]) * tau + rows[j, 0, k]
    return out


@kernel
def split(row: FloatArray, s: float, left: FloatArray, right: FloatArray) -> None:
    """De Casteljau: the parts of a row (d+1,) left and right of s."""
    degree = len(row) - 1
    work = row.copy()
    for k in range(degree + 1):
        left[k], right[degree - k] = work[0], work[degree - k]
        for i in range(degree - k):
            work[i] = work[i] + s * (work[i + 1] - work[i])


@kernel
def stationary(row: FloatArray) -> float:
    """A guess, in [0, 1], of where a row (d+1,) is largest (`extremum._stationary`)."""
    degree = len(row) - 1
    c = np.zeros(degree + 1)
    for k in range(degree + 1):
        for i in range(k + 1):
            c[k] += row[i] * POWERS[degree, i, k]
    s = float(np.argmax(row) / degree)
    for _ in range(5):
        f, g = 0.0, 0.0
        for k in range(degree, 0, -1):
            f = f * s + k * c[k]
        for k in range(degree, 1, -1):
            g = g * s + k * (k - 1) * c[k]
        if g < 0:
            s = s - f / g
        s = least(most(s, 0.0), 1.0)
    return s


@kernel
def highest(rows: FloatArray, taken: float, slack: float, rounds: int) -> float:
    """The bound of one group of `extremum.maxima` for rows (m, d+1); NaN: it did not close, or is not finite."""
    bound, width = taken, rows.shape[1]
    for row in rows:
        for x in row:
            if not np.isfinite(x):
                return np.nan
    for attempt in range(rounds):
        following = np.empty((2 * len(rows), width))
        count, now = 0, taken
        for row in rows:
            top = row.max()
            if top <= now + slack:
                bound = max(bound, top)
                continue
            s = 0.5 if attempt % 3 == 2 else stationary(row)
            if not 0 < s < 1:
                s = 0.5
            split(row, s, following[count], following[count + 1])
            taken = max(taken, following[count, width - 1])
            count += 2
        if count == 0:
            return max(bound, taken)
        rows = following[:count]
    return np.nan


@kernel
def extremes(pieces: FloatArray, tightness: float, rounds: int) -> tuple[FloatArray, FloatArray]:
    """`extremum.span` for pieces (P, n, d+1)."""
    many, n, width = pieces.shape
    lower, upper = np.empty(n), np.empty(n)
    rows = np.empty((many, width))
    for j in range(n):
        size, taken = 0.0, np.array([-np.inf, -np.inf])
        for p in range(many):
            for i in range(width):
                size = most(size, abs(pieces[p, j, i]))
            for i in (0, width - 1):
                taken[0] = most(taken[0], pieces[p, j, i])
                taken[1] = most(taken[1], -pieces[p, j, i])
        slack = tightness * size
        for side in range(2):
            sign = 1.0 if side == 0 else -1.0
            bound, count = taken[side], 0
            for p in range(many):
                top = sign * pieces[p, j, 0]
                for i in range(1, width):
                    top = most(top, sign * pieces[p, j, i])
                if top <= taken[side] + slack:
                    bound = max(bound, top)
                else:
                    for i in range(width):
                        rows[count, i] = sign * pieces[p, j, i]
                    count += 1
            if count:
                bound = most(bound, highest(rows[:count], taken[side], slack, rounds))
            if side == 0:
                upper[j] = bound
            else:
                lower[j] = -bound
    return lower, upper


@kernel
def pulled(
    edges: FloatArray, c: FloatArray, ends: FloatArray, arm: FloatArray, tcp: FloatArray, t: FloatArray
) -> tuple[float, float]:
    """Largest acceleration of the tool point of a SCARA at times t, and when (`tool_motion.tool_peak`); `ends` (3, n):
    q, q̇, q̈ of the last knot, `tcp` (2,) the tool point beside the flange's axis."""
    best, when = -1.0, t[0]
    x, n = np.empty((3, c.shape[1])), c.shape[1]
    for time in t:
        held = least(most(time, edges[0]), edges[-1])
        k = piece(edges, held)
        for order in range(3):
            for j in range(n):
                x[order, j] = ends[order, j] if held == edges[-1] else derivative(c, k, j, order, held - edges[k])
        ax, ay, phi, w, dw = 0.0, 0.0, arm[5], 0.0, 0.0
        for link in range(3):
            # the flange is turned by the fourth joint, if there is one
            joint = link if link < 2 else 3
            if joint < n:
                phi, w, dw = phi + x[0, joint], w + x[1, joint], dw + x[2, joint]
            cos, sin = np.cos(phi), np.sin(phi)
            if link < 2:
                rx, ry = arm[link] * cos, arm[link] * sin
            else:
                rx, ry = cos * tcp[0] - sin * tcp[1], sin * tcp[0] + cos * tcp[1]
            ax -= dw * ry + w * w * rx
            ay += dw * rx - w * w * ry
        size = np.sqrt(ax * ax + ay * ay + x[2, 2] * x[2, 2])
        if size > best or size != size:
            best, when = size, time
            if size != size:
                break
    return best, when
