"""Rows that show that bodies are as near as is stated, and rows that show that no pairs are nearer."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from assur.planner.claim import columns as c
from assur.planner.collision.nearest import nearest_at, pairs_of_pieces
from assur.planner.collision.proof import Prover
from assur.planner.collision.rows import Rows, written
from assur.planner.collision.simplex import simplex
from assur.planner.collision.touching import asked, supports
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import Arrival, Certificate, LegKind, Nearest, Plan
from assur.planner.model.phases import Phase, pair
from assur.planner.model.scene import Pick, Place, Scene
from assur.planner.trajectory import Trajectory

WITHIN_M = 5e-5
"""By how much a smallest clearance, and how far a part is from tool or support, may be off, m: the promise of the
planner, 0.05 mm."""
TIME_S = 1e-9
"""Times that are written in a document and read again may be off by this, s."""
Row = tuple[float, ...]


def is_limited(scene: Scene) -> bool:
    """Whether a step limits how far its part may be from tool or support."""
    return any(math.isfinite(asked(step)) for step in scene.task)


def required_of(prover: Prover, number: dict[str, int], plan: Plan, phases: Sequence[Phase]) -> list[Row]:
    """Grips and supports of the steps that limit how far they may be. `number`: the rows of bodies."""
    limits = [(arrival, asked(prover.scene.task[arrival.step])) for arrival in plan.arrivals]
    return [
        row
        for arrival, most in limits
        if math.isfinite(most)
        for row in _touching(prover, number, plan, phases, arrival, most)
    ]


def stated_of(prover: Prover, number: dict[str, int], plan: Plan, phases: Sequence[Phase], claims: Claims) -> list[Row]:
    """Grips and supports that arrivals state, and pairs that an answer names with their clearance."""
    found = list[Row]()
    for arrival in plan.arrivals:
        stated = arrival.grip_m if isinstance(prover.scene.task[arrival.step], Pick) else arrival.support_m
        if stated is not None:
            found += _touching(prover, number, plan, phases, arrival, stated)
    smallest = [said[0] for said in (claims.nearest, claims.placed) if said is not None]
    for each in (*(one for one in smallest if one is not None), *claims.pairs):
        found += _named(prover, number, plan, phases, each)
    return found


def _touching(
    prover: Prover, number: dict[str, int], plan: Plan, phases: Sequence[Phase], arrival: Arrival, most: float
) -> list[Row]:  # fmt: skip
    """How near a part is to tool or support when it changes hands: at the end of its FOLLOW."""
    scene, step = prover.scene, prover.scene.task[arrival.step]
    for p, phase in enumerate(phases):
        if phase.step == arrival.step and phase.kind is LegKind.FOLLOW and isinstance(step, Pick | Place):
            others = [body.name for body in scene.tool.bodies]
            if isinstance(step, Place):
                others = list(supports(scene, step, phase.attached, phase.t1))
            pairs = [(other, step.part) for other in others]
            return _row(prover, number, plan.trajectory, phase, p, phase.t1, pairs, most + WITHIN_M)
    return []


def _named(prover: Prover, number: dict[str, int], plan: Plan, phases: Sequence[Phase], each: Nearest) -> list[Row]:
    """How near the bodies that are named are at the time and in the phase that are stated: the nearest of all phases
    of this kind which that time is in."""
    rows = list[Row]()
    for p, phase in enumerate(phases):
        if phase.kind == each.phase and phase.t0 - TIME_S <= each.time <= phase.t1 + TIME_S:
            known = all(name in number for name in each.bodies) and pair(*each.bodies) not in phase.contacts
            t = min(max(each.time, phase.t0), phase.t1)
            pairs = [each.bodies] if known else []
            rows += _row(prover, number, plan.trajectory, phase, p, t, pairs, each.gap_m + WITHIN_M)
    return rows


def _row(
    prover: Prover, number: dict[str, int], path: Trajectory, phase: Phase, p: int, t: float,
    pairs: Iterable[tuple[str, str]], most: float,
) -> list[Row]:  # fmt: skip
    """The row of the nearest of some pairs at an instant of phase number `p`; none where it is not so near."""
    arrangement, q = prover.of(phase), path.evaluate(min(max(t, path.start), path.end))
    bodies = [(arrangement.number[one], arrangement.number[other]) for one, other in pairs]
    _, units = nearest_at(prover, arrangement, q, t, pairs_of_pieces(arrangement, bodies))
    if units == (0, 0):
        return []  # there is no pair, or its places are not known
    shown = simplex(arrangement, prover.carriers(q, t), *units)
    if not shown.distance_m <= most:
        return []
    names = [arrangement.names[body] for body in arrangement.body[list(units)]]
    pieces = arrangement.piece[list(units)].tolist()
    return [
        (
            t,
            p,
            *(number[name] for name in names),
            *pieces,
            most,
            *shown.weights.tolist(),
            *shown.directions.ravel().tolist(),
        )
    ]


def proofs_of(prover: Prover, plan: Plan, phases: Sequence[Phase], least: tuple[float, float]) -> Certificate | None:
    """Rows that show that pairs with a body of the robot, and pairs with a part that was put down, are nowhere nearer
    than `least`, m, where all is where it is planned (-1: nothing is required). None where nothing needs a row, or can
    be shown in no phase."""
    arm, placed = (-1.0 if each == c.LIMITLESS else each for each in least)
    if max(arm, placed) < 0.0:
        return None
    proofs = [prover.prove_gaps(phase, plan.trajectory, arm, placed) for phase in phases]
    shown = [rows for rows in proofs if isinstance(rows, Rows)]
    return written(prover.scene, plan.trajectory, plan.legs, plan.arrivals, shown) if shown else None


def least_of(said: tuple[Nearest | None] | None) -> float:
    """The second distance that is required for a smallest clearance that is stated, as a claim has it: -1 for none, and
    where there is no such pair `LIMITLESS`. A clearance within rounding of 0 is one that all pairs keep anyway."""
    if said is None:
        return -1.0
    if said[0] is None:
        return c.LIMITLESS
    least = said[0].gap_m - WITHIN_M
    return least if least > 0.0 else -1.0
