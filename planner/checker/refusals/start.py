"""What is wrong at the start: a joint beyond a limit, an open chain, a law that is over, a load, a yaw."""

from __future__ import annotations

import math

import numpy as np

from assur.planner.checker.limits import integrals, part_inertia, share_of, tool_inertia
from assur.planner.checker.refusals.standing import standing
from assur.planner.errors import InputError
from assur.planner.frames.motion import Pose
from assur.planner.model.attachments import at_start
from assur.planner.model.forbidden_yaw import slack_of
from assur.planner.model.phases import yaw_offsets
from assur.planner.model.proofs.witness import PROVED_M, PROVED_RAD, PROVED_S, PROVED_SHARE
from assur.planner.model.refusal import (
    BeyondRange,
    ForbiddenYaw,
    LawEnds,
    MotionLimit,
    Obstacle,
    Overload,
    Refusal,
    Singular,
    finite,
)
from assur.planner.model.scene import Move, Pick, Scene
from assur.planner.robots.five_bar import FiveBar

SAME = 1e-9
"""Two numbers that are off by less than this share of them, or this, are the same: sums of a few terms."""


def same(one: float | None, other: float | None, by: float = SAME) -> bool:
    """Whether two numbers are the same up to rounding; none is the same as none."""
    if one is None or other is None:
        return one is other
    return abs(one - other) <= by * max(1.0, abs(other))


def beyond_range(scene: Scene, refusal: Refusal, facts: BeyondRange) -> str:
    """Why it is not shown that a joint is beyond its range at the start; nothing: it is."""
    k = next((k for k, joint in enumerate(scene.robot.joints) if joint.name == refusal.joint), None)
    if k is None:
        return "the robot has no such joint"
    low, high = float(scene.robot.limits.lower[k]), float(scene.robot.limits.upper[k])
    q = float(scene.start.q[k])
    over = max(low - q, q - high)
    if not over > PROVED_SHARE * (high - low):
        return "the joint is within its range at the start"
    end = low if low - q > q - high else high
    if not (same(amount_of(refusal), over) and same(facts.value, scene.counted(k, q))):
        return "the joint is beyond its range by another amount"
    told = facts == BeyondRange(value=facts.value, limit=facts.limit)
    return "" if told and same(facts.limit, scene.counted(k, end)) else "its range ends elsewhere"


def too_fast(scene: Scene, refusal: Refusal, facts: MotionLimit) -> str:
    """The same of a joint that is faster, or accelerates more, than it may."""
    k = next((k for k, joint in enumerate(scene.robot.joints) if joint.name == refusal.joint), None)
    if k is None or facts.rate not in ("velocity", "acceleration"):
        return "the robot has no such joint, or the start no such rate"
    held = at_start(scene).held
    mass = (scene.tool.mass_kg or 0.0) + (0.0 if held is None else scene.index[held.part].mass_kg or 0.0)
    limits, start = scene.robot.limits, scene.start
    value, limit = abs(float(start.qd[k])), float(limits.velocity[k])
    if facts.rate == "acceleration":
        value, limit = abs(float(start.qdd[k])), share_of(scene, mass) * float(limits.acceleration[k])
    if not value > limit * (1.0 + PROVED_SHARE):
        return "the joint keeps its limit at the start"
    bare = MotionLimit(obstacle=Obstacle.RATE, rate=facts.rate, value=facts.value, limit=facts.limit)
    told = facts == bare and same(facts.value, value) and same(facts.limit, limit)
    told = told and same(amount_of(refusal), value - limit)
    return "" if told else "the joint exceeds its limit by another amount"


def unassembled(scene: Scene, refusal: Refusal, facts: Singular) -> str:
    """The same of a closed chain that is too near a type 2 singularity, or does not close, at the start: with s
    from the left elbow to the right one, |s|² = b_L² + b_R² + 2 b_L b_R cos of the angle between the couplers."""
    robot = scene.robot
    if not isinstance(robot, FiveBar):
        return "the arm has no loop"
    (left, right), (one, other) = robot.proximal, robot.distal
    a, b = float(scene.start.q[0]), float(scene.start.q[1])
    x = right * math.cos(b) - left * math.cos(a)
    y = right * math.sin(b) - left * math.sin(a) - robot.separation
    fold = (x * x + y * y - one * one - other * other) / (2.0 * one * other)
    margin = math.sqrt(1.0 - fold * fold) if abs(fold) <= 1.0 else None
    if not (margin or 0.0) < robot.parallel_least * (1.0 - PROVED_SHARE):
        return "the arm is far enough from the singularity"
    told = facts == Singular(margin=facts.margin, required=facts.required)
    told = told and same(facts.margin, margin, 1e-6) and same(facts.required, robot.parallel_least)
    short = robot.parallel_least - (margin or 0.0)
    return "" if told and same(amount_of(refusal), short, 1e-6) else "its margin is another one"


def law_over(scene: Scene, refusal: Refusal, facts: LawEnds) -> str:
    """The same of the law of a frame that bears a body, which is not known at the start."""
    name, t = refusal.frame, scene.start.time
    if name not in scene.frames or all(body.frame != name for body in scene.bodies):
        return "the frame bears no body"
    low, high = scene.frames[name].law.valid
    if not max(low - t, t - high) > PROVED_S:
        return "the motion of the frame is known at the start"
    told = facts.known_s == (finite(low), finite(high)) and same(facts.needed_s, t) and facts.tracked_s is None
    told = told and not facts.on_arrival and same(amount_of(refusal), max(low - t, t - high))
    return "" if told else "its motion is known at other times"


