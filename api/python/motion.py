"""The motion of a planned answer as arrays of NumPy: its knots, and its states at any times.

All of it is in the convention of the answer's document: joints in the order of `joint_names`, with the signs and zeros
of the robot's maker, in rad and m, times in seconds of the request's clock.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from assur.planner.trajectory import Trajectory as Spline

MOST_SAMPLES = 10_000_000
"""So many samples are taken at once at most: with four joints they are 1.3 GB."""
ROUNDING = 1e-9
"""A step that ends within this share of itself before the end counts as the end: 1.5 s are 375 steps of 4 ms."""


@dataclass(frozen=True, eq=False)
class Samples:
    """States at `times` (N,) s: `positions`, `velocities`, `accelerations`, `jerks`, each (N, n), a column for each of
    `joint_names`; rad or m as `joint_units` says, and their derivatives by time."""

    joint_names: tuple[str, ...]
    joint_units: tuple[str, ...]
    times: FloatArray
    positions: FloatArray
    velocities: FloatArray
    accelerations: FloatArray
    jerks: FloatArray


class Trajectory:
    """The knots of a planned motion, read-only, and the quintic Hermite spline through them, which is what is proved.

    `times` (K,) s; `positions`, `velocities`, `accelerations` (K, n), a column for each of `joint_names`, rad or m as
    `joint_units` says. Where the acceleration jumps (parabolic blends) two knots have the same time.
    """

    def __init__(self, document: dict[str, Any]) -> None:
        """`document`: the part `trajectory` of a planned answer. Raises `InputError` for knots that are none."""
        from assur.planner.trajectory import Trajectory as Spline

        for key in ("joint_names", "joint_units", "time_s", "position", "velocity", "acceleration"):
            if key not in document:
                raise InputError(f"trajectory.{key}", "nothing", "what a planned answer holds there")
        self.joint_names = tuple(map(str, document["joint_names"]))
        self.joint_units = tuple(map(str, document["joint_units"]))
        self._spline: Spline = Spline(
            document["time_s"],
            document["position"],
            document["velocity"],
            document["acceleration"],
            jumps=bool(document.get("acceleration_jumps", False)),
        )
        if not len(self.joint_names) == len(self.joint_units) == self._spline.n:
            raise InputError("trajectory.joint_names", self.joint_names, f"{self._spline.n} names, and as many units")

    @property
    def times(self) -> FloatArray:
        return self._spline.time

    @property
    def positions(self) -> FloatArray:
        return self._spline.q

    @property
    def velocities(self) -> FloatArray:
        return self._spline.qd

    @property
    def accelerations(self) -> FloatArray:
        return self._spline.qdd

    @property
    def start_s(self) -> float:
        """Time of the first knot, s of the request's clock."""
        return self._spline.start

    @property
    def end_s(self) -> float:
        """Time of the last knot, s of the request's clock."""
        return self._spline.end

    @cached_property
    def duration_s(self) -> float:
        return self._spline.duration

    def sample(self, dt: float) -> Samples:
        """The states every `dt` seconds from the start on, and the one at the end.

        The last two are less than `dt` apart where the duration is no multiple of it. Raises `InputError` for a step
        that is no number, or not more than 0, or that would give more than 10,000,000 samples.
        """
        step, least = _number(dt), self.duration_s / MOST_SAMPLES
        if not (step > 0 and math.isfinite(step) and self.duration_s / step <= MOST_SAMPLES):
            raise InputError("dt", dt, f"a step in s, a number of at least {least:.3g}: a sample takes memory")
        whole = math.ceil(self.duration_s / step * (1 - ROUNDING))
        times = np.minimum(self.start_s + step * np.arange(whole + 1), self.end_s)
        times[-1] = self.end_s
        return self.at(times)

    def at(self, times: ArrayLike) -> Samples:
        """The states at `times` (N,), or at one time (N = 1), in any order, from `start_s` to `end_s`.

        At a knot the piece that begins there counts, which matters for the jerk, and for an acceleration that jumps.
        Raises `InputError` for a time outside: nothing is known of the robot there.
        """
        wanted = np.atleast_1d(np.array(times, dtype=np.float64))
        if wanted.ndim != 1:
            raise InputError("times", wanted.shape, "one time, or a list of times")
        outside = ~((wanted >= self.start_s) & (wanted <= self.end_s))
        if outside.any():
            raise InputError("times", float(wanted[outside][0]), f"{self.start_s!r} to {self.end_s!r} s")
        states = self._spline.states(wanted)
        return Samples(self.joint_names, self.joint_units, wanted, *states, self._spline.evaluate(wanted, 3))

    def __repr__(self) -> str:
        return f"<Trajectory of {', '.join(self.joint_names)}: {len(self.times)} knots, {self.duration_s:.3f} s>"


def _number(value: object) -> float:
    """A real number of Python or NumPy as a float; NaN for what is none, or is beyond all floats."""
    one = value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value
    if isinstance(one, bool) or not isinstance(one, Real):
        return math.nan
    try:
        return float(one)
    except OverflowError:
        return math.nan
