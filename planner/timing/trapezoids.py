"""Trapezoidal velocity profiles between states, many at once: what Ruckig's motions are like, for a first look.

Jerk is not limited. That a jerk-limited motion needs longer to change its velocity is told by a lower acceleration.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.timing.bounds import least_duration

MET = 1e-6
"""An end is met to this, rad or m: the closed form rounds by some 1e-9."""


def mean_acceleration(velocity: FloatArray, acceleration: FloatArray, jerk: FloatArray) -> FloatArray:
    """The mean acceleration (...) of a jerk-limited change of velocity by `velocity`, which takes V/A + A/J."""
    found: FloatArray = velocity / (velocity / acceleration + acceleration / jerk)
    return found


def trapezoid_time(
    q0: FloatArray, v0: FloatArray, q1: FloatArray, v1: FloatArray, velocity: FloatArray, acceleration: FloatArray
) -> FloatArray:
    """The least time (...) in which all joints (..., n) get from one state to the other."""
    still = np.zeros(1)
    return least_duration(q0, v0, still, q1, v1, still, velocity, acceleration, None)


def stopping_distance(speed: FloatArray, acceleration: FloatArray, jerk: FloatArray) -> FloatArray:
    """The least distance (...) in which a joint that does not accelerate gets from `speed` to 0."""
    onset = np.sqrt(2 * np.minimum(speed, acceleration**2 / (2 * jerk)) / jerk)
    rest = np.maximum(speed - jerk * onset**2 / 2, 0.0)
    found: FloatArray = speed * onset - jerk * onset**3 / 6 + rest**2 / (2 * acceleration)
    return found


@dataclass(frozen=True, eq=False)
class Trapezoids:
    """Profiles (..., n) over [0, `duration`] (...): a ramp to velocity `cruise`, on with it, and a ramp to `v1`."""

    q0: FloatArray
    v0: FloatArray
    q1: FloatArray
    v1: FloatArray
    cruise: FloatArray
    acceleration: FloatArray
    duration: FloatArray

    @classmethod
    def of(
        cls,
        q0: FloatArray,
        v0: FloatArray,
        q1: FloatArray,
        v1: FloatArray,
        acceleration: FloatArray,
        duration: FloatArray,
    ) -> Trapezoids:
        """Profiles that take exactly `duration` (...), at least `trapezoid_time`.

        Not every longer duration is possible for a joint that is fast at its ends, either: if it cannot slow down as
        much, it ends elsewhere (`meets`).

        With D the distance left, T the duration and a the acceleration, the way at cruising velocity c is
        −c²/a + c (T + (v0 + v1)/a) − (v0² + v1²)/(2a) if c is above both ends, linear in c between them, and the mirror
        image below both (equation P5).
        """
        distance, t, a = q1 - q0, duration[..., None], acceleration
        low, high = np.minimum(v0, v1), np.maximum(v0, v1)
        between = t - (high - low) / a
        ramp = (high**2 - low**2) / (2 * a)
        above = distance > ramp + high * between
        sign = np.where(above, 1.0, -1.0)
        b = t + sign * (v0 + v1) / a
        c = sign * distance + (v0**2 + v1**2) / (2 * a)
        beyond = sign * (a / 2) * (b - np.sqrt(np.maximum(b * b - 4 * c / a, 0.0)))
        linear = (distance - ramp) / np.where(between > 0, between, 1.0)
        inside = ~above & (distance >= ramp + low * between) & (between > 0)
        return cls(q0, v0, q1, v1, np.where(inside, linear, beyond), a, duration)

    def at(self, t: FloatArray) -> FloatArray:
        """q (..., n) at times t (...), counted from the begin of each profile."""
        t, a = np.clip(t, 0.0, self.duration)[..., None], self.acceleration
        first, last = np.abs(self.cruise - self.v0) / a, self.duration[..., None] - np.abs(self.v1 - self.cruise) / a
        up, on, down = np.minimum(t, first), np.maximum(np.minimum(t, last) - first, 0.0), np.maximum(t - last, 0.0)
        found: FloatArray = self.q0 + (self.v0 + np.sign(self.cruise - self.v0) * (a / 2) * up) * up
        return found + self.cruise * on + (self.cruise + np.sign(self.v1 - self.cruise) * (a / 2) * down) * down

    def meets(self) -> BoolArray:
        """Which joints (..., n) end where they should."""
        return np.asarray(np.abs(self.at(self.duration) - self.q1) <= MET)

    def turning_points(self, acceleration: FloatArray, jerk: FloatArray) -> FloatArray:
        """q (2, ..., n) where each joint turns round in its first and in its last ramp, were its acceleration and jerk
        limited by these; where it does not turn, its ends."""
        first, last = self.v0 * self.cruise < 0, self.v1 * self.cruise < 0
        before = np.where(first, np.sign(self.v0) * stopping_distance(np.abs(self.v0), acceleration, jerk), 0.0)
        behind = np.where(last, np.sign(self.v1) * stopping_distance(np.abs(self.v1), acceleration, jerk), 0.0)
        return np.stack([self.q0 + before, self.q1 - behind])

    def some(self, key: tuple[object, ...]) -> Trapezoids:
        """Some of the profiles."""
        parts = (self.q0, self.v0, self.q1, self.v1, self.cruise, self.acceleration, self.duration)
        return Trapezoids(*(part[key] for part in parts))  # type: ignore[index]
