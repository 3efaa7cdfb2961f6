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

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.obstructions import MOST, STATED
from assur.planner.checker.refusals.places import Spot, spots
from assur.planner.checker.refusals.postures import posture
from assur.planner.checker.refusals.solids import deepest, is_within
from assur.planner.checker.refusals.spans import around
from assur.planner.checker.refusals.standing import allowed_modes, frame_at, links_at, still
from assur.planner.checker.refusals.stated import NotShownError, Shown
from assur.planner.checker.refusals.ways import Way, is_turn, ways
from assur.planner.checker.statement.arms import link_names
from assur.planner.checker.statement.differences import TRACKED_RAD
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Hull, Piece
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.clearance import rule_of
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase, pair
from assur.planner.model.proofs.witness import PROVED_M, PROVED_RAD, PROVED_TRACKED_M, Meeting, Met
from assur.planner.model.refusal import Bodies, Enclosed, Quantity, Reason, Refusal, Separation, Stage
from assur.planner.model.scene import Scene

OUTSIDE_M = 1e-9
"""By this much, m, a point may be outside of the body that it is said to be of: rounding of poses."""
REACHED_M = 1e-6
"""The flange of a posture is at its goal up to this, m: rounding, also where the arm is stretched."""
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


def met(scene: Scene, refusal: Refusal, witness: Met) -> Iterator[Shown]:
    """Refusals by bodies that are in the way as a witness says: in each way to a control point, or at the start. Raises
    `NotShownError` where they are not."""
    if len(witness.ways) > MOST:
        raise NotShownError("its witness has more meetings than there are")
    if refusal.stage is Stage.START:
        first = witness.ways[0] if len(witness.ways) == 1 else None
        if first is None or (first.place, first.mode, first.turn_rad) != ("start", None, None):
            raise NotShownError("one pair must be named, at the start")
        yield Shown(_at_the_start(scene, refusal, first), STATED)
        return
    found = list[Refusal]()
    for way in ways(scene, refusal.step):
        for mode in allowed_modes(scene):
            here = [each for each in witness.ways if each.mode == mode and is_turn(each.turn_rad, way.turn)]
            if not here:
                raise NotShownError(f"the witness has nothing that is in the way in mode {mode}")
            found += [_at_a_point(scene, refusal, way, mode, each) for each in here]
    yield from (Shown(each, STATED) for each in found)


def _at_the_start(scene: Scene, refusal: Refusal, meeting: Meeting) -> Refusal:
    t, attached = scene.start.time, at_start(scene)
    first, second = _stand(scene, scene.start.q, attached, meeting.bodies)
    links = pair(first.link or "", second.link or "")
    apart = (first.link is None) != (second.link is None) or links in {pair(*each) for each in scene.robot.self_pairs}
    if not apart or first.link == second.link:
        raise NotShownError(f"{' and '.join(meeting.bodies)} need not keep apart at the start")
    spot = Spot(attached, LegKind.WAIT, frozenset(), "start")
    true = _refusal(scene, refusal, spot, first, second, meeting, 0.0)
    return replace(true, reason=Reason.START_IN_COLLISION, interval=(t, t))


def _at_a_point(scene: Scene, refusal: Refusal, way: Way, mode: str, meeting: Meeting) -> Refusal:
    t, robot, step = scene.start.time, scene.robot, scene.task[way.number]
    if scene.options.vias_missed and step.via:
        raise NotShownError("the via is missed")
    if "pitch" in robot.coordinates and not all(math.isfinite(angle) for angle in way.tilt):
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
    wanted, found = (goal.x.middle, goal.y.middle, goal.z.middle), posture(robot, mode, goal)
    q = np.array([span.middle for span in found.joints])
    if not np.isfinite(q).all() or found.short.low > 0.0:
        raise NotShownError("the arm does not reach the point, so nothing of it can collide there")
    if not math.dist(links_at(scene, q)[link_names(robot).index("flange")].place, wanted) <= REACHED_M:
        raise NotShownError("the flange is not shown to be at the point")
    first, second = _stand(scene, q, spot.attached, meeting.bodies)
    _check_constant(scene, way, first, second, spot.attached)
    turned = 0.0
    if way.turn is not None:
        angle = TRACKED_RAD if spot.above > 0.0 else PROVED_RAD
        turned = 2.0 * angle * math.dist(meeting.points_m[0][:2], wanted[:2])
    return _refusal(scene, refusal, spot, first, second, meeting, turned)


