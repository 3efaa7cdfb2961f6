"""Bodies that are in the way of the arm wherever it must be: at its start, or on all ways through a control point.

What is found is said twice: as the refusal, and as the witness that the checker can verify.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.nearest import points_between
from assur.planner.checker.refusals.places import Spot, spots
from assur.planner.checker.refusals.stated import Shown
from assur.planner.checker.refusals.ways import Way, each_way
from assur.planner.collision.at_rest import TooNear, Within, closest, enclosed
from assur.planner.collision.proof import Prover
from assur.planner.geometry.shapes import Piece
from assur.planner.legs.control_point import ControlPoint, control_point
from assur.planner.legs.tilt import tilts
from assur.planner.model.attachments import at_start
from assur.planner.model.deadline import look
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase
from assur.planner.model.proofs.witness import Meeting
from assur.planner.model.refusal import Bodies, Enclosed, Quantity, Reason, Refusal, Separation, Stage
from assur.planner.model.scene import Scene
from assur.planner.robots.facts import Code

ROOM_M = 1e-4
"""A straight part that is stated to be long enough is so by this, m."""


@dataclass(frozen=True, slots=True)
class Hit:
    """What is in the way at a spot, in a phase, with the joints q (n,); `way`, `mode`: of a control point (None: it is
    the start)."""

    found: TooNear | Within
    spot: Spot
    phase: Phase
    q: FloatArray
    way: Way | None = None
    mode: str | None = None


def hit_at_start(scene: Scene, prover: Prover, *, hollow: bool = False) -> Hit | None:
    """What the arm collides with where it is at the start, at the clearance of travel; `hollow`: only a mesh that it is
    inside of counts, which is hollow to other proofs."""
    t, q, spot = scene.start.time, scene.start.q, Spot(at_start(scene), LegKind.WAIT, frozenset(), "start")
    phase = Phase(t, t, spot.kind, 0, spot.attached)
    found = enclosed(scene, prover, spot.attached, q, t, spot.contacts)
    near = found or (None if hollow else closest(scene, prover, phase, q, spot.contacts))
    return None if near is None else Hit(near, spot, phase, q)


def hits(scene: Scene, prover: Prover, number: int) -> list[Hit] | None:
    """What is in the way on each way to the control point of a step in each working mode that is allowed; None: on one
    of them nothing is, or it is not known, as the point may be met at another time."""
    found = list[Hit]()
    for way, mode, _ in each_way(scene, number, ()):
        look()
        at = (_in_the_way(scene, prover, way, mode, spot) for spot in spots(scene, number, way.before, way.after))
        hit = next((each for each in at if each is not None), None)
        if hit is None:
            return None
        found.append(hit)
    return found


def posture(scene: Scene, way: Way, mode: str, spot: Spot) -> FloatArray | None:
    """Joints (n,) at a spot in one working mode, the frame of the point being where it is at the start; None: the arm
    does not reach it."""
    flange = point_of(scene, way).flange(np.array([scene.start.time]), spot.above).at_rest()
    solution = scene.robot.inverse(flange, scene.robot.modes.index(mode), 0)
    return solution.q[0] if solution.code[0] in (Code.ASSEMBLED, Code.STRETCHED, Code.FOLDED) else None


def point_of(scene: Scene, way: Way) -> ControlPoint:
    """The control point that a way leads to."""
    tilt = tilts(scene, scene.task[way.number], scene.start.q)[0]
    return control_point(scene, way.number, way.before, way.turn or 0.0, tilt)


def _in_the_way(scene: Scene, prover: Prover, way: Way, mode: str, spot: Spot) -> Hit | None:
    """What is in the way of the flange's bodies at one spot and in one working mode."""
    t, attached, q = scene.start.time, spot.attached, posture(scene, way, mode, spot)
    if q is None:
        return None
    fixed = scene.frames[way.frame].law.is_fixed
    frames = {body.name: attached.pose_of(scene, body.name)[0] for body in scene.bodies}
    among = frozenset(
        name for name, frame in frames.items() if frame == way.frame or (fixed and scene.frames[frame].law.is_fixed)
    )
    tracked = None if spot.kind is LegKind.MOVE else way.frame
    phase = Phase(t, t, spot.kind, way.number, attached, tracked=tracked)
    within = enclosed(scene, prover, attached, q, t, spot.contacts, among) if fixed else None
    found = within or closest(scene, prover, phase, q, spot.contacts, among)
    return None if found is None else Hit(found, spot, phase, q, way, mode)


def refusal_of(scene: Scene, prover: Prover, hit: Hit) -> Refusal:
    """The refusal by what is in the way."""
    facts, short = Enclosed() if isinstance(hit.found, Within) else hit.found.facts, None
    if isinstance(facts, Separation) and facts.gap_m is not None and facts.required_m is not None:
        short = Quantity.of(facts.required_m - facts.gap_m, "m")
        facts = _of_straight_part(scene, prover, hit, facts, facts.required_m - max(facts.gap_m, 0.0))
    subject, t = Bodies(hit.found.names), hit.phase.t0
    if hit.way is None:
        return Shown(Reason.START_IN_COLLISION, facts, short, subject, interval=(t, t)).refusal(Stage.START, 0)
    return Shown(Reason.CONTROL_POINT_IN_COLLISION, facts, short, subject).refusal(Stage.CONTROL_POINT, hit.way.number)


def _of_straight_part(scene: Scene, prover: Prover, hit: Hit, facts: Separation, missing: float) -> Separation:
    """The same facts with the straight part at whose end it is, and with which length that would do."""
    spot = hit.spot
    if spot.end is None or hit.way is None or hit.mode is None:
        return facts
    longer = replace(spot, above=spot.above + missing + ROOM_M)
    enough = _in_the_way(scene, prover, hit.way, hit.mode, longer) is None
    return replace(facts, end=spot.end, straight_m=spot.above, least_m=longer.above if enough else None)


def meeting_of(prover: Prover, hit: Hit) -> Meeting:
    """The witness of what is in the way: a point of each body."""
    if isinstance(hit.found, Within):
        points = (hit.found.point, hit.found.point)
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
        inside=isinstance(hit.found, Within),
    )
