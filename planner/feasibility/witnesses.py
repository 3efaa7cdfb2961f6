"""What proves a refusal, and whether the checker is convinced by it: nothing else is called proved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.checker.refusals.judging import OBSTRUCTED, check_refusal
from assur.planner.checker.refusals.nearest import points_between
from assur.planner.checker.refusals.obstructions import witness_of as obstructions_of
from assur.planner.checker.refusals.places import spots
from assur.planner.checker.refusals.standing import allowed_modes
from assur.planner.checker.refusals.ways import Way, ways
from assur.planner.checker.refusals.windows import witness_of as openings_of
from assur.planner.collision.at_rest import TooNear, Within, closest, enclosed
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.spots import in_the_way
from assur.planner.geometry.shapes import Piece
from assur.planner.legs.control_point import control_point
from assur.planner.legs.tilt import tilts
from assur.planner.model.attachments import at_start
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase
from assur.planner.model.proofs.witness import Meeting, Met, Orbit, Place, Witness
from assur.planner.model.refusal import ForbiddenYaw, OutOfReach, Reason, Refusal, Stage
from assur.planner.model.scene import Scene


@dataclass(frozen=True, slots=True)
class Shown:
    """A refusal that the checker accepts as proved, by its facts alone or by a witness."""

    witness: Witness | None


def shown(scene: Scene, prover: Prover, refusal: Refusal) -> Shown | None:
    """What shows that a refusal holds for all times and modes; None: nothing that convinces the checker."""
    witness = _witness(scene, prover, refusal)
    return Shown(witness) if check_refusal(scene, refusal, witness).ok else None


def _witness(scene: Scene, prover: Prover, refusal: Refusal) -> Witness | None:
    """What may show it; None: its facts, or nothing."""
    facts = refusal.facts
    if refusal.reason is Reason.START_IN_COLLISION:
        return _at_start(scene, prover)
    if refusal.reason is Reason.CONTROL_POINT_IN_COLLISION:
        return _at_point(scene, prover, refusal.step)
    if refusal.stage is Stage.WINDOW:
        return openings_of(scene, refusal.step)
    if refusal.stage not in (Stage.CONTROL_POINT, Stage.INVERSE) or refusal.reason not in OBSTRUCTED:
        return None
    if isinstance(facts, OutOfReach) and facts.every_pitch:
        return None
    found = ways(scene, refusal.step)
    if any(way.still(scene) is None for way in found):
        return _orbit(scene, refusal, found[0]) if facts == OutOfReach() else None
    if isinstance(facts, ForbiddenYaw) and refusal.stage is Stage.CONTROL_POINT:
        return None
    return obstructions_of(scene, refusal.step)


def _orbit(scene: Scene, refusal: Refusal, way: Way) -> Orbit | None:
    lasts, start = scene.frames[way.frame].law.cycle_s, scene.start.time
    if lasts is None or refusal.amount is None:
        return None
    return Orbit(span_s=(start, start + lasts), short_m=refusal.amount.value)


def _at_start(scene: Scene, prover: Prover) -> Met | None:
    t, q, attached = scene.start.time, scene.start.q, at_start(scene)
    within = enclosed(scene, prover, attached, q, t, frozenset())
    phase = Phase(t, t, LegKind.WAIT, 0, attached)
    near = within or closest(scene, prover, phase, q, frozenset())
    return None if near is None else Met(ways=(_meeting(prover, near, phase, q, None, None, "start"),))


def _at_point(scene: Scene, prover: Prover, number: int) -> Met | None:
    """A pair for each way to a control point and each mode; None: in one of them nothing is found to be in the way."""
    found, names = list[Meeting](), scene.robot.modes
    tilt = tilts(scene, scene.task[number], scene.start.q)[0]
    for way in ways(scene, number):
        point = control_point(scene, number, way.before, way.turn or 0.0, tilt)
        for mode in allowed_modes(scene):
            tried = (
                (spot, in_the_way(scene, prover, point, spot, names.index(mode)))
                for spot in spots(scene, number, way.before, way.after)
            )
            spot, hit = next(((spot, hit) for spot, hit in tried if hit is not None), (None, None))
            if spot is None or hit is None:
                return None
            found.append(_meeting(prover, hit.found, hit.phase, hit.q, mode, way.turn, spot.place))
    return Met(ways=tuple(found))


def _meeting(
    prover: Prover,
    found: TooNear | Within,
    phase: Phase,
    q: FloatArray,
    mode: str | None,
    turn: float | None,
    place: Place,
) -> Meeting:
    if isinstance(found, Within):
        x = found.point
        points, inside = (x, x), True
    else:
        arrangement = prover.of(phase)
        one, other = prover.posed(arrangement, q, phase.t0, np.array(found.units))
        first, second = (Piece(each.shape, each.position.copy(), each.axes.copy()) for each in (one, other))
        a, b = (tuple(point.tolist()) for point in points_between(first, second))
        points, inside = (a, b), False
    return Meeting(mode=mode, turn_rad=turn, place=place, bodies=found.names, points_m=points, inside=inside)
