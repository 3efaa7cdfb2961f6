"""Whether the tool stays with its control point, or on the vertical above it, over the whole of a glued leg.

Between two instants a and b, h apart, every coordinate of the difference e of tool and control point leaves its chord
by at most M h²/8 with M ≥ |ë| (equation V2), and M is the sum of the bounds of both accelerations. Intervals are cut
until that decides.
"""

from __future__ import annotations

import math

import numpy as np

from assur.planner.arrays import FloatArray, IntArray
from assur.planner.checker.meeting import tool_motion
from assur.planner.checker.ranges import Ranges
from assur.planner.checker.settle import settle
from assur.planner.checker.targets import Target
from assur.planner.checker.tilt import has_tilt, tilt, tilt_accelerations, turned_by, wrapped
from assur.planner.checker.verdict import Code, Finding
from assur.planner.model.outcome import GLUED, Leg, LegKind
from assur.planner.model.scene import Pick, Place, Scene
from assur.planner.robots.protocol import Sweep

GLUE_M = 1e-5
"""m. In approach, follow and depart the tool stays within this of its line or point: what the design promises; a
planner keeps 1 µm between knots."""
GLUE_RAD = 1e-4
"""rad. The same for yaw: it moves the rim of a part of 200 mm by as much as `GLUE_M`."""
COARSEST_S = 0.005
"""Length of the intervals to begin with, s: at 5 m/s² the remainder is then 16 µm, and a cut later 1 µm."""
YAW_ARM_M = 1e6
"""A point this far from the flange's axis moves and accelerates along any horizontal line, at some yaw, by as much as
the flange turns, times this; so bounds for it, divided by it, are bounds of the yaw's rates."""
WHAT = ("leaves its line or point", "goes below its point", "goes higher than asked", "is turned", "tilts or rolls")


def glued(scene: Scene, ranges: Ranges, legs: tuple[Leg, ...], found: tuple[Target, ...]) -> list[Finding]:
    """Findings for the glued legs that leave their point, their line, or do not go as high as asked."""
    follows = [leg for leg in legs if leg.kind in GLUED]
    followers = _Followers(scene, ranges, follows, [found[leg.step] for leg in follows])
    findings = []
    for excess in settle([np.array([leg.t0, leg.t1]) for leg in follows], COARSEST_S, followers.judge):
        unit = "rad" if excess.column >= 3 else "m"
        what = f"the tool {WHAT[excess.column]} in {followers.told(excess.of)}"
        if not excess.decided:
            what += " (or could not be shown not to)"
        findings.append(Finding(Code.GLUE, what, excess.amount, unit, f"{excess.time:.6g} s"))
    for i, leg in enumerate(follows):
        if leg.kind is not LegKind.FOLLOW:
            outer = leg.t0 if leg.kind is LegKind.APPROACH else leg.t1
            missing = followers.height[i] - float(followers.error(np.array([i]), np.array([outer]))[0][0, 2])
            if not missing <= GLUE_M:
                what = f"{followers.told(i)} is shorter than asked"
                findings.append(Finding(Code.GLUE, what, missing, "m", f"{outer:.6g} s"))
    return findings


