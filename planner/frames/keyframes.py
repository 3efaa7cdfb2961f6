"""A frame that passes through given poses at given times, smoothly."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from assur.planner.arrays import FloatArray, frozen
from assur.planner.errors import InputError
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.validity import ALWAYS, FURTHEST_S, SHORTEST_S, KnownLaw, interval, number, placed

Ends = Literal["natural", "clamped"]

ROUNDING = 1e-13
"""Bounds are raised by this part of the largest speed or acceleration of the whole law: rounding of the polynomials."""
CONDITIONS = {"natural": 2, "clamped": 1}
"""The derivative that vanishes at both ends."""


@dataclass(frozen=True, eq=False)
class Keyframes(KnownLaw):
    """A frame that is at `poses` (K) at `times` (K,) s; between them a cubic spline in x, y, z and yaw, C².

    At both ends either the velocity is zero (`clamped`) or the acceleration (`natural`). The law is known from the
    first to the last time, or within `valid` if that is less. Yaw is taken as written: going from 350° to 10° turns
    backwards by 340°. The jerk jumps at the inner times; there the later piece counts.

    In piece i, with τ = t − times[i] (equation F5): x(t) = Σ c_ik τ^k, k = 0..3.

    Raises `InputError` for fewer than two poses, times that do not ascend by a millisecond at least, numbers that
    are not finite, or a `valid` that has nothing in common with the times.
    """

    times: Sequence[float] | FloatArray
    poses: tuple[Pose, ...]
    ends: Ends = "clamped"
    valid: tuple[float, float] = ALWAYS
    _knots: FloatArray = field(init=False, repr=False)
    coefficients: FloatArray = field(init=False, repr=False)
    slack: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        times = frozen(self.times, (None,), "keyframes.times")
        poses = tuple(placed(pose, f"keyframes.poses[{i}]") for i, pose in enumerate(self.poses))
        if not 2 <= len(times) == len(poses):
            raise InputError("keyframes.poses", len(poses), f"as many as times ({len(times)}), two at least")
        for i, time in enumerate(times.tolist()):
            least = -FURTHEST_S if i == 0 else float(times[i - 1]) + SHORTEST_S
            number(time, f"keyframes.times[{i}]", least, FURTHEST_S)
        if self.ends not in get_args(Ends):
            raise InputError("keyframes.ends", self.ends, f"one of {get_args(Ends)}")
        valid = interval(self.valid, "keyframes.valid")
        valid = max(valid[0], float(times[0])), min(valid[1], float(times[-1]))
        if not valid[0] < valid[1]:
            raise InputError("keyframes.valid", self.valid, f"times from {times[0]} to {times[-1]} s")
        pieces = _spline(times, np.array([(p.x, p.y, p.z, p.yaw) for p in poses]), CONDITIONS[self.ends])
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "poses", poses)
        object.__setattr__(self, "valid", valid)
        object.__setattr__(self, "_knots", times)
        object.__setattr__(self, "coefficients", pieces)
        object.__setattr__(self, "slack", ROUNDING * _largest(times, pieces))

    def _motion(self, t: FloatArray, /) -> Motion:
        i = np.clip(np.searchsorted(self._knots, t, side="right") - 1, 0, len(self.coefficients) - 1)
        tau = (t - self._knots[i])[..., None]
        c0, c1, c2, c3 = np.moveaxis(self.coefficients[i], -2, 0)
        x = c0 + tau * (c1 + tau * (c2 + tau * c3))
        xd = c1 + tau * (2.0 * c2 + tau * 3.0 * c3)
        xdd = 2.0 * c2 + 6.0 * tau * c3
        xddd = 6.0 * c3
        rates = (x, xd, xdd, xddd)
        return Motion(*(rate[..., :3] for rate in rates), *(rate[..., 3] for rate in rates))


def _spline(times: FloatArray, values: FloatArray, vanishing: int) -> FloatArray:
    """Coefficients (K-1, 4, 4), powers of τ by coordinates, of the C² cubic spline through `values` (K, 4)."""
    # Imported here: most scenes have no keyframes, and the web process loads every law.
    from scipy.interpolate import CubicSpline

    end = (vanishing, np.zeros(values.shape[1]))
    pieces: FloatArray = np.ascontiguousarray(CubicSpline(times, values, bc_type=(end, end)).c[::-1].transpose(1, 0, 2))
    pieces.flags.writeable = False
    return pieces


def _largest(times: FloatArray, pieces: FloatArray) -> FloatArray:
    """(4,): upper bounds of speed, acceleration, yaw rate and yaw acceleration over the whole law."""
    h = np.diff(times)[:, None]
    c1, c2, c3 = np.moveaxis(np.abs(pieces), 1, 0)[1:]
    speed, acceleration = c1 + 2.0 * h * c2 + 3.0 * h**2 * c3, 2.0 * c2 + 6.0 * h * c3
    travel = [np.linalg.norm(rate[:, :3], axis=1).max() for rate in (speed, acceleration)]
    return np.array([*travel, speed[:, 3].max(), acceleration[:, 3].max()])
