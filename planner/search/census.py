"""Counts refusals: what became of all candidates, by stage, reason and bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from assur.planner.checked import check
from assur.planner.collision.rows import ProofFailure, written
from assur.planner.collision.screening import Encounter
from assur.planner.errors import FaultError
from assur.planner.model.deadline import raise_if_late
from assur.planner.model.outcome import Census, CensusLine, Plan
from assur.planner.model.refusal import (
    Bodies,
    Quantity,
    Reason,
    Refusal,
    Refuted,
    Rule,
    Separation,
    Stage,
    Subject,
    Unit,
    finite,
)
from assur.planner.model.scene import Scene
from assur.planner.search.partial_plan import PartialPlan
from assur.planner.trajectory import Trajectory

_Kind = tuple[Stage, Reason, int, Subject | None, Unit | None]


def kind_of(refusal: Refusal) -> _Kind:
    """What refusals of one line of the census have in common."""
    unit = None if refusal.amount is None else refusal.amount.unit
    return refusal.stage, refusal.reason, refusal.step, refusal.subject, unit


@dataclass(eq=False)
class _Group:
    """Refusals of one kind: how many, the mildest of them, the largest amount, and from when to when they are."""

    mildest: Encounter
    count: int = 0
    most: float | None = None
    span: tuple[float, float] | None = None

    def take(self, encounter: Encounter) -> None:
        """Counts one more."""
        self.count += 1
        refusal, mildest = encounter.refusal, self.mildest.refusal
        if refusal.interval is not None:
            low, high = refusal.interval if self.span is None else self.span
            self.span = min(low, refusal.interval[0]), max(high, refusal.interval[1])
        if refusal.amount is None:
            return
        amount = refusal.amount.value
        self.most = amount if self.most is None else max(self.most, amount)
        if mildest.amount is None or amount < mildest.amount.value:
            self.mildest = encounter

    def line(self, reported: Encounter | None = None) -> CensusLine:
        """The line of the census, with the facts of `reported` (None: of the mildest), confirmed by FCL."""
        least, one = self.mildest.refusal.amount, (reported or self.mildest).confirmed()
        return CensusLine(
            replace(one, interval=self.span), self.count, self.most, None if least is None else least.value
        )


@dataclass(eq=False)
class Counter:
    """Collects refusals of one planning run."""

    candidates: int = 0
    refused: int = 0
    _groups: dict[_Kind, _Group] = field(default_factory=dict)

    def add(self, refusal: Refusal) -> None:
        self.add_all((Encounter(refusal),))

    def add_all(self, encounters: Sequence[Encounter]) -> None:
        """Records one refused candidate and with what it met; those that are reported are confirmed by then."""
        self.refused += 1
        for encounter in encounters:
            self._put(encounter)

    def note(self, refusal: Refusal) -> None:
        """Records a refusal that was not of a candidate (a working mode without a solution, say)."""
        self._put(Encounter(refusal))

    def _put(self, encounter: Encounter) -> None:
        self._groups.setdefault(kind_of(encounter.refusal), _Group(encounter)).take(encounter)

    def census(self, reported: Encounter | None = None) -> Census:
        """All lines, the most frequent first. `reported`: the refusal whose facts its line has."""
        kind = None if reported is None else kind_of(reported.refusal)
        lines = [group.line(reported if key == kind else None) for key, group in self._groups.items()]
        lines.sort(key=lambda line: (-line.count, line.refusal.stage, line.refusal.reason, str(line.refusal.subject)))
        return Census(self.candidates, self.refused, tuple(lines))


def refused_proof(unproved: ProofFailure, step: int, rule: tuple[Rule, float]) -> Refusal:
    """A failed proof as a refusal. `rule`: what requires a distance of the two, and how far, m (`Prover.rule`)."""
    reason = Reason.NOT_CERTIFIED
    if unproved.touching or unproved.gap <= unproved.required:
        reason = Reason.SELF_COLLISION if unproved.of_robot else Reason.BODY_COLLISION
    gap, required = finite(unproved.gap), finite(unproved.required)
    return Refusal(
        stage=Stage.CERTIFICATE,
        reason=reason,
        step=step,
        subject=Bodies(unproved.bodies),
        interval=(unproved.time, unproved.time),
        amount=Quantity.of(unproved.required - unproved.gap, "m"),
        facts=Separation(
            touching=bool(unproved.touching), gap_m=gap, required_m=required, rule=rule[0], clearance_m=rule[1]
        ),
    )


# Makes a plan of a whole partial and has it checked: nothing is an answer that the checker refuses.


def completed(scene: Scene, partial: PartialPlan, *, checked: bool = True) -> Plan | Refusal:
    """The plan of a partial through all steps, with its certificate; a refusal where the checker does not accept it,
    if it is `checked`.

    That is a fault of the planner. The census counts it under the stage `checker`, the sentence of a refusal begins
    with it, and each test and benchmark counts it as a failure. Raises `OutOfTimeError` where the deadline in force
    passes before the checker has accepted it.
    """
    if partial.knots is None:
        raise FaultError("a whole partial without knots")
    jumps = not scene.options.jerk_limited
    trajectory = partial.trajectory or Trajectory.of_knots(partial.knots.table, jumps=jumps)
    certificate = written(scene, trajectory, partial.legs, partial.arrivals, list(partial.proofs))
    plan = Plan(trajectory, partial.legs, partial.arrivals, certificate)
    if not checked:
        return plan
    verdict = check(scene, plan, between=raise_if_late)
    if verdict.ok:
        return plan
    first = verdict.findings[0]
    return Refusal(
        stage=Stage.CHECKER,
        reason=Reason.NOT_CERTIFIED,
        step=partial.step - 1,
        facts=Refuted(code=str(first.code), what=first.what, where=first.where),
    )
