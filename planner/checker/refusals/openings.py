"""When a control point may be met at all: bounds for all times, from the polynomials of its law.

The way of a point along its conveyor is a polynomial of the third degree in the time, piece after piece, and the last
piece, which never ends, is a straight line. Between its turning points and the times at which it passes an end of the
window it is on one side of both.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from assur.planner.checker.laws import travel
from assur.planner.checker.legs import dwell
from assur.planner.frames.motion import Pose
from assur.planner.laws import Law
from assur.planner.model.attachments import at_start
from assur.planner.model.proofs.witness import PROVED_M, PROVED_S
from assur.planner.model.scene import Scene, Window

Times = tuple[float, float]
LONG_S = 2e6
"""No law is known for so long, s (`FURTHEST_S` on both sides of time zero): what goes on for ever ends here."""
REAL = 1e-6
"""A root whose imaginary part, s, is not above this is looked at as a real one: a window that is only just touched."""


@dataclass(frozen=True, slots=True)
class Asked:
    """When the control point of a step may be tracked, and for how long, s; its way along a conveyor (None: none)."""

    frame: str
    law: Law
    point: Pose
    window: Window
    needed_s: float
    start: float
    latest: float | None

    @property
    def closes(self) -> float:
        """When the window in time is over, s."""
        return math.inf if self.window.time is None else self.window.time[1]

    @property
    def known(self) -> Times:
        """When the law of the frame is known."""
        return self.law.valid

    def span(self, *, lawless: bool = False) -> Times:
        """From when until when tracking may last, the way along a conveyor left aside; empty if reversed. `lawless`: as
        if the law were known for ever after its begin;"""
        opens = -math.inf if self.window.time is None else self.window.time[0]
        low = max(self.start, self.known[0], opens)
        latest = math.inf if self.latest is None else self.latest
        return low, min(math.inf if lawless else self.known[1], latest, self.closes)


def asked(scene: Scene, number: int) -> Asked:
    """What is asked of the control point of a step; which part is where follows from the steps before."""
    attached = at_start(scene)
    for step in scene.task[:number]:
        attached = attached.after(scene, step)
    step = scene.task[number]
    frame, point = attached.point(scene, step)
    law = scene.frames[frame].law
    start, latest = scene.start.time, scene.options.latest_end_s
    return Asked(frame, law, point, step.window, dwell(step), start, latest)


def inside(of: Asked, wider: float, *, lawless: bool = False) -> list[Times]:
    """When the point is in its window along a conveyor, `wider`, m, at both ends, from the start on for ever: intervals
    in order. All of the time where there is no such window."""
    begin, end = of.start, of.start + LONG_S if lawless else min(of.known[1], of.start + LONG_S)
    if of.window.along is None or of.law.kind not in ("conveyor", "linear"):
        return [(begin, end)]
    zero = _offset(of.law, of.point)
    low, high = of.window.along[0] - zero - wider, of.window.along[1] - zero + wider
    found: list[Times] = []
    for t0, t1, powers in travel(of.law, begin, end):
        for a, b in _within(powers, max(begin, t0) - t0, min(end, t1) - t0, low, high):
            if found and t0 + a <= found[-1][1] + PROVED_S:
                found[-1] = (found[-1][0], t0 + b)
            else:
                found.append((t0 + a, t0 + b))
    return found


def open_spans(
    of: Asked, wider_m: float = PROVED_M, wider_s: float = PROVED_S, *, lawless: bool = False
) -> list[Times]:
    """When the point may be tracked, wider by so much: intervals in order."""
    low, high = of.span(lawless=lawless)
    both = [(max(low - wider_s, a), min(high + wider_s, b)) for a, b in inside(of, wider_m, lawless=lawless)]
    return [(a, b) for a, b in both if a <= b]


def farthest_inside(of: Asked) -> float:
    """How far, m, the point stays outside its window along a conveyor from the start on for ever; below 0: it does not.
    Infinite where it is on no conveyor."""
    if of.window.along is None or of.law.kind not in ("conveyor", "linear"):
        return -math.inf
    begin, end = of.start, min(of.known[1], of.start + LONG_S)
    zero, found = _offset(of.law, of.point), math.inf
    for t0, t1, powers in travel(of.law, begin, end):
        first, last = max(begin, t0) - t0, min(end, t1) - t0
        if first <= last:
            cuts = [first, *(t for t in _roots(_derivative(powers)) if first < t < last), last]
            for t in cuts:
                way = zero + _value(powers, t)
                found = min(found, max(of.window.along[0] - way, way - of.window.along[1]))
            # it passes the whole window between two of them
            ways = [zero + _value(powers, t) for t in cuts]
            if min(ways) < of.window.along[0] and max(ways) > of.window.along[1]:
                found = min(found, 0.0)
    return found


def _offset(law: Law, point: Pose) -> float:
    """How far along the direction of travel the point is in its frame, m."""
    if law.kind == "conveyor":
        return point.x
    speed = math.hypot(*law.numbers.velocity)
    u = [part / speed for part in law.numbers.velocity] if speed > 0.0 else [1.0, 0.0, 0.0]
    own = Pose(yaw=law.numbers.pose.yaw).then(point)
    return own.x * u[0] + own.y * u[1] + own.z * u[2]


def _within(powers: Sequence[float], first: float, last: float, low: float, high: float) -> list[Times]:
    """When, of [first, last], a polynomial is from `low` to `high`."""
    if not first <= last:
        return []
    given = [float(c) for c in powers]
    roots = _roots(_derivative(given))
    for level in (low, high):
        roots += _roots([given[0] - level, *given[1:]])
    cuts = sorted({first, last, *(t for t in roots if first < t < last)})
    found: list[Times] = [(t, t) for t in cuts if low <= _value(given, t) <= high]
    for a, b in pairwise(cuts):
        if low <= _value(given, (a + b) / 2.0) <= high:
            found.append((a, b))
    joined: list[Times] = []
    for a, b in sorted(found):
        if joined and a <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(joined[-1][1], b))
        else:
            joined.append((a, b))
    return joined


def _value(powers: Sequence[float], t: float) -> float:
    return float(np.polynomial.polynomial.polyval(t, powers))


def _derivative(powers: Sequence[float]) -> list[float]:
    return [k * float(c) for k, c in enumerate(powers)][1:]


def _roots(powers: list[float]) -> list[float]:
    """The real parts of the roots that are real, or nearly so."""
    given = np.trim_zeros(np.array(powers, dtype=np.float64), "b")
    if len(given) < 2:
        return []
    return [float(root.real) for root in np.polynomial.polynomial.polyroots(given) if abs(root.imag) <= REAL]
