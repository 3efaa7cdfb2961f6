"""Kernels: bounds of the joint motion (`planner.sweep`) and of what it moves (K13, K14, the laws' bounds)."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np

from benchmarks.compiled.curves import piece, states
from benchmarks.compiled.door import kernel
from benchmarks.compiled.separating import least, most
from planner.arrays import FloatArray, IntArray
from planner.sweep import ROUNDING
from planner.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class Curve:
    """A trajectory for the kernels: see `curves`; `hulls` its Bernstein coefficients, by derivative."""

    edges: FloatArray
    c: FloatArray
    last: FloatArray
    ends: FloatArray
    hulls: tuple[FloatArray, FloatArray, FloatArray, FloatArray]


_curves: WeakKeyDictionary[Trajectory, Curve] = WeakKeyDictionary()


def curve(trajectory: Trajectory) -> Curve:
    """The arrays of a trajectory, made once; copies, for read-only arrays are another type to a kernel."""
    found = _curves.get(trajectory)
    if found is None:
        ends = np.stack([trajectory.q[-1], trajectory.qd[-1], trajectory.qdd[-1]])
        position, velocity, acceleration, jerk = (trajectory.bernstein(d).copy() for d in range(4))
        hulls = position, velocity, acceleration, jerk
        found = Curve(trajectory.edges.copy(), trajectory.coefficients.copy(), ends[0].copy(), ends, hulls)
        _curves[trajectory] = found
    return found


@kernel
def tables(
    steps: FloatArray,
    place: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray,
    rates: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """What does not depend on the interval, as `sweep._derive` has it: whole, curvature, slack."""
    many, n, m = len(steps), place.shape[1], len(rates)
    wide = 2 * m + 2 * n
    whole, curvature, slack = np.zeros((many, wide)), np.zeros((many, wide)), np.zeros(wide)
    top = np.zeros((3, n))
    for p in range(many):
        for r in range(m):
            for kind in range(4):
                count = (5, 4, 3, 2)[kind]
                far = 0.0
                for i in range(count):
                    value = 0.0
                    for j in range(n):
                        if kind == 0:
                            x = velocity[p, j, i]
                        elif kind == 1:
                            x = acceleration[p, j, i]
                        elif kind == 2:
                            x = jerk[p, j, i]
                        else:
                            x = 2 * (jerk[p, j, i + 1] - jerk[p, j, i]) / steps[p]
                        value += x * rates[r, j]
                    far = most(far, abs(value))
                if kind < 2:
                    whole[p, kind * m + r] = far
                else:
                    curvature[p, (kind - 2) * m + r] = far / 8
        for j in range(n):
            high, low, bend = -np.inf, np.inf, 0.0
            for i in range(6):
                high, low = most(high, place[p, j, i]), least(low, place[p, j, i])
                top[2, j] = most(top[2, j], abs(place[p, j, i]))
            for i in range(5):
                top[0, j] = most(top[0, j], abs(velocity[p, j, i]))
            for i in range(4):
                bend = most(bend, abs(acceleration[p, j, i]))
            top[1, j] = most(top[1, j], bend)
            whole[p, 2 * m + j], whole[p, 2 * m + n + j] = high, -low
            curvature[p, 2 * m + j] = curvature[p, 2 * m + n + j] = bend / 8
    for r in range(m):
        for j in range(n):
            slack[r] += abs(rates[r, j]) * top[0, j]
            slack[m + r] += abs(rates[r, j]) * top[1, j]
    for j in range(n):
        slack[2 * m + j] = slack[2 * m + n + j] = top[2, j]
    return whole, curvature, slack * ROUNDING


@kernel
def part(
    edges: FloatArray,
    c: FloatArray,
    whole: FloatArray,
    curvature: FloatArray,
    rates: FloatArray,
    p: int,
    a: float,
    b: float,
    out: FloatArray,
) -> None:
    """Raises out (c,) to the bounds over [a, b] within piece p."""
    n, m = c.shape[1], len(rates)
    x = np.empty((2, 3, n))
    for j in range(n):
        x[0, 0, j], x[0, 1, j], x[0, 2, j] = states(c, p, j, a - edges[p])
        x[1, 0, j], x[1, 1, j], x[1, 2, j] = states(c, p, j, b - edges[p])
    square = (b - a) ** 2
    for column in range(len(out)):
        if column < 2 * m:
            r, order = column % m, 1 + column // m
            first, last = 0.0, 0.0
            for j in range(n):
                first += x[0, order, j] * rates[r, j]
                last += x[1, order, j] * rates[r, j]
            ends = most(abs(first), abs(last))
        elif column < 2 * m + n:
            ends = most(x[0, 0, column - 2 * m], x[1, 0, column - 2 * m])
        else:
            ends = -least(x[0, 0, column - 2 * m - n], x[1, 0, column - 2 * m - n])
        bent = ends + square * curvature[p, column]
        out[column] = most(out[column], least(bent, most(whole[p, column], ends)))


@kernel
def swept(
    edges: FloatArray,
    c: FloatArray,
    whole: FloatArray,
    curvature: FloatArray,
    slack: FloatArray,
    rates: FloatArray,
    rests: tuple[bool, bool],
    t0: FloatArray,
    t1: FloatArray,
) -> FloatArray:
    """`sweep` over [t0, t1] (N,): (N, 2m + 2n), the bounds of |C q̇|, |C q̈|, q and −q."""
    wide = whole.shape[1]
    out = np.full((len(t0), wide), -np.inf)
    for i in range(len(t0)):
        a, b = least(most(t0[i], edges[0]), edges[-1]), least(most(t1[i], edges[0]), edges[-1])
        first = piece(edges, a)
        last = max(min(int(np.searchsorted(edges, b, side="left")) - 1, len(edges) - 2), first)
        part(edges, c, whole, curvature, rates, first, a, least(b, edges[first + 1]), out[i])
        if last > first:
            part(edges, c, whole, curvature, rates, last, edges[last], b, out[i])
            for p in range(first + 1, last):
                for k in range(wide):
                    out[i, k] = most(out[i, k], whole[p, k])
        unknown = (not rests[0] and t0[i] < edges[0]) or (not rests[1] and t1[i] > edges[-1])
        for k in range(wide):
            out[i, k] = np.inf if unknown else out[i, k] + (abs(out[i, k]) * ROUNDING + slack[k])
    return out


@kernel
def arm_bound(
    arm: FloatArray, link: int, reach: float, x: float, y: float, z: float, rate: FloatArray, rate_d: FloatArray
) -> tuple[float, float]:
    """`Scara.point_bounds` of one row."""
    across, along = np.hypot(x, y), abs(z)
    far = reach if reach >= 0 else np.nan
    speed = acceleration = 0.0
    for i in range(3):
        turns = (i == 0 and link == 1) or (i == 1 and link == 2) or (i == 2 and link == 4)
        length = far if turns else far * 0.0
        if i == 0 and link >= 2:
            length += arm[0]
        if i == 1 and link >= 3:
            length += arm[1]
        k = i if i < 2 else 3
        speed += length * rate[k]
        acceleration += length * np.hypot(rate_d[k], rate[k] * rate[k])
    rides = 1.0 if link >= arm[7] else 0.0
    speed = across * speed + along * (rides * rate[2])
    acceleration = across * acceleration + along * (rides * rate_d[2])
    return (speed if speed >= 0 else np.inf), (acceleration if acceleration >= 0 else np.inf)


@kernel
def law_bound(law: FloatArray, t0: float, t1: float, x: float, y: float, z: float, reach: float) -> tuple[float, float]:
    """Bounds of the points of a body on a frame: its law's, and what turning adds."""
    known = law[9] <= t0 <= t1 <= law[10]
    speed = abs(x * law[4] + y * law[5] + z * law[6]) + law[11] if known else np.inf
    rate = abs(law[7]) if known else np.inf
    across = np.hypot(x, y) * reach
    gain = 0.0 if known else np.inf
    return speed + across * rate, gain + across * np.hypot(gain, rate * rate)


@kernel
def bound(
    arm: FloatArray,
    laws: FloatArray,
    carrier: int,
    reach: float,
    x: float,
    y: float,
    z: float,
    t0: float,
    t1: float,
    rate: FloatArray,
    rate_d: FloatArray,
) -> tuple[float, float]:
    """Of a point of whatever rides on a carrier, along (x, y, z)."""
    if carrier < 5:
        return arm_bound(arm, carrier, reach, x, y, z, rate, rate_d)
    return law_bound(laws[carrier - 5], t0, t1, x, y, z, reach)


@kernel
def arm_bounds(
    arm: FloatArray, link: IntArray, reach: FloatArray, n: FloatArray, rate: FloatArray, rate_d: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """`Scara.point_bounds`."""
    speed, acceleration = np.empty(len(link)), np.empty(len(link))
    for i in range(len(link)):
        speed[i], acceleration[i] = arm_bound(arm, link[i], reach[i], n[i, 0], n[i, 1], n[i, 2], rate[i], rate_d[i])
    return speed, acceleration
