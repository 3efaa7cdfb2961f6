"""Grips and supports that are farther from their part than the request allows, whenever and however the arm comes."""

from __future__ import annotations

import math

from assur.planner.checker.refusals.ways import ways
from assur.planner.collision.proof import Prover
from assur.planner.collision.touching import asked, too_far
from assur.planner.model.attachments import Attachments
from assur.planner.model.deadline import look
from assur.planner.model.refusal import Refusal
from assur.planner.model.scene import Pick, Place, Scene, Step


def never_touching(scene: Scene, prover: Prover) -> Refusal | None:
    """The first pick or place whose part is too far from the tool, in all turns in which it may be gripped, or from
    what it is put down on, whenever; or None. Not known here: where any turn will do, and what rests on frames that
    move against each other. Raises `OutOfTimeError` where the deadline in force passes."""
    for number, step in enumerate(scene.task):
        look()
        found = ways(scene, number) if math.isfinite(asked(step)) else ()
        if isinstance(step, Pick):
            found = () if found and found[0].turn is None else found
        else:
            found = found[:1] if found and always(scene, step, found[0].before) else ()
        far = [too_far(prover, number, way.before, way.turn or 0.0, scene.start.time) for way in found]
        refusals = [refusal for refusal in far if refusal is not None]
        if refusals and len(refusals) == len(far):
            return min(refusals, key=_amount)
    return None


def always(scene: Scene, step: Step, attached: Attachments) -> bool:
    """Whether what the part of a place, or of a pick before which all is `attached`, rests on stays where it is against
    the part: it is named, and all of it is on the part's frame, or neither moves."""
    if not isinstance(step, Pick | Place) or step.contact_with is None:
        return False
    frame, _ = attached.point(scene, step)
    others = {attached.pose_of(scene, name)[0] for name in step.contact_with}
    return all(other == frame or _stand(scene, frame, other) for other in others)


def _stand(scene: Scene, *frames: str) -> bool:
    return all(scene.frames[name].law.is_fixed for name in frames)


def _amount(refusal: Refusal) -> float:
    return math.inf if refusal.amount is None else refusal.amount.value
