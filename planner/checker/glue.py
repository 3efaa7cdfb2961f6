"""Whether the tool stays with its control point, or on the vertical above it, over the whole of a glued leg.

Between two instants a and b, h apart, every coordinate of the difference e of tool and control point leaves its chord
by at most M h²/8 with M ≥ |ë| (equation V2), and M is the sum of the bounds of both accelerations. Intervals are cut
until that decides.
"""

from __future__ import annotations

import math

import numpy as np

from planner.arrays import FloatArray
from planner.checker.meeting import tool_motion, wrapped
from planner.checker.ranges import Ranges
from planner.checker.settle import settle
from planner.checker.targets import Target
from planner.checker.verdict import Code, Finding
from planner.outcome import GLUED, Leg, LegKind
from planner.robots.protocol import Sweep
from planner.scene import Pick, Place, Scene

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
WHAT = ("leaves its line or point", "goes below its point", "goes higher than asked", "is turned")


def glued(scene: Scene, ranges: Ranges, legs: tuple[Leg, ...], found: tuple[Target, ...]) -> list[Finding]:
    """Findings for the glued legs that leave their point, their line, or do not go as high as asked."""
    findings = []
    for leg in legs:
        if leg.kind not in GLUED:
            continue
        follower = _Follower(scene, ranges, leg, found[leg.step])
        excess = settle(np.array([leg.t0, leg.t1]), COARSEST_S, follower.judge)
        if excess is not None:
            unit = "rad" if excess.column == 3 else "m"
            what = f"the tool {WHAT[excess.column]} in {leg.kind} of {found[leg.step].step.name}"
            if not excess.decided:
                what += " (or could not be shown not to)"
            findings.append(Finding(Code.GLUE, what, excess.amount, unit, f"{excess.time:.6g} s"))
        if leg.kind is not LegKind.FOLLOW:
            outer = np.array([leg.t0 if leg.kind is LegKind.APPROACH else leg.t1])
            missing = follower.height - float(follower.error(outer)[0][0, 2])
            if not missing <= GLUE_M:
                what = f"{leg.kind} of {found[leg.step].step.name} is shorter than asked"
                findings.append(Finding(Code.GLUE, what, missing, "m", f"{outer[0]:.6g} s"))
    return findings


class _Follower:
    """The difference of the tool from the control point that it follows in one leg."""

    def __init__(self, scene: Scene, ranges: Ranges, leg: Leg, target: Target) -> None:
        self.scene, self.ranges, self.target, self.leg = scene, ranges, target, leg
        self.height = 0.0
        if isinstance(target.step, Pick | Place) and leg.kind is not LegKind.FOLLOW:
            self.height = target.step.approach_m if leg.kind is LegKind.APPROACH else target.step.depart_m

    def error(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Tool less control point at times t (T,): (T, 3) m and (T,) rad."""
        tool, goal = tool_motion(self.scene, self.ranges.spline, t), self.target.motion(self.scene, t)
        turned = wrapped(tool.yaw - goal.yaw) if self.target.turns else np.zeros(len(t))
        return tool.p - goal.p, turned

    def judge(self, a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Excess of distance, of depth, of height and of yaw over what is allowed (see `settle`)."""
        e, yaw = self.error(np.concatenate([a, b]))
        following = self.leg.kind is LegKind.FOLLOW
        off = np.sqrt((e[:, : 3 if following else 2] ** 2).sum(-1)) - GLUE_M
        taken = np.stack([off, -e[:, 2] - GLUE_M, e[:, 2] - self.height - GLUE_M, np.abs(yaw) - GLUE_RAD], -1)
        taken = np.maximum(taken[: len(a)], taken[len(a) :])
        m = self.accelerations(a, b)
        across = np.sqrt((m[:, : 3 if following else 2] ** 2).sum(-1))
        bent = np.stack([across, m[:, 2], m[:, 2], m[:, 3]], -1)
        return taken + bent * (b - a)[:, None] ** 2 / 8, taken

    def accelerations(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Bounds (N, 4) of the size of the second derivatives of x, y, z and yaw of the difference."""
        scene, many, robot = self.scene, len(a), self.scene.robot
        axes = np.concatenate([np.eye(3), np.eye(3)[:1]])
        n = np.tile(axes, (many, 1))
        reach = math.hypot(scene.tool.tcp.x, scene.tool.tcp.y)
        arms = np.tile([reach, reach, reach, YAW_ARM_M], many)
        swept = self.ranges.sweep(a, b)
        each = Sweep(*(np.repeat(column, 4, axis=0) for column in (swept.lower, swept.upper, swept.rate, swept.rate_d)))
        flange = np.full(4 * many, robot.links.index("flange"))
        tool = robot.point_bounds(flange, arms, n, each)[1].reshape(many, 4)
        law = scene.frames[self.target.frame].law.bounds(np.repeat(a, 4), np.repeat(b, 4), n)
        arm = math.hypot(self.target.tool.x, self.target.tool.y) * np.hypot(n[:, 0], n[:, 1])
        goal = (law.acceleration + arm * np.hypot(law.yaw_acceleration, law.yaw_rate**2)).reshape(many, 4)
        turn = tool[:, 3] / YAW_ARM_M + law.yaw_acceleration.reshape(many, 4)[:, 3]
        total = tool + goal
        total[:, 3] = turn if self.target.turns else 0.0
        return np.asarray(total)
