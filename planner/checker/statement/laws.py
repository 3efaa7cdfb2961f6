"""The motions of frames by their textbook formulas, (F1) to (F9) of docs/kinematics.md.

This module alone knows the kinds of laws and their numbers. A law is a polynomial of time on each of some pieces of
time, plus sines. So a `Formula` has the powers of these pieces, the times at which they begin, and the numbers of the
sines. Places are (x, y, z, yaw) in the world, m and rad; times are s.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement.differences import Four, Interval, numbers
from assur.planner.errors import FaultError
from assur.planner.laws.law import Law, Numbers
from assur.planner.laws.ramps import Change
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory

Sine = tuple[int, float, float, float]
"""Coordinate (0 to 3), amplitude, rate in rad/s and phase in rad of amplitude * sin(rate * t + phase)."""
TURN = (0.0, 0.0, 0.0, 1.0)
"""The direction of places round the vertical."""


@dataclass(frozen=True)
class Formula:
    """A law over the interval `when`: polynomials, and sines in addition. `begins` (K,), `powers` (K, 4, D) of the time
    since each begins; the first one holds before it begins, too, if there is no period. After a `period`, s (0: none),
    the place is `step` (4,) further on."""

    begins: Sequence[float]
    powers: Sequence[Sequence[Sequence[float]]]
    when: Interval
    sines: Sequence[Sine] = ()
    period: float = 0.0
    step: Sequence[float] = (0.0, 0.0, 0.0, 0.0)

    @property
    def degree(self) -> int:
        """Of the polynomials at most."""
        return len(self.powers[0][0]) - 1

    @property
    def ends(self) -> Iterator[float]:
        """The times at which pieces end, of many periods if the interval is long: they are computed one by one."""
        many, period = len(self.begins) > 1 or self.period > 0.0, self.period
        first, last = (math.floor((t - self.begins[0]) / period) if period > 0.0 else 0 for t in self.when)
        return (t + k * period for k in range(first, last + 2) for t in self.begins if many)

    @cached_property
    def _arrays(self) -> tuple[FloatArray, FloatArray]:
        return np.array(self.begins), np.array(self.powers)

    def place(self, t: FloatArray) -> FloatArray:
        """The places (m, 4) at times (m,), without sines."""
        begins, powers = self._arrays
        whole = np.floor((t - begins[0]) / self.period) if self.period > 0.0 else np.zeros(len(t))
        local = t - whole * self.period
        i = np.maximum(np.searchsorted(begins, local, side="right") - 1, 0)
        since = (local - begins[i])[:, None]
        found = np.outer(whole, self.step)
        for k in range(powers.shape[2]):
            found += powers[i, :, k] * since**k
        return found

    def place_at(self, time: float) -> list[float]:
        """The place at one time, sines included."""
        begin, period = self.begins[0], self.period
        whole = math.floor((time - begin) / period) if period > 0.0 else 0
        local = time - whole * period
        i = max(bisect_right(self.begins, local) - 1, 0)
        since, found = local - self.begins[i], [whole * step for step in self.step]
        for k, powers in enumerate(self.powers[i]):
            found[k] += sum(power * since**n for n, power in enumerate(powers))
        for k, amplitude, rate, phase in self.sines:
            found[k] += amplitude * math.sin(rate * time + phase)
        return found

    def powers_from(self, begin: float, end: float) -> list[list[float]] | None:
        """The powers (4, D) of the time since `begin`, of a law without a period; None: its pieces change before
        `end`."""
        i = max(bisect_right(self.begins, begin) - 1, 0)
        if i + 1 < len(self.begins) and self.begins[i + 1] < end:
            return None
        since, found = begin - self.begins[i], [list(powers) for powers in self.powers[i]]
        for powers in found:
            while powers and powers[-1] == 0.0:
                powers.pop()
            for first in range(len(powers) - 1) if since != 0.0 else ():
                for k in range(len(powers) - 2, first - 1, -1):  # Horner's scheme, again and again
                    powers[k] += since * powers[k + 1]
        return found


def link_of(law: Law) -> tuple[Robot, Trajectory, int] | None:
    """The arm, its motion and the number of its link (in the arm's own order) that the frame is; None: it is none."""
    return None if law.link is None else (law.link.robot, law.link.trajectory, law.link.link)


def formula_of(law: Law, begin: float, end: float) -> Formula:
    """The law over [begin, end]. Raises `FaultError` for a kind that this module does not know."""
    kind, of, when = law.kind, law.numbers, (begin, end)
    if kind == "keyframes":
        return _keyframes(of, when)
    pose = numbers(of.pose)
    if kind in ("fixed", "swing", "oscillation"):
        return Formula([0.0], [[[x] for x in pose]], when, _sines(law))
    if kind == "linear":
        return Formula([of.at_time], [[*zip(pose, (*of.velocity, 0.0), strict=True)]], when)
    ahead = (math.cos(pose[3]), math.sin(pose[3]), 0.0, 0.0)
    if kind in ("conveyor", "turntable"):
        belt = kind == "conveyor"
        begins, ways = _travel(of.speed if belt else of.rate, of.changes, of.at_time)
        powers = [[[x * along for x in way] for along in (ahead if belt else TURN)] for way in ways]
        for zero, piece in zip(begins, powers, strict=True):
            for own, x in zip(piece, pose, strict=True):
                own[0] += x
            piece[2][0] += (zero - of.at_time) * of.rise
            piece[2][1] += of.rise
        return Formula(begins, powers, when)
    if kind == "indexer":
        # steps by the polynomial without velocity, acceleration and jerk at both ends (F3), and dwells between them
        way, shares = [of.step * x for x in (TURN if of.turns else ahead)], (35.0, -84.0, 70.0, -20.0)
        moves = [
            [x, 0.0, 0.0, 0.0, *(far * share / of.move_s**k for k, share in enumerate(shares, start=4))]
            for x, far in zip(pose, way, strict=True)
        ]
        rests = [[x + far, *[0.0] * 7] for x, far in zip(pose, way, strict=True)]
        return Formula([of.start, of.start + of.move_s], [moves, rests], when, (), of.move_s + of.dwell_s, way)
    raise FaultError(f"no formula for the motion {kind}")


def place_at(law: Law, time: float) -> Four:
    """Where a frame that is no link of an arm is at a time."""
    x, y, z, yaw = formula_of(law, time, time).place_at(time)
    return (x, y, z, yaw)


def known(law: Law) -> Interval:
    """The first and the last time at which a law is known."""
    first, last = law.valid
    if law.kind == "keyframes" and law.numbers.ends != "periodic":
        return max(first, float(law.numbers.times[0])), min(last, float(law.numbers.times[-1]))
    return first, last


def stands(law: Law) -> bool:
    """Whether a frame never moves."""
    return law.kind == "fixed"


def keeps_yaw(law: Law) -> bool:
    """Whether a frame never turns."""
    return law.kind in ("fixed", "conveyor", "linear", "oscillation")


def period_of(law: Law) -> float | None:
    """After how many seconds a frame that moves is where it was, again and again; None: never, or it is not known."""
    of = law.numbers
    if law.kind in ("swing", "oscillation"):
        return float(of.period)
    if law.kind == "keyframes" and of.ends == "periodic":
        return float(of.times[-1] - of.times[0])
    if law.kind == "turntable" and of.rate != 0.0 and of.rise == 0.0 and not of.changes:
        return math.tau / abs(of.rate)
    return None


def line_of(law: Law) -> tuple[float, ...] | None:
    """The direction (unit vector) in which a frame travels; None: it travels along no line. A conveyor that stands has
    one, too: its errors are along it."""
    if law.kind == "conveyor":
        return (math.cos(law.numbers.pose.yaw), math.sin(law.numbers.pose.yaw), 0.0)
    if law.kind == "linear" and any(law.numbers.velocity):
        x, y, z = law.numbers.velocity
        length = math.hypot(x, y, z)
        return (x / length, y / length, z / length)
    return None


def measured_along(law: Law) -> tuple[tuple[float, ...], Four] | None:
    """The direction along which windows in metres are measured, and the pose from which; None: there is none."""
    if law.kind not in ("conveyor", "linear"):
        return None
    return line_of(law) or (1.0, 0.0, 0.0), numbers(law.numbers.pose)


def encoder_counts(law: Law) -> bool:
    """Whether an encoder counts the travel of the frame: not of a conveyor that always stands."""
    return law.kind != "conveyor" or any((law.numbers.speed, *(change.speed for change in law.numbers.changes)))


def _sines(law: Law) -> list[Sine]:
    """The sines of a swing (F4) and of an oscillation (F8)."""
    if law.kind == "swing":
        return [(3, law.numbers.amplitude, math.tau / law.numbers.period, law.numbers.phase)]
    if law.kind == "oscillation":
        length = math.hypot(*law.numbers.direction)
        parts = [(k, law.numbers.amplitude * u / length) for k, u in enumerate(law.numbers.direction) if u != 0.0]
        return [(k, amplitude, math.tau / law.numbers.period, law.numbers.phase) for k, amplitude in parts]
    return []


def _travel(speed: float, changes: Iterable[Change], zero: float) -> tuple[list[float], list[list[float]]]:
    """The times (K,) at which the acceleration of something jumps that has a speed and changes it by S-curves (F7), and
    how far it has come since the time `zero`: powers (K, 4) of the time since each."""
    rows: list[tuple[float, float, float, float, float]] = []  # begin, way, speed, acceleration, jerk
    way = now = 0.0
    for change in changes:
        if change.speed == speed:
            continue
        way, now = way + speed * (change.time - now) if rows else 0.0, change.time
        rows = rows or [(now, 0.0, speed, 0.0, 0.0)]
        more, sign = abs(change.speed - speed), math.copysign(1.0, change.speed - speed)
        if change.jerk == math.inf:
            rise, top, jerk = 0.0, change.acceleration, 0.0
        else:
            rise = min(change.acceleration / change.jerk, math.sqrt(more / change.jerk))
            top, jerk = change.jerk * rise, change.jerk
        level = max(0.0, more / top - rise) if top > 0.0 else 0.0
        for lasts, a, j in ((rise, 0.0, sign * jerk), (level, sign * top, 0.0), (rise, sign * top, -sign * jerk)):
            rows.append((now, way, speed, a, j))
            way += lasts * (speed + lasts * (a / 2.0 + lasts * j / 6.0))
            speed, now = speed + lasts * (a + lasts * j / 2.0), now + lasts
        speed = change.speed
        rows.append((now, way, speed, 0.0, 0.0))
    rows = rows or [(0.0, 0.0, speed, 0.0, 0.0)]
    begins, ways = [row[0] for row in rows], [[way, rate, a / 2.0, j / 6.0] for _, way, rate, a, j in rows]
    i = max(bisect_right(begins, zero) - 1, 0)
    gone = sum(x * (zero - begins[i]) ** k for k, x in enumerate(ways[i]))
    for own in ways:
        own[0] -= gone
    return begins, ways


def _keyframes(of: Numbers, when: Interval) -> Formula:
    """The cubic spline through poses (F5, F9), by its moments: the second derivatives at the poses."""
    times, values = np.array(of.times, dtype=float), np.array([numbers(pose) for pose in of.poses])
    h, n = np.diff(times), len(times)
    slopes = np.diff(values, axis=0) / h[:, None]
    a, b = np.zeros((n, n)), np.zeros((n, 4))
    for i in range(1, n - 1):
        a[i, i - 1 : i + 2] = h[i - 1], 2.0 * (h[i - 1] + h[i]), h[i]
        b[i] = 6.0 * (slopes[i] - slopes[i - 1])
    if of.ends == "natural":
        a[0, 0] = a[-1, -1] = 1.0
    elif of.ends == "clamped":
        a[0, :2], b[0] = (2.0 * h[0], h[0]), 6.0 * slopes[0]
        a[-1, -2:], b[-1] = (h[-1], 2.0 * h[-1]), -6.0 * slopes[-1]
    else:  # the last moment is the first one, and the rates at both ends are the same
        a[0, 0], a[0, -1] = 1.0, -1.0
        a[-1, :2] += 2.0 * h[0], h[0]
        a[-1, -2:] += h[-1], 2.0 * h[-1]
        b[-1] = 6.0 * (slopes[0] - slopes[-1])
    m, span = np.linalg.solve(a, b), h[:, None]
    rates, jerks = slopes - span * (2.0 * m[:-1] + m[1:]) / 6.0, np.diff(m, axis=0) / span
    powers = np.stack([values[:-1], rates, m[:-1] / 2.0, jerks / 6.0], axis=2)
    turn = math.tau * round((of.poses[-1].yaw - of.poses[0].yaw) / math.tau)
    # what repeats is where it was, but for whole turns
    period = float(times[-1] - times[0]) if of.ends == "periodic" else 0.0
    return Formula(times[:-1].tolist(), powers.tolist(), when, (), period, (0.0, 0.0, 0.0, turn))
