"""The ends of a profile: exact, and clear of phases too short to be written as knots.

The solver ends within 1e-8 of its target, and its times are sums of rounded durations. What is missing at both ends is
added as one quintic over the whole duration T (equation P1): with residuals r, r', r'' at u = t/T = 0 and 1,

    c(u) = Σ c_k u^k     c0 = r0    c1 = T r0'    c2 = T² r0''/2
    d = r1 − c0 − c1 − c2    v = T r1' − c1 − 2 c2    a = T² r1'' − 2 c2
    c3 = 10d − 4v + a/2    c4 = −15d + 7v − a    c5 = 6d − 3v + a/2

Its jerk is of the order of 60 r/T³; mending the last phase alone would take 60 r/h³.

A first or last phase of a few microseconds cannot be written: the outermost knots are given, and what the rounding of
the next one misses costs a jerk of 6 r/h³ (1e4 rad/s³ at 1 µs and 3 rad). Dropping its knot costs 9 Jδ/h on the next
piece. Moving its switch to the end and letting P1 mend what that changes costs 9 Jδ/T: a hundredth of it.

Numbers of one joint are plain floats here: for four joints NumPy takes three times as long.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from planner.arrays import FloatArray
from planner.errors import FaultError

END_PHASE = 1e-5
"""s. First and last phases of a joint that are shorter are left out: from here up they are known to 1 rad/s³."""
END_SHARE = 1e-3
"""... but never more than this share of the duration, so that leaving them out costs less than 2 % of the jerk."""
END_POSITION, END_VELOCITY, END_ACCELERATION = 1e-7, 1e-7, 1e-6
"""rad or m, and s. What a solver may miss an end state by: it promises 1e-8; more cannot be trusted."""

_SHIFT = np.array(
    [[[math.comb(j, k) if i == j - k else 0 for k in range(6)] for i in range(6)] for j in range(6)], dtype=np.float64
).reshape(6, 36)
"""Taylor's shift of a quintic: [j, i, k] = binomial(j, k) where i = j − k."""
_SCALE = np.array([1.0, 1.0, 0.5, 1 / 6])
"""Position, velocity, acceleration, jerk into coefficients of a polynomial."""


@dataclass(frozen=True, slots=True)
class Cubics:
    """One joint's phases of constant jerk: their begins `t` from 0, not decreasing, and p, v, a, j there (S each)."""

    t: list[float]
    p: list[float]
    v: list[float]
    a: list[float]
    j: list[float]

    def at(self, phase: int, tau: float) -> tuple[float, float, float]:
        """Position, velocity, acceleration `tau` after the begin of a phase."""
        p, v, a, j = self.p[phase], self.v[phase], self.a[phase], self.j[phase]
        return p + tau * (v + tau * (a / 2 + tau * j / 6)), v + tau * (a + tau * j / 2), a + tau * j


def missed(joint: Cubics, goal: tuple[float, float, float], duration: float) -> float:
    """By how much the last phase misses the goal at the end, in units of the `END_…` tolerances (1: the most)."""
    state = joint.at(-1, duration - joint.t[-1])
    allowed = (END_POSITION, END_VELOCITY, END_ACCELERATION)
    return max(abs(x - y) / z for x, y, z in zip(state, goal, allowed, strict=True))


def ended(joints: list[Cubics], states: list[list[float]], duration: float) -> tuple[FloatArray, FloatArray]:
    """Begins (n, S+1) and coefficients (n, S+1, 6) of phases with exact ends; the last phase holds the end state.

    `states`: six rows of n numbers, q, q̇, q̈ at the start, then at the end. Raises `FaultError` for a goal that is
    missed by more than the tolerances.
    """
    short = min(END_PHASE, END_SHARE * duration)
    times, cubics, corrections = [], [], []
    for joint, *ends in zip(joints, *states, strict=True):
        if not missed(joint, (ends[3], ends[4], ends[5]), duration) <= 1:
            raise FaultError(f"phases do not end at {ends[3:]} after {duration} s")
        t, columns, under_way = _cleared(joint, duration, short)
        clear = Cubics(t, *columns)
        begin, end = clear.at(0, 0.0), clear.at(under_way, duration - t[under_way])
        times.append([*t, duration])
        cubics.append(columns)
        corrections.append(_quintic([x - y for x, y in zip(ends, (*begin, *end), strict=True)], duration))
    n, size = len(joints), len(times[0])
    time = np.array(times)
    phases = np.zeros((n, size, 6))
    if duration > 0:
        power = np.empty((n, size - 1, 6))
        power[..., 0] = 1.0
        np.divide(time[:, :-1], duration, out=power[..., 1])
        for k in range(2, 6):
            np.multiply(power[..., k - 1], power[..., 1], out=power[..., k])
        shift = (np.array(corrections) @ _SHIFT).reshape(n, 6, 6)
        np.matmul(power, shift / [duration**k for k in range(6)], out=phases[:, :-1])
    phases[:, :-1, :4] += np.array(cubics).swapaxes(1, 2) * _SCALE
    phases[:, -1, :3] = np.array(states[3:]).T * _SCALE[:3]
    return time, phases


def _cleared(joint: Cubics, duration: float, short: float) -> tuple[list[float], list[list[float]], int]:
    """Begins, columns (p, v, a, j), and the phase that reaches the end, without outermost phases below `short`."""
    t, columns = list(joint.t), [joint.p, joint.v, joint.a, joint.j]
    under_way = 0
    for k, begin in enumerate(t):
        if begin >= duration - short:
            t[k] = duration
        elif duration > 0:
            under_way = k
    first = 0
    while first < under_way and t[first + 1] <= short:
        first += 1
    if t[first] > 0:
        state = (*joint.at(first, -t[first]), joint.j[first])
        columns = [[x] * (first + 1) + column[first + 1 :] for x, column in zip(state, columns, strict=True)]
        t[: first + 1] = [0.0] * (first + 1)
    elif first:
        columns = [[column[first]] * first + column[first:] for column in columns]
    return t, columns, under_way


def _quintic(residual: list[float], duration: float) -> list[float]:
    """c0..c5 of equation P1."""
    r0, v0, a0, r1, v1, a1 = residual
    c1, c2 = duration * v0, duration**2 * a0 / 2
    d, v, a = r1 - r0 - c1 - c2, duration * v1 - c1 - 2 * c2, duration**2 * a1 - 2 * c2
    return [r0, c1, c2, 10 * d - 4 * v + a / 2, -15 * d + 7 * v - a, 6 * d - 3 * v + a / 2]
