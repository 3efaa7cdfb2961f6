"""Whether tool or support are too far from the part of a step, however the part is turned and whenever it is taken."""

from __future__ import annotations

import math

from assur.planner.checker.claims.touching import distance_between, pair_of
from assur.planner.checker.doubts import stands
from assur.planner.checker.nearest import WITHIN_M
from assur.planner.checker.refusals.standing import standing
from assur.planner.checker.refusals.start import amount_of, same
from assur.planner.checker.refusals.ways import Way, ways
from assur.planner.checker.rows import Apart
from assur.planner.checker.solids import solids
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Phase
from assur.planner.model.proofs.witness import PROVED_M
from assur.planner.model.refusal import NotTouching, Refusal
from assur.planner.model.scene import Pick, Place, Scene


def never_touching(scene: Scene, refusal: Refusal, facts: NotTouching) -> str:
    """Why it is not shown that the part of a step is too far from the tool that takes it, or from what it is put down
    on; nothing: it is. What is said must be the distance in the turn in which it is least."""
    step = scene.task[refusal.step]
    if isinstance(step, Pick):
        of, allowed = "grip", step.grip_within_m
    elif isinstance(step, Place):
        of, allowed = "support", step.support_within_m
    else:
        return "no part changes hands"
    if facts.of != of or facts.allowed_m != allowed or not same(amount_of(refusal), facts.distance_m - allowed):
        return "the request allows another distance"
    least, named = math.inf, math.inf
    world = standing(scene, scene.start.q)
    for way in ways(scene, refusal.step):
        others = _others(scene, step, way)
        if way.turn is None or not others:
            return "where the part is then is not known for all turns and times"
        phase = Phase(scene.start.time, scene.start.time, LegKind.FOLLOW, refusal.step, way.after)
        apart = Apart.of(scene, (phase,), solids(scene, (phase,)), world.tables)
        for other in others:
            pair = pair_of(apart.table, 0, other, step.part)
            low, _ = distance_between(pair, phase.t0, apart.tables, allowed + PROVED_M)
            if not low > allowed + PROVED_M:
                return f"{other} is not shown to be too far from {step.part}"
            low, _ = distance_between(pair, phase.t0, apart.tables, facts.distance_m - WITHIN_M)
            _, high = distance_between(pair, phase.t0, apart.tables, facts.distance_m + WITHIN_M)
            least = min(least, low)
            if {other, step.part} == set(refusal.bodies):
                named = min(named, high)
    told = facts.distance_m - least <= WITHIN_M and named - facts.distance_m <= WITHIN_M
    return "" if told else "another distance, or that of other bodies, is the least"


def _others(scene: Scene, step: Pick | Place, way: Way) -> tuple[str, ...]:
    """Of a pick the tool's bodies; of a place what the part is put down on, where it never moves against it."""
    if isinstance(step, Pick):
        return tuple(body.name for body in scene.tool.bodies)
    names = step.contact_with or ()
    frames = {way.after.pose_of(scene, name)[0] for name in names} | {way.frame}
    alike = len(frames) == 1 or all(stands(scene.frames[name].law) for name in frames)
    return names if alike else ()
