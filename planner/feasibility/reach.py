"""Points where the arm can never be: those that stand still out of reach, or beyond a joint limit, in every allowed
mode; and those on a frame that repeats its motion which stay out of reach for a whole period."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from assur.planner.checker.refusals.standing import allowed_modes
from assur.planner.checker.refusals.stated import Shown
from assur.planner.checker.refusals.ways import ways
from assur.planner.feasibility.hits import point_of
from assur.planner.frames.motion import Motion
from assur.planner.frames.tilted import TiltedMotion
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.paths.tracing import lead_in_begin
from assur.planner.model.joint_range import beyond_at_nearest_turn
from assur.planner.model.refusal import (
    JointName,
    OutOfReach,
    Reason,
    Refusal,
    Stage,
    of_joint,
    out_of_reach,
)
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Code
from assur.planner.robots.turns import beyond_range, equivalents

EDGE_M = 1e-9
"""A point is called out of reach at every pitch, or at all times, from this much on, m: rounding of coordinates of a
few metres, and of times."""
PARTS = 512
"""Parts of a period over each of which the way of a point is bounded."""


def out_of_range(scene: Scene, number: int) -> Refusal | None:
    """Why no joint position meets the control point of a step, or what is required above it, however the part is held;
    None: one does, or nobody knows, for it moves."""
    first, refusal = point_of(scene, ways(scene, number)[0]), None
    if not first.still:
        return _never_near(scene, first)
    for way in ways(scene, number):
        beyond = _in_no_mode(scene, point_of(scene, way))
        if beyond is None:
            return None
        refusal = refusal or beyond
    return refusal


def _in_no_mode(scene: Scene, point: ControlPoint) -> Refusal | None:
    """Why a point is met in no working mode that is allowed; None: it is in one."""
    refusals = []
    for mode in map(scene.robot.modes.index, allowed_modes(scene)):
        heights = dict.fromkeys((0.0, point.approach, point.depart))
        here = [_refused(scene, point, above, mode) for above in heights]
        refused = [refusal for refusal in here if refusal is not None]
        if not refused:
            return None
        # the worst of them: with less, the others would still not be met
        refusals.append(max(refused, key=_amount))
    return min(refusals, key=_amount, default=None)


def _amount(refusal: Refusal) -> float:
    return 0.0 if refusal.amount is None else refusal.amount.value


def _refused(scene: Scene, point: ControlPoint, above: float, mode: int) -> Refusal | None:
    robot = scene.robot
    motion = point.flange(np.array([scene.start.time]), above).at_rest()
    found = robot.inverse(motion, mode, 0)
    if found.code[0] == Code.OUT_OF_REACH:
        return _far(scene, point, motion, mode)
    q = found.q[0]
    limits = robot.limits
    if not np.isfinite(q).all() or len(equivalents(robot, q, limits.lower - limits.slack, limits.upper + limits.slack)):
        return None
    over, lead_in = beyond_range(robot, q), lead_in_begin(point)
    worst = int(np.argmax(over))
    facts = replace(beyond_at_nearest_turn(scene, worst, q), mode=robot.modes[mode], above_m=above, **lead_in)
    amount, joint = of_joint(robot.joints[worst].kind, float(over[worst])), JointName(robot.joints[worst].name)
    return Shown(Reason.JOINT_LIMIT, facts, amount, joint).refusal(Stage.CONTROL_POINT, point.step)


def _far(scene: Scene, point: ControlPoint, motion: Motion, mode: int) -> Refusal:
    """By how much a point is out of reach."""
    robot, target, lead_in = scene.robot, motion.p[0], lead_in_begin(point)
    has = float(target[2]) if "z" in robot.coordinates else float(robot.forward(scene.start.q)[0][2])
    short = abs(float(target[2]) - has)
    if short > EDGE_M:
        facts = OutOfReach(heights_m=(float(target[2]), has), **lead_in)
    else:
        distance = float(np.hypot(target[0] - robot.base.x, target[1] - robot.base.y))
        short = float(np.maximum(-robot.reach_margin(motion, mode)[0], 0.0))
        pitch = float(motion.tilt[0, 0]) if isinstance(motion, TiltedMotion) else None
        facts = OutOfReach(from_axis_m=distance, pitch_rad=pitch, **lead_in)
    return out_of_reach(Stage.CONTROL_POINT, point.step, short_m=short, facts=facts)


def _never_near(scene: Scene, point: ControlPoint) -> Refusal | None:
    """Why an arm with a lift reaches a point on a frame that repeats its motion at no time. In the middle of each part
    of a period the flange is so far out of reach, and in half a part it comes no nearer than its greatest speed across
    takes it (equation F11)."""
    law, robot = scene.frames[point.frame].law, scene.robot
    period = law.cycle_s
    if period is None or robot.lift is None:
        return None
    edges = scene.start.time + period * np.arange(PARTS + 1) / PARTS
    middle = point.flange((edges[:-1] + edges[1:]) / 2)
    short = -np.max([robot.reach_margin(middle, mode) for mode in range(len(robot.modes))], axis=0)
    for i in range(PARTS):
        x, y, _ = law.sweep(edges[i], edges[i + 1]).point(1, point.pose.x, point.pose.y, 0.0)
        short[i] -= math.hypot(x, y) * (edges[i + 1] - edges[i]) / 2
    least = float(short.min())
    if not least > EDGE_M:  # nor where the law is not known for a whole period
        return None
    return out_of_reach(Stage.CONTROL_POINT, point.step, short_m=least, facts=OutOfReach())