def _check_constant(scene: Scene, way: Way, first: Solid, second: Solid, attached: Attachments) -> None:
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


def _stand(scene: Scene, q: FloatArray, attached: Attachments, names: tuple[str, str]) -> tuple[Solid, Solid]:
    """Two bodies where they are at the start, with the arm at joint values q (n,)."""
    first, second = (_solid(scene, q, attached, name) for name in names)
    return first, second


def _solid(scene: Scene, q: FloatArray, attached: Attachments, name: str) -> Solid:
    robot, held = scene.robot, attached.held
    own = [(item.body, robot.links[item.link]) for item in robot.bodies if item.body.name == name]
    own += [(body, "flange") for body in scene.tool.bodies if body.name == name]
    if not own and name not in scene.index:
        raise NotShownError(f"there is no body {name}")
    body, link = own[0] if own else (scene.index[name].body, None)
    local = Pose()
    if link is None and held is not None and held.part == name:
        link, local = "flange", held.in_flange
    if link is not None:
        carrier = links_at(scene, q)[link_names(robot).index(link)]
        place, turn = carrier.place, carrier.rotation
    else:
        frame, local = attached.pose_of(scene, name)
        at = frame_at(scene, frame, scene.start.time)
        if at is None:
            raise NotShownError(f"it is not known where {name} is")
        place, turn = at.position, about_vertical(at.yaw)
    position = place + turn @ local.position
    if not (np.isfinite(position).all() and np.isfinite(turn).all()):
        raise NotShownError(f"it is not known where {name} is")
    return Solid(body, position, turn @ about_vertical(local.yaw), link)


def about_vertical(yaw: float) -> FloatArray:
    c, s = math.cos(yaw), math.sin(yaw)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _refusal(
    scene: Scene, given: Refusal, spot: Spot, first: Solid, second: Solid, meeting: Meeting, turned: float
) -> Refusal:
    """The refusal by a pair at a spot, if both points of a meeting show that its bodies are nearer than required by
    more than a plan may be off its place, `turned`, m, of it by its yaw. The gap of bodies that overlap, and the length
    with which a straight part would do, are those of the given refusal: the points do not show them."""
    near = PROVED_TRACKED_M if spot.above > 0.0 else PROVED_M
    x, y = (np.array(point) for point in meeting.points_m)
    own = deepest(first.body, first.local(x))
    if not own >= -OUTSIDE_M:
        raise NotShownError(f"the point is not inside {first.body.name}")
    true = Refusal(
        stage=given.stage,
        reason=Reason.CONTROL_POINT_IN_COLLISION,
        step=given.step,
        subject=Bodies(meeting.bodies),
        facts=Enclosed(),
    )
    if meeting.inside:
        surface = second.body.surface
        if surface is None or not (x == y).all() or not is_within(surface, second.local(y), near + turned):
            raise NotShownError(f"the point is not inside the surface of {second.body.name}")
        return true
    phase = Phase(scene.start.time, scene.start.time, spot.kind, given.step, spot.attached)
    rule, required = rule_of(scene, phase, first.body.name, second.body.name)
    other = deepest(second.body, second.local(y))
    if not other >= -OUTSIDE_M:
        raise NotShownError(f"the point is not inside {second.body.name}")
    distance = float(np.linalg.norm(x - y)) - own - other
    if not distance <= required - near - turned - 2.0 * OUTSIDE_M:
        raise NotShownError(f"{first.body.name} and {second.body.name} are not shown to be nearer than they may be")
    gap, touching, least = distance, distance < 0.0, None
    if isinstance(given.facts, Separation):
        said = given.facts.gap_m
        if said is not None and said <= distance + STATED and (said <= STATED or distance <= said + 10.0 * STATED):
            gap = said
        touching = given.facts.touching if abs(distance) <= STATED else touching
        least = given.facts.least_m if spot.end is not None else None
    facts = Separation(
        touching=touching,
        gap_m=gap,
        required_m=required,
        rule=rule,
        clearance_m=required,
        end=spot.end,
        straight_m=None if spot.end is None else spot.above,
        least_m=least,
    )
    return replace(true, amount=Quantity.of(required - gap, "m"), facts=facts)
