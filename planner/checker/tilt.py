"""Pitch and roll of a hand, by the checker's own derivation, and whether it keeps to them along straight legs.

With the heading φ, M = Rz(φ)ᵀ R of the flange's rotation R is Ry(−P) Rx(r) (H9): its first column is (cos P, 0, sin P),
and the second row is (0, cos r, −sin r). What stands at its top left zero is how far the tool axis leaves the plane.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker.order import TIME_S
from assur.planner.checker.ranges import Ranges
from assur.planner.checker.settle import settle
from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.outcome import Arrival, Leg, LegKind
from assur.planner.model.scene import Move, Scene
from assur.planner.robots.protocol import Robot, Sweep

STRAIGHT_RAD = 1e-4
"""rad. Along a straight leg pitch and roll stay within this of the way between those at its ends: as in glued legs."""
COARSEST_S = 0.005
"""Length of the intervals to begin with, s, as for glued legs."""
HALF_RAD = 1e-6
"""rad. Ways that are so near to half a turn are as short one way round as the other: the one that was gone counts."""
FAR_M = 1e6
"""A point this far from the flange's origin accelerates along the vertical, at some attitude, by as much as the hand
pitches (or rolls), times this; so a bound for it, divided by it, bounds both."""


def wrapped(angle: FloatArray) -> FloatArray:
    """The angle less full turns, in [-π, π]."""
    return np.asarray(angle - 2 * np.pi * np.round(angle / (2 * np.pi)))


def has_tilt(robot: Robot) -> bool:
    """Whether an arm has a pitch and a roll to be asked for."""
    return "pitch" in robot.coordinates


def tilt(robot: Robot, q: FloatArray) -> FloatArray:
    """Pitch and roll (..., 2) of the flange in the joint positions q (..., n), in [-π, π], and third the sine of the
    angle by which the tool axis leaves the plane of its heading, which is 0: (..., 3)."""
    rotation, heading = robot.placements(q)[1][..., robot.links.index("flange"), :, :], robot.forward(q)[1]
    c, s = np.cos(heading)[..., None], np.sin(heading)[..., None]
    ahead = c * rotation[..., 0, :] + s * rotation[..., 1, :]
    across = c * rotation[..., 1, :] - s * rotation[..., 0, :]
    pitch, roll = np.arctan2(rotation[..., 2, 0], ahead[..., 0]), np.arctan2(-across[..., 2], across[..., 1])
    return np.stack([pitch, roll, across[..., 0]], -1)


def tilt_rates(robot: Robot, q: FloatArray, qd: FloatArray) -> FloatArray:
    """Rates (..., 2) of pitch and roll, by the Jacobian."""
    rows = [robot.coordinates.index(name) for name in ("pitch", "roll")]
    return np.asarray((robot.jacobian(q)[..., rows, :] @ qd[..., None])[..., 0])


def turned_by(found: FloatArray, asked: FloatArray) -> FloatArray:
    """How far (...) a tilt (..., 3) is from the pitch and roll (..., 2) that are asked, rad."""
    apart = np.abs(wrapped(found[..., :2] - asked)).max(-1)
    return np.asarray(np.maximum(apart, np.abs(found[..., 2])))


def tilt_accelerations(robot: Robot, swept: Sweep) -> FloatArray:
    """Bounds (N,) of the size of the second derivatives of pitch and of roll, rad/s², over the intervals of a sweep."""
    many = len(swept.rate)
    flange, far = np.full(many, robot.links.index("flange")), np.full(many, FAR_M)
    return np.asarray(robot.point_bounds(flange, far, far, np.tile([0.0, 0.0, 1.0], (many, 1)), swept)[1]) / FAR_M


def straight(scene: Scene, ranges: Ranges, legs: tuple[Leg, ...], arrivals: tuple[Arrival, ...]) -> list[Finding]:
    """Findings for straight legs on which the hand does not go from its pitch and roll at the beginning to those at the
    end, the short way and both together. Not checked: by which law of time, and that the tool point's way is straight.
    """
    if not has_tilt(scene.robot):
        return []
    met = {arrival.step: arrival.time for arrival in arrivals}
    names, spans = [], []
    for number, step in enumerate(scene.task):
        # however many legs the way is cut into, and whatever they are called
        own = [leg for leg in legs if leg.step == number and leg.kind is not LegKind.WAIT]
        own = [leg for leg in own if leg.t1 <= met.get(number, -np.inf) + TIME_S]
        if isinstance(step, Move) and step.leg == "cartesian" and own:
            names.append(step.name)
            spans.append(np.array([own[0].t0, own[-1].t1]))
    ways = _Ways(scene, ranges, spans)
    findings = []
    for excess in settle(spans, COARSEST_S, ways.judge):
        name = names[excess.of]
        what = f"the hand leaves the way between pitch and roll at the ends of the straight leg to {name}"
        findings.append(Finding(Code.GLUE, what, excess.amount, "rad", f"{excess.time:.6g} s"))
    return findings


class _Ways:
    """Distance of the hand from the segments, in the plane of pitch and roll, between the ends of spans [t0, t1]."""

    def __init__(self, scene: Scene, ranges: Ranges, spans: list[FloatArray]) -> None:
        self.robot, self.ranges = scene.robot, ranges
        looks = [self._tilt(np.array([t0, (t0 + t1) / 2, t1]))[:, :2] for t0, t1 in spans]
        begin, halfway, end = np.array(looks).reshape(-1, 3, 2).swapaxes(0, 1)
        way, gone = wrapped(end - begin), wrapped(halfway - begin)
        either = np.abs(way) > np.pi - HALF_RAD
        self.way = np.where(either & (way * gone < 0), way - 2 * np.pi * np.sign(way), way)
        self.middle = begin + self.way / 2

    def _tilt(self, t: FloatArray) -> FloatArray:
        return tilt(self.robot, self.ranges.spline.state(t)[0])

    def distance(self, of: IntArray, t: FloatArray) -> FloatArray:
        """(T,) rad. A segment is no longer than half a turn each way, so that from its middle no turn is in doubt."""
        found, way = self._tilt(t), self.way[of]
        beside = wrapped(found[:, :2] - self.middle[of])
        length = np.maximum((way * way).sum(-1), np.finfo(float).tiny)
        share = np.clip((beside * way).sum(-1) / length, -0.5, 0.5)
        return np.asarray(np.maximum(np.sqrt(((beside - share[:, None] * way) ** 2).sum(-1)), np.abs(found[:, 2])))

    def judge(self, of: IntArray, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Excess of the distance over what is allowed (see `settle`): between two instants pitch and roll leave their
        chord by at most M h²/8 (V2), and the distance from a segment is greatest at an end of the chord."""
        taken = np.maximum(self.distance(of, a), self.distance(of, b))[:, None] - STRAIGHT_RAD
        bent = np.sqrt(2.0) * tilt_accelerations(self.robot, self.ranges.sweep(a, b))
        return taken + bent[:, None] * (b - a)[:, None] ** 2 / 8, taken
