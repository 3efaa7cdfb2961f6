"""The ends of a profile: exact, and clear of phases too short to be written as knots.

The solver ends within 1e-8 of its target, and its times are sums of rounded durations. What is missing at both ends is
added as one quintic over the whole duration T (equation P1): with residuals r, r', r'' at u = t/T = 0 and 1,

    c(u) = Σ c_k u^k     c0 = r0    c1 = T r0'    c2 = T² r0''/2
    d = r1 − c0 − c1 − c2    v = T r1' − c1 − 2 c2    a = T² r1'' − 2 c2
    c3 = 10d − 4v + a/2    c4 = −15d + 7v − a    c5 = 6d − 3v + a/2

Its jerk is of the order of 60 r/T³; mending the last phase alone would take 60 r/h³.

A first or last phase of a few microseconds cannot be written: the outermost knots are given, and what the rounding of
the next one misses costs a jerk of 6 r/h³ (1e3 rad/s³ at 1 µs and 3 rad). Dropping its knot costs 9 Jδ/h on the next
piece, of length h. So the phase itself goes, and its neighbour takes on its time. The acceleration at the end is then
off by Jδ, or by nothing for a bump that goes up and down again. Either P1 mends it, for a jerk of 9 Jδ/T and Jδ more
acceleration near the end; or the neighbour's jerk does, for Jδ/h, and P1 mends the velocity of Jδh/2 that is left.
What costs least is done, keeping the phase included.

Numbers of one joint are plain floats here: for four joints NumPy takes three times as long.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.timing.question import JERK_RESERVE, RATE_RESERVE

END_WINDOW = 5e-5
"""s. Outermost phases this long, or longer, are always kept: rounding costs them 0.02 rad/s³."""
END_SHARE = 0.25
"""... and those that reach farther into a motion than this share of it."""
END_ROUNDING = 6 * 4.4e-16
"""rad. Six times the rounding of a position between 2 and 4 rad or m: over h³, what a last piece misses of its jerk."""
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
    """One joint's phases of constant jerk: their begins `t` from 0, not decreasing, and p, v, a, j there (S each).

    `acceleration`, `jerk`: the limits that they were made for.
    """

    t: list[float]
    p: list[float]
    v: list[float]
    a: list[float]
    j: list[float]
    acceleration: float
    jerk: float

    def at(self, phase: int, tau: float) -> tuple[float, float, float]:
        """Position, velocity, acceleration `tau` after the begin of a phase."""
        return _integrated(self.p[phase], self.v[phase], self.a[phase], self.j[phase], tau)


def _integrated(p: float, v: float, a: float, j: float, tau: float) -> tuple[float, float, float]:
    return p + tau * (v + tau * (a / 2 + tau * j / 6)), v + tau * (a + tau * j / 2), a + tau * j


def missed(joint: Cubics, goal: tuple[float, float, float], duration: float) -> float:
    """By how much the last phase misses the goal at the end, in units of the `END_…` tolerances (1: the most)."""
    return aside(*joint.at(-1, duration - joint.t[-1]), *goal)


def aside(p: float, v: float, a: float, goal_p: float, goal_v: float, goal_a: float) -> float:
    """How far a state is from a goal, in units of the `END_…` tolerances (1: the most).

    A norm, which NaN goes through, and not the largest of three, which it may not.
    """
    return math.hypot((p - goal_p) / END_POSITION, (v - goal_v) / END_VELOCITY, (a - goal_a) / END_ACCELERATION)


def ended(joints: list[Cubics], states: list[list[float]], duration: float) -> tuple[FloatArray, FloatArray]:
    """Begins (n, S+1) and coefficients (n, S+1, 6) of phases with exact ends; the last phase holds the end state.

    `states`: six rows of n numbers, q, q̇, q̈ at the start, then at the end. Raises `FaultError` for a goal that is
    missed by more than the tolerances.
    """
    times, cubics, corrections = [], [], []
    for joint, *ends in zip(joints, *states, strict=True):
        if not missed(joint, (ends[3], ends[4], ends[5]), duration) <= 1:
            raise FaultError(f"phases do not end at {ends[3:]} after {duration} s")
        last = _last_kept(joint, ends[5], duration)
        first = _first_kept(joint, ends[2], duration)
        kept = _cleared(joint, first, last, (ends[2], ends[5]), duration)
        t, columns = kept.t, [kept.p, kept.v, kept.a, kept.j]
        begin, end = kept.at(0, 0.0), kept.at(last.phase, duration - t[last.phase])
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


@dataclass(frozen=True, slots=True)
class _Kept:
    """The outermost phase that is kept, and whether its jerk is changed to mend the acceleration."""

    phase: int
    bent: bool = False


def _last_kept(joint: Cubics, goal: float, duration: float) -> _Kept:
    """The phase that goes on to the end; `goal`: the acceleration there."""
    number = len(joint.t) - 1
    while number and joint.t[number] >= duration:
        number -= 1
    best, least, window = _Kept(number), math.inf, min(END_WINDOW, END_SHARE * duration)
    if duration - joint.t[number] >= window:
        return best
    while True:
        length = duration - joint.t[number]
        off = abs(joint.a[number] + joint.j[number] * length - goal)
        for kept in (_Kept(number), _Kept(number, bent=True)):
            cost = _cost(joint, off, length, duration, bent=kept.bent)
            if cost < least:
                best, least = kept, cost
        if length >= window or not number:
            return best
        number -= 1


def _first_kept(joint: Cubics, start: float, duration: float) -> _Kept:
    """The phase that begins at the start; `start`: the acceleration there."""
    number, last = 0, len(joint.t) - 1
    while number < last and joint.t[number + 1] <= 0:
        number += 1
    best, least, window = _Kept(number), math.inf, min(END_WINDOW, END_SHARE * duration)
    if number == last or joint.t[number + 1] >= window:
        return best
    while True:
        length = joint.t[number + 1] if number < last else duration
        off = abs(joint.a[number] - joint.j[number] * joint.t[number] - start)
        for kept in (_Kept(number), _Kept(number, bent=True)):
            cost = _cost(joint, off, length, duration, bent=kept.bent)
            if cost < least:
                best, least = kept, cost
        if length >= window or number == last:
            return best
        number += 1


def _cost(joint: Cubics, off: float, length: float, duration: float, *, bent: bool) -> float:
    """What an outermost phase of this length costs in reserves, its acceleration being `off` at the end."""
    if not length > 0:
        return 0.0
    jerk, acceleration = 9 * off / duration, off
    if bent:
        jerk, acceleration = off / length + 18 * off * length / duration**2, 3 * off * length / duration
    jerk += END_ROUNDING / length**3
    return max(jerk / (joint.jerk * JERK_RESERVE), acceleration / (joint.acceleration * RATE_RESERVE))


def _cleared(joint: Cubics, first: _Kept, last: _Kept, goals: tuple[float, float], duration: float) -> Cubics:
    """The phases from `first` to `last`, which take on the time of those before and after, to accelerations `goals`.

    Phases that are left out stay as phases of no length.
    """
    t, p, v, a, j = list(joint.t), list(joint.p), list(joint.v), list(joint.a), list(joint.j)
    k = first.phase
    if t[k] > 0:
        # Backwards from the end of the phase, with its own jerk or the one that leads to the acceleration at the start.
        length = t[k + 1] if k + 1 < len(t) else duration
        end = joint.at(k, length - t[k])
        jerk = (end[2] - goals[0]) / length if first.bent else j[k]
        p[k], v[k], a[k] = _integrated(*end, jerk, -length)
        j[k] = jerk
    for column in (p, v, a, j):
        column[:k] = [column[k]] * k
    t[: k + 1] = [0.0] * (k + 1)
    k = last.phase
    if last.bent:
        j[k] = (goals[1] - a[k]) / (duration - t[k])
    t[k + 1 :] = [duration] * (len(t) - k - 1)
    return Cubics(t, p, v, a, j, joint.acceleration, joint.jerk)


def _quintic(residual: list[float], duration: float) -> list[float]:
    """c0..c5 of equation P1."""
    r0, v0, a0, r1, v1, a1 = residual
    c1, c2 = duration * v0, duration**2 * a0 / 2
    d, v, a = r1 - r0 - c1 - c2, duration * v1 - c1 - 2 * c2, duration**2 * a1 - 2 * c2
    return [r0, c1, c2, 10 * d - 4 * v + a / 2, -15 * d + 7 * v - a, 6 * d - 3 * v + a / 2]
