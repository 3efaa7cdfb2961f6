"""Where the flange is on every way through a control point, and what may touch there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from assur.planner.model.attachments import Attachments
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Contacts, contacts_of
from assur.planner.model.proofs.witness import Place
from assur.planner.model.scene import Scene


@dataclass(frozen=True, slots=True)
class Spot:
    """The flange `above` a point, m, in a phase of this kind, with bodies as `attached` has them and pairs that may
    touch; `end`: of which straight part it is the outer end. `place`: what a witness calls it."""

    attached: Attachments
    kind: LegKind
    contacts: Contacts
    place: Place
    above: float = 0.0
    end: Literal["approach", "depart"] | None = None


def spots(scene: Scene, number: int, before: Attachments, after: Attachments) -> list[Spot]:
    """Where the flange is on every way through the point of a step, whatever comes before and after it: at the point,
    before and after the part is taken or put down, and at the outer ends of the straight parts, where travel ends and
    begins."""
    step, nothing = scene.task[number], Contacts()
    if not step.tracks:
        return [Spot(before, LegKind.MOVE, nothing, "point")]
    first, behind = contacts_of(scene, step, before, None)
    found = [Spot(before, LegKind.FOLLOW, first, "point")]
    if step.part is not None:
        approach, depart = scene.straight(step)
        found += [
            Spot(after, LegKind.DEPART, behind, "behind"),
            Spot(before, LegKind.MOVE, nothing, "approach", approach, "approach"),
        ]
        if number + 1 < len(scene.task):
            found.append(Spot(after, LegKind.MOVE, nothing, "depart", depart, "depart"))
    return found
