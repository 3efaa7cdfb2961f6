"""Where the plan begins and ends, and whether its legs are those of the task, in order, without gap or overlap."""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.ranges import Ranges
from assur.planner.checker.spline import REST
from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.outcome import Leg, LegKind
from assur.planner.model.scene import Follow, Move, Pick, Place, Scene, Step

START = 1e-9
"""Greatest difference of the first knot from the given start, in s, rad or m, rad/s.., rad/s²..: what writing and
reading a request and its answer may round, and far below the resolution of a controller."""
TIME_S = 1e-9
"""Times that must agree do so up to this, s: rounding of sums of durations; in it a fast arm goes 10 nm."""
STANDING = 1e-9
"""A joint that stays within this, rad or m, is standing."""
LETTERS = {
    LegKind.WAIT: "W",
    LegKind.MOVE: "M",
    LegKind.ARCH: "A",
    LegKind.APPROACH: "D",
    LegKind.FOLLOW: "F",
    LegKind.DEPART: "U",
}
"""A letter a leg: wait, move, arch, down, follow, up."""


def ends(scene: Scene, ranges: Ranges) -> list[Finding]:
    """Begins in the given state; ends at rest if asked, and no later than allowed."""
    findings = []
    line, start, options = ranges.spline, scene.start, scene.options
    given = (np.array([start.time]), start.q, start.qd, start.qdd)
    have = (line.time[:1], *line.first)
    for name, one, other, unit in zip(("time", "q", "qd", "qdd"), given, have, ("s", "1", "1/s", "1/s²"), strict=True):
        off = float(np.abs(one - other).max())
        if not off <= START:
            findings.append(Finding(Code.START, f"the first knot has another {name} than the start", off, unit))
    if options.end == "rest" and not line.at_rest:
        fastest = max(float(np.abs(rate).max()) for rate in line.last[1:])
        findings.append(Finding(Code.END, "the last knot is not at rest", fastest - REST, "1/s, 1/s²"))
    if options.latest_end_s is not None and not line.end <= options.latest_end_s + TIME_S:
        findings.append(Finding(Code.END, "the motion ends too late", line.end - options.latest_end_s, "s"))
    return findings


def legs(scene: Scene, plan_legs: tuple[Leg, ...], ranges: Ranges) -> list[Finding]:
    """The legs cover the trajectory exactly, and each step has those that belong to it, in its order."""
    line = ranges.spline
    if not plan_legs:
        return [Finding(Code.LEGS, "a plan without legs")]
    findings: list[Finding] = []
    edges = [(line.start, plan_legs[0].t0), *((a.t1, b.t0) for a, b in pairwise(plan_legs))]
    edges.append((plan_legs[-1].t1, line.end))
    for i, (one, other) in enumerate(edges):
        if one != other:
            findings.append(Finding(Code.LEGS, "legs must meet", abs(one - other), "s", f"before leg {i}"))
    for i, leg in enumerate(plan_legs):
        lasts = leg.t1 >= leg.t0 if leg.kind is LegKind.FOLLOW else leg.t1 > leg.t0
        if not lasts:
            findings.append(Finding(Code.LEGS, "a leg must last", leg.t0 - leg.t1, "s", f"leg {i}"))
    steps = [leg.step for leg in plan_legs]
    if any(b < a for a, b in pairwise(steps)):
        findings.append(Finding(Code.LEGS, "legs must come in the order of the steps"))
    for number, step in enumerate(scene.task):
        own = tuple(leg for leg in plan_legs if leg.step == number)
        findings += _of_step(step, number, own, last=number == len(scene.task) - 1)
    return findings + _waits(plan_legs, ranges)


def pattern(step: Step, *, last: bool) -> str:
    """The legs that a step has, as a regular expression of `LETTERS`; after the last one the arm may come to rest."""
    way = "W?[MA]+"
    if isinstance(step, Move):
        return "W?[MA]*A[MA]*" if step.arch is not None else way
    rest = "M?" if last else ""
    if isinstance(step, Follow):
        return f"{way}F{rest}"
    return f"{way}{'D' if step.approach_m > 0 else ''}F{'U' if step.depart_m > 0 else ''}{rest}"


def dwell(step: Step) -> float:
    """How long the tool is glued at its control point, s."""
    if isinstance(step, Follow):
        return step.duration_s
    return step.dwell_s if isinstance(step, Pick | Place) else 0.0


def _of_step(step: Step, number: int, own: tuple[Leg, ...], *, last: bool) -> list[Finding]:
    word = "".join(LETTERS[leg.kind] for leg in own)
    if not re.fullmatch(pattern(step, last=last), word):
        kinds = ", ".join(leg.kind for leg in own) or "none"
        return [Finding(Code.LEGS, f"step {number} ({step.name}) cannot have the legs {kinds}")]
    findings = []
    for leg in own:
        if leg.kind is LegKind.FOLLOW:
            off = abs(leg.t1 - leg.t0 - dwell(step))
            if not off <= TIME_S:
                findings.append(Finding(Code.LEGS, f"step {number} ({step.name}) follows for another time", off, "s"))
    return findings


def _waits(plan_legs: tuple[Leg, ...], ranges: Ranges) -> list[Finding]:
    waits = [leg for leg in plan_legs if leg.kind is LegKind.WAIT]
    if not waits or not all(ranges.spline.start <= leg.t0 <= leg.t1 <= ranges.spline.end for leg in waits):
        return []
    swept = ranges.sweep(_times([leg.t0 for leg in waits]), _times([leg.t1 for leg in waits]))
    moved = (swept.upper - swept.lower).max(1)
    return [
        Finding(Code.LEGS, "a joint moves while the arm waits", float(amount), "rad or m", f"{leg.t0:.6g} s")
        for leg, amount in zip(waits, moved, strict=True)
        if not amount <= STANDING
    ]


def _times(values: list[float]) -> FloatArray:
    return np.array(values, dtype=np.float64)
