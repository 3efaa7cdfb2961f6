"""Refuses colliding candidates: a kernel finds an instant at which something is too near.

The instants are the middles of intervals that are halved, as in a proof, whose bounds leave out all instants at which a
pair cannot be too near. What passes is not yet proved. For what is reported, FCL decides whether true shapes touch.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from operator import itemgetter
from typing import Protocol

import numpy as np

from assur.planner.arrays import FloatArray
from assur.planner.collision.proof import Prover, Search
from assur.planner.collision.rows import ProofFailure
from assur.planner.kernels.interval_search import SCREEN
from assur.planner.kernels.intervals import DONE, HIT, RESERVE_M, RESISTED
from assur.planner.kernels.screening import HIT_A, HIT_B, HIT_GAP, HIT_NEED, HIT_S, HIT_T
from assur.planner.kernels.solids import FIRST, REQUIRED, SECOND
from assur.planner.kernels.spline import Spline, spline_state
from assur.planner.model.assembly_mode import leaves_assembly
from assur.planner.model.phases import Phase
from assur.planner.model.refusal import Bodies, Quantity, Reason, Refusal, Separation, Stage
from assur.planner.trajectory import Trajectory

EXACT_M = 1e-6
"""Gaps that differ by no more are one, m: GJK is near enough by then."""
MOST_BODIES = 3
"""Most bodies that are reported for one candidate: one refuses it, the others are reported in the census."""


class PhasedMotion(Protocol):
    """A timed motion in phases."""

    @property
    def phases(self) -> tuple[Phase, ...]: ...

    @property
    def trajectory(self) -> Trajectory:
        """Before it and after it the arm stands still."""
        ...


@dataclass(frozen=True, slots=True)
class Encounter:
    """Why a candidate is refused: with one body, at one instant. `refusal` takes what is not shown to be apart for a
    touch, and the gap along the normal that counts, errors included, for that of the two where they are planned;
    `confirmed` asks FCL about the true shapes, and evaluates the gap without errors: that takes longer than all the
    rest of a screening."""

    refusal: Refusal
    touches: Callable[[], bool] | None = None
    """Asks FCL; None: there is nothing to ask."""
    planned: Callable[[], float] | None = None
    """The gap where both are where they are planned, m; None: it is the gap."""

    def confirmed(self) -> Refusal:
        """The refusal, which says whether the true shapes touch, and how far they are apart as planned. What is missing
        stays as it is."""
        facts = self.refusal.facts
        if not isinstance(facts, Separation):
            return self.refusal
        if self.touches is not None:
            facts = replace(facts, touching=self.touches())
        if self.planned is not None and facts.gap_m is not None and facts.required_m is not None:
            more = self.planned() - facts.gap_m
            if more > EXACT_M:
                facts = replace(facts, gap_m=facts.gap_m + more, required_m=facts.required_m + more)
        return replace(self.refusal, facts=facts)


@dataclass(frozen=True, slots=True)
class ScreeningResult:
    """What became of a candidate: the encounters at the instant for which it is refused, the deepest first; or none."""

    encounters: tuple[Encounter, ...] = ()

    @property
    def refusal(self) -> Refusal | None:
        """Why it is refused, as the search sees it."""
        return self.encounters[0].refusal if self.encounters else None


def screen(prover: Prover, candidate: PhasedMotion) -> ScreeningResult:
    """What is in the way of a candidate."""
    lost = leaves_assembly(prover.scene.robot, candidate.phases[0].step, candidate.trajectory)
    if lost is not None:
        return ScreeningResult((Encounter(replace(lost, stage=Stage.SCREENING)),))
    for phase in candidate.phases:
        hits = prover.screened(phase, candidate.trajectory)
        if len(hits):
            return _refused(prover, phase, candidate.trajectory.spline, hits)
    return ScreeningResult()


def _refused(prover: Prover, phase: Phase, spline: Spline, hits: FloatArray) -> ScreeningResult:
    """Hits (H, HIT_COLUMNS) at an instant: the deepest with each body of the surroundings."""
    body, deepest = prover.of(phase).body, dict[int, list[float]]()
    for row in hits.tolist():
        other = int(body[int(row[HIT_B])])
        if other not in deepest or row[HIT_GAP] < deepest[other][HIT_GAP]:
            deepest[other] = row
    order = sorted(deepest.values(), key=itemgetter(HIT_GAP))[:MOST_BODIES]
    q = np.empty(spline[1].shape[1])
    spline_state(spline, order[0][HIT_T], q)
    return ScreeningResult(tuple([_encounter(prover, phase, row, q) for row in order]))


def _encounter(prover: Prover, phase: Phase, hit: list[float], q: FloatArray) -> Encounter:
    """A hit with one body, joints at q (n,)."""
    arrangement, one, other, t = prover.of(phase), int(hit[HIT_A]), int(hit[HIT_B]), hit[HIT_T]
    first, second = int(arrangement.body[one]), int(arrangement.body[other])
    names, roots = arrangement.names, arrangement.roots
    # the standstill after the last leg belongs to the last step
    step = phase.step if phase.step >= 0 else len(prover.scene.task) - 1
    gap, required = hit[HIT_GAP], hit[HIT_NEED] - RESERVE_M
    rule, clearance = prover.pairs_of(phase).rule(int(roots[first]), int(roots[second]))
    refusal = Refusal(
        stage=Stage.SCREENING,
        reason=Reason.SELF_COLLISION if arrangement.of_robot[second] else Reason.BODY_COLLISION,
        step=step,
        subject=Bodies((names[first], names[second])),
        interval=(t, t),
        amount=Quantity.of(max(0.0, required - gap), "m"),
        facts=Separation(touching=not gap > 0.0, gap_m=gap, required_m=required, rule=rule, clearance_m=clearance),
    )
    # what has a gap does not touch
    touches = None if gap > 0.0 else partial(prover.touching, arrangement, q, t, one, other, hit[HIT_S])
    known = not required > clearance
    return Encounter(
        refusal, touches, None if known else partial(prover.planned_gap, phase, q, t, one, other, hit[HIT_S])
    )


# How deep a pair that may touch is pressed together: where a straight part begins or ends, which no screening sees.


def deepest(prover: Prover, phase: Phase, trajectory: Trajectory, unproved: ProofFailure) -> ProofFailure:
    """A pair that may touch and was not proved in a phase, where it is deepest: there, or at an end of the phase."""
    arrangement, spline = prover.of(phase), trajectory.spline
    pairs = prover.pairs_of(phase)
    body = arrangement.body[pairs.rows[:, [FIRST, SECOND]].astype(np.int64)]
    ours = [arrangement.number[name] for name in unproved.bodies]
    touching = pairs.rows[(body == ours).all(1) & (pairs.rows[:, REQUIRED] < 0.0)]
    for t in (phase.t0, phase.t1) if len(touching) else ():
        search = Search(prover, replace(phase, t0=t, t1=t), spline, touching, pairs.errors, most_hits=len(touching))
        while search.go_on(SCREEN) not in (DONE, HIT, RESISTED) and not search.over:
            pass
        for hit in search.too_near:
            gap, need = float(hit[HIT_GAP]), float(hit[HIT_NEED]) - RESERVE_M
            if not gap - need >= unproved.gap - unproved.required:
                touch = prover.touch(arrangement, spline, t, int(hit[HIT_A]), int(hit[HIT_B]), float(hit[HIT_S]))
                unproved = replace(unproved, time=t, gap=gap, required=need, touching=touch)
    return unproved
