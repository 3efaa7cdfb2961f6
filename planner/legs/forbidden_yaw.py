"""Whether the tool turns into a forbidden range of yaw: where a point is met, and over the whole of a motion.

The yaw of a SCARA is base + θ1 + θ2 + θ4 + tool, a polynomial on each piece, whose extremes are exact; it may not leave
the room between two ranges in which it is at the start (`Room`). The yaw of a five-bar is no polynomial: with e the
direction of its tool, m the middle of a range and w half its width,

    e·m <= max at both ends of an interval of length h + M h²/8 < cos w,   M >= |ë|                          (Y1)

and intervals are halved until that is so.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.errors import FaultError
from assur.planner.kernels.jets import JET_COLUMNS
from assur.planner.kernels.spline import sweep_joints
from assur.planner.legs.control_point import ControlPoint
from assur.planner.legs.state import Branch
from assur.planner.model.forbidden_yaw import RESERVE_RAD, Room, YawRange, entered, gaps, room, slack_of
from assur.planner.model.refusal import ForbiddenYaw, Quantity, Reason, Refusal, Stage
from assur.planner.model.scene import Scene
from assur.planner.trajectory import Trajectory

INSTANTS = 65
"""Instants at which it is looked for when the yaw is first in a range, to tell it."""
BESIDE_RAD = math.radians(2.0)
"""So far from a range a free yaw is tried: a motion that ends there may turn a little beyond its end."""
SHORTEST_S = 1e-7
"""Intervals are halved no further, s: what is not shown by then is refused."""


def tool_yaw(scene: Scene, q: FloatArray) -> FloatArray:
    """The yaw (...) of the tool point in the world for joints (..., n), rad; of a SCARA full turns count."""
    joints = scene.robot.yaw_joints
    if joints is not None:
        return np.asarray(scene.robot.base.yaw + q[..., joints].sum(-1) + scene.tool.tcp.yaw)
    return np.asarray(scene.robot.forward(q)[1] + scene.tool.tcp.yaw)


def free_yaws_between(scene: Scene) -> list[float]:
    """Yaws of the flange in the world, rad, that are worth a try where ranges leave little: the middle of each gap
    between them, and `BESIDE_RAD` inside both of its ends."""
    found = []
    for edge, width in gaps(scene.forbidden_yaw, _slack(scene)):
        beside = min(BESIDE_RAD, width / 2.0)
        found += [edge + beside, edge + width - beside, edge + width / 2.0]
    return [yaw - scene.tool.tcp.yaw for yaw in dict.fromkeys(found)]


def start_room(scene: Scene) -> Room:
    """The room about the yaw at the start, which no motion of a SCARA can leave; without ends for other arms."""
    if scene.robot.yaw_joints is None:
        return Room()
    return room(scene.forbidden_yaw, float(tool_yaw(scene, scene.start.q)), _slack(scene))


def yaw_refused(
    scene: Scene,
    stage: Stage,
    step: int,
    yaw: float,
    *,
    mode: str | None = None,
    interval: tuple[float, float] | None = None,
) -> Refusal | None:
    """The refusal of a yaw, rad, that is in a forbidden range; None: it is in none."""
    found = entered(scene.forbidden_yaw, yaw, _slack(scene))
    if found is None:
        return None
    return _refusal(scene, stage, step, *found, yaw, mode=mode, interval=interval)


def allowed_branches(scene: Scene, point: ControlPoint, branches: list[Branch]) -> tuple[list[Branch], Refusal | None]:
    """The branches of one mode at the times at which the tool may be there; if none is left, why. A SCARA has to come
    there from its start without a turn through a forbidden range."""
    if not scene.forbidden_yaw or not branches or (scene.options.vias_missed and point.via):
        return branches, None  # a via that is missed says nothing: the whole motion is evaluated
    free, slack = start_room(scene), _slack(scene)
    kept, refusals = list[Branch](), list[Refusal]()
    for branch in branches:
        yaws = tool_yaw(scene, branch.q)
        outside = np.array([entered(scene.forbidden_yaw, yaw, slack) is None for yaw in yaws.tolist()])
        may = outside & (yaws > free.low) & (yaws < free.high)
        if may.all():
            kept.append(branch)
        elif may.any():
            kept.append(replace(branch, table=branch.table[may].copy(), numbers=branch.numbers[may]))
        else:
            refusals.append(_unmet(scene, point, branch, yaws, outside.tolist(), free))
    return kept, None if kept else min(refusals, key=lambda refusal: refusal.missing)


def _unmet(
    scene: Scene, point: ControlPoint, branch: Branch, yaws: FloatArray, outside: list[bool], free: Room
) -> Refusal:
    """Why a branch is met at none of its times: by the first at which the tool would be in no range, if any."""
    mode, span = scene.robot.modes[branch.mode], (float(branch.time[0]), float(branch.time[-1]))
    yaw = float(yaws[outside.index(True) if any(outside) else 0])
    found = yaw_refused(scene, Stage.INVERSE, point.step, yaw, mode=mode, interval=span)
    between = free.below if yaw <= free.low else free.above
    if found is not None:
        return found
    if between is None:
        raise FaultError(f"a yaw of {yaw} rad is in no forbidden range, nor behind one")
    over = max(free.low - yaw, yaw - free.high)
    return _refusal(scene, Stage.INVERSE, point.step, between, over, yaw, mode=mode, interval=span, way=True)


def turns_into(scene: Scene, step: int, trajectory: Trajectory) -> Refusal | None:
    """Why a motion is refused: at some time the tool is in a forbidden range of yaw, or is not shown not to be."""
    if not scene.forbidden_yaw:
        return None
    joints = scene.robot.yaw_joints
    if joints is None:
        return _bounded(scene, step, trajectory)
    parts = (part[:, joints].sum(-1, keepdims=True) for part in (trajectory.q, trajectory.qd, trajectory.qdd))
    turn = scene.robot.base.yaw + scene.tool.tcp.yaw
    yaw = Trajectory(trajectory.time, *parts, jumps=trajectory.jumps)
    low, high = (float(end[0]) + turn for end in yaw.extrema(0))
    free = start_room(scene)
    if free.low < low and high < free.high:
        return None
    over, between = max((free.low - low, 0), (high - free.high, 1))
    into = (free.below, free.above)[between]
    if into is None:
        raise FaultError(f"yaws from {low} to {high} rad leave the room of {free}")
    times = np.linspace(yaw.start, yaw.end, INSTANTS)
    there = yaw.evaluate(times)[:, 0] + turn
    outside = (there <= free.low) | (there >= free.high)
    # between two of these instants: where the yaw is farthest out
    first = int(outside.argmax()) if outside.any() else int(np.argmin(there) if between == 0 else np.argmax(there))
    when = float(times[first])
    end = free.low if between == 0 else free.high
    return _refusal(scene, Stage.LIMITS, step, into, over, end, interval=(when, when), way=True)


def _bounded(scene: Scene, step: int, trajectory: Trajectory) -> Refusal | None:
    """`turns_into` of an arm whose yaw is no sum of joints (Y1)."""
    robot, ranges = scene.robot, scene.forbidden_yaw
    spline, joints = trajectory.spline, np.empty((trajectory.n, JET_COLUMNS))
    flange = len(robot.links) - 1
    middles = np.array([each.middle for each in ranges])
    most = np.cos(np.minimum([each.width / 2.0 + _slack(scene) for each in ranges], math.pi))

    def toward(t: float) -> FloatArray:
        return np.asarray(np.cos(float(tool_yaw(scene, trajectory.evaluate(t))) - middles))

    stack = [(trajectory.start, trajectory.end, toward(trajectory.start), toward(trajectory.end))]
    while stack:
        t0, t1, first, last = stack.pop()
        h = t1 - t0
        sweep_joints(spline, t0, t1, joints)
        nearest = np.maximum(first, last)
        if (nearest + robot.sweep(joints, flange).turning(2) * h * h / 8.0 < most).all():
            continue
        if not (nearest < most).all() or h <= SHORTEST_S:
            number = int(np.argmax(nearest - most))
            t = t0 if first[number] >= last[number] else t1
            yaw = float(tool_yaw(scene, trajectory.evaluate(t)))
            deep = max(ranges[number].depth(yaw, _slack(scene)), 0.0)
            return _refusal(scene, Stage.LIMITS, step, ranges[number], deep, yaw, interval=(t, t), way=True)
        middle = t0 + h / 2.0
        there = toward(middle)
        stack += [(middle, t1, there, last), (t0, middle, first, there)]
    return None


def _slack(scene: Scene) -> float:
    return slack_of(scene.execution.lag) + RESERVE_RAD


def _refusal(
    scene: Scene,
    stage: Stage,
    step: int,
    into: YawRange,
    deep: float,
    yaw: float,
    *,
    mode: str | None = None,
    interval: tuple[float, float] | None = None,
    way: bool = False,
) -> Refusal:
    facts = ForbiddenYaw(
        first_rad=into.first,
        last_rad=into.last,
        yaw_rad=math.remainder(yaw, math.tau) if way else into.beside(yaw),
        lag_rad=slack_of(scene.execution.lag),
        on_the_way=way,
        mode=mode,
    )
    amount = Quantity.of(deep, "rad")
    reason = Reason.FORBIDDEN_YAW
    return Refusal(stage=stage, reason=reason, step=step, interval=interval, amount=amount, facts=facts)
