"""How long a motion takes at least, in closed form and over whole batches. No solver is asked."""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray, largest

ROUNDING = 1e-12
"""Relative. Taken off every bound: the closed forms round by some 1e-15, and a bound must never exceed the truth."""


def rest_to_rest_time(
    distance: FloatArray | float,
    velocity: FloatArray | float,
    acceleration: FloatArray | float,
    jerk: FloatArray | float,
) -> FloatArray:
    """The minimum time from rest to rest of one joint, elementwise (arguments broadcast), s.

    With V, A, J the limits and D the distance (equation P3):

        D ≤ 2A³/J², D ≤ 2√(V³/J):   T = (32 D/J)^⅓                     neither A nor V is reached
        D ≤ V (V/A + A/J), V J ≥ A²:  T = A/J + √(A²/J² + 4D/A)          A is reached, V is not
        else:                        T = D/V + (V/A + A/J  or, if V J < A²,  2√(V/J))

    Distances count by magnitude; 0 gives 0. Tested against the solver.
    """
    d, v = np.abs(np.asarray(distance, dtype=np.float64)), np.asarray(velocity, dtype=np.float64)
    a, j = np.asarray(acceleration, dtype=np.float64), np.asarray(jerk, dtype=np.float64)
    sharp = v * j < a * a
    ramp = np.where(sharp, 2 * np.sqrt(v / j), v / a + a / j)
    short = np.where(sharp, 2 * np.sqrt(v**3 / j), 2 * a**3 / j**2)
    cruise = d / v + ramp
    cubic = np.cbrt(32 * d / j)
    middle = a / j + np.sqrt((a / j) ** 2 + 4 * d / a)
    return np.asarray(np.where(d <= short, cubic, np.where(~sharp & (d <= v * ramp), middle, cruise)))


def least_duration(
    q0: FloatArray,
    v0: FloatArray,
    a0: FloatArray,
    q1: FloatArray,
    v1: FloatArray,
    a1: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray | None,
) -> FloatArray:
    """A lower bound of the duration of any motion between two states within the limits, (...), s.

    The greatest over the joints of: the time-optimal double integrator in (position, velocity) under V and A; the
    same in (velocity, acceleration) under A and J; and equation P3 for joints that are at rest at both ends, which is
    then the minimum itself. Each drops a constraint, so none exceeds the minimum. `jerk` None: no jerk is limited, and
    the first of the three is all that is true.

    Arguments: states (..., n), limits (n,) or (..., n); all broadcast. States beyond the limits, or NaN, give NaN
    or a number without meaning: they have no motion.
    """
    states = (q0, v0, a0, q1, v1, a1)
    q0, v0, a0, q1, v1, a1 = (np.asarray(state, dtype=np.float64) for state in states)
    still = (v0 == 0) & (v1 == 0) & (a0 == 0) & (a1 == 0)
    if jerk is not None and still.all():
        bound = rest_to_rest_time(q1 - q0, velocity, acceleration, jerk)
    else:
        bound = _double_integrator(q1 - q0, v0, v1, velocity, acceleration)
        if jerk is not None:
            bound = np.maximum(bound, _double_integrator(v1 - v0, a0, a1, acceleration, jerk))
            if still.any():
                bound = np.where(still, rest_to_rest_time(q1 - q0, velocity, acceleration, jerk), bound)
    return largest(bound) * (1 - ROUNDING)


def _double_integrator(
    x: FloatArray, v0: FloatArray, v1: FloatArray, speed: FloatArray, rate: FloatArray
) -> FloatArray:
    """Minimum time over the distance x from velocity v0 to v1 with |v| <= speed and |v̇| <= rate (equation P4).

    σ is the sign of what is left when v0 changes to v1 at once; then σ rate up to the velocity
    σ√(σ rate x + (v0² + v1²)/2), or a stretch at σ speed, and −σ rate down to v1.
    """
    direct = (v0 + v1) * np.abs(v1 - v0) / (2 * rate)
    sign = np.where(x >= direct, 1.0, -1.0)
    x, v0, v1 = sign * x, sign * v0, sign * v1
    peak = np.sqrt(np.maximum(rate * x + (v0 * v0 + v1 * v1) / 2, 0.0))
    quick = (2 * peak - v0 - v1) / rate
    long = (2 * speed - v0 - v1) / rate + (x - (2 * speed * speed - v0 * v0 - v1 * v1) / (2 * rate)) / speed
    return np.asarray(np.where(peak <= speed, quick, long))
