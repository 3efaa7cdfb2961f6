"""Rest to rest along a straight line in joint space, in closed form: every joint switches at the same moments.

For motions of a few milliseconds it beats the solver's: that one lets each joint switch at its own times, and a dozen
switches within a hundred microseconds cannot be written as knots.
"""

from __future__ import annotations

import numpy as np

from planner.arrays import FloatArray
from planner.timing.bounds import rest_to_rest_time
from planner.timing.ends import SCALE, ended
from planner.timing.profile import Profile

_SIGNS = np.array([1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0])
"""Jerk over the seven phases."""


def straight(
    q0: FloatArray,
    q1: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray,
    duration: float | None = None,
) -> Profile | None:
    """The fastest motion q0 + s(t)(q1 − q0) from rest to rest, or that one slowed down to `duration`; None if too short.

    s goes from 0 to 1 within the limits of all joints together; states (n,), limits (n,). Slowing down by a factor f
    divides velocities by f, accelerations by f², jerks by f³. q0 = q1 gives the duration asked for, or 0.
    """
    way = q1 - q0
    n, still = len(way), np.zeros_like(way)
    states = np.stack([q0, still, still, q1, still, still])
    if not way.any():
        time, phases = np.zeros((n, 1)), np.zeros((n, 1, 6))
        phases[:, 0, 0] = q0
        return Profile(
            duration or 0.0, *ended(duration or 0.0, time, phases, states), (q0, still, still), (q1, still, still)
        )
    v, a, j = (float((limit[way != 0] / np.abs(way[way != 0])).min()) for limit in (velocity, acceleration, jerk))
    least = float(rest_to_rest_time(1.0, v, a, j))
    if duration is None:
        duration = least
    if not duration >= least:
        return None
    lengths = phase_lengths(v, a, j)
    time = np.concatenate([[0.0], np.cumsum(lengths)])
    s = np.zeros((4, 8))
    s[3, :7] = _SIGNS * j
    for k, h in enumerate(lengths):
        p, pd, pdd, u = s[:, k]
        s[:3, k + 1] = p + h * (pd + h * (pdd / 2 + h * u / 6)), pd + h * (pdd + h * u / 2), pdd + h * u
    slower = duration / least
    phases = np.zeros((n, 8, 6))
    phases[..., :4] = way[:, None, None] * (s / slower ** np.arange(4)[:, None]).T * SCALE
    phases[..., 0] += q0[:, None]
    times = np.repeat(np.minimum(time * slower, duration)[None], n, 0)
    return Profile(duration, *ended(duration, times, phases, states), (q0, still, still), (q1, still, still))


def phase_lengths(v: float, a: float, j: float) -> FloatArray:
    """Lengths (7,) of the phases of jerk +j, 0, −j, 0, −j, 0, +j of the fastest motion over the distance 1 (P3)."""
    ramp = min(a / j, (v / j) ** 0.5, (1 / (2 * j)) ** (1 / 3))
    # With ramps of full length the plateau is what acceleration and distance leave room for.
    plateau = 0.0
    if ramp == a / j:
        plateau = max(0.0, min(v / a - ramp, (ramp * ramp / 4 + 1 / a) ** 0.5 - 1.5 * ramp))
    reached = j * ramp * (ramp + plateau)
    cruise = max(0.0, 1 / reached - 2 * ramp - plateau)
    return np.array([ramp, plateau, ramp, cruise, ramp, plateau, ramp])