class _Followers:
    """The difference of the tool from the control points that it follows in glued legs."""

    def __init__(self, scene: Scene, ranges: Ranges, legs: list[Leg], targets: list[Target]) -> None:
        self.scene, self.ranges, self.legs, self.targets = scene, ranges, legs, targets
        self.following = np.array([leg.kind is LegKind.FOLLOW for leg in legs], dtype=bool)
        self.height = np.array([_height(leg, target) for leg, target in zip(legs, targets, strict=True)])
        self.turns = np.array([target.turns for target in targets], dtype=bool)
        self.tilts = np.array([target.tilt or (0.0, 0.0) for target in targets])
        self.tilting = has_tilt(scene.robot)

    def told(self, i: int) -> str:
        return f"{self.legs[i].kind} of {self.targets[i].step.name}"

    def error(self, of: IntArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Tool less control point of legs (T,) at times t (T,): (T, 3) m and (T,) rad."""
        tool = tool_motion(self.scene, self.ranges.spline, t)
        e, turned = tool.p.copy(), tool.yaw.copy()
        for i in np.unique(of):
            rows = np.flatnonzero(of == i)
            goal = self.targets[i].motion(self.scene, t[rows])
            e[rows] -= goal.p
            turned[rows] -= goal.yaw
        return e, np.where(self.turns[of], wrapped(turned), 0.0)

    def tilted(self, of: IntArray, t: FloatArray) -> FloatArray:
        """Greater of the angles (T,) by which pitch and roll are off those of the point, rad."""
        return turned_by(tilt(self.scene.robot, self.ranges.spline.state(t)[0]), self.tilts[of])

    def judge(self, of: IntArray, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Excess of distance, of depth, of height, of yaw, and of pitch and roll over what is allowed (`settle`)."""
        both = np.tile(of, 2)
        e, yaw = self.error(both, np.concatenate([a, b]))
        off = np.sqrt(e[:, 0] ** 2 + e[:, 1] ** 2 + self.following[both] * e[:, 2] ** 2) - GLUE_M
        high = e[:, 2] - self.height[both] - GLUE_M
        columns = [off, -e[:, 2] - GLUE_M, high, np.abs(yaw) - GLUE_RAD]
        m = self.accelerations(of, a, b)
        across = np.sqrt(m[:, 0] ** 2 + m[:, 1] ** 2 + self.following[of] * m[:, 2] ** 2)
        bends = [across, m[:, 2], m[:, 2], m[:, 3]]
        if self.tilting:
            columns.append(self.tilted(both, np.concatenate([a, b])) - GLUE_RAD)
            bends.append(tilt_accelerations(self.scene.robot, self.ranges.sweep(a, b)))
        taken, bent = np.stack(columns, -1), np.stack(bends, -1)
        taken = np.maximum(taken[: len(a)], taken[len(a) :])
        return taken + bent * (b - a)[:, None] ** 2 / 8, taken

    def accelerations(self, of: IntArray, a: FloatArray, b: FloatArray) -> FloatArray:
        """Bounds (N, 4) of the size of the second derivatives of x, y, z and yaw of the difference."""
        scene, many, robot = self.scene, len(a), self.scene.robot
        n = np.tile(np.concatenate([np.eye(3), np.eye(3)[:1]]), (many, 1))
        tcp = scene.tool.tcp
        reach, distance = math.hypot(tcp.x, tcp.y), math.hypot(tcp.x, tcp.y, tcp.z)
        swept = self.ranges.sweep(a, b)
        each = Sweep(*(np.repeat(column, 4, axis=0) for column in (swept.lower, swept.upper, swept.rate, swept.rate_d)))
        flange = np.full(4 * many, robot.links.index("flange"))
        arms, distances = (np.tile([arm, arm, arm, YAW_ARM_M], many) for arm in (reach, distance))
        total = np.array(robot.point_bounds(flange, arms, distances, n, each)[1]).reshape(many, 4)
        total[:, 3] /= YAW_ARM_M
        for i in np.unique(of):
            rows, target = np.flatnonzero(of == i), self.targets[i]
            axes = np.tile(np.eye(3), (len(rows), 1))
            law = scene.frames[target.frame].law.bounds(np.repeat(a[rows], 3), np.repeat(b[rows], 3), axes)
            arm = math.hypot(target.tool.x, target.tool.y) * np.hypot(axes[:, 0], axes[:, 1])
            goal = law.acceleration + arm * np.hypot(law.yaw_acceleration, law.yaw_rate**2)
            total[rows, :3] += goal.reshape(-1, 3)
            total[rows, 3] = total[rows, 3] + law.yaw_acceleration[::3] if target.turns else 0.0
        return total


def _height(leg: Leg, target: Target) -> float:
    """How far above its point a leg begins or ends, m."""
    if not isinstance(target.step, Pick | Place) or leg.kind is LegKind.FOLLOW:
        return 0.0
    return target.step.approach_m if leg.kind is LegKind.APPROACH else target.step.depart_m
