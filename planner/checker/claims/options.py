"""Options and marks of steps that say how the arm goes: working mode, distance from singular positions, vias.

Nothing is endangered where they are not kept, and they are asked for all the same. The working mode is asked of the
control points; along legs that track a point or go along a line or a path it stays, where a margin keeps the arm from
singular positions there.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.claims.postures import margin_kept, mode_of, parallel_kept
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.meeting import MEET_RAD_S
from assur.planner.checker.targets import Target, asks_passing, asks_velocity
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.outcome import TRACKING, Arrival, Leg, LegKind
from assur.planner.model.scene import Move

MARGIN = 1e-3
"""By how much a singularity margin may be missed between the instants at which a planner looks: 1 ms apart, an elbow
with 100 rad/s² leaves its chord by 1e-5 rad; a margin is a choice of two digits."""
BESIDE_S = 0.01
"""How long before and after a via the arm's way there is looked at, s."""
WAY = 1e-9
"""rad or m. A joint that goes a shorter way in this time is taken to stand."""


def options(
    world: World, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...], found: tuple[Target, ...]
) -> list[Finding]:
    """Findings about the options that a plan does not keep."""
    if [arrival.step for arrival in arrivals] != list(range(len(found))):
        return []  # it is not said of which point an arrival is, which `meeting` finds
    findings = _modes(world, arrivals) + _margins(world, legs, arrivals, found)
    for arrival, target in zip(arrivals, found, strict=True):
        if asks_passing(target.step) and target.step.leg == "joint":
            findings += _flown_by(world, legs, arrival, target)
    return findings


def _modes(world: World, arrivals: tuple[Arrival, ...]) -> list[Finding]:
    """The working mode in which each control point is met; of a missed via, that of the pose that is missed."""
    robot, asked = world.scene.robot, world.scene.options.elbow
    if asked == "auto":
        return []
    number = mode_of(world, world.scene.start.q) if asked == "keep" else robot.modes.index(asked)
    findings = []
    for arrival in arrivals:
        if not world.start <= arrival.time <= world.end:
            continue  # `meeting` says so
        q = world.joints(arrival.time, arrival.time)[:, 0]
        if arrival.missed_by is not None:
            q = q - np.array(arrival.missed_by.joints)
        mode = mode_of(world, q)
        if mode != number:
            there = robot.modes[mode] if mode >= 0 else "none"
            what = f"{arrival.control_point} is met in mode {there}, and {robot.modes[number]} is asked for"
            findings.append(Finding(Code.ELBOW, what, where=f"{arrival.time:.6g} s"))
    return findings


def modes(world: World, arrivals: tuple[Arrival, ...], said: tuple[str | None, ...] | None) -> list[Finding]:
    """A finding for each arrival that is in another working mode than is said (None: nothing is said)."""
    findings = list[Finding]()
    for i, (arrival, told) in enumerate(zip(arrivals, said or (), strict=False)):
        if told is None or not world.start <= arrival.time <= world.end:
            continue
        mode = mode_of(world, world.joints(arrival.time, arrival.time)[:, 0])
        there = world.scene.robot.modes[mode] if mode >= 0 else "none"
        if told != there:
            what = f"an arrival is in mode {there}, not {told!r:.40}"
            findings.append(Finding(Code.CLAIM, what, where=f"arrivals[{i}].mode"))
    return findings


def _margins(
    world: World, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...], found: tuple[Target, ...]
) -> list[Finding]:
    """Where the arm is nearer to a singular position than it may be: along legs that track a point or go along a line
    or a path, and where the velocity of a moving point is matched."""
    least = world.scene.options.singularity_margin - MARGIN
    if not least > 0.0:
        return []
    spans = list[tuple[str, float, float]]()
    for arrival, target in zip(arrivals, found, strict=True):
        step, own = target.step, [leg for leg in legs if leg.step == target.number]
        if isinstance(step, Move) and step.leg == "cartesian":
            guided = [leg for leg in own if leg.kind is not LegKind.WAIT and leg.t1 <= arrival.time + TIME_S]
        else:
            guided = [leg for leg in own if leg.kind in TRACKING]
        spans += [(f"{leg.kind} of {step.name}", leg.t0, leg.t1) for leg in guided]
        moves = world.scene.frames[target.frame].law.kind != "fixed"
        if not guided and moves and asks_velocity(step):
            spans.append((step.name, arrival.time, arrival.time))
    findings = []
    for name, t0, t1 in spans:
        asked = ((margin_kept, "singular position"), (parallel_kept, "singular position of type 2"))
        for kept, what in asked[: 1 + (world.scene.robot.parallel_least > 0.0)]:
            lost = kept(world, least, t0, t1)
            if lost is not None:
                told = f"the arm comes too near to a {what} in {name}"
                told += " (or could not be shown not to)" if math.isnan(lost[0]) else ""
                findings.append(Finding(Code.SINGULARITY, told, least - lost[0], "1", f"{lost[1]:.6g} s"))
    return findings


def _flown_by(world: World, legs: tuple[Leg, ...], arrival: Arrival, target: Target) -> list[Finding]:
    """Whether a via is flown by: the arm does not wait there, and comes to rest only if no joint goes on."""
    name, where = target.step.name, f"{arrival.time:.6g} s"
    if any(leg.kind is LegKind.WAIT and abs(leg.t0 - arrival.time) <= TIME_S for leg in legs):
        return [Finding(Code.VIA, f"the arm waits at {name}, which is to be flown by", where=where)]
    if not world.tool(arrival.time).fastest <= MEET_RAD_S or not world.start < arrival.time < world.end:
        return []
    begin, there, behind = (_joints(world, arrival.time + beside) for beside in (-BESIDE_S, 0.0, BESIDE_S))
    goes_on = np.minimum(np.abs(there - begin), np.abs(behind - there)) > WAY
    if not (goes_on & ((there - begin) * (behind - there) > 0.0)).any():
        return []
    return [Finding(Code.VIA, f"the arm stops at {name}, which is to be flown by", where=where)]


def _joints(world: World, t: float) -> FloatArray:
    """Joints (n,) at a time, those of the nearer end outside the motion."""
    t = min(max(t, world.start), world.end)
    return np.asarray(world.joints(t, t)[:, 0])
