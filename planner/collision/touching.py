"""How far a tool is from the part that it takes, and a part from what it is put down on, when it changes hands.

The tool and what it holds are rigid, so a pick needs no time: what counts is how the part sits in the gripper.
Distances are those of the convex pieces in proofs; a mesh is hollow.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from assur.planner.collision.nearest import nearest_at, pairs_of_pieces
from assur.planner.collision.proof import Prover
from assur.planner.model.attachments import Attachments
from assur.planner.model.outcome import Arrival
from assur.planner.model.phases import contacts_of
from assur.planner.model.refusal import Bodies, NotTouching, Quantity, Reason, Refusal, Stage
from assur.planner.model.scene import Pick, Place, Scene, Step

TOUCH_M = 1e-6
"""Bodies this near, m, count as touching where they must touch: faces that lie on each other are computed some
roundings apart, and the tool meets its part within as much."""


@dataclass(frozen=True, slots=True)
class Nearest:
    """How far two bodies are apart at most, m; 0: they meet. `bodies`: of a grip the tool's and the part, of a support
    the part and what it is put down on."""

    distance_m: float
    bodies: tuple[str, str]


def grip(prover: Prover, step: Pick, attached: Attachments, yaw_offset: float) -> Nearest | None:
    """How far the tool's bodies are from the part of a pick that is taken with the tool turned by `yaw_offset`, rad,
    `attached` being so before; None: the tool has no bodies."""
    scene = prover.scene
    tool = [body.name for body in scene.tool.bodies]
    holding = attached.after(scene, step, yaw_offset)
    return _nearest(prover, holding, scene.start.time, [(name, step.part) for name in tool])


def supports(scene: Scene, step: Place, attached: Attachments, t: float) -> tuple[str, ...]:
    """What the part of a place may rest on when it is put down at time t, s, in the order of the names."""
    rest, _ = contacts_of(scene, step, attached, t)
    return tuple(sorted(name for names in rest for name in names if name != step.part))


def nearest_support(prover: Prover, step: Place, attached: Attachments, t: float) -> Nearest | None:
    """How far the part of a place is from the nearest body that it may rest on when it is put down at time t, s,
    `attached` being so before; None: there is none, or where they are then is not known."""
    names = supports(prover.scene, step, attached, t)
    return _nearest(prover, attached.after(prover.scene, step), t, [(step.part, name) for name in names])


def apart(prover: Prover, attached: Attachments, t: float, one: str, other: str) -> float:
    """How far two bodies are apart at most, m, at time t, s, the robot being as at the start; NaN: where they are then
    is not known."""
    found = _nearest(prover, attached, t, [(one, other)])
    return math.nan if found is None else found.distance_m


def touching(prover: Prover, attached: Attachments, arrival: Arrival) -> Arrival | Refusal:
    """An arrival, before whose step all is `attached`, with how far tool or support are from the part; or why that is
    too far."""
    step = prover.scene.task[arrival.step]
    found, facts = _measured(prover, step, attached, arrival.yaw_offset, arrival.until)
    if found is None:
        return arrival
    if facts is not None:
        return refused(Stage.TRACKING, arrival.step, found, facts)
    if isinstance(step, Pick):
        return replace(arrival, grip_m=found.distance_m)
    return replace(arrival, support_m=found.distance_m)


def too_far(prover: Prover, number: int, attached: Attachments, yaw_offset: float, t: float) -> Refusal | None:
    """Whether step `number`, before which all is `attached`, leaves its part too far from tool or support, with the
    tool turned by `yaw_offset`, rad, and the part put down at time t, s."""
    found, facts = _measured(prover, prover.scene.task[number], attached, yaw_offset, t)
    return None if found is None or facts is None else refused(Stage.CONTROL_POINT, number, found, facts)


def allowed_m(step: Step) -> float:
    """How far tool or support may be from the part of a step, m; inf: without a limit."""
    if isinstance(step, Pick):
        return step.grip_within_m
    return step.support_within_m if isinstance(step, Place) else math.inf


def refused(stage: Stage, number: int, found: Nearest, facts: NotTouching) -> Refusal:
    """A refusal of step `number` for what is too far apart."""
    return Refusal(
        stage=stage,
        reason=Reason.TOLERANCE,
        step=number,
        subject=Bodies(found.bodies),
        amount=Quantity.of(facts.distance_m - facts.allowed_m, "m"),
        facts=facts,
    )


def _measured(
    prover: Prover, step: Step, attached: Attachments, yaw_offset: float, t: float
) -> tuple[Nearest | None, NotTouching | None]:
    """What is nearest, and the facts of what is too far."""
    found = None
    if isinstance(step, Pick):
        found = grip(prover, step, attached, yaw_offset)
    elif isinstance(step, Place):
        found = nearest_support(prover, step, attached, t)
    if found is None or found.distance_m <= allowed_m(step) + TOUCH_M:
        return found, None
    of = "grip" if isinstance(step, Pick) else "support"
    return found, NotTouching(of=of, distance_m=found.distance_m, allowed_m=allowed_m(step))  # type: ignore[arg-type]


def _nearest(prover: Prover, attached: Attachments, t: float, pairs: list[tuple[str, str]]) -> Nearest | None:
    """The nearest of pairs of bodies."""
    arrangement = prover.arrangement(attached)
    bodies = [(arrangement.number[one], arrangement.number[other]) for one, other in pairs]
    found, units = nearest_at(prover, arrangement, prover.scene.start.q, t, pairs_of_pieces(arrangement, bodies))
    if not math.isfinite(found):
        return None
    first, second = (arrangement.names[arrangement.body[unit]] for unit in units)
    return Nearest(found, (first, second))
