"""The joint move with parabolic blends: straight in joint space at constant speed, and a parabola around each pose.

Poses P_0 … P_K, segment k of duration T_k from P_{k-1} to P_k with v_k = (P_k − P_{k-1})/T_k, and v_0 = v_{K+1} = 0.
Pose k belongs to its nominal time t_k = τ_0 + T_1 + … + T_k, and half of its acceleration time is τ_k. With s = t − t_k

    zone I,  |s| ≤ τ_k:  q = P_k − v_k (τ_k − s)²/4τ_k + v_{k+1} (τ_k + s)²/4τ_k                             (B1)
    zone II, between:    q = P_k + v_{k+1} s                                                                (B2)

so that q̇ goes linearly from v_k to v_{k+1}, and pose k is missed by

    q(t_k) − P_k = τ_k (v_{k+1} − v_k)/4                                                                    (B3)

The motion begins at rest in P_0 at the time 0, τ_0 before its nominal time, and ends at rest in P_K, τ_K behind that of
the last pose: there B1 is at the pose. Velocity is continuous, acceleration jumps, the jerk has no bound.

What it keeps: in zone I a velocity lies between v_k and v_{k+1}, the acceleration is constant, and the parabola is the
Bézier curve of P_k − τ_k v_k, P_k, P_k + τ_k v_{k+1}, which are on the polygon of the poses as long as the zones do not
overlap. So with limits V, A and a range of each joint that holds all poses, all limits are kept if and only if

    T_k ≥ τ_{k-1} + τ_k        |P_k − P_{k-1}| ≤ V T_k        |v_{k+1} − v_k| ≤ 2 τ_k A                     (B4)

for all segments, poses and joints (Source 004; its zones are not printed, docs/sources.md).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.options import LEAST_ACCELERATION_TIME_S
from assur.planner.model.refusal import AccelerationTime
from assur.planner.trajectory.trajectory import LIMIT_TOLERANCE

SHORTEST = 1e-5
"""s. The shortest straight piece; else zones meet. Over 10 µs, rounding of positions costs a velocity of 1e-10 rad/s
and an acceleration of 1e-4 rad/s², where there should be none."""
MEETS = 1e-12
"""s. Zones that are no further apart, or overlap no more, meet: rounding of sums of times."""
LEAST_TAU = LEAST_ACCELERATION_TIME_S / 2
"""s. Half of the shortest acceleration time."""


@dataclass(frozen=True, eq=False)
class ParabolicBlend:
    """The move through `poses` (K+1, n) with `segments` (K,) s from each to the next and half acceleration times `tau`
    (K+1,) s.

    Zones may meet; straight pieces that last are `SHORTEST` or longer (`durations.fitting`).
    """

    poses: FloatArray
    segments: FloatArray
    tau: FloatArray

    @property
    def duration(self) -> float:
        return float(self.tau[0] + self.segments.sum() + self.tau[-1])

    @property
    def passed(self) -> FloatArray:
        """Nominal times t_k (K+1,) of the poses, from the begin of the motion."""
        return np.asarray(self.tau[0] + np.concatenate([[0.0], np.cumsum(self.segments)]))

    @property
    def velocities(self) -> FloatArray:
        """v_0 … v_{K+1} (K+2, n), the first and the last zero."""
        return np.pad(np.diff(self.poses, axis=0) / self.segments[:, None], ((1, 1), (0, 0)))

    @property
    def accelerations(self) -> FloatArray:
        """Acceleration in zone I of each pose (K+1, n)."""
        return np.asarray(np.diff(self.velocities, axis=0) / (2 * self.tau[:, None]))

    @property
    def missed_by(self) -> FloatArray:
        """B3 for each pose (K+1, n); zero for the first and the last, where the motion rests."""
        missed = self.tau[:, None] * np.diff(self.velocities, axis=0) / 4
        return np.pad(missed[1:-1], ((1, 1), (0, 0)))

    def knots(self, begin: float) -> FloatArray:
        """Knots (M, 1 + 3n) of a motion that begins at `begin` s, two at each time at which the acceleration jumps.

        The first and the last are at rest in the outermost poses, to the bit. Times are rounded first, and the way
        between them follows from them, so that pieces are parabolas to the last digits.
        """
        time, rate = [begin], [0 * self.poses[0]]
        ends, velocity = self.passed + self.tau + begin, self.velocities
        for k, tau in enumerate(self.tau):
            if k and self.segments[k - 1] - self.tau[k - 1] - tau > MEETS:
                time.append(ends[k] - 2 * tau)
                rate.append(velocity[k])
            time.append(ends[k])
            rate.append(velocity[k + 1])
        at, qd = np.array(time), np.array(rate)
        length = np.diff(at)[:, None]
        way = length * (qd[1:] + qd[:-1]) / 2
        q = self.poses[0] + np.cumsum(np.concatenate([0 * way[:1], way]), axis=0)
        q[-1] = self.poses[-1]
        pull = np.concatenate([0 * way[:1], np.diff(qd, axis=0) / length, 0 * way[:1]])
        both = [np.column_stack([at, q, qd, side]) for side in (pull[:-1], pull[1:])]
        jumps = (pull[1:] != pull[:-1]).any(1)
        return np.asarray(np.stack(both, 1)[np.column_stack([np.ones_like(jumps), jumps])])


# Times of a move with parabolic blends: as short as the limits of velocity and acceleration of all joints allow.
#
# What has to hold is B4 of `assur.planner.blends.law`. With a given acceleration time 2τ, the same for all poses, every
# segment is as fast as the speeds of the joints allow,
#
# T_k = max( 2τ, max_j |P_k − P_{k-1}|_j / V_j ) (B5)
#
# and the accelerations then are what they are: one that is too large is a refusal with its number.
#
# Else each pose gets the shortest acceleration time that its change of velocity needs,
#
# 2 τ_k = max_j |v_{k+1} − v_k|_j / A_j (B6)
#
# and only the segments are free. Slowing a motion down by a factor f divides velocities by f, and with them the τ_k,
# while the T_k grow by f. So for any proportions of the segments there is a least factor with which all of B4 holds,
#
# f = max( max |P_k − P_{k-1}|/(V T_k), max √((τ_{k-1} + τ_k)/T_k) ) duration = f Σ T_k + (τ_0 + τ_K)/f (B7)
#
# (above that f the duration only grows). A single segment has no proportions: B7 is then the shortest synchronous
# trapezoid. Of more segments the proportions are searched one by one and in pairs, in steps that shrink from 50 % to
# 0.2 %, always the best of a round: the same poses give the same times. That is a search, not a proof of the optimum.

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
