"""Rest to rest along a straight line in joint space, in closed form: every joint switches at the same moments.

For motions of a few milliseconds it beats the solver's: that one lets each joint switch at its own times, and a dozen
switches within a hundred microseconds cannot be written as knots.
"""

from __future__ import annotations

from assur.planner.timing.ends import Cubics
from assur.planner.timing.profile import Profile, finished
from assur.planner.timing.question import Limits

ROUNDING = 1e-10
"""Relative. A duration that the solver found rounds to a hair less than the closed form: limits are lowered by more."""
_SIGNS = (1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0)
"""Jerk over the seven phases."""


def straight(
    q0: list[float],
    q1: list[float],
    limits: Limits,
    duration: float,
) -> Profile | None:
    """The motion q0 + s(t)(q1 − q0) from rest to rest in `duration` s; None if that is too short.

    s goes from 0 to 1 as fast as the limits of all joints together allow, and is then slowed down: by a factor f it
    divides velocities by f, accelerations by f², jerks by f³. States are n numbers each.
    """
    way = [b - a for a, b in zip(q0, q1, strict=True)]
    still = [0.0] * len(way)
    states = [q0, still, still, q1, still, still]
    if not any(way):
        rest = zip(q0, limits.acceleration, limits.jerk, strict=True)
        return finished([Cubics([0.0], [q], [0.0], [0.0], [0.0], a, j) for q, a, j in rest], states, duration)
    v, a, j = (
        min(limit / abs(d) for limit, d in zip(kind, way, strict=True) if d)
        for kind in (limits.velocity, limits.acceleration, limits.jerk)
    )
    lengths = phase_lengths(v, a, j)
    least = sum(lengths)
    if not duration >= least * (1 - ROUNDING):
        return None
    t, unit = [0.0], Cubics([0.0], [0.0], [0.0], [0.0], [0.0], a, j)
    for h, sign in zip(lengths, _SIGNS, strict=True):
        unit.j[-1] = sign * j
        for column, value in zip((unit.p, unit.v, unit.a), unit.at(-1, h), strict=True):
            column.append(value)
        unit.j.append(0.0)
        t.append(t[-1] + h)
    slower = duration / least
    t = [min(x * slower, duration) for x in t]
    joints = [
        Cubics(
            t,
            [q + d * x for x in unit.p],
            [d * x / slower for x in unit.v],
            [d * x / slower**2 for x in unit.a],
            [d * x / slower**3 for x in unit.j],
            acceleration,
            jerk,
        )
        for q, d, acceleration, jerk in zip(q0, way, limits.acceleration, limits.jerk, strict=True)
    ]
    return finished(joints, states, duration)


def phase_lengths(v: float, a: float, j: float) -> tuple[float, float, float, float, float, float, float]:
    """Lengths of the phases of jerk +j, 0, −j, 0, −j, 0, +j of the fastest motion over the distance 1 (P3)."""
    ramp = min(a / j, (v / j) ** 0.5, (1 / (2 * j)) ** (1 / 3))
    # With ramps of full length the plateau is what velocity and distance leave room for.
    plateau = 0.0
    if ramp == a / j:
        plateau = max(0.0, min(v / a - ramp, (ramp * ramp / 4 + 1 / a) ** 0.5 - 1.5 * ramp))
    cruise = max(0.0, 1 / (j * ramp * (ramp + plateau)) - 2 * ramp - plateau)
    return ramp, plateau, ramp, cruise, ramp, plateau, ramp
