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
trapezoid. Of more segments the proportions are looked for one by one and in pairs, in steps that shrink from 50 % to
0.2 %, always the best of a round: the same poses give the same times. That is a search, not a proof of the optimum.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.blends.law import LEAST_TAU, MEETS, SHORTEST, ParabolicBlend
from assur.planner.errors import FaultError, InputError

RESERVE = 1e-7
"""Share of the limits that is left free where they are used up by choice: what rounding of short pieces costs."""
STEPS = (0.4, 0.1, 0.03, 0.008, 0.002)
"""Changes of the logarithm of a segment's time that are tried."""
ROUNDS = 40
"""Rounds with one step, at most."""
TOLD_S = 1e-4
"""An acceleration time that would do is told in tenths of a millisecond."""
KEPT = 1e-9
"""Relative. An acceleration that exceeds its limit by less does so by rounding."""


def fastest(
    poses: FloatArray, velocity: FloatArray, acceleration: FloatArray, proportions: FloatArray | None = None
) -> ParabolicBlend:
    """The move through `poses` (K+1, n) with acceleration times of its own choice (B6, B7); limits (n,).

    `proportions` (K,): of the segments' times, if they are known and not to be looked for.
    """
    velocity, acceleration = velocity * (1 - RESERVE), acceleration * (1 - RESERVE)
    way = np.diff(poses, axis=0)
    need = np.abs(way) / velocity, np.abs(way) / acceleration
    least = np.maximum(need[0].max(1), 2 * LEAST_TAU)
    segments = np.maximum(least, np.sqrt(need[1].max(1))) if proportions is None else proportions
    moves = _moves(len(way))
    best = _measured(way, least, acceleration, segments[None])[0][0]
    for step in STEPS if len(way) > 1 and proportions is None else ():
        for _ in range(ROUNDS):
            tried = segments * np.exp(step * moves)
            durations = _measured(way, least, acceleration, tried)[0]
            first = int(np.argmin(durations))
            if not durations[first] < best * (1 - 1e-9):
                break
            best, segments = durations[first], tried[first]
    _, factor, tau = _measured(way, least, acceleration, segments[None])
    return _settled(poses, least, acceleration, segments * factor[0], tau[0] / factor[0])


def _moves(count: int) -> FloatArray:
    """Changes that are tried together: each segment, and each pair of neighbours, longer and shorter, (M, count)."""
    one = np.eye(count)
    two = one[:-1] + one[1:]
    return np.concatenate([one, -one, two, -two])


