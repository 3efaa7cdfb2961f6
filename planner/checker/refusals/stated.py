"""Whether a refusal states what was shown: the checker derives what is right, and compares all that both state."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Literal, NamedTuple

from assur.planner.model.attachments import Attachments
from assur.planner.model.outcome import LegKind
from assur.planner.model.phases import Contacts, contacts_of
from assur.planner.model.refusal import (
    Facts,
    FrameName,
    JointName,
    LawEnds,
    Quantity,
    Reason,
    Refusal,
    Stage,
    Subject,
    finite,
    of_joint,
)
from assur.planner.model.scene import Scene
from assur.planner.model.witness import Place

Span = tuple[float, float]
SAME = 1e-9
"""Two numbers that differ by no more than this share of them, or this, are the same: sums of a few terms."""
OPTIONAL = frozenset({"mode", "from_axis_m", "heights_m", "pitch_rad", "path_m", "path_part", "path_at_m"})
"""Facts that a refusal may leave out (None)."""
ANGLES = frozenset({"yaw_rad"})
"""Facts whose full turns do not count."""


class Proof(NamedTuple):
    """What is right of a stage and a step, and by how much the numbers of a refusal that states it may differ (as
    `same` has it)."""

    reason: Reason
    facts: Facts
    amount: Quantity | None = None
    subject: Subject | None = None
    within: float = SAME
    interval: tuple[float, float] | None = None

    def refusal(self, stage: Stage, step: int) -> Refusal:
        """The refusal of this stage and step that states it."""
        reason, facts, amount, subject, _, interval = self
        return Refusal(
            stage=stage, reason=reason, step=step, subject=subject, interval=interval, amount=amount, facts=facts
        )


def law_ends(
    frame: str, known: Span, needed: float, tracked: float | None = None, interval: Span | None = None, by: float = SAME
) -> Proof:
    """The motion of a frame is known on `known`, s, and not at `needed`; `tracked`: as in `LawEnds`."""
    facts = LawEnds(known_s=(finite(known[0]), finite(known[1])), needed_s=needed, tracked_s=tracked)
    over = Quantity(max(known[0] - needed, needed - known[1]), "s")
    return Proof(Reason.LAW_ENDS, facts, over, FrameName(frame), by, interval)


def exceeded(
    scene: Scene, reason: Reason, joint: int, over: float, facts: Facts, order: int = 0, by: float = SAME
) -> Proof:
    """A joint, by its index, exceeds its range (order 0) or a limit of a rate by `over`, rad or m, and per s."""
    of = scene.robot.joints[joint]
    return Proof(reason, facts, of_joint(of.kind, over, order), JointName(of.name), by)


class NotShownError(Exception):
    """A refusal is not shown to be right; the message says what is missing."""


def same(one: float | None, other: float | None, by: float = SAME) -> bool:
    """Whether two numbers are the same up to rounding; none is the same as none."""
    if one is None or other is None:
        return one is other
    return one == other or (math.isfinite(other) and abs(one - other) <= by * max(1.0, abs(other)))


def states(given: Refusal, shown: Proof) -> bool:
    """Whether a given refusal states what is shown of its stage and step. It may leave out its interval and the facts
    in `OPTIONAL`."""
    if (given.reason, given.subject, type(given.facts)) != (shown.reason, shown.subject, type(shown.facts)):
        return False
    amount, true = (None if each is None else (each.value, each.unit) for each in (given.amount, shown.amount))
    pairs: list[tuple[object, object]] = [(amount, true), (given.interval or shown.interval, shown.interval)]
    for name in (each.name for each in fields(given.facts)):
        one, other = getattr(given.facts, name), getattr(shown.facts, name)
        if name in ANGLES:
            one, other = math.remainder(one - other, math.tau), 0.0
        pairs += [(one, other)] * (one is not None or name not in OPTIONAL)
    return all(_is_alike(one, other, shown.within) for one, other in pairs)


def _is_alike(one: object, other: object, by: float) -> bool:
    """Whether two values of a fact are the same, number by number."""
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(_is_alike(a, b, by) for a, b in zip(one, other, strict=True))
    if isinstance(one, float | int) and isinstance(other, float | int) and not isinstance(one, bool):
        return same(one, other, by)
    return one == other


# Where the flange is on every way through a control point, and what may touch there.


@dataclass(frozen=True, slots=True)
class Spot:
    """The flange `above` a point, m, in a phase of this kind, with bodies as `attached` has them and pairs that may
    touch; `end`: the straight part whose outer end it is. `place`: what a witness calls it."""

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
