"""The motions of frames by their textbook formulas, (F1) to (F9) of docs/kinematics.md.

This module alone knows the kinds of laws and their numbers. A law is a polynomial of time on each of some pieces of
time, plus sines. So a `Formula` says the degree, the times at which pieces end, the place, and the numbers of the
sines. Places are (x, y, z, yaw) in the world, m and rad; times are s.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.statement.differences import Four, Interval, numbers
from assur.planner.errors import FaultError
from assur.planner.laws.law import Law, Numbers
from assur.planner.laws.ramps import Change
from assur.planner.robots.robot import Robot
from assur.planner.trajectory import Trajectory

Place = Callable[[FloatArray], FloatArray]
"""Times (m,) to places (m, 4)."""
Sine = tuple[int, float, float, float]
"""Coordinate (0 to 3), amplitude, rate in rad/s and phase in rad of amplitude * sin(rate * t + phase)."""
AHEAD, CLIMB, TURN = np.eye(4)[[0, 2, 3]]
"""Directions of places: along the x axis, up, and round the vertical."""


@dataclass(frozen=True)
class Formula:
    """A law over an interval: polynomials of this degree at most, which end at some times, and sines in addition. The
    times are those of many periods if the interval is long: they are computed one by one, and can be read once. After a
    `period`, s (0: none), the place is `step` (4,) further on. `begins`, `powers`: as of `polynomials`, as lists."""

    degree: int
    ends: Iterable[float]
    place: Place
    sines: Sequence[Sine] = ()
    period: float = 0.0
    step: Sequence[float] = (0.0, 0.0, 0.0, 0.0)
    begins: Sequence[float] = ()
    powers: Sequence[Sequence[Sequence[float]]] = ()

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


def polynomials(
    begins: FloatArray,
    powers: FloatArray,
    when: Interval,
    sines: Sequence[Sine] = (),
    period: float = 0.0,
    step: Sequence[float] = (0.0, 0.0, 0.0, 0.0),
) -> Formula:
    """The formula of polynomials with powers (K, 4, D) of the time since each begins, (K,); the first one holds before
    it begins, too, if there is no period. Its pieces end within `when`."""
    first, last = (math.floor((t - begins[0]) / period) if period > 0.0 else 0 for t in when)

    def place(t: FloatArray) -> FloatArray:
        whole = np.floor((t - begins[0]) / period) if period > 0.0 else np.zeros(len(t))
        local = t - whole * period
        i = np.maximum(np.searchsorted(begins, local, side="right") - 1, 0)
        since = (local - begins[i])[:, None]
        found = np.outer(whole, step)
        for k in range(powers.shape[2]):
            found += powers[i, :, k] * since**k
        return found

    ends: Iterable[float] = (float(t + k * period) for k in range(first, last + 2) for t in begins.tolist())
    ends = ends if len(begins) > 1 or period > 0.0 else ()
    return Formula(powers.shape[2] - 1, ends, place, sines, period, step, begins.tolist(), powers.tolist())


def link_of(law: Law) -> tuple[Robot, Trajectory, int] | None:
    """The arm, its motion and the number of its link (in the arm's own order) that the frame is; None: it is none."""
    return None if law.link is None else (law.link.robot, law.link.trajectory, law.link.link)


def formula_of(law: Law, begin: float, end: float) -> Formula:
    """The law over [begin, end]. Raises `FaultError` for a kind that this module does not know."""
    kind, of, when = law.kind, law.numbers, (begin, end)
    if kind == "keyframes":
        return _keyframes(of, when)
    pose = np.array(numbers(of.pose))
    ahead = np.array([math.cos(pose[3]), math.sin(pose[3]), 0.0, 0.0])
    if kind in ("fixed", "swing", "oscillation"):
        return polynomials(np.zeros(1), pose[None, :, None], when, _sines(law))
    if kind == "linear":
        return polynomials(np.array([of.at_time]), np.array([[*zip(pose, (*of.velocity, 0.0), strict=True)]]), when)
    if kind in ("conveyor", "turntable"):
        belt = kind == "conveyor"
        begins, ways = _travel(of.speed if belt else of.rate, of.changes, of.at_time)
        powers = ways[:, None, :] * (ahead if belt else TURN)[:, None]
        powers[:, :, 0] += pose + np.outer(begins - of.at_time, of.rise * CLIMB)
        powers[:, :, 1] += of.rise * CLIMB
        return polynomials(begins, powers, when)
    if kind == "indexer":
        # steps by the polynomial without velocity, acceleration and jerk at both ends (F3), and dwells between them
        way = of.step * (TURN if of.turns else ahead)
        powers = np.zeros((2, 4, 8))
        powers[0, :, 4:] = np.outer(way, np.array([35.0, -84.0, 70.0, -20.0]) / of.move_s ** np.arange(4.0, 8.0))
        powers[:, :, 0] = pose, pose + way
        begins = of.start + np.array([0.0, of.move_s])
        return polynomials(begins, powers, when, period=of.move_s + of.dwell_s, step=way.tolist())
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
        length = math.hypot(*law.numbers.velocity)
        return tuple(float(rate) / length for rate in law.numbers.velocity)
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


def _travel(speed: float, changes: Iterable[Change], zero: float) -> tuple[FloatArray, FloatArray]:
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
    table = np.array(rows or [(0.0, 0.0, speed, 0.0, 0.0)])
    begins, ways = table[:, 0], table[:, 1:] / (1.0, 1.0, 2.0, 6.0)
    i = max(int(np.searchsorted(begins, zero, side="right")) - 1, 0)
    ways[:, 0] -= ways[i] @ (zero - begins[i]) ** np.arange(4.0)
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
    return polynomials(times[:-1], powers, when, period=period, step=(0.0, 0.0, 0.0, turn))
