"""Whether a plan by parabolic blends moves along parabolas, and misses its vias by what it states.

In such a plan the acceleration of every piece of the spline is constant (zone I), or zero (zone II). A via is due in
the middle of a zone I, or of a piece without acceleration where nothing bends. From the velocities v1, v2 at both ends
of that piece, 2τ long, follows the pose that it is blended past,

    B = q(t) − τ (v2 − v1)/4                                                                                (V4)

and the tool must be at the control point in B. So neither an inverse nor what the plan claims is believed.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.along import MEET_M
from assur.planner.checker.legs import TIME_S
from assur.planner.checker.meeting import MEET_RAD, tilted
from assur.planner.checker.spline import JOINT, ROOM
from assur.planner.checker.targets import Target, asks_passing
from assur.planner.checker.verdict import Code, Finding
from assur.planner.checker.world import World
from assur.planner.model.outcome import Arrival
from assur.planner.trajectory import Trajectory

BENT = 1e-6
"""Relative. How much the acceleration may change over a piece, of the limit; or, if that is more, by what rounding of
positions does to a short piece (`UNITS`): over 10 µs some 1e-4 rad/s², where limits are some 10 rad/s²."""
UNITS = 64
"""Units in the last place of a position: an acceleration is 20 times the difference of two of them, over h²."""
MISSED = 1e-9
"""rad or m. How far a claimed miss of a joint may be from ours: sums of a few terms of some radians."""


def passed(world: World, arrivals: tuple[Arrival, ...], found: tuple[Target, ...]) -> list[Finding]:
    """Findings about parabolas, acceleration times and missed vias; of all else, that it is not said to be missed."""
    options, findings = world.scene.options, list[Finding]()
    pieces = None if options.jerk_limited else _Pieces(world)
    if pieces is not None:
        findings += _parabolas(world, pieces)
    for arrival, target in zip(arrivals, found, strict=False):
        name, missed = target.step.name, options.vias_missed and asks_passing(target.step)
        if missed is (arrival.missed_by is None):
            what = f"it is not said by how much {name} is missed" if missed else f"{name} is met, and said to be missed"
            findings.append(Finding(Code.BLEND, what, where=f"{arrival.time:.6g} s"))
        elif missed and pieces is not None:
            findings += _missed(world, pieces, arrival, target)
    return findings


class _Pieces:
    """Of each piece (P,): begin, length, velocities (P, n, 5) and accelerations (P, n, 4) by their control values."""

    def __init__(self, world: World) -> None:
        knots, n = world.knots, world.knots.n
        first = np.flatnonzero(knots.time[1:] > knots.time[:-1])
        every = world.tables[1][first, 1 : 1 + n * JOINT].reshape(len(first), n, JOINT // ROOM, ROOM)
        self.begin, self.length = knots.time[first], knots.time[first + 1] - knots.time[first]
        self.velocity, self.pull = every[:, :, 1, :5], every[:, :, 2, :4]
        # what some units in the last place of positions do to the acceleration
        rounding = UNITS * np.finfo(np.float64).eps * np.abs(every[:, :, 0]).max(-1) / self.length[:, None] ** 2
        self.bent: FloatArray = np.maximum(BENT * world.scene.robot.limits.acceleration, rounding)
        self.accelerates = (np.abs(self.pull).max(-1) > self.bent).any(1)


def _parabolas(world: World, pieces: _Pieces) -> list[Finding]:
    """Every piece has one acceleration, its control values being the same, and lasts as long as is required."""
    scene, findings = world.scene, []
    bent = pieces.pull.max(-1) - pieces.pull.min(-1)
    if not (bent <= pieces.bent).all():
        k, joint = (int(i) for i in np.unravel_index(np.argmax(bent / pieces.bent), bent.shape))
        what = f"{scene.robot.joints[joint].name} does not move along a parabola"
        share = float(bent[k, joint] / scene.robot.limits.acceleration[joint])
        findings.append(Finding(Code.BLEND, what, share, "of its acceleration limit", f"{pieces.begin[k]:.6g} s"))
    required = scene.options.acceleration_time_s
    if required is not None:
        off = np.where(pieces.accelerates, np.abs(pieces.length - required), 0.0)
        k = int(np.argmax(off))
        if not off[k] <= TIME_S:
            what = f"a blend does not last the {1e3 * required:g} ms that are required"
            findings.append(Finding(Code.BLEND, what, float(off[k]), "s", f"{pieces.begin[k]:.6g} s"))
    return findings


def _missed(world: World, pieces: _Pieces, arrival: Arrival, target: Target) -> list[Finding]:
    """Findings about a via that is missed by what its arrival states."""
    name, t, claimed = target.step.name, arrival.time, arrival.missed_by
    k = min(max(int(np.searchsorted(pieces.begin, t, side="right")) - 1, 0), len(pieces.begin) - 1)
    tau = float(pieces.length[k]) / 2
    late = abs(t - float(pieces.begin[k]) - tau) if pieces.accelerates[k] else 0.0
    miss = tau * (pieces.velocity[k, :, -1] - pieces.velocity[k, :, 0]) / 4
    # the same scene with the arm standing in the pose
    still = np.stack([world.joints(t, t)[:, 0] - miss] * 2)
    pose = Trajectory(world.knots.time[[0, -1]], still, np.zeros_like(still), np.zeros_like(still))
    past = World(world.scene, replace(world.plan, trajectory=pose))
    tool, here = past.tool(past.start), world.tool(t)
    (goal,) = world.states([(world.frame[target.frame], target.tool, t)])
    turned = abs(math.remainder(tool.yaw - goal.yaw, math.tau)) if target.turns else 0.0
    joints = distance = math.nan
    if claimed is not None:
        joints = float(np.abs(np.array(claimed.joints) - miss).max())
        distance = abs(claimed.distance_m - math.dist(here.p, goal.p))
    rules = (
        (late, TIME_S, "s", f"{name} is not due in the middle of its blend"),
        (math.dist(tool.p, goal.p), MEET_M, "m", f"what is blended past is not {name}"),
        (turned, MEET_RAD, "rad", f"what is blended past is turned against {name}"),
        (joints, MISSED, "rad or m", f"a joint misses {name} by another amount"),
        (distance, MEET_M, "m", f"the tool misses {name} by another distance"),
    )
    findings = [
        Finding(Code.BLEND, what, off, unit, f"{t:.6g} s") for off, most, unit, what in rules if not off <= most
    ]
    return findings + tilted([(tool.pitch, tool.roll)] if target.tilt is not None else [], arrival, target)
