"""Whether two bodies are too near each other where the arm must be: at its start, or at a control point.

A witness gives a point of each. With a point x of the first that is d_x deep in it, and y of the second, d_y deep,

    distance <= |x - y| - d_x - d_y                                                                           (W1)

where less than 0 means that they overlap however they are shifted by less than that. A pair is too near if this is less
than the distance required by more than a plan may be off its place.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.along import TRACKED_RAD
from assur.planner.checker.refusals.postures import posture
from assur.planner.checker.refusals.solids import deepest, within
from assur.planner.checker.refusals.spans import around
from assur.planner.checker.refusals.standing import place_of, standing
from assur.planner.checker.refusals.ways import Way
from assur.planner.checker.rows import Apart
from assur.planner.checker.solids import solids
from assur.planner.checker.world import World
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Body, Hull, Piece
from assur.planner.model.attachments import Attachments, at_start
from assur.planner.model.clearance import rule_of
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Contacts, Phase, contacts_of, pair
from assur.planner.model.proofs.witness import PROVED_M, PROVED_RAD, PROVED_TRACKED_M, Meeting
from assur.planner.model.refusal import Rule
from assur.planner.model.scene import Scene

OUTSIDE_M = 1e-9
"""By this much, m, a point may be outside of the body that it is said to be of: rounding of poses."""
REACHED_M = 1e-6
"""The flange of a posture is at its goal up to this, m: rounding, also where the arm is stretched."""
UPRIGHT = 1e-12
"""An axis whose horizontal part is not above this is vertical, and a place not farther from an axis, m, is on it."""


@dataclass(frozen=True, slots=True)
class Judged:
    """A pair that is too near: `distance`, m, is not below its distance (W1; NaN: inside a hollow mesh), `required`
    what is required of it, by which rule."""

    distance: float
    required: float
    rule: Rule
    above: float
    """m. How far above the control point it is."""


@dataclass(frozen=True, slots=True)
class _Stood:
    """A body where it stands: its pose in the world, position (3,) and rotation (3, 3)."""

    body: Body
    at: FloatArray
    turn: FloatArray
    link: str | None
    """The link of the arm, or None: it is of the surroundings."""
    in_link: Pose = Pose()

    def local(self, point: FloatArray) -> FloatArray:
        return np.asarray(self.turn.T @ (point - self.at))


def at_the_start(scene: Scene, meeting: Meeting) -> Judged | str:
    """The pair of a meeting at the start, or why it is none that proves anything."""
    t, attached = scene.start.time, at_start(scene)
    phase = Phase(t, t, LegKind.WAIT, 0, attached)
    world = standing(scene, scene.start.q)
    table = solids(scene, (phase,))
    apart = Apart.of(scene, (phase,), table, world.tables)
    numbers = [table.number.get(name) for name in meeting.bodies]
    if None in numbers or not apart.required(0, *(number or 0 for number in numbers)):
        return f"{' and '.join(meeting.bodies)} need not keep apart at the start"
    first, second = (_stood(scene, world, t, attached, name) for name in meeting.bodies)
    if first is None or second is None:
        return "a body is nowhere at the start"
    return _judged(scene, phase, first, second, meeting, 0.0, 0.0)


def at_a_point(scene: Scene, way: Way, meeting: Meeting) -> Judged | str:
    """The pair of a meeting at a control point, in the mode of the meeting, or why it proves nothing."""
    t, robot, step = scene.start.time, scene.robot, scene.task[way.number]
    if scene.options.vias_missed and step.via:
        return "the via is missed"
    tilts = "pitch" in robot.coordinates
    if tilts and not all(math.isfinite(angle) for angle in way.tilt):
        return "pitch or roll are free"
    place = _place(scene, way, meeting)
    if isinstance(place, str):
        return place
    phase, above, contacts = place
    if pair(*meeting.bodies) in contacts:
        return f"{' and '.join(meeting.bodies)} may touch there"
    at = place_of(standing(scene, scene.start.q), way.frame, t)
    if at is None or meeting.mode is None:
        return "the frame is not known at the start, or no mode is named"
    fixed = scene.frames[way.frame].law.kind == "fixed"
    if not fixed and not robot.turns_load:
        return "how the arm tilts depends on when the point is met"
    goal = way.goal(scene, at, above, 0.0, 0.0)
    if way.turn is None:
        goal = replace(goal, yaw=around(at.then(way.flange).yaw, 0.0))
    found = posture(robot, meeting.mode, goal)
    q = np.array([span.middle for span in found.joints])
    if not np.isfinite(q).all() or found.short.low > 0.0:
        return "the arm does not reach the point, so nothing of it can collide there"
    world = standing(scene, q)
    flange = world.states([(world.flange, Pose(), t)])[0]
    wanted = goal.x.middle, goal.y.middle, goal.z.middle
    if not math.dist(flange.p, wanted) <= REACHED_M:
        return "the flange is not shown to be at the point"
    first, second = (_stood(scene, world, t, phase.attached, name) for name in meeting.bodies)
    if first is None or second is None:
        return "a body is nowhere"
    refused = _hangs(scene, way, first, second, phase.attached)
    if refused:
        return refused
    axis = math.dist(meeting.points_m[0][:2], wanted[:2])
    angle = TRACKED_RAD if above > 0.0 else PROVED_RAD
    return _judged(scene, phase, first, second, meeting, above, 2.0 * angle * axis if way.turn is not None else 0.0)


def _place(scene: Scene, way: Way, meeting: Meeting) -> tuple[Phase, float, Contacts] | str:
    """The phase of a place at a point, how far above it is, and which pairs may touch there."""
    t, step, number = scene.start.time, scene.task[way.number], way.number
    approach, depart = scene.straight(step)
    nothing: Contacts = frozenset()
    before, behind = contacts_of(scene, step, way.before, None)
    tracked = way.frame if step.tracks else None
    if meeting.place == "point":
        kind = LegKind.FOLLOW if step.tracks else LegKind.MOVE
        return Phase(t, t, kind, number, way.before, tracked=tracked), 0.0, before if step.tracks else nothing
    if step.part is None:
        return f"there is no {meeting.place} at {step.name}"
    if meeting.place == "behind":
        return Phase(t, t, LegKind.DEPART, number, way.after, tracked=tracked), 0.0, behind
    if meeting.place == "approach":
        return Phase(t, t, LegKind.MOVE, number, way.before), approach, nothing
    if meeting.place == "depart" and number + 1 < len(scene.task):
        return Phase(t, t, LegKind.MOVE, number, way.after), depart, nothing
    return f"there is no {meeting.place} at {step.name} from which a way leads on"


def _hangs(scene: Scene, way: Way, first: _Stood, second: _Stood, attached: Attachments) -> str:
    """Why a pair is none that is as near whenever the point is met: the first must hang on the flange, or the point
    stand still, and the second never move against the point; and where the tool may be turned at will, that must change
    nothing."""
    if first.link is None or second.link is not None or second.body.name not in scene.index:
        return f"{first.body.name} is not of the arm, or {second.body.name} not of the surroundings"
    frame = attached.pose_of(scene, second.body.name)[0]
    stand = [scene.frames[name].law.kind == "fixed" for name in (frame, way.frame)]
    if first.link not in ("flange", "quill"):
        return "" if all(stand) and way.spread == 0.0 else f"{first.body.name} does not hang on the flange"
    if frame != way.frame and not all(stand):
        return f"{second.body.name} moves against the point"
    if way.turn is not None or first.link == "quill":
        return "" if way.turn is not None or way.spread == 0.0 else "the tool turns about another axis"
    held = None if attached.held is None else attached.held.part
    round_ = first.body.name != held and all(_round(piece) for piece in first.body.pieces)
    return "" if way.spread == 0.0 and round_ else f"{first.body.name} may be turned"


def _round(piece: Piece) -> bool:
    """Whether a piece is a solid of revolution about the vertical axis of its body."""
    shape, turn, at = piece.shape, piece.rotation, piece.position
    if isinstance(shape, Hull) or shape.half[0] > 0.0 or shape.half[1] > 0.0:
        return False
    upright = max(abs(float(turn[0, 2])), abs(float(turn[1, 2]))) <= UPRIGHT or not (shape.half[2] or shape.disc)
    return upright and math.hypot(float(at[0]), float(at[1])) <= UPRIGHT


def _stood(scene: Scene, world: World, t: float, attached: Attachments, name: str) -> _Stood | None:
    """A body where it stands at an instant."""
    links = scene.robot.links
    flange = links.index("flange")
    carrier, local, body = -1, Pose(), None
    for item in scene.robot.bodies:
        if item.body.name == name:
            carrier, body = item.link, item.body
    for tool in scene.tool.bodies:
        if tool.name == name:
            carrier, body = flange, tool
    if name in scene.index:
        body = scene.index[name].body
        if attached.held is not None and attached.held.part == name:
            carrier, local = flange, attached.held.in_flange
        else:
            frame, local = attached.pose_of(scene, name)
            carrier = world.frame[frame]
    if body is None:
        return None
    at, turn = world.place(carrier, t)
    c, s = math.cos(local.yaw), math.sin(local.yaw)
    own = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    position = at + turn @ local.position
    if not (np.isfinite(position).all() and np.isfinite(turn).all()):
        return None
    return _Stood(body, position, turn @ own, links[carrier] if carrier < len(links) else None, local)


def _judged(
    scene: Scene, phase: Phase, first: _Stood, second: _Stood, meeting: Meeting, above: float, turned: float
) -> Judged | str:
    """Whether both points of a meeting show that its bodies are nearer than required by more than a plan may be off its
    place, `turned`, m, of it by its yaw."""
    near = PROVED_TRACKED_M if above > 0.0 else PROVED_M
    x, y = (np.array(point) for point in meeting.points_m)
    rule, required = rule_of(scene, phase, first.body.name, second.body.name)
    own = deepest(first.body, first.local(x))
    if not own >= -OUTSIDE_M:
        return f"the point is not inside {first.body.name}"
    if meeting.inside:
        surface = second.body.surface
        if surface is None or not (x == y).all() or not within(surface, second.local(y), near + turned):
            return f"the point is not inside the surface of {second.body.name}"
        return Judged(math.nan, required, rule, above)
    other = deepest(second.body, second.local(y))
    if not other >= -OUTSIDE_M:
        return f"the point is not inside {second.body.name}"
    distance = float(np.linalg.norm(x - y)) - own - other
    if not distance <= required - near - turned - 2.0 * OUTSIDE_M:
        return f"{first.body.name} and {second.body.name} are not shown to be nearer than they may be"
    return Judged(distance, required, rule, above)
