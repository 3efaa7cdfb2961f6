"""Whether a trajectory keeps the joint limits at every instant: exact extrema against limits, accept-if.

Limits are arrays here, each (n,), because robots come after trajectories in the order of the modules.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import InputError
from assur.planner.trajectory.extremum import TIGHTNESS, cut, maxima
from assur.planner.trajectory.trajectory import Trajectory

LIMIT_TOLERANCE = 1e-9
"""Relative; of the range for positions. Knots that lie on a limit round to 1e-16 beyond it and extrema are bounded to
1e-13; a thousand times that is still a thousandth of the excess that anyone may find (1e-6)."""
JERK_TOLERANCE = 1e-6
"""Relative. A jerk is a third difference of the knots' numbers: those of a 1 µs piece round it by 1e-2 rad/s³, a
hundredth of what anyone may find (1e-4)."""
KINDS = ("position", "velocity", "acceleration", "jerk")


@dataclass(frozen=True, slots=True, eq=False)
class LimitCheck:
    """One kind of limit: exact `lower` and `upper` extremes (n,), `ratio` (n,) to the limit (1 is at the limit; for
    positions 1 is at an end of the range and 0 in its middle), whether it is kept, and else by which joint first, when.
    """

    kind: str
    lower: FloatArray
    upper: FloatArray
    ratio: FloatArray
    ok: bool
    joint: int | None = None
    time: float | None = None


@dataclass(frozen=True, slots=True, eq=False)
class LimitReport:
    """All four kinds; `jerk` is None where it was not asked."""

    position: LimitCheck
    velocity: LimitCheck
    acceleration: LimitCheck
    jerk: LimitCheck | None

    @property
    def checks(self) -> tuple[LimitCheck, ...]:
        asked = self.position, self.velocity, self.acceleration
        return asked if self.jerk is None else (*asked, self.jerk)

    @property
    def ok(self) -> bool:
        return all(check.ok for check in self.checks)


_Band = tuple[FloatArray, FloatArray, float]
"""Lower and upper limit (n,), and the relative tolerance."""


def _positions(trajectory: Trajectory, lower: FloatArray, upper: FloatArray) -> _Band:
    for name, limit in (("lower", lower), ("upper", upper)):
        _accept(trajectory, name, limit)
    if not (lower < upper).all():
        raise InputError("limits", (lower, upper), "lower below upper")
    return lower, upper, LIMIT_TOLERANCE


def _rates(trajectory: Trajectory, *rates: FloatArray) -> list[_Band]:
    """Of velocity, acceleration and, if it is among the rates, jerk."""
    for name, rate in zip(KINDS[1:], rates, strict=False):
        _accept(trajectory, name, rate)
        if not (rate > 0).all():
            raise InputError("limits", rate, "rates above zero")
    return [(-r, r, tol) for r, tol in zip(rates, (LIMIT_TOLERANCE, LIMIT_TOLERANCE, JERK_TOLERANCE), strict=False)]


def _accept(trajectory: Trajectory, name: str, limit: FloatArray) -> None:
    if np.shape(limit) != (trajectory.n,) or not np.isfinite(limit).all():
        raise InputError(f"limits.{name}", limit, f"{trajectory.n} finite numbers")


def _kept(trajectory: Trajectory, kind: int, low: FloatArray, high: FloatArray, tol: float) -> bool:
    """Whether a kind stays within its band; from hulls where they suffice."""
    slack = tol * (high - low) / 2
    hull = trajectory.bernstein(kind)
    smooth = kind < 3 or not trajectory.jumps
    if smooth and (hull.max(0).max(1) <= high + slack).all() and (hull.min(0).min(1) >= low - slack).all():
        return True
    least, most = trajectory.extrema(kind)
    return bool((most <= high + slack).all() and (least >= low - slack).all())


def keeps_limits(
    trajectory: Trajectory,
    lower: FloatArray,
    upper: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray | None,
) -> bool:
    """Whether all limits are kept; what `check_limits(...).ok` says."""
    rates = (velocity, acceleration) if jerk is None else (velocity, acceleration, jerk)
    bands = [_positions(trajectory, lower, upper), *_rates(trajectory, *rates)]
    return all(_kept(trajectory, kind, *band) for kind, band in enumerate(bands))


def keeps_positions(trajectory: Trajectory, lower: FloatArray, upper: FloatArray) -> bool:
    """Whether the limits of position are kept; what `check_limits(...).position.ok` says."""
    return _kept(trajectory, 0, *_positions(trajectory, lower, upper))


def rate_ratios(
    trajectory: Trajectory, velocity: FloatArray, acceleration: FloatArray, jerk: FloatArray
) -> tuple[FloatArray, bool]:
    """Exact peaks of velocity, acceleration and jerk over their limits, (3, n), and whether all are kept; what
    `check_limits` says of them, without a search for where they are not."""
    bands = _rates(trajectory, velocity, acceleration, jerk)
    found = [_peak(trajectory, kind, *band) for kind, band in enumerate(bands, start=1)]
    return np.stack([ratio for _, _, ratio, _ in found]), all(ok for *_, ok in found)


def _peak(
    trajectory: Trajectory, kind: int, low: FloatArray, high: FloatArray, tol: float
) -> tuple[FloatArray, FloatArray, FloatArray, bool]:
    """Extremes of a kind, their ratio to the band, and whether they are in it."""
    least, most = trajectory.extrema(kind)
    middle, half = (low + high) / 2, (high - low) / 2
    slack = tol * half
    ratio = np.maximum(most - middle, middle - least) / half
    return least, most, ratio, bool((most <= high + slack).all() and (least >= low - slack).all())


def check_limits(
    trajectory: Trajectory,
    lower: FloatArray,
    upper: FloatArray,
    velocity: FloatArray,
    acceleration: FloatArray,
    jerk: FloatArray | None,
) -> LimitReport:
    """Exact extremes of position, velocity, acceleration and jerk against the limits, each (n,), SI.

    Accepted within `LIMIT_TOLERANCE` and `JERK_TOLERANCE`, nothing else. `jerk` None: not asked; where an acceleration
    jumps no jerk limit is kept. Raises `InputError` for limits that are not
    n finite numbers, lower below upper, rates positive.
    """
    checks = []
    rates = (velocity, acceleration) if jerk is None else (velocity, acceleration, jerk)
    bands = [_positions(trajectory, lower, upper), *_rates(trajectory, *rates)]
    for kind, (low, high, tol) in enumerate(bands):
        least, most, ratio, ok = _peak(trajectory, kind, low, high, tol)
        slack = tol * (high - low) / 2
        where = (None, None) if ok else first_break(trajectory, kind, low - slack, high + slack)
        checks.append(LimitCheck(KINDS[kind], least, most, ratio, ok, *where))
    return LimitReport(checks[0], checks[1], checks[2], checks[3] if jerk is not None else None)


def first_break(
    trajectory: Trajectory, derivative: int, low: FloatArray, high: FloatArray
) -> tuple[int | None, float | None]:
    """The joint that leaves [low, high] (n,) first, and a time within 1e-9 of its piece's length of when it does.

    (None, None) if none does. Pieces are asked in the order of time; the one that leaves is halved, left half first.
    """
    hull = trajectory.bernstein(derivative)
    out = ~((hull.max(2) <= high) & (hull.min(2) >= low))
    for k in np.flatnonzero(out.any(1)):
        found: list[tuple[float, int]] = []
        for joint in map(int, np.flatnonzero(out[k])):
            for row, bound in ((hull[k, joint], high[joint]), (-hull[k, joint], -low[joint])):
                s = _first_above(row, float(bound))
                if s is not None:
                    found.append((s, joint))
        if found:
            s, joint = min(found)
            return joint, float(trajectory.edges[k] + s * trajectory.steps[k])
    return None, None


def _exceeds(row: FloatArray, bound: float) -> bool:
    """Whether a polynomial (d+1,) exceeds `bound` somewhere on [0, 1], by its rigorous maximum."""
    taken = np.array([max(row[0], row[-1])])
    slack = np.array([TIGHTNESS * np.abs(row).max()])
    return not maxima(row[None], np.zeros(1, dtype=np.int64), taken, slack)[0] <= bound


def _first_above(row: FloatArray, bound: float) -> float | None:
    """Where on [0, 1] a polynomial (d+1,) first exceeds `bound`: bisection, asking the left half first."""
    if not _exceeds(row, bound):
        return None
    begin, length = 0.0, 1.0
    while length > 1e-9 and row[0] <= bound:
        left, right = cut(row[None], np.array([0.5]))
        length /= 2
        if _exceeds(left[0], bound):
            row = left[0]
        else:
            row, begin = right[0], begin + length
    return begin
