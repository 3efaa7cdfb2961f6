"""A frame that passes through given poses at given times, smoothly; once, or again and again."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from assur.planner.arrays import FloatArray, frozen
from assur.planner.errors import InputError
from assur.planner.frames.indexer import reduced
from assur.planner.frames.motion import Motion, Pose
from assur.planner.frames.validity import ALWAYS, FURTHEST_S, SHORTEST_S, KnownLaw, interval, number, placed

Ends = Literal["natural", "clamped", "periodic"]

ROUNDING = 1e-13
"""Bounds are raised by this part of the largest speed or acceleration of the whole law: rounding of the polynomials."""
CONDITIONS = {"natural": 2, "clamped": 1}
"""The derivative that vanishes at both ends."""
WHOLE_TURN_RAD = 1e-12
"""By how much the yaw of a period may miss whole turns, rad: rounding of an angle written in degrees."""


@dataclass(frozen=True, eq=False)
class Keyframes(KnownLaw):
    """A frame that is at `poses` (K) at `times` (K,) s; between them a cubic spline in x, y, z and yaw, C².

    At both ends either the velocity is zero (`clamped`) or the acceleration (`natural`), and the law is known from the
    first to the last time. Or the sequence repeats for ever, before the first time, too (`periodic`): the last pose is
    the first, but for whole turns of the yaw, which add up, and the spline is C² there, as everywhere. `valid` may
    narrow that. Yaw is taken as written: going from 350° to 10° turns backwards by 340°. The jerk jumps at the inner
    times, and where a period ends; there the later piece counts.

    In piece i, with τ = t − times[i] (equation F5): x(t) = Σ c_ik τ^k, k = 0..3. Of a periodic law t is the time after
    whole periods were taken away (equation F9).

    Raises `InputError` for fewer than two poses, times that do not ascend by a millisecond at least, numbers that
    are not finite, a `valid` that has nothing in common with the times, or a period that does not close.
    """

    times: Sequence[float] | FloatArray
    poses: tuple[Pose, ...]
    ends: Ends = "clamped"
    valid: tuple[float, float] = ALWAYS
    period: float = field(init=False, repr=False)
    """Seconds from the first time to the last where the law repeats, else 0."""
    turn: float = field(init=False, repr=False)
    """By how much the yaw goes on in a period, rad: whole turns."""
    knots: FloatArray = field(init=False, repr=False)
    """Times (K,) of the poses: of a periodic law, from the begin of its period."""
    coefficients: FloatArray = field(init=False, repr=False)
    slack: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        times = frozen(self.times, (None,), "keyframes.times")
        poses = tuple(placed(pose, f"keyframes.points[{i}]") for i, pose in enumerate(self.poses))
        if not 2 <= len(times) == len(poses):
            raise InputError("keyframes.points", len(poses), f"as many as times ({len(times)}), two at least")
        for i, time in enumerate(times.tolist()):
            least = -FURTHEST_S if i == 0 else float(times[i - 1]) + SHORTEST_S
            number(time, f"keyframes.points[{i}].time", least, FURTHEST_S)
        if self.ends not in get_args(Ends):
            raise InputError("keyframes.ends", self.ends, f"one of {get_args(Ends)}")
        valid = interval(self.valid, "keyframes.valid")
        knots, period, turn = times, 0.0, 0.0
        if self.ends == "periodic":
            knots, period, turn = times - times[0], float(times[-1] - times[0]), _whole_turns(poses)
            knots.flags.writeable = False
        else:
            valid = max(valid[0], float(times[0])), min(valid[1], float(times[-1]))
        if not valid[0] < valid[1]:
            raise InputError("keyframes.valid", self.valid, f"times from {times[0]} to {times[-1]} s")
        values = np.array([(p.x, p.y, p.z, p.yaw) for p in poses])
        pieces = _periodic(knots, values, turn) if period else _spline(knots, values, CONDITIONS[self.ends])
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "poses", poses)
        object.__setattr__(self, "valid", valid)
        object.__setattr__(self, "period", period)
        object.__setattr__(self, "turn", turn)
        object.__setattr__(self, "knots", knots)
        object.__setattr__(self, "coefficients", pieces)
        object.__setattr__(self, "slack", ROUNDING * _largest(knots, pieces))

    @property
    def turns(self) -> bool:
        """Whether its yaw changes at all."""
        return any(pose.yaw != self.poses[0].yaw for pose in self.poses)

    def _motion(self, t: FloatArray, /) -> Motion:
        turned = np.zeros(t.shape)
        if self.period:
            whole, t = reduced(t, float(self.times[0]), self.period)
            turned = whole * self.turn
        i = np.clip(np.searchsorted(self.knots, t, side="right") - 1, 0, len(self.coefficients) - 1)
        tau = (t - self.knots[i])[..., None]
        c0, c1, c2, c3 = np.moveaxis(self.coefficients[i], -2, 0)
        x = c0 + tau * (c1 + tau * (c2 + tau * c3))
        xd = c1 + tau * (2.0 * c2 + tau * 3.0 * c3)
        xdd = 2.0 * c2 + 6.0 * tau * c3
        xddd = 6.0 * c3
        x[..., 3] += turned
        rates = (x, xd, xdd, xddd)
        return Motion(*(rate[..., :3] for rate in rates), *(rate[..., 3] for rate in rates))


def _whole_turns(poses: tuple[Pose, ...]) -> float:
    """By how much the yaw goes on from the first pose to the last, rad: exact whole turns.

    Raises `InputError` unless the last pose is the first again.
    """
    first, last = poses[0], poses[-1]
    field, allowed = f"keyframes.points[{len(poses) - 1}]", "that of the first point, for the sequence repeats"
    if (last.x, last.y, last.z) != (first.x, first.y, first.z):
        raise InputError(f"{field}.at", last.position.tolist(), allowed)
    turn = math.tau * round((last.yaw - first.yaw) / math.tau)
    if not abs(last.yaw - first.yaw - turn) <= WHOLE_TURN_RAD:
        raise InputError(f"{field}.yaw", last.yaw, f"{allowed}, but for whole turns")
    return turn


def _spline(knots: FloatArray, values: FloatArray, vanishing: int | None) -> FloatArray:
    """Coefficients (K-1, 4, 4), powers of τ by coordinates, of the C² cubic spline through `values` (K, 4), of which
    a derivative vanishes at both ends; None: which is periodic."""
    # Imported here: most scenes have no keyframes, and the web process loads every law.
    from scipy.interpolate import CubicSpline

    end = (vanishing, np.zeros(values.shape[1]))
    condition = "periodic" if vanishing is None else (end, end)
    pieces: FloatArray = np.ascontiguousarray(CubicSpline(knots, values, bc_type=condition).c[::-1].transpose(1, 0, 2))
    pieces.flags.writeable = False
    return pieces


def _periodic(knots: FloatArray, values: FloatArray, turn: float) -> FloatArray:
    """The same of the spline that repeats. A yaw that goes on by `turn` in a period is a line and what is periodic; a
    cubic spline reproduces lines."""
    rate = turn / knots[-1]
    around = values.copy()
    around[:, 3] -= rate * knots
    around[-1] = around[0]
    pieces = _spline(knots, around, None).copy()
    pieces[:, 0], pieces[:, 1, 3] = values[:-1], pieces[:, 1, 3] + rate
    pieces.flags.writeable = False
    return pieces


def _largest(knots: FloatArray, pieces: FloatArray) -> FloatArray:
    """(4,): upper bounds of speed, acceleration, yaw rate and yaw acceleration over the whole law."""
    h = np.diff(knots)[:, None]
    c1, c2, c3 = np.moveaxis(np.abs(pieces), 1, 0)[1:]
    speed, acceleration = c1 + 2.0 * h * c2 + 3.0 * h**2 * c3, 2.0 * c2 + 6.0 * h * c3
    travel = [rate[:, :3].sum(axis=1).max() for rate in (speed, acceleration)]  # no squares: they might underflow
    return np.array([*travel, speed[:, 3].max(), acceleration[:, 3].max()])
