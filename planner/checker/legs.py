"""Where the plan begins and ends, and whether its legs are those of the task, in order, without gap or overlap."""

from __future__ import annotations

import re
from itertools import pairwise

import numpy as np

from assur.planner.checker.paths.curves import length_of
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import REST, World
from assur.planner.model.outcome import Leg, LegKind
from assur.planner.model.scene import Follow, Move, Pick, Place, Step, Trace

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


def ends(world: World) -> list[Finding]:
    """Begins in the given state; ends at rest if asked, and no later than allowed."""
    findings = []
    knots, start, options = world.knots, world.scene.start, world.scene.options
    if not abs(world.start - start.time) <= START:
        off = abs(world.start - start.time)
        findings.append(Finding(Code.START, "the first knot has another time than the start", off, "s"))
    for name, unit in (("q", "1"), ("qd", "1/s"), ("qdd", "1/s²")):
        pairs = zip(getattr(knots, name)[0].tolist(), getattr(start, name).tolist(), strict=True)
        off = max(abs(one - other) for one, other in pairs)
        if not off <= START:
            findings.append(Finding(Code.START, f"the first knot has another {name} than the start", off, unit))
    if options.end == "rest" and not world.at_rest:
        fastest = max(float(np.abs(rate[-1]).max()) for rate in (knots.qd, knots.qdd))
        findings.append(Finding(Code.END, "the last knot is not at rest", fastest - REST, "1/s, 1/s²"))
    if options.latest_end_s is not None and not world.end <= options.latest_end_s + TIME_S:
        findings.append(Finding(Code.END, "the motion ends too late", world.end - options.latest_end_s, "s"))
    return findings


def order(world: World, legs: tuple[Leg, ...]) -> list[Finding]:
    """The legs cover the trajectory exactly, and each step has those that belong to it, in its order."""
    if not legs:
        return [Finding(Code.LEGS, "a plan without legs")]
    findings: list[Finding] = []
    edges = [(world.start, legs[0].t0), *((a.t1, b.t0) for a, b in pairwise(legs)), (legs[-1].t1, world.end)]
    for i, (one, other) in enumerate(edges):
        if one != other:
            findings.append(Finding(Code.LEGS, "legs must meet", abs(one - other), "s", f"before leg {i}"))
    for i, leg in enumerate(legs):
        lasts = leg.t1 >= leg.t0 if leg.kind is LegKind.FOLLOW else leg.t1 > leg.t0
        if not lasts:
            findings.append(Finding(Code.LEGS, "a leg must last", leg.t0 - leg.t1, "s", f"leg {i}"))
    task = world.scene.task
    if any(b.step < a.step for a, b in pairwise(legs)) or not all(0 <= leg.step < len(task) for leg in legs):
        return [*findings, Finding(Code.LEGS, "legs must come in the order of the steps")]
    for number, step in enumerate(task):
        own = tuple(leg for leg in legs if leg.step == number)
        findings += _of_step(step, own, last=number == len(task) - 1)
    if findings:
        return findings
    for leg in legs:
        if leg.kind is LegKind.WAIT:
            q = world.joints(leg.t0, leg.t1)
            moved = float((q[:, 1] - q[:, 0]).max())
            if not moved <= STANDING:
                what = "a joint moves while the arm waits"
                findings.append(Finding(Code.LEGS, what, moved, "rad or m", f"{leg.t0:.6g} s"))
    return findings


def pattern(step: Step, *, last: bool) -> str:
    """The legs that a step has, as a regular expression of `LETTERS`; after the last one the arm may come to rest."""
    way = "W?[MA]+" if step.arch is None else "W?[MA]*A[MA]*"
    if isinstance(step, Move):
        return way
    rest = "M?" if last else ""
    if isinstance(step, Follow):
        return f"{way}F{rest}"
    if isinstance(step, Trace):
        return f"{way}DFU{rest}"
    return f"{way}{'D' if step.approach_m > 0 else ''}F{'U' if step.depart_m > 0 else ''}{rest}"


def dwell(step: Step) -> float:
    """How long the tool stays at its control point, s."""
    if isinstance(step, Follow):
        return step.duration_s
    if isinstance(step, Trace):
        return length_of(step.path) / step.speed_m_s
    return step.dwell_s if isinstance(step, Pick | Place) else 0.0


def _of_step(step: Step, own: tuple[Leg, ...], *, last: bool) -> list[Finding]:
    word = "".join(LETTERS[leg.kind] for leg in own)
    if not re.fullmatch(pattern(step, last=last), word):
        kinds = ", ".join(leg.kind for leg in own) or "none"
        return [Finding(Code.LEGS, f"{step.name} cannot have the legs {kinds}")]
    findings = []
    for leg in own:
        if leg.kind is LegKind.FOLLOW:
            off = abs(leg.t1 - leg.t0 - dwell(step))
            if not off <= TIME_S:
                findings.append(Finding(Code.LEGS, f"{step.name} follows for another time", off, "s"))
    return findings
