"""Whether a plan with parabolic blends is one, and misses its vias by what it says.

In such a plan every piece of the spline is a parabola: its acceleration is constant (zone I), or zero (zone II). A via
is due in the middle of a zone I, or of a piece without acceleration where nothing bends. From the velocities v1, v2 at
both ends of that piece, 2τ long, follows the pose that it is blended past,

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


class _Pieces:
    """Of each piece (P,): begin, length, velocities (P, n, 5) and accelerations (P, n, 4) by their control values."""

    def __init__(self, world: World) -> None:
        knots, n = world.knots, world.knots.n
        first = np.flatnonzero(knots.time[1:] > knots.time[:-1])
        every = world.tables[1][first, 1 : 1 + n * JOINT].reshape(len(first), n, JOINT // ROOM, ROOM)
        self.begin, self.length = knots.time[first], knots.time[first + 1] - knots.time[first]
        self.place, self.velocity, self.pull = every[:, :, 0], every[:, :, 1, :5], every[:, :, 2, :4]
        # what some units in the last place of positions do to the acceleration
        rounding = UNITS * np.finfo(np.float64).eps * np.abs(self.place).max(-1) / self.length[:, None] ** 2
        self.bent: FloatArray = np.maximum(BENT * world.scene.robot.limits.acceleration, rounding)
        self.accelerates = (np.abs(self.pull).max(-1) > self.bent).any(1)


def blends(world: World, arrivals: tuple[Arrival, ...], found: tuple[Target, ...]) -> list[Finding]:
    """Findings about parabolas, acceleration times and missed vias; of other plans, that they claim none missed."""
    pairs = list(zip(arrivals, found, strict=False))
    if not world.scene.options.blended:
        return [
            Finding(Code.BLEND, f"{target.step.name} is said to be missed, and may not be")
            for arrival, target in pairs
            if arrival.missed_by is not None
        ]
    pieces = _Pieces(world)
    findings = _parabolas(world, pieces)
    for arrival, target in pairs:
        findings += _missed(world, pieces, arrival, target)
    return findings


def _parabolas(world: World, pieces: _Pieces) -> list[Finding]:
    """Every piece has one acceleration, its control values being the same, and lasts as long as is asked."""
    scene, findings = world.scene, []
    bent = pieces.pull.max(-1) - pieces.pull.min(-1)
    if not (bent <= pieces.bent).all():
        k, joint = (int(i) for i in np.unravel_index(np.argmax(bent / pieces.bent), bent.shape))
        what = f"{scene.robot.joints[joint].name} does not move along a parabola"
        share = float(bent[k, joint] / scene.robot.limits.acceleration[joint])
        where = f"{pieces.begin[k]:.6g} s"
        findings.append(Finding(Code.BLEND, what, share, "of its acceleration limit", where))
    asked = scene.options.acceleration_time_s
    if asked is not None:
        off = np.where(pieces.accelerates, np.abs(pieces.length - asked), 0.0)
        k = int(np.argmax(off))
        if not off[k] <= TIME_S:
            what = f"a blend does not last the {1e3 * asked:g} ms that are asked"
            findings.append(Finding(Code.BLEND, what, float(off[k]), "s", f"{pieces.begin[k]:.6g} s"))
    return findings


def _missed(world: World, pieces: _Pieces, arrival: Arrival, target: Target) -> list[Finding]:
    name, where, claimed = target.step.name, f"{arrival.time:.6g} s", arrival.missed_by
    if not asks_passing(target.step):
        return [] if claimed is None else [Finding(Code.BLEND, f"{name} is said to be missed, and may not be")]
    if claimed is None:
        return [Finding(Code.BLEND, f"it is not said by how much {name} is missed", where=where)]
    findings: list[Finding] = []

    def hold(off: float, allowed: float, unit: str, what: str) -> None:
        if not off <= allowed:
            findings.append(Finding(Code.BLEND, what, off, unit, where))

    k = min(max(int(np.searchsorted(pieces.begin, arrival.time, side="right")) - 1, 0), len(pieces.begin) - 1)
    tau = float(pieces.length[k]) / 2
    miss = tau * (pieces.velocity[k, :, -1] - pieces.velocity[k, :, 0]) / 4
    if pieces.accelerates[k]:
        off = abs(arrival.time - float(pieces.begin[k]) - tau)
        hold(off, TIME_S, "s", f"{name} is not due in the middle of its blend")
    q = world.joints(arrival.time, arrival.time)[:, 0]
    past = _standing(world, q - miss)
    tool, here = past.tool(past.start), world.tool(arrival.time)
    (goal,) = world.states([(world.frame[target.frame], target.tool, arrival.time)])
    hold(math.dist(tool.p, goal.p), MEET_M, "m", f"what is blended past is not {name}")
    turned = abs(math.remainder(tool.yaw - goal.yaw, math.tau)) if target.turns else 0.0
    hold(turned, MEET_RAD, "rad", f"what is blended past is turned against {name}")
    findings += tilted([(tool.pitch, tool.roll)] if target.tilt is not None else [], arrival, target)
    off = float(np.abs(np.array(claimed.joints) - miss).max())
    hold(off, MISSED, "rad or m", f"a joint misses {name} by another amount")
    off = abs(claimed.distance_m - math.dist(here.p, goal.p))
    hold(off, MEET_M, "m", f"the tool misses {name} by another distance")
    return findings


def _standing(world: World, q: FloatArray) -> World:
    """The same scene with the arm standing at q (n,)."""
    still, none = np.stack([q, q]), np.zeros((2, len(q)))
    return World(world.scene, replace(world.plan, trajectory=Trajectory(world.knots.time[[0, -1]], still, none, none)))
