"""Where the joints of an arm must be for its flange to be at a place that is known within a span.

The inverse kinematics of the checker, in closed form and on spans.

A planar arm of two links of lengths a and b that reaches a point at the distance D has, by the law of cosines,

    cos β = (D² - a² - b²) / (2ab)      the angle β between its links, 0 where it is stretched
    cos α = (D² + a² - b²) / (2aD)      the angle α between its first link and the point

and D is not below |a - b| nor above a + b. All five families are made of it. A mode is a choice of signs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from assur.planner.checker.refusals.spans import ANY, Span, arc_cosine, direction, length, pick, sine
from assur.planner.errors import FaultError
from assur.planner.robots.elbow_arm import ElbowArm
from assur.planner.robots.five_axis_arm import FiveAxisArm
from assur.planner.robots.five_bar import FiveBar
from assur.planner.robots.polar_arm import PolarArm
from assur.planner.robots.robot import Robot
from assur.planner.robots.scara import Scara

AT = Span(0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Goal:
    """The flange in the world: its position, m, its yaw, and pitch and roll of a hand, rad; each within a span, every
    number where it is free."""

    x: Span
    y: Span
    z: Span
    yaw: Span = ANY
    pitch: Span = ANY
    roll: Span = ANY


@dataclass(frozen=True, slots=True)
class Posture:
    """What a goal asks of an arm in one working mode. `short`: by how much, m, it is out of reach (below 0: it is not);
    `level`: how far, m, it is above the height at which an arm without a lift has its flange; `joints`: their values,
    rad or m, revolute ones up to full turns; `margin`, `parallel`: serial and parallel margin (None: the arm has
    none)."""

    short: Span
    level: Span
    joints: tuple[Span, ...]
    margin: Span
    parallel: Span | None = None


def posture(robot: Robot, mode: str, goal: Goal) -> Posture:
    """The posture of an arm in the working mode of this name. Raises `FaultError` for an arm that is not known."""
    base = robot.base
    own = Goal(goal.x - base.x, goal.y - base.y, goal.z - base.z, goal.yaw - base.yaw, goal.pitch, goal.roll)
    if isinstance(robot, Scara):
        return _scara(robot, mode, own)
    if isinstance(robot, FiveBar):
        return _five_bar(robot, mode, own)
    if isinstance(robot, ElbowArm | PolarArm):
        return _tilting(robot, mode, own)
    raise FaultError(f"the checker does not know the kinematics of {robot.name}")


def reaches_by_joint(robot: Robot) -> bool:
    """Whether an arm is out of reach exactly where a joint is beyond its range: the ram of a polar arm."""
    return isinstance(robot, PolarArm)


def beyond_every_pitch(robot: Robot, x: float, y: float, z: float) -> float | None:
    """By how much, m, a hand reaches a point of the world at no pitch (less than 0: at some); None: the arm has no
    pitch. Its wrist is l3 from the point, so the point is from |d - l3| to d + l3 away from the shoulder, d being a
    distance that the two links reach."""
    if not isinstance(robot, FiveAxisArm):
        return None
    away = math.dist((x, y, z), (robot.base.x, robot.base.y, robot.base.z + robot.height))
    least, most = abs(robot.l1 - robot.l2), robot.l1 + robot.l2
    return max(abs(away - robot.l3) - most, least - away - robot.l3)


@dataclass(frozen=True, slots=True)
class _Links:
    """Two links to a point: by how much it is out of reach, the angle of the first link from the way to the point, and
    that of the second from the first, both without a sign."""

    short: Span
    first: Span
    second: Span


def _links(a: float, b: float, distance: Span) -> _Links:
    away = distance.squared()
    bend = (away - (a * a + b * b)) / (2.0 * a * b)
    turn = (away + (a * a - b * b)) / (distance * (2.0 * a))
    known = math.isfinite(turn.low) and math.isfinite(turn.high)
    short = pick(max, distance - (a + b), -distance + abs(a - b))
    return _Links(short, arc_cosine(turn) if known else Span(0.0, math.pi), arc_cosine(bend))


def _scara(robot: Scara, mode: str, goal: Goal) -> Posture:
    found = _links(robot.l1, robot.l2, length(goal.x, goal.y))
    side = {"left": -1.0, "right": 1.0}[mode]
    first, second = direction(goal.x, goal.y) - robot.base.yaw - found.first * side, found.second * side
    joints = [first, second, goal.z]
    if robot.axes == 4:
        # θ1 and θ2 are both known up to what is not known of the distance
        joints.append(goal.yaw - (first + second))
    return Posture(found.short, AT, tuple(joints), abs(sine(found.second)))


def _five_bar(robot: FiveBar, mode: str, goal: Goal) -> Posture:
    c, s = math.cos(robot.base.yaw), math.sin(robot.base.yaw)
    x, y = goal.x * c + goal.y * s, goal.x * -s + goal.y * c
    cranks, couplers, found = [], [], []
    for side, word in enumerate(mode.split("-")):
        across = y + robot.separation * (side - 0.5)
        one = _links(robot.proximal[side], robot.distal[side], length(x, across))
        # an elbow to the left has its crank turned counter-clockwise from the way to the tool axis
        turn = 1.0 if word == "left" else -1.0
        cranks.append(direction(x, across) + one.first * turn)
        couplers.append(cranks[-1] - one.second * turn)
        found.append(one)
    joints = [cranks[0], cranks[1], goal.z, goal.yaw - couplers[0]][: robot.axes]
    front = 1.0 if robot.assembly == "front" else -1.0
    return Posture(
        pick(max, *(one.short for one in found)),
        AT if robot.axes > 2 else goal.z,
        tuple(joints),
        pick(min, *(abs(sine(one.second)) for one in found)),
        sine(couplers[1] - couplers[0]) * front,
    )


def _tilting(robot: ElbowArm | PolarArm, mode: str, goal: Goal) -> Posture:
    back = mode.startswith("back")
    radius, height = length(goal.x, goal.y), goal.z - robot.height
    heading = direction(goal.x, goal.y) + ((math.pi if back else 0.0) - robot.base.yaw)
    out, aligned = -radius if back else radius, radius / robot.longest
    if isinstance(robot, FiveAxisArm):
        out, height = out - sine(goal.pitch + math.pi / 2) * robot.l3, height - sine(goal.pitch) * robot.l3
    distance, up = length(out, height), direction(out, height)
    if isinstance(robot, PolarArm):
        low, high = float(robot.limits.lower[2]), float(robot.limits.upper[2])
        short, reach = pick(max, distance - high, -distance + low), distance / robot.longest
        return Posture(short, AT, (heading, up, distance), pick(min, reach, aligned, Span(1.0, 1.0)))
    found = _links(robot.l1, robot.l2, distance)
    side = 1.0 if mode.endswith("up") is not back else -1.0
    first, second = up + found.first * side, found.second * -side
    joints: tuple[Span, ...] = (heading, first, second)
    if isinstance(robot, FiveAxisArm):
        joints = (*joints, goal.pitch - (first + second), goal.roll)
    return Posture(found.short, AT, joints, pick(min, abs(sine(found.second)), aligned))
