"""The SCARA of source 004: its inverse (equations 1.4 to 1.10) and its joint move with parabolic blends.

Nothing of the planner is used here. The source prints no formulas of its zones; those below (docs/sources.md) give
its total time. Around a pose B that is passed at time T, with the segment's velocity v1 before and v2 behind it:

    zone I,  |t − T| ≤ τ:   q = B − v1 (τ − s)²/4τ + v2 (τ + s)²/4τ,   s = t − T                             (E1)
    zone II, between them:  q = B + v2 (t − T)                                                              (E2)

so that the pose itself is missed by q(T) − B = τ (v2 − v1)/4 (E3). Before the first pose and behind the last one the
arm is at rest: v = 0, the move begins τ before the first pose's time and ends τ behind that of the last, and there
E1 is exactly at the pose. Units are the caller's, angles in radians.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def inverse(p: Array, yaw: Array, a1: float, a2: float, g: int) -> Array:
    """θ1, θ2, d3, θ4 (..., 4) of the tool point p (..., 3) and yaw (...), with configuration index g = sign(sin θ2)."""
    if g not in (-1, 1):
        raise ValueError(f"configuration index {g}: -1 or 1")
    c2 = (p[..., 0] ** 2 + p[..., 1] ** 2 - a1**2 - a2**2) / (2 * a1 * a2)  # (1.4)
    s2 = g * np.sqrt(1 - c2**2)
    theta2 = np.arctan2(s2, c2)  # (1.5)
    along, across = a2 * c2 + a1, a2 * s2
    determinant = along**2 + across**2
    c1 = (along * p[..., 0] + across * p[..., 1]) / determinant  # (1.8)
    s1 = (along * p[..., 1] - across * p[..., 0]) / determinant
    theta1 = np.arctan2(s1, c1)  # (1.9)
    return np.asarray(np.stack([theta1, theta2, p[..., 2], yaw - theta1 - theta2], -1), np.float64)  # (1.3), (1.10)


@dataclass(frozen=True)
class ParabolicBlend:
    """The joint move through `poses` (K, n), `segment` seconds from each to the next, with blends of ±`tau` s."""

    poses: Array
    segment: float
    tau: float

    @property
    def duration(self) -> float:
        return (len(self.poses) - 1) * self.segment + 2 * self.tau

    @property
    def passed(self) -> Array:
        """Times (K,) of the poses."""
        return np.asarray(self.tau + self.segment * np.arange(len(self.poses)), np.float64)

    @property
    def velocities(self) -> Array:
        """Velocities (K + 1, n) of the segments, zero before the first pose and behind the last."""
        still = np.zeros((1, self.poses.shape[1]))
        return np.concatenate([still, np.diff(self.poses, axis=0) / self.segment, still])

    @property
    def missed_by(self) -> Array:
        """E3, for each pose (K, n); what it says of the first and last pose holds at their times, not at the ends."""
        return np.asarray(self.tau * np.diff(self.velocities, axis=0) / 4)

    def evaluate(self, t: Array, derivative: int = 0) -> Array:
        """q, q̇ or q̈ (derivative 0, 1, 2) at times t (T,) in [0, duration], (T, n)."""
        k = np.clip(np.rint((t - self.tau) / self.segment), 0, len(self.poses) - 1).astype(int)
        s = (t - self.passed[k])[:, None]
        before, behind, tau = self.velocities[k], self.velocities[k + 1], self.tau
        if derivative == 0:
            blend = self.poses[k] - before * (tau - s) ** 2 / (4 * tau) + behind * (tau + s) ** 2 / (4 * tau)
            straight = self.poses[k] + np.where(s > 0, behind, before) * s
        elif derivative == 1:
            blend = before * (tau - s) / (2 * tau) + behind * (tau + s) / (2 * tau)
            straight = np.where(s > 0, behind, before)
        else:
            blend = (behind - before) / (2 * tau) + 0 * s
            straight = np.zeros_like(blend)
        return np.asarray(np.where(np.abs(s) <= tau, blend, straight))
