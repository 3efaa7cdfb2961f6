"""Counts refusals: what became of all candidates, by stage, reason and bodies."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from assur.planner.collision.rows import Unproved
from assur.planner.collision.screening import Encounter
from assur.planner.model.outcome import Census, CensusLine
from assur.planner.model.refusal import Bodies, Quantity, Reason, Refusal, Separation, Stage, Subject, Unit, finite

_Kind = tuple[Stage, Reason, int, Subject | None, Unit | None]


@dataclass(eq=False)
class Counter:
    """Collects refusals of one planning run."""

    candidates: int = 0
    refused: int = 0
    _groups: dict[_Kind, list[Encounter]] = field(default_factory=dict)

    def add(self, refusal: Refusal) -> None:
        self.add_all((Encounter(refusal),))

    def add_all(self, encounters: Sequence[Encounter]) -> None:
        """Records one refused candidate and with what it met; those that are told are confirmed by then."""
        self.refused += 1
        for encounter in encounters:
            self._put(encounter)

    def note(self, refusal: Refusal) -> None:
        """Records a refusal that was not of a candidate (a working mode without a solution, say)."""
        self._put(Encounter(refusal))

    def _put(self, encounter: Encounter) -> None:
        refusal = encounter.refusal
        unit = None if refusal.amount is None else refusal.amount.unit
        key = (refusal.stage, refusal.reason, refusal.step, refusal.subject, unit)
        self._groups.setdefault(key, []).append(encounter)

    def census(self) -> Census:
        lines = [_line(group) for group in self._groups.values()]
        lines.sort(key=lambda line: (-line.count, line.refusal.stage, line.refusal.reason, str(line.refusal.subject)))
        return Census(self.candidates, self.refused, tuple(lines))


def _line(group: list[Encounter]) -> CensusLine:
    amounts = [r.amount.value for r in (each.refusal for each in group) if r.amount is not None]
    spans = [each.refusal.interval for each in group if each.refusal.interval is not None]
    interval = (min(a for a, _ in spans), max(b for _, b in spans)) if spans else None
    mildest = min(group, key=_amount).confirmed()
    return CensusLine(replace(mildest, interval=interval), len(group), max(amounts, default=None))


def _amount(encounter: Encounter) -> float:
    amount = encounter.refusal.amount
    return math.inf if amount is None else amount.value


def refused_proof(unproved: Unproved, step: int) -> Refusal:
    """A failed proof as a refusal."""
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
        facts=Separation(touching=bool(unproved.touching), gap_m=gap, required_m=required),
    )
