"""The phase law s(t) of a line that takes the joints from end to end in the least time, all but.

The jerk of s is constant on each of N equal parts of the time. Position, velocity and acceleration are linear in these
N jerks, the time that a law needs follows from its shape (equation L4 of docs/kinematics.md), and is made least. A law
is a proposal: what runs is a spline through knots, whose exact extrema decide (`assur.planner.legs.limits`).
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.legs.line import FLAT, LineRates, Seen
from assur.planner.robots.facts import Limits
from assur.planner.timing import RawProfile, Solver, TimingRefusal, trajectory_of
from assur.planner.trajectory import Trajectory

PIECES = 12
"""Parts of a law. Over Ruckig's joint move (median, lines of the benchmark) 8 reach 1.11, 12 reach 1.05, 24 reach 1.02;
each part adds two or three knots to a leg."""
SAMPLES = 4
"""Steps per part at whose ends the rates are compared: between them they rise by a few tenths of a percent."""
TABLE = 401
"""Points of a line at which the joints' derivatives by s are tabled, linear in between; 2 mm on a line of 0.8 m."""
STAGES = ((8, 5), (32, 5), (128, 5))
"""Exponents of the norm that stands for the largest rate, each with its steps at most. The last is within
4 % of the maximum of 150 equal rates; a hundred were flatter to descend."""
PASSED_OVER = 1e-3
"""Rates that count with less than this in the squares, against the largest, are left out of a step."""
SETTLED = 1e-3
"""Relative. A step that gains less ends its stage: a leg of 0.5 s is then known to half a millisecond."""
DAMPING, LEAST_DAMPING, RISE, FALL, TRIES = 1e-3, 1e-9, 8.0, 6.0, 6
"""Levenberg-Marquardt: damping to begin with and at least, its factors after a failed and a good step, and tries."""
BACK = 1e-9
"""1. A law whose ṡ, in shares of the mean speed, falls below minus this goes backwards: not proposed. Rounding."""
SHORTEST_S = 1e-3
"""A law of less is not proposed: knots some 10 µs apart do not carry its jerk."""


def quickest(derivatives: tuple[FloatArray, FloatArray, FloatArray], limits: Limits) -> Trajectory | None:
    """The law found for a line whose joints' q', q'', q''' by s, each (M, n), are given at M even s from 0 to 1.

    None where there is none to find: a derivative is not a number, no joint moves, or not far enough for the knots to
    carry it (`SHORTEST_S`), or what was found goes backwards.
    """
    if not (np.isfinite(derivatives).all() and np.any(derivatives[0])):
        return None
    rates = LineRates.of(derivatives, limits)
    y, best, found = np.zeros(_FREE.shape[1]), np.inf, np.zeros(_FREE.shape[1])
    seen, damping = rates.seen(_shape(y)), DAMPING
    for exponent, steps in STAGES:
        y, seen, damping = _descended(rates, y, seen, exponent, steps, damping)
        longest = float(seen.times.max())
        if longest < best:
            best, found = longest, y
    if not best >= SHORTEST_S:
        return None
    law = law_of_jerks(best, _PLAIN + _FREE @ found)
    return law if best * float(law.extrema(1)[0][0]) >= -BACK else None


def law_of_jerks(duration: float, jerks: FloatArray) -> Trajectory:
    """s(t) from 0 to 1, at rest at both ends, over [0, `duration`] s. `jerks` (`PIECES`,): s⃛ for a duration of 1, on
    equal parts, such that the end conditions hold (L3)."""
    states = np.concatenate([_BEGINS @ jerks, [[1.0, 0.0, 0.0]]]) / duration ** np.arange(3)
    return Trajectory.of_knots(np.column_stack([np.linspace(0.0, duration, PIECES + 1), states]))


