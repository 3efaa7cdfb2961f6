"""The checker's own evaluation of the quintic Hermite spline through the knots, in Bernstein form.

Over a piece of length h, with s from 0 to 1, a derivative of degree d is Σ c_i B_i^d(s) (equation V1): it takes c_0 and
c_d at its ends and nowhere leaves [min c, max c]; the part of it over [s0, s1] has control values of its own, by de
Casteljau's cuts, that lie closer. The control values of q follow from the knots; each derivative's are d/h times the
differences, taken from q1 − q0 directly so that the rounding of q does not reach the jerk more than it must.

Two knots at one time, of a plan with parabolic blends, are no piece: one piece ends with the first of them, the next
begins with the second, and everything that is bounded here is bounded piece by piece, on both sides of the jump.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb

import numpy as np

from planner.arrays import FloatArray, IntArray

State = tuple[FloatArray, FloatArray, FloatArray, FloatArray]
"""q, q̇, q̈, q⃛."""


@dataclass(frozen=True, eq=False)
class Spline:
    """Control values of q, q̇, q̈, q⃛ over the pieces between `time` (P+1,): `control[d]` (P, n, 6 - d).

    `first`, `last`: q, q̇, q̈ (n,) of the outermost knots, which a jump sets apart from the outermost pieces."""

    time: FloatArray
    length: FloatArray
    control: tuple[FloatArray, FloatArray, FloatArray, FloatArray]
    first: tuple[FloatArray, FloatArray, FloatArray]
    last: tuple[FloatArray, FloatArray, FloatArray]

    @property
    def start(self) -> float:
        return float(self.time[0])

    @property
    def end(self) -> float:
        return float(self.time[-1])

    def place(self, t: FloatArray) -> tuple[IntArray, FloatArray]:
        """Piece (T,) and s (T,) in [0, 1] of times t, those outside moved to the nearest end."""
        piece = np.clip(np.searchsorted(self.time, t, side="right") - 1, 0, len(self.length) - 1)
        return piece, np.clip((t - self.time[piece]) / self.length[piece], 0.0, 1.0)

    def state(self, t: FloatArray) -> State:
        """q, q̇, q̈, q⃛ at times t (T,), each (T, n), from the right. If the last knot is at rest, the arm stands still
        from there on."""
        q, *rates = self.inside(*self.place(t))
        if self.at_rest:
            rates = [np.where((t >= self.end)[:, None], 0.0, rate) for rate in rates]
        return q, rates[0], rates[1], rates[2]

    def inside(self, piece: IntArray, s: FloatArray) -> State:
        """q, q̇, q̈, q⃛ at s (T,) of the given pieces (T,), each (T, n)."""
        values = [
            (control[piece] @ basis(s, 5 - derivative)[:, :, None])[:, :, 0]
            for derivative, control in enumerate(self.control)
        ]
        return values[0], values[1], values[2], values[3]

    @property
    def at_rest(self) -> bool:
        """Whether the last knot is at rest up to `REST`."""
        return all(bool((np.abs(rate) <= REST).all()) for rate in self.last[1:])


REST = 1e-9
"""A joint slower than this is at rest, rad/s or m/s (and rad/s², m/s²): in an hour it goes 4 µm."""


def spline(time: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray) -> Spline:
    """The spline through knots `time` (K,), not decreasing, and `q, qd, qdd` (K, n); what lasts no time is no piece."""
    begin = np.flatnonzero(time[1:] > time[:-1])
    end = begin + 1
    length = time[end] - time[begin]
    h = length[:, None]
    step, v0, v1, a0, a1 = q[end] - q[begin], qd[begin], qd[end], qdd[begin], qdd[end]
    out, back = h * v0 / 5, h * v1 / 5
    position = [q[begin], q[begin] + out, q[begin] + 2 * out + h * h * a0 / 20]
    position += [q[end] - 2 * back + h * h * a1 / 20, q[end] - back, q[end]]
    middle = 5 * step / h - 2 * (v0 + v1) + h * (a1 - a0) / 4
    velocity = np.stack([v0, v0 + h * a0 / 4, middle, v1 - h * a1 / 4, v1], -1)
    inner = 4 * np.diff(velocity[..., 1:4], axis=-1) / h[..., None]
    acceleration = np.concatenate([a0[..., None], inner, a1[..., None]], -1)
    jerk = 3 * np.diff(acceleration, axis=-1) / h[..., None]
    control = (np.stack(position, -1), velocity, acceleration, jerk)
    edges = np.append(time[begin], time[-1])
    return Spline(edges, length, control, (q[0], qd[0], qdd[0]), (q[-1], qd[-1], qdd[-1]))


def basis(s: FloatArray, degree: int) -> FloatArray:
    """Bernstein polynomials B_i(s) of a degree, (T, degree + 1)."""
    i = np.arange(degree + 1)
    choose = np.array([comb(degree, int(k)) for k in i], dtype=np.float64)
    return np.asarray(choose * s[:, None] ** i * (1.0 - s[:, None]) ** (degree - i))


def cut(control: FloatArray, s0: FloatArray, s1: FloatArray) -> FloatArray:
    """Control values (N, ..., d+1) of the parts over [s0, s1] (N,) of N polynomials on [0, 1], 0 <= s0 <= s1 <= 1."""
    shape = (len(s0),) + (1,) * (control.ndim - 1)
    late = np.where(s1 > 0, s0 / np.where(s1 > 0, s1, 1.0), 0.0)
    return _half(_half(control, s1.reshape(shape), 0), late.reshape(shape), -1)


def _half(control: FloatArray, s: FloatArray, side: int) -> FloatArray:
    """The part left (`side` 0) or right (−1) of s: the outermost values of de Casteljau's triangle."""
    degree = control.shape[-1] - 1
    result = np.empty_like(control)
    for k in range(degree + 1):
        result[..., k if side == 0 else degree - k] = control[..., side]
        control = control[..., :-1] + s * (control[..., 1:] - control[..., :-1])
    return result
