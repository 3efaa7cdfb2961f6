"""Whether two bodies are too near each other where the arm must be: at its start, or at a control point.

A witness gives a point of each. With a point x of the first that is d_x deep in it, and y of the second, d_y deep,

    distance <= |x - y| - d_x - d_y                                                                           (W1)

where less than 0 means that they overlap however they are shifted by less than that. A pair is too near if this is less
than the distance required by more than a plan may be off its place.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.nearest import deepest, distance, is_within
from assur.planner.checker.refusals.obstructions import MOST, STATED
from assur.planner.checker.refusals.postures import frame_at, links_at, posture_in_mode, still
from assur.planner.checker.refusals.spans import around
from assur.planner.checker.refusals.stated import NotShownError, Proof, Spot, spots
from assur.planner.checker.refusals.ways import GraspOption, each_way, ways
from assur.planner.checker.statement.differences import TRACKED_RAD
from assur.planner.checker.statement.distances import required_between
from assur.planner.checker.statement.solids import bodies_of
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Hull, Piece
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.outcome import TRACKING, LegKind
from assur.planner.model.phases import pair
from assur.planner.model.refusal import (
    Bodies,
    Enclosed,
    Facts,
    NotTouching,
    Quantity,
    Reason,
    Refusal,
    Separation,
    Stage,
)
from assur.planner.model.scene import Pick, Place, Scene
from assur.planner.model.witness import PROVED_M, PROVED_RAD, PROVED_TRACKED_M, Meeting, Overlap

OUTSIDE_M = 1e-9
"""By this much, m, a point may be outside of the body whose point it is stated to be: rounding of poses."""
REACHED_M = 1e-6
"""The flange of a posture is at its goal up to this, m: rounding, also where the arm is stretched."""
NOWHERE = np.full(3, np.nan)
UPRIGHT = 1e-12
"""An axis whose horizontal part is not above this is vertical, and a place not farther from an axis, m, is on it."""


@dataclass(frozen=True, slots=True)
class Solid:
    """A body where it is: its pose in the world, position (3,) and rotation (3, 3); the link of the arm that it is on,
    or None: it is of the surroundings."""

    body: Body
    at: FloatArray
    turn: FloatArray
    link: str | None

    def local(self, point: FloatArray) -> FloatArray:
        return np.asarray(self.turn.T @ (point - self.at))


def met(scene: Scene, refusal: Refusal, witness: Overlap) -> Iterator[Proof]:
    """What is in the way as a witness states: in each way to a control point, or at the start. Raises `NotShownError`
    where it is not."""
    if len(witness.ways) > MOST:
        raise NotShownError("its witness has more meetings than there are")
    if refusal.stage is Stage.START:
        first = witness.ways[0] if len(witness.ways) == 1 else None
        if first is None or (first.place, first.mode, first.turn_rad) != ("start", None, None):
            raise NotShownError("one pair must be named, at the start")
        yield _at_the_start(scene, refusal, first)
        return
    found = list[Proof]()
    for way, mode, here in each_way(scene, refusal.step, witness.ways):
        if not here:
            raise NotShownError(f"the witness has nothing that is in the way in mode {mode}")
        found += [_at_a_point(scene, refusal, way, mode, each) for each in here]
    yield from found


def _at_the_start(scene: Scene, refusal: Refusal, meeting: Meeting) -> Proof:
    t, attached = scene.start.time, at_start(scene)
    first, second = _solids(scene, scene.start.q, attached, meeting.bodies)
    links = pair(first.link or "", second.link or "")
    apart = (first.link is None) != (second.link is None) or links in {pair(*each) for each in scene.robot.self_pairs}
    if not apart or first.link == second.link:
        raise NotShownError(f"{' and '.join(meeting.bodies)} need not keep apart at the start")
    spot = Spot(attached, LegKind.WAIT, frozenset(), "start")
    true = _too_near(scene, refusal, spot, first, second, meeting, 0.0)
    return true._replace(reason=Reason.START_IN_COLLISION, interval=(t, t))


def _at_a_point(scene: Scene, refusal: Refusal, way: GraspOption, mode: str, meeting: Meeting) -> Proof:
    t, robot, step = scene.start.time, scene.robot, scene.task[way.number]
    if scene.options.vias_missed and step.via:
        raise NotShownError("the via is missed")
    if "pitch" in robot.coordinates and None in way.tilt:
        raise NotShownError("pitch or roll are free")
    around_point = spots(scene, way.number, way.before, way.after)
    spot = next((each for each in around_point if each.place == meeting.place), None)
    if spot is None:
        raise NotShownError(f"there is no {meeting.place} at {step.name} from which a way leads on")
    if pair(*meeting.bodies) in spot.contacts:
        raise NotShownError(f"{' and '.join(meeting.bodies)} may touch there")
    at = frame_at(scene, way.frame, t)
    if at is None or (still(scene, way.frame) is None and not robot.turns_load):
        raise NotShownError("the frame is not known at the start, or how the arm tilts depends on the time")
    goal = way.goal(scene, at, spot.above, 0.0, 0.0)
    if way.turn is None:
        goal = replace(goal, yaw=around(at.then(way.flange).yaw, 0.0))
    wanted, found = (goal.x.middle, goal.y.middle, goal.z.middle), posture_in_mode(robot, mode, goal)
    q = np.array([span.middle for span in found.joints])
    if not np.isfinite(q).all() or found.short.low > 0.0:
        raise NotShownError("the arm does not reach the point, so nothing of it can collide there")
    if not math.dist(links_at(scene, q)[robot.links.index("flange")].place, wanted) <= REACHED_M:
        raise NotShownError("the flange is not shown to be at the point")
    first, second = _solids(scene, q, spot.attached, meeting.bodies)
    _check_constant(scene, way, first, second, spot.attached)
    turned = 0.0
    if way.turn is not None:
        angle = TRACKED_RAD if spot.above > 0.0 else PROVED_RAD
        turned = 2.0 * angle * math.dist(meeting.points_m[0][:2], wanted[:2])
    return _too_near(scene, refusal, spot, first, second, meeting, turned)


def _check_constant(scene: Scene, way: GraspOption, first: Solid, second: Solid, attached: Attachments) -> None:
    """Raises `NotShownError` for a pair that may be less near when the point is met at another time: the first must be
    on the flange, or the point stand still, and the second never move against the point; and where the tool may be
    turned at will, that must change nothing."""
    if first.link is None or second.link is not None:
        raise NotShownError(f"{first.body.name} is not of the arm, or {second.body.name} not of the surroundings")
    frame = attached.pose_of(scene, second.body.name)[0]
    at_rest = all(still(scene, name) is not None for name in (frame, way.frame))
    if first.link not in ("flange", "quill"):
        if not at_rest or way.spread != 0.0:
            raise NotShownError(f"{first.body.name} is not on the flange")
        return
    if frame != way.frame and not at_rest:
        raise NotShownError(f"{second.body.name} moves against the point")
    if way.turn is not None:
        return
    held = None if attached.held is None else attached.held.part
    round_ = first.body.name != held and all(_is_round(piece) for piece in first.body.pieces)
    if way.spread != 0.0 or not (first.link == "quill" or round_):
        raise NotShownError(f"{first.body.name} may be turned")


def _is_round(piece: Piece) -> bool:
    """Whether a piece is a solid of revolution about the vertical axis of its body."""
    shape, turn, at = piece.shape, piece.rotation, piece.position
    if isinstance(shape, Hull) or shape.half[0] > 0.0 or shape.half[1] > 0.0:
        return False
    upright = max(abs(float(turn[0, 2])), abs(float(turn[1, 2]))) <= UPRIGHT or not (shape.half[2] or shape.disc)
    return upright and math.hypot(float(at[0]), float(at[1])) <= UPRIGHT


def _solids(scene: Scene, q: FloatArray, attached: Attachments, names: tuple[str, str]) -> tuple[Solid, Solid]:
    """Two bodies where they are at the start, with the arm at joint values q (n,). Raises `NotShownError` for a body
    that there is not, or whose place is not known."""
    robot, held, links = scene.robot, attached.held, links_at(scene, q)
    seats = {item.body.name: (robot.links[item.link], Pose()) for item in robot.bodies}
    seats |= {body.name: ("flange", Pose()) for body in scene.tool.bodies}
    seats |= {} if held is None else {held.part: ("flange", held.in_flange)}
    bodies = {body.name: body for body in bodies_of(scene)}

    def solid(name: str) -> Solid:
        link, local = seats.get(name, (None, Pose()))
        if link is not None:
            carrier = links[robot.links.index(link)]
            place, turn = carrier.place, carrier.rotation
        else:
            frame, local = attached.pose_of(scene, name)
            at = frame_at(scene, frame, scene.start.time)
            place, turn = (NOWHERE, np.eye(3)) if at is None else (at.position, about_vertical(at.yaw))
        found = Solid(bodies[name], place + turn @ local.position, turn @ about_vertical(local.yaw), link)
        if not (np.isfinite(found.at).all() and np.isfinite(found.turn).all()):
            raise NotShownError(f"it is not known where {name} is")
        return found

    if not set(names) <= set(bodies):
        raise NotShownError(f"there is no body {' or '.join(names)}")
    return solid(names[0]), solid(names[1])


def about_vertical(yaw: float) -> FloatArray:
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _too_near(
    scene: Scene, given: Refusal, spot: Spot, first: Solid, second: Solid, meeting: Meeting, turned: float
) -> Proof:
    """What both points of a meeting at a spot show, if its bodies are nearer than required by more than a plan may be
    off its place, `turned`, m, of it by its yaw."""
    near = turned + (PROVED_TRACKED_M if spot.above > 0.0 else PROVED_M)
    x, y = (np.array(point) for point in meeting.points_m)
    depths = [deepest(first.body, first.local(x)), deepest(second.body, second.local(y))]
    reason, subject = Reason.CONTROL_POINT_IN_COLLISION, Bodies(meeting.bodies)
    if not all(each >= -OUTSIDE_M for each in (depths[:1] if meeting.inside else depths)):
        raise NotShownError(f"a point is not inside {first.body.name}, or the other one not inside {second.body.name}")
    if meeting.inside:
        surface = second.body.surface
        if surface is None or not (x == y).all() or not is_within(surface, second.local(y), near):
            raise NotShownError(f"the point is not inside the surface of {second.body.name}")
        return Proof(reason, Enclosed(), None, subject, STATED)
    rule, required = required_between(scene, spot.kind in TRACKING, first.body.name, second.body.name)
    distance = float(np.linalg.norm(x - y)) - sum(depths)
    if not distance <= required - near - 2.0 * OUTSIDE_M:
        raise NotShownError(f"{first.body.name} and {second.body.name} are not shown to be nearer than they may be")
    facts = Separation(
        touching=distance < 0.0,
        gap_m=distance,
        required_m=required,
        rule=rule,
        clearance_m=required,
        end=spot.end,
        straight_m=None if spot.end is None else spot.above,
    )
    facts = _as_given(facts, distance, given.facts)
    return Proof(reason, facts, Quantity(required - (facts.gap_m or 0.0), "m"), subject, STATED)


def _as_given(true: Separation, distance: float, given: Facts) -> Separation:
    """The same with what the points do not show, as it is given: the gap of bodies that overlap, whether those touch
    that are as far apart as rounding is large, and the length with which a straight part would do."""
    if not isinstance(given, Separation) or given.gap_m is None:
        return true
    gap, touching = given.gap_m, given.touching if abs(distance) <= STATED else true.touching
    may_be = gap <= distance + STATED and (gap <= STATED or distance <= gap + 10.0 * STATED)
    least = given.least_m if true.end is not None else None
    return replace(true, gap_m=gap if may_be else distance, touching=touching, least_m=least)


# Whether tool or support are too far from the part of a step, however the part is turned and whenever it is taken.

WITHIN_M = 5e-5
"""By how much a distance that is stated may be off, m."""


def never_touching(scene: Scene, refusal: Refusal) -> Iterator[Proof]:
    """The part of a step is too far from the tool that takes it, or from what it is put down on: by the distance in the
    turn in which it is least."""
    step = scene.task[refusal.step]
    if not isinstance(step, Pick | Place):
        return
    allowed = step.grip_within_m if isinstance(step, Pick) else step.support_within_m
    found = dict[str, float]()
    for way in ways(scene, refusal.step):
        others = _others(scene, step, way)
        if way.turn is None or not others:
            return  # where the part is then is not known for all turns and times
        part = scene.index[step.part].body.pieces
        for other, pose in others:
            low, high = distance(part, _placed(other, pose))
            if not low > allowed + PROVED_M:
                return
            found[other.name] = min(found.get(other.name, math.inf), high)
    least, given = min(found.values(), default=math.inf), refusal.facts
    if isinstance(given, NotTouching) and abs(given.distance_m - least) <= WITHIN_M:
        least = given.distance_m
    of: Literal["grip", "support"] = "grip" if isinstance(step, Pick) else "support"
    facts = NotTouching(of=of, distance_m=least, allowed_m=allowed)
    for name in (name for name, high in found.items() if high <= least + WITHIN_M):
        for bodies in ((name, step.part), (step.part, name)):
            yield Proof(Reason.TOLERANCE, facts, Quantity(least - allowed, "m"), Bodies(bodies))


def _others(scene: Scene, step: Pick | Place, way: GraspOption) -> list[tuple[Body, Pose]]:
    """What counts, with its pose in the part's frame: of a pick the tool's bodies; of a place what the part is put down
    on, where it never moves against the part."""
    held = way.after.held
    if isinstance(step, Pick):
        return [(body, held.in_flange.inverse()) for body in scene.tool.bodies] if held is not None else []
    found = []
    frame, pose = way.after.pose_of(scene, step.part)
    for name in step.contact_with or ():
        own, there = way.after.pose_of(scene, name)
        first, second = (Pose(), Pose()) if own == frame else (still(scene, frame), still(scene, own))
        if first is None or second is None:
            return []
        found.append((scene.index[name].body, first.then(pose).inverse().then(second.then(there))))
    return found


def _placed(body: Body, pose: Pose) -> list[Piece]:
    """The pieces of a body at a pose."""
    turn = about_vertical(pose.yaw)
    return [Piece(each.shape, pose.position + turn @ each.position, turn @ each.rotation) for each in body.pieces]
