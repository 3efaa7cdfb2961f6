"""Whether the peaks of the joints are what an answer says, from both sides: no instant exceeds them, and one reaches
them. Both follow from control values of the spline, cut until they decide (`spline.excesses`)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.limits import KINDS, weighed
from assur.planner.checker.spline import excesses
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.outcome import JointPeak
from assur.planner.model.phases import Phase

WITHIN = (1e-6, 1e-6, 1e-3)
"""By how much a peak of velocity, acceleration and jerk may be off, as a share of the joint's limit: rounding. Jerk is
a third difference of the knots' numbers, which over pieces of 10 µs rounds to 1e-4 of a usual limit."""


def peaks(world: World, phases: tuple[Phase, ...], said: tuple[JointPeak, ...] | None) -> list[Finding]:
    """Findings about the stated peaks of the joints and their shares of the limits; None: nothing is stated."""
    if said is None:
        return []
    limited = world.scene.options.jerk_limited
    joints, count = world.scene.robot.joints, 3 if limited else 2
    if [peak.joint for peak in said] != [joint.name for joint in joints]:
        return [Finding(Code.CLAIM, f"there must be a peak of each joint: {', '.join(each.name for each in joints)}")]
    if any((value is None) is limited for peak in said for value in (peak.jerk, peak.jerk_ratio)):
        which = "a jerk" if limited else "no jerk, which has no bound"
        return [Finding(Code.CLAIM, f"the peaks of the joints must have {which}")]
    limits, whole = world.scene.robot.limits, (0, len(world.knots.time) - 1)
    every = np.array([limits.velocity, limits.acceleration, limits.jerk])[:count]
    sizes, shares = _numbers(said, count, ratios=False), _numbers(said, count, ratios=True)
    findings = _wrong(world, [(*whole, sizes)], every, "peak of the")
    spans = [(first, last, shares * left * every) for first, last, left in _loaded(world, phases, count)]
    return findings + _wrong(world, spans, every, "share of the limit of")


def _numbers(said: Sequence[JointPeak], count: int, *, ratios: bool) -> FloatArray:
    """The sizes (count, n) that are said of velocity, acceleration and jerk, or their shares of the limits."""
    names = [name + "_ratio" * ratios for name in KINDS[1 : 1 + count]]
    return np.array([[getattr(peak, name) for peak in said] for name in names], dtype=np.float64)


def _loaded(world: World, phases: tuple[Phase, ...], count: int) -> list[tuple[int, int, FloatArray]]:
    """The knots between which each load is carried, and what it leaves of velocity, acceleration and jerk (count, 1).
    Where nothing is carried for any time, all of the motion has the limits of the robot."""
    time, found = world.knots.time, []
    for load in weighed(world.scene, phases, turned=False):
        first = int(np.searchsorted(time, load.t0 - TIME_S))
        last = int(np.searchsorted(time, load.t1 + TIME_S, side="right")) - 1
        if last > first:
            found.append((first, last, np.array([[1.0], [load.share], [load.share]])[:count]))
    return found or [(0, len(time) - 1, np.ones((count, 1)))]


def _wrong(world: World, spans: Sequence[tuple[int, int, FloatArray]], limits: FloatArray, told: str) -> list[Finding]:
    """Findings about sizes (count, n) that are said of the motion between two knots; one of the spans has to reach
    them, and none may exceed them."""
    slack, shape = np.array(WITHIN)[: len(limits), None] * limits, limits.shape
    exceeded, reached = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=bool)
    for first, last, sizes in spans:
        exceeded |= _exceeds(world, first, last, sizes + slack)
        reached |= (sizes <= slack) | _exceeds(world, first, last, sizes - slack)
    findings = []
    for wrong, how in ((exceeded, "more"), (~reached, "less")):
        for kind, joint in np.argwhere(wrong):
            name = world.scene.robot.joints[joint].name
            what = f"the {told} {KINDS[kind + 1]} of {name} is {how} than the answer says"
            findings.append(Finding(Code.CLAIM, what, where="margins.peaks"))
    return findings


def _exceeds(world: World, first: int, last: int, sizes: FloatArray) -> BoolArray:
    """Whether rates between two knots exceed `sizes` (count, n) anywhere; a number that is none is exceeded."""
    n, count = sizes.shape[1], len(sizes)
    worst, when, allowed = np.zeros((4, n)), np.zeros((4, n)), np.zeros((5, n))
    allowed[1], allowed[2 : 2 + count] = np.inf, sizes
    excesses(world.tables[1][first : last + 1], n, allowed, 1 + count, worst, when)
    return np.asarray(~(worst[1 : 1 + count] <= 0.0) | ~np.isfinite(sizes))
