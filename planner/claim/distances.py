"""Rows that show that bodies are as near as is stated, and rows that show that no pairs are nearer."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from assur.planner.claim import columns as c
from assur.planner.collision.nearest import nearest_at, pairs_of_pieces, simplex
from assur.planner.collision.proof import Prover
from assur.planner.collision.rows import Rows, written
from assur.planner.collision.touching import allowed_m, supports
from assur.planner.model.claims import Claims
from assur.planner.model.outcome import Arrival, Certificate, LegKind, Nearest, Plan
from assur.planner.model.phases import Phase, pair
from assur.planner.model.scene import Pick, Place, Scene

WITHIN_M = 5e-5
"""By how much a smallest clearance, and how far a part is from tool or support, may be off, m: the promise of the
planner, 0.05 mm."""
TIME_S = 1e-9
"""Times that are written in a document and read again may be off by this, s."""
Row = tuple[float, ...]


def is_limited(scene: Scene) -> bool:
    """Whether a step limits how far its part may be from tool or support."""
    return any(math.isfinite(allowed_m(step)) for step in scene.task)


class Distances(NamedTuple):
    """Writes the rows of a plan. `number`: the rows of bodies by name; `phases`: those of the plan."""

    prover: Prover
    number: dict[str, int]
    plan: Plan
    phases: Sequence[Phase]

    def required(self) -> list[Row]:
        """Grips and supports of the steps that limit how far they may be."""
        limits = [(arrival, allowed_m(self.prover.scene.task[arrival.step])) for arrival in self.plan.arrivals]
        return [row for arrival, most in limits if math.isfinite(most) for row in self._touching(arrival, most)]

    def stated(self, claims: Claims) -> list[Row]:
        """Grips and supports that arrivals state, and pairs that an answer names with their clearance."""
        found = list[Row]()
        for arrival in self.plan.arrivals:
            is_pick = isinstance(self.prover.scene.task[arrival.step], Pick)
            stated = arrival.grip_m if is_pick else arrival.support_m
            if stated is not None:
                found += self._touching(arrival, stated)
        smallest = [each[0] for each in (claims.nearest, claims.placed) if each is not None]
        for each in (*(one for one in smallest if one is not None), *claims.pairs):
            found += self._named(each)
        return found

    def _touching(self, arrival: Arrival, most: float) -> list[Row]:
        """How near a part is to tool or support when it changes hands: at the end of its FOLLOW."""
        scene, step = self.prover.scene, self.prover.scene.task[arrival.step]
        for p, phase in enumerate(self.phases):
            if phase.step == arrival.step and phase.kind is LegKind.FOLLOW and isinstance(step, Pick | Place):
                others: Iterable[str] = (body.name for body in scene.tool.bodies)
                if isinstance(step, Place):
                    others = supports(scene, step, phase.attached, phase.t1)
                return self._row(p, phase.t1, [(other, step.part) for other in others], most)
        return []

    def _named(self, each: Nearest) -> list[Row]:
        """How near the bodies that are named are at the time and in the phase that are stated: the nearest of all
        phases of this kind which that time is in."""
        rows = list[Row]()
        for p, phase in enumerate(self.phases):
            if phase.kind == each.phase and phase.t0 - TIME_S <= each.time <= phase.t1 + TIME_S:
                known = all(name in self.number for name in each.bodies) and pair(*each.bodies) not in phase.contacts
                rows += self._row(
                    p, min(max(each.time, phase.t0), phase.t1), [each.bodies] if known else [], each.gap_m
                )
        return rows

    def _row(self, p: int, t: float, pairs: Iterable[tuple[str, str]], most: float) -> list[Row]:
        """The row of the nearest of some pairs at an instant of phase number `p`; none where it is not so near."""
        arrangement, path = self.prover.of(self.phases[p]), self.plan.trajectory
        q = path.evaluate(min(max(t, path.start), path.end))
        bodies = [(arrangement.number[one], arrangement.number[other]) for one, other in pairs]
        _, units = nearest_at(self.prover, arrangement, q, t, pairs_of_pieces(arrangement, bodies))
        if units == (0, 0):
            return []  # there is no pair, or its places are not known
        shown = simplex(arrangement, self.prover.carriers(q, t), *units)
        if not shown.distance_m <= most + WITHIN_M:
            return []
        of_claim = [self.number[arrangement.names[body]] for body in arrangement.body[list(units)]]
        pieces = arrangement.piece[list(units)].tolist()
        numbers = (*shown.weights.tolist(), *shown.directions.ravel().tolist())
        return [(t, p, *of_claim, *pieces, most + WITHIN_M, *numbers)]


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


def least_of(stated: tuple[Nearest | None] | None) -> float:
    """The second distance that is required for a smallest clearance that is stated, as a claim has it: -1 for none, and
    where there is no such pair `LIMITLESS`. A clearance within rounding of 0 is one that all pairs keep anyway."""
    if stated is None:
        return -1.0
    if stated[0] is None:
        return c.LIMITLESS
    least = stated[0].gap_m - WITHIN_M
    return least if least > 0.0 else -1.0