def _measured(
    way: FloatArray, least: FloatArray, acceleration: FloatArray, segments: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """B6 and B7 for proportions (M, K): durations (M,), factors (M,), and τ (M, K+1) before they are scaled."""
    tau = _half_times(way, acceleration, segments)
    slow = np.maximum((least / segments).max(1), np.sqrt(((tau[:, 1:] + tau[:, :-1]) / segments).max(1)))
    return slow * segments.sum(1) + (tau[:, 0] + tau[:, -1]) / slow, slow, tau


def _half_times(way: FloatArray, acceleration: FloatArray, segments: FloatArray) -> FloatArray:
    """B6: τ (M, K+1) of segments (M, K)."""
    rate = way / segments[:, :, None]
    still = np.zeros_like(rate[:, :1])
    leap = np.diff(np.concatenate([still, rate, still], axis=1), axis=1)
    return np.asarray((np.abs(leap) / (2 * acceleration)).max(2))


def _settled(
    poses: FloatArray, least: FloatArray, acceleration: FloatArray, segments: FloatArray, tau: FloatArray
) -> ParabolicBlend:
    """The move with these times, lengthened where blends or straight pieces would be too short to be written."""
    tau = np.maximum(tau, LEAST_TAU)
    blends = tau[1:] + tau[:-1]
    left = segments - blends
    segments = np.where(left <= MEETS, blends, np.maximum(segments, blends + SHORTEST))
    # what was lengthened may have made a change of velocity greater: slower by as much mends it, and keeps what meets
    need = _half_times(np.diff(poses, axis=0), acceleration, segments[None])[0]
    slower = float(np.maximum(np.sqrt((need / tau).max()), (least / segments).max()))
    if slower > 1:
        segments, tau = segments * slower, tau * slower
        left = segments - tau[1:] - tau[:-1]
        segments = np.where(left <= MEETS, tau[1:] + tau[:-1], segments)
    return ParabolicBlend(poses, segments, tau)


@dataclass(frozen=True, slots=True)
class TooShort:
    """An acceleration time is too short: joint number `joint` would need the acceleration `needed` at pose number
    `pose`, and has `limit`. `enough`: the least acceleration time, s, that would do, told in tenths of a ms, rounded up
    (None: that rounded up it does not, either)."""

    joint: int
    pose: int
    needed: float
    limit: float
    enough: float | None


def with_acceleration_time(
    poses: FloatArray, velocity: FloatArray, acceleration: FloatArray, acceleration_time: float
) -> ParabolicBlend | TooShort:
    """The move through `poses` (K+1, n) whose acceleration times are all the given one, s (B5); limits (n,).

    Raises `InputError` for an acceleration time below 2 `LEAST_TAU`, or that is not a finite number.
    """
    if not (acceleration_time >= 2 * LEAST_TAU and math.isfinite(acceleration_time)):
        raise InputError("acceleration_time_s", acceleration_time, f"{2 * LEAST_TAU} s or more")
    made = _at_full_speed(poses, velocity, acceleration_time)
    size = np.abs(made.accelerations)
    share = size / acceleration
    if (share <= 1 + KEPT).all():
        return made
    pose, joint = (int(x) for x in np.unravel_index(np.argmax(share), share.shape))
    enough = math.ceil(_least_time(poses, velocity, acceleration, acceleration_time) / TOLD_S) * TOLD_S
    does = (np.abs(_at_full_speed(poses, velocity, enough).accelerations) <= acceleration * (1 + KEPT)).all()
    return TooShort(joint, pose, float(size[pose, joint]), float(acceleration[joint]), enough if does else None)


def _least_time(poses: FloatArray, velocity: FloatArray, acceleration: FloatArray, above: float) -> float:
    """The least acceleration time T above `above`, s, with which B5 keeps all accelerations.

    Between the times at which another segment gets longer (B5), a change of velocity is a/T + b: too much where
    A T² < |a + b T|, which is two open intervals of T for each pose and joint. They are gone through from the left.
    With the longest times all segments are T, and |a| ≤ A T² holds at last: there is always an answer.
    """
    way = np.diff(poses, axis=0)
    need = (np.abs(way) / velocity).max(1)
    edges = np.concatenate([[above], np.sort(need[need > above]), [np.inf]])
    for low, high in pairwise(edges):
        grown = (need <= low)[:, None]
        still = np.zeros_like(way[:1])
        a = np.diff(np.concatenate([still, np.where(grown, way, 0.0), still]), axis=0)
        steady = np.divide(way, need[:, None], out=np.zeros_like(way), where=~grown)
        b = np.diff(np.concatenate([still, steady, still]), axis=0)
        # A T² ∓ (a + b T) < 0 between its roots
        a, b = np.stack([a, -a]), np.stack([b, -b])
        root = np.sqrt(np.maximum(b * b + 4 * acceleration * a, 0.0))
        first, last = ((b - root) / (2 * acceleration)).ravel(), ((b + root) / (2 * acceleration)).ravel()
        found = low
        for number in np.argsort(first):
            if first[number] < found < last[number]:
                found = float(last[number])
        if found <= high:
            return float(found)
    raise FaultError("with long enough blends any acceleration is kept")


def _at_full_speed(poses: FloatArray, velocity: FloatArray, acceleration_time: float) -> ParabolicBlend:
    """B5."""
    tau = np.full(len(poses), acceleration_time / 2)
    blends = tau[1:] + tau[:-1]
    segments = np.maximum((np.abs(np.diff(poses, axis=0)) / velocity).max(1), blends)
    short = (segments - blends > MEETS) & (segments - blends < SHORTEST)
    return ParabolicBlend(poses, np.where(short, blends + SHORTEST, segments), tau)
