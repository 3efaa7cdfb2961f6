"""Whether the peaks of the joints are what an answer says, from both sides: no instant exceeds them, and one reaches
them. Both follow from control values of the spline, cut until they decide (`spline.excesses`). And whether what it says
of them is so: which limit binds, in which leg, and what would help."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from assur.planner.arrays import BoolArray, FloatArray
from assur.planner.checker.claims.busiest import busiest
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.limits import KINDS, weighed
from assur.planner.checker.spline import excesses
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import JointPeak
from assur.planner.model.phases import Phase

WITHIN = (1e-6, 1e-6, 1e-3)
"""By how much a peak of velocity, acceleration and jerk may be off, as a share of the joint's limit: rounding. Jerk is
a third difference of the knots' numbers, which over pieces of 10 µs rounds to 1e-4 of a usual limit."""
TIE = 1e-9
"""Shares of limits that differ by less are equal."""


def peaks(world: World, phases: tuple[Phase, ...], claims: Claims) -> list[Finding]:
    """Findings about the peaks of the joints, their shares of the limits, and about which of them binds."""
    said, limited = claims.peaks, world.scene.options.jerk_limited
    if said is None:
        alone = "what binds cannot be verified without the peaks of the joints"
        told = (("binds", claims.binds), ("helps", claims.helps), ("busiest", claims.busiest))
        return [Finding(Code.CLAIM, alone, where=f"margins.{name}") for name, claim in told if claim is not None]
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
    findings += _wrong(world, spans, every, "share of the limit of")
    return findings + _binding(world, phases, said, claims)


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


def _binding(world: World, phases: tuple[Phase, ...], said: Sequence[JointPeak], claims: Claims) -> list[Finding]:
    """Whether what binds is what is used most, of shares that were looked at already, and what is said of it."""
    limit = world.scene.carry_acceleration
    if claims.binds is None or (limit is not None and claims.tool_acceleration is None):
        missing = "binds" if claims.binds is None else "tool_acceleration_m_s2"
        told = (("binds", claims.binds), ("helps", claims.helps))
        alone = f"this cannot be verified without margins.{missing}"
        findings = [Finding(Code.CLAIM, alone, where=f"margins.{name}") for name, claim in told if claim is not None]
        return findings + busiest(world, phases, claims, None)
    used = [
        (ratio, str(kind), peak.joint)
        for peak in said
        for kind, ratio in zip(KINDS[1:], (peak.velocity_ratio, peak.acceleration_ratio, peak.jerk_ratio), strict=True)
        if ratio is not None
    ]
    if limit is not None and claims.tool_acceleration is not None:
        held = any(phase.attached.held is not None and phase.t1 > phase.t0 and phase.step >= 0 for phase in phases)
        used += [(claims.tool_acceleration / limit, "acceleration", "")] * held
    most = max(ratio for ratio, _, _ in used)
    allowed = {
        f"{kind} of {joint or 'the carried part'} ({100 * ratio:.0f} %)": (ratio, kind, joint)
        for ratio, kind, joint in used
        if ratio >= most - TIE
    }
    if claims.binds not in allowed:
        what = f"what binds is {' or '.join(allowed)}, not {claims.binds!r:.60}"
        return [Finding(Code.CLAIM, what, where="margins.binds")]
    binding = allowed[claims.binds]
    helps = f"a higher limit, or less travel of {binding[2]}" if binding[2] else "a higher limit (carry)"
    findings = busiest(world, phases, claims, binding)
    if claims.helps not in (None, helps):
        what = f"what helps is {helps}, not {claims.helps!r:.60}"
        findings.append(Finding(Code.CLAIM, what, where="margins.helps"))
    return findings
