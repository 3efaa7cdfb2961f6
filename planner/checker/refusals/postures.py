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
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.spans import ANY, Span, arc_cosine, direction, length, pick, sine, span_beyond
from assur.planner.checker.refusals.stated import Proof
from assur.planner.checker.statement import arms, laws
from assur.planner.checker.statement.arms import Limb, limbs
from assur.planner.checker.statement.joints import mode_at
from assur.planner.frames.motion import Pose
from assur.planner.model.forbidden_yaw import YawRange, slack_of
from assur.planner.model.refusal import ForbiddenYaw, Quantity, Reason
from assur.planner.model.scene import Scene
from assur.planner.model.witness import PROVED_RAD
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
    """What a goal requires of an arm in one mode. `short`: by how much, m, it is out of reach (below 0: it is not);
    `level`: how far, m, it is above the height at which an arm without a lift has its flange; `joints`: their values,
    rad or m, revolute ones up to full turns; `margin`, `parallel`: serial and parallel margin (None: the arm has
    none)."""

    short: Span
    level: Span
    joints: tuple[Span, ...]
    margin: Span
    parallel: Span | None = None


def posture_in_mode(robot: Robot, mode: str, goal: Goal) -> Posture:
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


# Where an arm is at some joint values, and where frames are: by the formulas of the statement checker.


class PlacedLink(NamedTuple):
    """Where a link is in the world: its origin (3,), m, its rotation (3, 3), and yaw (full turns of the joints
    counted), pitch and roll, rad."""

    place: FloatArray
    rotation: FloatArray
    angles: tuple[float, float, float]


def links_at(scene: Scene, q: FloatArray) -> list[PlacedLink]:
    """The links of the arm at joint values q (n,), in the order of the robot's."""
    links, axes = arms.textbook(scene.robot, q.tolist()), np.eye(3).tolist()
    turned = [np.transpose([arms.rotated(own, axis) for axis in axes]) for _, own in links]
    return [PlacedLink(np.array(p), r, own) for (p, own), r in zip(links, turned, strict=True)]


def flange_at(scene: Scene, q: FloatArray) -> PlacedLink:
    """The flange of the arm at joint values q (n,)."""
    return links_at(scene, q)[scene.robot.links.index("flange")]


def yaw_at(scene: Scene, q: FloatArray) -> float:
    """The yaw of the tool point in the world at joint values q (n,), rad."""
    return flange_at(scene, q).angles[0] + scene.tool.tcp.yaw


def frame_at(scene: Scene, name: str, time: float) -> Pose | None:
    """Where a frame is at a time; None: its motion is not known then."""
    law = scene.frames[name].law
    first, last = laws.known(law)
    if not first <= time <= last:
        return None
    link = laws.link_of(law)
    return Pose(*(laws.place_at(law, time) if link is None else arms.place_at(*link, time)))


def still(scene: Scene, name: str) -> Pose | None:
    """Where a frame is that never moves; None: it may move."""
    return frame_at(scene, name, scene.start.time) if laws.stands(scene.frames[name].law) else None


def allowed_mode_names(scene: Scene) -> tuple[str, ...]:
    """Names of the working modes that the request allows: where the arm has to keep its own, that of the start."""
    robot, elbow = scene.robot, scene.options.elbow
    mode = mode_at(robot, scene.start.q) if elbow == "keep" else elbow
    return (mode,) if mode in robot.modes else tuple(robot.modes)


# Yaws of the tool that are forbidden, and those to which it could only turn through a range that is.

MOST_TURNS = 64
"""Full turns, either way, by which a yaw that is stated may differ."""


def forbidden(scene: Scene, yaw: float, mode: str | None = None) -> list[Proof]:
    """The ranges that a yaw of the tool, rad, is in by more than a plan may be off it, with how deep it is in each, the
    deepest first."""
    slack = slack_of(scene.execution.lag)
    inside = [(depth, each) for each in scene.forbidden_yaw if (depth := each.depth(yaw, slack)) > PROVED_RAD]
    inside.sort(key=lambda found: -found[0])
    return [_in_range(scene, each, depth, yaw, mode, way=False) for depth, each in inside]


def unreachable(scene: Scene, yaw: float, joints: tuple[Span, ...], mode: str) -> list[Proof]:
    """Whether the tool of an arm with one limb would have to turn through a forbidden range to a yaw, rad, with joints
    within spans: by how much less it would have to be turned, for each full turn that may be stated, nearest first; or
    nothing."""
    room = _room(scene)
    if room is None or not _beyond_room(scene, room, yaw, joints):
        return []
    turned = (yaw + math.tau * k for k in range(-MOST_TURNS, MOST_TURNS + 1))
    over = sorted(by for by in (max(room.low - each, each - room.high) for each in turned) if by > 0.0)
    return [_in_range(scene, each, by, yaw, mode, way=True) for by in over for each in scene.forbidden_yaw]


def _in_range(scene: Scene, each: YawRange, by: float, yaw: float, mode: str | None, *, way: bool) -> Proof:
    facts = ForbiddenYaw(
        first_rad=each.first,
        last_rad=each.last,
        yaw_rad=yaw if way else each.beside(yaw),
        lag_rad=slack_of(scene.execution.lag),
        on_the_way=way,
        mode=mode,
    )
    return Proof(Reason.FORBIDDEN_YAW, facts, Quantity(by, "rad"), within=PROVED_RAD)


def _room(scene: Scene) -> Span | None:
    """Between which yaws, full turns counted as the sum of its joints has them, the tool of an arm with one limb
    stays for ever; None: it is in a range at the start, or the yaw of the arm is no such sum."""
    if not scene.robot.turns_load or len(limbs(scene.robot, scene.robot.modes[0])) != 1:
        return None
    own, slack, room = yaw_at(scene, scene.start.q), slack_of(scene.execution.lag), Span(-math.inf, math.inf)
    for each in scene.forbidden_yaw:
        if each.depth(own, slack) >= 0.0:
            return None
        begin = own - (own - each.first) % math.tau
        room = Span(max(room.low, begin + each.width + slack), min(room.high, begin + math.tau - slack))
    return room


def _beyond_room(scene: Scene, room: Span, yaw: float, joints: tuple[Span, ...]) -> bool:
    """Whether an arm that never leaves the room has no joint position, within its ranges, for a yaw: with θ1 and θ2 in
    each of their turns, θ4 would have to be what is left of the yaw."""
    lower, upper = scene.robot.limits.lower.tolist(), scene.robot.limits.upper.tolist()
    own = scene.robot.base.yaw + scene.tool.tcp.yaw
    first, second = (_turns(span, low, high) for span, low, high in zip(joints[:2], lower, upper, strict=False))
    for k in range(math.floor((room.low - yaw) / math.tau) - 1, math.ceil((room.high - yaw) / math.tau) + 2):
        total = Span(yaw + math.tau * k - PROVED_RAD, yaw + math.tau * k + PROVED_RAD)
        if total.high < room.low or total.low > room.high:
            continue
        for one in first:
            for other in second:
                last = total - (one + other + own)
                if not span_beyond(last, lower[3], upper[3], turns=False) > PROVED_RAD:
                    return False
    return True


def _turns(span: Span, low: float, high: float) -> list[Span]:
    """A span with all full turns with which it may be in a range; all numbers if nothing is known of it."""
    if not (math.isfinite(span.low) and math.isfinite(span.high)):
        return [span]
    first = math.ceil((low - PROVED_RAD - span.high) / math.tau)
    last = math.floor((high + PROVED_RAD - span.low) / math.tau)
    return [Span(span.low + math.tau * k, span.high + math.tau * k) for k in range(first, last + 1)]
