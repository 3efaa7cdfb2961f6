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

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.model.options import LEAST_ACCELERATION_TIME_S

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
