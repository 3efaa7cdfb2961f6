"""Whether the tool traces a path as a plan says: where it should be at every instant, and with the process speed.

The place on the path is a law of time alone (Q6). What is looked at is the tool point as it is seen from the frame of
the path, w(t), against that place r(t). Over an interval [a, b], h long,

    |w − r| <= max at both ends + (|ẅ| + |r̈|) h²/8        | |ẇ| − v | <= max at both ends + |d|ẇ|/dt| h/2         (V5)

with bounds of ẅ and of the rate of the speed from jets, and of r̈ from the curvature. Intervals are halved until that
decides; what is not decided is refused.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker import along
from assur.planner.checker.along import TRACKED_M, TRACKED_RAD
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.paths.along_path import along_path
from assur.planner.checker.paths.curves import curves_of, length_of
from assur.planner.checker.targets import Target
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.outcome import Arrival, Leg, LegKind, Traced
from assur.planner.model.scene import Move, Trace

SPEED_SHARE = 0.01
"""The promise: by how much of itself the process speed may be missed."""
STEP_S, HALVINGS, MOST = 2e-3, 14, 400_000
"""Length of the first intervals, s; how often they are halved; and how many there may be in all."""
LENGTH_M = 1e-9
"""m. How far a claimed length may be from ours: rounding of arc lengths."""
WHAT = ("is not where it should be on", "is too slow on", "is too fast on", "is turned on", "tilts or rolls on")
UNITS = ("m", "m/s", "m/s", "rad", "rad")


@dataclass(frozen=True, eq=False)
class _Stretch:
    """A part of a trace, in time: where the tool should be (T, 3), and a bound of the acceleration of that, m/s²."""

    t0: float
    t1: float
    place: Callable[[FloatArray], FloatArray]
    pull: float


def traced(
    world: World, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...], found: tuple[Target, ...]
) -> list[Finding]:
    """Findings about the traces of a plan, and about what its other arrivals say of traces."""
    findings: list[Finding] = []
    if [arrival.step for arrival in arrivals] != list(range(len(found))):
        return findings  # it is not said of which point an arrival is
    for arrival, target in zip(arrivals, found, strict=True):
        name, step = target.step.name, target.step
        if isinstance(step, Move) and step.path:
            findings += along_path(world, legs, arrival, target)
        if not isinstance(step, Trace):
            if arrival.trace is not None:
                findings.append(Finding(Code.ARRIVAL, f"{name} is said to be traced, and is no trace"))
            continue
        if arrival.trace is None or not arrival.matched:
            findings.append(Finding(Code.ARRIVAL, f"it is not said how {name} is traced, and that it is matched"))
            continue
        findings += _claims(step, arrival.trace)
        own = {leg.kind: leg for leg in legs if leg.step == target.number}
        stretches, wrong = _stretches(step, own)
        findings += wrong
        for stretch, said in stretches:
            findings += _followed(world, target, stretch, said and arrival.trace)
    return findings


def _claims(step: Trace, said: Traced) -> list[Finding]:
    """What is said must be within what is promised."""
    v, name = step.speed_m_s, step.name
    off = abs(said.length_m - length_of(step.path))
    findings = []
    for amount, allowed, unit, what in (
        (off, LENGTH_M, "m", f"the path of {name} has another length than its arrival says"),
        (v - said.slowest_m_s, SPEED_SHARE * v, "m/s", f"{name} may be traced too slowly by what its arrival says"),
        (said.fastest_m_s - v, SPEED_SHARE * v, "m/s", f"{name} may be traced too fast by what its arrival says"),
        (said.error_m, TRACKED_M, "m", f"the tool may leave the path of {name} by what its arrival says"),
    ):
        if not amount <= allowed:
            findings.append(Finding(Code.TRACKING, what, amount - allowed, unit))
    return findings


def _stretches(step: Trace, own: dict[LegKind, Leg]) -> tuple[list[tuple[_Stretch, bool]], list[Finding]]:
    """The stretches in time, and whether they are of the path itself; findings where they do not last as they must."""
    v, findings = step.speed_m_s, list[Finding]()
    parts = curves_of(step.path)
    for kind, lasts in (
        (LegKind.APPROACH, 2.0 * step.lead_in_m / v),
        (LegKind.FOLLOW, sum(part.length for part in parts) / v),
        (LegKind.DEPART, 2.0 * step.lead_out_m / v),
    ):
        off = abs(own[kind].t1 - own[kind].t0 - lasts)
        if not off <= TIME_S:
            where = f"{own[kind].t0:.6g} s"
            findings.append(
                Finding(Code.LEGS, f"{kind} of {step.name} takes another time than its path", off, "s", where)
            )
    first, _, _ = parts[0].state(0.0)
    found = [(_led(own[LegKind.APPROACH], first, parts[0].state(0.0)[1], step.lead_in_m, v, before=True), False)]
    begin, gone = own[LegKind.FOLLOW].t0, 0.0
    for k, part in enumerate(parts):
        t0 = begin + gone / v
        gone += part.length
        t1 = begin + gone / v if k + 1 < len(parts) else own[LegKind.FOLLOW].t1

        def place(t: FloatArray, part: object = part, t0: float = t0) -> FloatArray:
            return np.asarray(part.place(v * (t - t0)))  # type: ignore[attr-defined]

        found.append((_Stretch(t0, t1, place, v * v * part.part.bend), True))
    last, tangent, _ = parts[-1].state(parts[-1].length)
    found.append((_led(own[LegKind.DEPART], last, tangent, step.lead_out_m, v, before=False), False))
    return found, findings


def _led(leg: Leg, edge: FloatArray, tangent: FloatArray, length: float, v: float, *, before: bool) -> _Stretch:
    """A lead-in that ends in `edge` (3,), or a lead-out that begins there: g(x) = 2 x³ − x⁴ of its length from where
    the tool rests, x the share of the time."""
    lasts, sign = 2.0 * length / v, -1.0 if before else 1.0
    rest = edge + sign * length * tangent

    def place(t: FloatArray) -> FloatArray:
        x = np.clip((t - leg.t0 if before else leg.t1 - t) / lasts, 0.0, 1.0)
        return np.asarray(rest - sign * length * np.outer(x**3 * (2.0 - x), tangent))

    return _Stretch(leg.t0, leg.t1, place, 1.5 * v / lasts)


def _followed(world: World, target: Target, stretch: _Stretch, said: Traced | bool | None) -> list[Finding]:
    """A finding if the tool is not shown to be where it should; `said`: and with what speed, on the path itself."""
    step, claim = target.step, said if isinstance(said, Traced) else None
    t0, t1 = stretch.t0, stretch.t1
    if not t1 > t0:
        return []
    edges = np.linspace(t0, t1, math.ceil((t1 - t0) / STEP_S) + 1)
    spans, looked, decided = np.stack([edges[:-1], edges[1:]], 1), 0, False
    for _ in range(HALVINGS):
        looked += len(spans)
        ends, bounds = _excesses(world, target, stretch, spans, claim)
        exceeded = ~(ends <= 0.0)
        if exceeded.any():
            decided = True
            break
        open_ = ~(bounds <= 0.0).all(1)
        if not open_.any():
            return []
        if looked > MOST:
            break
        left = spans[open_]
        middle = left.mean(1)
        spans = np.concatenate([np.stack([left[:, 0], middle], 1), np.stack([middle, left[:, 1]], 1)])
        spans = spans[np.argsort(spans[:, 0])]
    table = ends if decided else bounds
    row = int(np.flatnonzero(~(table <= 0.0).all(1))[0])
    column = int(np.flatnonzero(~(table[row] <= 0.0))[0])
    what = f"the tool {WHAT[column]} the path of {step.name}" + ("" if decided else " (or could not be shown not to)")
    where = f"{spans[row, 0]:.6g} s"
    return [Finding(Code.TRACKING, what, float(table[row, column]), UNITS[column], where)]


def _excesses(
    world: World, target: Target, stretch: _Stretch, spans: FloatArray, claim: Traced | None
) -> tuple[FloatArray, FloatArray]:
    """By how much what is allowed is exceeded at the ends of intervals (N, 2), and at most between: (N, 5) each."""
    h = spans[:, 1] - spans[:, 0]
    begin = world.relative(world.frame[target.frame], spans)
    end = world.relative(world.frame[target.frame], np.repeat(spans[:, 1:], 2, 1))
    allowed = TRACKED_M if claim is None else claim.error_m
    offs, bounds = [], np.zeros((len(spans), 5))
    for found, t in ((begin, spans[:, 0]), (end, spans[:, 1])):
        off = np.zeros((len(spans), 5))
        place = found[:, along.PLACE : along.PLACE + 3]
        off[:, 0] = np.sqrt(((place - stretch.place(t)) ** 2).sum(1)) - allowed
        speed = np.sqrt((found[:, along.RATE : along.RATE + 3] ** 2).sum(1))
        if claim is not None:
            off[:, 1], off[:, 2] = claim.slowest_m_s - speed, speed - claim.fastest_m_s
        if target.turns:
            heading = found[:, along.HEADING : along.HEADING + 2]
            asked = np.array([math.cos(target.tool.yaw), math.sin(target.tool.yaw)])
            off[:, 3] = np.sqrt(((heading - asked) ** 2).sum(1)) - TRACKED_RAD
        if target.tilt is not None:
            turns = found[:, along.HAND : along.HAND + 2] - np.array(target.tilt)
            off[:, 4] = np.abs(turns - math.tau * np.round(turns / math.tau)).max(1) - TRACKED_RAD
        offs.append(off)
    ends = np.maximum(*offs)
    bounds[:, 0] = (begin[:, along.BEND] + stretch.pull) * h**2 / 8.0
    if claim is not None:
        bounds[:, 1] = bounds[:, 2] = begin[:, along.PULL] * h / 2.0
    if target.turns:
        bounds[:, 3] = begin[:, along.SPIN] * h / 2.0
    if target.tilt is not None:
        bounds[:, 4] = begin[:, along.TILTS] * h / 2.0
    return ends, ends + bounds
