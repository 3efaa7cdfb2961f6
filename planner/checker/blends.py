"""Whether a plan with parabolic blends is one, and misses its vias by what it says.

In such a plan every piece of the spline is a parabola: its acceleration is constant (zone I), or zero (zone II). A via
is due in the middle of a zone I, or of a stretch without acceleration where nothing bends. From the velocities v1, v2
at both ends of that piece, 2τ long, follows the pose that it is blended past,

    B = q(t) − τ (v2 − v1)/4                                                                                (V4)

and the tool must be at the control point in B. So neither an inverse nor what the plan claims is believed.
"""

from __future__ import annotations

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.meeting import MEET_M, MEET_RAD, tilted
from assur.planner.checker.order import TIME_S
from assur.planner.checker.spline import Spline
from assur.planner.checker.targets import Target, asks_passing
from assur.planner.checker.tilt import wrapped
from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.outcome import Arrival
from assur.planner.model.scene import Scene

BENT = 1e-6
"""Relative. How much the acceleration may change over a piece, of the limit; or, if that is more, by what rounding of
positions does to a short piece (`UNITS`): over 10 µs some 1e-4 rad/s², where limits are some 10 rad/s²."""
UNITS = 64
"""Units in the last place of a position: an acceleration is 20 times the difference of two of them, over h²."""
MISSED = 1e-9
"""rad or m. How far a claimed miss of a joint may be from ours: sums of a few terms of some radians."""


def blends(scene: Scene, line: Spline, arrivals: tuple[Arrival, ...], found: tuple[Target, ...]) -> list[Finding]:
    """Findings about parabolas, acceleration times and missed vias; of other plans, that they claim none missed."""
    pairs = list(zip(arrivals, found, strict=False))
    if not scene.options.blended:
        return [
            Finding(Code.BLEND, f"{target.step.name} is said to be missed, and may not be")
            for arrival, target in pairs
            if arrival.missed_by is not None
        ]
    findings = _parabolas(scene, line) + _acceleration_time(scene, line)
    for arrival, target in pairs:
        findings += _missed(scene, line, arrival, target)
    return findings


def _parabolas(scene: Scene, line: Spline) -> list[Finding]:
    """Every piece has one acceleration: its control values are the same."""
    limit = scene.robot.limits.acceleration
    pull = line.control[2]
    bent = (pull.max(-1) - pull.min(-1)) / limit
    allowed = np.maximum(BENT, _rounding(line) / limit)
    if (bent <= allowed).all():
        return []
    k, joint = (int(i) for i in np.unravel_index(np.argmax(np.where(np.isnan(bent), np.inf, bent)), bent.shape))
    what = f"{scene.robot.joints[joint].name} does not move along a parabola"
    return [Finding(Code.BLEND, what, float(bent[k, joint]), "of its acceleration limit", f"{line.time[k]:.6g} s")]


def _rounding(line: Spline) -> FloatArray:
    """What some units in the last place of positions do to the acceleration of each piece, (P, n)."""
    place = np.abs(line.control[0]).max(-1)
    return np.asarray(UNITS * np.finfo(np.float64).eps * place / line.length[:, None] ** 2)


def _accelerates(scene: Scene, line: Spline) -> FloatArray:
    """Which pieces (P,) are zones I: some joint accelerates."""
    floor = np.maximum(BENT * scene.robot.limits.acceleration, _rounding(line))
    return np.asarray((np.abs(line.control[2]).max(-1) > floor).any(1))


def _acceleration_time(scene: Scene, line: Spline) -> list[Finding]:
    """Where one is asked, every zone I lasts it."""
    asked = scene.options.acceleration_time_s
    if asked is None:
        return []
    off = np.where(_accelerates(scene, line), np.abs(line.length - asked), 0.0)
    k = int(np.argmax(off))
    if off[k] <= TIME_S:
        return []
    what = f"a blend does not last the {1e3 * asked:g} ms that are asked"
    return [Finding(Code.BLEND, what, float(off[k]), "s", f"{line.time[k]:.6g} s")]


def _missed(scene: Scene, line: Spline, arrival: Arrival, target: Target) -> list[Finding]:
    name, where = target.step.name, f"{arrival.time:.6g} s"
    claimed = arrival.missed_by
    if not asks_passing(target.step):
        return [] if claimed is None else [Finding(Code.BLEND, f"{name} is said to be missed, and may not be")]
    if claimed is None:
        return [Finding(Code.BLEND, f"it is not said by how much {name} is missed", where=where)]
    findings = []
    t = np.array([arrival.time])
    k = int(line.place(t)[0][0])
    tau = float(line.length[k]) / 2
    v1, v2 = line.control[1][k, :, 0], line.control[1][k, :, -1]
    miss = tau * (v2 - v1) / 4
    if _accelerates(scene, line)[k]:
        off = abs(arrival.time - float(line.time[k]) - tau)
        if not off <= TIME_S:
            findings.append(Finding(Code.BLEND, f"{name} is not due in the middle of its blend", off, "s", where))
    q = line.state(t)[0][0]
    tcp, robot = scene.tool.tcp, scene.robot
    still = np.zeros((2, len(q)))
    both = robot.link_motion(robot.links.index("flange"), np.stack([q - miss, q]), still, still, still).at(tcp)
    goal = target.motion(scene, t)
    off = float(np.sqrt(((both.p[0] - goal.p[0]) ** 2).sum()))
    if not off <= MEET_M:
        findings.append(Finding(Code.BLEND, f"what is blended past is not {name}", off, "m", where))
    off = abs(float(wrapped(both.yaw[:1] - goal.yaw)[0])) if target.turns else 0.0
    if not off <= MEET_RAD:
        findings.append(Finding(Code.BLEND, f"what is blended past is turned against {name}", off, "rad", where))
    findings += tilted(scene, (q - miss)[None], arrival, target)
    off = float(np.abs(np.array(claimed.joints) - miss).max())
    if not off <= MISSED:
        findings.append(Finding(Code.BLEND, f"a joint misses {name} by another amount", off, "rad or m", where))
    off = abs(claimed.distance_m - float(np.sqrt(((both.p[1] - goal.p[0]) ** 2).sum())))
    if not off <= MEET_M:
        findings.append(Finding(Code.BLEND, f"the tool misses {name} by another distance", off, "m", where))
    return findings