def _descended(
    rates: LineRates, y: FloatArray, seen: Seen, exponent: int, steps: int, damping: float
) -> tuple[FloatArray, Seen, float]:
    """The free jerks, `seen`, after some steps down the norm of all times with this exponent (L5), and the damping
    reached."""
    before = _norm(seen.times, exponent)
    for _ in range(steps):
        times, slopes = seen.times, rates.slopes(seen)
        largest = float(times.max())
        keep = times > largest * PASSED_OVER ** (2 / exponent)
        rows: IntArray = np.nonzero(keep)[0]
        share = times[keep] / largest
        residual = share ** (exponent / 2)
        slope = np.einsum("rk,rkf->rf", slopes[keep], _MOVED[rows]) / largest
        slope *= (exponent / 2 * share ** (exponent / 2 - 1))[:, None]
        square, descent = slope.T @ slope, slope.T @ residual
        scale = np.diag(np.diag(square) + FLAT * np.trace(square))
        for _ in range(TRIES):
            tried = y - np.linalg.solve(square + damping * scale, descent)
            there = rates.seen(_shape(tried))
            after = _norm(there.times, exponent)
            if after < before:
                break
            damping *= RISE
        else:
            return y, seen, damping
        y, seen, damping = tried, there, max(damping / FALL, LEAST_DAMPING)
        before, settled = after, after > before * (1 - SETTLED)
        if settled:
            break
    return y, seen, damping


def _norm(times: FloatArray, exponent: int) -> float:
    largest = times.max()
    return float(largest * ((times / largest) ** exponent).sum() ** (1 / exponent))


def _states(parts: int, t: FloatArray) -> FloatArray:
    """The maps (T, 3, N) from N jerks to s, ṡ, s̈ at times t (T,) in [0, 1], from rest in 0 (L3)."""
    h = 1 / parts
    begin = np.arange(parts) * h
    x, w = np.clip(t[:, None] - begin, 0.0, h), np.maximum(t[:, None] - begin - h, 0.0)
    return np.stack([x**3 / 6 + h**2 / 2 * w + h * w**2 / 2, x**2 / 2 + h * w, x], 1)


def _laws() -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Jerks (N,) of the law with the least sum of squares, the directions (N, N − 3) that keep the end conditions, and
    the states (R, 4), with the maps (R, 4, N − 3) to them, at both sides of all steps."""
    ends = _states(PIECES, np.ones(1))[0]
    plain = ends.T @ np.linalg.solve(ends @ ends.T, np.array([1.0, 0.0, 0.0]))
    free = np.linalg.svd(ends)[2][3:].T
    steps = PIECES * SAMPLES
    first = np.arange(steps)
    sides = np.concatenate([first, first + 1]) / steps
    jerk = np.tile(np.eye(PIECES)[first // SAMPLES], (2, 1))
    maps = np.concatenate([_states(PIECES, sides), jerk[:, None]], 1)
    return plain, free, maps @ plain, maps @ free


_PLAIN, _FREE, _STATE, _MOVED = _laws()
_BEGINS = _states(PIECES, np.arange(PIECES) / PIECES)
"""The maps to the states in which the parts begin."""


def _shape(y: FloatArray) -> FloatArray:
    """States (R, 4) of the law with the free jerks y."""
    return _STATE + _MOVED @ y


# A phase law for a path of several parts: slow where it bends, fast between, without a stop (equation Q8).
#
# Each part has a speed at which its bends keep the joints' limits with some reserve, and limits of the acceleration and
# jerk along it from what is left. Where parts meet the slower speed counts, or what can be reached on the parts beside.
# Ruckig times each part. The law is a proposal: what runs is scaled until the exact extrema of its spline keep the
# limits.

CORNER_SAMPLES = 33
"""Places on each part at which the joints' derivatives are evaluated."""
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
    third = np.abs(np.gradient(part.second, part.length / (CORNER_SAMPLES - 1), axis=0)).max(0)
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
    place, begins, profiles = 0.0, [0.0], list[RawProfile]()
    for zone, v0, v1 in zip(zones, speeds[:-1], speeds[1:], strict=True):
        solver = Solver([max(zone.speed, v0, v1)], [zone.acceleration], [zone.jerk])
        found = solver.raw_profile(([place], [v0], [0.0]), ([place + zone.length], [v1], [0.0]))
        if isinstance(found, TimingRefusal):
            return None
        profiles.append(found)
        begins.append(begins[-1] + found.duration)
        place += zone.length
    table = trajectory_of(profiles, begins).knots.copy()
    table[:, 1:] /= place
    if not (np.diff(table[:, 1]) > 0.0).all():
        return None
    table[-1, 1] = 1.0
    return Trajectory.of_knots(table)


def faster(law: Trajectory, scale: float) -> Trajectory:
    """The same shape, `scale` times as fast."""
    table = law.knots.copy()
    for order, column in enumerate((1, 2, 3)):
        table[:, column] *= scale**order
    table[:, 0] /= scale
    return Trajectory.of_knots(table)
