"""Counts refusals: what became of all candidates, by stage, reason and bodies."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from assur.planner.collision.rows import Unproved
from assur.planner.model.outcome import Census, CensusLine, Reason, Refusal


@dataclass(eq=False)
class Counter:
    """Collects refusals of one planning run."""

    candidates: int = 0
    refused: int = 0
    _groups: dict[tuple[str, Reason, int, tuple[str, ...], str], list[Refusal]] = field(default_factory=dict)

    def add(self, refusal: Refusal) -> None:
        self.refused += 1
        self.note(refusal)

    def note(self, refusal: Refusal) -> None:
        """Records a refusal that was not of a candidate (a working mode without a solution, say)."""
        key = (refusal.stage, refusal.reason, refusal.step, refusal.bodies, refusal.unit)
        self._groups.setdefault(key, []).append(refusal)

    def census(self) -> Census:
        lines = [_line(group) for group in self._groups.values()]
        lines.sort(key=lambda line: (-line.count, line.stage, line.reason, line.bodies))
        return Census(self.candidates, self.refused, tuple(lines))


def _line(group: list[Refusal]) -> CensusLine:
    first = group[0]
    amounts = [r.amount for r in group if math.isfinite(r.amount)]
    spans = [r.interval for r in group if r.interval is not None]
    interval = (min(a for a, _ in spans), max(b for _, b in spans)) if spans else None
    least, most = (min(amounts), max(amounts)) if amounts else (math.nan, math.nan)
    detail = min(group, key=lambda r: r.amount if math.isfinite(r.amount) else math.inf).detail
    return CensusLine(
        first.stage, first.reason, first.step, first.bodies, len(group), interval, least, most, first.unit, detail
    )


def refused_proof(unproved: Unproved, step: int) -> Refusal:
    """A failed proof as a refusal."""
    reason = Reason.NOT_CERTIFIED
    if unproved.touching or unproved.gap <= unproved.required:
        reason = Reason.SELF_COLLISION if unproved.of_robot else Reason.BODY_COLLISION
    amount = unproved.required - unproved.gap
    detail = "touch" if unproved.touching else "too close" if reason is not Reason.NOT_CERTIFIED else "not proved"
    span = (unproved.time, unproved.time)
    return Refusal("certificate", reason, step, unproved.bodies, span, amount, "m", detail)
