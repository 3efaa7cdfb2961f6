"""What proves a refusal, and whether the checker is convinced by it: nothing else is called proved."""

from __future__ import annotations

from dataclasses import dataclass

from assur.planner.checker.refusals.judging import OBSTRUCTED, check_refusal
from assur.planner.checker.refusals.obstructions import witness_of as obstructions_of
from assur.planner.checker.refusals.ways import ways
from assur.planner.checker.refusals.windows import witness_of as openings_of
from assur.planner.collision.proof import Prover
from assur.planner.feasibility.hits import hit_at_start, hits, meeting_of, ways_of_meeting
from assur.planner.model.refusal import ForbiddenYaw, OutOfReach, Reason, Refusal, Stage
from assur.planner.model.scene import Scene
from assur.planner.model.witness import Overlap, PeriodicReach, Witness


@dataclass(frozen=True, slots=True)
class RefusalProof:
    """A refusal that the checker accepts as proved, by its facts alone or by a witness."""

    witness: Witness | None


def refusal_proof(scene: Scene, prover: Prover, refusal: Refusal) -> RefusalProof | None:
    """What shows that a refusal holds for all times and modes; None: nothing that convinces the checker."""
    witness = _witness(scene, prover, refusal)
    return RefusalProof(witness) if check_refusal(scene, refusal, witness).ok else None


def _witness(scene: Scene, prover: Prover, refusal: Refusal) -> Witness | None:
    """What may show it; None: its facts, or nothing."""
    facts, number = refusal.facts, refusal.step
    if refusal.reason is Reason.START_IN_COLLISION:
        start = hit_at_start(scene, prover)
        return None if start is None else Overlap(ways=(meeting_of(prover, start),))
    if refusal.reason is Reason.CONTROL_POINT_IN_COLLISION:
        found = hits(scene, prover, ways_of_meeting(scene, number))
        return None if found is None else Overlap(ways=tuple(meeting_of(prover, hit) for hit in found))
    if refusal.stage is Stage.WINDOW:
        return openings_of(scene, number)
    if refusal.stage not in (Stage.CONTROL_POINT, Stage.INVERSE) or refusal.reason not in OBSTRUCTED:
        return None
    way = ways(scene, number)[0]
    if way.still(scene) is None:
        lasts, begin, short = scene.frames[way.frame].law.cycle_s, scene.start.time, refusal.amount
        if facts != OutOfReach() or lasts is None or short is None:
            return None
        return PeriodicReach(span_s=(begin, begin + lasts), short_m=short.value)
    by_facts = isinstance(facts, ForbiddenYaw) and refusal.stage is Stage.CONTROL_POINT
    return None if by_facts or (isinstance(facts, OutOfReach) and facts.every_pitch) else obstructions_of(scene, number)
