"""Bodies that are in the way of the arm wherever it must be: at its start, or on all ways through a control point.

What is found is stated twice: as the refusal, and as the witness that the checker can verify.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import product
from typing import NamedTuple

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.nearest import points_between
from assur.planner.checker.refusals.postures import allowed_mode_names
from assur.planner.checker.refusals.stated import Proof, Spot, spots
from assur.planner.checker.refusals.ways import GraspOption, ways
from assur.planner.collision.fcl_entry import PlacedShape
from assur.planner.collision.nearest import TooNear, closest, enclosed
from assur.planner.collision.proof import Prover
from assur.planner.collision.touching import allowed_m, too_far
from assur.planner.frames.motion import Pose
from assur.planner.geometry.shapes import Piece
from assur.planner.kernels.dyads import ASSEMBLED, FOLDED, STRETCHED
from assur.planner.legs.tilt import tilts
from assur.planner.model.attachments import AT_START, Attachments, at_start
from assur.planner.model.deadline import raise_if_late
from assur.planner.model.outcome import TRACKING, LegKind
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Bodies, Quantity, Reason, Refusal, Separation, Stage
from assur.planner.model.scene import Pick, Place, Scene, Step
from assur.planner.model.witness import Meeting
from assur.planner.robots.facts import Inverse

ROOM_M = 1e-4
"""A straight part that is stated to be long enough is so by this, m."""
REACHED = (ASSEMBLED, STRETCHED, FOLDED)
"""Codes of positions in which the flange is where it is required."""


class WayOfMeeting(NamedTuple):
    """A way to a control point, where the flange is on it, and how each mode that is allowed has it there, and then at
    the outer ends of both straight parts."""

    way: GraspOption
    spots: list[Spot]
    modes: list[Inverse]


def ways_of_meeting(scene: Scene, number: int) -> list[WayOfMeeting]:
    """All ways to the control point of a step, its frame being where it is at the start."""
    found, ends = list[WayOfMeeting](), scene.straight(scene.task[number])
    for way in ways(scene, number):
        at = spots(scene, number, way.before, way.after)
        found.append(WayOfMeeting(way, at, postures_above(scene, way, *[spot.above for spot in at], *ends)))
    return found


def postures_above(scene: Scene, way: GraspOption, *heights: float) -> list[Inverse]:
    """How each working mode that is allowed has the flange at heights above the point of a way, m, its frame being
    where it is at the start."""
    robot, t = scene.robot, np.full(len(heights), scene.start.time)
    motion = scene.frames[way.frame].law.motion(t).at(way.flange, np.array(heights)).at_rest()
    tilt = tilts(scene, scene.task[way.number], scene.start.q)[0]
    motion = motion if tilt is None else motion.with_tilt(np.array(tilt))
    return [robot.inverse(motion, robot.modes.index(mode), 0) for mode in allowed_mode_names(scene)]


@dataclass(frozen=True, slots=True)
class Hit:
    """What is in the way at a spot, in a phase, with the joints q (n,); `way`, `mode`: of a control point (None: it is
    the start)."""

    found: TooNear
    spot: Spot
    phase: Phase
    q: FloatArray
    way: GraspOption | None = None
    mode: str | None = None


def hit_at_start(scene: Scene, prover: Prover, *, hollow: bool = False) -> Hit | None:
    """What the arm collides with where it is at the start, at the clearance of travel; `hollow`: only a mesh that it is
    inside of counts, which is hollow to other proofs."""
    if hollow and not prover.arrangement.hollow:
        return None
    t, q, spot = scene.start.time, scene.start.q, Spot(at_start(scene), LegKind.WAIT, frozenset(), "start")
    phase = Phase(t, t, spot.kind, 0, spot.attached)
    found = enclosed(scene, prover, spot.attached, q, t, spot.contacts)
    near = found or (None if hollow else closest(scene, prover, phase, q, spot.contacts))
    return None if near is None else Hit(near, spot, phase, q)


def hits(scene: Scene, prover: Prover, every: list[WayOfMeeting]) -> list[Hit] | None:
    """What is in the way on each way to a control point in each working mode that is allowed; None: on one of them
    nothing is, or it is not known, as the point may be met at another time."""
    found = list[Hit]()
    for way, at, modes in every:
        for mode, inverse in zip(allowed_mode_names(scene), modes, strict=True):
            raise_if_late()
            for k, spot in enumerate(at):
                hit = _in_the_way(scene, prover, way, mode, spot, inverse, k)
                if hit is not None:
                    found.append(hit)
                    break
            else:
                return None
    return found


def _in_the_way(
    scene: Scene, prover: Prover, way: GraspOption, mode: str, spot: Spot, inverse: Inverse, row: int = 0
) -> Hit | None:
    """What is in the way of the flange's bodies at one spot in one working mode, which has it there as in a row of
    `inverse`; nothing where the arm does not reach it."""
    if int(inverse.code[row]) not in REACHED:
        return None
    q = inverse.q[row]
    t, attached, fixed = scene.start.time, spot.attached, scene.frames[way.frame].law.is_fixed
    phase = Phase(t, t, spot.kind, way.number, attached, tracked=way.frame if spot.kind in TRACKING else None)
    among = prover.arrangement.keeping(prover.of(phase), way.frame)
    found = enclosed(scene, prover, attached, q, t, spot.contacts, among) if fixed else None
    found = found or closest(scene, prover, phase, q, spot.contacts, among)
    return None if found is None else Hit(found, spot, phase, q, way, mode)


def refusal_of(scene: Scene, prover: Prover, hit: Hit) -> Refusal:
    """The refusal by what is in the way."""
    facts, short = hit.found.facts, None
    if isinstance(facts, Separation) and facts.gap_m is not None and facts.required_m is not None:
        short = Quantity.of(facts.required_m - facts.gap_m, "m")
        facts = _of_straight_part(scene, prover, hit, facts, facts.required_m - max(facts.gap_m, 0.0))
    subject, t = Bodies(hit.found.names), hit.phase.t0
    if hit.way is None:
        return Proof(Reason.START_IN_COLLISION, facts, short, subject, interval=(t, t)).refusal(Stage.START, 0)
    return Proof(Reason.CONTROL_POINT_IN_COLLISION, facts, short, subject).refusal(Stage.CONTROL_POINT, hit.way.number)


def _of_straight_part(scene: Scene, prover: Prover, hit: Hit, facts: Separation, missing: float) -> Separation:
    """The same facts with the straight part at whose end it is, and with which length that would do."""
    spot = hit.spot
    if spot.end is None or hit.way is None or hit.mode is None:
        return facts
    longer = replace(spot, above=spot.above + missing + ROOM_M)
    inverse = postures_above(scene, hit.way, longer.above)[allowed_mode_names(scene).index(hit.mode)]
    enough = _in_the_way(scene, prover, hit.way, hit.mode, longer, inverse) is None
    return replace(facts, end=spot.end, straight_m=spot.above, least_m=longer.above if enough else None)


def meeting_of(prover: Prover, hit: Hit) -> Meeting:
    """The witness of what is in the way: a point of each body."""
    if hit.found.point is not None:
        points = hit.found.point, hit.found.point
    else:
        posed = prover.posed(prover.of(hit.phase), hit.q, hit.phase.t0, np.array(hit.found.units))
        first, second = (Piece(each.shape, each.position.copy(), each.axes.copy()) for each in posed)
        points = tuple(tuple(point.tolist()) for point in points_between(first, second))  # type: ignore[assignment]
    return Meeting(
        mode=hit.mode,
        turn_rad=None if hit.way is None else hit.way.turn,
        place=hit.spot.place,
        bodies=hit.found.names,
        points_m=points,
        inside=hit.found.point is not None,
    )


# Bodies where they are at the start, and whether they touch, for warnings about requests.


class AtStart:
    """Bodies of the surroundings as they are at the start, or would be then if parts had changed places. Each body is
    posed once in each of its places."""

    def __init__(self, scene: Scene, prover: Prover) -> None:
        self.scene, self.prover = scene, prover
        self._posed: dict[tuple[str, str, Pose], list[PlacedShape]] = {}
        self._table: FloatArray | None = None
        carriers = prover.carriers(scene.start.q, scene.start.time)[len(scene.robot.links) :]
        self._frames = dict(zip(scene.frames, carriers, strict=True))
        """Where the frames are, (12,) each."""

    def place(self, name: str, attached: Attachments = AT_START) -> FloatArray:
        """Where the origin of a body is in the world, (3,) m; NaN: the motion of its frame is not known then."""
        frame, pose = attached.pose_of(self.scene, name)
        carrier = self._frames[frame]
        return np.asarray(carrier[:3] + carrier[3:].reshape(3, 3) @ pose.position)

    def shapes(self, name: str, attached: Attachments = AT_START) -> list[PlacedShape]:
        """The shapes of a body."""
        at = (name, *attached.pose_of(self.scene, name))
        if at not in self._posed:
            self._posed[at] = posed(self.prover, name, attached)
        return self._posed[at]

    def near(self, name: str, lowest: float, highest: float) -> list[str]:
        """The other bodies, in their order, that may touch a body at the start between two heights in the world, m: the
        circles about both meet, and theirs is not all above or below. None of those whose place is not known."""
        bodies, names = self.scene.bodies, list(self.scene.index)
        if self._table is None:
            self._table = np.empty((len(bodies), 5))
            for row, each in zip(self._table, bodies, strict=True):
                raise_if_late()
                place, row[2] = self.place(each.name), each.body.radius
                row[:2], row[3:] = place[:2], place[2] + each.body.heights
        table, own = self._table, self.place(name)
        reach = np.hypot(*(table[:, :2] - own[:2]).T) <= table[:, 2] + self.scene.index[name].body.radius
        reach &= (table[:, 4] >= lowest) & (table[:, 3] <= highest)
        return [names[k] for k in np.flatnonzero(reach).tolist() if names[k] != name]


def posed(prover: Prover, name: str, attached: Attachments = AT_START) -> list[PlacedShape]:
    """The shapes of any body as they are at the start, or would be then if it were so attached."""
    arrangement, start = prover.arrangement(attached), prover.scene.start
    return prover.posed(arrangement, start.q, start.time, np.array(arrangement.pieces(arrangement.number[name])))


def touch(prover: Prover, ones: list[PlacedShape], others: list[PlacedShape], *shifts: FloatArray) -> bool:
    """Whether any two of the shapes touch, after each of the shifts (3,) of the first ones, m. Checks the deadline
    before each two."""
    for by in shifts or (np.zeros(3),):
        for one, other in product([replace(each, position=each.position + by) for each in ones], others):
            raise_if_late()
            if prover.collider.touch(one, other):
                break
        else:
            return False
    return True


# Grips and supports that are farther from their part than the request allows, whenever and however the arm comes.


def never_touching(scene: Scene, prover: Prover) -> Refusal | None:
    """The first pick or place whose part is too far from the tool, in all turns in which it may be gripped, or from
    what it is put down on, whenever; or None. Not known here: where any turn will do, and what rests on frames that
    move against each other. Raises `OutOfTimeError` where the deadline in force passes."""
    for number, step in enumerate(scene.task):
        if not math.isfinite(allowed_m(step)):
            continue
        raise_if_late()
        found = ways(scene, number)
        if isinstance(step, Pick):
            found = () if found[0].turn is None else found
        else:
            found = found[:1] if always(scene, step, found[0].before) else ()
        far = [too_far(prover, number, way.before, way.turn or 0.0, scene.start.time) for way in found]
        refusals = [refusal for refusal in far if refusal is not None]
        if refusals and len(refusals) == len(far):
            return min(refusals, key=lambda refusal: refusal.missing)
    return None


def always(scene: Scene, step: Step, attached: Attachments) -> bool:
    """Whether what the part of a place, or of a pick before which all is `attached`, rests on stays where it is against
    the part: it is named, and all of it is on the part's frame, or neither moves."""
    if not isinstance(step, Pick | Place) or step.contact_with is None:
        return False
    frame, _ = attached.point(scene, step)
    others = {frame, *(attached.pose_of(scene, name)[0] for name in step.contact_with)}
    return len(others) == 1 or all(scene.frames[name].law.is_fixed for name in others)
