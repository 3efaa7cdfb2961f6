"""Whether a trajectory keeps the joint limits at every instant: exact extrema against limits, accept-if.

Limits are arrays here, each (n,), because robots come after trajectories in the order of the modules.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.trajectory.trajectory import Trajectory

LIMIT_TOLERANCE = 1e-9
"""Relative; of the range for positions. Knots that lie on a limit round to 1e-16 beyond it and extrema are bounded to
1e-13; a thousand times that is still a thousandth of the excess that anyone may find (1e-6)."""
JERK_TOLERANCE = 1e-6
"""Relative. A jerk is a third difference of the knots' numbers: those of a 10 µs piece round it by some rad/s³, a
hundredth of what anyone may find (1e-4)."""
KINDS = ("position", "velocity", "acceleration", "jerk")


@dataclass(frozen=True, slots=True, eq=False)
class LimitCheck:
    """One kind of limit: exact `lower` and `upper` extremes (n,), `ratio` (n,) to the limit (1 is at the limit; for
    positions 1 is at an end of the range and 0 in its middle), whether it is kept, and else the joint that keeps it
    least."""

    kind: str
    lower: FloatArray
    upper: FloatArray
    ratio: FloatArray
    ok: bool
    joint: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class LimitReport:
    """All four kinds; `jerk` is None where it is not limited."""

    position: LimitCheck
    velocity: LimitCheck
    acceleration: LimitCheck
    jerk: LimitCheck | None

    @property
    def checks(self) -> tuple[LimitCheck, ...]:
        limited = self.position, self.velocity, self.acceleration
        return limited if self.jerk is None else (*limited, self.jerk)

    @property
    def ok(self) -> bool:
        return all(check.ok for check in self.checks)


def accepted_bands(
    lower: FloatArray, upper: FloatArray, velocity: FloatArray, acceleration: FloatArray, jerk: FloatArray | None
) -> FloatArray:
    """What a trajectory within limits, each (n,), may reach: lowest and highest q and derivatives, (4, 2, n).

    Beyond the limits by `LIMIT_TOLERANCE` and `JERK_TOLERANCE`. `jerk` None: it is not limited.
    """
    wide = np.full(len(lower), np.inf) if jerk is None else jerk
    rates = np.array([velocity, acceleration, wide]) * (
        1 + np.array([[LIMIT_TOLERANCE], [LIMIT_TOLERANCE], [JERK_TOLERANCE]])
    )
    slack = LIMIT_TOLERANCE * (upper - lower) / 2
    bands = np.empty((4, 2, len(lower)))
    bands[0] = lower - slack, upper + slack
    bands[1:, 0], bands[1:, 1] = -rates, rates
    return bands


def keeps_bands(trajectory: Trajectory, bands: FloatArray) -> bool:
    """Whether a trajectory stays within `accepted_bands`."""
    from assur.planner.kernels.limits import NONE, first_beyond

    return first_beyond(trajectory.knots, bands) == NONE


def check_limits(
    trajectory: Trajectory,
    lower: FloatArray,
    upper: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray | None,
) -> LimitReport:
    """Exact extremes of position, velocity, acceleration and jerk against the limits, each (n,), SI.

    Accepted within `LIMIT_TOLERANCE` and `JERK_TOLERANCE`, nothing else. `jerk` None: not limited; where an
    acceleration jumps no jerk limit is kept. Raises `InputError` for limits that are not n finite numbers, lower below
    upper, rates positive.
    """
    _accept(trajectory, lower, upper, velocity, acceleration, jerk)
    bands = accepted_bands(lower, upper, velocity, acceleration, jerk)
    middle, half = (lower + upper) / 2, (upper - lower) / 2
    checks = []
    for kind, (name, limit) in enumerate(zip(KINDS, (half, velocity, acceleration, jerk), strict=True)):
        if limit is None:
            continue
        least, most = trajectory.extrema(kind)
        off = np.maximum(most - middle, middle - least) if kind == 0 else np.maximum(most, -least)
        ratio = off / limit
        ok = bool((most <= bands[kind, 1]).all() and (least >= bands[kind, 0]).all())
        checks.append(LimitCheck(name, least, most, ratio, ok, None if ok else int(ratio.argmax())))
    return LimitReport(checks[0], checks[1], checks[2], checks[3] if jerk is not None else None)


def _accept(trajectory: Trajectory, lower: FloatArray, upper: FloatArray, *rates: FloatArray | None) -> None:
    """Accepts limits that are n finite numbers each; `InputError` otherwise."""
    for name, limit in zip(("lower", "upper", *KINDS[1:]), (lower, upper, *rates), strict=True):
        if limit is not None and (np.shape(limit) != (trajectory.n,) or not np.isfinite(limit).all()):
            raise InputError(f"limits.{name}", limit, f"{trajectory.n} finite numbers")
    if not (lower < upper).all():
        raise InputError("limits", (lower, upper), "lower below upper")
    for rate in rates:
        if rate is not None and not (rate > 0).all():
            raise InputError("limits", rate, "rates above zero")
