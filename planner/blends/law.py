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
from assur.planner.errors import InputError
from assur.planner.model.blendable import LEAST_ACCELERATION_TIME_S

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

    Raises `InputError` for shapes that do not fit, fewer than two poses, times that are not above zero, zones that
    overlap (T_k < τ_{k-1} + τ_k), and straight pieces that last, but less than `SHORTEST`.
    """

    poses: FloatArray
    segments: FloatArray
    tau: FloatArray

    def __post_init__(self) -> None:
        count = len(self.poses)
        if self.poses.ndim != 2 or count < 2 or not np.isfinite(self.poses).all():
            raise InputError("parabolic_blend.poses", self.poses.shape, "two poses or more, finite")
        for name, size in (("segments", count - 1), ("tau", count)):
            value = getattr(self, name)
            if value.shape != (size,) or not (np.isfinite(value) & (value > 0)).all():
                raise InputError(f"parabolic_blend.{name}", value, f"{size} times above zero")
        fits = (np.abs(self._straight) <= MEETS) | (self._straight >= SHORTEST * (1 - 1e-9))
        if not fits.all():
            k = int(np.argmin(fits))
            allowed = f"the sum of its two half blends, or {SHORTEST} s more"
            raise InputError(f"parabolic_blend.segments[{k}]", float(self.segments[k]), allowed)

    @property
    def _straight(self) -> FloatArray:
        """Lengths of the straight pieces (K,), s."""
        return np.asarray(self.segments - self.tau[:-1] - self.tau[1:])

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
        still = np.zeros((1, self.poses.shape[1]))
        return np.concatenate([still, np.diff(self.poses, axis=0) / self.segments[:, None], still])

    @property
    def accelerations(self) -> FloatArray:
        """Acceleration in zone I of each pose (K+1, n)."""
        return np.asarray(np.diff(self.velocities, axis=0) / (2 * self.tau[:, None]))

    @property
    def missed_by(self) -> FloatArray:
        """B3 for each pose (K+1, n); zero for the first and the last, where the motion rests."""
        missed = np.asarray(self.tau[:, None] * np.diff(self.velocities, axis=0) / 4)
        missed[0] = missed[-1] = 0.0
        return missed

    def evaluate(self, t: FloatArray | float, derivative: int = 0) -> FloatArray:
        """q, q̇ or q̈ (derivative 0, 1, 2) at times t (...), (..., n); q̈ from the right. Outside [0, duration]: rest."""
        t = np.asarray(t, dtype=np.float64)
        passed, velocity = self.passed, self.velocities
        k = np.clip(np.searchsorted(passed + self.tau, t, "right"), 0, len(self.tau) - 1)
        s, tau = (t - passed[k])[..., None], self.tau[k][..., None]
        before, behind = velocity[k], velocity[k + 1]
        s = np.minimum(s, tau)
        early = s < -tau  # on the straight piece before zone I of this pose
        if derivative == 0:
            blend = self.poses[k] + (behind * (tau + s) ** 2 - before * (tau - s) ** 2) / (4 * tau)
            return np.asarray(np.where(early, self.poses[k] + before * s, blend))
        if derivative == 1:
            return np.asarray(np.where(early, before, (before * (tau - s) + behind * (tau + s)) / (2 * tau)))
        rest = (t < 0) | (t >= self.duration)
        return np.asarray(np.where(early | rest[..., None], 0.0, self.accelerations[k]))

    def knots(self, begin: float = 0.0) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Times (M,), q, q̇, q̈ (M, n) of a motion that begins at `begin` s: two wherever the acceleration jumps.

        The first and the last are at rest in the outermost poses, to the bit. Times are rounded first, and the way
        between them follows from them, so that pieces are parabolas to the last digits.
        """
        time, rate = [begin], [0 * self.poses[0]]
        ends, velocity = self.passed + self.tau + begin, self.velocities
        for k, tau in enumerate(self.tau):
            if k and self._straight[k - 1] > MEETS:
                time.append(ends[k] - 2 * tau)
                rate.append(velocity[k])
            time.append(ends[k])
            rate.append(velocity[k + 1])
        at, qd = np.array(time), np.array(rate)
        length = np.diff(at)[:, None]
        way = length * (qd[1:] + qd[:-1]) / 2
        q = self.poses[0] + np.concatenate([0 * way[:1], np.cumsum(way, axis=0)])
        q[-1] = self.poses[-1]
        pull = np.concatenate([0 * way[:1], np.diff(qd, axis=0) / length, 0 * way[:1]])
        twice = np.repeat(np.arange(len(at)), 2)
        leaps = np.ones(len(twice), dtype=bool)
        leaps[1::2] = (pull[1:] != pull[:-1]).any(1)
        qdd = np.stack([pull[:-1], pull[1:]], 1).reshape(len(twice), -1)
        which = twice[leaps]
        return at[which], q[which], qd[which], qdd[leaps]
