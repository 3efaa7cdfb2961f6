"""A phase law for a path of several parts: slow where it bends, fast between, without a stop (equation Q8).

Each part has a speed at which its bends keep the joints' limits with some reserve, and limits of the acceleration and
jerk along it from what is left. Where parts meet the slower speed counts, or what can be reached on the parts beside.
Ruckig times each part. The law is a proposal: what runs is scaled until the exact extrema of its spline keep the
limits.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.timing import TimingRefusal, time_joints
from assur.planner.trajectory import Trajectory

SAMPLES = 33
"""Places on each part at which the joints' derivatives are looked at."""
OF_BENDS = 0.6
"""Share of the limits of acceleration and jerk that bends may take; the rest is for the motion along the path."""
STEEPER = 2.25
"""The largest third derivative of the quintic over a jump of the second, times its length and over the jump (Q7)."""
HALVINGS = 50
SHARE = 0.98
"""Of a part, what a change of speed may take: Ruckig must not have to turn back for a rounding."""
LEAST = 1e-9
"""Below, a derivative asks for nothing: metres and radians by metres."""


@dataclass(frozen=True, eq=False)
class Bends:
    """Of one part of a path, `length` m: q' and q'' by arc length at SAMPLES places, (SAMPLES, n) each; `over`: how
    far the piece over a jump of the curvature at its beginning reaches altogether, m (0: there is none)."""

    length: float
    first: FloatArray
    second: FloatArray
    over: float


@dataclass(frozen=True, eq=False)
class _Zone:
    length: float
    speed: float
    acceleration: float
    jerk: float


def slowed_at_bends(
    parts: list[Bends], velocity: FloatArray, acceleration: FloatArray, jerk: FloatArray
) -> Trajectory | None:
    """The law s(t) from 0 to 1 over the whole of the parts, for joints (n,) with these limits; None: none was found."""
    zones = [_zone(part, velocity, acceleration, jerk) for part in parts]
    speeds = [0.0, *(min(a.speed, b.speed) for a, b in itertools.pairwise(zones)), 0.0]
    for k in range(1, len(parts)):
        if parts[k].over > 0.0:
            jump = np.abs(parts[k].second[0] - parts[k - 1].second[-1])
            most = np.cbrt(OF_BENDS * jerk * parts[k].over / (STEEPER * np.maximum(jump, LEAST)))
            speeds[k] = min(speeds[k], float(most.min()))
    for k, zone in enumerate(zones):
        speeds[k + 1] = min(speeds[k + 1], _reachable(speeds[k], zone))
    for k, zone in reversed(list(enumerate(zones))):
        speeds[k] = min(speeds[k], _reachable(speeds[k + 1], zone))
    return _timed(zones, speeds)


def _zone(part: Bends, velocity: FloatArray, acceleration: FloatArray, jerk: FloatArray) -> _Zone:
    first, second = np.abs(part.first).max(0), np.abs(part.second).max(0)
    third = np.abs(np.gradient(part.second, part.length / (SAMPLES - 1), axis=0)).max(0)
    first, second, third = (np.maximum(rate, LEAST) for rate in (first, second, third))
    speed = min(
        float((velocity / first).min()),
        float(np.sqrt(OF_BENDS * acceleration / second).min()),
        float(np.cbrt(OF_BENDS * jerk / third).min()),
        # more is not reached on a part of this length
        float(np.sqrt((acceleration / first).min() * part.length)),
    )
    # what bends leave of acceleration and jerk at this speed (L2); both other terms of the jerk share it
    left = jerk - third * speed**3
    pull = min(float(((acceleration - second * speed**2) / first).min()), float((left / (6.0 * second * speed)).min()))
    return _Zone(part.length, speed, pull, float(((left - 3.0 * second * speed * pull) / first).min()))


def _distance(v0: float, v1: float, zone: _Zone) -> float:
    """How far it takes to change the speed, without acceleration at both ends, m."""
    change, a, j = abs(v1 - v0), zone.acceleration, zone.jerk
    lasts = change / a + a / j if change >= a * a / j else 2.0 * (change / j) ** 0.5
    return (v0 + v1) / 2.0 * lasts


def _reachable(v0: float, zone: _Zone) -> float:
    """The greatest speed that can be reached from v0 on all of a zone, or left for v0 (Q8)."""
    low, high = v0, max(v0, zone.speed)
    if _distance(v0, high, zone) <= SHARE * zone.length:
        return high
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        low, high = (middle, high) if _distance(v0, middle, zone) <= SHARE * zone.length else (low, middle)
    return low


def _timed(zones: list[_Zone], speeds: list[float]) -> Trajectory | None:
    none, place, tables = np.zeros(1), 0.0, list[FloatArray]()
    whole, begin = sum(zone.length for zone in zones), 0.0
    for zone, v0, v1 in zip(zones, speeds[:-1], speeds[1:], strict=True):
        found = time_joints(
            np.array([place]),
            np.array([v0]),
            none,
            np.array([place + zone.length]),
            np.array([v1]),
            none,
            np.array([max(zone.speed, v0, v1)]),
            np.array([zone.acceleration]),
            np.array([zone.jerk]),
            begin=begin,
        )
        if isinstance(found, TimingRefusal):
            return None
        tables.append(found.knots if not tables else found.knots[1:])
        place, begin = place + zone.length, found.end
    table = np.concatenate(tables)
    table[:, 1:] /= whole
    if not (np.diff(table[:, 1]) > 0.0).all():
        return None
    table[-1, 1] = 1.0
    return Trajectory.of_knots(np.ascontiguousarray(table))


def faster(law: Trajectory, scale: float) -> Trajectory:
    """The same shape, `scale` times as fast."""
    table = law.knots.copy()
    for order, column in enumerate((1, 2, 3)):
        table[:, column] *= scale**order
    table[:, 0] /= scale
    return Trajectory.of_knots(table)
