"""Where the joints of an arm must be for its flange to be at a place that is known within a span.

The inverse kinematics of the checker, in closed form and on spans.

A planar arm of two links of lengths a and b that reaches a point at the distance D has, by the law of cosines,

    cos β = (D² - a² - b²) / (2ab)      the angle β between its links, 0 where it is stretched
    cos α = (D² + a² - b²) / (2aD)      the angle α between its first link and the point

and D is not below |a - b| nor above a + b. All arms are made of such limbs, or have a ram. A mode is a choice of signs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from assur.planner.checker.refusals.spans import ANY, Span, arc_cosine, direction, length, pick, sine
from assur.planner.checker.statement.arms import Limb, limbs
from assur.planner.robots.robot import Robot
from assur.planner.robots.tilting import TiltingArm

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
    own, base = limbs(robot, mode), robot.base
    local = Goal(goal.x - base.x, goal.y - base.y, goal.z - base.z, goal.yaw - base.yaw, goal.pitch, goal.roll)
    if isinstance(robot, TiltingArm):
        return _upright(robot, own, local, back=mode.startswith("back"))
    return _level(robot, own, local)


def reaches_by_joint(robot: Robot) -> bool:
    """Whether an arm is out of reach exactly where a joint is beyond its range: its ram."""
    return not limbs(robot, robot.modes[0])


def beyond_every_pitch(robot: Robot, x: float, y: float, z: float) -> float | None:
    """By how much, m, a hand reaches a point of the world at no pitch (less than 0: at some); None: the arm has no
    hand. Its wrist is as far from the point as the hand is long, so the point is from |d - hand| to d + hand away from
    the shoulder, d being a distance that the two links reach."""
    for limb in limbs(robot, robot.modes[0]):
        if limb.hand > 0.0 and isinstance(robot, TiltingArm):
            away = math.dist((x, y, z), (robot.base.x, robot.base.y, robot.base.z + robot.height))
            least, most = abs(limb.first - limb.second), limb.first + limb.second
            return max(abs(away - limb.hand) - most, least - away - limb.hand)
    return None


def _to(limb: Limb, x: Span, y: Span) -> tuple[Span, Span, Span]:
    """A limb to a point of its plane: by how much it is out of reach, the direction of its first link, and the angle of
    its second link from that, which is known better than the difference of both directions."""
    a, b, distance = limb.first, limb.second, length(x, y)
    away = distance.squared()
    bend = arc_cosine((away - (a * a + b * b)) / (2.0 * a * b))
    turn = (away + (a * a - b * b)) / (distance * (2.0 * a))
    first = arc_cosine(turn) if math.isfinite(turn.low) and math.isfinite(turn.high) else Span(0.0, math.pi)
    short = pick(max, distance - (a + b), -distance + abs(a - b))
    return short, direction(x, y) + first * limb.turn, bend * -limb.turn


def _level(robot: Robot, own: list[Limb], goal: Goal) -> Posture:
    """The posture of an arm whose limbs, one or two, are horizontal."""
    c, s = math.cos(robot.base.yaw), math.sin(robot.base.yaw)
    x, y = goal.x * c + goal.y * s, goal.x * -s + goal.y * c
    short, cranks, bends = zip(*(_to(limb, x, y - limb.across) for limb in own), strict=True)
    couplers = [crank + bend for crank, bend in zip(cranks, bends, strict=True)]
    joints = (cranks[0], *(cranks[1:] or bends), goal.z, goal.yaw - couplers[0])
    return Posture(
        pick(max, *short),
        goal.z if robot.lift is None else AT,
        joints[: len(robot.joints)],
        pick(min, *(abs(sine(bend)) for bend in bends)),
        sine(couplers[1] - couplers[0]) * own[0].front if len(own) > 1 else None,
    )


def _upright(robot: TiltingArm, own: list[Limb], goal: Goal, *, back: bool) -> Posture:
    """The posture of an arm whose limb, or ram, is in a vertical plane through the base's axis."""
    radius, height = length(goal.x, goal.y), goal.z - robot.height
    heading, out = direction(goal.x, goal.y) - robot.base.yaw, radius
    if back:
        heading, out = heading + math.pi, -radius
    for limb in own:
        if limb.hand > 0.0:
            out, height = out - sine(goal.pitch + math.pi / 2) * limb.hand, height - sine(goal.pitch) * limb.hand
        short, first, second = _to(limb, out, height)
        joints = (heading, first, second, goal.pitch - (first + second), goal.roll)[: len(robot.joints)]
        aligned = radius / (limb.first + limb.second + limb.hand)
        return Posture(short, AT, joints, pick(min, abs(sine(second)), aligned))
    low, high, ram = float(robot.limits.lower[2]), float(robot.limits.upper[2]), length(out, height)
    short, margin = pick(max, ram - high, -ram + low), pick(min, ram / high, radius / high, Span(1.0, 1.0))
    return Posture(short, AT, (heading, direction(out, height), ram), margin)
