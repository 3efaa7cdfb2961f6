"""Whether the peaks of the tool point's speed and acceleration are what an answer says.

A planner looks for them at instants. So a peak has to be there at the instant that is said, and no other instant may
exceed it by more than what can be between two of them (`BETWEEN`).
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from assur.planner.checker import along
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.claims import Claims
from assur.planner.model.phases import Phase
from assur.planner.model.scene import WORLD

BETWEEN = 0.01
"""Share by which a peak that was looked for every millisecond may be exceeded in between."""
ROUNDING = 1e-6
"""Share by which it may be off at the instant that is said."""
LEAST = 1e-6
"""m/s or m/s². What is no faster stands still."""
REACHED = 1e-3
"""Share by which the largest acceleration with a part may be off where its instant is not said."""
BEFORE_S = 1e-9
"""How long before a jump its other side is looked at, s."""
FINEST_S = 1e-7
"""Intervals are not halved any more below this, s: at 100 m/s² the speed changes by 10 µm/s in it."""
Span = tuple[float, float]


def tool(world: World, phases: tuple[Phase, ...], claims: Claims) -> list[Finding]:
    """Findings about the peaks of the tool point that are claimed."""
    whole, findings = [(world.start, world.end)], list[Finding]()
    said = claims.tool
    if said is not None:
        for name, size, time in (("speed", said.speed, said.speed_time), ("acceleration", said.acceleration,
                                                                          said.acceleration_time)):  # fmt: skip
            there = _at(world, time, fast=name == "speed")
            if not abs(there - size) <= ROUNDING * size + LEAST:
                what = f"the {name} of the tool point is not what the answer says it is then"
                unit = "m/s" if name == "speed" else "m/s²"
                findings.append(Finding(Code.CLAIM, what, abs(there - size), unit, f"{time:.6g} s"))
        if _faster(world, said.speed * (1.0 + BETWEEN) + LEAST):
            findings.append(Finding(Code.CLAIM, "the tool point is faster than the answer says", where="margins.tool"))
        findings += _harder(world, whole, said.acceleration, "margins.tool")
    pull = claims.tool_acceleration
    if pull is not None:
        held = [(p.t0, p.t1) for p in phases if p.attached.held is not None and p.t1 > p.t0 and p.step >= 0]
        spans, where = held or whole, "margins.tool_acceleration_m_s2"
        findings += _harder(world, spans, pull, where)
        if pull > LEAST and not _exceeded(world, spans, pull * (1.0 - REACHED)):
            what = "the tool point never accelerates as hard as the answer says"
            findings.append(Finding(Code.CLAIM, what, where=where))
    return findings


def _at(world: World, t: float, *, fast: bool) -> float:
    """Speed, m/s, or acceleration, m/s², of the tool point at an instant; at a jump the larger of both sides. NaN
    outside the motion."""
    if not world.start <= t <= world.end:
        return np.nan
    near = world.knots.time[np.abs(world.knots.time - t) <= BEFORE_S]
    if world.knots.jumps and len(near):
        t = float(near[0])  # a time that is told may be off the knot by its last digit
    spans = np.array([(t, t), (max(t - BEFORE_S, world.start), t)])
    found = world.relative(world.frame[WORLD], spans)
    if fast:
        return float(np.linalg.norm(found[0, along.RATE : along.RATE + 3]))
    # over an interval that ends at a jump the bound is that of the side before it
    return float(found[:, along.BEND].max()) if world.knots.jumps else float(found[0, along.BEND])


def _harder(world: World, spans: Iterable[Span], size: float, where: str) -> list[Finding]:
    if not _exceeded(world, spans, size * (1.0 + BETWEEN) + LEAST):
        return []
    return [Finding(Code.CLAIM, "the tool point accelerates harder than the answer says", where=where)]


def _exceeded(world: World, spans: Iterable[Span], size: float) -> bool:
    """Whether the tool point is not shown to accelerate by `size`, m/s², at most."""
    asked = [(along.HEIGHT, size)]
    return any(world.keeps(along.CARRY, asked, a, b) is not None for t0, t1 in spans for a, b in _pieces(world, t0, t1))


def _pieces(world: World, t0: float, t1: float) -> Iterable[Span]:
    """[t0, t1] in pieces of the spline: no acceleration jumps within one."""
    time = world.knots.time
    return pairwise([t0, *np.unique(time[(time > t0) & (time < t1)]).tolist(), t1])


def _faster(world: World, size: float) -> bool:
    """Whether the tool point is not shown to be no faster than `size`, m/s. Between two instants h apart a speed is no
    larger than the mean of both, and half of h times the greatest acceleration."""
    edges = np.unique(world.knots.time)
    spans = np.stack([edges[:-1], edges[1:]], axis=1)
    while len(spans):
        begin = world.relative(world.frame[WORLD], spans)
        end = world.relative(world.frame[WORLD], np.stack([spans[:, 1], spans[:, 1]], axis=1))
        one, other = (np.linalg.norm(each[:, along.RATE : along.RATE + 3], axis=1) for each in (begin, end))
        if not (np.maximum(one, other) <= size).all():
            return True
        h = spans[:, 1] - spans[:, 0]
        left = spans[~((one + other + begin[:, along.BEND] * h) / 2.0 <= size)]
        if len(left) and not (left[:, 1] - left[:, 0] > FINEST_S).all():
            return True
        middle = left.mean(axis=1)
        spans = np.concatenate([np.stack([left[:, 0], middle], 1), np.stack([middle, left[:, 1]], 1)])
    return False
