"""Whether a control point can be met in no way: because each way is hindered, because bodies are in the way in each, or
because a point that comes again and again is never near enough."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from assur.planner.checker import motion
from assur.planner.checker.refusals.hindrances import hindrances, room_at_start
from assur.planner.checker.refusals.meetings import Judged, at_a_point, at_the_start
from assur.planner.checker.refusals.postures import Goal, posture
from assur.planner.checker.refusals.spans import ANY, Span, around, plus, scaled
from assur.planner.checker.refusals.standing import allowed_modes, standing
from assur.planner.checker.refusals.start import amount_of, in_range, same
from assur.planner.checker.refusals.ways import Way, ways
from assur.planner.checker.world import World
from assur.planner.laws import Law
from assur.planner.model.forbidden_yaw import slack_of
from assur.planner.model.proofs.witness import PROVED_M, PROVED_RAD, Hindered, Hindrance, Meeting, Met, Orbit
from assur.planner.model.refusal import (
    BeyondRange,
    Enclosed,
    Facts,
    ForbiddenYaw,
    OutOfReach,
    Reason,
    Refusal,
    Separation,
    Singular,
)
from assur.planner.model.scene import Scene, Trace
from assur.planner.robots.five_axis_arm import FiveAxisArm

TOLD = 5e-6
"""Amounts that are told may be off by this, m, rad or 1: the square root of what a posture that is nearly stretched
rounds, and what the planner counts ranges of yaw wider."""
MOST_HINDRANCES = 4096
"""If a witness names more things it is not looked at: four modes, dozens of turns, and all joints of each are fewer."""
PARTS, DEEPEST = 64, 12
"""Into so many parts a period is cut, and each is halved so often at most."""


def hindered_of(scene: Scene, number: int) -> Hindered | None:
    """A hindrance for each way and mode in which a control point might be met; None: there may be a way."""
    found = list[Hindrance]()
    allowed = allowed_modes(scene)
    for way in ways(scene, number):
        for mode in allowed:
            every = [each for above in heights(scene, way) for each in hindrances(scene, way, mode, above)]
            if not every:
                return None
            found += every
    return Hindered(ways=tuple(dict.fromkeys(found)))


def heights(scene: Scene, way: Way) -> tuple[float, ...]:
    """How far above a point, m, the arm must be as well as at it."""
    return tuple(dict.fromkeys((0.0, *scene.straight(scene.task[way.number]))))


def hindered(scene: Scene, refusal: Refusal, witness: Hindered) -> str:
    """Why it is not shown that each way to a control point is hindered; nothing: it is."""
    shown = list[tuple[Way, Hindrance]]()
    if len(witness.ways) > MOST_HINDRANCES:
        return "its witness speaks of more than there is"
    for way in ways(scene, refusal.step):
        for mode in allowed_modes(scene):
            said = [each for each in witness.ways if each.mode == mode and _turn(each.turn_rad, way.turn)]
            held = [each for each in said if _true(scene, way, each)]
            if not held or len(held) < len(said):
                return f"in mode {mode} the point may be met, or not for what the witness says"
            shown += [(way, each) for each in held]
    if {id(each) for each in witness.ways} - {id(each) for _, each in shown}:
        return "the witness speaks of ways that there are not"
    if not any(_tells(scene, refusal, way, each) for way, each in shown):
        return "what the refusal says is none of the hindrances of its witness"
    return ""


def _turn(one: float | None, other: float | None) -> bool:
    return one is other if one is None or other is None else abs(one - other) <= 1e-9


def _true(scene: Scene, way: Way, said: Hindrance) -> bool:
    """Whether a hindrance is one."""
    above = next((height for height in heights(scene, way) if same(height, said.above_m)), None)
    if above is None:
        return False
    return any(
        (own.reason, own.joint, own.unit) == (said.reason, said.joint, said.unit) and same(own.by, said.by, TOLD)
        for own in hindrances(scene, way, said.mode, above)
    )


def _tells(scene: Scene, refusal: Refusal, way: Way, of: Hindrance) -> bool:
    """Whether a refusal tells this hindrance, with the numbers that are its own."""
    facts, robot, amount = refusal.facts, scene.robot, amount_of(refusal)
    if (refusal.reason, refusal.joint) != (of.reason, of.joint) or refusal.bodies or refusal.frame is not None:
        return False
    at = way.still(scene)
    if at is None or not isinstance(facts, OutOfReach | BeyondRange | Singular | ForbiddenYaw):
        return False
    if facts.mode is not None and facts.mode != of.mode:
        return False
    goal = way.goal(scene, at, of.above_m, 0.0, 0.0)
    if isinstance(facts, OutOfReach):
        away = math.hypot(goal.x.middle - robot.base.x, goal.y.middle - robot.base.y)
        z = None if facts.heights_m is None else (goal.z.middle, robot.base.z)
        told = (facts.from_axis_m is None or same(facts.from_axis_m, away)) and facts.modes is None
        told = told and (z is None or all(same(a, b) for a, b in zip(facts.heights_m or (), z, strict=True)))
        told = told and (facts.pitch_rad is None or same(facts.pitch_rad, way.tilt[0])) and not facts.every_pitch
        return told and (amount is None or same(amount, of.by, TOLD)) and _on_path(scene, way, facts)
    if amount is None or not _amount_told(scene, way, facts, of, amount):
        return False
    if isinstance(facts, BeyondRange):
        k = next(k for k, joint in enumerate(robot.joints) if joint.name == of.joint)
        ends = [scene.counted(k, float(end[k])) for end in (robot.limits.lower, robot.limits.upper)]
        told = same(facts.above_m, of.above_m) and facts.arch_top_m is None
        told = told and facts.limit is not None and facts.value is not None and any(same(facts.limit, x) for x in ends)
        return (
            told and same(abs((facts.value or 0.0) - (facts.limit or 0.0)), of.by, TOLD) and _on_path(scene, way, facts)
        )
    if isinstance(facts, Singular):
        need, margin = facts.required, facts.margin
        told = need is not None and margin is not None and same(need - margin, of.by, TOLD)
        return told and facts == Singular(margin=margin, required=need, mode=facts.mode)
    return True


def _amount_told(scene: Scene, way: Way, facts: Facts, of: Hindrance, amount: float) -> bool:
    """Whether the amount of a refusal is that of a hindrance; of a yaw that would have to be turned through a range, by
    how much a yaw with some full turns is beyond the room."""
    if not isinstance(facts, ForbiddenYaw):
        return same(amount, of.by, TOLD)
    at = way.still(scene)
    slack = slack_of(scene.execution.lag)
    ends = [(each.first, each.last) for each in scene.forbidden_yaw]
    if at is None or not any(same(facts.first_rad, a) and same(facts.last_rad, b) for a, b in ends):
        return False
    yaw = at.then(way.flange).yaw + scene.tool.tcp.yaw
    if not (abs(math.remainder(facts.yaw_rad - yaw, math.tau)) <= TOLD and same(facts.lag_rad, slack)):
        return False
    inside = max(each.depth(yaw, slack) for each in scene.forbidden_yaw) > PROVED_RAD
    if inside is facts.on_the_way:
        return False
    if inside:
        return same(amount, of.by, TOLD)
    room = room_at_start(scene)
    turned = [yaw + math.tau * k for k in range(-64, 65)]
    return room is not None and any(same(amount, max(room.low - y, y - room.high), TOLD) for y in turned)


def _on_path(scene: Scene, way: Way, facts: OutOfReach | BeyondRange) -> bool:
    """Whether what is told of a place on a path is so: a trace is met where its lead-in begins."""
    step = scene.task[way.number]
    if not isinstance(step, Trace):
        return facts.path_m is None and facts.path_part is None and facts.path_at_m is None
    if facts.path_at_m is None or facts.path_m is None:
        return True
    here = (way.point.x, way.point.y, way.point.z)
    return same(facts.path_m, -step.lead_in_m) and all(same(a, b) for a, b in zip(facts.path_at_m, here, strict=True))


def every_pitch(scene: Scene, refusal: Refusal) -> str:
    """Why it is not shown that a hand reaches a point at no pitch; nothing: it is. Its wrist is l3 from the point, so
    the point is from |d - l3| to d + l3 away from the shoulder, d being a distance that the two links reach."""
    robot, found = scene.robot, ways(scene, refusal.step)
    at = found[0].still(scene)
    if not isinstance(robot, FiveAxisArm) or at is None:
        return "the arm has no pitch, or the point moves"
    point = at.then(found[0].flange)
    x, y, z = point.x - robot.base.x, point.y - robot.base.y, point.z - robot.base.z - robot.height
    away = math.sqrt(x * x + y * y + z * z)
    least, most = abs(robot.l1 - robot.l2), robot.l1 + robot.l2
    short = max(abs(away - robot.l3) - most, least - away - robot.l3)
    if not short > PROVED_M:
        return "some pitch reaches the point"
    return "" if same(amount_of(refusal), short) else "it is out of reach by another amount"


def met(scene: Scene, refusal: Refusal, witness: Met) -> str:
    """Why it is not shown that bodies are in the way in each way to a control point, or at the start; nothing:
    it is."""
    if refusal.reason is Reason.START_IN_COLLISION:
        first = witness.ways[0] if len(witness.ways) == 1 else None
        if first is None or (first.place, first.mode, first.turn_rad) != ("start", None, None):
            return "one pair must be named, at the start"
        return _refuted([(witness.ways[0], at_the_start(scene, witness.ways[0]))], refusal)
    judged = list[tuple[Meeting, Judged | str]]()
    if len(witness.ways) > MOST_HINDRANCES:
        return "its witness speaks of more than there is"
    for way in ways(scene, refusal.step):
        for mode in allowed_modes(scene):
            said = [each for each in witness.ways if each.mode == mode and _turn(each.turn_rad, way.turn)]
            here = [(each, at_a_point(scene, way, each)) for each in said]
            if not here:
                return f"nothing is said to be in the way in mode {mode}"
            judged += here
    return _refuted(judged, refusal)


def _refuted(judged: list[tuple[Meeting, Judged | str]], refusal: Refusal) -> str:
    """The first complaint about meetings; nothing: all are right, and the refusal tells one of them."""
    for _, found in judged:
        if isinstance(found, str):
            return found
    if not any(isinstance(found, Judged) and _told(meeting, found, refusal) for meeting, found in judged):
        return "what the refusal says is none of the meetings of its witness"
    return ""


def _told(meeting: Meeting, found: Judged, refusal: Refusal) -> bool:
    """Whether a refusal tells this meeting. Of bodies that overlap it tells how deep they are at most, which is not
    held to anything but the points."""
    facts, amount = refusal.facts, amount_of(refusal)
    if refusal.bodies != meeting.bodies or meeting.inside is not isinstance(facts, Enclosed):
        return False
    if not isinstance(facts, Separation):
        return isinstance(facts, Enclosed) and amount is None
    gap, required = facts.gap_m, facts.required_m
    if gap is None or required is None or amount is None or not same(required, found.required):
        return False
    told = gap <= found.distance + TOLD and same(amount, required - gap) and facts.rule == found.rule
    told = told and same(facts.clearance_m, required)
    told = told and (found.distance <= TOLD if facts.touching else found.distance >= -TOLD)
    if gap > TOLD:  # what is apart is as near as is told
        told = told and found.distance <= gap + 10.0 * TOLD
    ends = {"approach", "depart"}
    if meeting.place not in ends:
        return told and (facts.end, facts.straight_m, facts.least_m) == (None, None, None)
    return told and facts.end == meeting.place and facts.straight_m is not None and same(facts.straight_m, found.above)


def orbit(scene: Scene, refusal: Refusal, witness: Orbit) -> str:
    """Why it is not shown that a point on a frame that repeats its motion is never within reach; nothing: it is."""
    number, t0 = refusal.step, scene.start.time
    found = ways(scene, number)
    lasts = _period(scene.frames[found[0].frame].law)
    amount = amount_of(refusal)
    if lasts is None or not same(witness.span_s[0], t0) or not same(witness.span_s[1], t0 + lasts):
        return "it was not looked at for a period"
    if not witness.short_m > PROVED_M or not same(amount, witness.short_m):
        return "the point is not out of reach by as much"
    world = standing(scene, scene.start.q, 2.0 * lasts + 1.0)
    edges = np.linspace(t0, t0 + lasts, PARTS + 1).tolist()
    for way in found:
        for mode in allowed_modes(scene):
            if not all(_apart(scene, world, way, mode, a, b, witness.short_m, 0) for a, b in pairwise(edges)):
                return "the point is not shown to stay so far out of reach"
    return ""


def _apart(scene: Scene, world: World, way: Way, mode: str, t0: float, t1: float, short: float, depth: int) -> bool:
    """Whether the flange is at least `short`, m, out of reach over [t0, t1] (up to `TOLD`)."""
    goal = _swept(world, way, t0, t1)
    if goal is not None and posture(scene.robot, mode, goal).short.low >= short - TOLD:
        return True
    if depth >= DEEPEST:
        return False
    middle = (t0 + t1) / 2.0
    halves = ((t0, middle), (middle, t1))
    return all(_apart(scene, world, way, mode, a, b, short, depth + 1) for a, b in halves)


def _swept(world: World, way: Way, t0: float, t1: float) -> Goal | None:
    """Where the flange is over [t0, t1], by bounds of the frame's motion; None: it is not known."""
    carrier = world.frame[way.frame]
    jets = motion.all_jets(world.tables)
    if not motion.carry(carrier, t0, t1, world.tables, jets):
        return None
    rows = [Span(float(row[0]), float(row[1])) for row in jets[carrier]]
    local = way.flange if way.turn is not None else way.point
    spread = around(0.0, way.spread)
    x, y = (plus(rows[k], scaled(local.x, rows[3 + k]), scaled(local.y, rows[6 + k]), spread) for k in range(2))
    return Goal(x, y, plus(rows[2], Span(way.flange.z, way.flange.z)), ANY, ANY, ANY)


