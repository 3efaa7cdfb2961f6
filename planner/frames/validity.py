"""Where a law is known, and what its numbers may be. Nothing is ever extrapolated.

Times outside a law's `valid` interval, NaN and infinite times get NaN motions and infinite bounds here, in one place,
so that no law can forget it.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.frames.law import LawBounds
from assur.planner.frames.motion import Motion, Pose

ALWAYS = (-math.inf, math.inf)
"""The validity of a law that is known for all times."""
FURTHEST_S = 1e6
"""No law is known further than this from time zero, s (11 days): a float there still resolves 0.2 ns. Seconds since
1970 would not do: they resolve 0.2 µs only, too coarse for knots that are 10 µs apart."""
LARGEST = 1e6
"""Largest magnitude, in SI units, of a length, speed, acceleration or angle of a law: above it a unit was mistaken."""
SHORTEST_S = 1e-3
"""Shortest period, move or step between keyframes, s: below it a unit was mistaken."""


def number(value: float, field: str, least: float = -LARGEST, most: float = LARGEST) -> float:
    """`value` as a float from `least` to `most`. Raises `InputError` naming `field` (for NaN and non-numbers too)."""
    try:
        result = float(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(field, value, f"a number from {least:g} to {most:g}") from error
    if not least <= result <= most:
        raise InputError(field, value, f"a number from {least:g} to {most:g}")
    return result


def span(value: float, field: str) -> float:
    """`value` as a duration in seconds, not zero. Raises `InputError` naming `field`."""
    return number(value, field, SHORTEST_S, FURTHEST_S)


def placed(pose: Pose, field: str) -> Pose:
    """`pose`, each coordinate a number of allowed size. Raises `InputError` naming the coordinate."""
    return Pose(*(number(getattr(pose, name), f"{field}.{name}") for name in ("x", "y", "z", "yaw")))


def interval(valid: tuple[float, float], field: str) -> tuple[float, float]:
    """`valid` as two floats, the first below the second; either may be infinite. Raises `InputError`."""
    wanted = "two times, the first below the second"
    try:
        first, last = (float(end) for end in valid)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(field, valid, wanted) from error
    if not (first < last and first < FURTHEST_S and last > -FURTHEST_S):
        raise InputError(field, valid, wanted)
    return first, last


class KnownLaw(ABC):
    """A law that is known over `valid`: its subclasses give `_motion` and `_bounds` for known times only."""

    valid: tuple[float, float]

    def motion(self, t: FloatArray) -> Motion:
        """Pose and three derivatives at times `t` (...), s; NaN in each row whose time is not known."""
        t = np.asarray(t, dtype=np.float64)
        first, last = max(self.valid[0], -FURTHEST_S), min(self.valid[1], FURTHEST_S)
        known = (first <= t) & (t <= last)
        if known.all():
            return self._motion(t)
        found = self._motion(np.where(known, t, first))
        row = known[..., None]
        return Motion(
            *(np.where(row, vector, math.nan) for vector in (found.p, found.v, found.a, found.j)),
            *(np.where(known, angle, math.nan) for angle in (found.yaw, found.yaw_d, found.yaw_dd, found.yaw_ddd)),
        )

    def pose_at(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Position (T, 3) and yaw (T,) at times `t` (T,), as `motion` has them; NaN where the time is not known."""
        first, last = max(self.valid[0], -FURTHEST_S), min(self.valid[1], FURTHEST_S)
        known = (first <= t) & (t <= last)
        if known.all():
            return self._pose(t)
        p, yaw = self._pose(np.where(known, t, first))
        return np.where(known[:, None], p, math.nan), np.where(known, yaw, math.nan)

    def bounds(self, t0: FloatArray, t1: FloatArray, n: FloatArray) -> LawBounds:
        """Bounds over the closed intervals [t0, t1] (N,) along unit vectors `n` (N, 3), see `LawBounds`.

        inf for an interval that is not wholly known, whose ends are NaN, or that ends before it begins.
        """
        first, last = max(self.valid[0], -FURTHEST_S), min(self.valid[1], FURTHEST_S)
        known = (first <= t0) & (t0 <= t1) & (t1 <= last)
        if known.all():
            return self._bounds(t0, t1, n)
        found = self._bounds(np.where(known, t0, first), np.where(known, t1, first), n)
        return LawBounds(
            *(
                np.where(known, bound, math.inf)
                for bound in (found.speed, found.acceleration, found.yaw_rate, found.yaw_acceleration)
            )
        )

    @abstractmethod
    def _motion(self, t: FloatArray, /) -> Motion:
        """As `motion`; each time is finite and known."""

    @abstractmethod
    def _bounds(self, t0: FloatArray, t1: FloatArray, n: FloatArray, /) -> LawBounds:
        """As `bounds`; each interval is known and t0 <= t1."""

    def _pose(self, t: FloatArray, /) -> tuple[FloatArray, FloatArray]:
        """As `pose_at`; each time is finite and known. Laws that know a shorter way than their motion take it."""
        motion = self._motion(t)
        return motion.p, motion.yaw
