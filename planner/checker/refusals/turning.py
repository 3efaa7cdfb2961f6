"""Yaws of the tool that are forbidden, and those to which it could only turn through a range that is."""

from __future__ import annotations

import math

from assur.planner.checker.refusals.spans import Span, beyond
from assur.planner.checker.refusals.standing import yaw_at
from assur.planner.checker.refusals.stated import Shown
from assur.planner.checker.statement.arms import limbs
from assur.planner.model.forbidden_yaw import YawRange, slack_of
from assur.planner.model.proofs.witness import PROVED_RAD
from assur.planner.model.refusal import ForbiddenYaw, Quantity, Reason
from assur.planner.model.scene import Scene

MOST_TURNS = 64
"""Full turns, either way, by which a yaw that is stated may differ."""


def forbidden(scene: Scene, yaw: float, mode: str | None = None) -> list[Shown]:
    """The ranges that a yaw of the tool, rad, is in by more than a plan may be off it, with how deep it is in each, the
    deepest first."""
    slack = slack_of(scene.execution.lag)
    inside = [(depth, each) for each in scene.forbidden_yaw if (depth := each.depth(yaw, slack)) > PROVED_RAD]
    inside.sort(key=lambda found: -found[0])
    return [_in_range(scene, each, depth, yaw, mode, way=False) for depth, each in inside]


def unreachable(scene: Scene, yaw: float, joints: tuple[Span, ...], mode: str) -> list[Shown]:
    """Whether the tool of an arm with one limb would have to turn through a forbidden range to a yaw, rad, with joints
    within spans: by how much less it would have to be turned, for each full turn that may be stated, nearest first; or
    nothing."""
    room = _room(scene)
    if room is None or not _beyond_room(scene, room, yaw, joints):
        return []
    turned = (yaw + math.tau * k for k in range(-MOST_TURNS, MOST_TURNS + 1))
    over = sorted(by for by in (max(room.low - each, each - room.high) for each in turned) if by > 0.0)
    return [_in_range(scene, each, by, yaw, mode, way=True) for by in over for each in scene.forbidden_yaw]


def _in_range(scene: Scene, each: YawRange, by: float, yaw: float, mode: str | None, *, way: bool) -> Shown:
    facts = ForbiddenYaw(
        first_rad=each.first,
        last_rad=each.last,
        yaw_rad=yaw if way else each.beside(yaw),
        lag_rad=slack_of(scene.execution.lag),
        on_the_way=way,
        mode=mode,
    )
    return Shown(Reason.FORBIDDEN_YAW, facts, Quantity(by, "rad"), within=PROVED_RAD)


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
                if not beyond(last, lower[3], upper[3], turns=False) > PROVED_RAD:
                    return False
    return True


def _turns(span: Span, low: float, high: float) -> list[Span]:
    """A span with all full turns with which it may be in a range; all numbers if nothing is known of it."""
    if not (math.isfinite(span.low) and math.isfinite(span.high)):
        return [span]
    first = math.ceil((low - PROVED_RAD - span.high) / math.tau)
    last = math.floor((high + PROVED_RAD - span.low) / math.tau)
    return [Span(span.low + math.tau * k, span.high + math.tau * k) for k in range(first, last + 1)]