def turned_into_range(scene: Scene, refusal: Refusal, facts: ForbiddenYaw) -> str:
    """The same of the yaw of the tool at the start."""
    world, t = standing(scene, scene.start.q), scene.start.time
    yaw = world.states([(world.flange, Pose(), t)])[0].yaw + scene.tool.tcp.yaw
    return in_range(scene, refusal, facts, yaw)


def in_range(scene: Scene, refusal: Refusal, facts: ForbiddenYaw, yaw: float) -> str:
    """Why it is not shown that a yaw is in the range that is named; nothing: it is."""
    slack = slack_of(scene.execution.lag)
    named = [
        each for each in scene.forbidden_yaw if same(each.first, facts.first_rad) and same(each.last, facts.last_rad)
    ]
    if not named or facts.on_the_way:
        return "there is no such range"
    depth = named[0].depth(yaw, slack)
    if not depth > PROVED_RAD:
        return "the yaw is not in the range"
    off = abs(math.remainder(facts.yaw_rad - yaw, math.tau))
    told = off <= PROVED_RAD and same(facts.lag_rad, slack) and same(amount_of(refusal), depth, PROVED_RAD)
    told = told and facts.mode is None
    return "" if told else "the yaw is another one, or deeper or less deep in the range"


def overload(scene: Scene, refusal: Refusal, facts: Overload) -> str:
    """Why it is not shown that the robot may not carry a load; nothing: it may not."""
    known, part = scene.load_limits, facts.part
    if part is not None:
        holding = scene.start.holding
        held = refusal.stage == "start" and holding is not None and holding.part == part
        step = scene.task[refusal.step]
        if not held and not (isinstance(step, Pick) and step.part == part and refusal.stage != "start"):
            return f"{part} is not taken there"
    if refusal.bodies != (() if part is None else (part,)):
        return "it is about other bodies"
    if facts.of == "max_inertia":
        return _inertia(scene, refusal, facts)
    tool = scene.tool.mass_kg or 0.0
    mass = tool + (0.0 if part is None else scene.index[part].mass_kg or 0.0)
    table = known.shares[-1][0] if known.shares else None
    limit = table if facts.of == "table" else known.max_kg
    if limit is None and facts.of == "max_load" and not known.shares:
        limit = known.rated_kg  # beyond which nothing is known
    if limit is None or not mass > limit * (1.0 + PROVED_SHARE):
        return "the load may be carried"
    told = same(facts.value, mass) and same(facts.limit, limit) and same(facts.tool, tool)
    told = told and same(facts.part_value, mass - tool) and same(amount_of(refusal), mass - limit)
    return "" if told else "the load is another one"


def _inertia(scene: Scene, refusal: Refusal, facts: Overload) -> str:
    """... for its inertia, however the part is turned."""
    most, robot = scene.load_limits.max_inertia_kgm2, scene.robot
    if most is None or not robot.turns_load:
        return "no inertia is limited"
    own = tool_inertia(scene)
    low, high = own, own
    if facts.part is not None:
        parts = _part_inertias(scene, refusal, facts.part)
        low, high = own + min(parts), own + max(parts)
    if not low > most * (1.0 + PROVED_SHARE):
        return "the load may be carried, at least if its part is turned"
    told = low - SAME <= facts.value <= high + SAME and same(facts.limit, most) and same(facts.tool, own)
    told = told and same(facts.part_value, facts.value - own) and same(amount_of(refusal), facts.value - most)
    return "" if told else "the inertia is another one"


def _part_inertias(scene: Scene, refusal: Refusal, part: str) -> list[float]:
    """Of a part, kg·m², for each turn in which it may be taken, or the least and the greatest of all."""
    step, tcp = scene.task[refusal.step], scene.tool.tcp
    holding = scene.start.holding
    if refusal.stage == "start" and holding is not None:
        return [part_inertia(scene, part, tcp.then(holding.grasp.inverse()))]
    if not isinstance(step, Pick):
        return [0.0]
    offsets = yaw_offsets(scene, step)
    if offsets is not None:
        turned = (Pose(yaw=turn).then(step.grasp) for turn in offsets)
        return [part_inertia(scene, part, tcp.then(grasp.inverse())) for grasp in turned]
    mass, axis = scene.index[part].mass_kg or 0.0, step.grasp.then(tcp.inverse())
    volume, x, y, square = integrals(scene.index[part].body)
    away, out = math.hypot(axis.x, axis.y), math.hypot(x, y)
    return [mass * (square + sign * 2.0 * away * out + away * away * volume) / volume for sign in (-1.0, 1.0)]


def amount_of(refusal: Refusal) -> float | None:
    """By how much a refusal says that something is missing, or too much."""
    return None if refusal.amount is None else refusal.amount.value


def no_path(scene: Scene, refusal: Refusal) -> str:
    """Why it is not shown that the path of the first step cannot begin where the tool is; nothing: it is."""
    move = scene.task[0]
    if refusal.step != 0 or not isinstance(move, Move) or not move.path:
        return "the first step has no path"
    law = scene.frames[move.target.frame].law
    if law.kind != "fixed":
        return "the frame of the path moves"
    tool = standing(scene, scene.start.q).tool(scene.start.time)
    at = law.numbers.pose.inverse().then(Pose(tool.x, tool.y, tool.z))
    near = np.array([[0.0, 0.0, 0.0], *(PROVED_M * np.eye(3)), *(-PROVED_M * np.eye(3))])
    for x, y, z in near.tolist():
        try:
            move.path_from((at.x + x, at.y + y, at.z + z)).curve  # noqa: B018 - what is wrong is found when it is made
        except InputError:
            continue
        return "the path can begin there"
    return ""