def _period(law: Law) -> float | None:
    """After how many seconds a frame is where it was, again and again; None: never, or nobody knows."""
    if law.kind in ("swing", "oscillation"):
        return law.numbers.period
    if law.kind == "keyframes":
        return float(law.numbers.times[-1] - law.numbers.times[0]) if law.numbers.ends == "periodic" else None
    if law.kind == "turntable" and law.numbers.rate != 0.0 and law.numbers.rise == 0.0 and not law.numbers.changes:
        return math.tau / abs(law.numbers.rate)
    return None


def yaw_of(scene: Scene, way: Way) -> float | None:
    """The yaw of the tool in the world at the point of a way, where it is the same at all times."""
    law = scene.frames[way.frame].law
    if way.turn is None or law.kind not in ("fixed", "conveyor", "linear", "oscillation"):
        return None
    return law.numbers.pose.yaw + way.flange.yaw + scene.tool.tcp.yaw


def yaws_forbidden(scene: Scene, refusal: Refusal, facts: ForbiddenYaw) -> str:
    """Why it is not shown that the tool has a forbidden yaw at a control point, however the part is turned; nothing: it
    has."""
    yaws = [yaw_of(scene, way) for way in ways(scene, refusal.step)]
    if scene.options.vias_missed and scene.task[refusal.step].via:
        return "the via is missed"
    slack = slack_of(scene.execution.lag)
    if not all(
        yaw is not None and max(each.depth(yaw, slack) for each in scene.forbidden_yaw) > PROVED_RAD for yaw in yaws
    ):
        return "the tool may have a yaw that is not forbidden"
    if any(yaw is not None and not in_range(scene, refusal, facts, yaw) for yaw in yaws):
        return ""
    return "the range is another one, or the yaw less deep in it"
