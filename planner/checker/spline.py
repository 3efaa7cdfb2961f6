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

from assur.planner.arrays import FloatArray, IntArray

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
        piece = np.minimum(np.maximum(self.time.searchsorted(t, "right") - 1, 0), len(self.length) - 1)
        return piece, within((t - self.time[piece]) / self.length[piece], 0.0, 1.0)

    def position(self, t: FloatArray) -> FloatArray:
        """q (T, n) at times t (T,)."""
        piece, s = self.place(t)
        return _value(self.control[0][piece], *_powers(s))

    def state(self, t: FloatArray) -> State:
        """q, q̇, q̈, q⃛ at times t (T,), each (T, n), from the right. If the last knot is at rest, the arm stands still
        from there on."""
        q, *rates = self.inside(*self.place(t))
        late = t >= self.end
        if late.any() and self.at_rest:
            rates = [np.where(late[:, None], 0.0, rate) for rate in rates]
        return q, rates[0], rates[1], rates[2]

    def inside(self, piece: IntArray, s: FloatArray) -> State:
        """q, q̇, q̈, q⃛ at s (T,) of the given pieces (T,), each (T, n)."""
        powers = _powers(s)
        values = [_value(control[piece], *powers) for control in self.control]
        return values[0], values[1], values[2], values[3]

    @property
    def at_rest(self) -> bool:
        """Whether the last knot is at rest up to `REST`."""
        return all(bool((np.abs(rate) <= REST).all()) for rate in self.last[1:])


REST = 1e-9
"""A joint slower than this is at rest, rad/s or m/s (and rad/s², m/s²): in an hour it goes 4 µm."""
_EXPONENTS = np.arange(6)
_CHOOSE = tuple(np.array([comb(degree, i) for i in range(degree + 1)], dtype=np.float64) for degree in range(6))
"""Binomial coefficients, a row a degree."""


def spline(time: FloatArray, q: FloatArray, qd: FloatArray, qdd: FloatArray) -> Spline:
    """The spline through knots `time` (K,), not decreasing, and `q, qd, qdd` (K, n); what lasts no time is no piece."""
    begin = np.flatnonzero(time[1:] > time[:-1])
    end = begin + 1
    length = time[end] - time[begin]
    h = length[:, None]
    q0, q1, v0, v1, a0, a1 = q[begin], q[end], qd[begin], qd[end], qdd[begin], qdd[end]
    # Control values by number, (d+1, P, n): contiguous rows of each.
    position, velocity, acceleration = (np.empty((rows, *q0.shape)) for rows in (6, 5, 4))
    out, back, bent = h * v0 / 5, h * v1 / 5, h * h / 20
    position[0], position[1], position[2] = q0, q0 + out, q0 + 2 * out + bent * a0
    position[3], position[4], position[5] = q1 - 2 * back + bent * a1, q1 - back, q1
    velocity[0], velocity[1], velocity[3], velocity[4] = v0, v0 + h * a0 / 4, v1 - h * a1 / 4, v1
    velocity[2] = 5 * (q1 - q0) / h - 2 * (v0 + v1) + h * (a1 - a0) / 4
    acceleration[0], acceleration[3] = a0, a1
    acceleration[1:3] = 4 * (velocity[2:4] - velocity[1:3]) / h
    jerk = 3 * (acceleration[1:] - acceleration[:-1]) / h
    control = tuple(rows.transpose(1, 2, 0) for rows in (position, velocity, acceleration, jerk))
    edges = np.append(time[begin], time[-1])
    ends = (q[0], qd[0], qdd[0]), (q[-1], qd[-1], qdd[-1])
    return Spline(edges, length, (control[0], control[1], control[2], control[3]), *ends)


def within(x: FloatArray, low: float, high: float) -> FloatArray:
    """x, and what is outside [low, high] at its nearest end; NaN stays (`numpy.clip`, which costs several times this
    on short arrays)."""
    return np.asarray(np.minimum(np.maximum(x, low), high))


def _powers(s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """s⁰ to s⁵ and (1 - s)⁰ to (1 - s)⁵, each (T, 6), for s (T,)."""
    return s[:, None] ** _EXPONENTS, (1.0 - s)[:, None] ** _EXPONENTS


def _value(control: FloatArray, up: FloatArray, down: FloatArray) -> FloatArray:
    """Values (T, n) of polynomials by their control values (T, n, d+1), by Bernstein's Σ c_i (d over i) sⁱ (1-s)ᵈ⁻ⁱ;
    `up`, `down`: the powers of s and of 1 - s."""
    degree = control.shape[-1] - 1
    weights = _CHOOSE[degree] * up[:, : degree + 1] * down[:, degree::-1]
    return np.asarray((control @ weights[:, :, None])[:, :, 0])


def cut(control: FloatArray, s0: FloatArray, s1: FloatArray) -> FloatArray:
    """Control values (N, ..., d+1) of the parts over [s0, s1] (N,) of N polynomials on [0, 1], 0 <= s0 <= s1 <= 1."""
    rows = np.array(np.moveaxis(control, -1, 0))
    shape = (len(s0),) + (1,) * (control.ndim - 2)
    before(rows, s1.reshape(shape))
    behind(rows, begin_of(s0, s1).reshape(shape))
    return np.moveaxis(rows, 0, -1)


def begin_of(s0: FloatArray, s1: FloatArray) -> FloatArray:
    """Where [s0, s1] (N,) begins in [0, s1], as a share of it."""
    return np.asarray(np.where(s1 > 0, s0 / np.where(s1 > 0, s1, 1.0), 0.0))


def before(rows: FloatArray, s: FloatArray) -> None:
    """Cuts polynomials, control values first (d+1, ...), down to their parts over [0, s] (...), in place: the values
    along one side of de Casteljau's triangle."""
    for k in range(1, len(rows)):
        step = rows[k:] - rows[k - 1 : -1]
        step *= s
        np.add(rows[k - 1 : -1], step, out=rows[k:])


def behind(rows: FloatArray, s: FloatArray) -> None:
    """As `before`, down to the parts over [s, 1]: the values along the other side."""
    for k in range(len(rows) - 1, 0, -1):
        step = rows[1 : k + 1] - rows[:k]
        step *= s
        rows[:k] += step
