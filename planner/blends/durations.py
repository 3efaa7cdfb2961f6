"""Times of a move with parabolic blends: as short as the limits of velocity and acceleration of all joints allow.

What has to hold is B4 of `assur.planner.blends.law`. With a given acceleration time 2τ, the same for all
poses, every segment is as fast as the speeds of the joints allow,

    T_k = max( 2τ, max_j |P_k − P_{k-1}|_j / V_j )                                                          (B5)

and the accelerations then are what they are: one that is too large is a refusal with its number.

Else each pose gets the shortest acceleration time that its change of velocity needs,

    2 τ_k = max_j |v_{k+1} − v_k|_j / A_j                                                                   (B6)

and only the segments are free. Slowing a motion down by a factor f divides velocities by f, and with them the τ_k,
while the T_k grow by f. So for any proportions of the segments there is a least factor with which all of B4 holds,

    f = max( max |P_k − P_{k-1}|/(V T_k),  max √((τ_{k-1} + τ_k)/T_k) )    duration = f Σ T_k + (τ_0 + τ_K)/f      (B7)

(above that f the duration only grows). A single segment has no proportions: B7 is then the shortest synchronous
trapezoid. Of more segments the proportions are searched one by one and in pairs, in steps that shrink from 50 % to
0.2 %, always the best of a round: the same poses give the same times. That is a search, not a proof of the optimum.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.blends.law import LEAST_TAU, MEETS, SHORTEST, ParabolicBlend
from assur.planner.model.refusal import AccelerationTime
from assur.planner.trajectory.limits import LIMIT_TOLERANCE

RESERVE = 1e-7
"""Share of the limits that is left free where they are used up by choice: what rounding of short pieces costs."""
STEPS = (0.4, 0.1, 0.03, 0.008, 0.002)
"""Changes of the logarithm of a segment's time that are tried."""
ROUNDS = 40
"""Rounds with one step, at most."""
STATED_S = 1e-4
"""An acceleration time that would do is stated in tenths of a millisecond."""


def fastest(
    poses: FloatArray, velocity: FloatArray, acceleration: FloatArray, proportions: FloatArray | None = None
) -> ParabolicBlend:
    """The move through `poses` (K+1, n) with acceleration times of its own choice (B6, B7); limits (n,).

    `proportions` (K,): of the segments' times, if they are known, and not to be searched.
    """
    velocity, acceleration = velocity * (1 - RESERVE), acceleration * (1 - RESERVE)
    way = np.diff(poses, axis=0)
    need = np.abs(way) / velocity, np.abs(way) / acceleration
    least = np.maximum(need[0].max(1), 2 * LEAST_TAU)
    segments = np.maximum(least, np.sqrt(need[1].max(1))) if proportions is None else proportions
    one = np.eye(len(way))
    two = one[:-1] + one[1:]
    moves = np.concatenate([one, -one, two, -two])
    best = _measured(way, least, acceleration, segments[None])[0][0]
    for step in STEPS if len(way) > 1 and proportions is None else ():
        for _ in range(ROUNDS):
            tried = segments * np.exp(step * moves)
            durations = _measured(way, least, acceleration, tried)[0]
            first = int(np.argmin(durations))
            if not durations[first] < best * (1 - 1e-9):
                break
            best, segments = durations[first], tried[first]
    _, (factor,), (tau,) = _measured(way, least, acceleration, segments[None])
    tau = np.maximum(tau / factor, LEAST_TAU)
    segments = fitting(segments * factor, tau)
    # what was lengthened may have made a change of velocity greater: slower by as much mends it, and keeps what meets
    need = _half_times(way, acceleration, segments[None])[0]
    slower = max(1.0, float(np.sqrt((need / tau).max())), float((least / segments).max()))
    return ParabolicBlend(poses, fitting(segments * slower, tau * slower), tau * slower)


def _measured(
    way: FloatArray, least: FloatArray, acceleration: FloatArray, segments: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """B6 and B7 for proportions (M, K): durations (M,), factors (M,), and τ (M, K+1) before they are scaled."""
    tau = _half_times(way, acceleration, segments)
    slow = np.maximum((least / segments).max(1), np.sqrt(((tau[:, 1:] + tau[:, :-1]) / segments).max(1)))
    return slow * segments.sum(1) + (tau[:, 0] + tau[:, -1]) / slow, slow, tau


def _half_times(way: FloatArray, acceleration: FloatArray, segments: FloatArray) -> FloatArray:
    """B6: τ (M, K+1) of segments (M, K)."""
    leap = np.diff(way / segments[:, :, None], axis=1, prepend=0.0, append=0.0)
    return np.asarray((np.abs(leap) / (2 * acceleration)).max(2))


def fitting(segments: FloatArray, tau: FloatArray) -> FloatArray:
    """Times (K,) of segments, lengthened where zones overlap, or a straight piece is too short to be written."""
    zones = tau[1:] + tau[:-1]
    return np.where(segments - zones <= MEETS, zones, np.maximum(segments, zones + SHORTEST))


def with_acceleration_time(
    poses: FloatArray, velocity: FloatArray, acceleration: FloatArray, given: float
) -> ParabolicBlend | tuple[int, AccelerationTime]:
    """The move through `poses` (K+1, n) whose acceleration times are all `given`, s (B5), limits (n,); or, where that
    is too short, the number of the joint that it would need most of, and the facts."""
    made = _at_full_speed(poses, velocity, given)
    size = np.abs(made.accelerations)
    share = size / acceleration
    if (share <= 1 + LIMIT_TOLERANCE).all():
        return made
    pose, joint = (int(x) for x in np.unravel_index(np.argmax(share), share.shape))
    needed, limit = float(size[pose, joint]), float(acceleration[joint])
    enough = _enough(poses, velocity, acceleration, given)
    return joint, AccelerationTime(given_s=given, needed=needed, limit=limit, enough_s=enough)


def _enough(poses: FloatArray, velocity: FloatArray, acceleration: FloatArray, above: float) -> float | None:
    """The least acceleration time above `above`, s, in tenths of a ms, rounded up, with which B5 keeps the limits.

    Between the times at which another segment gets longer (B5), a change of velocity is a/T + b. It is as large as the
    limit A allows where A T² = |a + b T|, and the least time is one of these.
    """
    way = np.diff(poses, axis=0)
    need = (np.abs(way) / velocity).max(1)
    times, slack = set[float](), 1 + LIMIT_TOLERANCE
    for low, high in pairwise([above, *np.sort(need[need > above]).tolist(), math.inf]):
        grown = (need <= low)[:, None]
        steady = np.divide(way, need[:, None], out=np.zeros_like(way), where=~grown)
        a, b = (np.diff(part, axis=0, prepend=0.0, append=0.0) for part in (np.where(grown, way, 0.0), steady))
        for sign in (1.0, -1.0):
            root = np.sqrt(np.maximum(b * b + sign * 4 * acceleration * a, 0.0))
            found = (sign * b + root) / (2 * acceleration)
            here = found[(low <= found * slack) & (found <= high * slack)]
            times |= {math.ceil(t / STATED_S) * STATED_S for t in here.tolist()}
    for time in sorted(times):
        if (np.abs(_at_full_speed(poses, velocity, time).accelerations) <= acceleration * slack).all():
            return time
    return None


def _at_full_speed(poses: FloatArray, velocity: FloatArray, acceleration_time: float) -> ParabolicBlend:
    """B5."""
    tau = np.full(len(poses), acceleration_time / 2)
    return ParabolicBlend(poses, fitting((np.abs(np.diff(poses, axis=0)) / velocity).max(1), tau), tau)
