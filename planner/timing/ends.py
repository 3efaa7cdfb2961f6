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
"""

from __future__ import annotations

import math

import numpy as np

from planner.arrays import FloatArray

END_PHASE = 1e-5
"""s. First and last phases of a joint that are shorter are left out: from here up they are known to 1 rad/s³."""
END_SHARE = 1e-3
"""... but never more than this share of the duration, so that leaving them out costs less than 2 % of the jerk."""

SCALE = np.array([1.0, 1.0, 0.5, 1 / 6])
"""Position, velocity, acceleration, jerk into coefficients of a polynomial."""
FACTORS = tuple(np.array([math.perm(k, d) for k in range(d, 6)], dtype=np.float64) for d in range(4))
"""Factors that the derivative d puts before the coefficients c_d..c_5."""
_SHIFT = np.array(
    [[[math.comb(j, k) if i == j - k else 0 for i in range(6)] for k in range(6)] for j in range(6)], dtype=np.float64
)
"""Taylor's shift of a quintic: _SHIFT[j, k, j − k] = binomial(j, k)."""
_ORDERS = np.arange(6.0)


def states_of(phases: FloatArray, tau: FloatArray) -> FloatArray:
    """q, q̇, q̈ (3, n) of one polynomial per joint, (n, 6), at its own time `tau` (n,)."""
    power = tau[:, None] ** _ORDERS
    return np.stack([(phases[:, d:] * FACTORS[d] * power[:, : 6 - d]).sum(1) for d in range(3)])


def reached(time: FloatArray, duration: float) -> FloatArray:
    """Begins of phases (n, S) of which those short of an end by less than `END_PHASE` are moved there."""
    short = min(END_PHASE, END_SHARE * duration)
    moved = np.where(time <= short, 0.0, time)
    return np.where(moved >= duration - short, duration, moved)


def ended(duration: float, time: FloatArray, phases: FloatArray, states: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Begins of phases and their coefficients with exact ends.

    `time` (n, S) not decreasing, `phases` (n, S, 6), both without a phase that holds the end: one is appended.
    `states` (6, n): q, q̇, q̈ at the start, then at the end.
    """
    n = len(time)
    joint = np.arange(n)
    clear = reached(time, duration)
    begun, under_way = (clear <= 0).sum(1) - 1, np.maximum((clear < duration).sum(1) - 1, 0)
    first = _shifted(phases[joint, begun], -time[joint, begun]) if time[joint, begun].any() else phases[joint, begun]
    phases = np.where((np.arange(time.shape[1]) <= begun[:, None])[..., None], first[:, None], phases)
    last = states_of(phases[joint, under_way], duration - clear[joint, under_way])
    residual = states - np.concatenate([first[:, :3].T / SCALE[:3, None], last])
    if residual.any() and duration > 0:
        phases = phases + _correction(residual, duration, clear)
    hold = np.zeros((n, 1, 6))
    hold[:, 0, :3] = states[3:].T * SCALE[:3]
    return np.append(clear, np.full((n, 1), duration), 1), np.append(phases, hold, 1)


def _shifted(phases: FloatArray, by: FloatArray) -> FloatArray:
    """Coefficients (n, 6) about a begin that is `by` (n,) later."""
    return np.asarray(np.einsum("nj,ni,jki->nk", phases, by[:, None] ** _ORDERS, _SHIFT))


def _correction(residual: FloatArray, duration: float, time: FloatArray) -> FloatArray:
    """Taylor coefficients (n, S, 6) at `time` (n, S) of the quintic P1 that has these `residual` (6, n) at its ends."""
    r0, v0, a0, r1, v1, a1 = residual
    c1, c2 = duration * v0, duration**2 * a0 / 2
    d, v, a = r1 - r0 - c1 - c2, duration * v1 - c1 - 2 * c2, duration**2 * a1 - 2 * c2
    c = np.stack([r0, c1, c2, 10 * d - 4 * v + a / 2, -15 * d + 7 * v - a, 6 * d - 3 * v + a / 2])
    power = (time / duration)[..., None] ** _ORDERS
    return np.asarray(np.einsum("jn,nsi,jki->nsk", c, power, _SHIFT) / duration**_ORDERS)
