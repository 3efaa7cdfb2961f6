"""Why a control point that stands still cannot be met in one way, one working mode and at one height above it.

What is said here holds for every flange within the tolerances of a plan about the place that is asked (`PROVED_M`,
`PROVED_RAD`), so no plan that the checker accepts can meet the point so.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

from assur.planner.checker.refusals.postures import Posture, posture
from assur.planner.checker.refusals.spans import Span, beyond, minus, plus
from assur.planner.checker.refusals.ways import Way
from assur.planner.frames.motion import Pose
from assur.planner.model.forbidden_yaw import slack_of
from assur.planner.model.proofs.witness import (
    PROVED_M,
    PROVED_RAD,
    PROVED_SHARE,
    PROVED_TRACKED_M,
    Hindrance,
)
from assur.planner.model.refusal import Reason, Unit
from assur.planner.model.scene import Scene
from assur.planner.robots.polar_arm import PolarArm

Make = Callable[..., Hindrance]
"""Makes the hindrance of one way, mode and height of its reason, amount, unit and joint."""


def hindrances(scene: Scene, way: Way, mode: str, above: float) -> Iterator[Hindrance]:
    """Everything that prevents the arm from meeting the point of a way that stands still; nothing: perhaps it can."""
    at = way.still(scene)
    if at is None:
        return
    robot = scene.robot
    near = PROVED_TRACKED_M if above > 0.0 else PROVED_M
    exact = posture(robot, mode, way.goal(scene, at, above, 0.0, 0.0))
    wide = posture(robot, mode, way.goal(scene, at, above, near, PROVED_RAD))

    def hindrance(reason: Reason, by: float, unit: Unit, joint: str | None = None) -> Hindrance:
        return Hindrance(
            mode=mode, turn_rad=way.turn, above_m=above, reason=reason, joint=joint, by=max(by, 0.0), unit=unit
        )

    if wide.level.low > 0.0 or wide.level.high < 0.0:
        yield hindrance(Reason.OUT_OF_REACH, abs(exact.level.middle), "m")
    # a polar arm is out of reach where its ram is beyond its range
    if wide.short.low > 0.0 and not isinstance(robot, PolarArm):
        yield hindrance(Reason.OUT_OF_REACH, exact.short.low, "m")
        return
    if scene.options.vias_missed and way_is_via(scene, way):
        return  # its joints are missed; that there are none is all that can be said
    limits = robot.limits
    for k, joint in enumerate(robot.joints):
        low, high = float(limits.lower[k]), float(limits.upper[k])
        turns, least = joint.kind == "revolute", PROVED_SHARE * (high - low)
        if beyond(wide.joints[k], low, high, turns=turns) > least:
            by = beyond(Span(exact.joints[k].middle, exact.joints[k].middle), low, high, turns=turns)
            yield hindrance(Reason.JOINT_LIMIT, by, "rad" if turns else "m", joint.name)
    yield from _singular(scene, way, exact, wide, hindrance)
    yield from _yaw(scene, way, at, wide, hindrance)


def way_is_via(scene: Scene, way: Way) -> bool:
    """Whether the point is passed, not stopped at."""
    return scene.task[way.number].via


def _singular(scene: Scene, way: Way, exact: Posture, wide: Posture, hindrance: Make) -> Iterator[Hindrance]:
    """The margins that a meeting must leave: those that are asked where the tool tracks the point, and that to a type 2
    singularity everywhere."""
    asked = scene.options.singularity_margin if scene.task[way.number].tracks else 0.0
    for reason, need, one, other in (
        (Reason.NEAR_SINGULARITY, asked, exact.margin, wide.margin),
        (Reason.NEAR_PARALLEL_SINGULARITY, max(asked, scene.robot.parallel_least), exact.parallel, wide.parallel),
    ):
        if one is not None and other is not None and other.high < need * (1.0 - PROVED_SHARE):
            yield hindrance(reason, need - one.middle, "1")


def _yaw(scene: Scene, way: Way, at: Pose, wide: Posture, hindrance: Make) -> Iterator[Hindrance]:
    """A forbidden range of yaw in which the tool would be, or through which it would have to turn."""
    if not scene.forbidden_yaw or way.turn is None or not scene.robot.turns_load:
        return
    slack, yaw = slack_of(scene.execution.lag), at.then(way.flange).yaw + scene.tool.tcp.yaw
    depths = [each.depth(yaw, slack) for each in scene.forbidden_yaw]
    if max(depths) > PROVED_RAD:
        yield hindrance(Reason.FORBIDDEN_YAW, max(depths), "rad")
        return
    room = room_at_start(scene)
    if room is None:
        return
    over = beyond_room(scene, room, yaw, wide)
    if over:
        # by how much less the nearest yaw would have to be turned
        yaws = [yaw + math.tau * k for k in range(-4, 5)]
        by = min(max(room.low - y, y - room.high) for y in yaws if max(room.low - y, y - room.high) > 0.0)
        yield hindrance(Reason.FORBIDDEN_YAW, by, "rad")


def room_at_start(scene: Scene) -> Span | None:
    """Between which yaws, full turns counted as the sum of its joints has them, the tool of a SCARA stays for ever;
    None: it is in a range at the start, or the arm is no SCARA."""
    if scene.robot.facts[0] != "scara" or len(scene.robot.joints) != 4:
        return None
    q, slack = scene.start.q, slack_of(scene.execution.lag)
    own = float(q[0] + q[1] + q[3]) + scene.robot.base.yaw + scene.tool.tcp.yaw
    low, high = -math.inf, math.inf
    for each in scene.forbidden_yaw:
        if each.depth(own, slack) >= 0.0:
            return None
        behind = (own - each.first) % math.tau
        low = max(low, own - behind + each.width + slack)
        high = min(high, own - behind + math.tau - slack)
    return Span(low, high)


def beyond_room(scene: Scene, room: Span, yaw: float, wide: Posture) -> bool:
    """Whether a SCARA that never leaves the room has no joint position, within its ranges, for a yaw: with θ1 and θ2 in
    each of their turns, θ4 would have to be what is left of the yaw."""
    robot = scene.robot
    lower, upper = robot.limits.lower, robot.limits.upper
    first, second, _, _ = wide.joints
    own = robot.base.yaw + scene.tool.tcp.yaw
    sides = [_turned(span, float(lower[k]), float(upper[k])) for k, span in enumerate((first, second))]
    if any(side is None for side in sides):
        return False
    count = 1 + math.ceil((room.high - room.low) / math.tau)
    begin = math.floor((room.low - yaw) / math.tau) - 1
    for k in range(begin, begin + count + 3):
        total = Span(yaw + math.tau * k - PROVED_RAD, yaw + math.tau * k + PROVED_RAD)
        if total.high < room.low or total.low > room.high:
            continue
        for one in sides[0] or ():
            for other in sides[1] or ():
                last = minus(total, plus(one, other, Span(own, own)))
                if not beyond(last, float(lower[3]), float(upper[3]), turns=False) > PROVED_RAD:
                    return False
    return True


def _turned(span: Span, low: float, high: float) -> list[Span] | None:
    """A span with all full turns with which it may be in a range; None: nothing is known of it."""
    if not (math.isfinite(span.low) and math.isfinite(span.high)):
        return None
    first = math.ceil((low - PROVED_RAD - span.high) / math.tau)
    last = math.floor((high + PROVED_RAD - span.low) / math.tau)
    return [Span(span.low + math.tau * k, span.high + math.tau * k) for k in range(first, last + 1)]
